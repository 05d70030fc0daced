//! Tables with a row for each joint or signal at each instant, as databases give them, become tables with a row an
//! instant.

use std::collections::{BTreeMap, BTreeSet};

use ::csv::ByteRecord;

use super::{
    CsvOptions, Role,
    date::{DateForm, Part},
    dialect::Dialect,
    head::{Head, looked_at},
    keys::{Changes, NAMES},
    label::label,
    number::{Looks, looks, number},
    restarts::apart,
    rows::{Rows, cell_text, writer},
    word::{Meaning, Word, words},
};
use crate::remark::{Code, Remarks};

/// First words of headers of columns that say only that they hold the value.
const VALUES: [&str; 8] = ["value", "values", "val", "wert", "varvalue", "floatvalue", "intvalue", "值"];

/// Stands between cells that are kept, and in none that is a number.
const END: u8 = b'\n';

/// More signals than these are no joints.
const MOST_NAMES: usize = 512;

/// Names that a remark lists.
const SHOWN: usize = 8;

/// Cells by filled cells of a table that is worth making.
const MOST_EMPTY: usize = 64;

/// What the columns of a long table hold.
struct Long {
    dialect: Dialect,
    head: Head,
    times: Vec<usize>,
    names: Vec<usize>,
    values: Vec<usize>,
    /// Whether the names alone say what the values are.
    bare: bool,
    /// Whether rows of the names come in turns, and hold values that jump with them.
    interleaved: bool,
    /// Whether that alone tells the column of names.
    guessed: bool,
}

/// The text of a long table with a row an instant, and how that is read; `None` if it is no long table.
pub(super) fn widened(
    file: &str,
    text: &[u8],
    options: &CsvOptions,
    remarks: &mut Remarks,
) -> Option<(Vec<u8>, CsvOptions)> {
    let (dialect, head) = looked_at(file, text, options)?;
    let long = Long::of(dialect, head, options)?;
    let gathered = long.gather(text)?;
    let mut wide = writer(dialect.separator);
    let names = long.times.iter().map(|&column| long.head.names[column].clone());
    wide.write_record(names.chain(long.headers(&gathered.ids))).ok()?;
    for (row, time) in gathered.times.iter().enumerate() {
        let cells = gathered.row(row).map(|[from, to]| gathered.text.get(from..to).unwrap_or_default());
        wide.write_record(time.iter().map(Vec::as_slice).chain(cells)).ok()?;
    }
    if long.guessed {
        let header = &long.head.names[*long.names.first()?];
        let shown: Vec<String> = gathered.ids.iter().take(SHOWN).flatten().map(|id| cell_text(id)).collect();
        let message = format!(
            "column {header:?} says of which joint a row is, because values jump with it: {}",
            shown.join(", ")
        );
        remarks.add(Code::Guessed, 1, message);
    }
    let message = "values of a signal at an instant that it has another value at, left out: is the table of several runs \
                   or machines?";
    remarks.add(Code::DuplicateStamp, gathered.twice, message);
    Some((wide.into_inner().ok()?, dialect.rewritten(options)))
}

/// Whether the cells of a column say whether a row is planned, measured or sent, and no two of them the same.
fn tells_sides(head: &Head, column: usize) -> bool {
    let cells = head.sample.iter().filter_map(|row| row.get(column)).map(|cell| cell_text(cell));
    let cells: BTreeSet<String> = cells.filter(|cell| !cell.is_empty()).collect();
    let side = |cell: &String| match words(cell).as_slice() {
        [Word { meaning: Meaning::Role(role), .. }] => Some(*role),
        _ => None,
    };
    let sides: Option<BTreeSet<Role>> = cells.iter().map(side).collect();
    sides.is_some_and(|sides| sides.len() > 1 && sides.len() == cells.len())
}

/// Cells of some columns of a row.
type Key = Vec<Vec<u8>>;

/// What the rows of a long table hold.
struct Gathered {
    ids: Vec<Key>,
    /// Cells of the time, `[rows]`.
    times: Vec<Key>,
    /// The cells of the values, one after the other.
    text: Vec<u8>,
    /// Where in that each cell is, `[rows][ids x values]`; nowhere if there is none.
    cells: Vec<[usize; 2]>,
    width: usize,
    /// Values beyond the first of a signal at an instant that differ from it.
    twice: u64,
}

impl Gathered {
    fn row(&self, row: usize) -> impl Iterator<Item = [usize; 2]> {
        self.cells.iter().skip(row * self.width).take(self.width).copied()
    }
}

impl Long {
    fn of(dialect: Dialect, head: Head, options: &CsvOptions) -> Option<Self> {
        if !head.named || options.rate_hz.is_some() {
            return None;
        }
        let plain = |column: &usize| head.names[*column].trim_matches(['_', ' ']).to_lowercase();
        let all = 0..head.names.len();
        let sided = |column: &usize| tells_sides(&head, *column);
        let named: Vec<usize> =
            all.clone().filter(|column| NAMES.contains(&plain(column).as_str()) || sided(column)).collect();
        let timely = |column: &usize| match &options.time {
            Some(time) => time.eq_ignore_ascii_case(&head.names[*column]),
            None => label(&head.names[*column], None).is_time,
        };
        let times: Vec<usize> =
            all.clone().filter(|column| !named.contains(column) && timely(column)).collect();
        if times.is_empty() {
            return None;
        }
        let says_value = |column: &usize| {
            let header = plain(column);
            words(&header).first().is_some_and(|word| VALUES.contains(&word.text))
        };
        let position = |column: &usize| {
            let label = label(&head.names[*column], None);
            label.role.is_some() || label.is_joint || says_value(column)
        };
        let other = |column: &usize| !named.contains(column) && !times.contains(column);
        let positions: Vec<usize> = all.clone().filter(|column| other(column) && position(column)).collect();
        let changes =
            Changes { head: &head, decimal_comma: dialect.decimal_comma, times: &times, values: &positions };
        let guess = || changes.key(all.clone().filter(|column| other(column) && !position(column)));
        let found = if named.is_empty() { guess() } else { None };
        let in_turns = |column: &usize| sided(column) || changes.is_interleaved(*column);
        let interleaved = named.iter().any(in_turns) || found.is_some();
        let guessed = found.is_some();
        let names = if guessed { found.into_iter().collect() } else { named };
        if names.is_empty() {
            return None;
        }
        let numeric = |column: &usize| {
            let cells = head.sample.iter().filter_map(|row| row.get(*column)).map(|cell| looks(cell));
            let (mut numbers, mut others) = (0, 0);
            for look in cells {
                match look {
                    Looks::Whole | Looks::Point | Looks::Comma => numbers += 1,
                    Looks::Empty => {}
                    Looks::Date | Looks::Text => others += 1,
                }
            }
            numbers > others
        };
        let rest = all.filter(|column| !names.contains(column) && !times.contains(column) && numeric(column));
        let rest: Vec<usize> = rest.collect();
        let values: Vec<usize> = rest.iter().filter(|column| says_value(column)).copied().collect();
        let bare = !values.is_empty();
        let values = if bare { values } else { rest };
        (!values.is_empty()).then_some(Self {
            dialect,
            head,
            times,
            names,
            values,
            bare,
            interleaved,
            guessed,
        })
    }

    /// `None` if the rows are not of several signals at each instant.
    fn gather(&self, text: &[u8]) -> Option<Gathered> {
        let mut of_id: BTreeMap<Key, usize> = BTreeMap::new();
        let mut times: BTreeMap<Key, usize> = BTreeMap::new();
        let (mut ids, mut kept, mut found) = (Vec::new(), Vec::new(), Vec::new());
        let mut rows = Rows::new(text, self.dialect.separator);
        let mut record = ByteRecord::new();
        while let Some(line) = rows.next(&mut record) {
            let cell = |column: &usize| record.get(*column).unwrap_or_default().trim_ascii();
            let key =
                |columns: &[usize]| -> Key { columns.iter().map(|column| cell(column).to_vec()).collect() };
            let usable =
                self.values.iter().any(|column| number(cell(column), self.dialect.decimal_comma).is_some());
            if line < self.head.first_line || record.len() != self.dialect.width || !usable {
                continue;
            }
            let (id, next) = (key(&self.names), ids.len());
            let id_at = *of_id.entry(id.clone()).or_insert(next);
            if id_at == next {
                ids.push(id);
            }
            if ids.len() > MOST_NAMES {
                return None;
            }
            let next = times.len();
            found.push((*times.entry(key(&self.times)).or_insert(next), id_at));
            for column in &self.values {
                kept.extend(cell(column).iter().filter(|byte| **byte != END));
                kept.push(END);
            }
        }
        // A column of words beside rows with times of their own is a note.
        let shared = 2 * found.len() >= 3 * times.len();
        let sparse = times.len().saturating_mul(ids.len()) > MOST_EMPTY * found.len();
        if ids.len() < 2 || !(shared || self.bare || self.interleaved) || sparse {
            return None;
        }
        let order = self.in_order(&times);
        let mut place = vec![0; order.len()];
        order.iter().enumerate().for_each(|(at, (row, _))| place[*row] = at);
        for (row, _) in &mut found {
            *row = place[*row];
        }
        let mut times: Vec<Key> = order.into_iter().map(|(_, time)| time.clone()).collect();
        let (mut cells, mut twice) = self.cells(&kept, &found, [times.len(), ids.len()])?;
        if twice > 0
            && let Some((apart, rows)) = apart(&found)
        {
            (cells, twice) = self.cells(&kept, &apart, [rows.len(), ids.len()])?;
            times = rows.into_iter().map(|row| times[row].clone()).collect();
        }
        let width = ids.len() * self.values.len();
        Some(Gathered { ids, times, text: kept, cells, width, twice })
    }

    /// Where the values lie in the text, by row and then by name, and how many more there are than places for them.
    fn cells(
        &self,
        text: &[u8],
        found: &[(usize, usize)],
        [rows, names]: [usize; 2],
    ) -> Option<(Vec<[usize; 2]>, u64)> {
        let width = names * self.values.len();
        let mut cells = vec![[0; 2]; rows.checked_mul(width)?];
        let mut ends = memchr::memchr_iter(END, text);
        let (mut from, mut twice) = (0, 0);
        for (row, id_at) in found {
            for value in 0..self.values.len() {
                let to = ends.next()?;
                let slot = &mut cells[row * width + id_at * self.values.len() + value];
                if slot[0] == slot[1] {
                    *slot = [from, to];
                } else if text.get(from..to) != text.get(slot[0]..slot[1]) {
                    twice += 1;
                }
                from = to + 1;
            }
        }
        Some((cells, twice))
    }

    /// The rows in the order of their times: blocks of signals that have times of their own come one after the other.
    fn in_order<'a>(&self, times: &'a BTreeMap<Key, usize>) -> Vec<(usize, &'a Key)> {
        let mut rows: Vec<(usize, &Key)> = times.iter().map(|(time, row)| (*row, time)).collect();
        rows.sort_unstable_by_key(|(row, _)| *row);
        let comma = self.dialect.decimal_comma;
        let one = |time: &Key| time.first().and_then(|cell| number(cell, comma)).filter(|t| t.is_finite());
        let iso = |time: &Key| time.first().is_some_and(|cell| cell.get(4) == Some(&b'-'));
        if self.times.len() == 1 && rows.iter().all(|(_, time)| one(time).is_some()) {
            rows.sort_by(|a, b| one(a.1).unwrap_or_default().total_cmp(&one(b.1).unwrap_or_default()));
        } else if rows.iter().all(|(_, time)| iso(time)) {
            let plain = |time: &Key| -> Key {
                time.iter().map(|cell| cell.strip_suffix(b"Z").unwrap_or(cell).to_vec()).collect()
            };
            rows.sort_by_cached_key(|(_, time)| plain(time));
        } else if self.times.len() == 1
            && let Some(form) = DateForm::fitting(&rows.iter().map(|(_, time)| time[0].as_slice())).first()
            && form.part == Part::Local
        {
            rows.sort_by_cached_key(|(_, time)| form.ns(&time[0]));
        }
        rows
    }

    /// A header for each signal: what the row is of, and what the column says.
    fn headers(&self, ids: &[Key]) -> Vec<String> {
        let telling = |k: &usize| ids.iter().map(|id| &id[*k]).collect::<BTreeSet<_>>().len() > 1;
        let telling: Vec<usize> = (0..self.names.len()).filter(telling).collect();
        let name = |id: &[Vec<u8>]| {
            let parts = telling.iter().map(|&k| {
                let text = cell_text(&id[k]);
                let counts = text.bytes().all(|byte| byte.is_ascii_digit());
                if counts {
                    format!("{} {text}", self.head.names[self.names[k]].trim_matches('_'))
                } else {
                    text
                }
            });
            parts.collect::<Vec<_>>().join(" ")
        };
        let of_value = |column: usize| {
            let header = self.head.names[column].trim_matches('_');
            match words(&header.to_lowercase()).first().filter(|_| self.bare) {
                Some(word) => header.get(word.text.len()..).unwrap_or_default().to_owned(),
                None => format!(" {header}"),
            }
        };
        let columns = ids.iter().flat_map(|id| self.values.iter().map(move |&column| (id, column)));
        columns.map(|(id, column)| name(id) + &of_value(column)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wide(text: &str) -> Option<String> {
        let (wide, _) = widened("a.csv", text.as_bytes(), &CsvOptions::default(), &mut Remarks::default())?;
        Some(String::from_utf8(wide).unwrap())
    }

    #[test]
    fn a_row_for_each_joint_becomes_a_row_an_instant() {
        let text =
            "time,joint,planned_deg,actual_deg\n0.0,boom,1,2\n0.0,arm,3,4\n0.1,boom,5,6\n0.1,arm,7,8\n";
        let expected = "time,boom planned_deg,boom actual_deg,arm planned_deg,arm actual_deg\n0.0,1,2,3,4\n0.1,5,6,7,8\n";
        assert_eq!(wide(text).as_deref(), Some(expected));
        let text = "t;axis;set [mm]\n0,0;1;1,5\n0,0;2;2,5\n0,1;1;3,5\n";
        assert_eq!(wide(text).as_deref(), Some("t;axis 1 set [mm];axis 2 set [mm]\n0,0;1,5;2,5\n0,1;3,5;\n"));
    }

    #[test]
    fn a_column_that_the_values_jump_with_tells_joints_apart_whatever_it_is_called() {
        let rows = |row: &dyn Fn(u32, &str, f64) -> String| -> String {
            (0..20).map(|k| row(k, "a", 10.0 + f64::from(k)) + &row(k, "b", 90.0 + f64::from(k))).collect()
        };
        let headers =
            |text: String| wide(&text).map(|text| text.lines().next().unwrap_or_default().to_owned());
        let expected = Some("t,a set_deg,a act_deg,b set_deg,b act_deg".to_owned());
        // At the same instants, or each at its own.
        let same = rows(&|k, of, q| format!("{k},{of},{q},{q}\n"));
        assert_eq!(headers(format!("t,vin,set_deg,act_deg\n{same}")), expected);
        let own = rows(&|k, of, q| format!("{k}.{},{of},{q},{q}\n", if of == "a" { 1 } else { 6 }));
        assert_eq!(headers(format!("t,vin,set_deg,act_deg\n{own}")), expected);
        assert_eq!(headers(format!("t,joint,set_deg,act_deg\n{own}")), expected);
        // A life bit comes in turns, too.
        let row = |k: u32| format!("{k},{},{},{}\n", k % 2, 10 + k, 9 + k);
        let bit: String = (0..40).map(row).collect();
        assert_eq!(headers(format!("t,life,boom_set_deg,boom_act_deg\n{bit}")), None);
    }

    #[test]
    fn signals_one_after_the_other_are_put_beside_each_other() {
        let text = "#group,false\n,table,_time,_value,_field,_measurement\n\
                    ,0,2026-11-20T10:00:00Z,1.5,boom_set,arm\n,0,2026-11-20T10:00:01Z,2.5,boom_set,arm\n\n\
                    ,table,_time,_value,_field,_measurement\n,1,2026-11-20T10:00:00.5Z,0.5,boom_actual,arm\n";
        let expected = "_time,boom_set,boom_actual\n2026-11-20T10:00:00Z,1.5,\n2026-11-20T10:00:00.5Z,,0.5\n\
                        2026-11-20T10:00:01Z,2.5,\n";
        assert_eq!(wide(text).as_deref(), Some(expected));
        let text = "VarName;Time;VarValue\nb_set;0;1\nb_act;0;2\nb_set;1;3\n";
        assert_eq!(wide(text).as_deref(), Some("Time;b_set;b_act\n0;1;2\n1;3;\n"));
        let text = "time,name,value_deg\n0,boom set,1\n0,boom act,2\n1,boom set,3\n1,boom act,4\n";
        assert_eq!(wide(text).as_deref(), Some("time,boom set_deg,boom act_deg\n0,1,2\n1,3,4\n"));
    }

    #[test]
    fn a_column_of_words_beside_a_row_an_instant_is_a_note() {
        assert_eq!(wide("t,name,q_set,q_act\n0,lift,1,2\n1,lift,1,2\n2,place,1,2\n3,place,1,2\n"), None);
        assert_eq!(wide("t,name,q_set,q_act\n0,a,1,2\n0,a,1,2\n1,a,1,2\n"), None);
        assert_eq!(wide("t,q_set,q_act\n0,1,2\n1,1,2\n"), None);
    }
}
