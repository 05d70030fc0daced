//! The trend, the step and the course of the levels of one joint, before they are judged.

use super::{
    blocks::{borders, count},
    course::{Course, course},
    joint_trend::{FEWEST_RUNS, JointTrend, Level},
    leveled::{Leveled, points},
    run::date,
    stepped::{LevelStep, best_step},
    within::Within,
};
use crate::math::{Trend, begins, median, theil_sen, trend, weighted_median};

/// What other machines tell of how blocks lie is known so well only: what is found is there by so many standard errors less and more.
const SURE_OF_LINK: f64 = 1.5;

/// What the levels did, as far as they alone tell.
struct Tested {
    /// Probability of the order of all runs by chance.
    p_value: f64,
    /// The trend from the day on that it begins.
    trend: Trend,
    begins: f64,
    step: Option<LevelStep>,
    course: Option<Course>,
}

impl Tested {
    /// Of levels that all can be compared; days since 1970 and level.
    fn of(levels: &[(f64, f64)]) -> Option<Self> {
        let whole = trend(levels)?;
        // A rate is that of the days that it is said of.
        let since = |from: &f64| levels.iter().filter(|(at, _)| at >= from).copied().collect::<Vec<_>>();
        let enough = begins(levels).filter(|from| since(from).len() >= FEWEST_RUNS);
        let begins = enough.unwrap_or(levels.first()?.0);
        let trend = trend(&since(&begins))?;
        Some(Self { p_value: whole.p, trend, begins, step: best_step(levels), course: course(levels) })
    }

    /// Of blocks whose levels cannot be compared: only what is within them counts.
    fn within(levels: &[(f64, f64)], blocks: &[usize]) -> Option<Self> {
        let within = Within { levels, blocks };
        let trend = within.trend()?;
        let begins = levels.first()?.0;
        Some(Self { p_value: trend.p, trend, begins, step: within.best_step(), course: None })
    }

    /// As little sure as with other levels, none of which is more than the other.
    fn less_sure(mut self, other: Option<&Self>) -> Self {
        let same = |a: f64, b: f64| a * b > 0.0;
        let other_p = other.filter(|other| same(other.trend.slope, self.trend.slope));
        self.p_value = self.p_value.max(other_p.map_or(1.0, |other| other.p_value));
        if let Some(step) = &mut self.step {
            let of_other = other.and_then(|other| other.step.as_ref());
            let of_other = of_other.filter(|other| same(other.change, step.change));
            step.p_value = step.p_value.max(of_other.map_or(1.0, |other| other.p_value));
        }
        let of_other = other.and_then(|other| other.course.as_ref());
        self.course = self
            .course
            .zip(of_other)
            .map(|(own, other)| Course { p_value: own.p_value.max(other.p_value), ..own });
        self
    }
}

impl Leveled {
    /// What its levels did, by what is known of its blocks.
    fn tested(&self, blocks: &[usize]) -> Option<Tested> {
        let levels = &self.levels;
        let last = count(blocks).saturating_sub(1);
        match &self.link {
            _ if last == 0 => Tested::of(levels),
            None => Tested::within(levels, blocks),
            Some(link) => {
                let off = SURE_OF_LINK * link.error * self.unit_of_link() / last as f64;
                let moved = |by: f64| -> Vec<(f64, f64)> {
                    let each = levels.iter().zip(blocks);
                    each.map(|((at, level), block)| (*at, level + by * off * *block as f64)).collect()
                };
                let own = Tested::of(levels)?;
                let [less, more] = [-1.0, 1.0].map(|by| Tested::of(&moved(by)));
                Some(own.less_sure(less.as_ref()).less_sure(more.as_ref()))
            }
        }
    }

    /// Its trend; `None` where all runs are of one instant.
    pub(super) fn trend(&self) -> Option<JointTrend> {
        let Self { rows, weights, levels, at_days, .. } = self;
        let blocks = self.level_blocks();
        let tested = self.tested(&blocks)?;
        let begins = tested.begins;
        let of_row = |row: &Vec<f64>| {
            let later: Vec<(f64, f64)> =
                points(at_days, row).into_iter().filter(|(at, _)| *at >= begins).collect();
            theil_sen(&later)
        };
        let slope = weighted_median(rows.iter().map(of_row).zip(weights.iter().copied()).collect());
        let [low, high] = tested.trend.interval;
        // The levels that are known for fewer days than the starts are tell another slope.
        let slope = if (low..=high).contains(&slope) { slope } else { tested.trend.slope };
        let level = |(at_days, level): &(f64, f64)| {
            let log = self.at_days.iter().position(|at| (at - at_days).abs() <= 0.0);
            let log = log.and_then(|at| self.logs.get(at)).cloned().unwrap_or_default();
            Level { at_days: *at_days, value: level + self.usual, log, page: None }
        };
        let early =
            rows.iter().flat_map(|row| points(at_days, row).into_iter().take(3)).map(|(_, value)| value);
        let untold = if self.link.is_none() { borders(&blocks) } else { Vec::new() };
        Some(JointTrend {
            machine: self.machine.clone(),
            joint: self.joint.clone(),
            direction: self.direction,
            metric: self.metric,
            unit: self.unit.clone(),
            slope_per_day: slope,
            interval_95: [low, high],
            p_value: tested.p_value,
            q_value: 1.0,
            step: tested.step,
            course: tested.course.map(|course| course.above(self.usual)),
            less_common: self.less_common,
            since: date(begins),
            starts: rows.len(),
            runs: levels.len(),
            days: levels.last()?.0 - levels.first()?.0,
            changing_days: levels.last()?.0 - begins,
            level: median(early.collect()),
            levels: levels.iter().map(level).collect(),
            untold: untold.into_iter().map(|run| levels[run].0).collect(),
            ..JointTrend::default()
        })
    }
}
