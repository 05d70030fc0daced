//! The numbers of a model as an estimator sees them, with their priors.
//!
//! Every parameter is measured from its prior mean in prior standard deviations; positive ones by
//! their logarithm. A prior then costs half the sum of squares.

use super::model::Model;
use crate::units::DEGREE_RAD;

/// Number of parameters that all runs share.
pub(super) const SHARED: usize = 26;

pub(super) const DEAD_TIME: usize = 0;
pub(super) const TIME_CONSTANT: usize = 1;
pub(super) const POSITION_GAIN: usize = 2;
pub(super) const INTEGRAL_GAIN: usize = 3;
pub(super) const FEED_FORWARD: usize = 4;
pub(super) const ASYMMETRY: usize = 5;
pub(super) const DEAD_BAND: usize = 6;
const CENTRE: usize = 7;
pub(super) const STICTION: usize = 8;
const OFFSET: usize = 9;
const POSE: usize = 10;
const POSE_ASYMMETRY: usize = 11;
const POSE_CURVE: usize = 12;
pub(super) const HYSTERESIS: usize = 13;
/// Speed limits for growing and shrinking angles, then acceleration limits.
pub(super) const LIMITS: usize = 14;
pub(super) const EDGE: usize = LIMITS + 4;
pub(super) const FILTER: usize = EDGE + 1;
pub(super) const SET_VALUE_DELAY: usize = FILTER + 1;
pub(super) const BEYOND: usize = SET_VALUE_DELAY + 1;
pub(super) const INTEGRAL_LIMIT: usize = BEYOND + 1;
pub(super) const FREQUENCY: usize = INTEGRAL_LIMIT + 1;
pub(super) const DAMPING: usize = FREQUENCY + 1;
pub(super) const PLAY: usize = DAMPING + 1;

/// Width of the play between joint and sensor of a model whose data do not show another, rad: a free one stands in for the lag of smooth
/// runs.
const BACKLASH_RAD: f64 = 0.05 * DEGREE_RAD;

/// Prior of one parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Prior {
    /// Median of a positive parameter, mean of another.
    pub(super) middle: f64,
    /// Standard deviation; of the logarithm of a positive parameter.
    pub(super) deviation: f64,
    pub(super) positive: bool,
}

const fn positive(middle: f64, deviation: f64) -> Prior {
    Prior { middle, deviation, positive: true }
}

const fn around_zero(deviation: f64) -> Prior {
    Prior { middle: 0.0, deviation, positive: false }
}

/// By index; the limits start from what the data reach.
const PRIORS: [Prior; SHARED] = [
    positive(0.15, 0.8),
    positive(0.05, 0.8),
    positive(2.0, 0.7),
    positive(0.4, 1.0),
    positive(0.9, 0.5),
    around_zero(0.4),
    positive(DEGREE_RAD, 1.0),
    around_zero(0.5 * DEGREE_RAD),
    positive(0.1 * DEGREE_RAD, 1.0),
    around_zero(0.05 * DEGREE_RAD),
    around_zero(0.5),
    around_zero(0.3),
    around_zero(0.7),
    positive(0.1 * DEGREE_RAD, 1.0),
    positive(1.0, 1.5),
    positive(1.0, 1.5),
    positive(1.0, 1.5),
    positive(1.0, 1.5),
    positive(2.0 * DEGREE_RAD, 1.0),
    positive(0.1, 0.8),
    positive(0.05, 1.0),
    positive(1.0, 1.0),
    positive(2.0 * DEGREE_RAD, 1.0),
    positive(12.0, 0.7),
    positive(0.3, 0.7),
    positive(BACKLASH_RAD, 1.0),
];

/// What a valve may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Valve {
    /// Its edges open gradually.
    pub(super) edge: bool,
    /// It opens beyond what the largest speeds take.
    pub(super) beyond: bool,
}

/// What lies between valve and sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Between {
    /// Oil or a link on which the joint swings.
    pub(super) swing: bool,
    /// A play that is not the usual one.
    pub(super) play: bool,
}

/// Integral action of a position loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Integral {
    None,
    Free,
    /// Within limits.
    Held,
}

/// Parts that a model has only where the data show them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shown {
    /// Speed limits for growing and shrinking angles, then acceleration limits.
    pub(super) limits: [bool; 4],
    /// What the valve is beside a dead band.
    pub(super) valve: Valve,
    /// What lies between valve and sensor.
    pub(super) between: Between,
    /// Set values that come late, by a filter and a delay.
    pub(super) late: bool,
    /// Integral action of the position loop.
    pub(super) integral: Integral,
    /// Speed that is fed forward.
    pub(super) feed_forward: bool,
}

impl Shown {
    /// Whether a parameter moves.
    pub(super) fn has(self, parameter: usize) -> bool {
        match parameter {
            EDGE => self.valve.edge,
            FILTER | SET_VALUE_DELAY => self.late,
            BEYOND => self.valve.beyond,
            INTEGRAL_GAIN => self.integral != Integral::None,
            FREQUENCY | DAMPING => self.between.swing,
            PLAY => self.between.play,
            INTEGRAL_LIMIT => self.integral == Integral::Held,
            FEED_FORWARD => self.feed_forward,
            LIMITS.. => self.limits.get(parameter - LIMITS).is_none_or(|shown| *shown),
            _ => true,
        }
    }
}

/// Of the integral at the start of a run, rad/s.
const INTEGRAL: Prior = around_zero(0.7 * DEGREE_RAD);

/// Priors of one joint.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Priors {
    shared: [Prior; SHARED],
    /// Lowest and highest angle sent, rad.
    pose_rad: [f64; 2],
}

impl Priors {
    /// `limits`: medians of the speed and acceleration limits, by index from [`LIMITS`].
    pub(super) fn new(limits: [f64; 4], pose_rad: [f64; 2]) -> Self {
        let mut shared = PRIORS;
        for (prior, middle) in shared[LIMITS..].iter_mut().zip(limits) {
            prior.middle = middle;
        }
        Self { shared, pose_rad }
    }

    pub(super) fn of(&self, parameter: usize) -> Prior {
        self.shared.get(parameter).copied().unwrap_or(INTEGRAL)
    }

    /// The model that `x` stands for, without what is not shown.
    pub(super) fn model(&self, x: &[f64], shown: Shown) -> Model {
        let value = |i: usize| self.of(i).value(x.get(i).copied().unwrap_or_default());
        let limit = |i: usize| shown.limits[i].then(|| value(LIMITS + i));
        Model {
            dead_time_s: value(DEAD_TIME),
            time_constant_s: value(TIME_CONSTANT),
            position_gain_1_s: value(POSITION_GAIN),
            integral_gain_1_s2: if shown.has(INTEGRAL_GAIN) { value(INTEGRAL_GAIN) } else { 0.0 },
            integral_limit_rad_s: shown.has(INTEGRAL_LIMIT).then(|| value(INTEGRAL_LIMIT)),
            feed_forward: if shown.feed_forward { value(FEED_FORWARD) } else { 0.0 },
            asymmetry: value(ASYMMETRY),
            dead_band_rad_s: value(DEAD_BAND),
            dead_band_centre_rad_s: value(CENTRE),
            stiction_rad_s: value(STICTION),
            offset_rad: value(OFFSET),
            pose_rad: self.pose_rad,
            pose_slope_1_rad: value(POSE),
            pose_asymmetry_1_rad: value(POSE_ASYMMETRY),
            pose_curve_1_rad2: value(POSE_CURVE),
            speed_limit_rad_s: [limit(0), limit(1)],
            acceleration_limit_rad_s2: [limit(2), limit(3)],
            hysteresis_rad_s: value(HYSTERESIS),
            edge_rad_s: if shown.valve.edge { value(EDGE) } else { 0.0 },
            set_value_filter_s: if shown.late { value(FILTER) } else { 0.0 },
            set_value_delay_s: if shown.late { value(SET_VALUE_DELAY) } else { 0.0 },
            opens_beyond: if shown.valve.beyond { value(BEYOND) } else { 0.0 },
            natural_frequency_rad_s: if shown.between.swing { value(FREQUENCY) } else { 0.0 },
            damping_ratio: if shown.between.swing { value(DAMPING) } else { 0.0 },
            backlash_rad: if shown.between.play { value(PLAY) } else { BACKLASH_RAD },
        }
    }

    /// Integral at the start of a run, rad/s.
    pub(super) fn integral_rad_s(x: f64) -> f64 {
        INTEGRAL.value(x)
    }
}

impl Prior {
    pub(super) fn value(&self, x: f64) -> f64 {
        let step = self.deviation * x;
        if self.positive { self.middle * step.exp() } else { self.middle + step }
    }

    /// The parameter of a value.
    pub(super) fn place(&self, value: f64) -> f64 {
        let step = if self.positive { (value / self.middle).ln() } else { value - self.middle };
        step / self.deviation
    }

    /// Longest step of the estimator: 0.7 in the logarithm, one deviation of the others.
    pub(super) fn longest_step(&self) -> f64 {
        if self.positive { 0.7 / self.deviation } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parameter_s_place_stands_for_its_value() {
        let priors = Priors::new([0.3, 0.3, 5.0, 5.0], [0.0, 1.0]);
        for i in 0..=SHARED {
            let prior = priors.of(i);
            let value = if prior.positive { 0.7 * prior.middle } else { 0.01 };
            assert!((prior.value(prior.place(value)) - value).abs() < 1e-12, "{i}");
        }
    }
}
