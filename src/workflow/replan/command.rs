//! The command to send for a plan: what was learnt, held to the arm's limits as a controller interpolates it.

use serde::{Deserialize, Serialize};

use super::{
    ReplanFailure,
    points::{Checked, checked, nearest},
    subject::Subject,
};
use crate::{
    fit::{
        Chance, Fit, JointFit, JointStep, Learning, Learnt, Oscillation, Room, SHARE, Step, Stop, Trial,
        learn, predict,
    },
    math::{State, range},
    plan::{BETWEEN, Limit, Margin, Setup, SpeedRoom},
    series::{JointKind, Series, Track, align},
    units::DEGREE_RAD,
};

/// Shares that are tried of a correction that breaks a limit of its joint or of the arm.
const SHARES: [f64; 6] = [0.97, 0.9, 0.75, 0.5, 0.25, 0.0];

/// Where a joint gets this share or less, smaller steps are tried as a whole: what the plan leaves of a pump or of the tool's speed
/// is dealt anew to each.
const LITTLE: f64 = 0.25;
const SMALLER: [f64; 2] = [0.5, 0.25];

/// Times that what rods, pump and tool leave is dealt anew.
const ROUNDS: usize = 4;

/// A kept correction below this is none, rad.
const NONE_RAD: f64 = 1e-5;

/// The command of one joint; of one that slides a radian stands for a metre.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct JointCommand {
    /// The joint.
    pub name: String,
    /// Whether it turns or slides.
    #[serde(default)]
    pub kind: JointKind,
    /// How its correction came about.
    pub step: Step,
    /// Periodicity of what the model leaves unexplained; null without a run of this plan.
    pub oscillation: Option<Oscillation>,
    /// Frequency above which nothing is learnt, Hz.
    pub cut_off_hz: f64,
    /// Root mean square error of each run of this plan below 1.5 Hz, rad.
    pub rms_error_rad: Vec<f64>,
    /// The part of it that comes differently each time, rad; null with fewer than two runs.
    pub spread_rad: Option<f64>,
    /// For how long the plan moves and the newest run was not measured, s: nothing is learnt there.
    #[serde(default)]
    pub unseen_s: f64,
    /// What the newest run was off by at rest, before its first motion and after its last alike, rad: not learnt; zero where the
    /// rests differ.
    #[serde(default)]
    pub shifted_rad: f64,
    /// By how much more of a correction gained nothing in some motion, rad: the smaller one is taken again there, unless the
    /// command of a whole run is kept. Zero if it did nowhere.
    #[serde(default)]
    pub stalled_rad: f64,
    /// Where the joint comes no farther, whatever is sent: a stop, a switch or a load; null where no runs tell that. Nothing is learnt
    /// beyond it.
    #[serde(default)]
    pub held: Option<Stop>,
    /// What came in one motion of the newest run alone: not learnt until it comes again; null without.
    #[serde(default)]
    pub by_chance: Option<Chance>,
    /// Predicted root mean square error of the plan sent as it is, rad; null if the fit does not know the joint.
    pub plain_rms_rad: Option<f64>,
    /// The same of the command, rad.
    pub compensated_rms_rad: Option<f64>,
    /// Largest distance of command and plan, rad.
    pub peak_correction_rad: f64,
    /// Largest distance that was allowed, rad.
    pub most_correction_rad: f64,
    /// Lowest and highest angle of the command, rad.
    pub range_rad: [f64; 2],
    /// Largest speed of the command by that of the plan; 1 for a plan at rest.
    pub speed_ratio: f64,
    /// Largest acceleration of the command by that of the plan; 1 for a plan at rest.
    pub acceleration_ratio: f64,
    /// Share of the correction that is applied.
    pub share: f64,
    /// The limit for which that is less than one.
    pub because: Option<Limit>,
}

impl JointCommand {
    /// Whether the joint is corrected; to keep the plan is no correction.
    pub fn applied(&self) -> bool {
        let made = match self.step {
            Step::None | Step::Astray => false,
            Step::Kept { .. } => self.peak_correction_rad > NONE_RAD,
            Step::Model | Step::First { .. } | Step::Later { .. } | Step::Rest { .. } => true,
        };
        made && self.share > 0.0
    }
}

/// A command, and how near it comes to the arm's limits.
#[derive(Debug, Clone, PartialEq)]
pub struct Commanded {
    /// What to send.
    pub series: Series,
    /// Its accelerations, rad/s², by track and sample.
    pub acceleration_rad_s2: Vec<Vec<f64>>,
    /// Whether these are the derivatives of its speeds: samples without their motion tell them roughly, and a controller that draws
    /// quintics through what does not fit jerks.
    pub exact: bool,
    /// One entry a joint of the plan.
    pub joints: Vec<JointCommand>,
    /// Joints that hunt; with three or more nothing is corrected.
    pub hunting: usize,
    /// The limits of the task's arm; empty without a task.
    pub margins: Vec<Margin>,
    /// Share of the usual step that was taken, and the limit that more of it would break, where that is less than one.
    pub smaller: Option<(f64, Limit)>,
}

impl Commanded {
    /// Whether it differs from the plan.
    pub fn applied(&self) -> bool {
        self.joints.iter().any(JointCommand::applied)
    }

    /// The limit that leaves a joint little of its correction.
    fn bound(&self) -> Option<Limit> {
        self.joints.iter().find(|joint| joint.share <= LITTLE)?.because
    }

    /// The shares of the corrections that are applied.
    fn sum_of_shares(&self) -> f64 {
        self.joints.iter().filter(|joint| joint.applied()).map(|joint| joint.share).sum()
    }
}

/// Where the limits are unknown and a joint reaches its own, a command leaves the range of its plan by no more than this, rad,
/// or share of the range.
const BEYOND: (f64, f64) = (2.0 * DEGREE_RAD, 0.1);

/// The range of a plan, and a little beyond it; and what was sent already.
fn near(planned: &[[f64; 4]], runs: &[Trial], name: &str) -> [f64; 2] {
    let [lowest, highest] = range(planned.iter().map(|state| state[0]));
    let beyond_rad = BEYOND.0.max(BEYOND.1 * (highest - lowest));
    let sent =
        runs.iter().filter_map(|run| run.sent.track(name)).flat_map(|track| track.position().iter().copied());
    range(sent.chain([lowest - beyond_rad, highest + beyond_rad]))
}

/// A command for a plan, by its runs and a fit: of steps of several sizes the one of which most is applied, where limits leave
/// little of the whole.
///
/// # Errors
///
/// [`ReplanFailure`] for settings out of range.
pub(super) fn commanded(
    fit: &Fit,
    subject: &Subject,
    runs: &[Trial],
    settings: Learning,
) -> Result<Commanded, ReplanFailure> {
    let mut best = of_step(fit, subject, runs, settings)?;
    let Some(limit) = best.bound().filter(|_| settings.keep.is_none() && subject.setup.is_some()) else {
        return Ok(best);
    };
    let mut most = best.sum_of_shares();
    for less in SMALLER {
        let made = of_step(fit, subject, runs, Learning { gain: less * settings.gain, ..settings })?;
        let applied = less * made.sum_of_shares();
        if applied > most {
            (best, most) = (Commanded { smaller: Some((less, limit)), ..made }, applied);
        }
    }
    Ok(best)
}

/// The command of one size of step. Limits of the joints are kept by construction; where the limits of the arm
/// as a whole or of rods are not, corrections are made smaller until they are.
///
/// # Errors
///
/// [`ReplanFailure`] for settings out of range.
fn of_step(
    fit: &Fit,
    subject: &Subject,
    runs: &[Trial],
    settings: Learning,
) -> Result<Commanded, ReplanFailure> {
    let Subject { plan, setup, points_hz, .. } = subject;
    let (planned, exact) = subject.derivatives();
    let index = |name: &str| plan.tracks.iter().position(|track| track.name() == name);
    let names = setup.map(Setup::joint_names).unwrap_or_default();
    let taught = |narrowed: &SpeedRoom| {
        let room = |name: &str| {
            let planned = planned.get(index(name)?)?.clone();
            let Some(own) = names.iter().position(|own| own == name) else {
                // A joint that only lags needs what it is sent ahead; one at its limits gains nothing by it, and of one whose
                // model does not hold nobody knows.
                let speeds_rad_s = range(planned.iter().map(|state| state[1]));
                let bound = |joint: &&JointFit| !joint.model_holds || joint.reaches_limits(speeds_rad_s);
                fit.joint(name).filter(bound)?;
                let any = [f64::NEG_INFINITY, f64::INFINITY];
                let limits = [near(&planned, runs, name), any, any, any];
                return Some(Room { limits, planned, speed_rad_s: Vec::new(), share: 1.0 });
            };
            let limits = setup.and_then(|s| s.joint_limits(own))?;
            let speed_rad_s = narrowed.get(own).cloned().unwrap_or_default();
            Some(Room { limits, planned, speed_rad_s, share: SHARE })
        };
        learn(fit, plan, runs, settings, room)
    };
    let mut learnt = taught(&SpeedRoom::new())?;
    let mut shares: Vec<(f64, Option<Limit>)> = vec![(1.0, None); plan.tracks.len()];
    let mut margins = Vec::new();
    if let Some(setup) = setup {
        let sent = |learnt: &Learnt, shares: &[(f64, Option<Limit>)]| -> Vec<Vec<State>> {
            let of = |name: &String| {
                let j = index(name)?;
                Some(states(&planned[j], &learnt.joints[j].correction, shares[j].0))
            };
            names.iter().filter_map(of).collect()
        };
        let none = vec![(0.0, None); shares.len()];
        let own = sent(&learnt, &none);
        let steps = own.iter().map(Vec::len).min().unwrap_or_default();
        let mut narrowed: SpeedRoom = vec![vec![[f64::NEG_INFINITY, f64::INFINITY]; steps]; own.len()];
        for _ in 0..ROUNDS {
            if !setup.narrow(&own, &sent(&learnt, &shares), &mut narrowed) {
                break;
            }
            learnt = taught(&narrowed)?;
        }
        // Samples without their motion tell no acceleration exactly.
        let told = |(_, margin): &(Checked, Margin)| {
            exact || !matches!(margin.limit, Limit::Acceleration | Limit::Jerk)
        };
        let checked = |sent: &[Vec<State>]| -> Vec<(Checked, Margin)> {
            checked(setup, sent, *points_hz).into_iter().filter(told).collect()
        };
        let own = checked(&own);
        let broken = |(how, margin): &&(Checked, Margin)| {
            let same = |(other, own): &&(Checked, Margin)| {
                (other, own.limit, own.joint) == (how, margin.limit, margin.joint)
            };
            let least = own.iter().find(same).map_or(0.0, |(_, own)| own.share);
            margin.share > least.max(1.0) + BETWEEN
        };
        let mut found = checked(&sent(&learnt, &shares));
        for share in SHARES {
            let worst: Vec<&Margin> = found.iter().filter(broken).map(|(_, margin)| margin).collect();
            if worst.is_empty() {
                break;
            }
            for (j, of) in shares.iter_mut().enumerate() {
                let is = |margin: &&&Margin| {
                    margin.joint.is_none_or(|k| names.get(k).is_some_and(|name| index(name) == Some(j)))
                };
                if let Some(margin) = worst.iter().find(is) {
                    *of = (share, Some(margin.limit));
                }
            }
            found = checked(&sent(&learnt, &shares));
        }
        margins = nearest(found);
    } else {
        for (j, of) in shares.iter_mut().enumerate() {
            *of = gentle_share(plan.tracks[j].kind(), &planned[j], &learnt.joints[j]);
        }
    }
    let share_of = |name: &str| index(name).map_or(1.0, |j| shares[j].0);
    let series = learnt.command(plan, share_of)?;
    let acceleration_rad_s2 = (planned.iter().zip(&learnt.joints).zip(&shares))
        .map(|((planned, joint), (share, _))| {
            planned
                .iter()
                .zip(&joint.correction)
                .map(|(planned, made)| planned[2] + share * made[2])
                .collect()
        })
        .collect();
    let joints = joints(fit, plan, &series, &planned, &learnt, &shares)?;
    let hunting = learnt.hunting;
    Ok(Commanded { series, acceleration_rad_s2, exact, joints, hunting, margins, smaller: None })
}

/// Where no limit of a joint is known, a correction accelerates it to no more than this times what its plan does, or to this,
/// rad/s² and m/s²: slow plans start over a dead band with more than theirs.
pub(super) const SHARPEST: f64 = 4.0;
pub(super) const fn gentle(kind: JointKind) -> f64 {
    match kind {
        JointKind::Turns => 30.0 * DEGREE_RAD,
        JointKind::Slides => 0.3,
    }
}

/// The share of a correction that keeps to that; what was sent before came without harm.
fn gentle_share(kind: JointKind, planned: &[[f64; 4]], made: &JointStep) -> (f64, Option<Limit>) {
    let peak = |share: f64| {
        let both = planned.iter().zip(&made.correction);
        both.fold(0.0_f64, |most, (state, made)| most.max((state[2] + share * made[2]).abs()))
    };
    let most = (SHARPEST * peak(0.0)).max(gentle(kind));
    if matches!(made.step, Step::Kept { .. }) || peak(1.0) <= most {
        return (1.0, None);
    }
    let share = SHARES.into_iter().find(|share| peak(*share) <= most).unwrap_or(0.0);
    (share, Some(Limit::Acceleration))
}

fn states(planned: &[[f64; 4]], correction: &[[f64; 3]], share: f64) -> Vec<State> {
    let one = |(planned, made): (&[f64; 4], &[f64; 3])| State {
        position: planned[0] + share * made[0],
        velocity: planned[1] + share * made[1],
        acceleration: planned[2] + share * made[2],
    };
    planned.iter().zip(correction).map(one).collect()
}

/// What is said of each joint.
fn joints(
    fit: &Fit,
    plan: &Series,
    sent: &Series,
    planned: &[Vec<[f64; 4]>],
    learnt: &Learnt,
    shares: &[(f64, Option<Limit>)],
) -> Result<Vec<JointCommand>, ReplanFailure> {
    let mut joints = Vec::with_capacity(learnt.joints.len());
    for (((made, planned), (share, because)), (track, sent)) in
        learnt.joints.iter().zip(planned).zip(shares).zip(plan.tracks.iter().zip(&sent.tracks))
    {
        let rms_rad = |sent: &Track| -> Result<Option<f64>, ReplanFailure> {
            let Some(joint) = fit.joint(&made.name) else { return Ok(None) };
            let response = predict(&joint.model, sent)?;
            let squares = align(track, &response).map_or(0.0, |pair| {
                let errors = pair.planned.iter().zip(&pair.measured).map(|(p, m)| (p - m).powi(2));
                errors.sum::<f64>() / pair.planned.len().max(1) as f64
            });
            Ok(Some(squares.sqrt()))
        };
        let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0_f64, |most, x| most.max(x.abs()));
        let ratio = |derivative: usize| {
            let plain = most(&mut planned.iter().map(|state| state[derivative]));
            let both = planned.iter().zip(&made.correction);
            let now = most(&mut both.map(|(state, made)| state[derivative] + share * made[derivative]));
            if plain > 0.0 { now / plain } else { 1.0 }
        };
        let [least, highest] = range(sent.position().iter().copied());
        joints.push(JointCommand {
            name: made.name.clone(),
            kind: track.kind(),
            step: made.step,
            oscillation: made.oscillation,
            cut_off_hz: made.cut_off_hz,
            rms_error_rad: made.rms_error_rad.clone(),
            spread_rad: made.spread_rad,
            unseen_s: made.unseen_s,
            shifted_rad: made.shifted_rad,
            stalled_rad: most(&mut made.stalled.iter().map(|held| held.more_rad)),
            held: made.stop,
            by_chance: made.chance,
            plain_rms_rad: rms_rad(track)?,
            compensated_rms_rad: rms_rad(sent)?,
            peak_correction_rad: share * most(&mut made.correction.iter().map(|made| made[0])),
            most_correction_rad: made.most_rad,
            range_rad: [least, highest],
            speed_ratio: ratio(1),
            acceleration_ratio: ratio(2),
            share: *share,
            because: *because,
        });
    }
    Ok(joints)
}
