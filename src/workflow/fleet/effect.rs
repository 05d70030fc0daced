//! `fleet effect`: what a repair or a change did to a machine, at matched starts, against the rest of the fleet.
//!
//! The level of each run is what is left when each start's own level is taken off. The effect is the mean level after
//! the change minus the mean before it, less what the other machines changed by in the same time (their median). It is
//! known no better than the machine's own runs scatter, nor than the other machines change without any reason.

use std::{collections::BTreeSet, path::Path};

use serde::{Deserialize, Serialize};

use super::{
    doubts,
    failure::FleetFailure,
    history::{Axis, By, Filter, History, Values},
    joint_trend::{FEWEST_OF_A_SIDE, MOST_FALSE},
    note::{Intervention, Note, notes},
    run::date,
    sides::{Drift, Sides},
    window::Window,
};
use crate::{
    document::PROGRAM,
    math::{SIGMA_PER_MAD, difference, false_discovery, mad, median},
    remark::Remarks,
    units::SECONDS_PER_DAY,
};

/// What the format is called.
const FORMAT: &str = "hydrotrace.fleet-effect.v1";
/// Machines beside the one that changed, at least: fewer tell nothing of what is usual.
const FEWEST_OTHERS: usize = 3;

/// What a change did.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Effect {
    /// Always "hydrotrace.fleet-effect.v1".
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// The machine.
    pub machine: String,
    /// When it was changed, UTC.
    pub at: String,
    /// What was done, as it is noted; null where the caller named the instant.
    #[serde(default)]
    pub what: Option<String>,
    /// What was noted last before and first after it, where there is such a thing: runs beyond these are left out.
    #[serde(default)]
    pub between: Vec<Intervention>,
    /// What was noted with fewer than three runs between: the effect is that of all of it.
    #[serde(default)]
    pub together: Vec<Intervention>,
    /// Runs of the machine before.
    pub runs_before: usize,
    /// Runs of the machine after.
    pub runs_after: usize,
    /// Share of false discoveries among the effects that are found, at most.
    pub false_discovery_rate: f64,
    /// By joint and metric, those that are found first.
    pub effects: Vec<JointEffect>,
    /// Joints and metrics with fewer than three runs of one plan before or after.
    pub too_few: usize,
    /// Doubts about the data.
    pub remarks: Remarks,
}

/// What a change did to one metric of one joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct JointEffect {
    /// The joint.
    pub joint: String,
    /// What was measured.
    pub metric: By,
    /// Its unit: "s" of delays and lags, else that of the joint, "rad" or "m".
    pub unit: String,
    /// Median over the starts before.
    pub before: f64,
    /// After minus before at matched starts, less what is usual in the rest of the fleet.
    pub change: f64,
    /// Its 95 % interval.
    pub interval_95: [f64; 2],
    /// The first run before that is compared, UTC, where the level had changed before that.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub since: Option<String>,
    /// The last run after that is compared, UTC, where the level changed again after that.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<String>,
    /// By how much a day its level changed before as after, where it did: that is taken off the change.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drift_per_day: Option<f64>,
    /// What the rest of the fleet changed by in the same time, median over machines; null for too few machines.
    pub usual_change: Option<f64>,
    /// Among all machines with this joint, how many changed as much or more, this one included.
    pub rank: usize,
    /// How many machines that are.
    pub of: usize,
    /// Two-sided probability of such a change by chance.
    pub p_value: f64,
    /// The same, corrected for the number of joints and metrics (false-discovery rate).
    pub q_value: f64,
    /// Whether the effect is found: q below the false-discovery rate.
    pub found: bool,
    /// Starts that were followed.
    pub starts: usize,
}

/// The effect of a change of a machine at an instant, microseconds since 1970; a run that begins then is after it. Runs before
/// what was noted of the joint earlier, or after what was noted later, tell of something else: they are left out.
///
/// # Errors
///
/// [`FleetFailure`] if there is no dataset, or no such machine in it.
pub fn effect(
    root: &Path,
    machine: &str,
    at_us: i64,
    filter: &Filter,
    by: &[By],
) -> Result<Effect, FleetFailure> {
    let filter = Filter { machine: Some(machine.to_owned()), ..filter.clone() };
    let history = History::read(root, &filter, true)?;
    let noted = notes(root, Some(machine))?;
    let own_runs = || history.runs.iter().filter(|run| run.machine == machine);
    let runs_us: Vec<i64> = own_runs().map(|run| run.started_us).collect();
    let of_joint = |joint: Option<&str>| {
        let about = |note: &&Note| note.joint.is_none() || joint.is_some() && note.joint.as_deref() == joint;
        let noted: Vec<&Note> = noted.iter().filter(about).collect();
        (Window::of(at_us, filter.since_us, &runs_us, noted.iter().copied()), noted)
    };
    let (whole, of_whole) = of_joint(filter.joint.as_deref());
    // Both sides have days enough, or neither is of days.
    let enough = |days: &[i64]| {
        let before = days.iter().filter(|day_us| **day_us < at_us).count();
        before.min(days.len() - before) >= FEWEST_OF_A_SIDE
    };
    // What was done on a day parts it.
    let splits_us: Vec<i64> = noted.iter().map(|note| note.at_us).chain([at_us]).collect();
    let (daily, few) = history.by_day(&splits_us, enough);
    let own =
        daily.values.iter().filter(|((axis, metric), _)| axis.machine == machine && by.contains(metric));
    let mut effects = Vec::new();
    let mut too_few = 0;
    for ((axis, metric), values) in own {
        match joint_effect(&daily, axis, *metric, values, of_joint(Some(&axis.joint)).0) {
            Some(found) => effects.push(found),
            None => too_few += 1,
        }
    }
    let p: Vec<f64> = effects.iter().map(|effect| effect.p_value).collect();
    for (effect, q) in effects.iter_mut().zip(false_discovery(&p)) {
        effect.q_value = q;
        effect.found = q < MOST_FALSE;
    }
    effects.sort_by(|a, b| {
        let share = |effect: &JointEffect| (effect.change / effect.before).abs();
        let by_share = share(b).total_cmp(&share(a));
        b.found.cmp(&a.found).then(if a.found { by_share } else { a.p_value.total_cmp(&b.p_value) })
    });
    let runs =
        |after: bool| own_runs().filter(|run| whole.holds(run) && whole.is_after(run) == after).count();
    let [between, together] = whole.beside(&of_whole);
    let mut remarks = history.remarks.clone();
    let found = effects.iter().any(|effect| effect.found);
    let few: Vec<String> = few.into_iter().filter(|few| found && few == machine).collect();
    doubts::few_days(&few, &mut remarks);
    Ok(Effect {
        format: FORMAT.to_owned(),
        program: PROGRAM.to_owned(),
        machine: machine.to_owned(),
        at: date(at_us as f64 / 1e6 / SECONDS_PER_DAY).unwrap_or_default(),
        what: None,
        between,
        together,
        runs_before: runs(false),
        runs_after: runs(true),
        false_discovery_rate: MOST_FALSE,
        effects,
        too_few,
        remarks,
    })
}

/// The effect of what was done last, of the machine or of any; where it was done to one joint, of that one unless the
/// filter names another.
///
/// # Errors
///
/// [`FleetFailure::NoNote`] if nothing is noted; otherwise as [`effect`].
pub fn effect_of_last_note(
    root: &Path,
    machine: Option<&str>,
    filter: &Filter,
    by: &[By],
) -> Result<Effect, FleetFailure> {
    let last = notes(root, machine)?.pop().ok_or_else(|| FleetFailure::NoNote {
        machine: machine.map(str::to_owned),
        dataset: root.to_owned(),
    })?;
    let filter = Filter { joint: filter.joint.clone().or(last.joint), ..filter.clone() };
    Ok(Effect { what: Some(last.what), ..effect(root, &last.machine, last.at_us, &filter, by)? })
}

fn joint_effect(
    history: &History,
    axis: &Axis,
    metric: By,
    values: &Values,
    window: Window,
) -> Option<JointEffect> {
    let scatters = history.scatters(metric);
    let sides = |axis: &Axis, values: &Values, window: Window| {
        Sides::of(history, metric, (axis.joint.as_str(), &scatters), values, window)
    };
    // What the level was just before and just after.
    let (window, [since, until]) = sides(axis, values, window).at_once(window);
    let own_sides = sides(axis, values, window);
    let drift = own_sides.drift().filter(|drift| own_sides.has(drift));
    let without = |sides: Sides, drift: Option<&Drift>| match drift {
        Some(drift) => sides.less(drift),
        None => sides,
    };
    let own_sides = without(own_sides, drift.as_ref());
    let own = own_sides.change()?;
    let alike = |(other, by): &&(Axis, By)| *by == metric && other.machine != axis.machine;
    // Peak errors of other joints change in proportion.
    let change = |(other, of): (&Axis, &Values)| {
        let found = sides(other, of, window);
        // What they do by themselves all the time is no measure of what is left here.
        let of_its_own = found.drift().filter(|_| drift.is_some());
        let found = without(found, of_its_own.as_ref());
        let same = other.joint == axis.joint && other.unit == axis.unit;
        let scale = if metric == By::Peak && !same { own_sides.level / found.level } else { 1.0 };
        found.change().map(|change| scale * change).filter(|change| change.is_finite())
    };
    let others = || history.values.iter().filter(|(key, _)| alike(key));
    let same = |other: &Axis| (&other.joint, &other.unit) == (&axis.joint, &axis.unit);
    let of_same = others().filter(|((other, _), _)| same(other));
    let of_same: Vec<f64> = of_same.filter_map(|((other, _), of)| change((other, of))).collect();
    let of_joints = || {
        let machines: BTreeSet<&str> = others().map(|((other, _), _)| other.machine.as_str()).collect();
        let changes: Vec<f64> = others().filter_map(|((other, _), of)| change((other, of))).collect();
        (machines.len() >= FEWEST_OTHERS && changes.len() >= FEWEST_OTHERS).then_some(changes)
    };
    let told = Some(of_same.clone()).filter(|same| same.len() >= FEWEST_OTHERS).or_else(of_joints);
    let usual = told.map(|told| (median(told.clone()), SIGMA_PER_MAD * mad(&told), told.len()));
    let (usual_change, spread, count) = usual.unwrap_or((0.0, 0.0, 1));
    let error =
        (1.2533 * spread / (count as f64).sqrt()).hypot(drift.as_ref().map_or(0.0, Drift::error_of_change));
    let found = difference(&own_sides.before, &own_sides.after, (usual_change, error, spread))?;
    let as_much =
        of_same.iter().filter(|other| (*other - usual_change).abs() >= (own - usual_change).abs()).count();
    Some(JointEffect {
        joint: axis.joint.clone(),
        metric,
        unit: if metric == By::Peak { axis.unit.clone() } else { "s".to_owned() },
        before: own_sides.level,
        change: found.value,
        interval_95: found.interval,
        since,
        until,
        drift_per_day: drift.map(|drift| drift.per_day),
        usual_change: usual.map(|(change, ..)| change),
        rank: 1 + as_much,
        of: 1 + of_same.len(),
        p_value: found.p,
        q_value: 1.0,
        found: false,
        starts: own_sides.starts,
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::workflow::fleet::{history::Event, run::Run};

    /// Six machines over ten days; all get better by 1 on day five, the first one by 4.
    fn history() -> History {
        let mut history = History::default();
        for k in 0..60_i64 {
            let machine = format!("M{}", k % 6);
            let run =
                Run { id: k.to_string(), log: k.to_string(), started_us: k / 6 * 86_400_000_000, machine };
            for (joint, share) in [("boom", 1.0), ("stick", 0.0)] {
                let unit = "rad".to_owned();
                let axis = Axis { machine: run.machine.clone(), joint: joint.to_owned(), unit };
                let values = history.values.entry((axis, By::Delay)).or_default();
                for index in 0..5 {
                    let better = if k % 6 == 0 { 1.0 + 3.0 * share } else { 1.0 };
                    let change = if k / 6 >= 5 { -better } else { 0.0 };
                    let noise = 0.01 * (((k * 13 + index * 7) % 11) as f64 - 5.0);
                    let event = Event { plan_id: "p".into(), index };
                    let value = 20.0 + 3.0 * index as f64 + change + noise;
                    values.entry(event).or_default().insert(usize::try_from(k).unwrap(), value);
                }
            }
            history.runs.push(run);
        }
        history
    }

    fn window() -> Window {
        Window::of(5 * 86_400_000_000, None, &[], [].iter())
    }

    #[test]
    fn what_the_whole_fleet_does_is_no_effect_of_the_repair() {
        let history = history();
        let of = |joint: &str| {
            let found =
                history.values.iter().find(|((axis, _), _)| axis.machine == "M0" && axis.joint == joint);
            let ((axis, metric), values) = found.unwrap();
            joint_effect(&history, axis, *metric, values, window()).unwrap()
        };
        let boom = of("boom");
        assert!((boom.change + 3.0).abs() < 0.2 && boom.p_value < 1e-4, "{boom:?}");
        assert!((boom.usual_change.unwrap() + 1.0).abs() < 0.2 && (boom.rank, boom.of) == (1, 6), "{boom:?}");
        let stick = of("stick");
        assert!(stick.change.abs() < 0.2 && stick.p_value > 0.05, "{stick:?}");
    }

    #[test]
    fn a_drift_that_goes_on_is_no_effect_and_what_came_beside_it_is() {
        let of = |jump: f64| {
            let mut history = history();
            for ((axis, _), values) in &mut history.values {
                let own = axis.machine == "M0" && axis.joint == "stick";
                for (run, value) in values.values_mut().flatten().filter(|_| own) {
                    let day = (*run / 6) as f64;
                    *value += 0.5 * day + if day >= 5.0 { jump } else { 0.0 };
                }
            }
            let found =
                history.values.iter().find(|((axis, _), _)| axis.machine == "M0" && axis.joint == "stick");
            let ((axis, metric), values) = found.unwrap();
            joint_effect(&history, axis, *metric, values, window()).unwrap()
        };
        let none = of(0.0);
        assert!(none.change.abs() < 0.1 && none.p_value > 0.05, "{none:?}");
        assert!((none.drift_per_day.unwrap() - 0.5).abs() < 0.02, "{none:?}");
        let some = of(2.0);
        assert!((some.change - 2.0).abs() < 0.1 && some.p_value < 1e-3, "{some:?}");
        // One that all machines share.
        let mut history = history();
        for of_run in history.values.values_mut().flat_map(BTreeMap::values_mut) {
            for (run, value) in of_run {
                *value += 0.5 * (*run / 6) as f64;
            }
        }
        for ((axis, metric), values) in &history.values {
            if axis.joint == "stick" {
                let found = joint_effect(&history, axis, *metric, values, window()).unwrap();
                assert!(found.change.abs() < 0.2 && found.p_value > 0.01, "{found:?}");
            }
        }
    }
}
