//! What is proposed for a table without names: its columns by their number, those side by side that follow each other.

use ::csv::ByteRecord;

use super::{
    clock::{Found, Look},
    number::number,
    rows::Rows,
    unit::{FARTHEST_DEG, FARTHEST_RAD},
};
use crate::math::median;

/// Rows of a time that do not rise, as where a recorder was started again: one in so many.
const SELDOM: usize = 1000;

/// Columns that are compared, by as many rows at most.
const MOST_COLUMNS: usize = 200;
const MOST_ROWS: usize = 4000;

/// Two columns follow each other where they differ by less than this share of how far they move, root mean square, and not at all
/// nowhere.
const ALIKE: f64 = 0.3;

/// A column that is so many times as noisy as the other was measured.
const NOISIER: f64 = 3.0;

impl Look<'_> {
    /// The options that name columns of a table without names by their number; none of one with names.
    pub(super) fn by_number(&self, text: &[u8]) -> Vec<String> {
        if self.head.named {
            return Vec::new();
        }
        let columns = 0..self.labels.len();
        let rises = |column: &usize| {
            let Some(Found { source, .. }) = self.rising(*column) else { return false };
            let [ns, _] = self.both(text, [&source; 2]);
            SELDOM * ns.windows(2).filter(|two| two[0] >= two[1]).count() <= ns.len()
        };
        let time = columns.clone().find(rises);
        // What counts the rows says no time.
        let doubt = |column: usize| self.rising(column).and_then(|found| found.doubt);
        let counts = |column: &usize| doubt(*column).is_some_and(|doubt| doubt.contains("--rate HZ"));
        let clock = time.filter(|column| !counts(column));
        let first = clock.map_or("--rate HZ".to_owned(), |column| format!("--time '#{}'", column + 1));
        let others: Vec<usize> = columns.filter(|column| Some(*column) != time).collect();
        let values = self.values(text, &others);
        let reach = |columns: &[usize]| {
            let of = |column: &usize| values.iter().find(|(other, _)| other == column);
            columns.iter().filter_map(of).flat_map(|(_, own)| own).fold(0.0_f64, |most, x| most.max(x.abs()))
        };
        let pairs = pairs(&values);
        let sides = match (&pairs[..], &others[..]) {
            ([], [one, other]) => [vec![*one], vec![*other]],
            ([], _) => [Vec::new(), Vec::new()],
            (pairs, _) => [0, 1].map(|side| pairs.iter().map(|pair| pair[side]).collect()),
        };
        let turns = self.options.angle_unit.is_none() && self.options.slides.is_empty();
        let far = (FARTHEST_RAD..=FARTHEST_DEG).contains(&reach(&sides.concat()));
        let degrees = (turns && far).then(|| "--degrees".to_owned());
        let named = |(side, columns): (&str, &Vec<usize>)| {
            let each = (1..).zip(columns).map(|(joint, column)| format!("J{joint}=#{}", column + 1));
            let all = each.collect::<Vec<_>>().join(",");
            format!("{side} '{}'", if all.is_empty() { "J1=#COLUMN" } else { &all })
        };
        let sides = ["--planned", "--measured"].into_iter().zip(&sides).map(named);
        std::iter::once(first).chain(sides).chain(degrees).collect()
    }

    /// Values of columns that hold a number in each row, of rows spread evenly over the table.
    fn values(&self, text: &[u8], columns: &[usize]) -> Vec<(usize, Vec<f64>)> {
        let mut rows = Rows::new(text, self.dialect.separator);
        let mut record = ByteRecord::new();
        let mut all: Vec<(usize, Vec<f64>)> =
            columns.iter().take(MOST_COLUMNS).map(|column| (*column, Vec::new())).collect();
        let mut count = 0;
        while let Some(line) = rows.next(&mut record) {
            if line < self.head.first_line {
                continue;
            }
            count += 1;
            for (column, values) in &mut all {
                let cell = record.get(*column).unwrap_or_default();
                values.extend(number(cell, self.dialect.decimal_comma).filter(|value| value.is_finite()));
            }
        }
        all.retain(|(_, values)| values.len() == count);
        let step = count.div_ceil(MOST_ROWS).max(1);
        all.into_iter().map(|(column, values)| (column, values.into_iter().step_by(step).collect())).collect()
    }
}

/// Columns that follow one another, as many columns apart as most that do, or as those that do best, each in one pair: the one that goes
/// first and the other.
fn pairs(values: &[(usize, Vec<f64>)]) -> Vec<[usize; 2]> {
    let mut alike: Vec<(usize, f64, [usize; 2])> = Vec::new();
    for (k, (one, a)) in values.iter().enumerate() {
        for (other, b) in &values[k + 1..] {
            alike.extend(apart(a, b).map(|share| (other - one, share, [*one, *other])));
        }
    }
    let of = |apart: usize| alike.iter().filter(move |one| one.0 == apart);
    let best = |apart: usize| of(apart).map(|one| one.1).fold(f64::INFINITY, f64::min);
    let by = |a: usize, b: usize| of(a).count().cmp(&of(b).count()).then(best(b).total_cmp(&best(a)));
    let Some(apart) = alike.iter().map(|one| one.0).max_by(|a, b| by(*a, *b)) else { return Vec::new() };
    let mut found: Vec<[usize; 2]> = Vec::new();
    for (.., pair) in of(apart) {
        if !found.iter().flatten().any(|taken| pair.contains(taken)) {
            found.push(*pair);
        }
    }
    let own =
        |column: usize| values.iter().find(|(other, _)| *other == column).map_or(&[][..], |(_, own)| own);
    let leads = |pair: &&[usize; 2]| {
        let [a, b] = pair.map(own);
        let [of_a, of_b] = [noise(a), noise(b)];
        if of_a.max(of_b) > NOISIER * of_a.min(of_b) {
            return of_a < of_b;
        }
        let off = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        off(&a[1..], b) > off(a, &b[1..])
    };
    if 2 * found.iter().filter(leads).count() < found.len() {
        for pair in &mut found {
            pair.reverse();
        }
    }
    found
}

/// What usually comes between three values besides a line: of a plan nothing, whether it goes smoothly or in steps.
fn noise(values: &[f64]) -> f64 {
    median(values.windows(3).map(|three| (three[2] - 2.0 * three[1] + three[0]).abs()).collect())
}

/// By how much columns that move nearly alike differ, as a share of how far they move; `None` of others.
fn apart(a: &[f64], b: &[f64]) -> Option<f64> {
    let moved = crate::math::deviation(a).max(crate::math::deviation(b));
    let square = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len().max(1) as f64;
    (a.len() > 1 && square > 0.0 && square.sqrt() < ALIKE * moved).then(|| square.sqrt() / moved)
}
