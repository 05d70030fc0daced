//! A run as a CSV file gave it, and the log it becomes.

use std::{collections::BTreeMap, io::Write};

use super::{Quantity, Role, Understood, layout::Layout, read::Cells, understood::ColumnRead};
use crate::{
    log::{LogWriter, WriteError, WriteOptions, joint_kind},
    remark::{Code, Remarks},
    series::JointKind,
};

/// Columns of one quantity, `[joints]`; `None` for a joint without one.
type ByJoint<'a> = Vec<Option<&'a [f64]>>;

/// Name of the metadata that says where an imported log comes from.
pub(in crate::log) const ORIGIN: &str = "hydrotrace.import";
/// Its entry on the time.
pub(in crate::log) const TIME_OF_ORIGIN: &str = "time";

/// Its entry where the times say no date, but count from a fixed instant.
pub(in crate::log) const UNDATED_OF_ORIGIN: &str = "no date";

/// Columns that are named of those that were not used.
const NAMED: usize = 20;

/// Its entry of columns that were not used.
pub(in crate::log) const UNUSED_OF_ORIGIN: &str = "not used";

/// What its entries of units begin with that the table or its reader stated.
pub(in crate::log) const UNIT_OF_ORIGIN: &str = "unit of ";
/// The same of units that were guessed.
pub(in crate::log) const GUESSED_OF_ORIGIN: &str = "guessed unit of ";
/// What its entries of options that were given begin with; a number and the option follow.
pub(in crate::log) const GIVEN_OF_ORIGIN: &str = "option ";

/// What its entries of doubts begin with that an option settles; a number follows.
pub(in crate::log) const DOUBT_OF_ORIGIN: &str = "doubt ";

/// A run as a CSV file gave it: SI units, one row an instant.
#[derive(Debug, Clone, PartialEq)]
pub struct CsvRun {
    /// How the file was read.
    pub understood: Understood,
    /// Doubts about the data.
    pub remarks: Remarks,
    layout: Layout,
    /// `[joints]`
    kinds: Vec<JointKind>,
    cells: Cells,
    /// Options that were given to read it.
    given: Vec<(&'static str, Option<String>)>,
}

impl CsvRun {
    /// The measurement alone.
    pub(in crate::log) fn measured(mut self) -> Self {
        self.layout.uses.retain(|one| one.role == Role::Measured);
        self
    }

    pub(super) fn new(
        (layout, kinds): (Layout, Vec<JointKind>),
        cells: Cells,
        understood: Understood,
        remarks: Remarks,
    ) -> Self {
        Self { understood, remarks, layout, kinds, cells, given: Vec::new() }
    }

    /// Notes the options that it was read with.
    pub(super) fn given(mut self, given: Vec<(&'static str, Option<String>)>) -> Self {
        self.given = given;
        self
    }

    /// Writes the run as an MCAP log of ROS 2 messages. A row gives a message of plan, measurement
    /// or command if at least one joint has a number for it; a joint without one is NaN in it.
    ///
    /// # Errors
    ///
    /// [`WriteError`] if `output` takes no more, or for a name of joint or interface that no log
    /// can hold.
    pub fn write<W: Write>(&self, output: W) -> Result<W, WriteError> {
        let mut log = self.begin(output, WriteOptions::default())?;
        self.write_rows(&mut log)?;
        log.finish()
    }

    /// The log with what it says of itself, before its rows.
    pub(super) fn begin<W: Write>(
        &self,
        output: W,
        options: WriteOptions,
    ) -> Result<LogWriter<W>, WriteError> {
        let Self { layout, understood, .. } = self;
        let mut log = LogWriter::new(output, &layout.joints, options)?;
        let columns =
            understood.columns.iter().map(|c| (format!("{} of {}", c.becomes, c.joint), c.header.clone()));
        let time = format!("{} ({})", understood.time.columns.join(", "), understood.time.form);
        let mut origin: BTreeMap<String, String> = columns.collect();
        let of_unit = |c: &ColumnRead| {
            let begins = match c.unit_from.as_str() {
                "file" | "option" => UNIT_OF_ORIGIN,
                "guess" => GUESSED_OF_ORIGIN,
                _ => return None,
            };
            Some((format!("{begins}{} of {}", c.becomes, c.joint), c.unit.clone().unwrap_or_default()))
        };
        origin.extend(understood.columns.iter().filter_map(of_unit));
        origin.extend([("file".to_owned(), understood.file.clone()), (TIME_OF_ORIGIN.to_owned(), time)]);
        if !understood.time.absolute {
            origin.insert(UNDATED_OF_ORIGIN.to_owned(), String::new());
        }
        let unused = &understood.unused;
        if !unused.is_empty() {
            let more = if unused.len() > NAMED {
                format!(" and {} more", unused.len() - NAMED)
            } else {
                String::new()
            };
            origin.insert(UNUSED_OF_ORIGIN.to_owned(), unused[..unused.len().min(NAMED)].join(", ") + &more);
        }
        let doubts = self.remarks.as_slice().iter().filter(|remark| remark.code == Code::Guessed);
        origin.extend(
            doubts
                .enumerate()
                .map(|(at, doubt)| (format!("{DOUBT_OF_ORIGIN}{at:02}"), doubt.message.clone())),
        );
        // Numbered, because an option may be given several times, and in the order of the line.
        let given = self.given.iter().enumerate().map(|(at, (option, value))| {
            (format!("{GIVEN_OF_ORIGIN}{at:02} {option}"), value.clone().unwrap_or_default())
        });
        origin.extend(given);
        log.metadata(ORIGIN, &origin)?;
        let kinds =
            joint_kind::entries(layout.joints.iter().map(String::as_str).zip(self.kinds.iter().copied()));
        if !kinds.is_empty() {
            log.metadata(joint_kind::METADATA, &kinds)?;
        }
        Ok(log)
    }

    pub(super) fn write_rows<W: Write>(&self, log: &mut LogWriter<W>) -> Result<(), WriteError> {
        let Self { layout, cells, .. } = self;
        let positions = |role| self.by_joint(role, Quantity::Position);
        let velocities = |role| self.by_joint(role, Quantity::Velocity);
        let sides: Vec<(Role, [ByJoint<'_>; 2])> = [Role::Planned, Role::Measured, Role::Command]
            .into_iter()
            .filter_map(|role| Some((role, [positions(role)?, velocities(role).unwrap_or_default()])))
            .collect();
        let names: Vec<&str> = layout.interfaces.iter().map(|one| one.name.as_str()).collect();
        let interfaces: BTreeMap<&str, ByJoint<'_>> =
            names.into_iter().map(|name| (name, self.interface(name))).collect();
        let mut row_values = [Vec::new(), Vec::new()];
        for (row, (&stamp_ns, &received_ns)) in cells.stamp_ns.iter().zip(&cells.received_ns).enumerate() {
            log.receive_after(received_ns.saturating_sub(stamp_ns));
            for (role, quantities) in &sides {
                for (values, columns) in row_values.iter_mut().zip(quantities) {
                    at(columns, row, values);
                }
                let [position_rad, velocity_rad_s] = &row_values;
                if position_rad.iter().any(|q| q.is_finite()) {
                    log.joint_sample(*role, stamp_ns, position_rad, velocity_rad_s, &[])?;
                }
            }
            if !interfaces.is_empty() {
                let values: Vec<(&str, Vec<f64>)> = interfaces
                    .iter()
                    .map(|(name, columns)| {
                        let mut values = Vec::new();
                        at(columns, row, &mut values);
                        (*name, values)
                    })
                    .collect();
                let slices: Vec<(&str, &[f64])> =
                    values.iter().map(|(name, v)| (*name, v.as_slice())).collect();
                log.interfaces(stamp_ns, &slices)?;
            }
        }
        Ok(())
    }

    /// Other rows of the same columns in place of these.
    pub(super) fn set_cells(&mut self, cells: Cells) {
        self.cells = cells;
    }

    /// When each row was, ns.
    pub(super) fn stamp_ns(&self) -> &[i64] {
        &self.cells.stamp_ns
    }

    fn column(&self, column: usize) -> Option<&[f64]> {
        self.cells.columns.get(&column).map(|column| column.values.as_slice())
    }

    /// Columns of a role and quantity, `[joints]`; `None` if no joint has one.
    pub(super) fn by_joint(&self, role: Role, quantity: Quantity) -> Option<ByJoint<'_>> {
        let of = |joint: usize| {
            let fits = |one: &&super::layout::Use| {
                one.role == role && one.quantity == quantity && one.joint == joint
            };
            self.layout.uses.iter().find(fits).and_then(|one| self.column(one.column))
        };
        let columns: ByJoint<'_> = (0..self.layout.joints.len()).map(of).collect();
        columns.iter().any(Option::is_some).then_some(columns)
    }

    fn interface(&self, name: &str) -> ByJoint<'_> {
        let of = |joint: usize| {
            let one = self.layout.interfaces.iter().find(|one| one.name == name && one.joint == joint);
            one.and_then(|one| self.column(one.column))
        };
        (0..self.layout.joints.len()).map(of).collect()
    }
}

/// A row of some columns; NaN where there is no number.
fn at(columns: &[Option<&[f64]>], row: usize, values: &mut Vec<f64>) {
    values.clear();
    let value = |values: Option<&[f64]>| values.and_then(|values| values.get(row)).copied();
    values.extend(columns.iter().map(|&column| value(column).unwrap_or(f64::NAN)));
}
