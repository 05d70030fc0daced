//! The built binary at a prompt: colours, what is said besides results, completions, manual pages.

use std::process::Command;

use crate::support::{command, root, run_at_root as hydrotrace, stderr, stdout};

const CLEAN: &str = "sample-logs/panel-install.mcap";
const DOUBTFUL: &str = "sample-logs/gaps.mcap";
const ESCAPE: char = '\u{1b}';

#[test]
fn a_pipe_gets_no_colour_unless_it_is_asked_for() {
    let args = ["report", CLEAN, "--max-rms-deg", "0.3"];
    let plain = hydrotrace(&args);
    assert!(!stdout(&plain).contains(ESCAPE) && !stderr(&plain).contains(ESCAPE));
    let coloured = hydrotrace(&[&args[..], &["--color", "always"]].concat());
    assert!(stdout(&coloured).contains("\u{1b}[31mNOT KEPT\u{1b}[0m"), "{}", stdout(&coloured));
    assert!(stderr(&coloured).starts_with("\u{1b}[1m\u{1b}[31mgate:\u{1b}[0m "), "{}", stderr(&coloured));
    let forced = command(root()).args(args).env("CLICOLOR_FORCE", "1").output().unwrap();
    assert_eq!((forced.stdout, forced.stderr), (coloured.stdout.clone(), coloured.stderr));
    let refused =
        command(root()).args(args).env("CLICOLOR_FORCE", "1").env("NO_COLOR", "1").output().unwrap();
    assert_eq!(refused.stdout, plain.stdout);
    let never = command(root()).args(args).arg("--color=never").env("CLICOLOR_FORCE", "1").output();
    assert_eq!(never.unwrap().stdout, plain.stdout);
}

#[test]
fn files_and_data_hold_no_colour_even_where_it_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("report.txt");
    let name = file.to_str().unwrap();
    hydrotrace(&["report", DOUBTFUL, "-o", name, "--color", "always"]);
    let printed = stdout(&hydrotrace(&["report", DOUBTFUL]));
    assert_eq!(std::fs::read_to_string(&file).unwrap(), printed + "\nWritten by hydrotrace.\n");
    for format in ["--json", "--csv", "--markdown"] {
        let run = hydrotrace(&["report", DOUBTFUL, format, "--color", "always"]);
        assert!(!stdout(&run).contains(ESCAPE), "{format}");
    }
}

#[test]
fn an_error_starts_red_on_a_terminal_and_what_a_name_holds_steers_nothing() {
    let run = hydrotrace(&["report", "no-such\u{1b}[2J.mcap", "--color", "always"]);
    assert_eq!(run.status.code(), Some(1));
    let said = stderr(&run);
    assert!(
        said.starts_with("\u{1b}[1m\u{1b}[31merror:\u{1b}[0m cannot open no-such\u{fffd}[2J"),
        "{said:?}"
    );
}

#[test]
fn quiet_says_nothing_but_errors_and_changes_no_result() {
    let loud = hydrotrace(&["report", DOUBTFUL, "--json", "--max-rms-deg", "0.001"]);
    let quiet = hydrotrace(&["report", DOUBTFUL, "--json", "--max-rms-deg", "0.001", "--quiet"]);
    assert!(stderr(&loud).contains("remark: ") && stderr(&loud).contains("gate: "), "{}", stderr(&loud));
    assert_eq!(stderr(&quiet), "");
    assert_eq!((quiet.status.code(), quiet.stdout), (loud.status.code(), loud.stdout));
    assert!(stderr(&hydrotrace(&["-q", "report", "no-such.mcap"])).starts_with("error: "));
    assert_eq!(hydrotrace(&["report", CLEAN, "-q", "-v"]).status.code(), Some(2));
}

#[test]
fn verbose_tells_what_was_read_and_chosen_and_changes_no_result() {
    let plain = hydrotrace(&["report", CLEAN]);
    let told = hydrotrace(&["report", CLEAN, "-v"]);
    assert_eq!(plain.stdout, told.stdout);
    let said = stderr(&told);
    for event in [
        "info: opened sample-logs/panel-install.mcap: ",
        "info: planned /planned/joint_states:position\n",
        "info: chosen: plan from /planned/joint_states, by its name",
        "info: clock header: ",
        "info: 6 joints aligned, ",
    ] {
        assert!(said.contains(event), "{event:?} not in {said}");
    }
    assert!(!said.contains("debug: "));
    let more = hydrotrace(&["-vv", "report", CLEAN]);
    assert!(stderr(&more).contains("debug: joint_1: 3993 samples aligned"), "{}", stderr(&more));
    assert_eq!(more.stderr, hydrotrace(&["-vv", "report", CLEAN]).stderr);
}

#[test]
fn names_that_were_meant_are_said_in_one_line() {
    for (args, meant) in [
        (&["report", CLEAN, "--planned", "/planed/joint_states"][..], "\"/planned/joint_states\""),
        (&["report", CLEAN, "--joints", "Joint_11"], "\"joint_1\""),
        (&["report", CLEAN, "--planned", "/planned/joint_states:positon"], "\"position\""),
        (&["simulate", CLEAN, "-o", "no-such/x.mcap", "--plant", "lag-limted"], "\"lag-limited\""),
    ] {
        let run = hydrotrace(args);
        assert_eq!(run.status.code(), Some(1), "{args:?}");
        let said = stderr(&run);
        let first = said.lines().next().unwrap();
        assert!(first.contains(&format!("did you mean {meant}?")), "{said}");
    }
}

#[test]
fn without_a_verb_the_help_is_said_as_bad_usage() {
    let run = hydrotrace(&[]);
    assert_eq!((run.status.code(), stdout(&run).as_str()), (Some(2), ""));
    let said = stderr(&run);
    let places: Vec<usize> = ["demo", "report", "compare", "plan", "import", "info", "man"]
        .iter()
        .map(|verb| said.find(&format!("\n  {verb} ")).unwrap())
        .collect();
    assert!(places.is_sorted(), "{said}");
}

#[cfg(unix)]
#[test]
fn a_reader_that_stops_early_is_success() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().to_str().unwrap();
    for args in [
        "--help",
        "report --help",
        "report sample-logs/panel-install.mcap --all",
        "report sample-logs/gaps.mcap --json",
        "info sample-logs/panel-install.mcap",
        "completions zsh",
        &format!("man {folder}"),
    ] {
        let script = format!("{{ \"$0\" {args}; echo $? >&2; }} | true");
        let run = Command::new("sh")
            .current_dir(root())
            .args(["-c", &script, env!("CARGO_BIN_EXE_hydrotrace")])
            .output()
            .unwrap();
        let said = stderr(&run);
        let code = said.lines().last().unwrap();
        // A short result may be written before its reader is gone.
        assert!(code == "0" || (code == "3" && args.contains("gaps")), "{args}: {said}");
        assert!(!said.contains("panicked") && !said.contains("error"), "{args}: {said}");
    }
}

#[test]
fn completions_name_every_verb_and_bash_reads_them() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let run = hydrotrace(&["completions", shell]);
        assert_eq!(run.status.code(), Some(0), "{shell}");
        for verb in ["report", "compare", "replan", "completions", "max-rms-deg"] {
            assert!(stdout(&run).contains(verb), "{shell} lacks {verb}");
        }
    }
    assert_eq!(hydrotrace(&["completions", "cmd"]).status.code(), Some(2));
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("hydrotrace.bash");
    std::fs::write(&script, hydrotrace(&["completions", "bash"]).stdout).unwrap();
    if let Ok(read) = Command::new("bash").arg("-n").arg(&script).output() {
        assert!(read.status.success(), "{}", stderr(&read));
    }
}

#[test]
fn every_verb_has_a_manual_page_and_stands_on_the_first() {
    let folder = tempfile::tempdir().unwrap();
    let pages = folder.path().join("share").join("man1");
    let run = hydrotrace(&["man", pages.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    let read = |name: &str| std::fs::read_to_string(pages.join(name)).unwrap();
    let first = read("hydrotrace.1");
    for verb in ["demo", "report", "compare", "plan", "simulate", "fit", "info", "man"] {
        assert!(first.contains(&format!("hydrotrace\\-{verb}(1)")), "{verb} is not on the first page");
        let page = read(&format!("hydrotrace-{verb}.1"));
        assert!(page.contains(".SH NAME") && page.contains(".SH SYNOPSIS"), "{page}");
    }
    assert!(read("hydrotrace-report.1").contains("max\\-rms\\-deg"));
}
