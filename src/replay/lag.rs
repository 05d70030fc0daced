//! Velocity lag: the time shift at which planned and measured speed agree best.

use std::ops::Range;

use super::{Rules, motion::Motion};
use crate::math::{jackknife, whole};
use multiversion::multiversion;

/// A motion that repeats itself fits as well a period later. A peak whose correlation falls short of the best by less than this, with a
/// valley of less than this share of it between, is one with the best: of these the machine needs the nearest, a lead counting so many
/// times as a lag.
const ALIKE: f64 = 0.05;
const VALLEY: f64 = 0.5;
const LEAD_COUNTS: f64 = 10.0;

/// Share of the planned motion that is compared at a shift at least, by its energy.
const OVERLAP: f64 = 0.5;

/// The lag of one joint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Lag {
    pub(super) shift_s: Option<f64>,
    pub(super) correlation: Option<f64>,
    pub(super) interval_s: Option<[f64; 2]>,
    pub(super) motions: usize,
}

/// Speeds of one joint, `[n]`.
#[expect(clippy::struct_field_names, reason = "the postfix is the unit")]
pub(super) struct Speeds<'a> {
    pub(super) t_s: &'a [f64],
    pub(super) planned_rad_s: &'a [f64],
    pub(super) measured_rad_s: &'a [f64],
}

/// Sums for every shift from -shifts to +shifts.
#[derive(Clone)]
struct Correlation {
    product: Vec<f64>,
    planned_energy: Vec<f64>,
    measured_energy: Vec<f64>,
}

/// Correlates the speeds around every planned motion, on a common grid; no motion, no lag.
pub(super) fn lag(speeds: &Speeds, planned: &[Motion], sample_interval_s: f64, rules: &Rules) -> Lag {
    let step_s = (1.0 / rules.lag_rate_hz).max(sample_interval_s);
    let shifts = whole((rules.lag_max_s / step_s).clamp(0.0, 1e4));
    let mut total = Correlation::zero(shifts);
    let singles: Vec<Correlation> =
        planned.iter().map(|motion| Correlation::around(speeds, motion, step_s, shifts)).collect();
    for one in &singles {
        total.add(one);
    }
    let Some((shift, correlation)) = total.best(rules, None) else {
        return Lag::default();
    };
    let single = |one: &Correlation| one.best(rules, shift)?.0;
    let single_s: Vec<f64> = singles.iter().filter_map(single).map(|shift| shift * step_s).collect();
    let lag_s = shift.map(|shift| shift * step_s);
    // Motions of unlike lags: neither that of all together nor the mean of their own is left out.
    let interval_s = lag_s.and_then(|lag_s| {
        let without = |one: &Correlation| Some(total.without(one).best(rules, shift)?.0? * step_s);
        let half_s = jackknife(&singles.iter().map(without).collect::<Option<Vec<f64>>>()?)?;
        let (count, sum_s) = (single_s.len() as f64, single_s.iter().sum::<f64>());
        let others_s: Vec<f64> = single_s.iter().map(|own_s| (sum_s - own_s) / (count - 1.0)).collect();
        let (mean_s, of_mean_s) = (sum_s / count, jackknife(&others_s)?);
        Some([(lag_s - half_s).min(mean_s - of_mean_s), (lag_s + half_s).max(mean_s + of_mean_s)])
    });
    Lag { shift_s: lag_s, correlation: Some(correlation), interval_s, motions: single_s.len() }
}

impl Correlation {
    fn zero(shifts: usize) -> Self {
        let zeros = || vec![0.0; 2 * shifts + 1];
        Self { product: zeros(), planned_energy: zeros(), measured_energy: zeros() }
    }

    fn around(speeds: &Speeds, motion: &Motion, step_s: f64, shifts: usize) -> Self {
        let mut sums = Self::zero(shifts);
        let t = &speeds.t_s[motion.segment.clone()];
        let (Some(&opens_s), Some(&closes_s)) = (t.first(), t.last()) else {
            return sums;
        };
        // The plan is taken a lag around the motion, the measurement two.
        let reach_s = shifts as f64 * step_s;
        let start_s = opens_s.max(motion.start_s - 2.0 * reach_s);
        let end_s = closes_s.min(motion.end_s + 2.0 * reach_s);
        let place = |at_s: f64| whole((at_s - start_s) / step_s);
        let n = place(end_s) + 1;
        let grid = |values: &[f64]| resample(t, &values[motion.segment.clone()], start_s, step_s, n);
        let (p, m) = (grid(speeds.planned_rad_s), grid(speeds.measured_rad_s));
        let plan = place(motion.start_s - reach_s)..(place(motion.end_s + reach_s) + 1).min(n);
        correlate(&p, &m, &plan, &mut sums);
        sums
    }

    fn add(&mut self, other: &Self) {
        self.change(other, |to, from| to + from);
    }

    fn without(&self, other: &Self) -> Self {
        let mut rest = self.clone();
        // What is left of a difference of equals is no energy.
        rest.change(other, |to, from| if (to - from).abs() > 1e-9 * to.abs() { to - from } else { 0.0 });
        rest
    }

    fn change(&mut self, other: &Self, by: impl Fn(f64, f64) -> f64) {
        for (to, from) in [
            (&mut self.product, &other.product),
            (&mut self.planned_energy, &other.planned_energy),
            (&mut self.measured_energy, &other.measured_energy),
        ] {
            to.iter_mut().zip(from).for_each(|(to, from)| *to = by(*to, *from));
        }
    }

    /// The best shift in steps, refined by a parabola, and its correlation. No shift where the
    /// best is at the end of the range or correlates too little; nothing where none correlates. Of equals the one next to `near`.
    fn best(&self, rules: &Rules, near: Option<f64>) -> Option<(Option<f64>, f64)> {
        let correlation = |k: usize| {
            let energy = (self.planned_energy[k] * self.measured_energy[k]).sqrt();
            if energy > 0.0 { self.product[k] / energy } else { 0.0 }
        };
        // Where a shift leaves little of the motion, anything fits it.
        let most = self.planned_energy.iter().copied().fold(0.0, f64::max);
        let tells = |k: usize| self.planned_energy.get(k).is_some_and(|energy| *energy >= OVERLAP * most);
        let all: Vec<f64> =
            (0..self.product.len()).map(|k| if tells(k) { correlation(k) } else { 0.0 }).collect();
        let best = nearest_alike(&all, (0..all.len()).max_by(|&a, &b| all[a].total_cmp(&all[b]))?, near);
        if !(all[best] > 0.0 && all[best].is_finite()) {
            return None;
        }
        let is_last = best == 0 || !tells(best - 1) || !tells(best + 1);
        if is_last || all[best] < rules.lag_min_correlation {
            return Some((None, all[best]));
        }
        let bend = all[best - 1] - 2.0 * all[best] + all[best + 1];
        let beyond = if bend < 0.0 { 0.5 * (all[best - 1] - all[best + 1]) / bend } else { 0.0 };
        let shifts = (self.product.len() / 2) as f64;
        Some((Some(best as f64 - shifts + beyond.clamp(-0.5, 0.5)), all[best].min(1.0)))
    }
}

/// The peak nearest to a shift, or to none, of those that fit as well as the best.
fn nearest_alike(all: &[f64], best: usize, near: Option<f64>) -> usize {
    let shift = |k: usize| k as f64 - (all.len() / 2) as f64;
    let counts = |k: usize| match near {
        Some(near) => (shift(k) - near).abs(),
        None => shift(k).max(-LEAD_COUNTS * shift(k)),
    };
    // At the end of the range nobody knows what lies beyond.
    if best == 0 || best + 1 == all.len() {
        return best;
    }
    let is_peak = |k: usize| {
        let beside = [k.checked_sub(1), Some(k + 1)];
        beside.into_iter().flatten().filter_map(|other| all.get(other)).all(|other| *other <= all[k])
    };
    let apart = |k: usize| all[k.min(best)..k.max(best)].iter().any(|one| *one < VALLEY * all[best]);
    (0..all.len())
        .filter(|&k| k == best || all[k] >= all[best] - ALIKE && is_peak(k) && apart(k))
        .min_by(|&a, &b| counts(a).total_cmp(&counts(b)))
        .unwrap_or(best)
}

/// Adds the products of the plan's samples with the measured ones at every shift. Shifts are taken side by side, each in
/// the order of its samples: the sums are those of one shift after the other.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn correlate(p: &[f64], m: &[f64], plan: &Range<usize>, sums: &mut Correlation) {
    const LANES: usize = 8;
    let (shifts, n) = (sums.product.len() / 2, m.len());
    // The planned samples that have a measured one `k - shifts` after them.
    let inside =
        |k: usize| plan.start.max(shifts.saturating_sub(k))..plan.end.min((n + shifts).saturating_sub(k));
    let add = |sums: &mut Correlation, k: usize, range: Range<usize>| {
        for i in range {
            let (p, m) = (p[i], m[i + k - shifts]);
            sums.product[k] += p * m;
            sums.planned_energy[k] += p * p;
            sums.measured_energy[k] += m * m;
        }
    };
    for from in (0..sums.product.len()).step_by(LANES) {
        let lanes = from..(from + LANES).min(sums.product.len());
        // Where all of these shifts have a sample.
        let (first, end) = (inside(from).start, inside(lanes.end - 1).end);
        if lanes.len() < LANES || first >= end {
            lanes.for_each(|k| add(sums, k, inside(k)));
            continue;
        }
        lanes.clone().for_each(|k| add(sums, k, inside(k).start..first));
        let held = |sums: &[f64]| std::array::from_fn::<f64, LANES, _>(|l| sums[from + l]);
        let mut product = held(&sums.product);
        let mut planned = held(&sums.planned_energy);
        let mut measured = held(&sums.measured_energy);
        for (p, m) in p[first..end].iter().zip(m[first + from - shifts..].windows(LANES)) {
            for l in 0..LANES {
                product[l] += p * m[l];
                planned[l] += p * p;
                measured[l] += m[l] * m[l];
            }
        }
        sums.product[lanes.clone()].copy_from_slice(&product);
        sums.planned_energy[lanes.clone()].copy_from_slice(&planned);
        sums.measured_energy[lanes.clone()].copy_from_slice(&measured);
        lanes.for_each(|k| add(sums, k, end..inside(k).end));
    }
}

/// Values at `start_s + k step_s` for `n` instants, linear between samples.
fn resample(t: &[f64], x: &[f64], start_s: f64, step_s: f64, n: usize) -> Vec<f64> {
    let last = t.len() - 1;
    let mut i = t.partition_point(|&t| t <= start_s).saturating_sub(1);
    (0..n)
        .map(|k| {
            let at_s = start_s + k as f64 * step_s;
            while i < last && t[i + 1] <= at_s {
                i += 1;
            }
            let j = (i + 1).min(last);
            let share = if j > i { ((at_s - t[i]) / (t[j] - t[i])).clamp(0.0, 1.0) } else { 0.0 };
            x[i] + share * (x[j] - x[i])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hump(at_s: f64, t_s: f64) -> f64 {
        (-((t_s - at_s) / 0.4).powi(2)).exp()
    }

    fn motion(start_s: f64, end_s: f64, segment: Range<usize>) -> Motion {
        Motion {
            direction: 1,
            samples: segment.clone(),
            segment,
            start_s,
            end_s,
            rest_before_s: 1.0,
            opens: false,
            closes: false,
            reversal: false,
            reversed: false,
        }
    }

    #[test]
    fn a_shift_between_two_samples_is_found_to_a_tenth_of_a_sample() {
        let t_s: Vec<f64> = (0..400).map(|k| f64::from(k) * 0.02 + 0.003 * f64::from(k % 3)).collect();
        let planned: Vec<f64> = t_s.iter().map(|&t| hump(4.0, t)).collect();
        let measured: Vec<f64> = t_s.iter().map(|&t| hump(4.133, t)).collect();
        let speeds = Speeds { t_s: &t_s, planned_rad_s: &planned, measured_rad_s: &measured };
        let found = lag(&speeds, &[motion(3.0, 5.0, 0..400)], 0.02, &Rules::default());
        assert!((found.shift_s.unwrap() - 0.133).abs() < 0.002, "{found:?}");
        assert!(found.correlation.unwrap() > 0.999);
        assert_eq!(found.interval_s, None);
    }

    #[test]
    fn of_a_motion_that_repeats_itself_the_nearest_shift_is_the_lag() {
        // Peaks a period of a second apart, the one before the plan a little higher; and a shoulder, which is none.
        let at = |k: i32, peak: i32, height: f64| (height - 2e-4 * f64::from((k - peak).pow(2))).max(-0.9);
        let gait: Vec<f64> = (-100..=100).map(|k| at(k, -97, 0.95).max(at(k, 3, 0.948))).collect();
        assert_eq!([nearest_alike(&gait, 3, None), nearest_alike(&gait, 3, Some(-90.0))], [103, 3]);
        let shoulder: Vec<f64> =
            (-100..=100).map(|k| at(k, 60, 0.95).max(at(k, 20, 0.93)).max(0.8)).collect();
        assert_eq!(nearest_alike(&shoulder, 160, None), 160);
    }

    #[test]
    fn sums_side_by_side_are_those_one_after_the_other() {
        let values = |seed: u32, n: u32| -> Vec<f64> {
            (0..n).map(|k| f64::from((k * 7919 + seed) % 101) * 0.37 - 11.0).collect()
        };
        for (n, shifts, plan) in
            [(60, 9, 20..40), (60, 9, 0..60), (30, 12, 3..29), (5, 20, 1..4), (40, 0, 10..30)]
        {
            let (p, m) = (values(3, n), values(17, n));
            let mut sums = Correlation::zero(shifts);
            correlate(&p, &m, &plan, &mut sums);
            for k in 0..=2 * shifts {
                let inside = plan.clone().filter(|i| (shifts..m.len() + shifts).contains(&(i + k)));
                let mut alone = [0.0; 3];
                for i in inside {
                    let (p, m) = (p[i], m[i + k - shifts]);
                    alone = [alone[0] + p * m, alone[1] + p * p, alone[2] + m * m];
                }
                let beside = [sums.product[k], sums.planned_energy[k], sums.measured_energy[k]];
                assert_eq!(beside.map(f64::to_bits), alone.map(f64::to_bits), "{n} {k}");
            }
        }
    }

    #[test]
    fn a_shift_that_leaves_little_of_a_short_run_is_no_lag() {
        let t_s: Vec<f64> = (0..60).map(|k| f64::from(k) * 0.008).collect();
        let ramp: Vec<f64> = t_s.iter().map(|t| 0.1 + t * t).collect();
        let late: Vec<f64> = t_s.iter().map(|t| 0.1 + (t - 0.004) * (t - 0.004)).collect();
        let speeds = Speeds { t_s: &t_s, planned_rad_s: &ramp, measured_rad_s: &late };
        let found = lag(&speeds, &[motion(0.0, 0.472, 0..60)], 0.008, &Rules::default());
        assert!(found.shift_s.is_none_or(|shift_s| shift_s.abs() < 0.02), "{found:?}");
    }

    #[test]
    fn a_lag_beyond_the_range_is_not_named() {
        let t_s: Vec<f64> = (0..400).map(|k| f64::from(k) * 0.02).collect();
        let planned: Vec<f64> = t_s.iter().map(|&t| hump(3.0, t)).collect();
        let measured: Vec<f64> = t_s.iter().map(|&t| hump(4.4, t)).collect();
        let speeds = Speeds { t_s: &t_s, planned_rad_s: &planned, measured_rad_s: &measured };
        assert_eq!(lag(&speeds, &[motion(2.0, 4.0, 0..400)], 0.02, &Rules::default()).shift_s, None);
        assert_eq!(lag(&speeds, &[], 0.02, &Rules::default()), Lag::default());
    }
}
