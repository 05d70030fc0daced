//! Flow through a valve's edges and pressures on both sides of a piston.

use super::{Chambers, Friction, Supply, Valve};

/// Pressure drop below which flow through an edge turns from turbulent to laminar, Pa.
const LAMINAR_PA: f64 = 5e4;

const STOP_N_M: f64 = 2e7;

const STOP_N_S_M: f64 = 2e5;

/// Sizes of all cylinders of a joint together.
#[derive(Debug, Clone, Copy)]
pub(super) struct Size {
    pub(super) cap_area_m2: f64,
    pub(super) rod_area_m2: f64,
    pub(super) stroke_m: f64,
}

/// Pressures of both sides, Pa.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Pressures {
    pub(super) cap_pa: f64,
    pub(super) rod_pa: f64,
}

/// Flow through an edge by flow gain and opening: the signed root of the pressure drop, and a bound of its slope.
fn root(drop_pa: f64) -> (f64, f64) {
    let slope = 1.0 / (drop_pa * drop_pa + LAMINAR_PA * LAMINAR_PA).sqrt().sqrt();
    (drop_pa * slope, slope)
}

/// Gain of an edge with a counterbalance valve behind it that is open by a share.
fn behind(gain: f64, valve: &Valve, share: f64) -> f64 {
    if valve.counterbalance_pa <= 0.0 {
        return gain;
    }
    let holding = COUNTERBALANCE * valve.flow_gain_m3_s_sqrt_pa * share;
    if holding > 0.0 { gain * holding / gain.hypot(holding) } else { 0.0 }
}

/// Flow gain of an open counterbalance valve by that of an open edge.
const COUNTERBALANCE: f64 = 2.0;

impl Pressures {
    /// Force of the pistons, positive where they push, N.
    pub(super) fn force_n(&self, size: &Size) -> f64 {
        self.cap_pa * size.cap_area_m2 - self.rod_pa * size.rod_area_m2
    }

    /// Goes on by one step and returns what the supply line gives, m³/s.
    ///
    /// `opening` is signed, positive to extend; the rod stands `out_m` from fully in and moves at
    /// `speed_m_s`. Linearly implicit in each pressure. Oil that would tear stays at zero pressure.
    pub(super) fn step(
        &mut self,
        (size, chambers, valve): (&Size, &Chambers, &Valve),
        (supply, supply_pa): (&Supply, f64),
        opening: f64,
        (out_m, speed_m_s): (f64, f64),
        step_s: f64,
    ) -> f64 {
        let gain = valve.flow_gain_m3_s_sqrt_pa * opening.abs();
        // What leaves passes the counterbalance valve of its side too.
        let (cap_gain, rod_gain) = if opening > 0.0 {
            (gain, behind(gain, valve, valve.counterbalance(self.rod_pa, self.cap_pa)))
        } else {
            (behind(gain, valve, valve.counterbalance(self.cap_pa, self.rod_pa)), gain)
        };
        let ((into_cap, cap_slope), (into_rod, rod_slope)) = if opening > 0.0 {
            (root(supply_pa - self.cap_pa), root(supply.return_pressure_pa - self.rod_pa))
        } else if opening < 0.0 {
            (root(supply.return_pressure_pa - self.cap_pa), root(supply_pa - self.rod_pa))
        } else {
            ((0.0, 0.0), (0.0, 0.0))
        };
        let leak_m3_s = chambers.leakage_m3_s_pa * (self.cap_pa - self.rod_pa);
        let out_m = out_m.max(0.0).min(size.stroke_m);
        let bulk = step_s * supply.bulk_modulus_pa;
        let cap_rate = bulk / (chambers.dead_volume_m3 + size.cap_area_m2 * out_m);
        let rod_rate = bulk / (chambers.dead_volume_m3 + size.rod_area_m2 * (size.stroke_m - out_m));
        let cap_net = cap_gain * into_cap - size.cap_area_m2 * speed_m_s - leak_m3_s;
        let rod_net = rod_gain * into_rod + size.rod_area_m2 * speed_m_s + leak_m3_s;
        let leakage = chambers.leakage_m3_s_pa;
        self.cap_pa =
            (self.cap_pa + cap_rate * cap_net / (1.0 + cap_rate * (cap_gain * cap_slope + leakage))).max(0.0);
        self.rod_pa =
            (self.rod_pa + rod_rate * rod_net / (1.0 + rod_rate * (rod_gain * rod_slope + leakage))).max(0.0);
        gain * if opening > 0.0 { into_cap } else { into_rod }
    }
}

/// Force of the end stops, positive where they push the rod out, N.
pub(super) fn stop_n(size: &Size, out_m: f64, speed_m_s: f64) -> f64 {
    let beyond_m = out_m - out_m.max(0.0).min(size.stroke_m);
    if beyond_m < 0.0 {
        (-STOP_N_M * beyond_m - STOP_N_S_M * speed_m_s).max(0.0)
    } else if beyond_m > 0.0 {
        (-STOP_N_M * beyond_m - STOP_N_S_M * speed_m_s).min(0.0)
    } else {
        0.0
    }
}

/// Speed at which the rod moves at a constant opening against a force that it must give, N,
/// positive where it pushes; signed as the opening, zero if it cannot move that way, m/s.
///
/// Both edges throttle alike, so that force balance is a quadratic in speed; the pump's flow bounds it.
pub(super) fn steady_speed_m_s(
    (size, valve, friction): (&Size, &Valve, &Friction),
    supply: &Supply,
    opening: f64,
    force_n: f64,
) -> f64 {
    let Size { cap_area_m2: cap, rod_area_m2: rod, .. } = *size;
    let (fed, drained, against_n) = if opening > 0.0 { (cap, rod, force_n) } else { (rod, cap, -force_n) };
    let gain = valve.flow_gain_m3_s_sqrt_pa * opening.abs();
    let left_n =
        supply.pressure_pa * fed - supply.return_pressure_pa * drained - against_n - friction.coulomb_n;
    if gain <= 0.0 || left_n <= 0.0 {
        return 0.0;
    }
    let throttle = (cap.powi(3) + rod.powi(3)) / (gain * gain);
    let viscous = friction.viscous_n_s_m;
    let speed_m_s = 2.0 * left_n / (viscous + (viscous * viscous + 4.0 * throttle * left_n).sqrt());
    speed_m_s.min(supply.flow_m3_s / fed).copysign(opening)
}
