//! The log of a plan, for any MCAP tool: plan and command sample by sample, what to send as a trajectory, the arm, and
//! what our logs carry.

use super::{
    Carried,
    arm_log::ArmLog,
    stamp::{START_NS, instants},
};
use crate::{
    arm::Chain,
    log::{LogWriter, Point, Role, Topics, WriteError, WriteOptions},
    math::{State, quintic},
    series::{Series, Track},
    spline::{Motion, Quantity, Samples},
    units::nanoseconds,
};

/// Rates of samples and of points, Hz, and how many of them a log holds at most.
const RATES_HZ: [f64; 2] = [1.0, 10_000.0];
const MOST_SAMPLES: f64 = 1e7;

/// Where joints should be over time, from 0 on.
#[derive(Debug, Clone, Copy)]
pub enum Planned<'a> {
    /// A motion of joints of these names; its accelerations are known.
    Motion(&'a Motion, &'a [String]),
    /// Samples.
    Series(&'a Series),
}

/// What to send in place of a plan.
#[derive(Debug, Clone, Copy)]
pub struct Command<'a> {
    /// Samples, of the plan's joints.
    pub series: &'a Series,
    /// Accelerations at these samples, rad/s², by track; none if they are not known.
    pub acceleration_rad_s2: &'a [Vec<f64>],
}

/// What to write.
#[derive(Debug, Clone, Copy)]
pub struct PlanLog<'a> {
    /// Where the joints should be.
    pub plan: Planned<'a>,
    /// What to send, if that is not the plan; of the same joints.
    pub command: Option<Command<'a>>,
    /// The arm of these joints, if it is known.
    pub arm: Option<&'a Chain>,
    /// Topic of what to send as a trajectory; `None`: ours.
    pub trajectory: Option<&'a str>,
    /// Task, plan and provenance.
    pub carried: &'a Carried,
    /// Samples a second.
    pub rate_hz: f64,
    /// Points a second of the trajectory to send.
    pub points_hz: f64,
}

impl PlanLog<'_> {
    /// The bytes of the log.
    ///
    /// # Errors
    ///
    /// [`WriteError`] for joint names that no log can hold, a rate that is not from 1 to 10 000 Hz, or a plan of more than ten
    /// million samples.
    pub fn bytes(&self) -> Result<Vec<u8>, WriteError> {
        let [least, most] = RATES_HZ;
        for found in [self.rate_hz, self.points_hz] {
            if !(least..=most).contains(&found) {
                return Err(WriteError::Rate { found, least, most });
            }
        }
        let (duration_s, rate_hz) = (self.plan.end_s(), self.rate_hz.max(self.points_hz));
        if duration_s.is_nan() || duration_s * rate_hz > MOST_SAMPLES {
            return Err(WriteError::TooLong { duration_s, rate_hz, most: MOST_SAMPLES });
        }
        let names = self.plan.names();
        let ours = Topics::default();
        let trajectory = self.trajectory.map_or_else(|| ours.trajectory.clone(), str::to_owned);
        let options = WriteOptions { topics: Topics { trajectory, ..ours }, ..WriteOptions::default() };
        let mut log = LogWriter::new(Vec::new(), &names, options)?;
        let mut carried = self.carried.clone();
        match (self.plan, self.arm) {
            (Planned::Series(series), _) => carried = carried.with_kinds_of(series.tracks.iter()),
            (Planned::Motion(..), Some(chain)) => carried = carried.with_kinds_of_arm(chain),
            (Planned::Motion(..), None) => {}
        }
        carried.begin(&mut log)?;
        let mut arm = match self.arm {
            Some(chain) => ArmLog::begin(&mut log, chain, &names, START_NS, false)?,
            None => None,
        };
        log.trajectory_to_send(START_NS, &self.to_send().points().collect::<Vec<_>>())?;
        let fine_s: Vec<f64> = instants(self.plan.end_s(), self.rate_hz).collect();
        let command = self.command.map(|command| command.states(&names, fine_s.clone()));
        let mut commanded = command.as_ref().map(States::points);
        for point in self.plan.states(&names, fine_s).points() {
            let stamp_ns = START_NS + point.time_from_start_ns;
            log.joint_sample(Role::Planned, stamp_ns, point.position_rad, point.velocity_rad_s, &[])?;
            if let Some(arm) = &mut arm {
                arm.sample(&mut log, stamp_ns, point.position_rad, None)?;
            }
            if let Some(point) = commanded.as_mut().and_then(Iterator::next) {
                log.joint_sample(Role::Command, stamp_ns, point.position_rad, point.velocity_rad_s, &[])?;
            }
        }
        carried.end(&mut log, START_NS)?;
        log.finish()
    }

    /// The trajectory to send: the command, or the plan without one.
    pub(in crate::workflow) fn to_send(self) -> States {
        let (names, t_s) = (self.plan.names(), instants(self.plan.end_s(), self.points_hz).collect());
        match &self.command {
            Some(command) => command.states(&names, t_s),
            None => self.plan.states(&names, t_s),
        }
    }
}

impl Planned<'_> {
    fn names(&self) -> Vec<&str> {
        match self {
            Self::Motion(_, joints) => joints.iter().map(String::as_str).collect(),
            Self::Series(series) => series.tracks.iter().map(Track::name).collect(),
        }
    }

    fn end_s(&self) -> f64 {
        match self {
            Self::Motion(motion, _) => motion.duration_s(),
            Self::Series(series) => series.span_s().map_or(0.0, |[_, end_s]| end_s.max(0.0)),
        }
    }

    fn states(&self, names: &[&str], t_s: Vec<f64>) -> States {
        match self {
            Self::Motion(motion, _) => {
                let (joints, mut samples) = (motion.joints(), Samples::default());
                motion.sample(&t_s, Quantity::Acceleration, &mut samples);
                let of = |quantity| {
                    let at = |i: usize| (0..joints).map(move |joint| (joint, i));
                    (0..t_s.len()).flat_map(at).map(|(joint, i)| samples.of(quantity, joint)[i]).collect()
                };
                let values = [of(Quantity::Position), of(Quantity::Velocity), of(Quantity::Acceleration)];
                States { t_s, joints, values }
            }
            Self::Series(series) => {
                let (mut position, mut velocity) = (Vec::new(), Vec::new());
                for t_s in &t_s {
                    let [positions, velocities] = states(series, names, *t_s);
                    position.extend(positions);
                    velocity.extend(velocities);
                }
                States { t_s, joints: names.len(), values: [position, velocity, Vec::new()] }
            }
        }
    }
}

impl Command<'_> {
    /// Accelerations only where all of the instants are samples, or between two whose accelerations are known.
    fn states(&self, names: &[&str], t_s: Vec<f64>) -> States {
        let mut found = Planned::Series(self.series).states(names, t_s);
        let all = found.t_s.iter().flat_map(|t_s| names.iter().map(|name| self.at(name, *t_s)));
        let Some(states) = all.collect::<Option<Vec<State>>>() else { return found };
        found.values = [
            states.iter().map(|state| state.position).collect(),
            states.iter().map(|state| state.velocity).collect(),
            states.iter().map(|state| state.acceleration).collect(),
        ];
        found
    }

    /// At a sample as it is, between two by the curve that meets both.
    fn at(&self, name: &str, t_s: f64) -> Option<State> {
        const SAME_S: f64 = 1e-6;
        let joint = self.series.tracks.iter().position(|track| track.name() == name)?;
        let track = self.series.tracks.get(joint)?;
        let state = |sample: usize| {
            let acceleration = *self.acceleration_rad_s2.get(joint)?.get(sample)?;
            Some(State { acceleration, ..track.held_at(*track.t_s().get(sample)?) })
        };
        let next = track.t_s().partition_point(|stamp| *stamp < t_s - SAME_S);
        let next_s = *track.t_s().get(next)?;
        if (next_s - t_s).abs() < SAME_S {
            return state(next);
        }
        let before_s = *track.t_s().get(next.checked_sub(1)?)?;
        Some(quintic(state(next - 1)?, state(next)?, next_s - before_s, t_s - before_s))
    }
}

/// States, instant by instant.
pub(in crate::workflow) struct States {
    t_s: Vec<f64>,
    joints: usize,
    /// Position, velocity and, if it is known, acceleration, each `[instant][joint]`.
    values: [Vec<f64>; 3],
}

impl States {
    pub(in crate::workflow) fn points(&self) -> impl Iterator<Item = Point<'_>> {
        self.t_s.iter().enumerate().map(|(i, t_s)| {
            let of = |values: &'_ Vec<f64>| -> std::ops::Range<usize> {
                let first = (i * self.joints).min(values.len());
                first..(first + self.joints).min(values.len())
            };
            let [position, velocity, acceleration] = &self.values;
            Point {
                position_rad: &position[of(position)],
                velocity_rad_s: &velocity[of(velocity)],
                acceleration_rad_s2: &acceleration[of(acceleration)],
                effort_n_m: &[],
                time_from_start_ns: nanoseconds(*t_s),
            }
        })
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
