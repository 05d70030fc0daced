//! Cells that hold a list each, as programs in Python write what messages of ROS hold: `"(0.17, -0.69)"`, `[ 0.17 -0.69]`.

use std::collections::BTreeSet;

use ::csv::ByteRecord;

use super::{
    Separator,
    rows::{Rows, cell_text, writer},
};

/// So many rows tell which columns hold lists.
const LOOKED_AT: usize = 50;
/// More numbers than this in a cell are no joints.
const MOST: usize = 64;

const QUOTES: [char; 2] = ['\'', '"'];

/// What the cells of a column hold.
enum Holds {
    Cell,
    /// Numbers, of columns with these names.
    List(Vec<String>),
    /// Numbers of the joints that another column of the row names.
    OfJoints,
}

/// The table with a column for each number of a list; the names of joints in a list of names are theirs, row by row.
pub(super) fn widened(text: &[u8]) -> Option<Vec<u8>> {
    let separator = [b',', b';', b'\t'].into_iter().find(|byte| holds_lists(text, *byte))?;
    let mut rows = Rows::new(text, Separator::Byte(separator));
    let mut record = ByteRecord::new();
    rows.next(&mut record)?;
    let header: Vec<String> = record.iter().map(cell_text).collect();
    let sample: Vec<Vec<String>> = sample(text, separator);
    let (columns, naming) = columns(&header, &sample);
    let joints = naming.map_or_else(Vec::new, |naming| joints(text, separator, naming));
    let mut out = writer(Separator::Byte(separator));
    let names = header.iter().zip(&columns).flat_map(|(name, holds)| match holds {
        Holds::Cell => vec![name.clone()],
        Holds::List(names) => names.clone(),
        Holds::OfJoints => joints.iter().map(|joint| format!("{joint}.{name}")).collect(),
    });
    out.write_record(names).ok()?;
    let mut named: Vec<String> = Vec::new();
    while rows.next(&mut record).is_some() {
        let own = naming.and_then(|at| items(&cell_text(record.get(at)?))).filter(|own| !own.is_empty());
        // Where a row names none, those of the row before are meant.
        named = own.unwrap_or(named);
        for (at, cell) in record.iter().enumerate() {
            let fields: Vec<Option<usize>> = match columns.get(at) {
                Some(Holds::List(names)) => (0..names.len()).map(Some).collect(),
                Some(Holds::OfJoints) => {
                    joints.iter().map(|joint| named.iter().position(|name| name == joint)).collect()
                }
                _ => {
                    out.write_field(cell).ok()?;
                    continue;
                }
            };
            let count =
                if let Some(Holds::List(names)) = columns.get(at) { names.len() } else { named.len() };
            let numbers = items(&cell_text(cell)).filter(|items| items.len() == count).unwrap_or_default();
            for field in fields {
                let number = field.and_then(|field| numbers.get(field));
                out.write_field(number.map_or("", String::as_str)).ok()?;
            }
        }
        out.write_record(None::<&[u8]>).ok()?;
    }
    out.into_inner().ok()
}

/// The names that a column lists in any row.
fn joints(text: &[u8], separator: u8, naming: usize) -> Vec<String> {
    let (mut rows, mut record) = (Rows::new(text, Separator::Byte(separator)), ByteRecord::new());
    let mut joints: Vec<String> = Vec::new();
    rows.next(&mut record);
    while joints.len() < MOST && rows.next(&mut record).is_some() {
        for name in record.get(naming).and_then(|cell| items(&cell_text(cell))).unwrap_or_default() {
            if !joints.contains(&name) {
                joints.push(name);
            }
        }
    }
    joints
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

/// What the columns hold, and which of them names the joints.
fn columns(header: &[String], sample: &[Vec<String>]) -> (Vec<Holds>, Option<usize>) {
    let list = |at: usize| move |row: &Vec<String>| items(row.get(at)?).filter(|list| !list.is_empty());
    let are_names =
        |list: &Vec<String>| list.iter().collect::<BTreeSet<_>>().len() == list.len() && !are_numbers(list);
    let naming =
        (0..header.len()).find(|at| sample.iter().find_map(list(*at)).is_some_and(|list| are_names(&list)));
    let of = |(at, name): (usize, &String)| {
        let numbers =
            |row: &&Vec<String>| list(at)(row).is_some_and(|list| are_numbers(&list) && list.len() <= MOST);
        let Some(row) = sample.iter().find(numbers) else { return Holds::Cell };
        let count = list(at)(row).map_or(0, |list| list.len());
        let named = naming.and_then(|naming| list(naming)(row)).map_or(0, |names| names.len());
        if named == count {
            Holds::OfJoints
        } else {
            Holds::List((0..count).map(|k| format!("{name}[{k}]")).collect())
        }
    };
    (header.iter().enumerate().map(of).collect(), naming)
}

/// The items of a list in brackets, without their quotes; `None` of a cell that is no list.
fn items(cell: &str) -> Option<Vec<String>> {
    let inner = [('(', ')'), ('[', ']')]
        .into_iter()
        .find_map(|(open, close)| cell.trim().strip_prefix(open)?.strip_suffix(close))?;
    let between = |c: char| c == ',' || c.is_whitespace();
    let mut items = Vec::new();
    let mut rest = inner.trim_start_matches(between);
    while let Some(first) = rest.chars().next() {
        let quoted =
            rest.get(1..).filter(|_| QUOTES.contains(&first)).and_then(|rest| rest.split_once(first));
        let (item, behind) =
            quoted.unwrap_or_else(|| rest.split_at(rest.find(between).unwrap_or(rest.len())));
        items.push(item.to_owned());
        rest = behind.trim_start_matches(between);
    }
    Some(items)
}

/// A cell with items that [`widened`] reads.
pub(super) fn listed(items: &[String]) -> String {
    let quote = |item: &String| QUOTES.into_iter().find(|quote| !item.contains(*quote)).unwrap_or('"');
    let quoted = |item: &String| format!("{0}{item}{0}", quote(item));
    format!("[{}]", items.iter().map(quoted).collect::<Vec<_>>().join(" "))
}

/// Whether items are numbers, or some of them empty.
fn are_numbers(items: &[String]) -> bool {
    items.iter().any(|item| !item.is_empty())
        && items.iter().all(|item| item.is_empty() || item.parse::<f64>().is_ok())
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
    fn names_are_those_of_their_row_whatever_their_order_and_number() {
        let text = "t;name;q\n0;['a', 'b'];(1, 2)\n1;['b', 'a'];(4, 3)\n2;[c, a];(6, 5)\n3;[];(8, 7)\n";
        let expected = "t;name;a.q;b.q;c.q\n0;['a', 'b'];1;2;\n1;['b', 'a'];3;4;\n2;[c, a];5;;6\n3;[];7;;8\n";
        assert_eq!(of(text), expected);
    }

    #[test]
    fn brackets_in_a_header_or_around_one_word_are_no_lists() {
        for text in ["t,q [deg],q_set (deg)\n0,1,2\n", "t,q\n0,(invalid)\n", "t\n[1 2]\n", ""] {
            assert_eq!(of(text), text);
        }
    }
}
