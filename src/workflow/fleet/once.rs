//! One log a run: copies, and logs of one run in other forms, are left out.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

use super::{dated::began_ns, run::Run};
use crate::remark::{Code, Remarks};

/// Runs of one machine and the same joints that begin within this of one another and last as long are one run, µs.
const SAME_BEGIN_US: i64 = 50_000;
/// How much longer one log of a run may last than another: what a recorder goes on for, s.
const SAME_DURATION_S: f64 = 1.0;

/// Shares by which the errors of one run differ between a table and a log.
const SAME_ERROR: f64 = 0.01;

/// A row of the table of runs.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Logged {
    pub(super) run: Run,
    /// Hash of the log; empty if unknown.
    pub(super) content: String,
    pub(super) duration_s: f64,
    /// Root mean square and peak error, in the unit of the joints, where they have one.
    pub(super) errors: [Option<f64>; 2],
    /// Whether what was sent stands in for a plan.
    pub(super) plan_is_command: bool,
    /// Whether the log is no longer there.
    pub(super) is_gone: bool,
    /// When its file was changed last, ns since 1970, where it lies on a disk: a copy is no older.
    pub(super) changed_ns: Option<u128>,
}

/// Whether a log that was on a disk is there no more.
pub(super) fn is_gone(log: &str) -> bool {
    let path = Path::new(log);
    path.is_absolute() && !path.exists()
}

/// Of logs with the same content, and then of those of one run, one each, in order of time.
///
/// A log with a plan is kept before one without, one that is there before one that is not, then the older file.
pub(super) fn one_a_run(
    mut rows: Vec<Logged>,
    joints: &BTreeMap<String, BTreeSet<String>>,
    remarks: &mut Remarks,
) -> Vec<Run> {
    let by_age = |a: &Logged, b: &Logged| {
        (a.is_gone, a.changed_ns, &a.run.log).cmp(&(b.is_gone, b.changed_ns, &b.run.log))
    };
    rows.sort_by(by_age);
    let content = |row: &Logged| (!row.content.is_empty()).then(|| (row.content.clone(), 0));
    let of_content = kept(rows, content, |_, _| true);
    say("logs with the content of another one", &of_content, remarks);
    let mut rows = of_content.kept;
    rows.sort_by(|a, b| a.plan_is_command.cmp(&b.plan_is_command).then_with(|| by_age(a, b)));
    let none = BTreeSet::new();
    let of = |row: &Logged| joints.get(&row.run.id).unwrap_or(&none);
    let begins = |row: &Logged| Some((row.run.machine.clone(), row.run.started_us));
    let of_run = kept(rows, begins, |row, before| {
        // Packed, the same table has another content.
        let identical = row.duration_s.to_bits() == before.duration_s.to_bits()
            && row.errors == before.errors
            && row.errors[0].is_some();
        let at_once = row.run.is_dated()
            && (is_stamped(&row.run) && is_stamped(&before.run) || are_beside(row, before))
            && (row.duration_s - before.duration_s).abs() <= SAME_DURATION_S
            && (row.plan_is_command != before.plan_is_command || alike(row.errors, before.errors));
        (identical || at_once) && of(row) == of(before)
    });
    say("logs of a run that another log is of, too", &of_run, remarks);
    let mut runs: Vec<Run> = of_run.kept.into_iter().map(|row| row.run).collect();
    runs.sort_by(|a, b| (a.started_us, &a.log).cmp(&(b.started_us, &b.log)));
    runs
}

/// Whether a run begins by its stamps: a date without a time of day, as names have it, is that of many runs.
fn is_stamped(run: &Run) -> bool {
    began_ns(&run.log, None) != Some(run.started_us.saturating_mul(1000))
}

/// Whether logs lie beside one another under one name, or one that a recording with a plan has.
fn are_beside(row: &Logged, before: &Logged) -> bool {
    let [one, other] = [row, before].map(|row| Path::new(&row.run.log));
    let stems = one.file_stem().zip(other.file_stem());
    let alike = stems.is_some_and(|(a, b)| {
        let (a, b) = (a.to_string_lossy(), b.to_string_lossy());
        let with_plan = row.plan_is_command != before.plan_is_command;
        a == b || with_plan && (a.starts_with(&*b) || b.starts_with(&*a))
    });
    alike && one.parent() == other.parent()
}

/// Whether errors are the same but for the digits that a table has.
fn alike(one: [Option<f64>; 2], other: [Option<f64>; 2]) -> bool {
    one.into_iter().zip(other).all(|pair| match pair {
        (Some(a), Some(b)) => (a - b).abs() <= SAME_ERROR * a.abs().max(b.abs()),
        // Of joints that turn and that slide there is no common one.
        _ => false,
    })
}

struct Kept {
    kept: Vec<Logged>,
    /// Those that are left out and are there still, each with the one that stays.
    out: Vec<[String; 2]>,
}

/// The first of all that are the same: of one name, and of instants within [`SAME_BEGIN_US`].
fn kept(
    rows: Vec<Logged>,
    key: impl Fn(&Logged) -> Option<(String, i64)>,
    same: impl Fn(&Logged, &Logged) -> bool,
) -> Kept {
    let mut found = Kept { kept: Vec::new(), out: Vec::new() };
    let mut places: BTreeMap<(String, i64), Vec<usize>> = BTreeMap::new();
    for row in rows {
        let key = key(&row);
        let near = key.iter().flat_map(|(name, at_us)| {
            let until = (name.clone(), at_us.saturating_add(SAME_BEGIN_US));
            places.range((name.clone(), at_us.saturating_sub(SAME_BEGIN_US))..=until).flat_map(|(_, own)| own)
        });
        let before = near.map(|place| &found.kept[*place]).find(|before| same(&row, before));
        if let Some(before) = before {
            let out = [row.run.log.clone(), before.run.log.clone()];
            // What was moved is no copy.
            found.out.extend((!row.is_gone).then_some(out));
            continue;
        }
        if let Some(key) = key {
            places.entry(key).or_default().push(found.kept.len());
        }
        found.kept.push(row);
    }
    found
}

fn say(what: &str, found: &Kept, remarks: &mut Remarks) {
    let example = found.out.first().map_or_else(String::new, |[out, stays]| {
        let shared = out.split('/').zip(stays.split('/')).take_while(|(a, b)| a == b).count();
        let own = |log: &str| log.split('/').skip(shared).collect::<Vec<_>>().join("/");
        format!(", as {} of {}", own(out), own(stays))
    });
    remarks.add(Code::SameRun, found.out.len() as u64, format!("{what}{example}; left out"));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn logged(log: &str, started_s: i64, content: &str) -> Logged {
        let machine = log.split('/').next().unwrap_or_default().to_owned();
        Logged {
            run: Run { id: log.into(), machine, log: log.into(), started_us: 1_000_000 * started_s },
            content: content.into(),
            duration_s: 20.0,
            errors: [Some(0.01), Some(0.03)],
            plan_is_command: false,
            is_gone: false,
            changed_ns: None,
        }
    }

    fn logs(rows: Vec<Logged>) -> (Vec<String>, u64) {
        let joints = BTreeSet::from(["boom".to_owned()]);
        let other = BTreeSet::from(["slew".to_owned()]);
        let of = |row: &Logged| if row.run.log.contains("slew") { other.clone() } else { joints.clone() };
        let joints = rows.iter().map(|row| (row.run.id.clone(), of(row))).collect();
        let mut remarks = Remarks::default();
        let runs = one_a_run(rows, &joints, &mut remarks);
        (runs.into_iter().map(|run| run.log).collect(), remarks.as_slice().iter().map(|one| one.count).sum())
    }

    #[test]
    fn a_copy_steals_no_history_and_a_renamed_folder_has_its_new_name() {
        let day = 1_772_000_000;
        let rows = || {
            let mut copy = logged("A/a", day, "x");
            copy.changed_ns = Some(1);
            vec![copy, logged("M3/a", day, "x"), logged("M3/b", day + 60, "y")]
        };
        assert_eq!(logs(rows()), (vec!["M3/a".into(), "M3/b".into()], 1));
        let mut gone = rows();
        gone[1].is_gone = true;
        assert_eq!(logs(gone), (vec!["A/a".into(), "M3/b".into()], 0));
    }

    #[test]
    fn a_run_in_two_forms_counts_once_and_with_its_plan() {
        let day = 1_772_000_000;
        let mut live = logged("M3/run", day, "x");
        live.plan_is_command = true;
        let with_plan = logged("M3/run-with-plan", day, "y");
        let named = |log: &str, rms: f64| {
            let log = format!("M3/2026-02-25/{log}");
            // Midnight, as the name says.
            let begins_s = began_ns(&log, None).unwrap() / 1_000_000_000;
            Logged { errors: [Some(rms), Some(0.03)], ..logged(&log, begins_s, &log) }
        };
        assert_eq!(logs(vec![named("1", 0.01), named("2", 0.0101)]).1, 0, "a date is that of many runs");
        assert_eq!(logs(vec![named("1.csv", 0.01), named("1.csv.gz", 0.01)]).1, 1, "packed");
        assert_eq!(logs(vec![live.clone(), with_plan.clone()]), (vec!["M3/run-with-plan".into()], 1));
        // Of other joints, of another machine, later, longer, of other errors, or without a date: other runs.
        let mut longer = logged("M3/longer", day, "z");
        longer.duration_s = 40.0;
        let mut other = logged("M3/other", day, "o");
        other.errors[1] = Some(0.031);
        let rows = vec![
            with_plan,
            logged("M3/slew", day, "s"),
            logged("M4/run", day, "m"),
            logged("M3/next", day + 1, "n"),
            longer,
            other,
        ];
        assert_eq!(logs(rows).1, 0);
        let undated = crate::log::UNDATED_NS / 1_000_000_000;
        assert_eq!(
            logs(vec![
                logged("M3/1", undated, "a"),
                Logged { duration_s: 21.0, ..logged("M3/2", undated, "b") }
            ])
            .1,
            0
        );
    }
}
