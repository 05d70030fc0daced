//! The tables of the dataset: their columns, and the rows of one log. Positions are in the joint's unit, rad or m.

use super::dated::{began_ns, undated};
use crate::{
    document::PROGRAM,
    fit::{Estimated, JointFit},
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
            Self::Joints => columns(JOINTS),
            Self::Limits => columns(LIMITS),
            Self::Remarks => columns(REMARKS),
            Self::Runs => columns(RUNS),
            Self::Transitions => columns(TRANSITIONS),
        }
    }
}

fn columns<T>(table: &[(Column, T)]) -> Vec<Column> {
    table.iter().map(|(column, _)| *column).collect()
}

/// A column, and what it says of something in a log.
type Told<T> = (Column, for<'a> fn(&(&'a Log, &'a Findings, &'a T)) -> Cell);

type Says<T> = (Column, fn(&T) -> Cell);
type SaysOfLimit = (Column, for<'a> fn(&OfLimit<'a>) -> Cell);
type SaysOfRemark = (Column, for<'a> fn(&(&'a Log, &'a str, &'a Remark)) -> Cell);

fn row<T>(table: &[Says<T>], of: &T) -> Vec<Cell> {
    table.iter().map(|(_, told)| told(of)).collect()
}

/// Of a run, and when it began, ns since 1970.
const RUNS: &[Told<Option<i64>>] = &[
    (Column::text("run_id"), |(_, found, _)| Cell::from(found.run_id.as_str())),
    (Column::text("machine"), |(log, _, _)| Cell::from(log.machine.as_deref())),
    (Column::instant("started_at"), |(_, _, began_ns)| began_ns.map_or(Cell::None, micros)),
    (Column::text("log_uri"), |(log, _, _)| Cell::from(log.uri.as_str())),
    (Column::text("log_etag"), |(log, _, _)| Cell::from(log.etag.as_str())),
    (Column::whole("log_bytes"), |(log, _, _)| Cell::from(log.bytes)),
    (Column::text("log_sha256"), |(_, found, _)| Cell::from(content(found).as_deref())),
    (Column::text("analysis_id"), |(log, _, _)| Cell::from(log.analysis_id.as_str())),
    (Column::text("program"), |_| Cell::from(PROGRAM)),
    (Column::text("plan_id"), |(_, found, _)| Cell::from(found.plan_id.as_deref())),
    (Column::real("duration_s"), |(_, found, _)| Cell::from(found.report.source.duration_s)),
    (Column::text("planned_topic"), |(_, found, _)| Cell::from(found.report.source.planned_topic.as_str())),
    (Column::text("planned_field"), |(_, found, _)| Cell::from(found.report.source.planned_field.as_str())),
    (Column::text("measured_topic"), |(_, found, _)| Cell::from(found.report.source.measured_topic.as_str())),
    (Column::text("measured_field"), |(_, found, _)| Cell::from(found.report.source.measured_field.as_str())),
    (Column::text("time_base"), |(_, found, _)| Cell::from(found.report.source.time_base.name())),
    (Column::flag("plan_is_command"), |(_, found, _)| {
        Cell::from(found.report.remarks.iter().any(|remark| remark.code == Code::PlanIsCommand))
    }),
    (Column::whole("joints"), |(_, found, _)| Cell::from(found.report.joints.len())),
    (Column::whole("samples"), |(_, found, _)| {
        Cell::from(found.report.alignment.iter().map(|joint| joint.matched).max())
    }),
    (Column::whole("transitions"), |(_, found, _)| Cell::from(found.report.transitions.len())),
    (Column::text("unit"), |(_, found, _)| Cell::from(unit(&found.report.joints))),
    (Column::real("rms"), |(_, found, _)| {
        Cell::from(found.report.whole_run.tracking_error.map(|error| error.rms))
    }),
    (Column::real("peak"), |(_, found, _)| {
        Cell::from(found.report.whole_run.tracking_error.map(|error| error.peak))
    }),
    (Column::real("path_rms"), |(_, found, _)| {
        Cell::from(found.report.whole_run.path_error.map(|error| error.rms))
    }),
    (Column::real("lag_share"), |(_, found, _)| {
        Cell::from(found.report.whole_run.lag_share.map(|lag| lag.share))
    }),
    (Column::text("verdict"), |(_, found, _)| {
        let concentration = found.report.whole_run.concentration.as_ref();
        let verdict = concentration.and_then(|c| serde_json::to_string(&c.verdict).ok());
        Cell::from(verdict.as_deref().map(|text| text.trim_matches('"')))
    }),
    (Column::real("concentration_p"), |(_, found, _)| {
        let concentration = found.report.whole_run.concentration.as_ref();
        Cell::from(concentration.and_then(|c| c.test).map(|test| test.p_value))
    }),
    (Column::whole("remarks"), |(_, found, began_ns)| {
        Cell::from(found.report.remarks.len() + usize::from(began_ns.is_none()))
    }),
    (Column::text("error"), |_| Cell::None),
    (Column::flag("may_pass"), |_| Cell::from(false)),
    (Column::whole("tries"), |(log, _, _)| Cell::from(log.tries)),
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

/// A number of a joint by its name, in a run of a log.
pub(super) type OfLimit<'a> = (&'a Log, &'a str, &'a JointFit, &'a str, Estimated);

/// Numbers of a joint as a fit finds them; `value` is in the unit of the quantity's name.
const LIMITS: &[SaysOfLimit] = &[
    (Column::text("run_id"), |(_, run_id, ..)| Cell::from(*run_id)),
    (Column::text("machine"), |(log, ..)| Cell::from(log.machine.as_deref())),
    (Column::text("joint"), |(_, _, joint, ..)| Cell::from(joint.name.as_str())),
    (Column::text("quantity"), |(.., name, _)| Cell::from(*name)),
    (Column::real("value"), |(.., found)| Cell::from(found.value)),
    (Column::real("low"), |(.., found)| Cell::from(found.interval.map(|[low, _]| low))),
    (Column::real("high"), |(.., found)| Cell::from(found.interval.map(|[_, high]| high))),
    (Column::real("not_below"), |(.., found)| Cell::from(found.lower_bound)),
    (Column::real("not_above"), |(.., found)| Cell::from(found.upper_bound)),
    (Column::flag("identified"), |(.., found)| Cell::from(found.identified)),
    (Column::flag("model_holds"), |(_, _, joint, ..)| Cell::from(joint.model_holds)),
    (Column::real("held_out_r2"), |(_, _, joint, ..)| Cell::from(joint.held_out_r2)),
    (Column::whole("samples"), |(_, _, joint, ..)| Cell::from(joint.samples)),
];

const INTERVENTIONS: &[Column] =
    &[Column::text("machine"), Column::instant("at"), Column::text("joint"), Column::text("what")];

/// A doubt about a run of a log.
const REMARKS: &[SaysOfRemark] = &[
    (Column::text("run_id"), |(_, run_id, _)| Cell::from(*run_id)),
    (Column::text("machine"), |(log, _, _)| Cell::from(log.machine.as_deref())),
    (Column::text("code"), |(_, _, remark)| Cell::from(remark.code.name().as_str())),
    (Column::whole("count"), |(_, _, remark)| Cell::from(remark.count)),
    (Column::text("message"), |(_, _, remark)| Cell::from(remark.message.as_str())),
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
    let began_ns = began_ns(&log.uri, report.source.began_ns());
    let mut rows = vec![(Name::Runs, row(RUNS, &(log, found, &began_ns)))];
    rows.extend(report.joints.iter().map(|joint| (Name::Joints, row(JOINTS, &(log, found, joint)))));
    let start = |start| (Name::Transitions, row(TRANSITIONS, &(log, found, start)));
    rows.extend(report.transitions.iter().map(start));
    let doubt = |remark: &Remark| (Name::Remarks, remark_row(log, &found.run_id, remark));
    rows.extend(report.remarks.iter().map(doubt));
    rows.extend(began_ns.is_none().then(|| doubt(&undated())));
    rows
}

/// The row of a doubt about a run.
pub(super) fn remark_row(log: &Log, run_id: &str, remark: &Remark) -> Vec<Cell> {
    row(REMARKS, &(log, run_id, remark))
}

/// The row of a number of a joint.
pub(super) fn limit_row(of: &OfLimit<'_>) -> Vec<Cell> {
    row(LIMITS, of)
}

/// The unit that all joints share.
fn unit(joints: &[JointReplay]) -> Option<&'static str> {
    let shared = joints.windows(2).all(|two| two[0].kind == two[1].kind);
    joints.first().filter(|_| shared).map(|joint| joint.kind.unit())
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
        if let Some(place) = RUNS.iter().position(|(column, _)| column.name == name) {
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
