//! `fleet drift`: which joint of which machine changes over the days, how fast, and since when; or at once, and when.
//!
//! A start is compared with the same start of the same plan only. Runs are what varies on its own, so the test and the
//! interval are of one level a run: that which is left when each start's own level is taken off. The slope is the median
//! over the starts of each start's Theil-Sen slope. A start that scatters from run to run, because the joint had not come to
//! rest before it, say, weighs less. The starts of each direction are judged by themselves, too.
//!
//! A new plan has other starts, so the levels before it and from it on are told apart by what four other machines or more did that ran
//! both plans. Where fewer did, only what lies before or after it is judged, and a remark says so.

use std::{collections::BTreeSet, path::Path};

use serde::{Deserialize, Serialize};

use super::{
    alike::Alike,
    doubts,
    failure::FleetFailure,
    history::{By, Filter, History},
    joint_trend::{FEWEST_RUNS, JointTrend, MOST_FALSE},
    judged::{Judged, judged},
    map::{Map, maps},
    one_way::clearest,
    run::date,
};
use crate::{
    document::PROGRAM,
    remark::{Code, Remarks},
};

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
    /// What most machines did alike, which is taken off the trends.
    #[serde(default)]
    pub alike: Vec<Alike>,
    /// Machines, joints and metrics with too few runs of one plan to tell a trend.
    pub too_few: usize,
    /// Runs that a trend takes at least to be found among so many, if all of them are in order.
    #[serde(default)]
    pub fewest_runs: usize,
    /// Doubts about the data.
    pub remarks: Remarks,
}

impl Drift {
    /// Trends that have runs enough to be found, or not to be there.
    pub fn judged(&self) -> usize {
        self.trends.iter().filter(|trend| trend.found || trend.runs >= self.fewest_runs).count()
    }
}

/// The trends of what the filter lets through, judged against the whole fleet; `by`: of one metric only.
///
/// # Errors
///
/// [`FleetFailure`] if there is no dataset, or no such machine in it.
pub fn drift(root: &Path, filter: &Filter, by: &[By]) -> Result<Drift, FleetFailure> {
    // What is found does not depend on what is shown of it.
    let mut history = History::read(root, &Filter { joint: None, ..filter.clone() }, true)?;
    history.check_joint(filter)?;
    let wanted = |machine: &str| filter.machine.as_ref().is_none_or(|own| own == machine);
    let shown = |joint: &str| filter.joint.as_ref().is_none_or(|own| own == joint);
    let (daily, mut of_few_days) = history.by_day(&[], |days| days.len() >= FEWEST_RUNS);
    let Judged { trends, few, alike } = judged(&daily, by);
    of_few_days.retain(|machine| trends.iter().any(|trend| trend.found && trend.machine == *machine));
    doubts::few_days(&of_few_days, &mut history.remarks);
    let too_few = few.iter().filter(|axis| wanted(&axis.machine) && shown(&axis.joint)).count();
    let fewest_runs = fewest_runs(trends.len());
    let mut trends = clearest(trends);
    trends.retain(|trend| wanted(&trend.machine) && shown(&trend.joint));
    history.values.retain(|(axis, _), _| shown(&axis.joint));
    untold(&trends, &mut history.remarks);
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
        alike,
        too_few,
        fewest_runs,
        remarks: history.remarks,
    })
}

/// Says which joints have another plan from a day on, so that nothing tells what they did on that very day.
fn untold(trends: &[JointTrend], remarks: &mut Remarks) {
    let split = || trends.iter().filter(|trend| !trend.untold.is_empty());
    let joints: BTreeSet<(&str, &str)> = split().map(|trend| (&*trend.machine, &*trend.joint)).collect();
    let Some(first) = split().min_by(|a, b| a.untold[0].total_cmp(&b.untold[0])) else { return };
    let day = date(first.untold[0]).unwrap_or_default();
    let message = format!(
        "joints whose plan changed, as of {} {} on {}: whether a joint changed on that very day cannot be told, for no start is in both \
         plans, and fewer than four other machines ran both",
        first.machine,
        first.joint,
        day.get(..10).unwrap_or_default()
    );
    remarks.add(Code::OtherPlan, joints.len() as u64, message);
}

/// Runs that make a trend sure among so many, each of which is tested as a step, too: in order by chance are two of all orders.
fn fewest_runs(trends: usize) -> usize {
    let by_chance = |runs: usize| 2.0 / (1..=runs).map(|k| k as f64).product::<f64>();
    (FEWEST_RUNS..100)
        .find(|runs| by_chance(*runs) * 2.0 * (trends as f64) < MOST_FALSE)
        .unwrap_or(FEWEST_RUNS)
}

#[cfg(test)]
pub(super) mod tests {
    use std::collections::BTreeMap;

    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::{
        super::{
            found::judge,
            history::{Axis, Event, Scatters, Values},
            leveled::Leveled,
            run::Run,
        },
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

    /// Machines with two joints that run once a day, each start with its own level; `of`: the dead time beside that by machine, day and joint
    /// and the plan of the day, s.
    pub(in super::super) fn fleet(
        seed: u64,
        machines: u32,
        of: impl Fn(u32, u32, usize) -> (f64, &'static str),
    ) -> History {
        let mut history = History::default();
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let mut noise = |sd: f64| -> f64 { sd * Distribution::<f64>::sample(&StandardNormal, &mut rng) };
        for (day, machine) in (0..14).flat_map(|day| (0..machines).map(move |machine| (day, machine))) {
            let run = history.runs.len();
            let started_us = i64::from(20_000 + day) * 86_400_000_000 + i64::from(machine) * 3_600_000_000;
            let (id, name) = (run.to_string(), format!("M{machine}"));
            history.runs.push(Run { log: id.clone(), id, machine: name.clone(), started_us });
            for (joint, of_joint) in ["boom", "stick"].into_iter().zip(0..) {
                let (more, plan) = of(machine, day, of_joint);
                let axis = Axis { machine: name.clone(), joint: joint.into(), unit: "rad".into() };
                let values = history.values.entry((axis, By::Delay)).or_default();
                let of_run = noise(0.01);
                for index in 0..4_i32 {
                    // Another plan has other starts.
                    let own = 0.2 + 0.02 * f64::from(index) + if plan == "p" { 0.0 } else { 0.07 };
                    let event = Event { plan_id: plan.into(), index: index.into() };
                    values.entry(event).or_default().insert(run, own + more + of_run + noise(0.015));
                }
            }
        }
        history
    }

    pub(in super::super) fn found(history: &History) -> Vec<JointTrend> {
        clearest(judged(history, &[By::Delay]).trends).into_iter().filter(|trend| trend.found).collect()
    }

    pub(in super::super) fn judged_alike(history: &History) -> Vec<Alike> {
        judged(history, &[By::Delay]).alike
    }

    fn plan(is_new: bool) -> &'static str {
        if is_new { "q" } else { "p" }
    }

    #[test]
    fn a_new_plan_is_no_change_of_the_machines_that_run_it() {
        let all = |_: u32, day: u32, _: usize| (0.0, plan(day >= 7));
        let one = |machine: u32, day: u32, _: usize| (0.0, plan(machine == 1 && day >= 7));
        let each = |machine: u32, day: u32, _: usize| (0.0, plan(day >= 5 + machine));
        let fleets = |of: &dyn Fn(u32, u32, usize) -> (f64, &'static str)| {
            (0..10).filter(|seed| !found(&fleet(*seed, 5, of)).is_empty()).count()
        };
        let with_finds = [fleets(&all), fleets(&one), fleets(&each)];
        assert!(with_finds.iter().sum::<usize>() <= 2, "of ten fleets each: {with_finds:?}");
    }

    #[test]
    fn a_step_on_the_day_of_a_new_plan_is_told_by_four_others_and_else_said_to_be_unknown() {
        let of = |all: bool| {
            move |machine: u32, day: u32, joint: usize| {
                let more = if (machine, joint) == (1, 0) && day >= 7 { 0.15 } else { 0.0 };
                (more, plan(day >= 7 && (all || machine == 1)))
            }
        };
        for seed in 0..5 {
            let found = found(&fleet(seed, 5, of(true)));
            let [step] = found.as_slice() else { panic!("{found:?}") };
            assert!(
                (step.machine.as_str(), step.joint.as_str(), step.is_step) == ("M1", "boom", true),
                "{step:?}"
            );
            assert!(step.step.as_ref().is_some_and(|step| (step.change - 0.15).abs() < 0.04), "{step:?}");
            assert!(step.untold.is_empty());
            let trends = clearest(judged(&fleet(seed, 5, of(false)), &[By::Delay]).trends);
            let mut remarks = Remarks::default();
            untold(&trends, &mut remarks);
            assert_eq!(remarks.as_slice()[0].count, 2, "both joints of one machine: {remarks:?}");
            assert!(remarks.as_slice()[0].message.contains("M1 boom on 2024-10-11"), "{remarks:?}");
        }
    }

    #[test]
    fn a_joint_that_drifts_makes_no_finding_of_others_and_is_found_beyond_a_new_plan() {
        let drifts = |machine: u32, day: u32, joint: usize| {
            if (machine, joint) == (1, 0) { 0.01 * f64::from(day) } else { 0.0 }
        };
        let mut others = 0;
        for seed in 0..10 {
            let same = found(&fleet(seed, 5, |machine, day, joint| (drifts(machine, day, joint), "p")));
            let new =
                found(&fleet(seed, 5, |machine, day, joint| (drifts(machine, day, joint), plan(day >= 7))));
            for found in [same, new] {
                let own =
                    |trend: &&JointTrend| (trend.machine.as_str(), trend.joint.as_str()) == ("M1", "boom");
                assert!(found.iter().any(|trend| own(&trend) && !trend.is_step), "{seed}: {found:?}");
                others += found.iter().filter(|trend| !own(trend)).count();
            }
        }
        assert!(others <= 2, "{others} of twenty fleets");
    }
}
