//! The document of a report, as `schemas/report.v2.schema.json` describes it.

use serde::{Deserialize, Serialize};

use super::{Alignment, GateResult, LogFile, Report, Why, log_files};
use crate::{
    document::PROGRAM,
    fit::Supply,
    log::SourceInfo,
    remark::Remark,
    replay::{JointReplay, KindRun, Rules, Stop, ToolReplay, Transition, WholeRun},
    workflow::carried::Held,
};

/// What the format is called.
pub(super) const FORMAT: &str = "hydrotrace.report.v2";

/// A tracking-error report of one run. Times are seconds since the first sample of the run; positions, errors and
/// speeds of a joint are in its unit, rad or m; errors are planned minus measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Document {
    /// Always "hydrotrace.report.v2".
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// The files of the run.
    pub logs: Vec<LogFile>,
    /// The machine: the entry "machine" of the log's metadata.
    pub machine: Option<String>,
    /// The run: the entry "run" of the log's metadata.
    pub run: Option<String>,
    /// What the command of this run promised, beside what came; null without a promise in the log.
    pub promised: Option<Held>,
    /// The supply, where its pressure was logged and fell while joints moved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub supply: Option<Supply>,
    /// Where the data come from.
    pub source: SourceInfo,
    /// How plan and measurement were matched, by joint.
    pub alignment: Vec<Alignment>,
    /// Each joint over the whole run.
    pub joints: Vec<JointReplay>,
    /// Planned starts and reversals, by joint, then time.
    pub transitions: Vec<Transition>,
    /// Dynamic-to-static events, by joint, then time.
    pub stops: Vec<Stop>,
    /// All joints together, in their unit.
    pub whole_run: WholeRun,
    /// Of an arm of which some joints turn and some slide, those of each kind together.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub of_kinds: Vec<KindRun>,
    /// The tool against its plan; null where the log holds no arm, or the tool cannot be placed.
    #[serde(default)]
    pub tool: Option<ToolReplay>,
    /// Why nothing is said of the tool although there is an arm; else null.
    #[serde(default)]
    pub no_tool: Option<String>,
    /// Why starts come late, by the model of a fit; null where that was not asked for, or cannot be told.
    #[serde(default)]
    pub why: Option<Why>,
    /// The limits that were set, each with the worst value found against it.
    pub gates: Vec<GateResult>,
    /// Whether every limit is kept; if not, the exit code is 4.
    pub gates_kept: bool,
    /// Thresholds and windows used.
    pub rules: Rules,
    /// Doubts about the data; any makes the exit code 3.
    pub remarks: Vec<Remark>,
}

impl Document {
    /// The document of a report; reads the logs again, for their digests.
    pub fn of(report: &Report) -> Self {
        Self::with_logs(report, log_files(&report.paths))
    }

    /// The same, where the logs are known already.
    pub(super) fn with_logs(report: &Report, logs: Vec<LogFile>) -> Self {
        Self {
            format: FORMAT.to_owned(),
            program: PROGRAM.to_owned(),
            logs,
            machine: report.machine.clone(),
            run: report.run.clone(),
            promised: report.promised,
            supply: report.supply,
            source: report.source.clone(),
            alignment: report.alignment.clone(),
            joints: report.replay.joints.clone(),
            transitions: report.replay.transitions.clone(),
            stops: report.replay.stops.clone(),
            whole_run: report.replay.whole_run.clone(),
            of_kinds: report.replay.of_kinds.clone(),
            tool: report.tool.found().cloned(),
            no_tool: report.tool.why_not(),
            why: report.why.as_ref().and_then(|why| why.as_ref().ok()).cloned(),
            gates: report.gates.clone(),
            gates_kept: report.gates_kept(),
            rules: report.replay.rules.clone(),
            remarks: report.remarks.as_slice().to_vec(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        replay::TRANSITION,
        series::JointKind,
        workflow::report::{Gates, Inputs, run},
    };

    fn document() -> Document {
        let log = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("sample-logs/gaps.mcap");
        let gates = crate::replay::limits()
            .fold(Gates::default(), |gates, limit| gates.with(limit, JointKind::Turns, 0.01));
        Document::of(&run(&Inputs { logs: vec![log], gates, ..Inputs::default() }).unwrap())
    }

    #[test]
    fn a_document_reads_back_as_it_was_written() {
        let document = document();
        let text = crate::document::pretty(&document);
        assert_eq!(serde_json::from_str::<Document>(&text).unwrap(), document);
        let [log] = document.logs.as_slice() else { panic!("one log") };
        assert_eq!((log.name.as_str(), log.sha256.as_ref().map(String::len)), ("gaps.mcap", Some(64)));
    }

    #[test]
    fn a_transition_has_the_keys_of_its_table() {
        let transition = serde_json::to_value(&document().transitions[0]).unwrap();
        let mut keys: Vec<&str> = transition.as_object().unwrap().keys().map(String::as_str).collect();
        let mut rows: Vec<&str> = TRANSITION.iter().map(|metric| metric.key).collect();
        keys.sort_unstable();
        rows.sort_unstable();
        assert_eq!(keys, rows);
    }
}
