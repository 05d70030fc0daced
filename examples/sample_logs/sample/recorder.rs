//! The control loop that reads the encoders and writes the log, with what it loses.

use std::{error::Error, io::Write};

use hydrotrace::{
    log::{ControllerState, LogWriter, Point, Role, WriteError},
    rng::{self, Stream},
    units::{DEGREE_RAD, NS_PER_S},
};
use rand_distr::{Bernoulli, Distribution, Normal};

use super::{
    machine::Motion,
    plan::{JointPlan, knots_s},
};

/// Stamp of the first cycle, ns since 1970.
pub(crate) const START_NS: i64 = 1_750_000_000_000_000_000;

const CYCLE_S: f64 = 0.01;
/// Cycles of a run, the first at its start.
pub(crate) const CYCLES: usize = 4001;
/// Cycles come late or early by this, one standard deviation, s.
pub(crate) const JITTER_S: f64 = 0.5e-3;
/// Part of the messages that is lost.
pub(crate) const LOSS: f64 = 0.002;
/// Noise of an encoder, one standard deviation, rad.
pub(crate) const NOISE_RAD: f64 = 0.01 * DEGREE_RAD;
/// What one count of a 16-bit encoder stands for, rad.
pub(crate) const COUNT_RAD: f64 = 360.0 / 65536.0 * DEGREE_RAD;

/// One turn of the control loop: what it knows, and which messages get through.
///
/// The loop computes in `f32`, as many controllers do.
#[derive(Debug, Clone)]
pub(crate) struct Cycle {
    pub(crate) t_s: f64,
    pub(crate) stamp_ns: i64,
    pub(crate) planned_rad: Vec<f64>,
    pub(crate) planned_rad_s: Vec<f64>,
    pub(crate) measured_rad: Vec<f64>,
    pub(crate) keep_planned: bool,
    pub(crate) keep_measured: bool,
}

/// The cycles of a run. The first and the last lose nothing.
///
/// # Errors
///
/// Never for the constants of this module; the distributions check them.
pub(crate) fn cycles(
    seed: u64,
    plans: &[JointPlan],
    motions: &[Motion],
) -> Result<Vec<Cycle>, Box<dyn Error>> {
    let noise = Normal::new(0.0, NOISE_RAD)?;
    let jitter = Normal::new(0.0, JITTER_S)?;
    let loss = Bernoulli::new(LOSS)?;
    let mut sensor_rng = rng::stream(seed, Stream::SensorNoise);
    let mut sampling_rng = rng::stream(seed, Stream::Sampling);
    let mut cycles = Vec::with_capacity(CYCLES);
    for k in 0..CYCLES {
        let inner = k > 0 && k + 1 < CYCLES;
        let late_s = jitter.sample(&mut sampling_rng).clamp(-0.4 * CYCLE_S, 0.4 * CYCLE_S);
        let [keep_planned, keep_measured] = [(); 2].map(|()| !loss.sample(&mut sampling_rng) || !inner);
        let since_ns = nanoseconds(k as f64 * CYCLE_S + if inner { late_s } else { 0.0 });
        let t_s = since_ns as f64 / NS_PER_S;
        let planned: Vec<_> = plans.iter().map(|plan| plan.at(t_s)).collect();
        let encoder = |motion: &Motion| (motion.at(t_s) + noise.sample(&mut sensor_rng)) / COUNT_RAD;
        cycles.push(Cycle {
            t_s,
            stamp_ns: START_NS + since_ns,
            planned_rad: planned.iter().map(|p| single(p.angle_rad)).collect(),
            planned_rad_s: planned.iter().map(|p| single(p.speed_rad_s)).collect(),
            measured_rad: motions
                .iter()
                .map(encoder)
                .map(|count| single(count.round() * COUNT_RAD))
                .collect(),
            keep_planned,
            keep_measured,
        });
    }
    Ok(cycles)
}

#[expect(clippy::cast_possible_truncation, reason = "that is the point")]
fn single(value: f64) -> f64 {
    f64::from(value as f32)
}

#[expect(clippy::cast_possible_truncation, reason = "a run lasts 40 s")]
fn nanoseconds(t_s: f64) -> i64 {
    (t_s * NS_PER_S).round() as i64
}

/// Writes the planned and the measured state of one cycle, as far as they get through.
pub(crate) fn write_joints<W: Write>(log: &mut LogWriter<W>, cycle: &Cycle) -> Result<(), WriteError> {
    if cycle.keep_planned {
        log.joint_sample(Role::Planned, cycle.stamp_ns, &cycle.planned_rad, &cycle.planned_rad_s, &[])?;
    }
    write_measured(log, cycle)
}

/// Writes the measured state of one cycle if it gets through.
pub(crate) fn write_measured<W: Write>(log: &mut LogWriter<W>, cycle: &Cycle) -> Result<(), WriteError> {
    if !cycle.keep_measured {
        return Ok(());
    }
    log.joint_sample(Role::Measured, cycle.stamp_ns, &cycle.measured_rad, &[], &[])
}

/// Writes what the controller tells of one cycle.
pub(crate) fn write_state<W: Write>(log: &mut LogWriter<W>, cycle: &Cycle) -> Result<(), WriteError> {
    let time_from_start_ns = cycle.stamp_ns - START_NS;
    let point = |position_rad, velocity_rad_s| Point {
        position_rad,
        velocity_rad_s,
        time_from_start_ns,
        ..Point::default()
    };
    let state = ControllerState {
        reference: point(&cycle.planned_rad, &cycle.planned_rad_s),
        feedback: point(&cycle.measured_rad, &[]),
        output: Point::default(),
        speed_scaling_factor: 1.0,
    };
    log.controller_state(cycle.stamp_ns, &state)
}

/// Writes the whole plan as one trajectory that starts with the run.
pub(crate) fn write_plan<W: Write>(log: &mut LogWriter<W>, plans: &[JointPlan]) -> Result<(), WriteError> {
    let rows: Vec<(i64, [Vec<f64>; 3])> = knots_s(plans)
        .into_iter()
        .map(|t_s| {
            let planned: Vec<_> = plans.iter().map(|plan| plan.at(t_s)).collect();
            let quantities = [
                planned.iter().map(|p| p.angle_rad).collect(),
                planned.iter().map(|p| p.speed_rad_s).collect(),
                planned.iter().map(|p| p.acceleration_rad_s2).collect(),
            ];
            (nanoseconds(t_s), quantities)
        })
        .collect();
    let points: Vec<Point> = rows
        .iter()
        .map(|(time_from_start_ns, [position_rad, velocity_rad_s, acceleration_rad_s2])| Point {
            position_rad,
            velocity_rad_s,
            acceleration_rad_s2,
            effort_n_m: &[],
            time_from_start_ns: *time_from_start_ns,
        })
        .collect();
    log.trajectory(START_NS, &points)
}
