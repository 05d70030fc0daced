//! Where results go: streams that end early, files of every kind, forms by their ending.

use std::{
    fs,
    io::{Read as _, Seek as _},
    path::Path,
    process::{Command, Output, Stdio},
};

use crate::support::{command, said, samples};

fn start(folder: &Path, words: &str) -> Command {
    let mut command = command(folder);
    let samples = samples().to_str().unwrap();
    command.args(words.split_whitespace().map(|word| word.replace("SAMPLES", samples)));
    command
}

fn hydrotrace(folder: &Path, words: &str) -> Output {
    start(folder, words).output().unwrap()
}

fn contents(mut file: fs::File) -> Vec<u8> {
    let mut bytes = Vec::new();
    file.rewind().unwrap();
    file.read_to_end(&mut bytes).unwrap();
    bytes
}

const REPORT: &str = "report SAMPLES/panel-install.mcap";
const TIMES: &str = "plan SAMPLES/tasks/task-1.toml --times 0,20,40,60,82,102";

#[test]
fn a_reader_that_goes_away_is_success_for_every_verb() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    assert!(hydrotrace(path, &format!("{TIMES} -o plan.mcap")).status.success());
    for words in [
        REPORT,
        "report SAMPLES/panel-install.mcap --json",
        "report SAMPLES/panel-install.mcap --html",
        "report SAMPLES/panel-install.mcap --csv",
        "compare SAMPLES/task-1-run.mcap SAMPLES/precompensated-run.mcap",
        "info SAMPLES/panel-install.mcap",
        "export SAMPLES/panel-install.mcap --csv",
        "export SAMPLES/panel-install.mcap -o run.parquet",
        "import SAMPLES/plc-trace.csv -o plc.mcap",
        "recover SAMPLES/panel-install.mcap -o saved.mcap --json",
        TIMES,
        "simulate plan.mcap -o run.mcap",
        "excite -o id.mcap --task SAMPLES/tasks/task-1.toml",
        "fit SAMPLES/task-1-run.mcap --json",
        "completions bash",
        "man pages",
        "--help",
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let run = start(path, words).stdout(writer).stderr(Stdio::piped()).output().unwrap();
        let error = String::from_utf8(run.stderr).unwrap();
        // 3 is the verdict of a log with remarks.
        assert!(matches!(run.status.code(), Some(0 | 3)), "{words}: {:?} {error}", run.status);
        assert!(!error.contains("error"), "{words}: {error}");
    }
}

#[test]
fn a_dash_is_standard_output_for_texts_and_refused_for_logs() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let plain = hydrotrace(path, REPORT).stdout;
    for words in [
        "report SAMPLES/panel-install.mcap -o -",
        "report SAMPLES/panel-install.mcap --output=-",
        "report SAMPLES/panel-install.mcap -o /dev/stdout",
    ] {
        assert!(hydrotrace(path, words).stdout == plain, "{words}");
    }
    for (words, start) in [
        ("report SAMPLES/panel-install.mcap --json -o -", "{"),
        ("compare SAMPLES/task-1-run.mcap SAMPLES/precompensated-run.mcap --json -o -", "{"),
        ("export SAMPLES/panel-install.mcap --csv -o -", "stamp_ns,"),
        (&format!("{TIMES} --json -o -"), "{"),
    ] {
        let (code, text, error) = said(&hydrotrace(path, words));
        assert_eq!(code, 0, "{words}: {error}");
        assert!(text.starts_with(start), "{words}: {text}");
    }
    for words in [
        "import SAMPLES/plc-trace.csv -o -",
        "import SAMPLES/plc-trace.csv -o /dev/stdout",
        "recover SAMPLES/power-loss.mcap -o -",
        "export SAMPLES/panel-install.mcap --parquet -o -",
        "fit SAMPLES/task-1-run.mcap -o -",
        "excite -o - --task SAMPLES/tasks/task-1.toml",
        &format!("{TIMES} -o -"),
    ] {
        let (code, text, error) = said(&hydrotrace(path, words));
        assert_eq!((code, text.as_str()), (2, ""), "{words}: {error}");
        assert!(error.contains("standard output is for text"), "{words}: {error}");
    }
    assert_eq!(fs::read_dir(path).unwrap().count(), 0, "a file was made");
}

#[test]
fn a_log_is_not_written_under_the_name_of_another_form() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for (words, named) in [
        ("replan SAMPLES/task-1-run.mcap --keep-plan -o next.json", "next.mcap"),
        ("simulate SAMPLES/task-1-run.mcap -o run.csv", "run.mcap"),
        ("join SAMPLES/panel-install.mcap --plan SAMPLES/task-1-run.mcap -o both.db3", "both.mcap"),
        (&format!("{TIMES} -o plan.toml"), "plan.mcap"),
    ] {
        let (code, text, error) = said(&hydrotrace(path, words));
        assert_eq!((code, text.as_str()), (2, ""), "{words}: {error}");
        assert!(error.contains(&format!("is an MCAP log; name it {named}")), "{words}: {error}");
    }
    assert_eq!(fs::read_dir(path).unwrap().count(), 0, "a file was made");
}

#[test]
fn devices_and_pipes_are_written_to_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    assert_eq!(said(&hydrotrace(path, &format!("{REPORT} -o /dev/null"))), (0, String::new(), String::new()));
    assert!(Command::new("mkfifo").arg(path.join("pipe")).status().unwrap().success());
    let read = tempfile::tempfile().unwrap();
    let into = read.try_clone().unwrap();
    let mut reader = Command::new("cat").arg("pipe").current_dir(path).stdout(into).spawn().unwrap();
    let (code, _, error) = said(&hydrotrace(path, "export SAMPLES/panel-install.mcap --csv -o pipe"));
    assert_eq!(code, 0, "{error}");
    assert!(reader.wait().unwrap().success());
    let read = contents(read);
    assert!(read == hydrotrace(path, "export SAMPLES/panel-install.mcap --csv").stdout);
    assert_eq!(fs::read_dir(path).unwrap().count(), 1, "the pipe was replaced");
}

#[test]
fn what_cannot_be_written_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for words in [REPORT, "import SAMPLES/plc-trace.csv", "recover SAMPLES/power-loss.mcap", TIMES] {
        let (code, _, error) = said(&hydrotrace(path, &format!("{words} -o nodir/x.out")));
        assert_eq!(code, 1, "{words}");
        assert!(error.contains("nodir/x.out") && error.contains("no folder nodir"), "{words}: {error}");
        assert!(!error.contains("partial"), "{words}: {error}");
    }
    for words in [REPORT, "import SAMPLES/plc-trace.csv", "export SAMPLES/panel-install.mcap --csv"] {
        let (code, _, error) = said(&hydrotrace(path, &format!("{words} -o /dev/full")));
        assert_eq!(code, 1, "{words}");
        let expected = "error: cannot write /dev/full\n  because: No space left on device";
        assert!(error.contains(expected), "{words}: {error}");
    }
    let (code, _, error) = said(&hydrotrace(path, &format!("{REPORT} -o .")));
    assert!(code == 1 && error.contains(". is a folder"), "{error}");
}

#[cfg(unix)]
#[test]
fn a_link_to_a_file_that_is_not_there_yet_stays_a_link() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::create_dir(path.join("far")).unwrap();
    symlink("far/run.mcap", path.join("near")).unwrap();
    symlink("near", path.join("nearer")).unwrap();
    symlink("nodir/run.mcap", path.join("lost")).unwrap();
    symlink("round", path.join("round")).unwrap();
    let (code, _, error) = said(&hydrotrace(path, "import SAMPLES/plc-trace.csv -o nearer --force"));
    assert!(code != 1 && path.join("far/run.mcap").is_file(), "{error}");
    assert!(path.join("near").is_symlink() && path.join("nearer").is_symlink());
    let (code, _, error) = said(&hydrotrace(path, "import SAMPLES/plc-trace.csv -o lost --force"));
    assert!(code == 1 && error.contains("cannot write lost") && error.contains("no folder nodir"), "{error}");
    let (code, _, error) = said(&hydrotrace(path, "import SAMPLES/plc-trace.csv -o round --force"));
    assert!(code == 1 && error.contains("round") && error.contains("symbolic links"), "{error}");
    assert!(path.join("lost").is_symlink() && path.join("round").is_symlink());
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_takes_no_file_is_named_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let (code, _, error) = said(&hydrotrace(path, "import SAMPLES/plc-trace.csv -o /sys/x.mcap"));
    assert!(code == 1 && error.contains("cannot write /sys/x.mcap"), "{error}");
    assert!(error.contains("give the output a name in another folder"), "{error}");
    let (_, _, error) = said(&hydrotrace(path, "import SAMPLES/plc-trace.csv -o /dev/full"));
    assert!(error.contains("make room"), "{error}");
    let table = fs::read(samples().join("plc-trace.csv")).unwrap();
    fs::write(path.join("a.csv.zst"), zstd::encode_all(table.as_slice(), 1).unwrap()).unwrap();
    for (line, at) in [("report a.csv.zst", "nowhere"), ("import a.csv.zst -o b.mcap", "/sys")] {
        let (code, _, error) = said(&start(path, line).env("TMPDIR", at).output().unwrap());
        assert!(code == 1 && error.contains("a.csv.zst") && error.contains(at), "{line}: {error}");
        assert!(error.contains("set TMPDIR to a folder"), "{line}: {error}");
    }
    assert!(!path.join("b.mcap").exists());
}

#[test]
fn the_ending_of_a_file_says_the_form_unless_an_option_does() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let compare = "compare SAMPLES/task-1-run.mcap SAMPLES/precompensated-run.mcap";
    let export = "export SAMPLES/panel-install.mcap";
    for (words, file, start) in [
        (REPORT, "a.html", "<!DOCTYPE html>"),
        (REPORT, "a.JSON", "{"),
        (REPORT, "a.csv", "run,joint,"),
        (REPORT, "a.md", "#"),
        (REPORT, "a.txt", "panel-install.mcap\nrun "),
        ("report SAMPLES/panel-install.mcap --json", "b.html", "{"),
        (compare, "c.html", "<!DOCTYPE html>"),
        (compare, "c.json", "{"),
        (compare, "c.md", "#"),
        (TIMES, "d.html", "<!DOCTYPE html>"),
        (TIMES, "d.json", "{"),
        ("fit SAMPLES/task-1-run.mcap", "e.json", "{"),
        (export, "f.csv", "stamp_ns,"),
        (export, "f.parquet", "PAR1"),
        ("export SAMPLES/panel-install.mcap --csv", "g.parquet", "stamp_ns,"),
    ] {
        let (code, _, error) = said(&hydrotrace(path, &format!("{words} -o {file}")));
        assert!(code == 0 || code == 3 || code == 4, "{words} -o {file}: {error}");
        let bytes = fs::read(path.join(file)).unwrap();
        let found = String::from_utf8_lossy(&bytes[..40.min(bytes.len())]).into_owned();
        assert!(bytes.starts_with(start.as_bytes()), "{words} -o {file}: {found}");
    }
    let (code, _, error) = said(&hydrotrace(path, &format!("{export} -o x.txt")));
    assert!(code == 2 && error.contains("--csv or --parquet"), "{error}");
}
