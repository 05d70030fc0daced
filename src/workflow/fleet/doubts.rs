//! Doubts about the runs of a history: when they were, how they were analysed, and what their machines are called.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

use super::{
    dated::named_otherwise,
    run::{Run, date, days},
    scan::FITTED,
    store::begun as begun_scans,
};
use crate::{
    remark::{Code, Remarks},
    text::{shell_argument, shell_word},
};

fn name(run: &Run) -> &str {
    run.log.rsplit('/').next().unwrap_or_default()
}

/// Says which scans began and did not end: what they did not come to is missing.
pub(super) fn begun(root: &Path, remarks: &mut Remarks) {
    let begun = begun_scans(root);
    let sources: Vec<String> = begun.iter().map(|source| shell_word(source)).collect();
    let message = format!(
        "a scan began and did not end, so that logs may be missing; if none is under way, `hydrotrace fleet scan {} --into {}` with \
         the options that it had goes on",
        sources.join(" "),
        shell_argument(root)
    );
    remarks.add(Code::NotClosed, sources.len() as u64, message);
}

/// A run that nobody knows the time of has no place in a history.
pub(super) fn without_undated(runs: &mut Vec<Run>, remarks: &mut Remarks) {
    let count = runs.iter().filter(|run| !run.is_dated()).count() as u64;
    if let Some(first) = runs.iter().find(|run| !run.is_dated()) {
        let message = format!(
            "runs that say no date, neither in their stamps nor in their names (2026-03-06, 06.03.2026), as {}; left out",
            name(first)
        );
        remarks.add(Code::Undated, count, message);
    }
    runs.retain(Run::is_dated);
}

/// Says of machines of which something was found by several runs on few days what these do not tell.
pub(super) fn few_days(machines: &[String], remarks: &mut Remarks) {
    let message = format!(
        "machines whose runs are of too few days, as {}: what differs from day to day, such as oil and load, is not known, and what is \
         found may be of that alone",
        machines.first().map_or("", String::as_str)
    );
    remarks.add(Code::FewDays, machines.len() as u64, message);
}

/// Says of which runs day and month may be the other way round.
pub(super) fn orders(runs: &[Run], doubtful: &BTreeSet<String>, remarks: &mut Remarks) {
    let mut of_them = runs.iter().filter(|run| doubtful.contains(&run.id)).peekable();
    let Some(first) = of_them.peek() else { return };
    let message = format!(
        "runs in whose dates the day or the month may come first, as {}, which is taken to be of {}: if that is wrong, \
         `hydrotrace import LOG --time-unit mdy --save-map map.toml -o checked.mcap` (or dmy) and a scan with --map map.toml set it right",
        name(first),
        date(days(first)).unwrap_or_default().get(..10).unwrap_or_default()
    );
    remarks.add(Code::DateOrder, of_them.count() as u64, message);
}

/// Takes the dates of names where those of the stamps cannot be right, and says so; and where they may not be.
pub(super) fn dates(runs: &mut [Run], remarks: &mut Remarks) {
    let mut doubts: [(u64, String); 2] = Default::default();
    let slow = slow_clocks(runs);
    for run in runs.iter_mut().filter(|run| run.is_dated()) {
        let Some((named_us, surely)) = named_otherwise(&run.log, run.started_us) else { continue };
        let surely = surely || slow.contains(&(run.machine.clone(), days_off(run, named_us)));
        let (count, example) = &mut doubts[usize::from(surely)];
        if *count == 0 {
            *example = format!("as {} ({})", name(run), date(days(run)).unwrap_or_default());
        }
        *count += 1;
        if surely {
            run.started_us = named_us;
        }
    }
    let words = [
        ["a month or more from", "stamps"],
        ["half a year or more, or as many days as those of other runs of the machine, from", "names"],
    ];
    for ((count, example), [apart, taken]) in doubts.into_iter().zip(words) {
        let message = format!(
            "runs whose stamps are {apart} the dates in their names, {example}: was the clock set? The dates of the {taken} are \
             taken"
        );
        remarks.add(Code::UnusableStamp, count, message);
    }
    runs.sort_by_key(|run| run.started_us);
}

/// So many runs of a machine whose stamps are as far from their names say that its clock was off.
const ALIKE: usize = 3;

/// By how many days the name of a run is later than its stamps.
fn days_off(run: &Run, named_us: i64) -> i64 {
    const DAY_US: i64 = 86_400_000_000;
    (named_us - run.started_us + DAY_US / 2).div_euclid(DAY_US)
}

/// Machines whose clocks were off, and by how many days: a name that is mistyped is off alone.
fn slow_clocks(runs: &[Run]) -> BTreeSet<(String, i64)> {
    let mut alike: BTreeMap<(String, i64), usize> = BTreeMap::new();
    for run in runs.iter().filter(|run| run.is_dated()) {
        if let Some((named_us, _)) = named_otherwise(&run.log, run.started_us) {
            *alike.entry((run.machine.clone(), days_off(run, named_us))).or_default() += 1;
        }
    }
    alike.into_iter().filter(|(_, count)| *count >= ALIKE).map(|(key, _)| key).collect()
}

/// Says which runs were analysed otherwise than most: what differs may be the analysis alone.
pub(super) fn analyses(runs: &[Run], analyses: &BTreeMap<String, String>, remarks: &mut Remarks) {
    let mut groups: BTreeMap<&str, Vec<&Run>> = BTreeMap::new();
    for run in runs {
        let analysis = analyses.get(&run.id).map_or("", |id| id.strip_suffix(FITTED).unwrap_or(id));
        groups.entry(analysis).or_default().push(run);
    }
    let most = groups.values().map(Vec::len).max().unwrap_or_default();
    let mut others = groups.values().filter(|own| own.len() < most).flatten();
    let Some(first) = others.next() else {
        // As many of each.
        let second = groups.values().nth(1).and_then(|own| own.first());
        if let Some(run) = second {
            otherwise(run, most, remarks);
        }
        return;
    };
    otherwise(first, 1 + others.count(), remarks);
}

fn otherwise(first: &Run, count: usize, remarks: &mut Remarks) {
    let message = format!(
        "runs that were analysed by other options or another version than the others, as {}: what differs may be that alone; a \
         scan with one set of options analyses anew those whose logs are there",
        name(first)
    );
    remarks.add(Code::MeasuredOtherwise, count as u64, message);
}

/// A name without case and separators.
pub(super) fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// Machines whose names differ in case or separators alone are called one by people.
pub(super) fn spelled(runs: &[Run], remarks: &mut Remarks) {
    let mut spellings: BTreeMap<String, BTreeSet<&str>> = BTreeMap::new();
    for run in runs {
        spellings.entry(plain(&run.machine)).or_default().insert(&run.machine);
    }
    let twice = spellings.values().filter(|names| names.len() > 1);
    for names in twice {
        let names: Vec<&str> = names.iter().copied().collect();
        let message = format!(
            "machines whose names differ in case or separators alone are taken as several: {}; are they one?",
            names.join(", ")
        );
        remarks.add(Code::UnknownMachine, names.len() as u64, message);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(machine: &str, k: i64) -> Run {
        let started_us = (20_000 + k) * 86_400_000_000;
        Run { id: k.to_string(), machine: machine.into(), log: format!("/{machine}/{k}.csv"), started_us }
    }

    #[test]
    fn a_clock_that_is_off_by_as_much_in_several_runs_is_and_one_name_alone_is_mistyped() {
        let stamped = |name: &str, day: i64| Run { log: format!("/M/{name}.csv"), ..run("M", day) };
        // The day 20000 is the 4th of October 2024.
        let off = ["2024-12-03", "2024-12-05", "2024-12-06"];
        let mut runs: Vec<Run> =
            off.into_iter().zip([0, 2, 3]).map(|(name, day)| stamped(name, day)).collect();
        runs.push(stamped("2024-11-20", 5));
        let mut remarks = Remarks::default();
        dates(&mut runs, &mut remarks);
        let days: Vec<i64> = runs.iter().map(|run| run.started_us / 86_400_000_000 - 20_000).collect();
        assert_eq!(days, [5, 60, 62, 63]);
        assert_eq!(remarks.as_slice().iter().map(|remark| remark.count).collect::<Vec<_>>(), [1, 3]);
    }

    #[test]
    fn other_options_are_said_and_a_fit_beside_is_none() {
        let runs: Vec<Run> = (0..5).map(|k| run("M", k)).collect();
        let said = |ids: [&str; 5]| {
            let ids = ids.iter().enumerate().map(|(k, id)| (k.to_string(), (*id).to_owned())).collect();
            let mut remarks = Remarks::default();
            analyses(&runs, &ids, &mut remarks);
            remarks.as_slice().iter().map(|one| (one.count, one.message.contains("as 1.csv"))).next()
        };
        assert_eq!(said(["a", "a", "a", "a", "a"]), None);
        assert_eq!(said(["a", "a-fit", "a", "a-fit", "a"]), None);
        assert_eq!(said(["a", "b", "a", "b", "a"]), Some((2, true)));
    }

    #[test]
    fn two_spellings_of_a_machine_are_asked_about() {
        let mut remarks = Remarks::default();
        spelled(&["Kran-8", "kran-8", "Kran 9", "Kran-10"].map(|name| run(name, 1)), &mut remarks);
        assert_eq!(remarks.as_slice().len(), 1);
        assert!(remarks.as_slice()[0].message.contains("Kran-8, kran-8;"), "{remarks:?}");
    }
}
