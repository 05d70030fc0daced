//! Runs of one plan that were logged with other joints: one that was added, left out or renamed makes no other plan of those that stay.

use std::collections::{BTreeMap, BTreeSet};

use super::{
    renamed::{INDEX, JOINT, PLAN, RUN, SAME_ONSET_S, Shape, shapes},
    run::Run,
};
use crate::{
    log::dataset::Cell,
    math::median,
    remark::{Code, Remarks},
};

/// Fewer starts that two plans share may lie alike by chance.
const FEWEST: usize = 2;
/// Peak errors of shared starts that differ by this factor in the middle are of other strokes.
const OTHER_STROKE: f64 = 1.5;

/// Where the peak error of a start stands.
const PEAK: usize = 6;

/// The starts of a plan, and the peak error of each in the middle.
struct Plan<'a> {
    shape: &'a Shape,
    peaks: Peaks<'a>,
}

/// By joint and number of the start, rad or m.
type Peaks<'a> = BTreeMap<(&'a str, i64), f64>;

/// Takes plans of one machine as one whose joints are those of the other and more, or are named otherwise but for their starts, where
/// all starts of the joints of both are the same; and says so.
pub(super) fn as_one(runs: &[Run], [starts, lags]: [&mut Vec<Vec<Cell>>; 2], remarks: &mut Remarks) {
    let machines: BTreeMap<&str, &str> =
        runs.iter().map(|run| (run.id.as_str(), run.machine.as_str())).collect();
    let shapes = shapes(starts);
    let mut same: BTreeMap<(String, String), String> = BTreeMap::new();
    let mut first = None;
    for (machine, peaks) in peaks(&machines, starts) {
        let mut plans: Vec<(&str, Plan<'_>)> = peaks
            .into_iter()
            .filter_map(|(plan, peaks)| Some((plan, Plan { shape: shapes.get(plan)?, peaks })))
            .collect();
        plans.sort_by_key(|(_, plan)| joints(plan.shape).len());
        let mut known: Vec<(&str, Plan<'_>)> = Vec::new();
        for (id, plan) in plans {
            let mut others = known.iter().filter(|(_, other)| differ_by_joints(other, &plan));
            // One of two would be a guess.
            let (Some((other, theirs)), None) = (others.next(), others.next()) else {
                known.push((id, plan));
                continue;
            };
            let (own, theirs) = (joints(plan.shape), joints(theirs.shape));
            let joint = own.symmetric_difference(&theirs).next().copied().unwrap_or_default();
            first.get_or_insert_with(|| format!("as {joint} of {machine}"));
            same.insert((machine.to_owned(), id.to_owned()), (*other).to_owned());
        }
    }
    for row in starts.iter_mut().chain(lags.iter_mut()) {
        let machine = row[RUN].as_text().and_then(|run| machines.get(run));
        let key =
            machine.zip(row[PLAN].as_text()).map(|(machine, plan)| ((*machine).to_owned(), plan.to_owned()));
        if let Some(other) = key.and_then(|key| same.get(&key)) {
            row[PLAN] = Cell::from(other.as_str());
        }
    }
    let message = format!(
        "plans that differ by a joint that is not logged, stands or has another name, {}, are taken as one: the starts of the others are the same",
        first.unwrap_or_default()
    );
    remarks.add(Code::JointsChange, same.len() as u64, message);
}

/// The peak error of each start in the middle, by machine and plan.
fn peaks<'a>(
    machines: &BTreeMap<&str, &'a str>,
    starts: &'a [Vec<Cell>],
) -> BTreeMap<&'a str, BTreeMap<&'a str, Peaks<'a>>> {
    let mut all: BTreeMap<_, BTreeMap<_, BTreeMap<_, Vec<f64>>>> = BTreeMap::new();
    for row in starts {
        let text = |k: usize| row[k].as_text();
        let machine = text(RUN).and_then(|run| machines.get(run).copied());
        let told = machine.zip(text(PLAN)).zip(text(JOINT)).zip(row[INDEX].as_whole());
        if let Some((((machine, plan), joint), index)) = told {
            let of_plan = all.entry(machine).or_default().entry(plan).or_default();
            of_plan.entry((joint, index)).or_default().extend(row[PEAK].as_real());
        }
    }
    let middle = |(start, peaks)| (start, median(peaks));
    let of_plan = |(plan, of): (_, BTreeMap<_, Vec<f64>>)| (plan, of.into_iter().map(middle).collect());
    all.into_iter().map(|(machine, of)| (machine, of.into_iter().map(of_plan).collect())).collect()
}

/// The joints that start.
fn joints(shape: &Shape) -> BTreeSet<&str> {
    shape.keys().map(|(joint, _)| joint.as_str()).collect()
}

/// Whether two plans are the same but for joints of one of them, or for their names.
fn differ_by_joints(fewer: &Plan<'_>, more: &Plan<'_>) -> bool {
    let (few, many) = (joints(fewer.shape), joints(more.shape));
    let both: Vec<&str> = few.intersection(&many).copied().collect();
    let [gone, new] = [&few, &many]
        .map(|own| own.iter().copied().filter(|joint| !both.contains(joint)).collect::<Vec<&str>>());
    // A renamed joint stands behind those that both have; one that is more is not compared.
    let [one, other] = [(fewer, &gone), (more, &new)].map(|(plan, own)| {
        let named: Vec<&str> = both.iter().chain(&own[..own.len().min(gone.len())]).copied().collect();
        starts(plan.shape, &named, &both)
    });
    let ratios =
        fewer.peaks.iter().filter_map(|(start, peak)| Some((more.peaks.get(start)? / peak).ln().abs()));
    let ratios: Vec<f64> = ratios.filter(|ratio| ratio.is_finite()).collect();
    let renamed = gone.len() == 1 && new.len() == 1;
    let shared = fewer.shape.keys().filter(|(joint, _)| both.contains(&joint.as_str())).count();
    shared >= FEWEST
        && !new.is_empty()
        && (gone.is_empty() || renamed)
        && alike(&one, &other)
        && (ratios.is_empty() || median(ratios) < OTHER_STROKE.ln())
}

/// A start: its joint by its place among some, its number, direction, and how long after the first one of shared joints it lies, s.
type Start = (usize, i64, i64, f64);

/// The starts of some joints, of which some are shared.
fn starts(shape: &Shape, joints: &[&str], shared: &[&str]) -> Vec<Start> {
    let of = |joint: &String| joints.iter().position(|one| one == joint);
    let first_s = shape
        .iter()
        .filter(|((joint, _), _)| shared.contains(&joint.as_str()))
        .map(|(_, (_, at_s))| *at_s)
        .fold(f64::INFINITY, f64::min);
    let own = shape
        .iter()
        .filter_map(|((joint, index), (way, at_s))| Some((of(joint)?, *index, *way, at_s - first_s)));
    let mut own: Vec<Start> = own.collect();
    own.sort_by_key(|(joint, index, ..)| (*joint, *index));
    own
}

fn alike(one: &[Start], other: &[Start]) -> bool {
    let same =
        |(a, b): (&Start, &Start)| (a.0, a.1, a.2) == (b.0, b.1, b.2) && (a.3 - b.3).abs() <= SAME_ONSET_S;
    one.len() == other.len() && one.iter().zip(other).all(same)
}

/// The joints of each plan that all of its runs have.
pub(super) fn of_all_runs(starts: &[Vec<Cell>]) -> BTreeMap<&str, BTreeSet<&str>> {
    let mut of_runs: BTreeMap<(&str, &str), BTreeSet<&str>> = BTreeMap::new();
    for row in starts {
        if let (Some(run), Some(plan), Some(joint)) =
            (row[RUN].as_text(), row[PLAN].as_text(), row[JOINT].as_text())
        {
            of_runs.entry((plan, run)).or_default().insert(joint);
        }
    }
    let mut all: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for ((plan, _), joints) in of_runs {
        all.entry(plan).and_modify(|all| all.retain(|joint| joints.contains(joint))).or_insert(joints);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    type Told<'a> = &'a [(&'a str, i64, f64, f64)];

    fn same(few: Told<'_>, many: Told<'_>) -> bool {
        let shape = |told: Told<'_>| -> Shape {
            let starts = (0_i64..).zip(told);
            starts.map(|(k, (joint, way, at_s, _))| (((*joint).to_owned(), k % 2), (*way, *at_s))).collect()
        };
        let shapes = [few, many].map(shape);
        let [few, many] = [(few, &shapes[0]), (many, &shapes[1])].map(|(told, shape)| Plan {
            shape,
            peaks: (0_i64..).zip(told).map(|(k, start)| ((start.0, k % 2), start.3)).collect(),
        });
        differ_by_joints(&few, &many)
    }

    #[test]
    fn a_joint_more_or_with_another_name_makes_no_other_plan_and_another_start_or_stroke_does() {
        let boom = |at_s: f64, peak: f64| [("boom", 1, at_s, peak), ("boom", -1, at_s + 5.0, peak)];
        let with = |boom: [(&'static str, i64, f64, f64); 2], more: (&'static str, i64, f64)| {
            [boom[0], boom[1], (more.0, more.1, more.2, 0.1)]
        };
        assert!(same(&boom(0.0, 0.1), &with(boom(2.0, 0.12), ("slew", 1, 0.0))));
        assert!(!same(&boom(0.0, 0.1), &with(boom(2.0, 0.3), ("slew", 1, 0.0))));
        assert!(!same(&boom(0.0, 0.1), &boom(0.0, 0.1)));
        let late = [("boom", 1, 2.0, 0.1), ("boom", -1, 8.0, 0.1), ("slew", 1, 0.0, 0.1)];
        assert!(!same(&boom(0.0, 0.1), &late));
        let hook = with(boom(0.0, 0.1), ("hook", 1, 8.0));
        assert!(same(&hook, &with(boom(0.0, 0.1), ("tip", 1, 8.0))));
        assert!(!same(&hook, &with(boom(0.0, 0.1), ("slew", 1, 5.0))));
        assert!(!same(&hook, &with(boom(0.0, 0.1), ("tip", -1, 8.0))));
        // One start that two plans share lies alike by chance.
        assert!(!same(&boom(0.0, 0.1)[..1], &[("boom", 1, 0.0, 0.1), ("slew", 1, 3.0, 0.1)]));
    }
}
