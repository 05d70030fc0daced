//! Numbered columns of names beside those of their values become a cell a row for each, with the list in it: `field.name0` and
//! `field.name1` beside `field.position0` and `field.position1`, or `joints[0].name` beside `joints[0].angle_deg`.

use std::borrow::Cow;

use super::{
    Separator,
    lists::listed,
    members::LISTS,
    number::{Looks, looks},
    rows::{Rows, cell_text, rewritten},
};
use ::csv::ByteRecord;

/// Rows that tell which columns hold names.
const LOOKED_AT: usize = 50;

/// Columns of one list, in the order of their numbers.
struct Numbered<'a> {
    /// The header without the number.
    stem: Cow<'a, str>,
    columns: Vec<usize>,
}

/// The table with those lists; `None` where no numbered columns are names of joints.
pub(super) fn gathered(text: &[u8]) -> Option<Vec<u8>> {
    b",;\t".iter().find_map(|separator| of_separator(text, Separator::Byte(*separator)))
}

fn of_separator(text: &[u8], separator: Separator) -> Option<Vec<u8>> {
    let (mut rows, mut record) = (Rows::new(text, separator), ByteRecord::new());
    let first = rows.next(&mut record)?;
    let header: Vec<String> = record.iter().map(cell_text).collect();
    let all = numbered(&header);
    let called = |one: &Numbered<'_>| one.stem.rsplit(['.', '/']).next().unwrap_or_default().to_lowercase();
    let mut named = all.iter().filter(|one| LISTS.contains(&called(one).as_str()));
    let (Some(names), None) = (named.next(), named.next()) else { return None };
    let is_name = |cell: &[u8]| matches!(looks(cell), Looks::Text | Looks::Empty);
    let mut seen = 0;
    while seen < LOOKED_AT && rows.next(&mut record).is_some() {
        if names.columns.iter().any(|at| !record.get(*at).is_some_and(is_name)) {
            return None;
        }
        seen += 1;
    }
    let path = &names.stem[..names.stem.len() - called(names).len()];
    let beside = |one: &&Numbered<'_>| {
        one.columns.len() == names.columns.len() && one.stem.len() > path.len() && one.stem.starts_with(path)
    };
    let lists: Vec<&Numbered<'_>> = all.iter().filter(beside).collect();
    if seen == 0 || lists.len() < 2 {
        return None;
    }
    rewritten(text, separator, |line, record, out| {
        for (at, cell) in record.iter().enumerate() {
            match lists.iter().find(|list| list.columns.contains(&at)) {
                None => out.write_field(cell)?,
                Some(list) if list.columns[0] != at => {}
                Some(list) if line == first => out.write_field(&list.stem[path.len()..])?,
                Some(list) => {
                    let items =
                        list.columns.iter().map(|at| record.get(*at).map_or_else(String::new, cell_text));
                    out.write_field(listed(&items.collect::<Vec<_>>()))?;
                }
            }
        }
        out.write_record(None::<&[u8]>)
    })
}

/// Columns whose headers differ by a number, which goes on by one.
fn numbered(header: &[String]) -> Vec<Numbered<'_>> {
    let mut all: Vec<(Numbered<'_>, u32)> = Vec::new();
    for (at, name) in header.iter().enumerate() {
        let Some((stem, number)) = parted(name) else { continue };
        match all.iter_mut().find(|(one, _)| one.stem == stem) {
            Some((one, next)) if *next == number => {
                one.columns.push(at);
                *next += 1;
            }
            Some(_) => {}
            None => all.push((Numbered { stem, columns: vec![at] }, number.saturating_add(1))),
        }
    }
    all.into_iter().map(|(one, _)| one).collect()
}

/// A header without its number, and the number: at its end, or in brackets.
fn parted(header: &str) -> Option<(Cow<'_, str>, u32)> {
    let in_brackets = || {
        let (before, rest) = header.rsplit_once('[')?;
        let (number, behind) = rest.split_once(']')?;
        let stem =
            if behind.is_empty() { Cow::Borrowed(before) } else { Cow::Owned([before, behind].concat()) };
        Some((stem, number.parse().ok()?))
    };
    let at_end = || {
        let stem = header.trim_end_matches(|c: char| c.is_ascii_digit());
        let number = header[stem.len()..].parse().ok()?;
        Some((Cow::Borrowed(stem.trim_end_matches(['_', '.', '/', ' '])), number))
    };
    in_brackets().or_else(at_end).filter(|(stem, _)| !stem.is_empty())
}

#[cfg(test)]
mod tests {
    use super::{super::lists::widened, *};

    #[test]
    fn numbered_names_are_those_of_the_numbered_values_beside_them() {
        let of = |text: &str| {
            let table = widened(&gathered(text.as_bytes())?)?;
            Some(String::from_utf8(table).unwrap())
        };
        let rows = "0,boom,left stick,1,2\n1,left stick,boom,4,3\n2,boom,left stick,,5\n";
        for (header, [position, named]) in [
            ("t,field.name0,field.name1,field.position0,field.position1", ["position", "name"]),
            ("t,name[0],name[1],position[0],position[1]", ["position", "name"]),
            ("t,joints[0].name,joints[1].name,joints[0].set_deg,joints[1].set_deg", ["set_deg", "name"]),
        ] {
            let table = of(&format!("{header}\n{rows}")).unwrap();
            let mut lines = table.lines();
            assert_eq!(lines.next().unwrap(), format!("t,{named},boom.{position},left stick.{position}"));
            let cells: Vec<&str> =
                lines.map(|line| line.rsplit_once("]\"").or(line.rsplit_once(']')).unwrap().1).collect();
            assert_eq!(cells, [",1,2", ",3,4", ",,5"], "{header}");
        }
        for text in ["t,joint1,joint2,q1,q2\n0,1,2,3,4\n", "t,q1,q2\n0,1,2\n", "t,name0,name1\n0,a,b\n", ""] {
            assert_eq!(gathered(text.as_bytes()), None, "{text}");
        }
    }
}
