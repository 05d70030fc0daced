//! How each machine did over the days, against the same starts of the whole fleet: what a heat map shows.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{
    history::{By, History},
    run::{date, days},
};
use crate::math::median;

/// Columns, at most.
const MOST_COLUMNS: usize = 31;
/// Machines, at most: the worst.
const MOST_MACHINES: usize = 200;

/// One metric of all machines over time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Map {
    /// What was measured.
    pub metric: By,
    /// First day of each column, UTC.
    pub columns: Vec<String>,
    /// Days of a column.
    pub days_a_column: usize,
    /// The machines, first those whose newest runs are worst.
    pub machines: Vec<MapRow>,
    /// Machines that are not listed.
    pub left_out: usize,
}

/// A machine, with a cell a column.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct MapRow {
    /// The machine.
    pub machine: String,
    /// Null where it did not run.
    pub cells: Vec<Option<Cell>>,
}

/// The worst joint of a machine within a column.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Cell {
    /// Which joint.
    pub joint: String,
    /// Median over its starts of how much larger each is than the median of the fleet at the same start, as a share.
    pub above_fleet: f64,
    /// Starts.
    pub starts: usize,
}

/// The maps of these metrics and of the machines that are wanted, against all; none of what no two runs tell.
pub(super) fn maps(history: &History, by: &[By], wanted: impl Fn(&str) -> bool) -> Vec<Map> {
    by.iter().filter_map(|metric| map(history, *metric, &wanted)).collect()
}

fn map(history: &History, metric: By, wanted: impl Fn(&str) -> bool) -> Option<Map> {
    #[expect(clippy::cast_possible_truncation, reason = "days of runs are few")]
    let day =
        |run: &usize| history.runs.get(*run).filter(|run| run.is_dated()).map(|run| days(run).floor() as i64);
    let usual = history.usual(metric);
    // Starts by machine, day and joint.
    let mut shares: BTreeMap<(&str, i64, &str), Vec<f64>> = BTreeMap::new();
    for ((axis, _), values) in history.values.iter().filter(|((_, by), _)| *by == metric) {
        if !wanted(&axis.machine) {
            continue;
        }
        for (event, of) in values {
            let usual = usual.get(&(axis.joint.as_str(), event)).copied().filter(|usual| *usual > 0.0);
            let Some(usual) = usual else { continue };
            for (run, value) in of {
                let Some(day) = day(run) else { continue };
                shares.entry((&axis.machine, day, &axis.joint)).or_default().push(value / usual - 1.0);
            }
        }
    }
    let first = shares.keys().map(|(_, day, _)| *day).min()?;
    let last = shares.keys().map(|(_, day, _)| *day).max()?;
    let all = usize::try_from(last - first).ok()? + 1;
    let days_a_column = all.div_ceil(MOST_COLUMNS);
    let columns = all.div_ceil(days_a_column);
    let column = |day: i64| usize::try_from(day - first).map_or(0, |day| day / days_a_column);
    let mut joined: BTreeMap<(&str, usize, &str), Vec<f64>> = BTreeMap::new();
    for ((machine, day, joint), own) in shares {
        joined.entry((machine, column(day), joint)).or_default().extend(own);
    }
    let mut rows: BTreeMap<&str, Vec<Option<Cell>>> = BTreeMap::new();
    for ((machine, column, joint), own) in joined {
        let cell = &mut rows.entry(machine).or_insert_with(|| vec![None; columns])[column];
        let (starts, above_fleet) = (own.len(), median(own));
        if cell.as_ref().is_none_or(|known| known.above_fleet < above_fleet) {
            *cell = Some(Cell { joint: joint.to_owned(), above_fleet, starts });
        }
    }
    let mut machines: Vec<MapRow> =
        rows.into_iter().map(|(machine, cells)| MapRow { machine: machine.to_owned(), cells }).collect();
    machines.sort_by(|a, b| newest(b).total_cmp(&newest(a)));
    let left_out = machines.len().saturating_sub(MOST_MACHINES);
    machines.truncate(MOST_MACHINES);
    let begins = |k: usize| date((first + i64::try_from(k * days_a_column).ok()?) as f64);
    let columns = (0..columns).filter_map(begins).collect();
    Some(Map { metric, columns, days_a_column, machines, left_out })
}

/// The share of the newest runs of a machine.
fn newest(row: &MapRow) -> f64 {
    row.cells.iter().rev().flatten().next().map_or(f64::NEG_INFINITY, |cell| cell.above_fleet)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workflow::fleet::{
        history::{Axis, Event},
        run::Run,
    };

    /// Machines that run once a day; the last one has half as much again from day `from` on.
    fn history(machines: usize, days: usize, from: usize) -> History {
        let mut history = History::default();
        for day in 0..days {
            for machine in 0..machines {
                let run = history.runs.len();
                let name = format!("M{machine}");
                let started_us = i64::try_from(20_454 + day).unwrap() * 86_400_000_000;
                let id = run.to_string();
                history.runs.push(Run { log: id.clone(), id, machine: name.clone(), started_us });
                for joint in ["boom", "stick"] {
                    let worse = machine + 1 == machines && day >= from && joint == "stick";
                    let axis = Axis { machine: name.clone(), joint: joint.into(), unit: "rad".into() };
                    let values = history.values.entry((axis, By::Peak)).or_default();
                    for index in 1..4 {
                        let value = 0.01 * index as f64 * if worse { 1.5 } else { 1.0 };
                        let event = Event { plan_id: "p".into(), index };
                        values.entry(event).or_default().insert(run, value);
                    }
                }
            }
        }
        history
    }

    #[test]
    fn a_machine_that_became_worse_stands_first_with_its_joint_from_that_day_on() {
        let history = history(5, 10, 6);
        let maps = maps(&history, &[By::Peak, By::Delay], |_| true);
        assert_eq!(maps.len(), 1);
        let map = &maps[0];
        assert_eq!((map.columns.len(), map.days_a_column, map.machines.len()), (10, 1, 5));
        assert_eq!(map.columns[9], "2026-01-10T00:00:00Z");
        let worst = &map.machines[0];
        assert_eq!(worst.machine, "M4");
        for (day, cell) in worst.cells.iter().enumerate() {
            let cell = cell.as_ref().unwrap();
            let above = if day < 6 { 0.0 } else { 0.5 };
            assert!((cell.above_fleet - above).abs() < 1e-9, "{day}: {cell:?}");
            assert!(day < 6 || cell.joint == "stick" && cell.starts == 3);
        }
        assert!(
            map.machines[1..].iter().flat_map(|row| row.cells.iter().flatten()).all(|c| c.above_fleet == 0.0)
        );
    }

    #[test]
    fn a_year_is_shown_in_columns_of_days_and_many_machines_as_the_worst() {
        let maps = maps(&history(201, 2, 0), &[By::Peak], |_| true);
        assert_eq!((maps[0].machines.len(), maps[0].left_out), (200, 1));
        let year = &super::maps(&history(2, 365, 300), &[By::Peak], |_| true)[0];
        assert_eq!((year.days_a_column, year.columns.len()), (12, 31));
        assert_eq!(year.machines[0].machine, "M1");
    }
}
