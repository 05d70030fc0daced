//! The finding as a function: one log in, one owned document with its identity out, on the calling thread alone.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{
    Document, Inputs, LogFile, Report, ReportFailure,
    identity::{hash, input_files},
    plan_id::plan_id,
    report,
};
use crate::{
    document::PROGRAM,
    log::{Input, LogFiles},
    replay::Rules,
    threads,
};

/// The report of one run without its samples, and what tells it from others. Within a run a start has `index` and `id`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Findings {
    /// The run: a hash of the names of its logs, as given, and of their content.
    pub run_id: String,
    /// The plan: equal for runs of one plan, whatever the machine and the day; null if no planned start was found.
    pub plan_id: Option<String>,
    /// The analysis: a hash of the program's version, of the document's layout, and of the rules.
    pub analysis_id: String,
    /// The report.
    #[serde(flatten)]
    pub report: Document,
}

/// Analyses one run on the calling thread alone: no pool of threads is begun or used, so that a caller may fork, or
/// run one call on each of its own threads. `Inputs::logs` is not read.
///
/// # Errors
///
/// [`ReportFailure`], as [`run`](super::run).
///
/// ```standalone_crate
/// use hydrotrace::{log::Input, workflow::report::{Inputs, findings}};
///
/// let data = std::fs::read("sample-logs/task-1-run.mcap")?;
/// let found = findings(vec![Input::Bytes { name: "run.mcap".into(), data }], &Inputs::default())?;
/// assert_eq!(found.report.transitions[0].index, 1);
/// let text = serde_json::to_string(&found)?;
/// assert_eq!(serde_json::from_str::<hydrotrace::workflow::report::Findings>(&text)?, found);
/// // Nothing has begun the pool of this process: it can still be set up.
/// assert!(rayon::ThreadPoolBuilder::new().num_threads(1).build_global().is_ok());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn findings(logs: Vec<Input>, inputs: &Inputs) -> Result<Findings, ReportFailure> {
    reported(logs, inputs).map(|(_, found)| found)
}

/// The same with its samples, which a page shows.
pub(in crate::workflow) fn reported(
    logs: Vec<Input>,
    inputs: &Inputs,
) -> Result<(Report, Findings), ReportFailure> {
    threads::alone(|| {
        let names: Vec<PathBuf> = logs.iter().map(|log| log.name().to_owned()).collect();
        let files = input_files(&logs);
        let read = inputs.read_options()?;
        let files_of_run = LogFiles::with(logs, &read)?;
        let recording = files_of_run.scan()?.read(&read)?;
        let found = report(recording, &Inputs { logs: names, ..inputs.clone() })?;
        let findings = Findings::of(&found, files);
        Ok((found, findings))
    })
}

impl Findings {
    fn of(report: &Report, files: Vec<LogFile>) -> Self {
        Self {
            run_id: run_id(&report.paths, &files),
            plan_id: plan_id(&report.pairs, &report.replay),
            analysis_id: analysis_id(&report.replay.rules),
            report: Document::with_logs(report, files),
        }
    }
}

/// The identity of a run: of the names of its logs and their content.
fn run_id(names: &[PathBuf], files: &[LogFile]) -> String {
    let names = names.iter().map(|name| name.to_string_lossy().into_owned());
    let contents = files.iter().map(|file| file.sha256.clone().unwrap_or_default());
    hash(names.chain(contents))
}

/// Counts changes of what an analysis finds within a version: datasets analyse their logs anew.
const REVISION: u32 = 3;

/// What the numbers of an analysis depend on beside the log: equal for the same program, layout and rules.
pub fn analysis_id(rules: &Rules) -> String {
    hash([
        PROGRAM.to_owned(),
        REVISION.to_string(),
        super::document::FORMAT.to_owned(),
        serde_json::to_string(rules).unwrap_or_default(),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(name: &str) -> Findings {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("sample-logs").join(name);
        findings(vec![path.into()], &Inputs::default()).unwrap()
    }

    #[test]
    fn the_finding_is_the_report_whether_of_a_path_or_of_bytes() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("sample-logs/gaps.mcap");
        let of_path = sample("gaps.mcap");
        let data = std::fs::read(&path).unwrap();
        let bytes = vec![Input::Bytes { name: "gaps.mcap".into(), data }];
        let of_bytes = findings(bytes, &Inputs::default()).unwrap();
        assert_eq!(of_path.report, of_bytes.report);
        assert_eq!((of_path.plan_id, of_path.analysis_id), (of_bytes.plan_id, of_bytes.analysis_id));
        // Another name is another run.
        assert_ne!(of_path.run_id, of_bytes.run_id);
        let usual = super::super::run(&Inputs { logs: vec![path], ..Inputs::default() }).unwrap();
        assert_eq!(Document::of(&usual), of_path.report);
    }

    #[test]
    fn a_plan_keeps_its_identity_from_run_to_run_and_another_has_another() {
        let [one, again, other] =
            ["task-1-run.mcap", "precompensated-run.mcap", "task-2-run.mcap"].map(sample);
        assert!(
            one.plan_id.is_some() && one.plan_id == again.plan_id,
            "{:?} {:?}",
            one.plan_id,
            again.plan_id
        );
        assert_ne!(one.plan_id, other.plan_id);
        assert_eq!(one.analysis_id, other.analysis_id);
    }
}
