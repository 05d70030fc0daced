//! A plan given by samples as a log, with the command to send beside it.

use std::collections::BTreeMap;

use super::{
    arm_log::ArmLog,
    plan_log::PROVENANCE,
    stamp::{START_NS, TRAJECTORY_HZ, instants},
};
use crate::{
    arm::Chain,
    log::{Attachment, LogWriter, Point, Role, Topics, WriteError, WriteOptions},
    math::State,
    series::{Series, Track},
    units::nanoseconds,
};

/// What to write. Times of all tracks count from the start of the log.
#[derive(Debug, Clone, Copy)]
pub struct SeriesLog<'a> {
    /// Where the joints should be.
    pub plan: &'a Series,
    /// What to send, where that is not the plan; of the same joints.
    pub command: Option<&'a Series>,
    /// The arm of these joints, where it is known.
    pub arm: Option<&'a Chain>,
    /// Where it comes from.
    pub provenance: &'a BTreeMap<String, String>,
    /// Topic of what to send as a trajectory; `None`: ours.
    pub trajectory: Option<&'a str>,
    /// Files to go with it.
    pub files: &'a [Attachment],
    /// Samples a second.
    pub rate_hz: f64,
}

impl SeriesLog<'_> {
    /// The bytes of the log: plan and command sample by sample, and what to send as a trajectory.
    ///
    /// # Errors
    ///
    /// [`WriteError`] for joint names that no log can hold.
    pub fn bytes(&self) -> Result<Vec<u8>, WriteError> {
        let names: Vec<&str> = self.plan.tracks.iter().map(Track::name).collect();
        let ours = Topics::default();
        let trajectory = self.trajectory.map_or_else(|| ours.trajectory.clone(), str::to_owned);
        let options = WriteOptions { topics: Topics { trajectory, ..ours }, ..WriteOptions::default() };
        let mut log = LogWriter::new(Vec::new(), &names, options)?;
        log.metadata(PROVENANCE, self.provenance)?;
        let mut arm = match self.arm {
            Some(chain) => ArmLog::begin(&mut log, chain, &names, START_NS, false)?,
            None => None,
        };
        let end_s = self.plan.tracks.iter().filter_map(|t| t.t_s().last()).fold(0.0, |a: f64, b| a.max(*b));
        let sent = self.command.unwrap_or(self.plan);
        let points: Vec<(f64, [Vec<f64>; 2])> =
            instants(end_s, TRAJECTORY_HZ).map(|t_s| (t_s, states(sent, &names, t_s))).collect();
        let points: Vec<Point<'_>> = points
            .iter()
            .map(|(t_s, [position_rad, velocity_rad_s])| Point {
                position_rad,
                velocity_rad_s,
                acceleration_rad_s2: &[],
                effort_n_m: &[],
                time_from_start_ns: nanoseconds(*t_s),
            })
            .collect();
        log.trajectory_to_send(START_NS, &points)?;
        for t_s in instants(end_s, self.rate_hz) {
            let stamp_ns = START_NS + nanoseconds(t_s);
            let [position_rad, velocity_rad_s] = states(self.plan, &names, t_s);
            log.joint_sample(Role::Planned, stamp_ns, &position_rad, &velocity_rad_s, &[])?;
            if let Some(arm) = &mut arm {
                arm.sample(&mut log, stamp_ns, &position_rad, None)?;
            }
            if let Some(command) = self.command {
                let [position_rad, velocity_rad_s] = states(command, &names, t_s);
                log.joint_sample(Role::Command, stamp_ns, &position_rad, &velocity_rad_s, &[])?;
            }
        }
        for file in self.files {
            log.attach(&file.name, &file.media_type, &file.data, START_NS)?;
        }
        log.finish()
    }
}

/// Positions, rad, and speeds, rad/s, of some joints at an instant; NaN of one that the series lacks.
pub(in crate::workflow) fn states(series: &Series, names: &[&str], t_s: f64) -> [Vec<f64>; 2] {
    let unknown = State { position: f64::NAN, velocity: f64::NAN, acceleration: 0.0 };
    let at = |name: &&str| series.track(name).map_or(unknown, |track| track.held_at(t_s));
    let (position_rad, velocity_rad_s) =
        names.iter().map(at).map(|state| (state.position, state.velocity)).unzip();
    [position_rad, velocity_rad_s]
}
