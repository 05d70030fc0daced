//! Where the numbers begin, and the names above them.

use std::collections::BTreeSet;

use ::csv::ByteRecord;

use super::{
    CsvOptions,
    agreed::agree,
    dialect::{Dialect, detect, head},
    label::{Label, label},
    number::{Looks, looks, says_absent},
    rows::{Rows, cell_text},
    scale::unit_alone,
};
use crate::{
    remark::{Code, Remarks},
    text::of_spreadsheet_cell,
};

/// The names of the columns and the first rows below them.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Head {
    /// By column; `column_3` where the file has none.
    pub(super) names: Vec<String>,
    /// Cells of the header as the file has them; none without one.
    pub(super) written: Vec<String>,
    /// Whether the file has a header.
    pub(super) named: bool,
    /// Whether the header names fewer columns than every row has: which of them has no name cannot be told.
    pub(super) is_short: bool,
    /// Cells of a row of units below the header.
    pub(super) units: Option<Vec<String>>,
    /// Line of the header, 0 if there is none.
    pub(super) line: u64,
    /// Line of the first row of numbers.
    pub(super) first_line: u64,
    /// Rows above the header.
    pub(super) above: usize,
    /// The first rows of numbers, as cells.
    pub(super) sample: Vec<Vec<Vec<u8>>>,
}

impl Head {
    /// What the header and the row of units below it say of each column.
    pub(super) fn labels(&self) -> Vec<Label> {
        let below = |column: usize| self.units.as_ref().and_then(|units| units.get(column));
        let names = self.names.iter().enumerate();
        let mut labels: Vec<Label> =
            names.map(|(column, name)| label(name, below(column).map(String::as_str))).collect();
        agree(&mut labels);
        labels
    }
}

const SAMPLE_ROWS: usize = 200;

/// So many rows with numbers may stand above the names of columns.
const FEW_ROWS: usize = 5;

/// How a text is written and its head, without a remark; `None` if it is no table.
pub(super) fn looked_at(file: &str, text: &[u8], options: &CsvOptions) -> Option<(Dialect, Head)> {
    let dialect = detect(file, text, options).ok()?;
    Some((dialect, read_head(text, dialect, &mut Remarks::default())))
}

pub(super) fn read_head(text: &[u8], dialect: Dialect, remarks: &mut Remarks) -> Head {
    let start = head(text);
    let mut rows = Rows::new(start, dialect.separator);
    let mut record = ByteRecord::new();
    let mut above: Vec<(u64, Vec<String>)> = Vec::new();
    let mut found = Head::default();
    while found.sample.len() < SAMPLE_ROWS
        && let Some(line) = rows.next(&mut record)
    {
        if found.sample.is_empty() && !is_data(&record, dialect.width) && !is_first_event(&record, &above) {
            above.push((line, record.iter().map(cell_text).collect()));
            continue;
        }
        if found.sample.len() < FEW_ROWS {
            let cells: Vec<String> = record.iter().map(cell_text).collect();
            let again = above.iter().any(|(_, other)| *other == cells);
            if record.len().abs_diff(dialect.width) <= 1 && cells.len() > 2 && are_names(&cells) && !again {
                // What came before looked like numbers, but the names stand here.
                found.sample.clear();
                above.push((line, cells));
                continue;
            }
        }
        let fits_names =
            |(_, cells): &(u64, Vec<String>)| cells.len().abs_diff(dialect.width) <= 1 && are_names(cells);
        if let [first] = found.sample.as_slice()
            && !above.iter().any(fits_names)
            && let Some(cells) = names_beside_numbers(first, &record)
        {
            found.sample.clear();
            above.push((found.first_line, cells));
        }
        if found.sample.is_empty() {
            found.first_line = line;
        }
        if record.len() == dialect.width {
            found.sample.push(record.iter().map(<[u8]>::to_vec).collect());
        }
    }
    let mut units = None;
    above.retain(|(_, cells)| match described(cells) {
        None => true,
        Some((key, values)) => {
            units = units.take().or(key.eq_ignore_ascii_case("unit").then_some(values));
            false
        }
    });
    // A header may lack the empty cell that a trailing separator adds to every row, or have it alone.
    let fits = |cells: &[String]| {
        cells.len().abs_diff(dialect.width) <= 1 && cells.iter().any(|cell| !cell.is_empty())
    };
    let mut whole = None;
    if !above.iter().any(|(_, cells)| fits(cells)) {
        above.retain(|(_, cells)| are_names(cells));
        if let Some((line, cells)) = above.last_mut() {
            let message = format!(
                "the header, line {line}, has {} cells and the rows have {}; its names are taken from the left",
                cells.len(),
                dialect.width
            );
            remarks.add(Code::LengthMismatch, 1, message);
            whole = Some(cells.clone());
            cells.resize(dialect.width, String::new());
        }
    }
    let named = above.iter().rposition(|(_, cells)| fits(cells));
    let below = named.map_or(0, |at| above.len() - at - 1) as u64;
    let message = "rows between the header and the first row of numbers that have other cells; left out";
    remarks.add(Code::LengthMismatch, below, message);
    above.retain(|(_, cells)| fits(cells));
    if above.len() > 1 && above.last().is_some_and(|(_, cells)| is_units(cells)) {
        found.units = above.pop().map(|(_, cells)| cells);
    }
    found.units = found.units.or(units);
    if let Some((line, names)) = above.pop() {
        found.line = line;
        found.written = whole.unwrap_or_else(|| names.clone());
        found.names = names;
        found.above = above.len();
        found.named = true;
    } else if let Some((line, names)) = commented(start, found.first_line, dialect) {
        found.line = line;
        found.written.clone_from(&names);
        found.names = names;
        found.named = true;
    }
    let written = found.written.len();
    let holds = |row: &Vec<Vec<u8>>| row[written..].iter().any(|cell| !cell.trim_ascii().is_empty());
    let is_short = found.named && written < dialect.width && !found.sample.is_empty();
    found.is_short = is_short && found.sample.iter().all(holds);
    found.names.resize(dialect.width, String::new());
    for (name, number) in found.names.iter_mut().zip(numbered(dialect.width)) {
        *name = of_spreadsheet_cell(name).to_owned();
        if name.is_empty() {
            *name = number;
        }
    }
    found
}

/// Names of columns that have none.
pub(super) fn numbered(width: usize) -> Vec<String> {
    (1..=width).map(|number| format!("column_{number}")).collect()
}

/// Whether a row is one of numbers: as wide as most, and no more words than numbers; or a time and a number beside words
/// that say of what it is.
fn is_data(record: &ByteRecord, width: usize) -> bool {
    let told = record.iter().filter(|cell| !says_absent(cell));
    let all: Vec<Looks> = told.map(looks).filter(|looks| *looks != Looks::Empty).collect();
    let words = all.iter().filter(|looks| **looks == Looks::Text).count();
    let numbers = all.len() - words;
    record.len() == width && !all.is_empty() && (words < numbers || numbers >= 2)
}

/// Whether a row has a time and below all names one and the same word, as the first events of a historian do: `Pt Created`.
fn is_first_event(record: &ByteRecord, above: &[(u64, Vec<String>)]) -> bool {
    let mut cells = record.iter();
    let timed = cells.next().is_some_and(|cell| !matches!(looks(cell), Looks::Text | Looks::Empty));
    let Some(word) = cells.next().filter(|word| timed && looks(word) == Looks::Text) else { return false };
    let named = above.last().is_some_and(|(_, names)| names.len() == record.len() && are_names(names));
    named && cells.all(|cell| cell == word)
}

/// The words of a first row that has more of them than numbers, all above numbers of the next row: somebody wrote beside the names.
fn names_beside_numbers(first: &[Vec<u8>], next: &ByteRecord) -> Option<Vec<String>> {
    let of = |cell: &[u8]| if says_absent(cell) { Looks::Empty } else { looks(cell) };
    let is_word = |cell: &&Vec<u8>| of(cell) == Looks::Text;
    let words = first.iter().filter(is_word).count();
    let numbers = first.iter().filter(|cell| !matches!(of(cell), Looks::Text | Looks::Empty)).count();
    let above_numbers = first
        .iter()
        .zip(next)
        .all(|(cell, below)| of(cell) != Looks::Text || !matches!(of(below), Looks::Text | Looks::Empty));
    let name = |cell: &Vec<u8>| if is_word(&cell) { cell_text(cell) } else { String::new() };
    let names: Vec<String> = first.iter().map(name).collect();
    (words > numbers.max(1) && numbers > 0 && above_numbers && are_names(&names)).then_some(names)
}

/// Whether the cells of a row may be the names of columns: several, none a number, no two alike.
pub(super) fn are_names(cells: &[String]) -> bool {
    let named: Vec<&String> = cells.iter().filter(|cell| !cell.is_empty()).collect();
    let distinct: BTreeSet<&String> = named.iter().copied().collect();
    named.len() > 1
        && distinct.len() == named.len()
        && named.iter().all(|cell| looks(cell.as_bytes()) == Looks::Text)
}

/// The word and what follows it, if each cell of a row is empty or such as `Unit: deg`, all with the same word.
fn described(cells: &[String]) -> Option<(String, Vec<String>)> {
    let (word, _) = cells.iter().find(|cell| !cell.is_empty())?.split_once(": ")?;
    let said = cells.iter().map(|cell| match cell.split_once(": ") {
        Some((one, said)) if one == word => Some(said.to_owned()),
        _ => cell.is_empty().then(String::new),
    });
    let said = said.collect::<Option<Vec<String>>>()?;
    (said.iter().filter(|said| !said.is_empty()).count() > 1).then(|| (word.to_owned(), said))
}

fn is_units(cells: &[String]) -> bool {
    let stated = |cell: &String| !cell.is_empty() && cell != "-";
    cells.iter().any(stated)
        && cells.iter().filter(|cell| stated(cell)).all(|cell| unit_alone(cell).is_some())
}

/// A header that is written as the last comment above the numbers that says something, perhaps behind a word (`Columns: t q`) or between
/// blanks.
fn commented(start: &[u8], first_line: u64, dialect: Dialect) -> Option<(u64, Vec<String>)> {
    let before = usize::try_from(first_line).ok()?.checked_sub(1)?;
    let lines = start.split(|byte| *byte == b'\n').take(before).enumerate();
    let says = |(_, line): &(usize, &[u8])| !matches!(line.trim_ascii(), b"" | b"#");
    let (line, text) = lines.filter(says).last()?;
    let text = text.trim_ascii().strip_prefix(b"#")?.trim_ascii();
    let behind = text.iter().position(|byte| *byte == b':').map(|at| text[at + 1..].trim_ascii());
    let names = |text: &[u8]| -> Option<Vec<String>> {
        let mut record = ByteRecord::new();
        Rows::new(text, dialect.separator).next(&mut record)?;
        let separated: Vec<String> = record.iter().map(cell_text).collect();
        let blank = || text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).map(cell_text);
        let fits = |names: &Vec<String>| names.len() == dialect.width;
        Some(separated).filter(fits).or_else(|| Some(blank().collect()).filter(fits))
    };
    let names = [Some(text), behind].into_iter().flatten().find_map(names)?;
    Some((line as u64 + 1, names))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::csv::{CsvOptions, dialect::detect};

    fn of(text: &str) -> Head {
        let dialect = detect("a.csv", text.as_bytes(), &CsvOptions::default()).unwrap();
        read_head(text.as_bytes(), dialect, &mut Remarks::default())
    }

    #[test]
    fn a_header_longer_than_the_rows_is_kept() {
        let head = of("t,q_set,q_act,note,operator\n0,1,2\n1,1,2\n2,1,2\n");
        assert_eq!((head.names.as_slice(), head.line), (&["t", "q_set", "q_act"].map(str::to_owned)[..], 1));
    }

    #[test]
    fn a_header_may_stand_below_other_lines_and_above_its_units() {
        let head =
            of("Trace;of arm\nStart;12\nt;\"q ist\";q soll\ns;deg;deg\n0;1;2\n1;1;2\n2;1;2\n3;1;2\n4;1;2\n");
        assert_eq!(head.names, ["t", "q ist", "q soll"]);
        assert_eq!((head.line, head.first_line, head.units.is_some()), (3, 5, true));
        assert_eq!(head.sample.len(), 5);
    }

    #[test]
    fn a_header_stays_where_the_first_rows_say_that_there_is_no_value() {
        for absent in ["n/a", "NULL", "-", "#N/A", "no data"] {
            let head = of(&format!(
                "t_s,q_set,q_act\n0.00,{absent},{absent}\n0.02,{absent},1\n0.04,1,2\n0.06,1,2\n"
            ));
            assert_eq!((head.names[0].as_str(), head.first_line), ("t_s", 2), "{absent}");
        }
    }

    #[test]
    fn a_first_row_of_one_word_below_all_names_is_no_header() {
        let head = of("Time [s],q_set,q_act\n0.00,Pt Created,Pt Created\n0.05,20,19.9\n0.10,20,20\n");
        assert_eq!((head.names[1].as_str(), head.first_line), ("q_set", 2));
    }

    #[test]
    fn numbers_that_somebody_wrote_beside_the_names_do_not_cost_the_header() {
        let head =
            of("Time (ms),Set (deg),Act (deg),25.4,765.1\n0,0,0,,\n12,5,0.1,,\n24,6,0.2,,\n36,7,0.3,,\n");
        assert_eq!(head.names[..3], ["Time (ms)", "Set (deg)", "Act (deg)"]);
        assert_eq!((head.line, head.first_line), (1, 2));
        // Rows that name what they tell have their words in every row.
        let long = of("joint,time,kind,value,n\nboom,0.0,set,1,1\nboom,0.1,act,2,2\nboom,0.2,set,2,3\n");
        assert_eq!((long.names[0].as_str(), long.first_line), ("joint", 2));
    }

    #[test]
    fn a_header_may_be_a_comment_or_missing() {
        let head = of("# t q1 q2\n0 1 2\n1 1 2\n");
        assert_eq!((head.names.as_slice(), head.named), (&["t".into(), "q1".into(), "q2".into()][..], true));
        let head = of("# by us\n# Columns: t q1 q2\n#\n0\t1\t2\n1\t1\t2\n");
        assert_eq!((head.names.as_slice(), head.line), (&["t".into(), "q1".into(), "q2".into()][..], 2));
        let head = of("0 1 2\n1 1 2\n");
        assert_eq!((head.names[2].as_str(), head.named), ("column_3", false));
    }
}
