//! Friction with breakaway: bristles that bend at standstill and slip in motion.

use super::Friction;

/// Mean deflection of the bristles, m.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Bristles(f64);

impl Bristles {
    /// Bends them for one step at a speed of the rod, m/s, and returns the force against it, N.
    ///
    /// Implicit in the deflection, so that fast motion cannot make it overshoot.
    pub(super) fn step(&mut self, friction: &Friction, speed_m_s: f64, step_s: f64) -> f64 {
        let ratio = speed_m_s / friction.stribeck_m_s;
        let extra_n = friction.breakaway_n - friction.coulomb_n;
        // Beyond six Stribeck speeds nothing is left of the exponential.
        let bound_n = if ratio.abs() > 6.0 {
            friction.coulomb_n
        } else {
            friction.coulomb_n + extra_n * (-ratio * ratio).exp()
        };
        let slip = step_s * friction.bristle_stiffness_n_m * speed_m_s.abs() / bound_n;
        let bent_m = (self.0 + step_s * speed_m_s) / (1.0 + slip);
        let bending_m_s = (bent_m - self.0) / step_s;
        self.0 = bent_m;
        friction.bristle_stiffness_n_m * bent_m
            + friction.bristle_damping_n_s_m * bending_m_s
            + friction.viscous_n_s_m * speed_m_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRICTION: Friction = Friction {
        coulomb_n: 600.0,
        breakaway_n: 1000.0,
        stribeck_m_s: 6e-3,
        viscous_n_s_m: 3000.0,
        bristle_stiffness_n_m: 6e6,
        bristle_damping_n_s_m: 6e3,
        drift: 0.0,
    };

    fn steady(speed_m_s: f64, steps: usize) -> f64 {
        let mut bristles = Bristles::default();
        (0..steps).map(|_| bristles.step(&FRICTION, speed_m_s, 1e-4)).last().unwrap()
    }

    #[test]
    fn steady_friction_is_breakaway_at_a_crawl_and_coulomb_with_viscous_in_motion() {
        assert!((steady(1e-4, 1_000_000) - 1000.0).abs() < 1.0);
        assert!((steady(0.1, 20_000) - 900.0).abs() < 1.0);
        assert!((steady(-0.1, 20_000) + 900.0).abs() < 1.0);
        assert!((steady(10.0, 20_000) - 30_600.0).abs() < 1.0);
    }

    #[test]
    fn standstill_holds_against_a_push_below_breakaway() {
        let (mut bristles, mut x_m, mut v_m_s) = (Bristles::default(), 0.0, 0.0);
        for step in 0..100_000 {
            // Applied gently: a sudden push swings to twice its size.
            let force_n =
                900.0 * (f64::from(step) / 50_000.0).min(1.0) - bristles.step(&FRICTION, v_m_s, 1e-4);
            v_m_s += 1e-4 * force_n / 500.0;
            x_m += 1e-4 * v_m_s;
        }
        // Bristles yield as they bend: dz = (1 - z / z_most) dx.
        let yielded_m = -(1000.0 / 6e6) * (1.0_f64 - 0.9).ln();
        assert!((x_m / yielded_m - 1.0).abs() < 0.1, "{x_m} and {yielded_m} m");
    }
}
