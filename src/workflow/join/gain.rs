//! How much of the correction of a plan was sent: commands of one plan are so alike that each fits where another was sent.

use crate::series::{Series, Track};

/// Instants that are looked at.
const INSTANTS: u32 = 1_000;
/// Another share of the correction leaves this of what the whole leaves, or none of it, as root mean squares.
const CLEARLY: f64 = 0.5;
/// Shares nearer to the whole, or to none, are those.
const NEAR: f64 = 0.15;
/// Less than this, rad or m, root mean square, tells nothing.
const LEAST: f64 = 1e-4;
/// Steps in which the speed of a plan is taken, s.
const STEP_S: f64 = 0.02;

/// The share of the correction of `command` on its `plan` that was sent, where that is clearly neither the whole nor none; `at_s` is
/// where the time 0 of the plan lies. What is sent a little earlier or later is no other share.
pub(super) fn other_share(plan: &Series, command: &Series, sent: &Series, at_s: f64) -> Option<f64> {
    let [from_s, to_s] = plan.span_s()?;
    let instants =
        || (0..INSTANTS).map(|k| from_s + (to_s - from_s) * f64::from(k) / f64::from(INSTANTS - 1));
    let of_joint = |plan: &Track| {
        let (command, sent) = (command.track(plan.name())?, sent.track(plan.name())?);
        let mut cursors = [0; 5];
        let mut place = |k: usize, track: &Track, t_s: f64| track.held_after(&mut cursors[k], t_s).position;
        let sums = instants().fold([0.0; 6], |[ss, sc, cc, sv, cv, vv], t_s| {
            let wanted = place(0, plan, t_s);
            let correction = place(1, command, t_s) - wanted;
            let sent = place(2, sent, at_s + t_s) - wanted;
            let speed = (place(3, plan, t_s + STEP_S) - place(4, plan, t_s - STEP_S)) / (2.0 * STEP_S);
            [
                ss + sent * sent,
                sc + sent * correction,
                cc + correction * correction,
                sv + sent * speed,
                cv + correction * speed,
                vv + speed * speed,
            ]
        });
        Some(sums)
    };
    let sums = plan.tracks.iter().filter_map(of_joint);
    let [ss, sc, cc, sv, cv, vv] = sums.fold([0.0; 6], |a, b| std::array::from_fn(|k| a[k] + b[k]));
    // Without what another time explains.
    let [ss, sc, cc] =
        if vv > 0.0 { [ss - sv * sv / vv, sc - sv * cv / vv, cc - cv * cv / vv] } else { [ss, sc, cc] };
    let least = LEAST * LEAST * f64::from(INSTANTS);
    let share = sc / cc;
    let [whole, none, best] = [ss - 2.0 * sc + cc, ss, ss - sc * share];
    let clearly = best.max(0.0) < CLEARLY * CLEARLY * whole.min(none);
    (cc > least && whole.min(none) > least && clearly && share > NEAR && (share - 1.0).abs() > NEAR)
        .then_some(share)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::smooth_step as step;

    #[test]
    fn another_share_of_a_correction_is_told_and_another_time_or_a_held_sample_is_not() {
        let plan = |t: f64| step((t - 1.0) / 3.0) - 0.5 * step((t - 6.0) / 3.0);
        let bump =
            |t: f64| 0.02 * (-((t - 1.3) / 0.2).powi(2)).exp() - 0.015 * (-((t - 6.3) / 0.2).powi(2)).exp();
        let series = |q: &dyn Fn(f64) -> f64| Series::sampled("swing", 1000, q);
        let command = |share: f64| move |t: f64| plan(t) + share * bump(t);
        let of = |sent: &dyn Fn(f64) -> f64, at_s: f64| {
            other_share(&series(&plan), &series(&command(1.0)), &series(sent), at_s)
        };
        for share in [0.25, 0.5, 1.3, 2.0] {
            let found = of(&command(share), 0.0).unwrap_or_default();
            assert!((found - share).abs() < 0.02, "{share}: {found}");
            // Where its time was found by what it is not.
            let found = of(&command(share), 0.01).unwrap_or_default();
            assert!((found - share).abs() < 0.1, "{share}: {found}");
        }
        assert_eq!([of(&command(1.0), 0.0), of(&command(1.0), 0.02), of(&plan, 0.0)], [None; 3]);
        let held = |t: f64| command(1.0)((t / 0.05).floor() * 0.05);
        assert_eq!(of(&held, 0.025), None);
    }
}
