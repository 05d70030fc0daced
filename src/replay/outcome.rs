//! What a replay found. Field names are those of the report's document.
//!
//! Positions, errors and speeds of a joint are in its unit: rad and rad/s if it turns, m and m/s if it slides.

use serde::{Deserialize, Serialize};

use super::{Concentration, DirectionDelay, RestDrift, Rules};
use crate::series::{JointKind, Noise};

/// Analysis of one run; error is planned minus measured throughout.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Replay {
    /// Thresholds and windows used.
    pub rules: Rules,
    /// One entry a joint, in the order given.
    pub joints: Vec<JointReplay>,
    /// Planned starts and reversals, by joint, then time.
    pub transitions: Vec<Transition>,
    /// Dynamic-to-static events, by joint, then time.
    pub stops: Vec<Stop>,
    /// All joints together.
    pub whole_run: WholeRun,
    /// Of an arm of which some joints turn and some slide, those of each kind together; else empty.
    pub of_kinds: Vec<KindRun>,
}

impl Replay {
    /// The kind in whose unit means over its joints are told.
    pub fn common_kind(&self) -> JointKind {
        JointKind::common(self.joints.iter().map(|joint| joint.kind))
    }

    /// Whether the joints turn or slide: the first one's kind, for figures of all exist only if they are alike.
    pub fn kind(&self) -> JointKind {
        self.joints.first().map_or(JointKind::Turns, |joint| joint.kind)
    }

    /// The joints together, each kind for itself where they have no unit in common.
    pub fn together(&self) -> Vec<(JointKind, &WholeRun)> {
        if self.of_kinds.is_empty() {
            return vec![(self.kind(), &self.whole_run)];
        }
        self.of_kinds.iter().map(|of| (of.kind, &of.run)).collect()
    }

    /// The joints together that have a unit in common with one of a kind.
    pub fn together_with(&self, kind: JointKind) -> &WholeRun {
        self.of_kinds.iter().find(|of| of.kind == kind).map_or(&self.whole_run, |of| &of.run)
    }

    /// Peak errors of the transitions, rad; a metre of a joint that slides counts as a radian.
    pub fn peaks_rad(&self) -> impl Iterator<Item = f64> {
        self.transitions.iter().map(|transition| transition.peak_error)
    }

    /// Their mean; `None` without any.
    pub(crate) fn mean_peak_rad(&self) -> Option<f64> {
        let count = self.transitions.len();
        (count > 0).then(|| self.peaks_rad().sum::<f64>() / count as f64)
    }

    /// The joints, the one with the largest error first, compared as transitions are.
    pub fn joints_worst_first(&self) -> Vec<&JointReplay> {
        let bands =
            |joint: &JointReplay| joint.tracking_error.peak / self.rules.sizes(joint.kind).settle_band;
        let mut worst: Vec<&JointReplay> = self.joints.iter().collect();
        worst.sort_by(|a, b| bands(b).total_cmp(&bands(a)));
        worst
    }

    /// The longest dead time of the starts of a joint, s; `None` where none is timed.
    pub fn longest_delay_s(&self, joint: &str) -> Option<f64> {
        let own = self.transitions.iter().filter(|start| start.joint == joint);
        own.filter_map(|start| start.onset_delay_s).reduce(f64::max)
    }

    /// The transitions, the worst first. Joints that turn and joints that slide have no unit in common: peak errors are
    /// compared by the error band of settling, [`Sizes::settle_band`](super::Sizes::settle_band).
    pub fn worst_first(&self) -> Vec<&Transition> {
        let bands = |transition: &Transition| self.rules.bands(transition.joint_kind, transition.peak_error);
        let mut worst: Vec<&Transition> = self.transitions.iter().collect();
        worst.sort_by(|a, b| bands(b).total_cmp(&bands(a)));
        worst
    }
}

/// One joint over the whole run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct JointReplay {
    /// The joint.
    pub name: String,
    /// The unit of its position: "rad" or "m".
    #[serde(rename = "unit", with = "super::unit")]
    #[cfg_attr(test, schemars(with = "String"))]
    pub kind: JointKind,
    /// Whether the measured position changes: it answers a planned start, or one of its motions travels
    /// [`Sizes::moves_travel`](super::Sizes::moves_travel).
    pub moves: bool,
    /// Whether the plan moves.
    pub plan_moves: bool,
    /// Planned minus measured at the same instant, over the whole run.
    pub tracking_error: TrackingError,
    /// The same while the plan has been at rest for a while; `None` if it never is.
    pub standstill_error: Option<TrackingError>,
    /// How fast it moves meanwhile; `None` where no rest is long enough.
    pub rest_drift: Option<RestDrift>,
    /// Whether it leaves later in one direction; `None` with fewer than three timed starts in either.
    pub direction_delay: Option<DirectionDelay>,
    /// This joint's share of the distance to the planned path, ignoring time.
    pub path_error: Option<PathError>,
    /// Time shift at the maximum of the speed correlation, s; positive if the joint is late.
    pub lag_s: Option<f64>,
    /// Correlation of planned and measured speed at that shift.
    pub lag_correlation: Option<f64>,
    /// 95 % interval of the lag from its spread over single motions, s; needs three of them.
    pub lag_interval_s: Option<[f64; 2]>,
    /// Number of motions behind the interval.
    pub lag_motions: usize,
    /// How much of its error that lag explains; `None` where there is no lag.
    pub lag_share: Option<LagShare>,
    /// Largest measured speed, over whole windows of the velocity fit.
    pub peak_speed: Option<f64>,
    /// Largest measured acceleration, likewise, in the joint's unit a second squared.
    pub peak_acceleration: Option<f64>,
    /// Noise of the measured position.
    pub noise: Noise,
    /// Median time between samples, s: nothing in time is known better than this.
    pub sample_interval_s: f64,
    /// Detector settings that resulted from noise and sampling.
    pub thresholds: Thresholds,
    /// Planned starts, reversals included.
    pub starts: usize,
    /// Planned reversals.
    pub reversals: usize,
    /// Planned stops.
    pub stops: usize,
    /// Planned starts that the joint does not answer.
    pub unanswered_starts: usize,
    /// Planned starts that the joint may have answered, at an instant that cannot be told.
    pub undated_starts: usize,
    /// Measured starts without a planned start.
    pub unplanned_starts: usize,
    /// Planned motions that may have left rest where a stretch after a gap begins, and whose starts are not seen.
    #[serde(default)]
    pub edge_starts: usize,
}

/// How much of the squared error is gone when the plan is shifted by the lag.
///
/// The lag is that of the speeds, so a late start that is caught up with, or an offset, is not taken for one. The
/// rest before the next motion counts with the motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct LagShare {
    /// Share; 0 where the shift makes the error no smaller.
    pub share: f64,
    /// 95 % interval from its spread over events, the lag taken as known; needs three of them.
    pub interval: Option<[f64; 2]>,
    /// Planned motions; over joints, those that begin within [`Rules::same_event_s`] are one.
    pub events: usize,
    /// Whether the share reaches [`Rules::mostly_lag_share`].
    pub mostly: bool,
}

/// Detector settings of one joint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Thresholds {
    /// Speed above which the plan starts.
    pub planned_start: f64,
    /// Speed below which the plan rests.
    pub planned_stop: f64,
    /// Speed above which the joint starts, median over samples.
    pub measured_start: f64,
    /// Speed below which the joint rests, median over samples.
    pub measured_stop: f64,
    /// Half window of the velocity fit, s.
    pub window_s: f64,
}

/// Statistics of the error at equal instants, each sample weighted with the time it stands for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TrackingError {
    /// Root mean square.
    pub rms: f64,
    /// Mean magnitude.
    pub mean_abs: f64,
    /// Largest magnitude.
    pub peak: f64,
    /// When that was, s.
    pub peak_time_s: f64,
    /// When it first reached half of that, s; zero in documents of older versions.
    #[serde(default)]
    pub half_peak_time_s: f64,
    /// 95 % of the time the magnitude is below this.
    pub p95: f64,
    /// Mean with its sign.
    pub bias: f64,
    /// Number of samples.
    pub samples: usize,
    /// Time they stand for, s.
    pub duration_s: f64,
}

/// Distance from measured joint vectors to the planned joint path: of one joint its component, of all the
/// Euclidean norm over joints, which is larger than any of them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PathError {
    /// Root mean square.
    pub rms: f64,
    /// Largest.
    pub peak: f64,
    /// Root mean square of the same distance to where the plan is at the same instant.
    pub timed_rms: f64,
    /// Number of measured joint vectors compared.
    pub samples: usize,
    /// Time between them, s.
    pub sample_interval_s: f64,
}

/// From rest, or out of the opposite motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Static-to-dynamic.
    #[default]
    Start,
    /// Dynamic to dynamic with the opposite sign.
    Reversal,
}

/// How the onsets of a transition were found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum OnsetMethod {
    /// From rest: where a curve that rests and then rises, fitted to the angle, passes the speed
    /// threshold at which the plan's onset is taken.
    #[default]
    Fit,
    /// Out of the opposite motion: where both speeds cross the measured stop threshold.
    Crossing,
}

/// What became of a planned start.
///
/// Only [`Answer::Never`] is a start without an answer: it alone counts as such and breaks limits on the delay.
/// In ascending order of what it costs to know less.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Answer {
    /// A measured start answers it, and its instant is known.
    #[default]
    Timed,
    /// Too small by plan, or too soon followed by the next start, to tell whether the joint follows; or the samples are so far apart that
    /// its instant could be any.
    Unclear,
    /// The joint follows, but crept into the motion or was under way: there is no instant at which it left rest.
    Creeps,
    /// The joint does not follow: within the window it covers less than [`Rules::follow_share`] of the planned travel.
    Never,
}

/// One planned start or reversal and how the joint answered; a row of [`TRANSITION`](super::TRANSITION) reads each field.
///
/// The error is planned minus measured; "signed along the motion" is that times the direction,
/// so positive means that the joint is behind.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Transition {
    /// The joint.
    pub joint: String,
    /// The unit of its position: "rad" or "m".
    #[serde(rename = "unit", with = "super::unit")]
    #[cfg_attr(test, schemars(with = "String"))]
    pub joint_kind: JointKind,
    /// Its place among the planned starts of the joint, from 1, in order of time.
    pub index: usize,
    /// Joint and planned onset, which no setting of the measurement changes.
    pub id: String,
    /// From rest or not.
    pub kind: Kind,
    /// Sign of the planned motion, +1 or -1.
    pub direction: i8,
    /// When the plan starts, s.
    pub planned_onset_s: f64,
    /// What became of it.
    pub answer: Answer,
    /// When the joint starts, s; `None` unless the answer is timed.
    pub measured_onset_s: Option<f64>,
    /// How the onsets were found.
    pub onset_method: OnsetMethod,
    /// Measured minus planned onset (dead time, IEC 60050 351-50-31), s.
    pub onset_delay_s: Option<f64>,
    /// 95 % interval of it, widened by the time resolution, s.
    pub onset_delay_interval_s: Option<[f64; 2]>,
    /// Time between plan and joint having travelled the displacement threshold, s.
    pub displacement_delay_s: Option<f64>,
    /// Error at the measured onset, signed along the motion.
    pub breakaway_error: Option<f64>,
    /// Largest excess of measured over planned speed soon after the onset.
    pub jump: Option<f64>,
    /// Largest error magnitude in the window.
    pub peak_error: f64,
    /// The same with the sign of planned minus measured.
    pub peak_error_signed: f64,
    /// Time from the planned onset to that peak, s.
    pub time_to_peak_s: f64,
    /// Integral of the error magnitude over the window, in the joint's unit times seconds.
    pub error_area: f64,
    /// Root mean square error in the window.
    pub rms_error: f64,
    /// Largest error of the opposite sign after the peak; 0 if there is none.
    pub overshoot: f64,
    /// Time from the planned onset until the error, past its peak, stays in the settling band, s.
    pub settling_time_s: Option<f64>,
    /// The window: from the planned onset to the next one, the segment's end or the longest.
    pub window_s: [f64; 2],
    /// Samples in the window.
    pub samples: usize,
    /// Median time between them, or between those of the plan if that is longer, s.
    pub time_resolution_s: f64,
}

/// A dynamic-to-static event, planned and measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Stop {
    /// The joint.
    pub joint: String,
    /// Sign of the motion that ends, +1 or -1.
    pub direction: i8,
    /// When the plan comes to rest, s; `None` for a stop nobody planned.
    pub planned_s: Option<f64>,
    /// When the joint comes to rest, s.
    pub measured_s: Option<f64>,
    /// Error when the plan comes to rest, planned minus measured.
    pub error: Option<f64>,
}

/// All joints together.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct WholeRun {
    /// Error pooled over joints; `None` without joints, or if some turn and some slide.
    pub tracking_error: Option<TrackingError>,
    /// Norm over joints of the distance to the planned path, ignoring time; `None` where the
    /// joints have no instants in common, or some turn and some slide.
    pub path_error: Option<PathError>,
    /// How much of the error of joints whose plan moves is gone when each joint's plan is shifted by its lag; a joint
    /// without a lag keeps its error. `None` where none has one.
    pub lag_share: Option<LagShare>,
    /// Whether most of the error arises in the transitions; `None` if no plan moves, or if joints that turn and joints that slide do.
    pub concentration: Option<Concentration>,
}

/// All joints of one kind together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct KindRun {
    /// Whether they turn or slide.
    pub kind: JointKind,
    /// They together, in their unit.
    #[serde(flatten)]
    pub run: WholeRun,
}
