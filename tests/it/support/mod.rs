//! What many tests share: the built binary, the sample logs, schemas, simulated machines.

pub(crate) mod choice;
pub(crate) mod compensation;
pub(crate) mod detection;
pub(crate) mod fleet;
pub(crate) mod machine;
pub(crate) mod recovery;
#[cfg(feature = "cloud")]
pub(crate) mod store;
pub(crate) mod variation;
pub(crate) mod why;

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    process::{Command, Output},
    sync::{Arc, Mutex, OnceLock},
};

use serde_json::Value;

/// The project's folder.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

pub(crate) fn samples() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/sample-logs"))
}

/// A file of `sample-logs`.
pub(crate) fn sample(name: &str) -> PathBuf {
    samples().join(name)
}

/// The built binary in a folder; whatever colours the caller's terminal asks for.
pub(crate) fn command(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hydrotrace"));
    command.current_dir(folder);
    for name in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE"] {
        command.env_remove(name);
    }
    command
}

pub(crate) fn run_args(folder: &Path, args: &[&str]) -> Output {
    command(folder).args(args).output().unwrap()
}

/// Arguments separated by spaces.
pub(crate) fn run_line(folder: &Path, line: &str) -> Output {
    command(folder).args(line.split_whitespace()).output().unwrap()
}

pub(crate) fn run_at_root(args: &[&str]) -> Output {
    run_args(root(), args)
}

pub(crate) fn stdout(run: &Output) -> String {
    String::from_utf8(run.stdout.clone()).unwrap()
}

pub(crate) fn stderr(run: &Output) -> String {
    String::from_utf8(run.stderr.clone()).unwrap()
}

/// Exit code, standard output and standard error.
pub(crate) fn said(run: &Output) -> (i32, String, String) {
    (run.status.code().unwrap(), stdout(run), stderr(run))
}

/// The standard output of a command that must end without remarks.
pub(crate) fn clean(folder: &Path, line: &str) -> String {
    let run = run_line(folder, line);
    assert_eq!(run.status.code(), Some(0), "{line}: {}", stderr(&run));
    stdout(&run)
}

/// Writes a file by a command that must end without remarks. What was made by the same line of the same files is copied: that
/// the same inputs give the same bytes, other tests hold.
pub(crate) fn made(folder: &Path, line: &str) {
    /// By the line and the files that it names.
    type Made = BTreeMap<(String, Vec<Vec<u8>>), Arc<OnceLock<Vec<u8>>>>;
    static ALL: Mutex<Made> = Mutex::new(BTreeMap::new());
    let words: Vec<&str> = line.split_whitespace().collect();
    let to = words.iter().position(|word| *word == "-o").map(|at| words[at + 1]).unwrap();
    let read =
        words.iter().filter(|word| **word != to).filter_map(|word| std::fs::read(folder.join(word)).ok());
    let key = (line.replace(&format!("-o {to}"), ""), read.collect());
    let made = Arc::clone(ALL.lock().unwrap().entry(key).or_default());
    let bytes = made.get_or_init(|| {
        clean(folder, line);
        std::fs::read(folder.join(to)).unwrap()
    });
    std::fs::write(folder.join(to), bytes).unwrap();
}

/// A line as it is pasted into a shell.
#[cfg(unix)]
pub(crate) fn pasted(folder: &Path, line: &str) -> (i32, String, String) {
    let program = Path::new(env!("CARGO_BIN_EXE_hydrotrace")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    let mut shell = Command::new("sh");
    said(&shell.args(["-c", line]).env("PATH", path).current_dir(folder).output().unwrap())
}

/// The document of a command that may end with remarks.
pub(crate) fn json(folder: &Path, line: &str) -> Value {
    let run = run_line(folder, &format!("{line} --json"));
    assert!(matches!(run.status.code(), Some(0 | 3)), "{line}: {}", stderr(&run));
    serde_json::from_slice(&run.stdout).unwrap()
}

/// A folder with the paper's tasks.
pub(crate) fn scratch() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for task in ["task-1.toml", "task-2.toml"] {
        std::fs::copy(samples().join("tasks").join(task), folder.path().join(task)).unwrap();
    }
    folder
}

/// A header, and a line for each of some instants that are `step_s` apart.
pub(crate) fn timed(head: &str, (rows, step_s): (u32, f64), mut line: impl FnMut(f64) -> String) -> String {
    let rows = (0..rows).map(|k| line(step_s * f64::from(k)) + "\n");
    std::iter::once(format!("{head}\n")).chain(rows).collect()
}

/// Holds a document to a committed schema, say `report.v2`.
pub(crate) fn hold_to_schema(document: &Value, name: &str) {
    let schema = std::fs::read_to_string(root().join(format!("schemas/{name}.schema.json"))).unwrap();
    let validator = jsonschema::validator_for(&serde_json::from_str(&schema).unwrap()).unwrap();
    let faults: Vec<String> =
        validator.iter_errors(document).map(|fault| format!("{}: {fault}", fault.instance_path())).collect();
    assert!(faults.is_empty(), "{name}: {faults:?}");
}
