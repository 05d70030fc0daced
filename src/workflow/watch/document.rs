//! What is said of a log that was reported: a line for scripts, and what the index is made of after a restart.

use std::path::Path;

use chrono::DateTime;
use serde::{Deserialize, Serialize};

use crate::{
    document::PROGRAM,
    replay::JointReplay,
    series::JointKind,
    units::SECONDS_PER_DAY,
    workflow::{
        fleet::{Log, began_ns},
        report::{Findings, GateResult, Report, hash},
    },
};

/// What the format is called.
pub(super) const FORMAT: &str = "hydrotrace.watch.v1";

/// A log that was reported: one line of JSON, and the same in a file beside its page.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Run {
    /// Always "hydrotrace.watch.v1".
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// Where the log is.
    pub log: String,
    /// Its size and time of change: another one is another state of the log.
    pub log_etag: String,
    /// What the numbers and the verdict depend on beside the log: program, rules, options of reading, limits.
    pub request_id: String,
    /// The page, in the folder of the index; null of a log that failed.
    pub page: Option<String>,
    /// The machine, if anything names it.
    pub machine: Option<String>,
    /// When the run began, UTC; null of a log that failed, or that says no date in stamps or name.
    pub started_at: Option<String>,
    /// How long it took, s.
    pub duration_s: Option<f64>,
    /// The plan: equal for runs of one plan; null if no planned start was found.
    pub plan_id: Option<String>,
    /// Whether its limits are kept.
    pub verdict: Verdict,
    /// The limits that were set, each with the worst value found against it.
    pub gates: Vec<GateResult>,
    /// The joint whose error is largest for its kind.
    pub worst_joint: Option<String>,
    /// The longest dead time of a start, s.
    pub largest_delay_s: Option<f64>,
    /// Planned starts that were never answered.
    pub unanswered_starts: usize,
    /// Each joint over the run.
    pub joints: Vec<RunJoint>,
    /// Doubts about its data, which its page says.
    pub remarks: usize,
    /// Why there is no report; null if there is one.
    pub error: Option<String>,
}

/// Whether a run is good enough.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// All limits are kept.
    Kept,
    /// A limit is not kept.
    NotKept,
    /// No limit is set.
    NoLimits,
    /// There is no report.
    #[default]
    Failed,
}

/// A joint over a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct RunJoint {
    /// The joint.
    pub joint: String,
    /// The unit of its position: "rad" or "m".
    #[serde(rename = "unit", with = "crate::replay::unit")]
    #[cfg_attr(test, schemars(with = "String"))]
    pub kind: JointKind,
    /// Largest tracking error, in its unit.
    pub peak: f64,
    /// Root mean square of the tracking error, in its unit.
    pub rms: f64,
    /// The longest dead time of its starts, s.
    pub largest_delay_s: Option<f64>,
}

impl Run {
    /// Of a log that could not be analysed.
    pub(super) fn failed(log: &Log, request_id: &str, error: &str) -> Self {
        Self {
            format: FORMAT.to_owned(),
            program: PROGRAM.to_owned(),
            log: log.uri.clone(),
            log_etag: log.etag.clone(),
            request_id: request_id.to_owned(),
            machine: log.machine.clone(),
            error: Some(error.to_owned()),
            ..Self::default()
        }
    }

    /// Of one that was.
    pub(super) fn of(
        log: &Log,
        request_id: &str,
        page: String,
        (report, found): (&Report, &Findings),
    ) -> Self {
        let replay = &report.replay;
        let joint = |joint: &JointReplay| RunJoint {
            joint: joint.name.clone(),
            kind: joint.kind,
            peak: joint.tracking_error.peak,
            rms: joint.tracking_error.rms,
            largest_delay_s: replay.longest_delay_s(&joint.name),
        };
        let joints: Vec<RunJoint> = replay.joints.iter().map(joint).collect();
        let started = began_ns(&log.uri, report.source.began_ns()).map(DateTime::from_timestamp_nanos);
        Self {
            page: Some(page),
            started_at: started.map(|at| at.format("%Y-%m-%dT%H:%M:%SZ").to_string()),
            duration_s: Some(report.source.duration_s),
            plan_id: found.plan_id.clone(),
            verdict: match (report.gates.is_empty(), report.gates_kept()) {
                (true, _) => Verdict::NoLimits,
                (false, true) => Verdict::Kept,
                (false, false) => Verdict::NotKept,
            },
            gates: report.gates.clone(),
            worst_joint: replay.joints_worst_first().first().map(|joint| joint.name.clone()),
            largest_delay_s: joints.iter().filter_map(|joint| joint.largest_delay_s).reduce(f64::max),
            unanswered_starts: replay.joints.iter().map(|joint| joint.unanswered_starts).sum(),
            joints,
            remarks: found.report.remarks.len(),
            error: None,
            ..Self::failed(log, request_id, "")
        }
    }

    /// The joint whose error is largest.
    pub fn worst(&self) -> Option<&RunJoint> {
        self.joints.iter().find(|joint| Some(&joint.joint) == self.worst_joint.as_ref())
    }

    /// The joint whose start is latest.
    pub fn latest(&self) -> Option<&RunJoint> {
        let timed = self.joints.iter().filter(|joint| joint.largest_delay_s.is_some());
        timed.max_by(|a, b| {
            a.largest_delay_s.partial_cmp(&b.largest_delay_s).unwrap_or(std::cmp::Ordering::Equal)
        })
    }

    /// When it began, days since 1970.
    pub fn at_days(&self) -> Option<f64> {
        let at = DateTime::parse_from_rfc3339(self.started_at.as_deref()?).ok()?;
        Some(at.timestamp() as f64 / SECONDS_PER_DAY)
    }

    /// The log's name without its folders.
    pub fn name(&self) -> &str {
        self.log.trim_end_matches('/').rsplit('/').next().unwrap_or_default()
    }
}

/// The name of a log's files, without an ending: people know it by the words, the digits keep it apart.
pub(super) fn file_name(log: &str) -> String {
    const LONGEST: usize = 60;
    let path = Path::new(log);
    let parts = [path.parent().and_then(Path::file_name), path.file_stem()];
    let words: Vec<_> = parts.into_iter().flatten().map(|part| part.to_string_lossy()).collect();
    let plain = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c } else { '-' };
    let words: String = words.join("-").chars().map(plain).collect();
    let start = words.len().saturating_sub(LONGEST);
    format!("{}-{}", &words[start..], &hash([log])[..8])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        let text = str::to_owned;
        let log = Log {
            uri: text("/logs/M07/run.mcap"),
            etag: text("1-2"),
            bytes: 1,
            machine: Some(text("M07")),
            analysis_id: text("a"),
            tries: 1,
        };
        let document = Run::failed(&log, "b", "the file is empty");
        let read: Run = serde_json::from_str(&serde_json::to_string(&document).unwrap()).unwrap();
        assert_eq!(read, document);
        assert_eq!(document.name(), "run.mcap");
    }

    #[test]
    fn names_of_pages_are_plain_and_stay_apart() {
        let (a, b) = (file_name("/logs/M 07/run.mcap"), file_name("/logs/M-07/run.mcap"));
        assert!(a.starts_with("M-07-run-") && b.starts_with("M-07-run-") && a != b, "{a} {b}");
        assert!(file_name(&format!("/logs/{}.mcap", "ü".repeat(200))).len() < 80);
        assert!(file_name("/").len() == 9);
    }
}
