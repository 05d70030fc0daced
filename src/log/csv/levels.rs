//! Headers of several rows: joint over signal, as data frames and sheets with merged cells have them.

use std::collections::BTreeSet;

use super::{
    CsvOptions,
    dialect::detect,
    label::label,
    number::{Looks, looks},
    rows::{Rows, cell_text, writer},
    scale::unit_named,
    typed::names_type,
};

/// Rows that a header may have.
const MOST: usize = 3;

/// The same table with one header: to each column's own name those above it; `None` unless that makes all names differ
/// that were alike.
pub(super) fn joined(file: &str, text: &[u8], options: &CsvOptions) -> Option<Vec<u8>> {
    let dialect = detect(file, text, options).ok()?;
    let mut rows = Rows::new(text, dialect.separator);
    let mut record = ::csv::ByteRecord::new();
    let mut levels: Vec<(u64, Vec<String>)> = Vec::new();
    // The rows above a first row of numbers that has a word, too.
    let mut noted = None;
    let first_line = loop {
        let line = rows.next(&mut record)?;
        let cells: Vec<String> = record.iter().map(cell_text).collect();
        let words = cells.iter().filter(|cell| looks(cell.as_bytes()) == Looks::Text).count();
        let empty = cells.iter().filter(|cell| cell.is_empty()).count();
        if cells.len() != dialect.width || words > 0 && words + empty < cells.len() {
            let note = words == 1 && words + empty + 1 < cells.len();
            noted = note.then(|| (line, std::mem::take(&mut levels)));
            levels.clear();
        } else if words > 0 {
            levels.push((line, cells));
            noted = None;
        } else {
            let (first, above) = noted.filter(|_| levels.is_empty()).unwrap_or((line, levels));
            levels = above;
            break first;
        }
    };
    let levels = &levels[levels.len().saturating_sub(MOST)..];
    let top = levels.first()?.0;
    let names = names(levels.iter().map(|(_, cells)| cells.as_slice()).collect::<Vec<_>>().as_slice())?;
    let mut header = writer(dialect.separator);
    header.write_record(&names).ok()?;
    // The lines keep their numbers.
    let mut start = 0;
    let mut ends = memchr::memchr_iter(b'\n', text).map(|at| at + 1);
    let above = usize::try_from(top - 1).ok()?;
    for _ in 0..above {
        start = ends.next()?;
    }
    let mut below = start;
    for _ in top..first_line {
        below = ends.next()?;
    }
    let blank = b"\n".repeat(usize::try_from(first_line - top).ok()?.checked_sub(1)?);
    Some([&text[..start], &blank, &header.into_inner().ok()?, &text[below..]].concat())
}

/// One name a column; `None` if the lowest row with names of signals has none that are alike and names the index, too, or
/// if all together leave some alike.
fn names(levels: &[&[String]]) -> Option<Vec<String>> {
    // The lowest row may name the index alone.
    let filled = |row: &[String]| row.iter().filter(|cell| !cell.is_empty()).count();
    let (index, levels) = match levels.split_last() {
        Some((last, rest)) if filled(last) == 1 && !last[0].is_empty() => (Some(&last[0]), rest),
        _ => (None, levels),
    };
    let (lowest, upper) = levels.split_last()?;
    let differ = |names: &[String]| {
        let named: Vec<&String> = names.iter().filter(|name| !name.is_empty()).collect();
        named.iter().collect::<BTreeSet<_>>().len() == named.len()
    };
    if index.is_none()
        && let Some(described) = described(levels, differ)
    {
        return Some(described);
    }
    let is_plain = index.is_none() && (upper.is_empty() || differ(lowest));
    if is_plain || lowest.get(1..).is_none_or(|rest| rest.iter().any(String::is_empty)) {
        return None;
    }
    let mut names: Vec<String> = lowest.to_vec();
    for row in upper.iter().rev() {
        // Of merged cells the first holds the name.
        let mut name = "";
        for (at, (cell, below)) in row.iter().zip(&mut names).enumerate() {
            if !cell.is_empty() {
                name = cell;
            }
            if at > 0 && !name.is_empty() {
                *below = format!("{name} {below}");
            }
        }
    }
    // Above an index stand the names of the levels.
    if let (Some(index), Some(first)) = (index, names.first_mut()) {
        first.clone_from(index);
    }
    differ(&names).then_some(names)
}

/// The names of a row above others that only describe its columns, such as units, with these.
fn described(levels: &[&[String]], differ: impl Fn(&[String]) -> bool) -> Option<Vec<String>> {
    let at = levels.iter().rposition(|row| row.iter().all(|cell| !cell.is_empty()) && differ(row))?;
    let (names, below) = (levels[at], &levels[at + 1..]);
    // Beside one that is known an unknown one is a unit, too.
    let is_unit = |cell: &String| unit_named(cell).is_some();
    let is_row = |row: &&&[String]| row.iter().any(is_unit);
    let units = below.iter().find(is_row).copied().unwrap_or_default();
    let says_other =
        |cell: &String| units[0] != *cell && cell.chars().any(char::is_alphabetic) && !names_type(cell);
    let says = |cell: &&String| is_unit(cell) || says_other(cell);
    let unit = |column: usize| units.get(column).filter(says);
    let with_unit = |(column, name): (usize, &String)| match unit(column) {
        Some(unit) if label(name, None).stated.is_none() => {
            format!("{name} [{}]", unit.trim_matches(['[', ']', '(', ')']))
        }
        _ => name.clone(),
    };
    (!below.is_empty()).then(|| names.iter().enumerate().map(with_unit).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Option<String> {
        let text = joined("a.csv", text.as_bytes(), &CsvOptions::default())?;
        Some(String::from_utf8(text).unwrap())
    }

    #[test]
    fn names_above_names_are_one_name() {
        const ROWS: &str = "0.5,1,2,3,4\n1.5,1,2,3,4\n";
        let header = ",boom set,boom act,arm set,arm act\n";
        let expected = format!("\n{header}{ROWS}");
        let plain = format!(",boom,boom,arm,arm\n,set,act,set,act\n{ROWS}");
        assert_eq!(of(&plain), Some(expected.clone()));
        assert_eq!(of(&plain.replace("boom,boom,arm,arm", "boom,,arm,")), Some(expected.clone()));
        let named = format!("joint,boom,boom,arm,arm\nsignal,set,act,set,act\nt,,,,\n{ROWS}");
        assert_eq!(of(&named), Some(format!("\n\nt{header}{ROWS}")));
        let one = format!(",boom,boom,boom,boom\n,set,act,a,b\nt,,,,\n{ROWS}");
        assert_eq!(of(&one), Some(format!("\n\nt,boom set,boom act,boom a,boom b\n{ROWS}")));
        let units = format!("t,boom set,boom act,c,d_s\n[s],deg,deg,-,s\nraw,raw,raw,raw,raw\n{ROWS}");
        assert_eq!(of(&units), Some(format!("\n\nt [s],boom set [deg],boom act [deg],c,d_s\n{ROWS}")));
        let other = format!("t,boom set,boom act,c,d_s\ns,Volt,Volt,-,s\n{ROWS}");
        assert_eq!(of(&other), Some(format!("\nt [s],boom set [Volt],boom act [Volt],c,d_s\n{ROWS}")));
        let types = other.replace("Volt", "float");
        assert_eq!(of(&types), Some(format!("\nt [s],boom set,boom act,c,d_s\n{ROWS}")));
        let noted = "descriptor,x,a_set,a_act,b\nunit,s,deg,deg,deg\nstart,0,1,2,3\n,1,1,2,3\n";
        let expected = "\ndescriptor,x [s],a_set [deg],a_act [deg],b [deg]\nstart,0,1,2,3\n,1,1,2,3\n";
        assert_eq!(of(noted).as_deref(), Some(expected));
        let below = format!("Log;7\n\nt,boom,boom,arm,arm\n\n,set,act,set,act\n{ROWS}");
        assert!(
            of(&below).is_some_and(|text| text.lines().count() == below.lines().count()),
            "{:?}",
            of(&below)
        );
    }

    #[test]
    fn other_headers_are_left() {
        for header in [
            "t,a,b,c,d", "x,x,x,x,x\nt,a,b,c,d", ",boom,boom,boom,boom\n,set,act,set,act",
            ",a,a,b,b\n,set,,set,",
        ] {
            assert_eq!(of(&format!("{header}\n0.5,1,2,3,4\n1.5,1,2,3,4\n")), None, "{header}");
        }
        assert_eq!(of("a,b,b\nc,d,d\n"), None);
    }
}
