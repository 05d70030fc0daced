//! Cells that hold a list each, as programs in Python write what messages of ROS hold: `"(0.17, -0.69)"`, `[ 0.17 -0.69]`.

use ::csv::ByteRecord;

use super::{
    Separator,
    rows::{Rows, cell_text, writer},
};

/// So many rows tell which columns hold lists.
const LOOKED_AT: usize = 50;
/// More numbers than this in a cell are no joints.
const MOST: usize = 64;

/// What the cells of a column hold.
enum Holds {
    Cell,
    /// Numbers, of columns with these names.
    List(Vec<String>),
}

/// The table with a column for each number of a list; the names of joints in a list of names are theirs.
pub(super) fn widened(text: &[u8]) -> Option<Vec<u8>> {
    let separator = [b',', b';', b'\t'].into_iter().find(|byte| holds_lists(text, *byte))?;
    let mut rows = Rows::new(text, Separator::Byte(separator));
    let mut record = ByteRecord::new();
    rows.next(&mut record)?;
    let header: Vec<String> = record.iter().map(cell_text).collect();
    let sample: Vec<Vec<String>> = sample(text, separator);
    let columns = columns(&header, &sample);
    let mut out = writer(Separator::Byte(separator));
    let names = header.iter().zip(&columns).flat_map(|(name, holds)| match holds {
        Holds::Cell => vec![name.clone()],
        Holds::List(names) => names.clone(),
    });
    out.write_record(names).ok()?;
    while rows.next(&mut record).is_some() {
        for (at, cell) in record.iter().enumerate() {
            match columns.get(at) {
                Some(Holds::List(names)) => {
                    let numbers = items(&cell_text(cell)).filter(|items| items.len() == names.len());
                    for k in 0..names.len() {
                        out.write_field(numbers.as_ref().map_or("", |numbers| &numbers[k])).ok()?;
                    }
                }
                _ => out.write_field(cell).ok()?,
            }
        }
        out.write_record(None::<&[u8]>).ok()?;
    }
    out.into_inner().ok()
}

/// Whether a cell of the first rows below the header is a list of numbers.
fn holds_lists(text: &[u8], separator: u8) -> bool {
    let start = &text[..text.len().min(1 << 16)];
    if memchr::memchr2(b'[', b'(', start).is_none() {
        return false;
    }
    let mut rows = Rows::new(start, Separator::Byte(separator));
    let mut record = ByteRecord::new();
    let width = rows.next(&mut record).map_or(0, |_| record.len());
    rows.next(&mut record).is_some()
        && record.len() == width
        && width > 1
        && record.iter().any(|cell| items(&cell_text(cell)).is_some_and(|items| are_numbers(&items)))
}

fn sample(text: &[u8], separator: u8) -> Vec<Vec<String>> {
    let mut rows = Rows::new(text, Separator::Byte(separator));
    let mut record = ByteRecord::new();
    let mut sample = Vec::new();
    rows.next(&mut record);
    while sample.len() < LOOKED_AT && rows.next(&mut record).is_some() {
        sample.push(record.iter().map(cell_text).collect());
    }
    sample
}

fn columns(header: &[String], sample: &[Vec<String>]) -> Vec<Holds> {
    let lists =
        |at: usize| sample.iter().filter_map(move |row| items(row.get(at)?)).filter(|list| !list.is_empty());
    let named = (0..header.len()).find_map(|at| lists(at).find(|list| !are_numbers(list)));
    let of = |(at, name): (usize, &String)| {
        let Some(first) = lists(at).find(|list| are_numbers(list)).filter(|list| list.len() <= MOST) else {
            return Holds::Cell;
        };
        let names = named.as_ref().filter(|names| names.len() == first.len());
        Holds::List(match names {
            Some(names) => names.iter().map(|joint| format!("{joint}.{name}")).collect(),
            None => (0..first.len()).map(|k| format!("{name}[{k}]")).collect(),
        })
    };
    header.iter().enumerate().map(of).collect()
}

/// The items of a list in brackets, without their quotes; `None` of a cell that is no list.
fn items(cell: &str) -> Option<Vec<String>> {
    let inner = [('(', ')'), ('[', ']')]
        .into_iter()
        .find_map(|(open, close)| cell.trim().strip_prefix(open)?.strip_suffix(close))?;
    let between = |c: char| c == ',' || c.is_whitespace();
    let bare = |item: &str| item.trim_matches(['\'', '"']).to_owned();
    Some(inner.split(between).filter(|item| !item.is_empty()).map(bare).collect())
}

fn are_numbers(items: &[String]) -> bool {
    !items.is_empty() && items.iter().all(|item| item.parse::<f64>().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> String {
        widened(text.as_bytes()).map_or(text.to_owned(), |wide| String::from_utf8(wide).unwrap())
    }

    #[test]
    fn a_list_becomes_a_column_for_each_number_named_by_a_list_of_names() {
        let text = "Time,name,position,effort\n1.5,\"['elbow', 'wrist']\",\"(0.1, -2e-05)\",()\n\
                    1.6,\"['elbow', 'wrist']\",\"(0.2,)\",()\n";
        assert_eq!(
            of(text),
            "Time,name,elbow.position,wrist.position,effort\n1.5,\"['elbow', 'wrist']\",0.1,-2e-05,()\n\
             1.6,\"['elbow', 'wrist']\",,,()\n"
        );
        assert_eq!(of("t;q\n0;\"[ 0.1\n -0.7]\"\n"), "t;q[0];q[1]\n0;0.1;-0.7\n");
    }

    #[test]
    fn brackets_in_a_header_or_around_one_word_are_no_lists() {
        for text in ["t,q [deg],q_set (deg)\n0,1,2\n", "t,q\n0,(invalid)\n", "t\n[1 2]\n", ""] {
            assert_eq!(of(text), text);
        }
    }
}
