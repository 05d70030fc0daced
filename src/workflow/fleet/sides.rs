//! The levels of a joint before and after something that was done.

use std::collections::BTreeMap;

use statrs::distribution::{ContinuousCDF as _, StudentsT};

use super::{
    history::{By, History, Scatters, Values},
    joint_trend::FEWEST_OF_A_SIDE,
    leveled::matrix,
    run::date,
    window::Window,
};
use crate::{
    math::{column_levels, mean, median, pieces},
    units::SECONDS_PER_DAY,
};

/// A level that changes by itself by chance with a smaller probability does so.
const SURELY: f64 = 0.01;
const VERY_SURELY: f64 = 1e-4;

/// Levels of the runs of one machine before and after, and the median value before.
pub(super) struct Sides {
    pub(super) before: Vec<f64>,
    pub(super) after: Vec<f64>,
    pub(super) level: f64,
    pub(super) starts: usize,
    /// When each run of either side began, microseconds since 1970.
    at_us: [Vec<i64>; 2],
}

/// A level that changes evenly before as after.
pub(super) struct Drift {
    pub(super) per_day: f64,
    /// Its standard error.
    error: f64,
    /// Probability of such a slope by chance.
    p: f64,
    /// From the middle of the runs before to that of the runs after.
    apart_days: f64,
    /// Between the last run before and the first one after.
    at_days: f64,
}

impl Drift {
    /// What its error makes of the change.
    pub(super) fn error_of_change(&self) -> f64 {
        self.error * self.apart_days
    }
}

fn in_days(us: i64) -> f64 {
    us as f64 / 1e6 / SECONDS_PER_DAY
}

impl Sides {
    pub(super) fn of(
        history: &History,
        metric: By,
        scatters: (&str, &Scatters),
        values: &Values,
        window: Window,
    ) -> Self {
        let is_after = |run: &usize| history.runs.get(*run).is_some_and(|run| window.is_after(run));
        let tells = |run: &usize| history.runs.get(*run).is_some_and(|run| window.holds(run));
        // A start that one side lacks tells nothing of the change.
        let both = |of: &BTreeMap<usize, f64>| {
            let after = of.keys().filter(|run| is_after(run)).count();
            after > 0 && after < of.len()
        };
        let told = values.iter().map(|(event, of)| {
            let of = of.iter().filter(|(run, _)| tells(run)).map(|(run, value)| (*run, *value));
            (event.clone(), of.collect::<BTreeMap<usize, f64>>())
        });
        let values: Values = told.filter(|(_, of)| both(of)).collect();
        let (runs, rows, weights) = matrix(metric, &values, 2, scatters);
        let levels = column_levels(&rows, &weights, runs.len());
        let side = |after: bool| -> (Vec<f64>, Vec<i64>) {
            let levels =
                runs.iter().zip(&levels).filter(|(run, level)| is_after(run) == after && level.is_finite());
            let at = |run: &usize| history.runs.get(*run).map_or(0, |run| run.started_us);
            levels.map(|(run, level)| (*level, at(run))).unzip()
        };
        let early = values.values().flat_map(|of| of.iter().filter(|(run, _)| !is_after(run)));
        let level = median(early.map(|(_, value)| *value).collect());
        let ((before, before_us), (after, after_us)) = (side(false), side(true));
        Self { before, after, level, starts: rows.len(), at_us: [before_us, after_us] }
    }

    pub(super) fn change(&self) -> Option<f64> {
        (self.before.len() >= 2 && self.after.len() >= 2).then(|| mean(&self.after) - mean(&self.before))
    }

    /// The drift that goes on before as after: one slope within both sides. `None` for too few runs.
    pub(super) fn drift(&self) -> Option<Drift> {
        let sides = [&self.before, &self.after].into_iter().zip(&self.at_us);
        let (mut square, mut product, mut total) = (0.0, 0.0, 0.0);
        for (levels, at_us) in sides {
            let days: Vec<f64> = at_us.iter().copied().map(in_days).collect();
            let (day, level) = (mean(&days), mean(levels));
            for (at, value) in days.iter().zip(levels) {
                square += (at - day).powi(2);
                product += (at - day) * (value - level);
                total += (value - level).powi(2);
            }
        }
        let freedom = (self.before.len() + self.after.len()) as f64 - 3.0;
        let [before, after] = self.at_us.each_ref().map(|side| side.iter().copied().map(in_days));
        let at_days = 0.5 * (before.clone().reduce(f64::max)? + after.clone().reduce(f64::min)?);
        if freedom < 3.0 || square <= 0.0 {
            return None;
        }
        let per_day = product / square;
        let error = ((total - per_day * product).max(0.0) / freedom / square).sqrt();
        let chance = |t: StudentsT| if error > 0.0 { 2.0 * t.cdf(-(per_day / error).abs()) } else { 0.0 };
        let p = StudentsT::new(0.0, 1.0, freedom).map_or(1.0, chance);
        let apart_days = mean(&after.collect::<Vec<_>>()) - mean(&before.collect::<Vec<_>>());
        Some(Drift { per_day, error, p, apart_days, at_days })
    }

    /// Whether a drift is sure, and makes the change smaller or is very sure: the steepest slope of many by chance would be taken for one.
    pub(super) fn has(&self, drift: &Drift) -> bool {
        let change = mean(&self.after) - mean(&self.before);
        let smaller = (change - drift.per_day * drift.apart_days).abs() < change.abs();
        drift.p < VERY_SURELY || drift.p < SURELY && smaller
    }

    /// The same without a drift: what is left is what changed at once.
    pub(super) fn less(self, drift: &Drift) -> Self {
        let level = |levels: &[f64], at_us: &[i64]| {
            let drifted = |us: &i64| drift.per_day * (in_days(*us) - drift.at_days);
            levels.iter().zip(at_us).map(|(level, us)| level - drifted(us)).collect()
        };
        let [before, after] = [(&self.before, &self.at_us[0]), (&self.after, &self.at_us[1])]
            .map(|(levels, at)| level(levels, at));
        Self { before, after, ..self }
    }

    /// The window narrowed to what the level was just before and just after, where it changed earlier or later by itself, and the
    /// ends of that, UTC.
    pub(super) fn at_once(&self, window: Window) -> (Window, [Option<String>; 2]) {
        let of = |levels: &[f64], at_us: &[i64], is_before: bool| {
            let points: Vec<(f64, f64)> =
                at_us.iter().map(|us| in_days(*us)).zip(levels.iter().copied()).collect();
            let found = pieces(&points).filter(|found| found.p < SURELY)?;
            let near = if is_before { found.pieces.last()? } else { found.pieces.first()? };
            let runs = near.points.clone();
            // Of one that goes on changing, its end.
            let count =
                if near.slope.abs() > 0.0 { (runs.len() / 3).max(FEWEST_OF_A_SIDE) } else { runs.len() };
            let kept = count.max(FEWEST_OF_A_SIDE).min(levels.len());
            (kept < levels.len())
                .then(|| if is_before { at_us[levels.len() - kept] } else { at_us[kept - 1] })
        };
        let from_us = of(&self.before, &self.at_us[0], true);
        let until_us = of(&self.after, &self.at_us[1], false);
        let said = [from_us, until_us].map(|us| date(in_days(us?)));
        (window.within(from_us, until_us), said)
    }
}
