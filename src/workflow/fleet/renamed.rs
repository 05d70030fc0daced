//! Joints that are spelt in two ways: a name in other case or with other separators is the same joint, and the plan that names it so the
//! same plan.

use std::collections::{BTreeMap, BTreeSet};

use super::{doubts::plain, run::Run};
use crate::{
    log::dataset::Cell,
    math::median,
    remark::{Code, Remarks},
};

/// Starts of one plan lie so near to one another in two runs, counted from the first start, s.
pub(super) const SAME_ONSET_S: f64 = 0.05;

/// Where rows of starts and of joints name their run.
pub(super) const RUN: usize = 0;
/// Where they name their plan.
pub(super) const PLAN: usize = 1;
/// Where they name their joint.
pub(super) const JOINT: usize = 2;
/// Where the number of a start within its joint stands.
pub(super) const INDEX: usize = 4;
/// Where the instant of a start stands.
const ONSET: usize = 5;
/// Where the direction of a start stands.
const DIRECTION: usize = 9;

/// The other spelling of a joint, by machine and spelling.
type Renamed = BTreeMap<(String, String), String>;

/// Each start of a plan by joint and number: its direction, and how long after the first one it lies, s.
pub(super) type Shape = BTreeMap<(String, i64), (i64, f64)>;

/// The same of each run.
type Told = BTreeMap<(String, i64), (i64, Vec<f64>)>;

/// Takes the spellings of a joint within a machine as one, where no run has both, and the plans that name it so; and says so.
pub(super) fn as_one(runs: &[Run], tables: [&mut Vec<Vec<Cell>>; 2], remarks: &mut Remarks) {
    let machines: BTreeMap<&str, &str> =
        runs.iter().map(|run| (run.id.as_str(), run.machine.as_str())).collect();
    let [starts, lags] = tables;
    let renamed = renamed(&machines, [starts, lags], remarks);
    if renamed.is_empty() {
        return;
    }
    let mut plans = BTreeSet::new();
    for row in starts.iter_mut().chain(lags.iter_mut()) {
        let Some((run, joint)) = row[RUN].as_text().zip(row[JOINT].as_text()) else { continue };
        let key = (machines.get(run).copied().unwrap_or_default().to_owned(), joint.to_owned());
        if let Some(name) = renamed.get(&key) {
            plans.extend(row[PLAN].as_text().map(str::to_owned));
            row[JOINT] = Cell::from(name.as_str());
        }
    }
    let shapes = shapes(starts);
    for plan in &plans {
        let Some(own) = shapes.get(plan) else { continue };
        let mut others = shapes.iter().filter(|(id, other)| !plans.contains(*id) && alike(own, other));
        // One of two would be a guess.
        let (Some((other, _)), None) = (others.next(), others.next()) else { continue };
        for row in starts.iter_mut().chain(lags.iter_mut()) {
            if row[PLAN].as_text() == Some(plan) {
                row[PLAN] = Cell::from(other.as_str());
            }
        }
    }
}

/// The names to take, by machine and spelling: of each joint that which most runs have.
fn renamed(machines: &BTreeMap<&str, &str>, tables: [&Vec<Vec<Cell>>; 2], remarks: &mut Remarks) -> Renamed {
    let mut of_runs: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for row in tables.into_iter().flatten() {
        if let Some((run, joint)) = row[RUN].as_text().zip(row[JOINT].as_text()) {
            of_runs.entry(run).or_default().insert(joint);
        }
    }
    let mut often: BTreeMap<&str, usize> = BTreeMap::new();
    let mut spellings: BTreeMap<(&str, String), BTreeSet<&str>> = BTreeMap::new();
    let mut together = BTreeSet::new();
    for (run, joints) in of_runs {
        let Some(machine) = machines.get(run) else { continue };
        let mut seen = BTreeSet::new();
        for joint in joints {
            *often.entry(joint).or_default() += 1;
            spellings.entry((machine, plain(joint))).or_default().insert(joint);
            if !seen.insert(plain(joint)) {
                together.insert((*machine, plain(joint)));
            }
        }
    }
    let mut found = Renamed::new();
    let twice = spellings.iter().filter(|(key, names)| names.len() > 1 && !together.contains(*key));
    let (mut count, mut first) = (0, None);
    for ((machine, _), names) in twice {
        let Some(name) = names.iter().rev().max_by_key(|name| often.get(*name)) else { continue };
        let others = names.iter().filter(|other| *other != name);
        found.extend(others.map(|other| ((machine.to_string(), other.to_string()), name.to_string())));
        count += 1;
        let all: Vec<&str> = names.iter().copied().collect();
        first.get_or_insert_with(|| format!("as {} of {machine}", all.join(" and ")));
    }
    let message = format!(
        "joints whose names differ from run to run in case or separators alone are taken as one, {}; give them one name in the logs, or \
         another one if they are several",
        first.unwrap_or_default()
    );
    remarks.add(Code::JointsChange, count, message);
    found
}

/// What the starts of each plan are like, in the middle of its runs.
pub(super) fn shapes(starts: &[Vec<Cell>]) -> BTreeMap<String, Shape> {
    let mut first_s: BTreeMap<&str, f64> = BTreeMap::new();
    for row in starts {
        if let Some((run, at_s)) = row[RUN].as_text().zip(row[ONSET].as_real()) {
            first_s.entry(run).and_modify(|first_s| *first_s = first_s.min(at_s)).or_insert(at_s);
        }
    }
    let mut all: BTreeMap<String, Told> = BTreeMap::new();
    for row in starts {
        let text = |k: usize| row[k].as_text();
        let told = row[INDEX].as_whole().zip(row[DIRECTION].as_whole()).zip(row[ONSET].as_real());
        let Some(((index, direction), at_s)) = told else { continue };
        let (Some(run), Some(plan), Some(joint)) = (text(RUN), text(PLAN), text(JOINT)) else { continue };
        let of_plan = all.entry(plan.to_owned()).or_default();
        let start = of_plan.entry((joint.to_owned(), index)).or_insert((direction, Vec::new()));
        start.1.extend(first_s.get(run).map(|first_s| at_s - first_s));
    }
    let middle = |(start, (direction, at_s))| (start, (direction, median(at_s)));
    all.into_iter().map(|(plan, of)| (plan, of.into_iter().map(middle).collect())).collect()
}

/// Whether all starts of two plans are the same.
fn alike(one: &Shape, other: &Shape) -> bool {
    let starts = one.iter().zip(other);
    let mut same = starts.map(|((a, (a_way, a_s)), (b, (b_way, b_s)))| {
        a == b && a_way == b_way && (a_s - b_s).abs() <= SAME_ONSET_S
    });
    one.len() == other.len() && same.all(|same| same)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two starts of a joint in each of some runs: the machine and the joint of each run and its plan, and when its second start is, s.
    fn told(runs: &[(&str, &str, &str, f64)]) -> (Vec<Vec<Cell>>, Vec<String>) {
        let run = |(k, (machine, ..)): (usize, &(&str, &str, &str, f64))| Run {
            id: k.to_string(),
            machine: (*machine).into(),
            log: String::new(),
            started_us: 0,
        };
        let all: Vec<Run> = runs.iter().enumerate().map(run).collect();
        let mut starts = Vec::new();
        for (k, (_, joint, plan, second_s)) in runs.iter().enumerate() {
            for (index, at_s) in [(1, 2.0), (2, 2.0 + second_s)] {
                let text = |text: &str| Cell::from(text);
                let mut row =
                    vec![text(&k.to_string()), text(plan), text(joint), text("rad"), Cell::Whole(index)];
                row.extend([Cell::Real(at_s), Cell::None, Cell::None, Cell::None, Cell::Whole(1)]);
                starts.push(row);
            }
        }
        let mut remarks = Remarks::default();
        as_one(&all, [&mut starts, &mut Vec::new()], &mut remarks);
        (starts, remarks.as_slice().iter().map(|remark| remark.message.clone()).collect())
    }

    #[test]
    fn a_joint_in_another_spelling_goes_on_with_its_plan_and_another_plan_stays() {
        let (rows, said) = told(&[
            ("M1", "boom", "p", 5.0),
            ("M1", "boom", "p", 5.0),
            ("M1", "boom", "p", 5.0),
            ("M1", "Boom", "q", 5.01),
            ("M1", "Boom", "r", 9.0),
        ]);
        let names: BTreeSet<Option<&str>> = rows.iter().map(|row| row[JOINT].as_text()).collect();
        assert_eq!(names, BTreeSet::from([Some("boom")]));
        let plans: Vec<Option<&str>> = rows.iter().step_by(2).map(|row| row[PLAN].as_text()).collect();
        assert_eq!(plans, [Some("p"), Some("p"), Some("p"), Some("p"), Some("r")]);
        assert!(said.len() == 1 && said[0].contains("Boom and boom of M1"), "{said:?}");
    }

    #[test]
    fn names_of_two_machines_and_names_in_one_run_are_left() {
        let (rows, said) = told(&[("M1", "boom", "p", 5.0), ("M2", "Boom", "q", 5.0)]);
        assert!(said.is_empty() && rows[2][JOINT].as_text() == Some("Boom"));
        assert!(told(&[("M1", "boom", "p", 5.0), ("M1", "stick", "q", 5.0)]).1.is_empty());
    }
}
