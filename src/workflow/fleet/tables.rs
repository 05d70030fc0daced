//! The tables of the dataset: their columns, and the rows of one log. Positions are in the joint's unit, rad or m.

use super::dated::{began_ns, undated};
use crate::{
    document::PROGRAM,
    log::dataset::{Cell, Column},
    remark::{Code, Remark},
    replay::{JointReplay, Transition},
    workflow::report::{Findings, hash},
};

/// A table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Name {
    /// A row for each thing that was done to a machine.
    Interventions,
    /// A row for each run and joint.
    Joints,
    /// A row for each run, joint and fitted number.
    Limits,
    /// A row for each doubt about a log.
    Remarks,
    /// A row for each log.
    Runs,
    /// A row for each planned start or reversal.
    Transitions,
}

impl Name {
    pub(super) const ALL: [Self; 6] =
        [Self::Interventions, Self::Joints, Self::Limits, Self::Remarks, Self::Runs, Self::Transitions];

    pub(super) fn text(self) -> &'static str {
        match self {
            Self::Interventions => "interventions",
            Self::Joints => "joints",
            Self::Limits => "limits",
            Self::Remarks => "remarks",
            Self::Runs => "runs",
            Self::Transitions => "transitions",
        }
    }

    /// Its columns; every row has a cell for each.
    pub fn columns(self) -> Vec<Column> {
        match self {
            Self::Interventions => INTERVENTIONS.to_vec(),
            Self::Joints => JOINTS.iter().map(|(column, _)| *column).collect(),
            Self::Limits => LIMITS.to_vec(),
            Self::Remarks => REMARKS.to_vec(),
            Self::Runs => RUNS.to_vec(),
            Self::Transitions => TRANSITIONS.iter().map(|(column, _)| *column).collect(),
        }
    }
}

/// A column, and what it says of something in a log.
type Told<T> = (Column, for<'a> fn(&(&'a Log, &'a Findings, &'a T)) -> Cell);

fn row<T>(table: &[Told<T>], log: &Log, found: &Findings, of: &T) -> Vec<Cell> {
    table.iter().map(|(_, told)| told(&(log, found, of))).collect()
}

const RUNS: &[Column] = &[
    Column::text("run_id"),
    Column::text("machine"),
    Column::instant("started_at"),
    Column::text("log_uri"),
    Column::text("log_etag"),
    Column::whole("log_bytes"),
    Column::text("log_sha256"),
    Column::text("analysis_id"),
    Column::text("program"),
    Column::text("plan_id"),
    Column::real("duration_s"),
    Column::text("planned_topic"),
    Column::text("planned_field"),
    Column::text("measured_topic"),
    Column::text("measured_field"),
    Column::text("time_base"),
    Column::flag("plan_is_command"),
    Column::whole("joints"),
    Column::whole("samples"),
    Column::whole("transitions"),
    Column::text("unit"),
    Column::real("rms"),
    Column::real("peak"),
    Column::real("path_rms"),
    Column::real("lag_share"),
    Column::text("verdict"),
    Column::real("concentration_p"),
    Column::whole("remarks"),
    Column::text("error"),
    Column::flag("may_pass"),
    Column::whole("tries"),
];

const JOINTS: &[Told<JointReplay>] = &[
    (Column::text("run_id"), |(_, found, _)| Cell::from(found.run_id.as_str())),
    (Column::text("machine"), |(log, _, _)| Cell::from(log.machine.as_deref())),
    (Column::text("plan_id"), |(_, found, _)| Cell::from(found.plan_id.as_deref())),
    (Column::text("joint"), |(_, _, joint)| Cell::from(joint.name.as_str())),
    (Column::text("unit"), |(_, _, joint)| Cell::from(joint.kind.unit())),
    (Column::flag("moves"), |(_, _, joint)| Cell::from(joint.moves)),
    (Column::real("rms"), |(_, _, joint)| Cell::from(joint.tracking_error.rms)),
    (Column::real("mean_abs"), |(_, _, joint)| Cell::from(joint.tracking_error.mean_abs)),
    (Column::real("p95"), |(_, _, joint)| Cell::from(joint.tracking_error.p95)),
    (Column::real("peak"), |(_, _, joint)| Cell::from(joint.tracking_error.peak)),
    (Column::real("peak_time_s"), |(_, _, joint)| Cell::from(joint.tracking_error.peak_time_s)),
    (Column::real("bias"), |(_, _, joint)| Cell::from(joint.tracking_error.bias)),
    (Column::real("standstill_rms"), |(_, _, joint)| {
        Cell::from(joint.standstill_error.map(|error| error.rms))
    }),
    (Column::real("lag_s"), |(_, _, joint)| Cell::from(joint.lag_s)),
    (Column::real("lag_low_s"), |(_, _, joint)| Cell::from(joint.lag_interval_s.map(|i| i[0]))),
    (Column::real("lag_high_s"), |(_, _, joint)| Cell::from(joint.lag_interval_s.map(|i| i[1]))),
    (Column::real("lag_correlation"), |(_, _, joint)| Cell::from(joint.lag_correlation)),
    (Column::real("lag_share"), |(_, _, joint)| Cell::from(joint.lag_share.map(|lag| lag.share))),
    (Column::real("noise"), |(_, _, joint)| Cell::from(joint.noise.sigma)),
    (Column::real("sample_interval_s"), |(_, _, joint)| Cell::from(joint.sample_interval_s)),
    (Column::whole("starts"), |(_, _, joint)| Cell::from(joint.starts)),
    (Column::whole("reversals"), |(_, _, joint)| Cell::from(joint.reversals)),
    (Column::whole("stops"), |(_, _, joint)| Cell::from(joint.stops)),
    (Column::whole("unanswered"), |(_, _, joint)| Cell::from(joint.unanswered_starts)),
    (Column::whole("undated"), |(_, _, joint)| Cell::from(joint.undated_starts)),
    (Column::whole("unplanned"), |(_, _, joint)| Cell::from(joint.unplanned_starts)),
];

const TRANSITIONS: &[Told<Transition>] = &[
    (Column::text("run_id"), |(_, found, _)| Cell::from(found.run_id.as_str())),
    (Column::text("machine"), |(log, _, _)| Cell::from(log.machine.as_deref())),
    (Column::text("plan_id"), |(_, found, _)| Cell::from(found.plan_id.as_deref())),
    (Column::text("joint"), |(_, _, start)| Cell::from(start.joint.as_str())),
    (Column::text("unit"), |(_, _, start)| Cell::from(start.joint_kind.unit())),
    (Column::whole("event_index"), |(_, _, start)| Cell::from(start.index)),
    (Column::text("event_id"), |(_, _, start)| Cell::from(start.id.as_str())),
    (Column::text("kind"), |(_, _, start)| Cell::from(start.kind.name())),
    (Column::whole("direction"), |(_, _, start)| Cell::Whole(i64::from(start.direction))),
    (Column::text("answer"), |(_, _, start)| Cell::from(start.answer.name())),
    (Column::real("planned_onset_s"), |(_, _, start)| Cell::from(start.planned_onset_s)),
    (Column::real("measured_onset_s"), |(_, _, start)| Cell::from(start.measured_onset_s)),
    (Column::real("onset_delay_s"), |(_, _, start)| Cell::from(start.onset_delay_s)),
    (Column::real("onset_delay_low_s"), |(_, _, start)| {
        Cell::from(start.onset_delay_interval_s.map(|i| i[0]))
    }),
    (Column::real("onset_delay_high_s"), |(_, _, start)| {
        Cell::from(start.onset_delay_interval_s.map(|i| i[1]))
    }),
    (Column::real("peak_error"), |(_, _, start)| Cell::from(start.peak_error)),
    (Column::real("peak_error_signed"), |(_, _, start)| Cell::from(start.peak_error_signed)),
    (Column::real("time_to_peak_s"), |(_, _, start)| Cell::from(start.time_to_peak_s)),
    (Column::real("error_area"), |(_, _, start)| Cell::from(start.error_area)),
    (Column::real("rms_error"), |(_, _, start)| Cell::from(start.rms_error)),
    (Column::real("overshoot"), |(_, _, start)| Cell::from(start.overshoot)),
    (Column::real("settling_time_s"), |(_, _, start)| Cell::from(start.settling_time_s)),
    (Column::real("breakaway_error"), |(_, _, start)| Cell::from(start.breakaway_error)),
    (Column::whole("samples"), |(_, _, start)| Cell::from(start.samples)),
    (Column::real("time_resolution_s"), |(_, _, start)| Cell::from(start.time_resolution_s)),
];

/// Numbers of a joint as a fit finds them; `value` is in the unit of the quantity's name.
const LIMITS: &[Column] = &[
    Column::text("run_id"),
    Column::text("machine"),
    Column::text("joint"),
    Column::text("quantity"),
    Column::real("value"),
    Column::real("low"),
    Column::real("high"),
    Column::real("not_below"),
    Column::real("not_above"),
    Column::flag("identified"),
    Column::flag("model_holds"),
    Column::real("held_out_r2"),
    Column::whole("samples"),
];

const INTERVENTIONS: &[Column] =
    &[Column::text("machine"), Column::instant("at"), Column::text("joint"), Column::text("what")];

const REMARKS: &[Column] = &[
    Column::text("run_id"),
    Column::text("machine"),
    Column::text("code"),
    Column::whole("count"),
    Column::text("message"),
];

/// What is known of a log before it is opened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Log {
    /// Where it is.
    pub uri: String,
    /// Another one is another state of the log.
    pub etag: String,
    /// Its size.
    pub bytes: u64,
    /// The machine that it is of.
    pub machine: Option<String>,
    /// What the numbers depend on beside the log.
    pub analysis_id: String,
    /// How often it was analysed, this time included.
    pub tries: u64,
}

/// Rows of one log by table.
pub type Rows = Vec<(Name, Vec<Cell>)>;

fn micros(ns: i64) -> Cell {
    Cell::Whole(ns.div_euclid(1000))
}

/// The rows of a log that was analysed.
pub fn analysed(log: &Log, found: &Findings) -> Rows {
    let report = &found.report;
    let whole = &report.whole_run;
    let kinds = report.joints.windows(2).all(|two| two[0].kind == two[1].kind);
    let unit = report.joints.first().filter(|_| kinds).map(|joint| joint.kind.unit());
    let concentration = whole.concentration.as_ref();
    let is_command = report.remarks.iter().any(|remark| remark.code == Code::PlanIsCommand);
    let verdict = concentration.and_then(|c| serde_json::to_string(&c.verdict).ok());
    let began_ns = began_ns(&log.uri, report.source.began_ns());
    let run = vec![
        Cell::from(found.run_id.as_str()),
        Cell::from(log.machine.as_deref()),
        began_ns.map_or(Cell::None, micros),
        Cell::from(log.uri.as_str()),
        Cell::from(log.etag.as_str()),
        Cell::from(log.bytes),
        Cell::from(content(found).as_deref()),
        Cell::from(log.analysis_id.as_str()),
        Cell::from(PROGRAM),
        Cell::from(found.plan_id.as_deref()),
        Cell::from(report.source.duration_s),
        Cell::from(report.source.planned_topic.as_str()),
        Cell::from(report.source.planned_field.as_str()),
        Cell::from(report.source.measured_topic.as_str()),
        Cell::from(report.source.measured_field.as_str()),
        Cell::from(report.source.time_base.name()),
        Cell::from(is_command),
        Cell::from(report.joints.len()),
        Cell::from(report.alignment.iter().map(|joint| joint.matched).max()),
        Cell::from(report.transitions.len()),
        Cell::from(unit),
        Cell::from(whole.tracking_error.map(|error| error.rms)),
        Cell::from(whole.tracking_error.map(|error| error.peak)),
        Cell::from(whole.path_error.map(|error| error.rms)),
        Cell::from(whole.lag_share.map(|lag| lag.share)),
        Cell::from(verdict.as_deref().map(|text| text.trim_matches('"'))),
        Cell::from(concentration.and_then(|c| c.test).map(|test| test.p_value)),
        Cell::from(report.remarks.len() + usize::from(began_ns.is_none())),
        Cell::None,
        Cell::from(false),
        Cell::from(log.tries),
    ];
    let mut rows = vec![(Name::Runs, run)];
    rows.extend(report.joints.iter().map(|joint| (Name::Joints, row(JOINTS, log, found, joint))));
    rows.extend(
        report.transitions.iter().map(|start| (Name::Transitions, row(TRANSITIONS, log, found, start))),
    );
    let doubt = |remark: &Remark| (Name::Remarks, remark_row(log, &found.run_id, remark));
    rows.extend(report.remarks.iter().map(doubt));
    rows.extend(began_ns.is_none().then(|| doubt(&undated())));
    rows
}

/// The row of a doubt about a run.
pub(super) fn remark_row(log: &Log, run_id: &str, remark: &Remark) -> Vec<Cell> {
    vec![
        Cell::from(run_id),
        Cell::from(log.machine.as_deref()),
        Cell::from(remark.code.name().as_str()),
        Cell::from(remark.count),
        Cell::from(remark.message.as_str()),
    ]
}

/// The hash of the content of all files of a run.
fn content(found: &Findings) -> Option<String> {
    let digests: Option<Vec<String>> = found.report.logs.iter().map(|log| log.sha256.clone()).collect();
    digests.map(|digests| digests.join("+"))
}

/// The row of a log that could not be analysed; `may_pass`: whether a later try may be able to.
pub fn failed(log: &Log, error: &str, may_pass: bool) -> Rows {
    let run_id = hash([log.uri.as_str(), log.etag.as_str()]);
    let mut row = vec![Cell::None; RUNS.len()];
    let mut put = |name: &str, cell: Cell| {
        if let Some(place) = RUNS.iter().position(|column| column.name == name) {
            row[place] = cell;
        }
    };
    put("run_id", Cell::from(run_id.as_str()));
    put("machine", Cell::from(log.machine.as_deref()));
    put("log_uri", Cell::from(log.uri.as_str()));
    put("log_etag", Cell::from(log.etag.as_str()));
    put("log_bytes", Cell::from(log.bytes));
    put("analysis_id", Cell::from(log.analysis_id.as_str()));
    put("program", Cell::from(PROGRAM));
    put("error", Cell::from(error));
    put("may_pass", Cell::from(may_pass));
    put("tries", Cell::from(log.tries));
    vec![(Name::Runs, row)]
}

/// The column of a table by its name; columns are asked for by names of this file.
pub(super) fn column(table: Name, name: &str) -> Column {
    let columns = table.columns();
    *columns.iter().find(|column| column.name == name).unwrap_or(&columns[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        log::Input,
        workflow::report::{Inputs, findings},
    };

    fn log() -> Log {
        let text = str::to_owned;
        Log { uri: text("/a"), etag: text("1"), bytes: 1, machine: None, analysis_id: text("b"), tries: 1 }
    }

    #[test]
    fn every_row_has_a_cell_for_each_column_and_no_name_stands_twice() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("sample-logs/gaps.mcap");
        let found = findings(vec![Input::Path(path)], &Inputs::default()).unwrap();
        let rows = analysed(&log(), &found);
        for name in [Name::Joints, Name::Remarks, Name::Runs, Name::Transitions] {
            let own: Vec<_> = rows.iter().filter(|(table, _)| *table == name).collect();
            assert!(!own.is_empty(), "{name:?}");
            assert!(own.iter().all(|(_, row)| row.len() == name.columns().len()), "{name:?}");
            let mut names: Vec<&str> = name.columns().iter().map(|column| column.name).collect();
            names.sort_unstable();
            names.dedup();
            assert_eq!(names.len(), name.columns().len());
        }
        assert_eq!(failed(&log(), "broken", true)[0].1.len(), RUNS.len());
    }
}
