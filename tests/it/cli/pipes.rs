//! Inputs that are no files: standard input, what a shell puts in place of a command, devices.

use std::{fs, path::Path, process::Stdio};

use super::csv::trace;
use crate::support::{command, pasted, said};

/// A folder with a table and the log of it.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let text = trace("t_s,boom_set_rad,boom_act_rad", 1.0, ",", 1.0);
    fs::write(folder.path().join("a.csv"), text).unwrap();
    assert_eq!(pasted(folder.path(), "hydrotrace import a.csv -o a.mcap").0, 0);
    folder
}

/// A table of starts without the name of the run.
fn starts(csv: &str) -> Vec<&str> {
    csv.lines().filter_map(|line| Some(line.split_once(',')?.1)).collect()
}

fn run(folder: &Path, line: &str) -> (i32, String) {
    let (code, said, error) = pasted(folder, line);
    (code, said + &error)
}

#[test]
fn a_table_or_a_log_comes_through_a_pipe_as_from_a_file() {
    let folder = folder();
    let expected = run(folder.path(), "hydrotrace report a.csv --csv").1;
    assert!(expected.contains("boom"), "{expected}");
    for source in ["a.csv", "a.mcap"] {
        for stream in ["-", "/dev/stdin"] {
            for line in [
                format!("cat {source} | hydrotrace report {stream} --csv"),
                format!("hydrotrace report {stream} --csv < {source}"),
                format!(
                    "cat {source} | hydrotrace import {stream} -o b.mcap --force >&2 && hydrotrace report b.mcap --csv"
                ),
                format!(
                    "hydrotrace import {stream} -o b.mcap --force >&2 < {source} && hydrotrace report b.mcap --csv"
                ),
            ] {
                let (code, said, error) = pasted(folder.path(), &line);
                // What `report` reads as it is needs no import.
                if source == "a.mcap" && line.contains("hydrotrace import") {
                    let told = error.contains("an MCAP log; `hydrotrace report` reads it");
                    assert!(
                        told || line.contains("import /dev/stdin -o b.mcap --force >&2 <"),
                        "{line}: {error}"
                    );
                } else {
                    assert_eq!((code, starts(&said)), (0, starts(&expected)), "{line}: {error}");
                }
            }
        }
    }
    let fifo = "mkfifo pipe; cat a.csv > pipe & hydrotrace import pipe -o b.mcap --force && (cat a.csv > pipe & \
                timeout 20 hydrotrace report pipe)";
    let (code, said) = run(folder.path(), fifo);
    assert!(code == 0 && said.contains("one joint"), "{said}");
    // A file of this name is a file.
    fs::copy(folder.path().join("a.csv"), folder.path().join("-")).unwrap();
    let (code, said) = run(folder.path(), "hydrotrace report - --csv < /dev/null");
    assert!(code == 0 && starts(&said) == starts(&expected), "{said}");
}

#[test]
fn an_input_that_ends_at_once_or_never_is_refused_with_what_to_do() {
    let folder = folder();
    for line in ["report /dev/zero", "import /dev/zero -o b.mcap", "info /dev/urandom", "fit /dev/full"] {
        let (code, said) = run(folder.path(), &format!("timeout 20 hydrotrace {line}"));
        assert!(code == 1 && said.contains("a device") && said.contains("| hydrotrace"), "{line}: {said}");
    }
    for line in ["report -", "import - -o b.mcap", "report /dev/stdin"] {
        let mut command = command(folder.path());
        let run = command.args(line.split_whitespace()).stdin(Stdio::piped()).output().unwrap();
        let (code, _, error) = said(&run);
        assert!(code == 1 && error.contains("empty"), "{line}: {error}");
    }
    assert!(!folder.path().join("b.mcap").exists());
    // `--json` takes no file: this would read what it writes.
    let (_, said) = run(folder.path(), "timeout 20 hydrotrace report a.mcap --json /dev/stdout 2>&1 | cat");
    assert!(said.contains("it is where the output of this command goes"), "{said}");
}
