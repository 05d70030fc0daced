//! Confidence intervals of the numbers of a model.
//!
//! Noise is the smaller part: machines are not of the model's form. On simulated machines fits miss
//! by the discrepancies below, which are added in quadrature to the deviations from noise and priors.

use nalgebra::DMatrix;

use super::{
    Estimated,
    estimate::{Problem, Workspace},
    outcome::{LEAST_SHARP_SKILL, LEAST_SMOOTH_SKILL, MOST_UNEXPLAINED},
    parameters::{
        DAMPING, DEAD_BAND, DEAD_TIME, FEED_FORWARD, FILTER, FREQUENCY, HYSTERESIS, POSITION_GAIN,
        SET_VALUE_DELAY, STICTION, TIME_CONSTANT,
    },
    robust::inefficiency,
    run::ASKED_OVER_S,
};
use crate::units::DEGREE_RAD;

/// Normal quantile of a two-sided 95 % interval.
pub(super) const QUANTILE: f64 = 1.96;

/// Model error as deviations of logarithms; no log narrows them. Pairs: of a joint as it is, and behind late set
/// values, whose filter is of a form not known: what one of second order or a moving mean delays beyond one of first order goes to them.
pub(super) mod discrepancy {
    /// Of the lag.
    pub(in crate::fit) const LAG: [f64; 2] = [0.11, 0.25];
    /// Of the lag where no start is sharp.
    pub(in crate::fit) const SMOOTH_LAG: f64 = 0.50;
    /// Of the dead band.
    pub(in crate::fit) const DEAD_BAND: [f64; 2] = [0.24, 0.65];
    /// Of the largest speeds of growing and of shrinking angles, and of the largest accelerations.
    pub(in crate::fit) const LIMIT: [f64; 4] = [0.12, 0.12, 0.75, 0.75];
    /// Of the position gain.
    pub(in crate::fit) const POSITION_GAIN: f64 = 0.15;
    /// Of the position gain where no start is sharp: set values that come late, which smooth runs do not show, take it for lower.
    pub(in crate::fit) const SMOOTH_POSITION_GAIN: f64 = 0.30;
    /// Of the integral gain.
    pub(in crate::fit) const INTEGRAL_GAIN: f64 = 0.40;
    /// Of the integral gain where no start is sharp.
    pub(in crate::fit) const SMOOTH_INTEGRAL_GAIN: f64 = 0.50;
    /// Of the feed-forward, which valves with play and friction that falls with speed stand in for.
    pub(in crate::fit) const FEED_FORWARD: [f64; 2] = [0.14, 0.25];
    /// Of how late set values come, for a part of which the lag of the loop stands in.
    pub(in crate::fit) const SET_VALUES_LATE: f64 = 0.38;
    /// Of the feed-forward where no start is sharp: a filter of set values that smooth runs do not show takes it for lower.
    pub(in crate::fit) const SMOOTH_FEED_FORWARD: f64 = 0.20;
    /// Of the ratio of gains.
    pub(in crate::fit) const GAIN: f64 = 0.10;
    /// Of the ratio of gains where no start is sharp: the middle of the dead band stands in for it.
    pub(in crate::fit) const SMOOTH_GAIN: f64 = 0.25;
}

/// Deviations of a logarithm above which a number is not identified.
const VAGUE: f64 = 0.6;

/// The data must narrow the prior to this share.
const NARROWED: f64 = 0.6;

/// A feed-forward whose interval does not lie above this may be none.
const LEAST_FEED_FORWARD: f64 = 0.4;

/// Sent speeds that change by less within a tenth of a second are smooth, rad/s.
const SHARP_RAD_S: f64 = 2.5 * DEGREE_RAD;

/// Posterior of the parameters.
#[derive(Debug, Clone)]
pub(super) struct Knowledge {
    free: Vec<usize>,
    covariance: DMatrix<f64>,
    pub(super) inefficiency: f64,
    /// Whether a start asks for more than the dead band within the lag.
    pub(super) sharp: bool,
    /// Whether the machine answers as the model does; if not, nothing is claimed of its numbers.
    pub(super) holds: bool,
    /// How many times the usual discrepancy a machine has of which the model misses so much.
    doubt: f64,
}

/// Unexplained peak of starts by their measured peak: from the first on a machine is of another form than those that the
/// discrepancies are from, and above the second the model does not hold, where starts are sharp. From simulated machines
/// of twenty-four structures: below the first a fiftieth of all intervals miss the truth, above it a seventh.
const UNEXPLAINED: [f64; 2] = [0.028, MOST_UNEXPLAINED];
/// Times the usual discrepancy at the second.
const MOST_DOUBT: f64 = 2.5;
/// Held-out skill below which a model of smooth runs is doubted, and does not hold.
const SMOOTH_SKILL: [f64; 2] = [0.98, LEAST_SMOOTH_SKILL];
/// Times the usual discrepancy between the two.
const SMOOTH_DOUBT: f64 = 1.3;

/// The discrepancy of a joint as it is, or that behind late set values.
fn behind(problem: &Problem, [plain, late]: [f64; 2]) -> f64 {
    if problem.shown.late { late } else { plain }
}

impl Knowledge {
    /// Around an estimate of a problem.
    pub(super) fn new(problem: &Problem, x: &[f64], scale_rad: f64, workspace: &mut Workspace) -> Self {
        let free = problem.free();
        let mut residuals = Vec::new();
        problem.residuals(x, workspace, &mut residuals);
        let inefficiency = inefficiency(&residuals);
        let normal = problem.normal(x, &free, &residuals, scale_rad, workspace);
        let covariance = normal.covariance(inefficiency, x, &free);
        let jump_rad_s =
            problem.runs.iter().map(|run| run.asked[2].max(run.asked[3])).fold(0.0, f64::max) * ASKED_OVER_S;
        let sharp = jump_rad_s > problem.model(x).dead_band_rad_s.max(SHARP_RAD_S);
        Self { free, covariance, inefficiency, sharp, holds: true, doubt: 1.0 }
    }

    /// Takes in what the model misses of held-out data, starts by their measured peaks among them, and whether it does so
    /// without a period.
    pub(super) fn judge(&mut self, calm: bool, held_out_r2: f64, unexplained: Option<f64>) {
        let [least_r2, doubt, most] = if self.sharp {
            let share =
                unexplained.map_or(0.0, |peak| (peak - UNEXPLAINED[0]) / (UNEXPLAINED[1] - UNEXPLAINED[0]));
            [LEAST_SHARP_SKILL, 1.0 + (MOST_DOUBT - 1.0) * share.clamp(0.0, 1.0), UNEXPLAINED[1]]
        } else {
            let doubt = if held_out_r2 < SMOOTH_SKILL[0] { SMOOTH_DOUBT } else { 1.0 };
            [SMOOTH_SKILL[1], doubt, f64::INFINITY]
        };
        self.doubt = doubt;
        self.holds = calm && held_out_r2 >= least_r2 && unexplained.is_none_or(|peak| peak <= most);
    }

    /// The discrepancy of logs with sharp starts, or that of logs without.
    pub(super) fn missed(&self, sharp: f64, smooth: f64) -> f64 {
        if self.sharp { sharp } else { smooth }
    }

    /// Standard deviation of a sum of parameters, each in its prior deviations.
    fn deviation(&self, parts: &[(usize, f64)]) -> f64 {
        let mut variance = 0.0;
        for &(a, by_a) in parts {
            for &(b, by_b) in parts {
                let place = |i| self.free.iter().position(|&free| free == i);
                if let (Some(a), Some(b)) = (place(a), place(b)) {
                    variance += by_a * by_b * self.covariance[(a, b)];
                }
            }
        }
        variance.max(0.0).sqrt()
    }

    /// A positive number whose logarithm grows with the parameters as `parts` say, by prior
    /// deviations.
    pub(super) fn positive(&self, value: f64, parts: &[(usize, f64)], discrepancy: f64) -> Estimated {
        let own = self.deviation(parts);
        let before = parts.iter().map(|(_, by)| by * by).sum::<f64>().sqrt();
        let deviation = own.hypot(self.doubt * discrepancy);
        let reach = (QUANTILE * deviation).exp();
        Estimated {
            value: Some(value),
            interval: self.holds.then_some([value / reach, value * reach]),
            identified: self.holds && deviation <= VAGUE && own <= NARROWED * before,
            ..Estimated::default()
        }
    }

    /// The lag: neither dead time nor time constant alone is known.
    pub(super) fn lag(&self, problem: &Problem, x: &[f64]) -> Estimated {
        let model = problem.model(x);
        let lag_s = model.lag_s();
        let part = |i: usize, value: f64| (i, problem.priors.of(i).deviation * value / lag_s);
        let parts = [
            part(DEAD_TIME, model.dead_time_s),
            part(TIME_CONSTANT, model.time_constant_s),
            part(DAMPING, model.swing_s()),
            part(FREQUENCY, -model.swing_s()),
        ];
        let missed = self.missed(behind(problem, discrepancy::LAG), discrepancy::SMOOTH_LAG);
        let found = self.unfiltered(problem, x, self.positive(lag_s, &parts, missed));
        // Within the lag a smooth start does not leave the dead band: its delay is the band's, and bounds the lag; but where
        // set values come late, which of it was lag is not known.
        let bounds = !self.sharp && !problem.shown.late;
        let upper_bound = found.interval.map(|[_, most_s]| most_s).filter(|_| bounds);
        Estimated { identified: found.identified && self.sharp, upper_bound, ..found }
    }

    /// How late the loop asks for what is sent: neither filter nor delay alone is known.
    pub(super) fn set_values_late(&self, problem: &Problem, x: &[f64]) -> Estimated {
        let model = problem.model(x);
        let late_s = model.set_values_late_s();
        if late_s <= 0.0 {
            return Estimated { value: Some(0.0), ..Estimated::default() };
        }
        let part = |i: usize, value_s: f64| (i, problem.priors.of(i).deviation * value_s / late_s);
        let parts = [part(FILTER, model.set_value_filter_s), part(SET_VALUE_DELAY, model.set_value_delay_s)];
        self.positive(late_s, &parts, discrepancy::SET_VALUES_LATE)
    }

    /// Wanted speed by sent speed; one that may be none is not identified. A filter of set values that is longer than what
    /// is fed forward makes up for is as good without any.
    pub(super) fn feed_forward(&self, problem: &Problem, x: &[f64]) -> Estimated {
        let part = (FEED_FORWARD, problem.priors.of(FEED_FORWARD).deviation);
        let model = problem.model(x);
        if !problem.shown.feed_forward {
            return Estimated { value: Some(0.0), ..Estimated::default() };
        }
        let sharp = behind(problem, discrepancy::FEED_FORWARD);
        let missed = self.missed(sharp, sharp.max(discrepancy::SMOOTH_FEED_FORWARD));
        let found = self.positive(model.feed_forward, &[part], missed);
        let leads = model.set_value_filter_s * model.position_gain_1_s < model.feed_forward;
        let sure = leads && found.interval.is_some_and(|[low, _]| low >= LEAST_FEED_FORWARD);
        Estimated { identified: found.identified && sure, ..found }
    }

    /// A number that a filter of set values changes: in a loop that may be without feed-forward one acts as a lower gain, more lag and
    /// another dead band. Where the data show none, the rivals with late set values tell how far.
    fn unfiltered(&self, problem: &Problem, x: &[f64], found: Estimated) -> Estimated {
        let sure = !problem.shown.feed_forward || self.feed_forward(problem, x).identified;
        Estimated { identified: found.identified && sure, ..found }
    }

    /// The position gain. Smooth runs do not identify it: they show by how much the joint is behind at a speed, and a delay
    /// of the set values makes a part of that, which they do not tell apart.
    pub(super) fn position_gain(&self, problem: &Problem, x: &[f64]) -> Estimated {
        let part = (POSITION_GAIN, problem.priors.of(POSITION_GAIN).deviation);
        let missed = self.missed(discrepancy::POSITION_GAIN, discrepancy::SMOOTH_POSITION_GAIN);
        let found =
            self.unfiltered(problem, x, self.positive(problem.model(x).position_gain_1_s, &[part], missed));
        Estimated { identified: found.identified && self.sharp, ..found }
    }

    /// What must be wanted before the joint leaves rest: dead band, hysteresis and stiction, which logs of angles hardly
    /// tell apart; and the same by the position gain, an error.
    pub(super) fn dead_band(&self, problem: &Problem, x: &[f64]) -> [Estimated; 2] {
        let model = problem.model(x);
        let whole_rad_s = model.leaves_rest_rad_s();
        let part = |i: usize, share: f64| (i, share * problem.priors.of(i).deviation);
        let band = part(DEAD_BAND, model.dead_band_rad_s / whole_rad_s);
        let stiction = part(STICTION, model.stiction_rad_s / whole_rad_s);
        let play = part(HYSTERESIS, model.hysteresis_rad_s / whole_rad_s);
        let gain = part(POSITION_GAIN, -1.0);
        let missed = behind(problem, discrepancy::DEAD_BAND);
        let [speed, error] = [
            (whole_rad_s, &[band, stiction, play][..]),
            (whole_rad_s / model.position_gain_1_s, &[band, stiction, play, gain]),
        ]
        .map(|(value, parts)| self.unfiltered(problem, x, self.positive(value, parts, missed)));
        // Without a feed-forward all that is wanted scales with the gain, which smooth runs do not tell.
        let scaled = self.sharp || problem.shown.feed_forward;
        [Estimated { identified: speed.identified && scaled, ..speed }, error]
    }
}
