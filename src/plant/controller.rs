//! The position loop of one joint.

use super::Control;

/// What the loop remembers: the integral parts of the wanted speed, rad/s.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Integral {
    /// Of the error of the angle.
    angle: f64,
    /// Of the error of the speed.
    speed: f64,
}

impl Integral {
    /// One turn of the loop: the signal for the valve, within ±1, positive for growing angles.
    pub(super) fn turn(
        &mut self,
        control: &Control,
        (planned_rad, planned_rad_s): (f64, f64),
        (measured_rad, measured_rad_s): (f64, f64),
        period_s: f64,
    ) -> f64 {
        let error_rad = planned_rad - measured_rad;
        if planned_rad_s.abs() > 0.0 || error_rad.abs() >= control.freeze_error_rad {
            self.angle += period_s * control.integral_gain_1_s2 * error_rad;
        }
        let wanted_rad_s =
            control.feed_forward * planned_rad_s + control.position_gain_1_s * error_rad + self.angle;
        let driven_rad_s = if control.has_speed_loop() {
            let short_rad_s = wanted_rad_s - measured_rad_s;
            self.speed += period_s * control.speed_integral_gain_1_s * short_rad_s;
            wanted_rad_s + control.speed_gain * short_rad_s + self.speed
        } else {
            wanted_rad_s
        };
        if driven_rad_s.abs() < control.window_rad_s() {
            return 0.0;
        }
        control.signal(driven_rad_s).clamp(-1.0, 1.0)
    }
}

impl Control {
    fn has_speed_loop(&self) -> bool {
        self.speed_gain > 0.0 || self.speed_integral_gain_1_s > 0.0
    }

    /// Wanted speed below which the positioning window gives no signal, rad/s.
    pub(super) fn window_rad_s(&self) -> f64 {
        self.position_gain_1_s * self.window_rad
    }

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

    fn control() -> Control {
        Control {
            position_gain_1_s: 2.0,
            integral_gain_1_s2: 0.5,
            feed_forward: 1.0,
            nominal_speed_rad_s: 0.3,
            compensation: 0.05,
            compensation_speed_rad_s: 0.01,
            freeze_error_rad: 0.001,
            ..Control::default()
        }
    }

    #[test]
    fn the_wanted_speed_for_a_signal_gives_that_signal() {
        for signal in [0.0, 0.01, 0.08, 0.09, 0.5, 1.0] {
            assert!((control().signal(control().wanted_rad_s(signal)) - signal).abs() < 1e-15);
        }
    }

    #[test]
    fn the_integral_rests_while_the_plan_rests_and_the_error_is_small() {
        let mut integral = Integral::default();
        integral.turn(&control(), (0.0009, 0.0), (0.0, 0.0), 0.01);
        assert!(integral.angle.abs() < f64::MIN_POSITIVE);
        integral.turn(&control(), (0.0009, 1e-6), (0.0, 0.0), 0.01);
        assert!(integral.angle > 0.0);
    }

    #[test]
    fn within_the_window_there_is_no_signal_and_beyond_it_the_whole_compensation() {
        let module = Control { window_rad: 0.01, compensation_speed_rad_s: 1e-4, ..control() };
        let signal = |error_rad| Integral::default().turn(&module, (error_rad, 0.0), (0.0, 0.0), 0.01);
        assert!(signal(0.0099).abs() < f64::MIN_POSITIVE);
        assert!(signal(-0.0101) < -0.05);
    }

    #[test]
    fn a_speed_loop_presses_on_until_the_speed_is_the_wanted_one() {
        let cascade = Control { speed_gain: 0.5, speed_integral_gain_1_s: 4.0, ..control() };
        let mut integral = Integral::default();
        let mut turn = |speed| integral.turn(&cascade, (0.01, 0.0), (0.0, speed), 0.01);
        let stuck = [turn(0.0), turn(0.0)];
        assert!(stuck[1] > stuck[0] && stuck[0] > control().signal(0.02));
        let (moving, on) = (turn(0.0202), turn(0.0202));
        assert!((on - moving).abs() < 1e-3 && moving < stuck[1]);
    }
}
