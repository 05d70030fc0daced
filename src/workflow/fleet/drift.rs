//! `fleet drift`: which joint of which machine changes over the days, how fast, and since when; or at once, and when.
//!
//! A start is compared with the same start of the same plan only. Runs are what varies on its own, so the test and the
//! interval are of one level a run: that which is left when each start's own level is taken off. The slope is the median
//! over the starts of each start's Theil-Sen slope. A start that scatters from run to run, because the joint had not come to
//! rest before it, say, weighs less. The starts of each direction are judged by themselves, too.

use std::{collections::BTreeMap, path::Path};

use serde::{Deserialize, Serialize};

use super::{
    common::Commons,
    failure::FleetFailure,
    found::judge,
    history::{By, Filter, History, Scatters, Values},
    joint_trend::{FEWEST_RUNS, JointTrend, MOST_FALSE},
    leveled::Leveled,
    map::{Map, maps},
    one_way::{by_direction, clearest},
};
use crate::{document::PROGRAM, remark::Remarks};

/// What the format is called.
const FORMAT: &str = "hydrotrace.fleet-drift.v1";

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
    /// The trends, one a machine, joint and metric: first those that are found, what grows before what falls, by how far they stand out
    /// from the fleet.
    pub trends: Vec<JointTrend>,
    /// How the machines did over the days, by metric.
    pub maps: Vec<Map>,
    /// Machines, joints and metrics with too few runs of one plan to tell a trend.
    pub too_few: usize,
    /// Runs that a trend takes at least to be found among so many, if all of them are in order.
    #[serde(default)]
    pub fewest_runs: usize,
    /// Doubts about the data.
    pub remarks: Remarks,
}

/// The trends of what the filter lets through, judged against the whole fleet; `by`: of one metric only.
///
/// # Errors
///
/// [`FleetFailure`] if there is no dataset, or no such machine in it.
pub fn drift(root: &Path, filter: &Filter, by: &[By]) -> Result<Drift, FleetFailure> {
    let history = History::read(root, filter, true)?;
    let wanted = |machine: &str| filter.machine.as_ref().is_none_or(|own| own == machine);
    let scatters: BTreeMap<By, Scatters> = by.iter().map(|by| (*by, history.scatters(*by))).collect();
    let none = Scatters::new();
    let mut joints = Vec::new();
    let mut too_few = 0;
    for ((axis, metric), values) in &history.values {
        if !by.contains(metric) {
            continue;
        }
        let scatters = (axis.joint.as_str(), scatters.get(metric).unwrap_or(&none));
        let leveled = |values: &Values, direction| {
            let found = Leveled::of(*metric, &history.runs, values, scatters)?;
            let unit = if *metric == By::Peak { axis.unit.clone() } else { "s".to_owned() };
            Some(Leveled {
                machine: axis.machine.clone(),
                joint: axis.joint.clone(),
                direction,
                unit,
                ..found
            })
        };
        let Some(found) = leveled(values, None) else {
            too_few += usize::from(wanted(&axis.machine));
            continue;
        };
        joints.push(found);
        for (direction, own) in by_direction(&history, axis, values) {
            joints.extend(leveled(&own, Some(direction)));
        }
    }
    let commons = Commons::of(&joints);
    let mut trends: Vec<JointTrend> = joints
        .into_iter()
        .filter_map(|joint| {
            let common = commons.at(&joint);
            let shared_per_day = common.as_ref().and_then(|common| joint.shared_per_day(common));
            Some(JointTrend { shared_per_day, ..joint.less(common).trend()? })
        })
        .collect();
    judge(&mut trends);
    let fewest_runs = fewest_runs(trends.len());
    let mut trends = clearest(trends);
    trends.retain(|trend| wanted(&trend.machine));
    trends.sort_by(|a, b| {
        let out = |trend: &JointTrend| trend.stands_out.unwrap_or(0.0);
        let by_size = out(b).total_cmp(&out(a));
        // What became better is no reason to go to the machine.
        let worse = |trend: &JointTrend| trend.found && trend.growth_per_day() > 0.0;
        let first = b.found.cmp(&a.found).then(worse(b).cmp(&worse(a)));
        first.then(if a.found { by_size } else { a.p_value.total_cmp(&b.p_value) })
    });
    Ok(Drift {
        format: FORMAT.to_owned(),
        program: PROGRAM.to_owned(),
        runs: history.runs.iter().filter(|run| wanted(&run.machine)).count(),
        machines: history.machines().into_iter().filter(|machine| wanted(machine)).count(),
        false_discovery_rate: MOST_FALSE,
        trends,
        maps: maps(&history, by, wanted),
        too_few,
        fewest_runs,
        remarks: history.remarks,
    })
}

/// Runs that make a trend sure among so many, each of which is tested as a step, too: in order by chance are two of all orders.
fn fewest_runs(trends: usize) -> usize {
    let by_chance = |runs: usize| 2.0 / (1..=runs).map(|k| k as f64).product::<f64>();
    (FEWEST_RUNS..100)
        .find(|runs| by_chance(*runs) * 2.0 * (trends as f64) < MOST_FALSE)
        .unwrap_or(FEWEST_RUNS)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::{
        super::{history::Event, run::Run},
        *,
    };

    fn joint_trend(by: By, runs: &[Run], values: &Values, scatters: (&str, &Scatters)) -> Option<JointTrend> {
        Leveled::of(by, runs, values, scatters)?.trend()
    }

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
        let found = joint_trend(By::Delay, &runs, &values, ("boom", &Scatters::new())).unwrap();
        assert!((found.slope_per_day - 2.0).abs() < 0.05 && found.p_value < 1e-5, "{found:?}");
        assert!(found.interval_95[0] > 1.8 && found.interval_95[1] < 2.2, "{found:?}");
        assert_eq!((found.starts, found.runs, found.since.as_deref()), (8, 10, Some("1970-01-01T00:00:00Z")));
    }

    /// What grows by a tenth of its first value a day does so at slow and at fast starts, which scatter in proportion.
    #[test]
    fn the_slowest_start_does_not_say_all_of_a_peak_error() {
        let (runs, mut values) = values(0.0);
        for (event, of_runs) in &mut values {
            for (run, value) in of_runs {
                let noise = 0.01 * ((*run * 7 + usize::try_from(event.index).unwrap() * 3) % 5) as f64;
                *value = (1.0 + event.index as f64) * (1.0 + 0.1 * *run as f64 + noise);
            }
        }
        let found = joint_trend(By::Peak, &runs, &values, ("boom", &Scatters::new())).unwrap();
        // The middle one of starts that grow by 0.1 to 0.8.
        assert!((found.slope_per_day - 0.45).abs() < 0.03 && found.p_value < 1e-5, "{found:?}");
        assert!(found.levels.iter().all(|level| level.value > 0.0), "{:?}", found.levels);
    }

    #[test]
    fn more_trends_take_more_runs() {
        assert_eq!([1, 16, 48, 720].map(fewest_runs), [5, 7, 7, 9]);
    }

    #[test]
    fn noise_is_no_trend_and_four_runs_prove_nothing() {
        let (runs, values) = values(0.0);
        assert!(joint_trend(By::Delay, &runs, &values, ("boom", &Scatters::new())).unwrap().p_value > 0.05);
        let few = values.into_iter().map(|(event, mut of)| {
            of.retain(|run, _| *run < 4);
            (event, of)
        });
        assert_eq!(joint_trend(By::Delay, &runs, &few.collect(), ("boom", &Scatters::new())), None);
    }

    #[test]
    fn a_level_that_jumps_is_a_step_on_the_day_it_jumps() {
        let (runs, mut values) = values(0.0);
        for of_runs in values.values_mut() {
            of_runs.iter_mut().filter(|(run, _)| **run >= 6).for_each(|(_, value)| *value += 3.0);
        }
        let mut found = vec![joint_trend(By::Delay, &runs, &values, ("boom", &Scatters::new())).unwrap()];
        judge(&mut found);
        let step = found[0].step.clone().unwrap();
        assert!(found[0].found && found[0].is_step, "{found:?}");
        assert_eq!(found[0].since.as_deref(), Some("1970-01-07T00:00:00Z"));
        assert!((step.change - 3.0).abs() < 0.2 && (found[0].growth_per_day() - step.change).abs() < 1e-12);
        let (runs, mut values) = super::tests::values(2.0);
        let mut drifts = vec![joint_trend(By::Delay, &runs, &values, ("boom", &Scatters::new())).unwrap()];
        judge(&mut drifts);
        assert!(drifts[0].found && !drifts[0].is_step, "{drifts:?}");
        values.values_mut().flat_map(BTreeMap::values_mut).for_each(|value| *value += 2000.0);
        let mut drifts = vec![joint_trend(By::Delay, &runs, &values, ("boom", &Scatters::new())).unwrap()];
        judge(&mut drifts);
        assert!(drifts[0].q_value < 0.01 && !drifts[0].found, "of no concern: {drifts:?}");
    }
}
