//! Two columns that say the same of a joint.

use ::csv::ByteRecord;

use super::{
    CsvError, Role, Separator,
    head::Head,
    label::Label,
    number::number,
    options::{describe, option},
    pairing::Draft,
    rows::Rows,
    unit::Unit,
};
use crate::{
    math::quantile,
    remark::{Code, Remarks},
};

/// Words that say plan or measurement where nothing else does.
const SECOND: [&str; 6] = ["estimate", "pfb", "fdb", "pcmd", "req", "dmd"];

/// A set value that the profile of a drive leads to goes so many times as far from row to row as the profile, and both go as far in
/// all but for this share.
const STEPS: f64 = 5.0;
const AS_FAR: f64 = 0.2;

/// Columns that differ by rounding, a share of how far they go, in all rows but for the rest of this share, say the same.
const ROUNDED: f64 = 0.002;
const ALIKE: f64 = 0.99;

/// Two columns for one thing are an error, unless they say the same, or one says so by a word of these, or one is the profile
/// that leads to the set values of the other.
pub(super) fn drop_repeats(
    (text, separator): (&[u8], Separator),
    head: &Head,
    labels: &[Label],
    drafts: &mut Vec<Draft>,
    remarks: &mut Remarks,
) -> Result<(), CsvError> {
    let mut kept: Vec<Draft> = Vec::new();
    for draft in drafts.drain(..) {
        let same = |other: &&Draft| {
            other.key == draft.key && other.role == draft.role && other.quantity == draft.quantity
        };
        let Some(first) = kept.iter().find(same) else {
            kept.push(draft);
            continue;
        };
        // What an observer makes of a measurement, or one drive calls a command, gives way to what says so.
        let weak = |column: usize| labels[column].words.iter().any(|word| SECOND.contains(&word.as_str()));
        let columns = [first.column, draft.column];
        let [before, now] = columns.map(weak);
        let other_unit = || in_another_unit(head, labels, columns);
        let by_word = (before != now).then_some((before, "says the same of a joint as"));
        let by_rows = || match rows_of((text, separator), head, columns) {
            Rowwise::Same => None,
            _ if other_unit() => None,
            Rowwise::Profile(first_steps) if draft.role == Role::Planned => {
                Some(Ok((first_steps, "is of set values that step, which the profile leads to in")))
            }
            Rowwise::Stands(first_stands) => Some(Ok((first_stands, "never moves, other than"))),
            Rowwise::Profile(_) | Rowwise::Differ => Some(Err(())),
        };
        let Ok(gives_way) = by_word.map(Ok).or_else(by_rows).transpose() else {
            let shown = |column: usize| format!("{:?} (#{})", head.names[column], column + 1);
            return Err(CsvError::Twice {
                columns: format!("{} and {}", shown(first.column), shown(draft.column)),
                what: describe(draft.role, draft.quantity),
                joint: draft.joint,
                option: option(draft.role, draft.quantity),
            });
        };
        if let Some((before, why)) = gives_way {
            let [used, left] =
                if before { [draft.column, first.column] } else { [first.column, draft.column] };
            let message =
                format!("column {:?} {why} {:?}, and was not used", head.names[left], head.names[used]);
            remarks.add(Code::Ambiguous, 1, message);
            if before {
                kept.retain(|other| !same(&other));
                kept.push(draft);
            }
            continue;
        }
        let message = format!(
            "column {:?} (#{}) repeats #{} and was not used",
            head.names[draft.column],
            draft.column + 1,
            first.column + 1
        );
        remarks.add(Code::Ambiguous, 1, message);
    }
    *drafts = kept;
    Ok(())
}

/// Whether two columns say the same in two units: `q1_rad` and `q1_deg`.
fn in_another_unit(head: &Head, labels: &[Label], columns: [usize; 2]) -> bool {
    let [Some(one), Some(other)] = columns.map(|column| labels[column].unit) else { return false };
    let read = |row: &Vec<Vec<u8>>, column: usize, unit: Unit| {
        let cell = row.get(column)?;
        let value = number(cell, false).or_else(|| number(cell, true))?;
        Some(value * unit.factor)
    };
    let both = |row: &Vec<Vec<u8>>| Some([read(row, columns[0], one)?, read(row, columns[1], other)?]);
    let pairs: Vec<[f64; 2]> = head.sample.iter().filter_map(both).collect();
    let most = pairs.iter().flatten().fold(0.0_f64, |most, value| most.max(value.abs()));
    one.measure == other.measure
        && one != other
        && pairs.iter().any(|[a, _]| a.to_bits() != pairs[0][0].to_bits())
        && pairs.iter().all(|[a, b]| (a - b).abs() <= ROUNDED * most)
}

/// How two columns are beside each other.
enum Rowwise {
    Same,
    /// One steps to where the other goes by and by: whether that is the first.
    Profile(bool),
    /// One never moves, or holds nothing, and the other moves: whether that is the first.
    Stands(bool),
    Differ,
}

/// By all rows of the table.
fn rows_of((text, separator): (&[u8], Separator), head: &Head, columns: [usize; 2]) -> Rowwise {
    let mut rows = Rows::new(text, separator);
    let mut record = ByteRecord::new();
    let (mut apart, mut last, mut farthest) = (Vec::new(), [f64::NAN; 2], [0.0_f64; 2]);
    let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    while let Some(line) = rows.next(&mut record) {
        if line < head.first_line {
            continue;
        }
        let read = |column: usize| {
            let cell = record.get(column).unwrap_or_default();
            number(cell, false).or_else(|| number(cell, true))
        };
        let both = columns.map(read);
        for (k, value) in both.into_iter().enumerate() {
            let Some(value) = value else { continue };
            farthest[k] = farthest[k].max((value - last[k]).abs());
            last[k] = value;
            range[k] = [range[k][0].min(value), range[k][1].max(value)];
        }
        if let [Some(a), Some(b)] = both {
            apart.push((a - b).abs());
        }
    }
    let travel = range.map(|[lowest, highest]| (highest - lowest).max(0.0));
    let most = travel[0].max(travel[1]);
    let as_far = (travel[0] - travel[1]).abs() <= AS_FAR * most;
    let [a, b] = farthest;
    let moves = travel.map(|travel| travel > 0.0);
    if moves[0] != moves[1] {
        Rowwise::Stands(moves[1])
    } else if apart.is_empty() || quantile(apart, ALIKE) <= ROUNDED * most {
        Rowwise::Same
    } else if as_far && (a > STEPS * b || b > STEPS * a) {
        Rowwise::Profile(a > b)
    } else {
        Rowwise::Differ
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CsvError, CsvOptions, CsvRun, read_csv_bytes};

    fn read(header: &str, row: impl Fn(u32) -> [f64; 2]) -> Result<CsvRun, CsvError> {
        let row = |k: u32| {
            let [a, b] = row(k);
            format!("{:.2},{a:.3},{b:.3},{b:.3}\n", 0.01 * f64::from(k))
        };
        let table = format!("t,{header},j1_pos_deg\n{}", (0..4000).map(row).collect::<String>());
        read_csv_bytes("a.csv", table.as_bytes(), &CsvOptions::default())
    }

    #[test]
    fn of_a_goal_and_its_profile_the_profile_is_the_plan_in_either_order() {
        let goal = |k: u32| if k < 3000 { 0.0 } else { 10.0 };
        let profile = |k: u32| f64::from(k.clamp(3000, 3500) - 3000) / 50.0;
        let planned = |run: CsvRun| run.understood.columns[0].header.clone();
        let run = read("j1_goal_deg,j1_ref_deg", |k| [goal(k), profile(k)]).unwrap();
        assert!(run.remarks.as_slice().iter().any(|remark| remark.message.contains("set values")));
        assert_eq!(planned(run), "j1_ref_deg");
        assert_eq!(planned(read("j1_ref_deg,j1_goal_deg", |k| [profile(k), goal(k)]).unwrap()), "j1_ref_deg");
        let other = read("j1_ref_deg,j1_goal_deg", |k| [profile(k), 0.5 * profile(k)]);
        assert!(matches!(other, Err(CsvError::Twice { .. })), "{other:?}");
        let same = read("j1_ref_deg,j1_goal_deg", |k| [profile(k); 2]).unwrap();
        assert!(same.remarks.as_slice().iter().any(|remark| remark.message.contains("repeats")));
    }
}
