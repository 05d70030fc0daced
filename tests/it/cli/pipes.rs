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

#[test]
fn a_reader_that_leaves_makes_a_broken_limit_no_kept_one() {
    let folder = folder();
    let code = |line: &str| {
        run(folder.path(), &format!("(hydrotrace {line}; echo $? > code) | true"));
        fs::read_to_string(folder.path().join("code")).unwrap().trim().to_owned()
    };
    for form in ["", "--html", "--json", "--csv"] {
        assert_eq!(code(&format!("report a.csv {form} --max-peak-deg 0.001")), "4", "{form}");
        assert_eq!(code(&format!("report a.csv {form} --max-peak-deg 90")), "0", "{form}");
    }
    assert_eq!(code("compare a.csv a.csv --html --min-peak-reduction-percent 80"), "4");
    assert_eq!(code("watch 'a.cs*' --into pages --once --settle 0 --max-peak-deg 0.001"), "4");
}

#[test]
fn a_sensor_that_is_not_up_yet_stops_no_recording_and_no_report() {
    let folder = folder();
    let text = fs::read_to_string(folder.path().join("a.csv")).unwrap();
    for (word, rows) in [("nan", 10), ("NaN", 10), ("null", 10), ("N/A", 10), ("nan", 150)] {
        let late = |(k, line): (usize, &str)| match line.rsplit_once(',') {
            Some((others, _)) if (1..=rows).contains(&k) => format!("{others},{word}\n"),
            _ => format!("{line}\n"),
        };
        let late: String = text.lines().enumerate().map(late).collect();
        fs::write(folder.path().join("late.csv"), &late).unwrap();
        let (code, said) = run(folder.path(), "hydrotrace record -o late.mcap --force < late.csv");
        assert!(code == 0 || code == 3, "{word} {rows}: {said}");
        for log in ["late.csv", "late.mcap"] {
            let (code, said) = run(folder.path(), &format!("hydrotrace report {log}"));
            assert!(code == 3 || log == "late.mcap" && code == 0, "{word} {rows}: {said}");
        }
    }
}
