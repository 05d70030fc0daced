//! Tables of several machines: rows of one of them.

use std::{
    borrow::Cow,
    collections::BTreeMap,
    fmt::{self, Display, Formatter},
};

use ::csv::ByteRecord;

use super::{
    CsvError, CsvOptions,
    column::find,
    dialect::Dialect,
    head::looked_at,
    rows::{Rows, cell_text, rewritten},
};

/// Headers of columns that say of which machine a row is.
const MACHINES: [&str; 24] = [
    "machine", "machine_id", "machineid", "machine_name", "maschine", "maschine_id", "robot", "robot_id",
    "robot_name", "vehicle", "vehicle_id", "asset", "asset_id", "device", "device_id", "deviceid",
    "equipment", "equipment_id", "excavator", "crane", "serial", "serial_number", "serial_no", "hostname",
];

/// More of them than these are not listed.
const LISTED: usize = 8;

/// Says that all rows are meant.
const ALL: &str = "*";

/// Rows with a value in a column.
#[derive(Debug, Clone)]
pub(super) struct Only {
    column: usize,
    value: String,
}

impl Display for Only {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&self.value)
    }
}

impl Only {
    /// The rows that the caller names, or of the first machine where a column tells of which one a row is; `None` for
    /// all rows.
    pub(super) fn of(file: &str, text: &[u8], options: &CsvOptions) -> Result<Option<Self>, CsvError> {
        Ok(Table::of(file, text, options)?.and_then(|table| {
            let named = options.only.as_ref().map(|(_, value)| value.clone());
            let value = named.or_else(|| table.counts.into_keys().next())?;
            Some(Self { column: table.column, value })
        }))
    }

    pub(super) fn holds(&self, row: &ByteRecord) -> bool {
        row.get(self.column).map(cell_text).as_ref() == Some(&self.value)
    }
}

/// The rows of the machine that the caller names; an error if the table is of several and none is named.
pub(super) fn of_one<'a>(
    file: &str,
    text: Cow<'a, [u8]>,
    options: &CsvOptions,
) -> Result<Cow<'a, [u8]>, CsvError> {
    let Some(table) = Table::of(file, &text, options)? else { return Ok(text) };
    let known = || table.counts.keys().take(LISTED).cloned().collect::<Vec<_>>().join(", ");
    let column = || table.header.clone();
    match &options.only {
        None if table.counts.len() < 2 => Ok(text),
        None => {
            let first = table.counts.keys().next().cloned().unwrap_or_default();
            Err(CsvError::Machines { column: column(), known: known(), first })
        }
        Some((_, value)) if !table.counts.contains_key(value) => {
            Err(CsvError::NoMachine { column: column(), value: value.clone(), known: known() })
        }
        Some((_, value)) => Ok(table.rows_with(&text, value).map_or(text, Cow::Owned)),
    }
}

/// A table with a column that tells rows apart.
struct Table {
    dialect: Dialect,
    first_line: u64,
    column: usize,
    header: String,
    /// The values of that column, with their rows.
    counts: BTreeMap<String, u64>,
}

impl Table {
    fn of(file: &str, text: &[u8], options: &CsvOptions) -> Result<Option<Self>, CsvError> {
        let Some((dialect, head)) = looked_at(file, text, options) else { return Ok(None) };
        let is_machine =
            |name: &String| MACHINES.contains(&name.trim().to_lowercase().replace([' ', '-'], "_").as_str());
        let column = match &options.only {
            Some((column, value)) => Some(find(column, "--only", &head.names)?).filter(|_| value != ALL),
            None => head.names.iter().position(is_machine),
        };
        let Some(column) = column else { return Ok(None) };
        let mut counts = BTreeMap::new();
        let mut rows = Rows::new(text, dialect.separator);
        let mut record = ByteRecord::new();
        while let Some(line) = rows.next(&mut record) {
            let cell = record.get(column).map(cell_text).filter(|cell| !cell.is_empty());
            if let Some(cell) = cell.filter(|_| line >= head.first_line && record.len() == dialect.width) {
                *counts.entry(cell).or_default() += 1;
            }
        }
        let header = head.names[column].clone();
        Ok(Some(Self { dialect, first_line: head.first_line, column, header, counts }))
    }

    /// The table with all rows above the first of numbers, and of those the ones with a value in the column.
    fn rows_with(&self, text: &[u8], value: &str) -> Option<Vec<u8>> {
        let only = Only { column: self.column, value: value.to_owned() };
        rewritten(text, self.dialect.separator, |line, record, kept| {
            let keeps = line < self.first_line || only.holds(record);
            if keeps { kept.write_byte_record(record) } else { Ok(()) }
        })
    }
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
        assert_eq!(of(two, Some(("machine", "*"))).unwrap(), two);
        let one = "t,machine,q\n0,EX1,1\n1,EX1,3\n";
        assert_eq!(of(one, None).unwrap(), one);
        let none = "t,phase,q\n0,lift,1\n1,place,3\n";
        assert_eq!(of(none, None).unwrap(), none);
    }
}
