//! The lists of joints that messages of a topic name, and the topic taken apart where several publishers each send
//! joints of their own.

use std::ops::Range;

use super::Table;

/// So many lists are kept apart; who names more sends no steady ones.
const MOST_LISTS: usize = 64;
/// A publisher sends no fewer messages.
const LEAST_ROWS: usize = 8;

/// Lists of joints in the order of the messages.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Lists {
    /// Each list once, as indices of joints; `None` for a joint without a name.
    known: Vec<Vec<Option<usize>>>,
    /// First row of each run of messages with one list, and its place among the known; [`MOST_LISTS`] for one more.
    runs: Vec<(usize, usize)>,
    /// Whether messages of other publishers lay between these.
    pub(super) apart: bool,
    /// Changes from publisher to publisher, where these are not steady.
    between: u64,
}

impl Lists {
    /// From this row on messages name these joints.
    pub(super) fn begin(&mut self, row: usize, joints: &[Option<usize>]) {
        let place = self.known.iter().position(|list| list == joints).unwrap_or(self.known.len());
        if place == self.known.len() && place < MOST_LISTS {
            self.known.push(joints.to_vec());
        }
        if place == MOST_LISTS || self.runs.last().is_none_or(|(_, last)| *last != place) {
            self.runs.push((row, place));
        }
    }

    /// Appends the lists of messages after these `rows`, whose joints have the indices `joints` here.
    pub(super) fn append(&mut self, other: &Self, rows: usize, joints: &[Option<usize>]) {
        let here = |joint: &Option<usize>| joint.and_then(|joint| joints.get(joint).copied().flatten());
        let known: Vec<Vec<_>> = other.known.iter().map(|list| list.iter().map(here).collect()).collect();
        for &(row, place) in &other.runs {
            match known.get(place) {
                Some(list) => self.begin(rows + row, list),
                None => self.runs.push((rows + row, MOST_LISTS)),
            }
        }
    }

    /// How often a message named other joints, or in another order, than the one before.
    pub(super) fn changes(&self) -> u64 {
        self.runs.len().saturating_sub(1) as u64 + self.between
    }

    /// The publisher of each joint: lists that share joints are of one. `None` where all are of one.
    fn publishers(&self, joints: usize) -> Option<Vec<usize>> {
        if self.known.len() < 2 || self.runs.iter().any(|(_, place)| *place == MOST_LISTS) {
            return None;
        }
        let mut of: Vec<usize> = (0..joints).collect();
        for list in &self.known {
            let joined: Vec<usize> =
                list.iter().flatten().filter_map(|joint| of.get(*joint).copied()).collect();
            let Some(&least) = joined.iter().min() else { continue };
            of.iter_mut().filter(|one| joined.contains(one)).for_each(|one| *one = least);
        }
        of.iter().any(|one| *one != of[0]).then_some(of)
    }
}

/// Rows of one publisher among those of the topic, ascending.
pub(in crate::log) struct Rows(Vec<Range<usize>>);

impl Rows {
    /// How many lie before a row of the topic.
    pub(in crate::log) fn before(&self, row: usize) -> usize {
        self.0.iter().map(|own| own.end.min(row).saturating_sub(own.start)).sum()
    }

    /// The values of these rows; a column ends with its last value.
    pub(super) fn of<T: Copy>(&self, column: &[T]) -> Vec<T> {
        let end = |row: usize| row.min(column.len());
        self.0.iter().flat_map(|own| &column[end(own.start)..end(own.end)]).copied().collect()
    }
}

impl Table {
    /// How often a message named other joints, or in another order, than the one before.
    pub(in crate::log) fn list_changes(&self) -> u64 {
        self.lists.changes()
    }

    /// A table for each publisher, with its rows, where several each send joints of their own; empty where one sends all.
    /// The stamps of each are judged by themselves.
    pub(in crate::log) fn apart(&mut self) -> Vec<(Self, Rows)> {
        let Some(publishers) = self.lists.publishers(self.joints.len()) else { return Vec::new() };
        let mut each = publishers.clone();
        each.sort_unstable();
        each.dedup();
        let mut tables: Vec<(Self, Rows)> =
            each.iter().map(|publisher| self.of_publisher(*publisher, &publishers)).collect();
        let steady =
            self.lists.runs.len() > each.len() && tables.iter().all(|(table, _)| table.len() >= LEAST_ROWS);
        let own: u64 = tables.iter().map(|(table, _)| table.lists.changes()).sum();
        if let Some((first, _)) = tables.first_mut() {
            // What is counted of the topic as a whole is told once.
            first.lists.between = if steady { 0 } else { self.lists.changes().saturating_sub(own) };
            first.speed_scaling = std::mem::take(&mut self.speed_scaling);
            first.not_finite = std::mem::take(&mut self.not_finite);
            first.length_mismatch = std::mem::take(&mut self.length_mismatch);
            first.too_many = self.too_many;
        }
        tables
    }

    fn of_publisher(&mut self, publisher: usize, publishers: &[usize]) -> (Self, Rows) {
        let is_own = |list: &[Option<usize>]| {
            list.iter().flatten().next().is_some_and(|joint| publishers.get(*joint) == Some(&publisher))
        };
        let ends = self.lists.runs.iter().skip(1).map(|(row, _)| *row).chain([self.len()]);
        let runs = self.lists.runs.iter().zip(ends);
        let own: Vec<(&[Option<usize>], Range<usize>)> = runs
            .map(|(&(row, place), end)| (self.lists.known[place].as_slice(), row..end))
            .filter(|(list, _)| is_own(list))
            .collect();
        let rows = Rows(own.iter().map(|(_, rows)| rows.clone()).collect());
        let mut table = Self::new(self.form, &self.fields, &self.default_joints, self.alone.as_deref());
        table.lists.apart = true;
        let mut before = 0;
        for (list, run) in own {
            table.lists.begin(before, list);
            before += run.len();
        }
        table.stamps = self.stamps.of_rows(&rows);
        for (joint, name) in
            self.joints.iter().enumerate().filter(|(joint, _)| publishers[*joint] == publisher)
        {
            let Some(here) = table.joint(name) else { continue };
            for (into, from) in table.columns.iter_mut().zip(&mut self.columns) {
                into[here] = rows.of(&std::mem::take(&mut from[joint]));
            }
        }
        (table, rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{
        decode::{Numbers, Sink, Slot, Texts},
        source::{Field, Form, Role, slot},
    };

    /// Messages of joints, each with its row as the value, taken in a block at a time.
    fn table(messages: &[&[&str]], per_block: usize) -> Table {
        let path = "position".to_owned();
        let field = Field { path, role: Role::Either, velocity: None, is_velocity: false };
        let new = || Table::new(Form::Table, std::slice::from_ref(&field), &[], None);
        let (mut all, mut row) = (new(), 0_u32);
        for block in messages.chunks(per_block) {
            let mut part = new();
            for names in block {
                part.element(Slot::MAX);
                part.texts(
                    slot::NAMES,
                    Texts::Parsed(&names.iter().map(|n| (*n).to_owned()).collect::<Vec<_>>()),
                );
                part.numbers(slot::FIELD, Numbers::Parsed(&vec![f64::from(row); names.len()]));
                part.commit(row.into(), row.into());
                row += 1;
            }
            all.append(&mut part);
        }
        all
    }

    fn apart(messages: &[&[&str]], per_block: usize) -> Vec<(Vec<String>, Vec<i64>, u64)> {
        let tables = table(messages, per_block).apart().into_iter();
        let told = |(table, _): (Table, Rows)| {
            let rows: Vec<i64> = table.stamps.log_ns.clone();
            for joint in 0..table.joints.len() {
                assert!(
                    table
                        .column(0, joint)
                        .iter()
                        .zip(&rows)
                        .all(|(q, row)| q.is_nan() || (*q - *row as f64).abs() < 0.5)
                );
            }
            (table.joints.clone(), rows, table.list_changes())
        };
        tables.map(told).collect()
    }

    #[test]
    fn publishers_of_joints_of_their_own_are_told_apart_and_others_are_one() {
        let [a, b]: [&[&str]; 2] = [&["a"], &["b", "c"]];
        let turns: Vec<&[&str]> = (0..20).map(|k| if k % 2 == 0 { a } else { b }).collect();
        for per_block in [1, 3, 100] {
            let found = apart(&turns, per_block);
            assert_eq!(found[0], (vec!["a".into()], (0..20).step_by(2).collect(), 0));
            assert_eq!(found[1], (vec!["b".into(), "c".into()], (1..20).step_by(2).collect(), 0));
        }
        assert_eq!(apart(&[a; 20], 3), []);
        let shared: Vec<&[&str]> = (0..20).map(|k| if k % 2 == 0 { &["a", "b"] } else { b }).collect();
        assert_eq!((apart(&shared, 3), table(&shared, 3).list_changes()), (vec![], 19));
    }

    #[test]
    fn joints_that_others_replace_for_good_and_joints_named_a_few_times_are_told_of() {
        let [a, b]: [&[&str]; 2] = [&["a"], &["b"]];
        let changes = |messages: &[&[&str]]| apart(messages, 3).iter().map(|one| one.2).sum::<u64>();
        assert_eq!(changes(&[[a; 10], [b; 10]].concat()), 1);
        assert_eq!(changes(&[&[a; 10][..], &[b], &[a; 10]].concat()), 2);
    }

    #[test]
    fn the_rows_of_a_file_are_those_of_its_own_publisher() {
        let rows = Rows(vec![2..4, 6..7]);
        assert_eq!([0, 3, 4, 6, 9].map(|row| rows.before(row)), [0, 1, 2, 2, 3]);
        assert_eq!(rows.of(&[0, 1, 2, 3, 4]), [2, 3]);
    }
}
