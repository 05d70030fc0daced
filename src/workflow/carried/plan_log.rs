//! A plan as a log that any MCAP tool opens: the trajectory, the plan sample by sample, the task and
//! the front as files within, and where it comes from.

use std::collections::BTreeMap;

use super::{
    arm_log::ArmLog,
    stamp::{START_NS, TRAJECTORY_HZ, instants},
};
use crate::{
    log::{LogWriter, Point, Role, WriteError, WriteOptions},
    plan::Setup,
    spline::{Motion, Quantity, Samples},
    units::nanoseconds,
};

/// Name of the attached task.
pub const TASK: &str = "task.toml";
/// Name of an attached task of which only the arm counts: what the log holds does another thing.
pub const ARM: &str = "arm.toml";
/// Name of the attached front.
pub const FRONT: &str = "plan.json";
/// Name of the metadata that say where a plan comes from.
pub const PROVENANCE: &str = "hydrotrace.plan";

/// Key of the provenance that says when the times of the plan count from, s since the start of the log; 0 without.
pub const STARTS: &str = "starts_s";

/// Arrivals of the chosen plan in the document of a plan, s.
pub fn chosen_times_s(document: &[u8]) -> Option<Vec<f64>> {
    let document: serde_json::Value = serde_json::from_slice(document).ok()?;
    document["chosen"]["times_s"].as_array()?.iter().map(serde_json::Value::as_f64).collect()
}

/// What to write.
#[derive(Debug, Clone)]
pub struct PlanLog<'a> {
    /// The task on its arm.
    pub setup: &'a Setup,
    /// Text of the task file.
    pub task: &'a str,
    /// The document on plan and front, JSON.
    pub document: &'a str,
    /// Where it comes from.
    pub provenance: &'a BTreeMap<String, String>,
    /// The motion.
    pub motion: &'a Motion,
    /// Samples a second.
    pub rate_hz: f64,
}

impl PlanLog<'_> {
    /// The bytes of the log.
    ///
    /// # Errors
    ///
    /// [`WriteError`] for joint names that no log can hold.
    pub fn bytes(&self) -> Result<Vec<u8>, WriteError> {
        let joints = self.setup.joint_names();
        let joints: Vec<&str> = joints.iter().map(String::as_str).collect();
        let mut log = LogWriter::new(Vec::new(), &joints, WriteOptions::default())?;
        log.metadata(PROVENANCE, self.provenance)?;
        let mut arm = ArmLog::begin(&mut log, &self.setup.arm().chain, &joints, START_NS, false)?;
        let coarse = States::of(self.motion, instants(self.motion.duration_s(), TRAJECTORY_HZ).collect());
        log.trajectory_to_send(START_NS, &coarse.points().collect::<Vec<_>>())?;
        let fine = States::of(self.motion, instants(self.motion.duration_s(), self.rate_hz).collect());
        for point in fine.points() {
            let stamp_ns = START_NS + point.time_from_start_ns;
            log.joint_sample(Role::Planned, stamp_ns, point.position_rad, point.velocity_rad_s, &[])?;
            if let Some(arm) = &mut arm {
                arm.sample(&mut log, stamp_ns, point.position_rad, None)?;
            }
        }
        log.attach(TASK, "application/toml", self.task.as_bytes(), START_NS)?;
        log.attach(FRONT, "application/json", self.document.as_bytes(), START_NS)?;
        log.finish()
    }
}

/// States of a motion, instant by instant.
struct States {
    t_s: Vec<f64>,
    joints: usize,
    /// Position, velocity and acceleration, each `[instant][joint]`.
    values: [Vec<f64>; 3],
}

impl States {
    fn of(motion: &Motion, t_s: Vec<f64>) -> Self {
        let (joints, mut samples) = (motion.joints(), Samples::default());
        motion.sample(&t_s, Quantity::Acceleration, &mut samples);
        let values = [Quantity::Position, Quantity::Velocity, Quantity::Acceleration].map(|quantity| {
            let at = |i: usize| (0..joints).map(move |joint| (joint, i));
            (0..t_s.len()).flat_map(at).map(|(joint, i)| samples.of(quantity, joint)[i]).collect()
        });
        Self { t_s, joints, values }
    }

    fn points(&self) -> impl Iterator<Item = Point<'_>> {
        self.t_s.iter().enumerate().map(|(i, t_s)| {
            let own = i * self.joints..(i + 1) * self.joints;
            let [position, velocity, acceleration] = &self.values;
            Point {
                position_rad: &position[own.clone()],
                velocity_rad_s: &velocity[own.clone()],
                acceleration_rad_s2: &acceleration[own.clone()],
                effort_n_m: &[],
                time_from_start_ns: nanoseconds(*t_s),
            }
        })
    }
}
