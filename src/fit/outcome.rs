//! What a fit found. Field names are those of the JSON report and of the file that brings a fit back.

use serde::{Deserialize, Serialize};

use super::{Estimated, FitError, Model, SharedLimit, Supply, skill::MOST_MARGIN};
use crate::series::JointKind;

/// Held-out skill below which no command should be made from a model.
pub const LEAST_SKILL: f64 = 0.3;

/// Held-out skill below which a model does not hold where starts are sharp: errors are large there, and a machine of the
/// model's structure is predicted to 0.3 % of their square. Between .990 and .995 a rate limit of the set values, and
/// set values held for 0.2 s, put gain, dead band and lag off by a factor of two.
pub const LEAST_SHARP_SKILL: f64 = 0.995;

/// The same where none is.
pub const LEAST_SMOOTH_SKILL: f64 = 0.8;

/// Peak of sharp starts that a model leaves unexplained, by their measured peak, above which it does not hold.
pub const MOST_UNEXPLAINED: f64 = 0.075;

/// A machine as its logs show it. Of joints that slide a radian stands for a metre.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Fit {
    /// Joints that could be fitted, in the order of the first log that has them.
    pub joints: Vec<JointFit>,
    /// Joints that are sent and measured but hardly moved.
    pub left_out: Vec<LeftOut>,
    /// Factor on predicted peak errors: 90 % of the measured peaks of held-out starts stayed below; 1.2 with fewer
    /// than ten starts.
    pub peak_margin: f64,
    /// Number of starts behind the margin.
    pub margin_starts: usize,
    /// The limit that joints share, such as a pump, where the logs show one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shared: Option<SharedLimit>,
    /// The supply, where its pressure was logged and fell while joints moved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub supply: Option<Supply>,
}

/// A joint that cannot be fitted, for it was hardly sent anywhere while it was measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct LeftOut {
    /// The joint.
    pub name: String,
    /// Whether it turns or slides.
    #[serde(default, skip_serializing_if = "turns")]
    pub kind: JointKind,
    /// How far it was sent, all logs together, rad.
    pub travel_rad: f64,
    /// How far is enough, rad.
    pub least_travel_rad: f64,
}

/// One joint. Pairs of arrays are for growing and for shrinking angles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct JointFit {
    /// The joint.
    pub name: String,
    /// Whether it turns or slides; of one that slides a radian stands for a metre.
    #[serde(default, skip_serializing_if = "turns")]
    pub kind: JointKind,
    /// Runs without gaps or long rests.
    pub runs: usize,
    /// Samples in them.
    pub samples: usize,
    /// Robust scale of what the model leaves unexplained, rad.
    pub residual_rad: f64,
    /// Statistical inefficiency: correlated residuals per effective sample.
    pub inefficiency: f64,
    /// Share of the squared tracking error (sent minus measured, about its mean) that is predicted
    /// where it was not fitted: time is dealt in blocks of 3 s to four parts in turn, and each part is
    /// predicted by a fit to the other three, simulated from the start of the run. 1 is perfect, 0 no
    /// better than the mean, -1 worse by as much or more. It says how well runs like these are predicted, not others.
    pub held_out_r2: f64,
    /// Whether the machine answers as the model does; if not, no number has an interval.
    #[serde(default = "holds")]
    pub model_holds: bool,
    /// Peak of the unexplained error after held-out starts, mean and 0.9 quantile, rad: it remains even if a command
    /// cancels the modelled error exactly. `None` without starts.
    pub unexplained_peak_rad: Option<[f64; 2]>,
    /// Dead time, time constant and half a period of the loop, s.
    pub lag_s: Estimated,
    /// Speed that must be wanted before the joint leaves rest: dead band, hysteresis and stiction, which logs of angles
    /// do not tell apart; mean of both directions, rad/s.
    pub dead_band_rad_s: Estimated,
    /// Position error at which the joint leaves rest: the dead band divided by the position gain, rad.
    pub dead_band_error_rad: Estimated,
    /// Wanted speed per position error, 1/s.
    pub position_gain_1_s: Estimated,
    /// Growth of the wanted speed per position error, 1/s².
    pub integral_gain_1_s2: Estimated,
    /// Wanted speed per sent speed.
    pub feed_forward: Estimated,
    /// How late the loop asks for what is sent, through a filter of first order and by a delay, s; 0 where the data show
    /// none. Late stamps of measured angles look like it. Logs of angles hardly tell the two parts apart.
    #[serde(default)]
    pub set_values_late_s: Estimated,
    /// Gain for growing angles by that for shrinking ones.
    pub gain_ratio: Estimated,
    /// Largest speed of growing angles, rad/s.
    pub speed_limit_growing_rad_s: Estimated,
    /// Largest speed of shrinking angles, rad/s.
    pub speed_limit_shrinking_rad_s: Estimated,
    /// Largest change of speed upwards, rad/s².
    pub acceleration_limit_growing_rad_s2: Estimated,
    /// Largest change of speed downwards, rad/s².
    pub acceleration_limit_shrinking_rad_s2: Estimated,
    /// Share of the full signal at which oil begins to flow, growing and shrinking; `None` without a
    /// log of signals to the valves.
    pub valve_dead_band: Option<[Estimated; 2]>,
    /// The numbers to predict with. Some are held by what is known beforehand alone; dead time, time
    /// constant, centre of the dead band, stiction and offset mean nothing on their own.
    pub model: Model,
}

/// Those that turn need not say so.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
fn turns(kind: &JointKind) -> bool {
    *kind == JointKind::Turns
}

/// What files say that were written before this was asked.
const fn holds() -> bool {
    true
}

impl Fit {
    /// The kind in whose unit means over its joints are told.
    pub fn common_kind(&self) -> JointKind {
        JointKind::common(self.joints.iter().map(|joint| joint.kind))
    }

    /// A joint by name.
    pub fn joint(&self, name: &str) -> Option<&JointFit> {
        self.joints.iter().find(|joint| joint.name == name)
    }

    /// Holds a fit that comes from a file to what predictions need.
    ///
    /// # Errors
    ///
    /// [`FitError::Value`].
    pub fn check(&self) -> Result<(), FitError> {
        let (found, least, most) = (self.peak_margin, 1.0, MOST_MARGIN);
        if !(least..=most).contains(&found) {
            return Err(FitError::Setting { key: "peak_margin", found, least, most });
        }
        self.joints.iter().try_for_each(|joint| {
            joint.quantities().iter().try_for_each(|(key, found)| found.check(&joint.name, key))?;
            joint.check_skill()?;
            joint.model.check(&joint.name)
        })
    }
}

/// A joint that is sent this share of its largest speed may be at it: what it is late by is made up for faster.
const NEAR: f64 = 0.8;
/// A limit of this share of what a joint makes alone is its own.
const OWN: f64 = 0.9;

impl JointFit {
    /// Holds what is said of its predictions to what that can be.
    fn check_skill(&self) -> Result<(), FitError> {
        let value =
            |key, found, least, most| FitError::Value { joint: self.name.clone(), key, found, least, most };
        if !(f64::MIN..=1.0).contains(&self.held_out_r2) {
            return Err(value("held_out_r2", self.held_out_r2, f64::NEG_INFINITY, 1.0));
        }
        let unexplained_rad = self.unexplained_peak_rad.into_iter().flatten();
        let bad = unexplained_rad.into_iter().find(|found| !(0.0..=f64::MAX).contains(found));
        bad.map_or(Ok(()), |found| Err(value("unexplained_peak_rad", found, 0.0, f64::INFINITY)))
    }

    /// Every number that is told of a joint, by its name with its unit.
    pub const fn quantities(&self) -> [(&'static str, Estimated); 12] {
        [
            ("lag_s", self.lag_s),
            ("dead_band_rad_s", self.dead_band_rad_s),
            ("dead_band_error_rad", self.dead_band_error_rad),
            ("position_gain_1_s", self.position_gain_1_s),
            ("integral_gain_1_s2", self.integral_gain_1_s2),
            ("feed_forward", self.feed_forward),
            ("set_values_late_s", self.set_values_late_s),
            ("gain_ratio", self.gain_ratio),
            ("speed_limit_growing_rad_s", self.speed_limit_growing_rad_s),
            ("speed_limit_shrinking_rad_s", self.speed_limit_shrinking_rad_s),
            ("acceleration_limit_growing_rad_s2", self.acceleration_limit_growing_rad_s2),
            ("acceleration_limit_shrinking_rad_s2", self.acceleration_limit_shrinking_rad_s2),
        ]
    }

    /// The same where no model predicts the joint: it is taken to be where it is sent, no number is known, and limits
    /// are what was reached.
    pub(super) fn without_model(self) -> Self {
        let none = Estimated::default();
        let reached = |limit: Estimated| Estimated { lower_bound: limit.lower_bound, ..none };
        Self {
            model_holds: false,
            lag_s: none,
            dead_band_rad_s: none,
            dead_band_error_rad: none,
            position_gain_1_s: none,
            integral_gain_1_s2: none,
            feed_forward: none,
            set_values_late_s: none,
            gain_ratio: none,
            speed_limit_growing_rad_s: reached(self.speed_limit_growing_rad_s),
            speed_limit_shrinking_rad_s: reached(self.speed_limit_shrinking_rad_s),
            acceleration_limit_growing_rad_s2: reached(self.acceleration_limit_growing_rad_s2),
            acceleration_limit_shrinking_rad_s2: reached(self.acceleration_limit_shrinking_rad_s2),
            model: Model { pose_rad: self.model.pose_rad, ..Model::FOLLOWS },
            ..self
        }
    }

    /// The same where another model explains the data as well.
    pub(super) fn with_rival(self, other: &Model) -> Self {
        let band_rad_s = other.leaves_rest_rad_s();
        Self {
            lag_s: self.lag_s.with_rival(other.lag_s()),
            dead_band_rad_s: self.dead_band_rad_s.with_rival(band_rad_s),
            dead_band_error_rad: self.dead_band_error_rad.with_rival(band_rad_s / other.position_gain_1_s),
            position_gain_1_s: self.position_gain_1_s.with_rival(other.position_gain_1_s),
            integral_gain_1_s2: self.integral_gain_1_s2.with_rival(other.integral_gain_1_s2),
            feed_forward: self.feed_forward.with_rival(other.feed_forward),
            set_values_late_s: self.set_values_late_s.with_rival(other.set_values_late_s()),
            ..self
        }
    }

    /// Takes in that a speed was reached, growing for `way` 0 and shrinking for 1, rad/s: a limit that is surely below is none, and neither
    /// is one that the model has without telling it.
    pub(super) fn has_reached(&mut self, way: usize, speed_rad_s: f64) {
        let limit = if way == 0 {
            &mut self.speed_limit_growing_rad_s
        } else {
            &mut self.speed_limit_shrinking_rad_s
        };
        let model = &mut self.model.speed_limit_rad_s[way];
        let most = limit.interval.map(|[_, most]| most).or(*model);
        if most.is_some_and(|most| most < speed_rad_s) {
            let lower_bound = Some(speed_rad_s);
            (*limit, *model) = (Estimated { lower_bound, ..Estimated::default() }, None);
        }
    }

    /// Takes in the speed that the joint makes with all of what it shares with others, rad/s: a limit below it is what the others left. The
    /// model keeps it for what the same plan does again.
    pub(super) fn makes_alone(&mut self, alone_rad_s: f64) {
        for limit in [&mut self.speed_limit_growing_rad_s, &mut self.speed_limit_shrinking_rad_s] {
            if limit.value.is_some_and(|most| most < OWN * alone_rad_s) {
                *limit = Estimated { lower_bound: limit.lower_bound, ..Estimated::default() };
            }
        }
    }

    /// Whether these lowest and highest speeds, rad/s, are so near its limits that it may be at them, where those are known.
    pub fn reaches_limits(&self, [lowest, highest]: [f64; 2]) -> bool {
        let reaches = |limit: Estimated, speed: f64| {
            limit.identified && limit.value.is_some_and(|most| speed > NEAR * most)
        };
        reaches(self.speed_limit_growing_rad_s, highest) || reaches(self.speed_limit_shrinking_rad_s, -lowest)
    }

    /// Whether the model predicts well enough to make commands from it.
    pub fn trusted(&self) -> bool {
        self.held_out_r2 >= LEAST_SKILL
    }
}
