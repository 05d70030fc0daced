//! When a joint left rest: the instant at which its speed first passed a stated threshold, found
//! below the noise of any speed.
//!
//! Curves that rest and then rise, steeply or gently, are fitted to the angle for every instant
//! of departure. Each says when its own speed passes the threshold; weighted with their likelihood
//! they give the onset and its interval. A speed smoothed enough to show the threshold
//! would blur a sharp start over the width of the smoothing.

use std::ops::Range;

use multiversion::multiversion;

use super::{Rules, at_rest::AtRest};
use crate::math::{SIGMA_PER_MAD, mad};

/// An onset with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Onset {
    pub(super) at_s: f64,
    /// 95 %, without the time resolution, s.
    pub(super) interval_s: [f64; 2],
}

/// More samples than this are averaged in blocks: blocks of 5 ms lose nothing at this resolution.
const MOST_POINTS: usize = 200;

/// The rest is looked at from so long before the crossing until so long before its smoothing, s.
const REST_FROM_S: f64 = 3.0;
const REST_UNTIL_S: f64 = 0.4;
/// A speed at rest below this share of the threshold of an onset moves none.
const NEGLIGIBLE: f64 = 0.05;
/// A likely departure beyond this share of what is looked at before the crossing asks for more of it, s at most; it is likely
/// up to so much of minus the logarithm of its likelihood more than the likeliest.
const NEAR_EDGE: f64 = 0.6;
const LIKELY: f64 = 2.0;
const LONGEST_BEFORE_S: f64 = 4.0;
const ROUNDS: usize = 4;
/// What a rise misses, root mean square, by what scatters at rest: from there on the motion takes another course in the time that is
/// looked at, and half of that is looked at; a few samples stay.
const OTHER_COURSE: f64 = 5.0;
const FEWEST_RISEN: usize = 4;
/// A motion whose mean speed is so many times the threshold is far beyond it.
const FAST: f64 = 20.0;
/// So many times what scatters tells a rise from it.
const CLEAR: f64 = 30.0;
const FEWEST: usize = 6;

/// How a joint leaves rest, as travel over time since the departure.
#[derive(Clone, Copy)]
pub(super) enum Rise {
    /// Constant acceleration for this long, then constant speed, s.
    Ramp(f64),
    /// A power of time: constant acceleration, constant jerk, constant snap.
    Power(i32),
    /// A jump of speed, of which half is left after 0.4 times this, s: what breaks away or answers a step slows down at once.
    Slows(f64),
    /// A speed that swings up and down again within this, s: what sticks breaks away by more than is asked for, and comes to rest again.
    Swings(f64),
    /// A jump of speed that grows to twice it within half of the inverse of this, 1/s: what takes up play meets a plan under way.
    Gains(f64),
}

/// From a breakaway with a jump of speed to the gentle start of a spline at rest; the first [`SMOOTH`] are those of plans.
pub(super) const RISES: [Rise; 13] = [
    Rise::Ramp(0.03),
    Rise::Ramp(0.08),
    Rise::Ramp(0.16),
    Rise::Power(2),
    Rise::Power(3),
    Rise::Power(4),
    Rise::Power(5),
    Rise::Slows(0.1),
    Rise::Slows(0.4),
    Rise::Slows(2.0),
    Rise::Gains(3.0),
    Rise::Swings(0.1),
    Rise::Swings(0.2),
];
pub(super) const SMOOTH: usize = 6;

impl Rise {
    pub(super) fn travel(self, since_s: f64) -> f64 {
        match self {
            Rise::Ramp(ramp_s) if since_s >= ramp_s => since_s - 0.5 * ramp_s,
            Rise::Ramp(ramp_s) => 0.5 * since_s * since_s / ramp_s,
            Rise::Power(2) => since_s * since_s,
            Rise::Power(3) => since_s * (since_s * since_s),
            Rise::Power(4) => (since_s * since_s) * (since_s * since_s),
            Rise::Power(power) => since_s.powi(power),
            Rise::Slows(time_s) => since_s * time_s / (since_s + time_s),
            Rise::Gains(per_s) => since_s + per_s * (since_s * since_s),
            // The speed is 16 s² (1 - s)², s from 0 to 1.
            Rise::Swings(for_s) => {
                let s = (since_s / for_s).min(1.0);
                for_s * (s * s * s) * (16.0 / 3.0 + s * (3.2 * s - 8.0))
            }
        }
    }

    /// How long after the departure a rise of this scale passes a speed; `None` if never.
    pub(super) fn passes_s(self, scale: f64, speed_rad_s: f64) -> Option<f64> {
        let unit = speed_rad_s / scale;
        match self {
            Rise::Ramp(ramp_s) => (unit <= 1.0).then_some(unit * ramp_s),
            Rise::Slows(_) => (unit <= 1.0).then_some(0.0),
            Rise::Gains(per_s) => Some((0.5 * (unit - 1.0) / per_s).max(0.0)),
            Rise::Swings(for_s) => (unit <= 1.0).then(|| 0.5 * for_s * (1.0 - (1.0 - unit.sqrt()).sqrt())),
            Rise::Power(power) => Some((unit / f64::from(power)).powf(1.0 / f64::from(power - 1))),
        }
    }
}

/// Where to look: a motion in `direction` whose smoothed speed crossed a threshold at
/// `crossing_s` after `rest_s` at rest, found with smoothing of half width `window_s`.
#[derive(Debug, Clone)]
pub(super) struct Search {
    pub(super) segment: Range<usize>,
    pub(super) direction: i8,
    pub(super) crossing_s: f64,
    pub(super) rest_s: f64,
    pub(super) window_s: f64,
    /// The threshold of the onset.
    pub(super) stop_speed: f64,
    /// Whether it may break away, as a joint that sticks does and no plan.
    pub(super) sticks: bool,
}

/// When the speed of a motion first passed [`Search::stop_speed`]. `None` with fewer than
/// six samples to fit.
pub(super) fn onset(t_s: &[f64], position_rad: &[f64], search: &Search, rules: &Rules) -> Option<Onset> {
    let most_s = rules.onset_rest_share * search.rest_s;
    let mut before_s = most_s.min(rules.onset_before_s);
    let (mut found, mut departs_s) = within(t_s, position_rad, search, before_s, rules)?;
    // A departure near the edge of what is looked at may lie before it.
    for _ in 0..ROUNDS {
        if -departs_s < NEAR_EDGE * before_s || before_s >= most_s.min(LONGEST_BEFORE_S) {
            break;
        }
        before_s = (2.0 * before_s).min(most_s).min(LONGEST_BEFORE_S);
        (found, departs_s) = within(t_s, position_rad, search, before_s, rules)?;
    }
    Some(found)
}

/// The same, looked for from so long before the crossing on, and when the earliest likely motion departs by that, s.
fn within(
    t_s: &[f64],
    position_rad: &[f64],
    search: &Search,
    before_s: f64,
    rules: &Rules,
) -> Option<(Onset, f64)> {
    let Search { segment, crossing_s, window_s, .. } = search;
    let times = &t_s[segment.clone()];
    let first = times.partition_point(|&t| t < crossing_s - before_s);
    let end = times.partition_point(|&t| t <= crossing_s + window_s + rules.onset_after_s);
    if end < first + FEWEST {
        return None;
    }
    let block = (end - first).div_ceil(MOST_POINTS);
    let mean_of = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let t: Vec<f64> = times[first..end].chunks(block).map(|t| mean_of(t) - crossing_s).collect();
    let x: Vec<f64> =
        position_rad[segment.start + first..segment.start + end].chunks(block).map(mean_of).collect();
    let mean = mean_of(&x);
    let x: Vec<f64> = x.iter().map(|x| f64::from(search.direction) * (x - mean)).collect();

    if !x.iter().map(|x| x * x).sum::<f64>().is_finite() {
        return None;
    }
    // A joint that sinks at rest, or comes to rest, moves before it leaves: what its rise adds to that passes the threshold.
    let at = |before_s: f64| times.partition_point(|&t| t < crossing_s - before_s);
    let (from, until) =
        (at(REST_FROM_S.min(rules.onset_rest_share * search.rest_s)), at(window_s + REST_UNTIL_S));
    let rest = times.get(from..until).zip(position_rad.get(segment.start + from..segment.start + until));
    let at_rest = rest.map_or(AtRest::Stands, |(t_s, position)| {
        let t: Vec<f64> = t_s.iter().map(|t_s| t_s - crossing_s).collect();
        let position: Vec<f64> = position.iter().map(|x| f64::from(search.direction) * x).collect();
        AtRest::of(&t, &position, NEGLIGIBLE * search.stop_speed)
    });
    let x: Vec<f64> = x.iter().zip(&t).map(|(x, t)| x - at_rest.position(*t)).collect();
    let mean = mean_of(&x);
    let x: Vec<f64> = x.iter().map(|x| x - mean).collect();
    let stop_speed = search.stop_speed - at_rest.speed(0.0);

    // The crossing of a smoothed speed may lie closer to the segment's start than the rest does.
    let before_s = before_s.min(crossing_s - times[first]);
    // What creeps before it leaves crosses earlier than a smoothed speed would.
    let on_s = (window_s + 0.5 * rules.onset_after_s).min(times[end - 1] - crossing_s);
    let steps = |span_s: f64| (span_s / rules.onset_step_s).floor().clamp(0.0, 10_000.0);
    let (back, on) = (steps(before_s), steps(on_s));
    #[expect(clippy::cast_possible_truncation, reason = "clamped above")]
    let grid = (-(back as i64)..=on as i64).map(|k| k as f64 * rules.onset_step_s);
    let grid: Vec<f64> = grid.collect();
    let tried = |count: usize| -> Vec<Fit> {
        let mean = mean_of(&x[..count]);
        let own: Vec<f64> = x[..count].iter().map(|x| x - mean).collect();
        let all = grid.iter().flat_map(|t0| fits(&t[..count], &own, *t0));
        let all = all.filter(|fit| search.sticks || !matches!(fit.rise, Rise::Swings(_)));
        all.filter(|fit| fit.onset_s(stop_speed).is_some_and(|s| s <= t[count - 1])).collect()
    };
    let least = |all: &[Fit]| all.iter().copied().min_by(|a, b| a.squares.total_cmp(&b.squares));
    let mut count = t.len();
    let mut all = tried(count);
    while let Some(shorter) = least(&all).and_then(|best| best.shorter(&t[..count], &x[..count], stop_speed))
    {
        let fewer = tried(shorter);
        if fewer.is_empty() {
            break;
        }
        (count, all) = (shorter, fewer);
    }
    let mean = mean_of(&x[..count]);
    let (t, x) = (&t[..count], &x[..count].iter().map(|x| x - mean).collect::<Vec<f64>>());
    let best = &least(&all)?;
    let freedom = ((t.len() as f64 - 4.0).max(1.0) / best.redundancy(t, x)).max(1.0);
    let variance = (best.squares / freedom).max(f64::MIN_POSITIVE);
    let likely = all
        .iter()
        .filter_map(|fit| Some((fit.onset_s(stop_speed)?, 0.5 * (fit.squares - best.squares) / variance)));
    let [low_s, at_s, high_s] = quantiles(likely.collect(), [0.025, 0.5, 0.975])?;
    // Departures are tried at steps; the shapes between the ones tried are not.
    let step_s = rules.onset_step_s;
    let interval_s = [crossing_s + low_s - step_s, crossing_s + high_s + step_s];
    let likely = all.iter().filter(|fit| 0.5 * (fit.squares - best.squares) < LIKELY * variance);
    let departs_s = likely.map(|fit| fit.t0).fold(best.t0, f64::min);
    Some((Onset { at_s: crossing_s + at_s, interval_s }, departs_s))
}

/// Quantiles of instants, each with minus the logarithm of its likelihood; `None` if there are none.
pub(super) fn quantiles<const N: usize>(mut likely: Vec<(f64, f64)>, shares: [f64; N]) -> Option<[f64; N]> {
    let best = likely.iter().map(|(_, unlikely)| *unlikely).min_by(f64::total_cmp)?;
    likely.sort_by(|a, b| a.0.total_cmp(&b.0));
    let weight = |unlikely: f64| (best - unlikely).exp();
    let total: f64 = likely.iter().map(|(_, unlikely)| weight(*unlikely)).sum();
    Some(shares.map(|share| {
        let mut sum = 0.0;
        let passed = likely.iter().find(|(_, unlikely)| {
            sum += weight(*unlikely);
            sum >= share * total
        });
        passed.map_or(0.0, |(at_s, _)| *at_s)
    }))
}

/// The best rest level and scale of a rise that begins at `t0`.
#[derive(Clone, Copy)]
struct Fit {
    t0: f64,
    rise: Rise,
    level: f64,
    scale: f64,
    /// Sum of squared residuals.
    squares: f64,
}

/// Fits all rises from `t0` on to values of zero mean, side by side.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn fits(t: &[f64], x: &[f64], t0: f64) -> [Fit; RISES.len()] {
    let n = t.len() as f64;
    let from = t.partition_point(|&t| t <= t0);
    let zeros = [0.0; RISES.len()];
    let (mut f1, mut f2, mut fx) = (zeros, zeros, zeros);
    for (t, x) in t[from..].iter().zip(&x[from..]) {
        let f = RISES.map(|rise| rise.travel(t - t0));
        for k in 0..RISES.len() {
            f1[k] += f[k];
            f2[k] += f[k] * f[k];
            fx[k] += f[k] * x;
        }
    }
    let (mut level, mut scale, mut squares) = (zeros, zeros, zeros);
    for k in 0..RISES.len() {
        let spread = f2[k] - f1[k] * f1[k] / n;
        // The values have zero mean, so the covariance needs no correction.
        scale[k] = if spread > 0.0 { (fx[k] / spread).max(0.0) } else { 0.0 };
        level[k] = -scale[k] * f1[k] / n;
    }
    for x in &x[..from] {
        for k in 0..RISES.len() {
            squares[k] += (x - level[k]) * (x - level[k]);
        }
    }
    for (t, x) in t[from..].iter().zip(&x[from..]) {
        let f = RISES.map(|rise| rise.travel(t - t0));
        for k in 0..RISES.len() {
            let off = x - level[k] - scale[k] * f[k];
            squares[k] += off * off;
        }
    }
    std::array::from_fn(|k| Fit { t0, rise: RISES[k], level: level[k], scale: scale[k], squares: squares[k] })
}

impl Fit {
    /// When its speed passes the threshold; `None` if it never does.
    fn onset_s(&self, speed_rad_s: f64) -> Option<f64> {
        if self.scale <= 0.0 {
            return None;
        }
        Some(self.t0 + self.rise.passes_s(self.scale, speed_rad_s)?)
    }

    /// How many samples to look at in place of all, where the motion takes another course among them than any rise; in these it is far
    /// beyond the speed that is looked for.
    fn shorter(&self, t: &[f64], x: &[f64], stop_speed: f64) -> Option<usize> {
        let from = t.partition_point(|&t| t <= self.t0);
        let mean = x.iter().sum::<f64>() / x.len() as f64;
        let missed = |range: Range<usize>| {
            let count = range.len() as f64;
            (range.map(|k| self.residual(t[k], x[k] - mean).powi(2)).sum::<f64>() / count).sqrt()
        };
        // Angles in steps scatter by them, whatever their last digits.
        let steps: Vec<f64> = x.windows(2).map(|two| (two[1] - two[0]).abs()).collect();
        let digits = 1e-6 * steps.iter().copied().fold(0.0, f64::max);
        let step = steps.into_iter().filter(|step| *step > digits).fold(f64::INFINITY, f64::min);
        // What leaves early may seem to be at rest.
        let rest: Vec<f64> = (0..from).map(|k| self.residual(t[k], x[k] - mean)).collect();
        let scatter = (SIGMA_PER_MAD * mad(&rest)).max(step);
        let half_s = 0.5 * (self.t0 + t[t.len() - 1]);
        let half = t.partition_point(|&t| t <= half_s);
        let shorter = half.max(from + FEWEST_RISEN).max(FEWEST);
        let seen = x.get(shorter - 1).filter(|_| from >= 2 && shorter < x.len())?;
        let travel = seen - self.level - mean;
        let far = travel > FAST * stop_speed * (t[shorter - 1] - self.t0) && travel > CLEAR * scatter;
        (far && missed(from..x.len()) > OTHER_COURSE * scatter).then_some(shorter)
    }

    fn residual(&self, t: f64, x: f64) -> f64 {
        let risen = if t > self.t0 { self.scale * self.rise.travel(t - self.t0) } else { 0.0 };
        x - self.level - risen
    }

    /// How many samples carry the information of one, at least 1, from the correlation of
    /// neighbouring residuals: rounding and a wrong shape repeat themselves.
    fn redundancy(&self, t: &[f64], x: &[f64]) -> f64 {
        let r: Vec<f64> = t.iter().zip(x).map(|(&t, &x)| self.residual(t, x)).collect();
        let neighbours: f64 = r.windows(2).map(|w| w[0] * w[1]).sum();
        let correlation = if self.squares > 0.0 { (neighbours / self.squares).clamp(0.0, 0.95) } else { 0.0 };
        (1.0 + correlation) / (1.0 - correlation)
    }
}

#[cfg(test)]
mod tests;
