//! `simulate`: the log of a simulated hydraulic arm that runs a command.

pub mod log;

use super::carried::{Carried, arm_log::ArmLog, stamp::START_NS, write_truth};
use crate::{
    arm::Chain,
    log::{LogWriter, Role, WriteError, WriteOptions},
    math::range,
    plant::{JointRecord, PayloadChange, Plant, PlantError, Record, Truth, simulate},
    series::{Series, Track},
    units::nanoseconds,
};

/// Stands for a sample that is not there.
const UNKNOWN: (f64, f64) = (f64::NAN, f64::NAN);

/// What to run on which machine.
#[derive(Debug, Clone)]
pub struct Inputs {
    /// The machine.
    pub plant: Plant,
    /// Where the joints should be.
    pub plan: Series,
    /// Command to the machine: the plan, or the plan corrected for the machine. Both with speeds, from time 0 on.
    pub command: Series,
    /// Payloads with their times.
    pub payload: Vec<PayloadChange>,
    /// Seed of noise, jitter and losses.
    pub seed: u64,
}

/// A simulated run.
#[derive(Debug, Clone, PartialEq)]
pub struct Outputs {
    /// The run.
    pub record: Record,
    /// Plan by joint and sample of the record: angle, rad, and speed, rad/s.
    pub planned: Vec<Vec<(f64, f64)>>,
    /// Command by joint and sample of the record: angle, rad, and speed, rad/s.
    pub command: Vec<Vec<(f64, f64)>>,
    /// True parameters at the middle of the plan's angles, without payload.
    pub truth: Truth,
}

/// How much of a run its log holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// Plan, command and measurement of the joints.
    Joints,
    /// Pressures, signals to the valves and spools too.
    Everything,
}

/// Runs the command.
///
/// # Errors
///
/// [`PlantError`], as [`simulate`]; a plan without one of the machine's joints counts as a command
/// without it.
pub fn run(inputs: &Inputs) -> Result<Outputs, PlantError> {
    let Inputs { plant, plan, command, payload, seed } = inputs;
    let record = simulate(plant, command, payload, *seed)?;
    let laid = |series: &Series| -> Result<Vec<Vec<(f64, f64)>>, PlantError> {
        let of = |name: &str| {
            let missing = || PlantError::NoCommand { joint: name.to_owned(), what: "track" };
            series.track(name).map(|track| at(track, &record.t_s)).ok_or_else(missing)
        };
        plant.joints().map(of).collect()
    };
    let (planned, command) = (laid(plan)?, laid(command)?);
    let middle = |samples: &Vec<(f64, f64)>| {
        let [least, most] = range(samples.iter().map(|(q, _)| *q));
        0.5 * (least + most)
    };
    let pose_rad: Vec<f64> = planned.iter().map(middle).collect();
    let truth = plant.truth(&pose_rad, 0.0)?;
    Ok(Outputs { record, planned, command, truth })
}

/// A track at some instants; it holds its angle where it says nothing.
fn at(track: &Track, t_s: &[f64]) -> Vec<(f64, f64)> {
    t_s.iter().map(|&t_s| track.held_at(t_s)).map(|state| (state.position, state.velocity)).collect()
}

impl Outputs {
    /// The run as an MCAP log of ROS 2 messages: plan, command and measurement as joint states, the arm for tools
    /// that draw it, the truth as metadata, and what the plan's log carried.
    ///
    /// # Errors
    ///
    /// [`WriteError`] for joint names that no log can hold.
    pub fn log(
        &self,
        carried: &Carried,
        chain: Option<&Chain>,
        content: Content,
        options: WriteOptions,
    ) -> Result<Vec<u8>, WriteError> {
        let names: Vec<&str> = self.record.joints.iter().map(|joint| joint.name.as_str()).collect();
        let mut log = LogWriter::new(Vec::new(), &names, options)?;
        write_truth(&mut log, &self.truth)?;
        carried.begin(&mut log)?;
        let mut arm = match chain {
            Some(chain) => ArmLog::begin(&mut log, chain, &names, START_NS, true)?,
            None => None,
        };
        let joints = &self.record.joints;
        for (k, t_s) in self.record.t_s.iter().enumerate() {
            let stamp_ns = START_NS + nanoseconds(*t_s);
            let side = |samples: &[Vec<(f64, f64)>]| -> (Vec<f64>, Vec<f64>) {
                samples.iter().map(|samples| samples.get(k).copied().unwrap_or(UNKNOWN)).unzip()
            };
            let column = |of: fn(&JointRecord) -> &Vec<f64>| -> Vec<f64> {
                joints.iter().map(|joint| of(joint).get(k).copied().unwrap_or(f64::NAN)).collect()
            };
            let (planned_rad, speed_rad_s) = side(&self.planned);
            log.joint_sample(Role::Planned, stamp_ns, &planned_rad, &speed_rad_s, &[])?;
            let (angle_rad, speed_rad_s) = side(&self.command);
            log.joint_sample(Role::Command, stamp_ns, &angle_rad, &speed_rad_s, &[])?;
            let (angle_rad, speed_rad_s) = (column(|j| &j.measured_rad), column(|j| &j.measured_rad_s));
            log.joint_sample(Role::Measured, stamp_ns, &angle_rad, &speed_rad_s, &[])?;
            if let Some(arm) = &mut arm {
                let error_rad: Vec<f64> = planned_rad.iter().zip(&angle_rad).map(|(p, m)| p - m).collect();
                log.tracking_error(stamp_ns, &error_rad)?;
                arm.sample(&mut log, stamp_ns, &planned_rad, Some(&angle_rad))?;
            }
            if content == Content::Joints {
                continue;
            }
            let supply_pa = self.record.supply_pa.get(k).copied().unwrap_or(f64::NAN);
            log.interfaces(
                stamp_ns,
                &[
                    ("cap_pressure_pa", &column(|j| &j.cap_pressure_pa)),
                    ("rod_pressure_pa", &column(|j| &j.rod_pressure_pa)),
                    ("supply_pressure_pa", &vec![supply_pa; joints.len()]),
                    ("valve_command", &column(|j| &j.valve_command)),
                    ("spool", &column(|j| &j.spool)),
                ],
            )?;
        }
        carried.end(&mut log, START_NS)?;
        log.finish()
    }
}
