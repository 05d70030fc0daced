//! What reaches the loop of the command: held between messages, late, smoothed.

use rand_distr::{Distribution, StandardUniform};

use super::{Control, Cycle};
use crate::rng::{Stream, stream};

/// A smoothed speed below this is rest, rad/s.
const REST_RAD_S: f64 = 1e-6;

/// The instant of the command, s, that is the newest which has arrived by each period of the loop.
pub(super) fn instants_s(cycle: &Cycle, periods: usize, seed: u64) -> Vec<f64> {
    let turn_s = |period| period as f64 * cycle.period_s - cycle.set_value_delay_s;
    let turns_s = (0..=periods).map(turn_s);
    if cycle.set_value_period_s <= 0.0 && cycle.set_value_jitter_s <= 0.0 {
        return turns_s.map(|t_s: f64| t_s.max(0.0)).collect();
    }
    let every_s = if cycle.set_value_period_s > 0.0 { cycle.set_value_period_s } else { cycle.period_s };
    let mut rng = stream(seed, Stream::SetValues);
    let mut late_s = move || {
        let share: f64 = StandardUniform.sample(&mut rng);
        share * cycle.set_value_jitter_s
    };
    // The first is there before the loop starts. Messages keep their order.
    let (mut held_s, mut next) = (0.0, (every_s, every_s + late_s()));
    let newest_s = turns_s.map(|now_s| {
        while next.1 <= now_s + 1e-9 {
            held_s = next.0;
            let sent_s = next.0 + every_s;
            next = (sent_s, next.1.max(sent_s + late_s()));
        }
        held_s
    });
    newest_s.collect()
}

/// Smooths angles and speeds, rad and rad/s, one of each a period, where the loop does.
pub(super) fn smooth(control: &Control, period_s: f64, values: &mut [(f64, f64)]) {
    if control.set_value_filter_s <= 0.0 {
        return;
    }
    let share = period_s / (period_s + control.set_value_filter_s);
    let mut now = values.first().copied().unwrap_or_default();
    for value in values {
        now.0 += share * (value.0 - now.0);
        now.1 += share * (value.1 - now.1);
        let rests = value.1.abs() <= 0.0 && now.1.abs() < REST_RAD_S;
        *value = (now.0, if rests { 0.0 } else { now.1 });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cycle(set_value_period_s: f64, set_value_jitter_s: f64) -> Cycle {
        Cycle { period_s: 0.01, set_value_period_s, set_value_jitter_s, ..Cycle::default() }
    }

    #[test]
    fn set_values_without_a_period_of_their_own_come_with_every_turn() {
        assert_eq!(instants_s(&cycle(0.0, 0.0), 2, 1), [0.0, 0.01, 0.02]);
    }

    #[test]
    fn set_values_are_held_between_messages() {
        assert_eq!(instants_s(&cycle(0.02, 0.0), 5, 1), [0.0, 0.0, 0.02, 0.02, 0.04, 0.04]);
    }

    #[test]
    fn delayed_set_values_begin_with_the_first() {
        let delayed = |every_s| Cycle { set_value_delay_s: 0.02, ..cycle(every_s, 0.0) };
        let found_s = instants_s(&delayed(0.0), 4, 1);
        let due_s = [0.0, 0.0, 0.0, 0.01, 0.02];
        assert!(
            found_s.iter().zip(due_s).all(|(found_s, due_s)| (found_s - due_s).abs() < 1e-9),
            "{found_s:?}"
        );
        assert_eq!(instants_s(&delayed(0.02), 5, 1), [0.0, 0.0, 0.0, 0.0, 0.02, 0.02]);
    }

    #[test]
    fn late_set_values_keep_their_order_and_come_within_the_jitter() {
        let found_s = instants_s(&cycle(0.02, 0.03), 1000, 1);
        let mut latest_s = 0.0_f64;
        for (period, held_s) in found_s.iter().enumerate() {
            let late_s = period as f64 * 0.01 - held_s;
            assert!((-1e-9..0.05 + 1e-9).contains(&late_s), "{late_s} s");
            latest_s = latest_s.max(late_s);
        }
        assert!(latest_s > 0.03 && found_s.is_sorted());
        assert_ne!(found_s, instants_s(&cycle(0.02, 0.03), 1000, 2));
    }

    #[test]
    fn smoothed_set_values_lag_by_the_time_constant() {
        let control = Control { set_value_filter_s: 0.2, ..Control::default() };
        let mut values: Vec<(f64, f64)> = (0..400).map(|k| (0.1 * 0.01 * f64::from(k), 0.1)).collect();
        smooth(&control, 0.01, &mut values);
        let last = values[399];
        assert!((0.399 - last.0 - 0.1 * 0.2).abs() < 1e-4, "{last:?}");
    }
}
