//! Interpolation between two states, as the ROS 2 joint trajectory controller does it.

/// Position, velocity and acceleration at one instant, in whatever unit the caller uses.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State {
    /// Position.
    pub position: f64,
    /// First derivative, per s.
    pub velocity: f64,
    /// Second derivative, per s².
    pub acceleration: f64,
}

/// The state `at_s` after `a` on the straight line to `b`, which lies `span_s` after `a`.
pub fn linear(a: f64, b: f64, span_s: f64, at_s: f64) -> State {
    let velocity = (b - a) / span_s;
    State { position: a + velocity * at_s, velocity, acceleration: 0.0 }
}

/// The state `at_s` after `a` on the cubic that meets positions and velocities at both ends.
pub fn cubic(a: State, b: State, span_s: f64, at_s: f64) -> State {
    let rise = b.position - a.position;
    let c2 = (3.0 * rise / span_s - 2.0 * a.velocity - b.velocity) / span_s;
    let c3 = (-2.0 * rise / span_s + a.velocity + b.velocity) / (span_s * span_s);
    State {
        position: a.position + at_s * (a.velocity + at_s * (c2 + at_s * c3)),
        velocity: a.velocity + at_s * (2.0 * c2 + at_s * 3.0 * c3),
        acceleration: 2.0 * c2 + 6.0 * at_s * c3,
    }
}

/// The state `at_s` after `a` on the quintic that meets positions, velocities and
/// accelerations at both ends.
pub fn quintic(a: State, b: State, span_s: f64, at_s: f64) -> State {
    let (h, u) = (span_s, at_s / span_s);
    // In u = t/h with scaled end states: p = c0 + c1 u + ... + c5 u^5.
    let rise = b.position - a.position;
    let (v0, v1) = (a.velocity * h, b.velocity * h);
    let (a0, a1) = (a.acceleration * h * h, b.acceleration * h * h);
    let c2 = 0.5 * a0;
    let c3 = 10.0 * rise - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1;
    let c4 = -15.0 * rise + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1;
    let c5 = 6.0 * rise - 3.0 * (v0 + v1) - 0.5 * a0 + 0.5 * a1;
    State {
        position: a.position + u * (v0 + u * (c2 + u * (c3 + u * (c4 + u * c5)))),
        velocity: (v0 + u * (2.0 * c2 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5)))) / h,
        acceleration: (2.0 * c2 + u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5))) / (h * h),
    }
}

/// From 0 to 1 with zero speed and acceleration at both.
pub fn smooth_step(share: f64) -> f64 {
    let x = share.clamp(0.0, 1.0);
    x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: State = State { position: 0.3, velocity: -0.7, acceleration: 2.0 };
    const B: State = State { position: 1.1, velocity: 0.4, acceleration: -1.0 };

    fn near(got: f64, want: f64) -> bool {
        (got - want).abs() < 1e-12
    }

    #[test]
    fn a_quintic_meets_both_ends_in_all_three_quantities() {
        for (at_s, want) in [(0.0, A), (0.8, B)] {
            let got = quintic(A, B, 0.8, at_s);
            assert!(near(got.position, want.position), "{got:?}");
            assert!(near(got.velocity, want.velocity), "{got:?}");
            assert!(near(got.acceleration, want.acceleration), "{got:?}");
        }
    }

    #[test]
    fn a_cubic_meets_both_ends_in_position_and_velocity() {
        for (at_s, want) in [(0.0, A), (0.8, B)] {
            let got = cubic(A, B, 0.8, at_s);
            assert!(near(got.position, want.position) && near(got.velocity, want.velocity), "{got:?}");
        }
    }

    #[test]
    fn velocities_are_the_derivative_of_positions() {
        for f in [cubic, quintic] {
            let h = 1e-5;
            let slope = (f(A, B, 0.8, 0.5 + h).position - f(A, B, 0.8, 0.5 - h).position) / (2.0 * h);
            assert!((slope - f(A, B, 0.8, 0.5).velocity).abs() < 1e-8);
        }
    }
}
