//! One log a run: copies, and logs of one run in other forms, are left out.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

use crate::{
    log::is_dated,
    remark::{Code, Remarks},
};

/// Runs of one machine and the same joints that begin within this of one another and last as long are one run, µs.
const SAME_BEGIN_US: i64 = 50_000;
/// How much longer one log of a run may last than another: what a recorder goes on for, s.
const SAME_DURATION_S: f64 = 1.0;

/// One run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Run {
    pub(super) id: String,
    pub(super) machine: String,
    pub(super) log: String,
    /// Microseconds since 1970.
    pub(super) started_us: i64,
}

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
}

/// Whether a log that was on a disk is there no more.
pub(super) fn is_gone(log: &str) -> bool {
    let path = Path::new(log);
    path.is_absolute() && !path.exists()
}

/// Of logs with the same content, and then of those of one run, one each; rows come as they were scanned, and go by time.
///
/// A log with a plan is kept before one without, one that is there before one that is not, then the one scanned first.
pub(super) fn one_a_run(
    rows: Vec<Logged>,
    joints: &BTreeMap<String, BTreeSet<String>>,
    remarks: &mut Remarks,
) -> Vec<Run> {
    let mut rows: Vec<(usize, Logged)> = rows.into_iter().enumerate().collect();
    rows.sort_by_key(|(place, row)| (row.is_gone, *place));
    let of_content = kept(rows, |row, before| !row.content.is_empty() && row.content == before.content);
    say("logs with the content of another one", &of_content, remarks);
    let mut rows = of_content.kept;
    rows.sort_by_key(|(place, row)| (row.plan_is_command, row.is_gone, *place));
    let none = BTreeSet::new();
    let of = |row: &Logged| joints.get(&row.run.id).unwrap_or(&none);
    let of_run = kept(rows, |row, before| {
        row.run.machine == before.run.machine
            && is_dated(row.run.started_us.saturating_mul(1000))
            && row.run.started_us.abs_diff(before.run.started_us) <= SAME_BEGIN_US.unsigned_abs()
            && (row.duration_s - before.duration_s).abs() <= SAME_DURATION_S
            && (row.plan_is_command != before.plan_is_command || alike(row.errors, before.errors))
            && of(row) == of(before)
    });
    say("logs of a run that another log is of, too", &of_run, remarks);
    let mut runs: Vec<Run> = of_run.kept.into_iter().map(|(_, row)| row.run).collect();
    runs.sort_by(|a, b| (a.started_us, &a.log).cmp(&(b.started_us, &b.log)));
    runs
}

/// Whether errors are the same but for the digits that a table has.
fn alike(one: [Option<f64>; 2], other: [Option<f64>; 2]) -> bool {
    one.into_iter().zip(other).all(|pair| match pair {
        (Some(a), Some(b)) => (a - b).abs() <= SAME_ERROR * a.abs().max(b.abs()),
        (a, b) => a == b,
    })
}

struct Kept {
    kept: Vec<(usize, Logged)>,
    /// Those that are left out, each with the one that stays.
    out: Vec<[String; 2]>,
}

/// The first of all that are the same.
fn kept(rows: Vec<(usize, Logged)>, same: impl Fn(&Logged, &Logged) -> bool) -> Kept {
    let mut found = Kept { kept: Vec::new(), out: Vec::new() };
    for (place, row) in rows {
        match found.kept.iter().find(|(_, before)| same(&row, before)) {
            Some((_, before)) => found.out.push([row.run.log, before.run.log.clone()]),
            None => found.kept.push((place, row)),
        }
    }
    found
}

fn say(what: &str, found: &Kept, remarks: &mut Remarks) {
    let end = |log: &str| {
        let parts: Vec<&str> = log.rsplit('/').take(2).collect();
        parts.into_iter().rev().collect::<Vec<_>>().join("/")
    };
    let example = found.out.first();
    let example =
        example.map_or_else(String::new, |[out, stays]| format!(", as {} of {}", end(out), end(stays)));
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
        let rows = || vec![logged("M3/a", day, "x"), logged("A/a", day, "x"), logged("M3/b", day + 60, "y")];
        assert_eq!(logs(rows()), (vec!["M3/a".into(), "M3/b".into()], 1));
        let mut gone = rows();
        gone[0].is_gone = true;
        assert_eq!(logs(gone), (vec!["A/a".into(), "M3/b".into()], 1));
    }

    #[test]
    fn a_run_in_two_forms_counts_once_and_with_its_plan() {
        let day = 1_772_000_000;
        let mut live = logged("M3/run", day, "x");
        live.plan_is_command = true;
        let with_plan = logged("M3/run-with-plan", day, "y");
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
        assert_eq!(logs(vec![logged("M3/1", undated, "a"), logged("M3/2", undated, "b")]).1, 0);
    }
}
