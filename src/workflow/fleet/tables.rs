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
    pub fn columns(self) -> &'static [Column] {
        match self {
            Self::Interventions => INTERVENTIONS,
            Self::Joints => JOINTS,
            Self::Limits => LIMITS,
            Self::Remarks => REMARKS,
            Self::Runs => RUNS,
            Self::Transitions => TRANSITIONS,
        }
    }
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

const JOINTS: &[Column] = &[
    Column::text("run_id"),
    Column::text("machine"),
    Column::text("plan_id"),
    Column::text("joint"),
    Column::text("unit"),
    Column::flag("moves"),
    Column::real("rms"),
    Column::real("mean_abs"),
    Column::real("p95"),
    Column::real("peak"),
    Column::real("peak_time_s"),
    Column::real("bias"),
    Column::real("standstill_rms"),
    Column::real("lag_s"),
    Column::real("lag_low_s"),
    Column::real("lag_high_s"),
    Column::real("lag_correlation"),
    Column::real("lag_share"),
    Column::real("noise"),
    Column::real("sample_interval_s"),
    Column::whole("starts"),
    Column::whole("reversals"),
    Column::whole("stops"),
    Column::whole("unanswered"),
    Column::whole("undated"),
    Column::whole("unplanned"),
];

const TRANSITIONS: &[Column] = &[
    Column::text("run_id"),
    Column::text("machine"),
    Column::text("plan_id"),
    Column::text("joint"),
    Column::text("unit"),
    Column::whole("event_index"),
    Column::text("event_id"),
    Column::text("kind"),
    Column::whole("direction"),
    Column::text("answer"),
    Column::real("planned_onset_s"),
    Column::real("measured_onset_s"),
    Column::real("onset_delay_s"),
    Column::real("onset_delay_low_s"),
    Column::real("onset_delay_high_s"),
    Column::real("peak_error"),
    Column::real("peak_error_signed"),
    Column::real("time_to_peak_s"),
    Column::real("error_area"),
    Column::real("rms_error"),
    Column::real("overshoot"),
    Column::real("settling_time_s"),
    Column::real("breakaway_error"),
    Column::whole("samples"),
    Column::real("time_resolution_s"),
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

fn pair(interval: Option<[f64; 2]>) -> [Cell; 2] {
    [Cell::from(interval.map(|i| i[0])), Cell::from(interval.map(|i| i[1]))]
}

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
    rows.extend(report.joints.iter().map(|joint| (Name::Joints, joint_row(log, found, joint))));
    rows.extend(
        report.transitions.iter().map(|start| (Name::Transitions, transition_row(log, found, start))),
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

fn joint_row(log: &Log, found: &Findings, joint: &JointReplay) -> Vec<Cell> {
    let error = &joint.tracking_error;
    let [lag_low, lag_high] = pair(joint.lag_interval_s);
    vec![
        Cell::from(found.run_id.as_str()),
        Cell::from(log.machine.as_deref()),
        Cell::from(found.plan_id.as_deref()),
        Cell::from(joint.name.as_str()),
        Cell::from(joint.kind.unit()),
        Cell::from(joint.moves),
        Cell::from(error.rms),
        Cell::from(error.mean_abs),
        Cell::from(error.p95),
        Cell::from(error.peak),
        Cell::from(error.peak_time_s),
        Cell::from(error.bias),
        Cell::from(joint.standstill_error.map(|error| error.rms)),
        Cell::from(joint.lag_s),
        lag_low,
        lag_high,
        Cell::from(joint.lag_correlation),
        Cell::from(joint.lag_share.map(|lag| lag.share)),
        Cell::from(joint.noise.sigma),
        Cell::from(joint.sample_interval_s),
        Cell::from(joint.starts),
        Cell::from(joint.reversals),
        Cell::from(joint.stops),
        Cell::from(joint.unanswered_starts),
        Cell::from(joint.undated_starts),
        Cell::from(joint.unplanned_starts),
    ]
}

fn transition_row(log: &Log, found: &Findings, start: &Transition) -> Vec<Cell> {
    let [delay_low, delay_high] = pair(start.onset_delay_interval_s);
    vec![
        Cell::from(found.run_id.as_str()),
        Cell::from(log.machine.as_deref()),
        Cell::from(found.plan_id.as_deref()),
        Cell::from(start.joint.as_str()),
        Cell::from(start.joint_kind.unit()),
        Cell::from(start.index),
        Cell::from(start.id.as_str()),
        Cell::from(start.kind.name()),
        Cell::Whole(i64::from(start.direction)),
        Cell::from(start.answer.name()),
        Cell::from(start.planned_onset_s),
        Cell::from(start.measured_onset_s),
        Cell::from(start.onset_delay_s),
        delay_low,
        delay_high,
        Cell::from(start.peak_error),
        Cell::from(start.peak_error_signed),
        Cell::from(start.time_to_peak_s),
        Cell::from(start.error_area),
        Cell::from(start.rms_error),
        Cell::from(start.overshoot),
        Cell::from(start.settling_time_s),
        Cell::from(start.breakaway_error),
        Cell::from(start.samples),
        Cell::from(start.time_resolution_s),
    ]
}

/// The column of a table by its name; columns are asked for by names of this file.
pub(super) fn column(table: Name, name: &str) -> Column {
    let found = table.columns().iter().find(|column| column.name == name);
    found.copied().unwrap_or(table.columns()[0])
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
