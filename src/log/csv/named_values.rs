//! Lines of names and values, `boom_set:1.5 boom_act:1.4`, as micro-controllers print them for a plotter.

use super::{Separator, number::number, rows::writer};

/// The first lines that are looked at, and the share of them that has to be of one form.
const LOOKED_AT: usize = 50;
const ALIKE: f64 = 0.9;

/// The text of a table, if the lines of a text are names and values; lines of other names are left out.
pub(super) fn as_table(text: &[u8]) -> Option<Vec<u8>> {
    let text = std::str::from_utf8(text).ok()?;
    let lines = || text.lines().map(str::trim).filter(|line| !line.is_empty());
    let pairs: Vec<Pairs<'_>> = lines().take(LOOKED_AT).map(pairs).collect();
    let first = pairs.iter().find(|pairs| pairs.values.len() >= 2)?;
    let alike = pairs.iter().filter(|pairs| pairs.is_like(first)).count();
    if alike < 2 || (alike as f64) < ALIKE * pairs.len() as f64 {
        return None;
    }
    let mut out = writer(Separator::Byte(b'\t'));
    let time = first.before.map(|_| "time");
    out.write_record(time.into_iter().chain(first.values.iter().map(|value| value.0))).ok()?;
    for row in lines().map(self::pairs).filter(|pairs| pairs.is_like(first)) {
        out.write_record(row.before.into_iter().chain(row.values.iter().map(|value| value.1))).ok()?;
    }
    out.into_inner().ok()
}

/// Whether the first lines of a text are names and values, the last of which may be cut.
pub(in crate::log) fn is_named_values(text: &str) -> bool {
    let whole = text.rfind('\n').map_or(text, |end| &text[..end]);
    as_table(whole.as_bytes()).is_some()
}

/// A line: the instant that a terminal puts before it, `12:00:01.250 -> `, and names with their values.
#[derive(Debug, Default)]
struct Pairs<'a> {
    before: Option<&'a str>,
    values: Vec<(&'a str, &'a str)>,
}

impl Pairs<'_> {
    fn is_like(&self, other: &Self) -> bool {
        let names = |pairs: &Self| pairs.values.iter().map(|value| value.0.to_owned()).collect::<Vec<_>>();
        self.before.is_some() == other.before.is_some() && names(self) == names(other)
    }
}

/// None where a part of the line is no name with a number.
fn pairs(line: &str) -> Pairs<'_> {
    let (before, mut rest) =
        line.split_once("->").map_or((None, line), |(before, rest)| (Some(before.trim()), rest));
    let separates = |c: char| c.is_whitespace() || c == ',' || c == ';';
    let mut values = Vec::new();
    loop {
        rest = rest.trim_start_matches(separates);
        if rest.is_empty() {
            return Pairs { before, values };
        }
        let Some(at) = rest.find([':', '=']).filter(|_| rest.starts_with(char::is_alphabetic)) else {
            return Pairs::default();
        };
        let (name, value) = (rest[..at].trim_end(), rest[at + 1..].trim_start());
        let end = value.find(separates).unwrap_or(value.len());
        if name.contains(separates) || number(&value.as_bytes()[..end], false).is_none() {
            return Pairs::default();
        }
        values.push((name, &value[..end]));
        rest = &value[end..];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Option<String> {
        as_table(text.as_bytes()).map(|text| String::from_utf8(text).unwrap())
    }

    #[test]
    fn lines_of_names_and_values_are_a_table_and_other_lines_are_none() {
        let expected = "set\tact\n1.5\t1\n2\t-1e-3\n";
        for text in [
            "set:1.5 act:1\nset:2 act:-1e-3\n",
            "set=1.5, act=1\nset=2, act=-1e-3",
            "set: 1.5\tact: 1\r\nset: 2\tact: -1e-3\r\n",
            "set:1.5,act:1,\nset:2,act:-1e-3,\n",
        ] {
            assert_eq!(of(text).as_deref(), Some(expected), "{text}");
        }
        let terminal = of("12:00:01.250 -> set:1 act:2\n12:00:01.300 -> set:1 act:3\n").unwrap();
        assert!(terminal.starts_with("time\tset\tact\n12:00:01.250\t1\t2\n"), "{terminal}");
        for other in [
            "t,a:b\n1,2\n2,3\n", "a: 1\nb: 2\n", "set:1 act:x\nset:2 act:y\n", "12:00:01 1\n12:00:02 2\n", "",
        ] {
            assert_eq!(of(other), None, "{other}");
        }
    }
}
