//! `fleet drift`: which joint of which machine changes over the days, how fast, and since when; or at once, and when.
//!
//! A start is compared with the same start of the same plan only. Runs are what varies on its own, so the test and the
//! interval are of one level a run: that which is left when each start's own level is taken off. The slope is the median
//! over the starts of each start's Theil-Sen slope. A start that scatters from run to run, because the joint had not come to
//! rest before it, say, weighs less.

use std::{collections::BTreeMap, path::Path};

use serde::{Deserialize, Serialize};

use super::{
    failure::FleetFailure,
    history::{By, Event, Filter, History, Run, Scatters, Values, date, days},
    map::{Map, maps},
    stepped::{LevelStep, best_step},
};
use crate::{
    document::PROGRAM,
    math::{
        SIGMA_PER_MAD, begins, column_levels, false_discovery, mad, median, row_weights, step_scatter,
        theil_sen, trend, weighted_median,
    },
    remark::Remarks,
};

/// What the format is called.
const FORMAT: &str = "hydrotrace.fleet-drift.v1";
/// Runs of one plan, at least: fewer cannot prove a trend.
pub(super) const FEWEST_RUNS: usize = 5;
/// False discoveries among what is found, at most.
pub(super) const MOST_FALSE: f64 = 0.05;

/// Robust standard deviations of the fleet's slopes that a slope must stand out by to be found: less than that many
/// healthy joints change by, in a season or with other work.
const STANDS_OUT: f64 = 3.0;
/// Joints that tell what is usual, at least; of steps, which a day that all share makes in all.
const FEWEST_JOINTS: usize = 10;
const FEWEST_OF_STEPS: usize = 4;
/// A step, or what a trend makes from the first run to the last, that is a smaller share of the level is of no concern.
const RELEVANT: f64 = 0.02;

/// The trends of all joints of a fleet.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Drift {
    /// Always "hydrotrace.fleet-drift.v1".
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// Runs that were looked at.
    pub runs: usize,
    /// Machines that they are of.
    pub machines: usize,
    /// Share of false discoveries among the trends that are found, at most.
    pub false_discovery_rate: f64,
    /// The trends, one a machine, joint and metric: first those that are found, by how far they stand out from the fleet.
    pub trends: Vec<JointTrend>,
    /// How the machines did over the days, by metric.
    pub maps: Vec<Map>,
    /// Machines, joints and metrics with too few runs of one plan to tell a trend.
    pub too_few: usize,
    /// Doubts about the data.
    #[cfg_attr(test, schemars(with = "Vec<crate::remark::Remark>"))]
    pub remarks: Remarks,
}

/// The trend of one metric of one joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct JointTrend {
    /// The machine.
    pub machine: String,
    /// The joint.
    pub joint: String,
    /// What was measured.
    pub metric: By,
    /// Its unit: "s" of delays and lags, else that of the joint, "rad" or "m".
    pub unit: String,
    /// Change a day, median over the starts of each start's Theil-Sen slope, weighted by one over the square of its scatter.
    pub slope_per_day: f64,
    /// Its 95 % interval, by Kendall's test on the levels of the runs.
    pub interval_95: [f64; 2],
    /// Two-sided probability of such an order of runs by chance.
    pub p_value: f64,
    /// The same, corrected for the number of machines, joints and metrics (false-discovery rate).
    pub q_value: f64,
    /// Whether a change is found, as a trend or as a step: q below the false-discovery rate, 2 % of the level or more, and three
    /// robust standard deviations or more from what is usual where ten joints or more tell that.
    pub found: bool,
    /// Whether what is found is a step, which leaves less of the levels unexplained than the trend does.
    #[serde(default)]
    pub is_step: bool,
    /// The step that explains the levels best; null for fewer than six runs.
    #[serde(default)]
    pub step: Option<LevelStep>,
    /// The slope in robust standard deviations of the slopes of this metric in all joints; null where these are equal.
    pub stands_out: Option<f64>,
    /// When the level begins to change, UTC: of a step the first run after it, else the first run if it changes all the time.
    pub since: Option<String>,
    /// Starts that were followed from run to run.
    pub starts: usize,
    /// Runs with such starts.
    pub runs: usize,
    /// From the first run to the last, days.
    pub days: f64,
    /// Median over the starts at the level of the first three runs.
    pub level: f64,
    /// The level of each run, in the order of time; only of trends that are found.
    pub levels: Vec<Level>,
}

impl JointTrend {
    /// Growth a day: of a step that from the last run before it to the first run after it, taken as a day at least.
    pub fn growth_per_day(&self) -> f64 {
        let step = self.step.as_ref().filter(|_| self.is_step);
        step.map_or(self.slope_per_day, |step| step.change / step.days.max(1.0))
    }
}

/// What the starts of a joint were like in one run, each start's own level taken off and their median put back.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Level {
    /// When the run began, days since 1970.
    pub at_days: f64,
    /// In the unit of the trend.
    pub value: f64,
    /// The log of the run.
    pub log: String,
    /// The page that lies beside the log under its name, where there is one: `run.html` beside `run.mcap`.
    pub page: Option<String>,
}

/// The starts that enough runs have, as rows by run, with what each row says; and those runs. A start that scatters on
/// all machines says little, however quiet it was on this one.
pub(super) fn matrix(
    values: &Values,
    fewest: usize,
    (joint, scatters): (&str, &Scatters),
) -> (Vec<usize>, Vec<Vec<f64>>, Vec<f64>) {
    let often = || values.values().filter(|of_runs| of_runs.len() >= fewest);
    let mut runs: Vec<usize> = often().flat_map(|of_runs| of_runs.keys().copied()).collect();
    runs.sort_unstable();
    runs.dedup();
    let row = |of_runs: &BTreeMap<usize, f64>| {
        runs.iter().map(|run| of_runs.get(run).copied().unwrap_or(f64::NAN)).collect()
    };
    let rows = often().map(row).collect();
    let events = values.iter().filter(|(_, of_runs)| of_runs.len() >= fewest);
    let scatter = |(event, of_runs): (&Event, &BTreeMap<usize, f64>)| {
        let own = step_scatter(of_runs.values().copied());
        let usual = scatters.get(&(joint.to_owned(), event.clone())).copied();
        own.into_iter().chain(usual).reduce(f64::max)
    };
    let scatters: Vec<Option<f64>> = events.map(scatter).collect();
    (runs, rows, row_weights(&scatters))
}

/// The trends of what the filter lets through; `by`: of one metric only.
///
/// # Errors
///
/// [`FleetFailure`] if there is no dataset, or no such machine in it.
pub fn drift(root: &Path, filter: &Filter, by: &[By]) -> Result<Drift, FleetFailure> {
    let history = History::read(root, filter, false)?;
    let scatters: BTreeMap<By, Scatters> = by.iter().map(|by| (*by, history.scatters(*by))).collect();
    let none = Scatters::new();
    let mut trends = Vec::new();
    let mut too_few = 0;
    for ((axis, metric), values) in &history.values {
        if !by.contains(metric) {
            continue;
        }
        let scatters = (axis.joint.as_str(), scatters.get(metric).unwrap_or(&none));
        match joint_trend(&history.runs, values, scatters) {
            None => too_few += 1,
            Some(found) => trends.push(JointTrend {
                machine: axis.machine.clone(),
                joint: axis.joint.clone(),
                metric: *metric,
                unit: if *metric == By::Peak { axis.unit.clone() } else { "s".to_owned() },
                ..found
            }),
        }
    }
    judge(&mut trends);
    trends.sort_by(|a, b| {
        let out = |trend: &JointTrend| trend.stands_out.unwrap_or(0.0);
        let by_size = out(b).total_cmp(&out(a));
        b.found.cmp(&a.found).then(if a.found { by_size } else { a.p_value.total_cmp(&b.p_value) })
    });
    Ok(Drift {
        format: FORMAT.to_owned(),
        program: PROGRAM.to_owned(),
        runs: history.runs.len(),
        machines: history.machines().len(),
        false_discovery_rate: MOST_FALSE,
        trends,
        maps: maps(&history, by),
        too_few,
        remarks: history.remarks,
    })
}

/// Which trends and steps are found. Both are tests of the same data, so they are corrected for together.
fn judge(trends: &mut [JointTrend]) {
    let tell = stand_out(trends);
    let usual_steps = usual_steps(trends);
    let p_trend = trends.iter().map(|trend| trend.p_value);
    let p_step = trends.iter().map(|trend| trend.step.as_ref().map_or(1.0, |step| step.p_value));
    let q = false_discovery(&p_trend.chain(p_step).collect::<Vec<f64>>());
    let (q_trend, q_step) = q.split_at(trends.len());
    for (k, trend) in trends.iter_mut().enumerate() {
        trend.q_value = q_trend[k];
        let usual = tell[k] && trend.stands_out.is_some_and(|out| out < STANDS_OUT);
        let least = RELEVANT * trend.level.abs();
        let drifts =
            trend.q_value < MOST_FALSE && !usual && (trend.slope_per_day * trend.days).abs() >= least;
        let usual_step = usual_steps.get(&(trend.metric, trend.unit.clone())).copied().unwrap_or_default();
        if let Some(step) = &mut trend.step {
            step.q_value = q_step[k];
            let least = (STANDS_OUT * usual_step).max(least);
            let steps = step.q_value < MOST_FALSE && step.change.abs() >= least;
            trend.is_step = steps && (!drifts || step.left < 1.0);
            if trend.is_step {
                trend.since.clone_from(&step.by);
            }
        }
        trend.found = drifts || trend.is_step;
        if trend.found {
            trend.levels.iter_mut().for_each(|level| level.page = page_beside(&level.log));
        } else {
            trend.levels.clear();
        }
    }
}

/// What the best steps of a metric are like in most joints, as a robust standard deviation, where enough joints tell that.
fn usual_steps(trends: &[JointTrend]) -> BTreeMap<(By, String), f64> {
    let mut sizes: BTreeMap<(By, String), Vec<f64>> = BTreeMap::new();
    for trend in trends {
        let size = trend.step.as_ref().map_or(0.0, |step| step.change.abs());
        sizes.entry((trend.metric, trend.unit.clone())).or_default().push(size);
    }
    let enough = sizes.into_iter().filter(|(_, sizes)| sizes.len() >= FEWEST_OF_STEPS);
    enough.map(|(key, sizes)| (key, SIGMA_PER_MAD * median(sizes))).collect()
}

fn page_beside(log: &str) -> Option<String> {
    let page = Path::new(log).with_extension("html").canonicalize().ok()?;
    page.is_file().then(|| page.to_str().map(str::to_owned))?
}

/// Says by how much each slope differs from what is usual for its metric; gives whether enough joints tell that.
fn stand_out(trends: &mut [JointTrend]) -> Vec<bool> {
    let key = |trend: &JointTrend| (trend.metric, trend.unit.clone());
    let mut slopes: BTreeMap<_, Vec<f64>> = BTreeMap::new();
    for trend in trends.iter() {
        slopes.entry(key(trend)).or_default().push(trend.slope_per_day);
    }
    let usual = |own: Vec<f64>| (own.len() >= FEWEST_JOINTS, SIGMA_PER_MAD * mad(&own), median(own));
    let usual: BTreeMap<_, (bool, f64, f64)> =
        slopes.into_iter().map(|(key, own)| (key, usual(own))).collect();
    let judge = |trend: &mut JointTrend| {
        let (tells, spread, middle) = usual.get(&key(trend)).copied().unwrap_or_default();
        trend.stands_out = (spread > 0.0).then(|| (trend.slope_per_day - middle).abs() / spread);
        tells
    };
    trends.iter_mut().map(judge).collect()
}

/// The trend without its names; `None` for too few runs.
fn joint_trend(runs: &[Run], values: &Values, scatters: (&str, &Scatters)) -> Option<JointTrend> {
    let (own, rows, weights) = matrix(values, FEWEST_RUNS, scatters);
    let at: Vec<f64> = own.iter().filter_map(|run| runs.get(*run)).map(days).collect();
    let points = |row: &[f64]| -> Vec<(f64, f64)> {
        at.iter().copied().zip(row.iter().copied()).filter(|(_, value)| value.is_finite()).collect()
    };
    let slopes = rows.iter().map(|row| theil_sen(&points(row))).zip(weights.iter().copied());
    let slope = weighted_median(slopes.collect());
    let levels = points(&column_levels(&rows, &weights, own.len()));
    let found = trend(&levels).filter(|_| levels.len() >= FEWEST_RUNS && slope.is_finite())?;
    let [low, high] = found.interval;
    let usual = median(rows.iter().flatten().copied().filter(|value| value.is_finite()).collect());
    let level = |(at_days, level): &(f64, f64)| {
        let run = own.iter().filter_map(|run| runs.get(*run)).find(|run| (days(run) - at_days).abs() <= 0.0);
        let log = run.map(|run| run.log.clone()).unwrap_or_default();
        Level { at_days: *at_days, value: level + usual, log, page: None }
    };
    let early = rows.iter().flat_map(|row| points(row).into_iter().take(3)).map(|(_, value)| value);
    Some(JointTrend {
        machine: String::new(),
        joint: String::new(),
        metric: By::Peak,
        unit: String::new(),
        slope_per_day: slope,
        interval_95: [low.min(slope), high.max(slope)],
        p_value: found.p,
        q_value: 1.0,
        found: false,
        is_step: false,
        step: best_step(&levels),
        stands_out: None,
        since: begins(&levels).and_then(date),
        starts: rows.len(),
        runs: levels.len(),
        days: levels.last()?.0 - levels.first()?.0,
        level: median(early.collect()),
        levels: levels.iter().map(level).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::is_written_and_read;

    /// Ten runs a day apart, eight starts of their own level; a start grows by 2 a day from day four on and is lost late.
    fn values(slope: f64) -> (Vec<Run>, Values) {
        let run = |k: i64| Run {
            id: k.to_string(),
            machine: "M".into(),
            log: k.to_string(),
            started_us: k * 86_400_000_000,
        };
        let mut values = Values::new();
        for index in 0..8 {
            for k in 0..10_usize {
                let noise = 0.1 * ((k * 7 + index * 3) % 5) as f64;
                let lost = index == 7 && k > 6;
                let value = 10.0 * index as f64 + slope * k as f64 + noise;
                if !lost {
                    let event = Event { plan_id: "p".into(), index: i64::try_from(index).unwrap() };
                    values.entry(event).or_default().insert(k, value);
                }
            }
        }
        ((0..10).map(run).collect(), values)
    }

    #[test]
    fn a_slope_is_found_at_matched_starts_though_the_largest_is_lost_late() {
        let (runs, values) = values(2.0);
        let found = joint_trend(&runs, &values, ("boom", &Scatters::new())).unwrap();
        assert!((found.slope_per_day - 2.0).abs() < 0.05 && found.p_value < 1e-5, "{found:?}");
        assert!(found.interval_95[0] > 1.8 && found.interval_95[1] < 2.2, "{found:?}");
        assert_eq!((found.starts, found.runs, found.since.as_deref()), (8, 10, Some("1970-01-01T00:00:00Z")));
    }

    #[test]
    fn noise_is_no_trend_and_four_runs_prove_nothing() {
        let (runs, values) = values(0.0);
        assert!(joint_trend(&runs, &values, ("boom", &Scatters::new())).unwrap().p_value > 0.05);
        let few = values.into_iter().map(|(event, mut of)| {
            of.retain(|run, _| *run < 4);
            (event, of)
        });
        assert_eq!(joint_trend(&runs, &few.collect(), ("boom", &Scatters::new())), None);
    }

    #[test]
    fn a_level_that_jumps_is_a_step_on_the_day_it_jumps() {
        let (runs, mut values) = values(0.0);
        for of_runs in values.values_mut() {
            of_runs.iter_mut().filter(|(run, _)| **run >= 6).for_each(|(_, value)| *value += 3.0);
        }
        let mut found = vec![joint_trend(&runs, &values, ("boom", &Scatters::new())).unwrap()];
        judge(&mut found);
        let step = found[0].step.clone().unwrap();
        assert!(found[0].found && found[0].is_step, "{found:?}");
        assert_eq!(found[0].since.as_deref(), Some("1970-01-07T00:00:00Z"));
        assert!((step.change - 3.0).abs() < 0.2 && (found[0].growth_per_day() - step.change).abs() < 1e-12);
        let (runs, mut values) = super::tests::values(2.0);
        let mut drifts = vec![joint_trend(&runs, &values, ("boom", &Scatters::new())).unwrap()];
        judge(&mut drifts);
        assert!(drifts[0].found && !drifts[0].is_step, "{drifts:?}");
        values.values_mut().flat_map(BTreeMap::values_mut).for_each(|value| *value += 2000.0);
        let mut drifts = vec![joint_trend(&runs, &values, ("boom", &Scatters::new())).unwrap()];
        judge(&mut drifts);
        assert!(drifts[0].q_value < 0.01 && !drifts[0].found, "of no concern: {drifts:?}");
    }

    #[test]
    fn the_committed_schema_is_that_of_the_document_and_what_is_written_is_read_back() {
        let (runs, values) = values(1.0);
        let document = Drift {
            format: FORMAT.into(),
            program: PROGRAM.into(),
            runs: 10,
            machines: 1,
            false_discovery_rate: MOST_FALSE,
            trends: vec![joint_trend(&runs, &values, ("boom", &Scatters::new())).unwrap()],
            maps: Vec::new(),
            too_few: 0,
            remarks: Remarks::default(),
        };
        is_written_and_read(&document, "fleet-drift.v1.schema.json", "hydrotrace fleet drift, version 1");
    }
}
