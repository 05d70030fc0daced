//! CSV files of controllers (PLC traces, RTDE recordings, exports): what their columns are, and the log that they become.
//!
//! `dialect` finds separator and mark, `head` names, `label` what they say, `clock` the time, `layout` joints; [`CsvOptions`] say the rest.

mod again;
mod agreed;
mod behind;
mod by_column;
mod by_meaning;
mod by_number;
mod clock;
mod clocks;
mod coarse;
mod column;
mod dataset;
mod date;
mod dated;
mod decimal_mark;
mod dialect;
mod doubled;
mod echoed;
mod efforts;
mod elapsed;
#[cfg(feature = "encodings")]
mod encoding;
mod error;
mod expression;
mod given;
mod grouping;
mod guess;
mod halves;
mod head;
mod judged;
mod keys;
mod label;
mod layout;
mod lenient;
mod letter;
mod levels;
mod lists;
mod live_clock;
mod long;
mod lvm;
mod map;
mod marks;
mod members;
mod name;
mod named_values;
mod negatives;
mod number;
mod numbered;
mod object_number;
mod objects;
mod offered;
mod only;
mod options;
mod order;
mod own;
mod packed;
mod pairing;
mod printed;
mod read;
mod repeats;
mod restarts;
mod row_order;
mod rows;
mod run;
mod scale;
mod scope;
mod settle;
mod si;
mod signals;
mod spread;
mod stamp;
mod started;
mod stream;
mod supply;
#[cfg(test)]
mod tests;
mod text;
mod time;
mod too_fast;
mod trailing;
mod trajectory;
mod typed;
mod understood;
mod unit;
mod unpadded;
mod within;
mod word;

pub use again::{is_aside, is_header, other_header};
pub(in crate::log) use echoed::begins as begins_with_message;
pub use error::CsvError;
pub(in crate::log) use map::MAP_BEGINS;
pub(in crate::log) use named_values::is_named_values;
pub use objects::JsonLines;
pub use options::{AngleUnit, Columns, CsvOptions, LengthUnit, Separator};
pub(in crate::log) use printed::is_rule;
pub use run::CsvRun;
pub(in crate::log) use run::{
    DOUBT_OF_ORIGIN, GIVEN_OF_ORIGIN, GUESSED_OF_ORIGIN, ORIGIN, TIME_OF_ORIGIN, UNDATED_OF_ORIGIN,
    UNIT_OF_ORIGIN, UNUSED_OF_ORIGIN,
};
pub use stream::TableStream;
pub(in crate::log) use text::of_lines;
pub use time::{UNDATED_NS, is_dated};
pub use understood::{ColumnRead, TimeRead, Understood};

use std::borrow::Cow;

use super::write::Role;
use crate::{
    remark::{Code, Remarks},
    series::JointKind,
};
use unit::Measure;

/// The quantity of a joint that a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    /// Its angle.
    Position,
    /// Its speed.
    Velocity,
}

/// Whether a unit by its name is one of angles.
pub(in crate::log) fn is_angle(unit: &str) -> bool {
    unit::parse_unit(unit).is_some_and(|unit| unit.measure == unit::Measure::Angle)
}

/// The joint that a header or the name of a topic speaks of, without the words for plan, measurement and angle.
pub(in crate::log) fn joint_in(name: &str) -> String {
    label::label(name, None).joint
}

/// SI value of one of the unit that ends a name, where positions of such a joint are told in it; else 1.
pub(in crate::log) fn scale_in(name: &str, kind: JointKind) -> f64 {
    let measure = match kind {
        JointKind::Turns => Measure::Angle,
        JointKind::Slides => Measure::Length,
    };
    unit::split_suffix(name).filter(|(_, unit)| unit.measure == measure).map_or(1.0, |(_, unit)| unit.factor)
}

/// What a header says if it is one of a joint by its words: of its position or speed, planned, measured or sent.
pub(in crate::log) fn of_joint(name: &str) -> Option<OfJoint> {
    let label = label::label(name, None);
    label.is_joint.then_some(OfJoint { role: label.role, quantity: label.quantity, alone: !label.is_weak })
}

/// What a header of a joint says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::log) struct OfJoint {
    pub(in crate::log) role: Option<Role>,
    pub(in crate::log) quantity: Option<Quantity>,
    /// Whether it says so without another column of the joint.
    pub(in crate::log) alone: bool,
}

/// Whether a part of a name says that something is planned, measured or sent.
pub(in crate::log) fn says_side(part: &str) -> bool {
    word::words(part).iter().any(|word| matches!(word.meaning, word::Meaning::Role(_)))
}

/// Reads a CSV file in memory.
///
/// # Errors
///
/// [`CsvError`]
pub fn read_csv_bytes(name: &str, bytes: &[u8], options: &CsvOptions) -> Result<CsvRun, CsvError> {
    let text = text::of_bytes(name, bytes)?;
    let mut remarks = Remarks::default();
    let table = by_column::as_table(&text)
        .or_else(|| objects::as_table(&text, &mut remarks))
        .or_else(|| echoed::as_table(&text))
        .or_else(|| printed::as_table(&text))
        .or_else(|| named_values::as_table(&text))
        .or_else(|| dataset::as_table(&text));
    let text = table.map_or(text, Cow::Owned);
    read_table(name, Cow::Borrowed(&text), options, remarks)
        .or_else(|error| of_other_form(name, &text, options, &error).unwrap_or(Err(error)))
}

/// What cannot be read as it stands, as a table of another form; `None` if it is of none.
fn of_other_form(
    name: &str,
    text: &[u8],
    options: &CsvOptions,
    error: &CsvError,
) -> Option<Result<CsvRun, CsvError>> {
    let mut remarks = Remarks::default();
    if grouping::has_quoted_commas(name, text, options) {
        let comma = CsvOptions { decimal_comma: Some(true), ..options.clone() };
        let run = read_table(name, Cow::Borrowed(text), &comma, remarks).ok()?;
        return Some(Ok(run.given(options.given())));
    }
    if let Some((plain, form)) = marks::by_column(name, text, options, error, &mut remarks) {
        let run = read_table(name, Cow::Owned(plain), &form, remarks);
        return Some(run.map(|run| run.given(options.given())));
    }
    let table = lvm::as_table(text)
        .or_else(|| scope::as_table(text, &mut remarks))
        .or_else(|| halves::joined(text, &mut remarks))
        .or_else(|| levels::joined(name, text, options))?;
    Some(read_table(name, Cow::Owned(table), options, remarks))
}

/// Reads the text of a table.
fn read_table(
    name: &str,
    text: Cow<'_, [u8]>,
    options: &CsvOptions,
    mut remarks: Remarks,
) -> Result<CsvRun, CsvError> {
    let text = trailing::filled(name, &text, options).map_or(text, Cow::Owned);
    let text = negatives::signed(name, &text, options)?.map_or(text, Cow::Owned);
    let text = numbered::gathered(&text).map_or(text, Cow::Owned);
    let text = lists::widened(&text).map_or(text, Cow::Owned);
    let text = only::of_one(name, text, options)?;
    let text = judged::without_bad(name, &text, options, &mut remarks).map_or(text, Cow::Owned);
    let text = doubled::once(name, &text, options, &mut remarks).map_or(text, Cow::Owned);
    let text = packed::unpacked(name, &text, options).map_or(text, Cow::Owned);
    let text = unpadded::padded(name, &text, options, &mut remarks).map_or(text, Cow::Owned);
    let (text, form, _) = in_one_form(name, text, options, &mut remarks);
    let before = remarks.clone();
    let read = Form::of(name, &text, &form, &mut remarks)?;
    let guess = read.guessed_ms();
    let (run, _) = read.read(name, &text, remarks)?;
    let run = match guess.and_then(|column| Some((too_fast::in_seconds(&run, &column)?, column))) {
        Some((_, column)) if too_fast::counts_rows(&run) => {
            return Err(CsvError::TimeUnit { column, step: 1.0 });
        }
        Some((doubt, _)) => {
            let mut remarks = before;
            remarks.add(Code::Guessed, 1, doubt);
            let form = CsvOptions { time_unit: Some("s".to_owned()), ..form };
            Form::of(name, &text, &form, &mut remarks)?.read(name, &text, remarks)?.0
        }
        None => run,
    };
    Ok(run.given(options.given()))
}

/// Whether rows can be read one by one; what a caller names is.
fn by_rows(name: &str, text: &[u8], options: &CsvOptions) -> Result<(), CsvError> {
    let named = options.time.is_some() && !options.columns.is_empty();
    let (.., had) = in_one_form(name, Cow::Borrowed(text), options, &mut Remarks::default());
    had.filter(|_| !named).map_or(Ok(()), |had| Err(CsvError::NotByRows { had }))
}

const CLOCKS: &str = "times of their own for some columns";

/// The text of a table with one number a cell, one time and all joints a row, how that is read, and what it had that is otherwise.
fn in_one_form<'a>(
    name: &str,
    text: Cow<'a, [u8]>,
    options: &CsvOptions,
    remarks: &mut Remarks,
) -> (Cow<'a, [u8]>, CsvOptions, Option<&'static str>) {
    let mut had = None;
    let before = text.len();
    let text = behind::without_units(name, &text, options).map_or(text, Cow::Owned);
    let text = grouping::plain(name, text, options, remarks);
    // Both leave marks and letters out.
    if text.len() != before {
        had = Some("units or marks of thousands in its cells");
    }
    let (text, form) = if let Some((joined, form)) = clocks::joined(name, &text, options, remarks) {
        had = Some(CLOCKS);
        (Cow::Owned(joined), form)
    } else {
        // Few rows may have no time in common yet.
        had = had.or(clocks::are_several(name, &text, options).then_some(CLOCKS));
        (text, options.clone())
    };
    match long::widened(name, &text, &form, remarks) {
        Some((wide, form)) => (Cow::Owned(wide), form, Some("a row for each joint")),
        None => (text, form, had),
    }
}

/// How the rows of a table are read.
#[derive(Debug)]
struct Form {
    dialect: dialect::Dialect,
    head: head::Head,
    labels: Vec<label::Label>,
    derived: Vec<expression::Derived>,
    time: time::TimeSource,
    layout: layout::Layout,
    options: CsvOptions,
}

impl Form {
    /// By the first rows, and what the caller says.
    fn of(name: &str, text: &[u8], options: &CsvOptions, remarks: &mut Remarks) -> Result<Self, CsvError> {
        options.check()?;
        let dialect = dialect::detect(name, text, options)?;
        let mut head = head::read_head(text, dialect, remarks);
        if head.is_short && options.by_number() {
            // No name stands above its own column.
            head = head::Head { names: head::numbered(dialect.width), named: false, units: None, ..head };
        } else if head.is_short {
            let [names, cells] = [head.written.len(), dialect.width];
            return Err(CsvError::ShortHeader { line: head.line, names, cells });
        }
        let mut labels = head.labels();
        settle::leave_out_names(&mut labels, &head);
        settle::settle(&mut labels);
        settle::take_slides(&mut labels, &options.slides);
        settle::leave_out_orientation(&mut labels, &column::named(options, &head.names), remarks);
        let by_name = !options.as_plan && pairing::names_a_plan(name);
        let mut options = CsvOptions { as_plan: options.as_plan || by_name, ..options.clone() };
        let derived = expression::derive(&mut head, &mut labels, &mut options)?;
        let time = clock::choose(text, &head, &labels, dialect, &options, remarks)?;
        let layout =
            layout::lay_out((text, dialect.separator), &head, &labels, &time.columns(), &options, remarks)?;
        let silent = |one: &&layout::Use| one.role == Role::Planned && labels[one.column].role.is_none();
        if let Some(one) = layout.uses.iter().find(silent).filter(|_| by_name && options.columns.is_empty()) {
            let message = format!(
                "columns such as {:?}, taken as the plan because the file is called so; else say --measured JOINT=COLUMN,...",
                head.names[one.column]
            );
            remarks.add(Code::Guessed, layout.uses.iter().filter(silent).count() as u64, message);
        }
        Ok(Self { dialect, head, labels, derived, time, layout, options })
    }

    /// The column of a time that is taken as ms and says nowhere so.
    fn guessed_ms(&self) -> Option<String> {
        let time = if let time::TimeSource::Spread { whole, .. } = &self.time { whole } else { &self.time };
        let time::TimeSource::Number { column, unit } = time else { return None };
        let says =
            |row: &Vec<Vec<u8>>| row.get(*column).is_some_and(|cell| time::with_unit(cell).1.is_some());
        let stated = self.options.time_unit.is_some()
            || self.labels[*column].stated.is_some()
            || self.head.sample.iter().any(says);
        (unit.name == "ms" && !stated).then(|| self.head.names[*column].clone())
    }

    /// Columns that sums are made of.
    fn added(&self) -> Vec<usize> {
        self.derived.iter().flat_map(|one| &one.terms).map(|(_, column)| *column).collect()
    }

    /// Columns of the file that hold numbers to read.
    fn wanted(&self) -> impl Iterator<Item = usize> {
        let uses = self.layout.uses.iter().map(|one| one.column);
        let wanted = uses.chain(self.layout.interfaces.iter().map(|one| one.column));
        wanted.filter(|column| self.derived.iter().all(|one| one.column != *column)).chain(self.added())
    }

    /// All rows, and the unit of each column in use.
    fn read(
        &self,
        name: &str,
        text: &[u8],
        mut remarks: Remarks,
    ) -> Result<(CsvRun, Vec<si::Settled>), CsvError> {
        let Self { dialect, head, labels, derived, time, layout, options } = self;
        let mut cells = read::read(name, text, head, *dialect, time, self.wanted(), &mut remarks)?;
        expression::compute(derived, &mut cells);
        let given = options.columns.contains_key(&(Role::Command, Quantity::Position));
        let stated = |column: usize| given || labels[column].unit.is_some();
        let layout = efforts::as_signals(layout.clone(), head, labels, &cells, stated, &mut remarks);
        let layout = efforts::left_out(layout, head, &cells, stated, &mut remarks);
        let layout = efforts::as_plans(layout, head, &mut remarks);
        let (units, kinds) = si::to_si(head, labels, &layout, options, &mut cells, &mut remarks)?;
        let layout_added = (&layout, self.added());
        let understood = Understood::new(name, *dialect, head, time, layout_added, &cells, &units);
        Ok((CsvRun::new((layout, kinds), cells, understood, remarks), units))
    }
}
