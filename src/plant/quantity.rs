//! The table of all numbers of a machine: key in the file, place, range, spread.

use super::{JointParameters, PlantError, STEP_S, parameters::Parameters};
use crate::units::DEGREE_RAD;

#[derive(Clone, Copy)]
pub(super) enum Place {
    /// Once a machine.
    Machine(fn(&mut Parameters) -> &mut f64),
    /// Once a joint.
    Joint(fn(&mut JointParameters) -> &mut f64),
}

#[derive(Clone, Copy)]
pub(super) struct Quantity {
    /// Table and key of the file.
    pub(super) key: (&'static str, &'static str),
    pub(super) place: Place,
    /// The file's unit in SI units.
    pub(super) unit: f64,
    /// Smallest and largest value, in the file's unit.
    pub(super) range: (f64, f64),
    /// A random machine differs by up to this share either way.
    pub(super) spread: f64,
    /// Whether a file may leave it out, for zero: a structure that most machines lack.
    pub(super) optional: bool,
}

const fn shared(
    key: (&'static str, &'static str),
    range: (f64, f64),
    spread: f64,
    of: fn(&mut Parameters) -> &mut f64,
) -> Quantity {
    Quantity { key, place: Place::Machine(of), unit: 1.0, range, spread, optional: false }
}

const fn joint(
    key: (&'static str, &'static str),
    range: (f64, f64),
    spread: f64,
    of: fn(&mut JointParameters) -> &mut f64,
) -> Quantity {
    Quantity { key, place: Place::Joint(of), unit: 1.0, range, spread, optional: false }
}

const fn degrees(quantity: Quantity) -> Quantity {
    Quantity { unit: DEGREE_RAD, ..quantity }
}

const fn optional(
    key: (&'static str, &'static str),
    most: f64,
    of: fn(&mut JointParameters) -> &mut f64,
) -> Quantity {
    Quantity { optional: true, ..joint(key, (0.0, most), 0.0, of) }
}

const fn optional_shared(
    key: (&'static str, &'static str),
    most: f64,
    of: fn(&mut Parameters) -> &mut f64,
) -> Quantity {
    Quantity { optional: true, ..shared(key, (0.0, most), 0.0, of) }
}

/// All of them, in the order of the file.
pub(super) const QUANTITIES: [Quantity; 51] = [
    shared(("supply", "pressure_pa"), (1e5, 1e8), 0.0, |p| &mut p.supply.pressure_pa),
    shared(("supply", "return_pressure_pa"), (0.0, 1e8), 0.0, |p| &mut p.supply.return_pressure_pa),
    shared(("supply", "flow_m3_s"), (1e-7, 1.0), 0.2, |p| &mut p.supply.flow_m3_s),
    shared(("supply", "droop_pa"), (1e3, 1e8), 0.3, |p| &mut p.supply.droop_pa),
    shared(("supply", "volume_m3"), (1e-6, 1.0), 0.3, |p| &mut p.supply.volume_m3),
    shared(("supply", "bulk_modulus_pa"), (1e7, 3e9), 0.2, |p| &mut p.supply.bulk_modulus_pa),
    joint(("valve", "dead_time_s"), (0.0, 2.0), 0.5, |p| &mut p.valve.dead_time_s),
    joint(("valve", "hysteresis"), (0.0, 0.5), 0.5, |p| &mut p.valve.hysteresis),
    joint(("valve", "overlap_extend"), (0.0, 0.9), 0.4, |p| &mut p.valve.overlap_extend),
    joint(("valve", "overlap_retract"), (0.0, 0.9), 0.4, |p| &mut p.valve.overlap_retract),
    joint(("valve", "spool_lag_s"), (1e-3, 2.0), 0.4, |p| &mut p.valve.spool_lag_s),
    joint(("valve", "spool_slew_1_s"), (0.1, 1e4), 0.4, |p| &mut p.valve.spool_slew_1_s),
    joint(("valve", "flow_gain_m3_s_sqrt_pa"), (1e-12, 1e-4), 0.2, |p| &mut p.valve.flow_gain_m3_s_sqrt_pa),
    optional(("valve", "progression"), 4.0, |p| &mut p.valve.progression),
    optional(("valve", "counterbalance_pa"), 1e8, |p| &mut p.valve.counterbalance_pa),
    optional(("valve", "counterbalance_pilot_ratio"), 20.0, |p| &mut p.valve.counterbalance_pilot_ratio),
    optional(("valve", "null_drift"), 0.3, |p| &mut p.valve.null_drift),
    optional(("valve", "dead_time_drift_s"), 1.0, |p| &mut p.valve.dead_time_drift_s),
    joint(("cylinder", "dead_volume_m3"), (1e-7, 1.0), 0.3, |p| &mut p.chambers.dead_volume_m3),
    joint(("cylinder", "leakage_m3_s_pa"), (0.0, 1e-9), 0.5, |p| &mut p.chambers.leakage_m3_s_pa),
    joint(("friction", "coulomb_n"), (1e-3, 1e6), 0.4, |p| &mut p.friction.coulomb_n),
    joint(("friction", "breakaway_n"), (1e-3, 1e6), 0.4, |p| &mut p.friction.breakaway_n),
    joint(("friction", "stribeck_m_s"), (1e-5, 1.0), 0.4, |p| &mut p.friction.stribeck_m_s),
    joint(("friction", "viscous_n_s_m"), (0.0, 1e7), 0.4, |p| &mut p.friction.viscous_n_s_m),
    joint(("friction", "bristle_stiffness_n_m"), (1e3, 1e9), 0.2, |p| &mut p.friction.bristle_stiffness_n_m),
    joint(("friction", "bristle_damping_n_s_m"), (0.0, 1e7), 0.2, |p| &mut p.friction.bristle_damping_n_s_m),
    optional(("friction", "drift"), 0.9, |p| &mut p.friction.drift),
    optional(("link", "frequency_hz"), 100.0, |p| &mut p.link.frequency_hz),
    optional(("link", "damping_ratio"), 1.0, |p| &mut p.link.damping_ratio),
    shared(("control", "period_s"), (STEP_S, 1.0), 0.0, |p| &mut p.cycle.period_s),
    joint(("control", "position_gain_1_s"), (0.0, 100.0), 0.25, |p| &mut p.control.position_gain_1_s),
    joint(("control", "integral_gain_1_s2"), (0.0, 100.0), 0.3, |p| &mut p.control.integral_gain_1_s2),
    joint(("control", "feed_forward"), (0.0, 10.0), 0.2, |p| &mut p.control.feed_forward),
    degrees(joint(("control", "nominal_speed_deg_s"), (0.01, 1e4), 0.0, |p| {
        &mut p.control.nominal_speed_rad_s
    })),
    joint(("control", "compensation"), (0.0, 0.9), 0.2, |p| &mut p.control.compensation),
    degrees(joint(("control", "compensation_speed_deg_s"), (1e-3, 1e3), 0.0, |p| {
        &mut p.control.compensation_speed_rad_s
    })),
    degrees(joint(("control", "freeze_error_deg"), (0.0, 10.0), 0.0, |p| &mut p.control.freeze_error_rad)),
    optional(("control", "set_value_filter_s"), 10.0, |p| &mut p.control.set_value_filter_s),
    optional_shared(("control", "set_value_period_s"), 1.0, |p| &mut p.cycle.set_value_period_s),
    optional_shared(("control", "set_value_jitter_s"), 1.0, |p| &mut p.cycle.set_value_jitter_s),
    optional_shared(("control", "set_value_delay_s"), 1.0, |p| &mut p.cycle.set_value_delay_s),
    optional(("control", "speed_gain"), 100.0, |p| &mut p.control.speed_gain),
    optional(("control", "speed_integral_gain_1_s"), 1000.0, |p| &mut p.control.speed_integral_gain_1_s),
    degrees(optional(("control", "window_deg"), 10.0, |p| &mut p.control.window_rad)),
    degrees(joint(("encoder", "backlash_deg"), (0.0, 10.0), 0.4, |p| &mut p.encoder.backlash_rad)),
    degrees(joint(("encoder", "noise_deg"), (0.0, 10.0), 0.0, |p| &mut p.encoder.noise_rad)),
    degrees(joint(("encoder", "count_deg"), (1e-9, 10.0), 0.0, |p| &mut p.encoder.count_rad)),
    shared(("encoder", "speed_filter_s"), (0.0, 10.0), 0.0, |p| &mut p.cycle.speed_filter_s),
    shared(("log", "jitter_s"), (0.0, 0.1), 0.0, |p| &mut p.cycle.jitter_s),
    shared(("log", "loss"), (0.0, 0.9), 0.0, |p| &mut p.cycle.loss),
    shared(("payload", "ramp_s"), (0.0, 60.0), 0.0, |p| &mut p.cycle.payload_ramp_s),
];

/// What is wrong with a number, before it is known in which line it stands.
pub(super) struct Flaw {
    pub(super) key: (&'static str, &'static str),
    pub(super) joint: Option<String>,
    pub(super) found: f64,
    pub(super) expected: String,
}

impl Flaw {
    pub(super) fn at(self, line: Option<usize>) -> PlantError {
        let Self { key: (table, key), joint, found, expected } = self;
        let of = joint.map(|joint| format!(" of {joint}")).unwrap_or_default();
        PlantError::Value { line, key: format!("{table}.{key}{of}"), found, expected }
    }
}

/// Holds every number to its range, and to the numbers that it must agree with.
pub(super) fn check(parameters: &Parameters) -> Result<(), Flaw> {
    // The table hands out places to write to; a copy keeps it the only table.
    let mut copy = parameters.clone();
    for quantity in &QUANTITIES {
        match quantity.place {
            Place::Machine(of) => quantity.check(None, *of(&mut copy))?,
            Place::Joint(of) => {
                for joint in &mut copy.joints {
                    let value = *of(joint);
                    quantity.check(Some(&joint.name), value)?;
                }
            }
        }
    }
    let flaw = |key, joint: Option<&str>, found, expected: String| {
        Err(Flaw { key, joint: joint.map(str::to_owned), found, expected })
    };
    let supply = &parameters.supply;
    if supply.return_pressure_pa >= supply.pressure_pa {
        let expected = format!("less than the supply's {} Pa is expected", supply.pressure_pa);
        return flaw(("supply", "return_pressure_pa"), None, supply.return_pressure_pa, expected);
    }
    let steps = parameters.cycle.period_s / STEP_S;
    if (steps - steps.round()).abs() > 1e-6 {
        let expected = format!("a multiple of the simulation's step, {STEP_S} s, is expected");
        return flaw(("control", "period_s"), None, parameters.cycle.period_s, expected);
    }
    for joint in &parameters.joints {
        let friction = &joint.friction;
        if friction.breakaway_n < friction.coulomb_n {
            let expected = format!("no less than coulomb_n, {} N, is expected", friction.coulomb_n);
            return flaw(("friction", "breakaway_n"), Some(&joint.name), friction.breakaway_n, expected);
        }
    }
    Ok(())
}

impl Quantity {
    fn check(&self, joint: Option<&str>, value: f64) -> Result<(), Flaw> {
        let (least, most) = self.range;
        let found = value / self.unit;
        // A limit typed in degrees comes back within rounding.
        let slack = 1e-12 * most.abs();
        if found >= least - slack && found <= most + slack {
            return Ok(());
        }
        let expected = format!("a number from {least} to {most} is expected");
        Err(Flaw { key: self.key, joint: joint.map(str::to_owned), found, expected })
    }
}
