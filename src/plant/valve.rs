//! From the controller's signal to the opening of the ports.

use super::Valve;

/// Spool of a valve; positive extends.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Spool {
    /// The signal behind the play.
    drive: f64,
    /// Travel, share of the full one.
    pub(super) travel: f64,
}

impl Spool {
    /// Follows the signal, which is within ±1, for one step.
    pub(super) fn step(&mut self, valve: &Valve, signal: f64, step_s: f64) {
        self.drive = self.drive.min(signal + valve.hysteresis).max(signal - valve.hysteresis);
        let speed_1_s = (self.drive - self.travel) / valve.spool_lag_s;
        self.travel += step_s * speed_1_s.max(-valve.spool_slew_1_s).min(valve.spool_slew_1_s);
    }

    /// Opening of the ports beyond the overlap, signed.
    pub(super) fn opening(&self, valve: &Valve) -> f64 {
        valve.port(
            (self.travel - valve.overlap_extend).max(0.0) + (self.travel + valve.overlap_retract).min(0.0),
        )
    }
}

impl Valve {
    /// Area of the edges, share of the full one, by travel beyond the overlap; signed.
    pub(super) fn port(&self, beyond: f64) -> f64 {
        if self.progression > 0.0 { beyond * beyond.abs().powf(self.progression) } else { beyond }
    }

    /// How far the counterbalance valve of a side is open, by the pressures of this side and of the
    /// other; 1 without one.
    pub(super) fn counterbalance(&self, side_pa: f64, other_pa: f64) -> f64 {
        if self.counterbalance_pa <= 0.0 {
            return 1.0;
        }
        let beyond_pa = side_pa + self.counterbalance_pilot_ratio * other_pa - self.counterbalance_pa;
        (beyond_pa / (COUNTERBALANCE_RANGE * self.counterbalance_pa)).clamp(0.0, 1.0)
    }
}

/// A counterbalance valve is fully open this share of its setting beyond it.
const COUNTERBALANCE_RANGE: f64 = 0.25;

#[cfg(test)]
mod tests {
    use super::*;

    fn valve() -> Valve {
        Valve {
            hysteresis: 0.01,
            overlap_extend: 0.1,
            overlap_retract: 0.05,
            spool_lag_s: 0.03,
            spool_slew_1_s: 9.0,
            flow_gain_m3_s_sqrt_pa: 1e-8,
            ..Valve::default()
        }
    }

    fn settled(spool: &mut Spool, signal: f64) -> f64 {
        let valve = valve();
        (0..20_000).for_each(|_| spool.step(&valve, signal, 1e-4));
        spool.opening(&valve)
    }

    #[test]
    fn a_signal_within_overlap_and_play_opens_nothing() {
        let mut spool = Spool::default();
        for signal in [0.0, 0.109, -0.059, 0.02] {
            assert!(settled(&mut spool, signal).abs() < 1e-12, "{signal}");
        }
        assert!((settled(&mut spool, 0.3) - 0.19).abs() < 1e-9);
        assert!((settled(&mut spool, -0.3) + 0.24).abs() < 1e-9);
    }

    #[test]
    fn a_signal_that_turns_back_by_less_than_the_play_moves_no_spool() {
        let mut spool = Spool::default();
        settled(&mut spool, 0.5);
        let travel = spool.travel;
        settled(&mut spool, 0.481);
        assert!((spool.travel - travel).abs() < 1e-9);
    }

    #[test]
    fn a_full_signal_opens_at_the_slew_rate() {
        let mut spool = Spool::default();
        (0..500).for_each(|_| spool.step(&valve(), 1.0, 1e-4));
        assert!((spool.travel - 0.45).abs() < 1e-3, "{}", spool.travel);
    }

    #[test]
    fn progressive_edges_pass_little_near_the_null_and_as_much_when_wide_open() {
        let notched = Valve { progression: 1.0, ..valve() };
        assert!((notched.port(-0.1) + 0.01).abs() < 1e-15);
        assert!((notched.port(1.0) - valve().port(1.0)).abs() < 1e-15);
    }

    #[test]
    fn a_counterbalance_valve_opens_by_load_or_by_pilot() {
        let valve = Valve { counterbalance_pa: 16e6, counterbalance_pilot_ratio: 4.0, ..valve() };
        assert!(valve.counterbalance(8e6, 1.9e6) < f64::MIN_POSITIVE);
        assert!((valve.counterbalance(8e6, 2.5e6) - 0.5).abs() < 1e-12);
        assert!((valve.counterbalance(20e6, 0.0) - 1.0).abs() < 1e-12);
    }
}
