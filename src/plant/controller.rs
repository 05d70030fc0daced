//! The position loop of one joint.

use super::Control;

/// What the loop remembers: the integral part of the wanted speed, rad/s.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Integral(f64);

impl Integral {
    /// One turn of the loop: the signal for the valve, within ±1, positive for growing angles.
    pub(super) fn turn(
        &mut self,
        control: &Control,
        (planned_rad, planned_rad_s): (f64, f64),
        measured_rad: f64,
        period_s: f64,
    ) -> f64 {
        let error_rad = planned_rad - measured_rad;
        if planned_rad_s.abs() > 0.0 || error_rad.abs() >= control.freeze_error_rad {
            self.0 += period_s * control.integral_gain_1_s2 * error_rad;
        }
        let wanted_rad_s =
            control.feed_forward * planned_rad_s + control.position_gain_1_s * error_rad + self.0;
        control.signal(wanted_rad_s).clamp(-1.0, 1.0)
    }
}

impl Control {
    /// The signal that a wanted speed becomes; increasing, odd, and unbounded.
    pub(super) fn signal(&self, wanted_rad_s: f64) -> f64 {
        let share = (wanted_rad_s / self.compensation_speed_rad_s).clamp(-1.0, 1.0);
        wanted_rad_s / self.nominal_speed_rad_s + self.compensation * share
    }

    /// The wanted speed, rad/s, that becomes a signal of zero or more.
    pub(super) fn wanted_rad_s(&self, signal: f64) -> f64 {
        let knee = self.signal(self.compensation_speed_rad_s);
        if signal <= knee {
            signal / knee * self.compensation_speed_rad_s
        } else {
            (signal - self.compensation) * self.nominal_speed_rad_s
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONTROL: Control = Control {
        position_gain_1_s: 2.0,
        integral_gain_1_s2: 0.5,
        feed_forward: 1.0,
        nominal_speed_rad_s: 0.3,
        compensation: 0.05,
        compensation_speed_rad_s: 0.01,
        freeze_error_rad: 0.001,
    };

    #[test]
    fn the_wanted_speed_for_a_signal_gives_that_signal() {
        for signal in [0.0, 0.01, 0.08, 0.09, 0.5, 1.0] {
            assert!((CONTROL.signal(CONTROL.wanted_rad_s(signal)) - signal).abs() < 1e-15);
        }
    }

    #[test]
    fn the_integral_rests_while_the_plan_rests_and_the_error_is_small() {
        let mut integral = Integral::default();
        integral.turn(&CONTROL, (0.0009, 0.0), 0.0, 0.01);
        assert!(integral.0.abs() < f64::MIN_POSITIVE);
        integral.turn(&CONTROL, (0.0009, 1e-6), 0.0, 0.01);
        assert!(integral.0 > 0.0);
    }
}
