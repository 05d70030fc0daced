//! Tables of several machines: rows of one of them.

use std::{borrow::Cow, collections::BTreeMap};

use ::csv::{ByteRecord, WriterBuilder};

use super::{
    CsvError, CsvOptions, Separator,
    column::find,
    dialect::{Dialect, detect},
    head::read_head,
    rows::{Rows, cell_text},
};
use crate::remark::Remarks;

/// Headers of columns that say of which machine a row is.
const MACHINES: [&str; 24] = [
    "machine",
    "machine_id",
    "machineid",
    "machine_name",
    "maschine",
    "maschine_id",
    "robot",
    "robot_id",
    "robot_name",
    "vehicle",
    "vehicle_id",
    "asset",
    "asset_id",
    "device",
    "device_id",
    "deviceid",
    "equipment",
    "equipment_id",
    "excavator",
    "crane",
    "serial",
    "serial_number",
    "serial_no",
    "hostname",
];

/// More of them than these are not listed.
const LISTED: usize = 8;

/// The rows of the machine that the caller names; an error if the table is of several and none is named.
pub(super) fn of_one<'a>(
    file: &str,
    text: Cow<'a, [u8]>,
    options: &CsvOptions,
) -> Result<Cow<'a, [u8]>, CsvError> {
    let Ok(dialect) = detect(file, &text, options) else { return Ok(text) };
    let head = read_head(&text, dialect, &mut Remarks::default());
    let is_machine =
        |name: &String| MACHINES.contains(&name.trim().to_lowercase().replace([' ', '-'], "_").as_str());
    let column = match &options.only {
        Some((column, _)) => Some(find(column, "--only", &head.names)?),
        None => head.names.iter().position(is_machine),
    };
    let Some(column) = column else { return Ok(text) };
    let counts = counted(&text, dialect, head.first_line, column);
    let known = || counts.keys().take(LISTED).cloned().collect::<Vec<_>>().join(", ");
    let (header, known) = (head.names[column].clone(), known());
    match &options.only {
        None if counts.len() < 2 => Ok(text),
        None => {
            let first = counts.into_keys().next().unwrap_or_default();
            Err(CsvError::Machines { column: header, known, first })
        }
        Some((_, value)) if !counts.contains_key(value) => {
            Err(CsvError::NoMachine { column: header, value: value.clone(), known })
        }
        Some((_, value)) => {
            Ok(rows_of(&text, dialect, head.first_line, (column, value)).map_or(text, Cow::Owned))
        }
    }
}

/// The values of a column, with their rows.
fn counted(text: &[u8], dialect: Dialect, first_line: u64, column: usize) -> BTreeMap<String, u64> {
    let mut counts = BTreeMap::new();
    let mut rows = Rows::new(text, dialect.separator);
    let mut record = ByteRecord::new();
    while let Some(line) = rows.next(&mut record) {
        let cell = record.get(column).map(cell_text).filter(|cell| !cell.is_empty());
        if let Some(cell) = cell.filter(|_| line >= first_line && record.len() == dialect.width) {
            *counts.entry(cell).or_default() += 1;
        }
    }
    counts
}

/// The table with all rows above the first of numbers, and of those the ones with a value in a column.
fn rows_of(
    text: &[u8],
    dialect: Dialect,
    first_line: u64,
    (column, value): (usize, &String),
) -> Option<Vec<u8>> {
    let separator = match dialect.separator {
        Separator::Byte(byte) => byte,
        Separator::Space => b'\t',
    };
    let mut kept = WriterBuilder::new().delimiter(separator).flexible(true).from_writer(Vec::new());
    let mut rows = Rows::new(text, dialect.separator);
    let mut record = ByteRecord::new();
    while let Some(line) = rows.next(&mut record) {
        if line < first_line || record.get(column).map(cell_text).as_ref() == Some(value) {
            kept.write_byte_record(&record).ok()?;
        }
    }
    kept.into_inner().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str, only: Option<(&str, &str)>) -> Result<String, String> {
        let only = only.map(|(column, value)| (column.to_owned(), value.to_owned()));
        let options = CsvOptions { only, ..CsvOptions::default() };
        let text =
            of_one("a.csv", Cow::Borrowed(text.as_bytes()), &options).map_err(|error| error.to_string())?;
        Ok(String::from_utf8(text.into_owned()).unwrap())
    }

    #[test]
    fn a_table_of_two_machines_is_of_one_that_is_named() {
        let two = "t,Machine,q\n0,EX1,1\n0,EX2,2\n1,EX1,3\n1,EX2,4\n";
        let said = of(two, None).unwrap_err();
        assert!(said.contains("EX1, EX2") && said.contains("--only 'Machine=EX1'"), "{said}");
        assert_eq!(of(two, Some(("machine", "EX2"))).unwrap(), "t,Machine,q\n0,EX2,2\n1,EX2,4\n");
        assert!(of(two, Some(("machine", "EX3"))).unwrap_err().contains("EX1, EX2"));
        let one = "t,machine,q\n0,EX1,1\n1,EX1,3\n";
        assert_eq!(of(one, None).unwrap(), one);
        let none = "t,phase,q\n0,lift,1\n1,place,3\n";
        assert_eq!(of(none, None).unwrap(), none);
    }
}
