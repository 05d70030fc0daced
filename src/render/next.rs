//! What was written, and the commands that come next.

use std::path::{Path, PathBuf};

use super::kit::{Block, Id, Section, Sentence, argument, command};

fn written(file: &str) -> Section {
    Section::plain(Id::NEXT, [Sentence::finding(format!("Written to {file}."))])
}

fn step(section: Section, aim: &str, words: &[&str]) -> Section {
    section.with(Sentence::advice(aim)).with(Block::Command(command(words)))
}

/// After a plan that breaks limits was written all the same.
pub(crate) fn broken_written(log: &Path) -> Section {
    written(&argument(log))
        .with(Sentence::finding("It breaks limits, as told above: to look at, not to send."))
}

/// After `plan`; `of_sample_arm`: whether the machines that `simulate` knows by name have its joints.
pub(crate) fn plan_written(log: &Path, of_sample_arm: bool) -> Section {
    // The run has another name than the plan.
    let run = if log.file_name().is_some_and(|name| name == "run.mcap") { "run-2.mcap" } else { "run.mcap" };
    let log = argument(log);
    if of_sample_arm {
        let aim = "To run it on a simulated machine:";
        return step(written(&log), aim, &["simulate", &log, "-o", run]);
    }
    let aim = "To send it as a table, where the trajectory in it is not what the controller takes:";
    let sent = step(written(&log), aim, &["export", &log, "-o", "plan.csv"]);
    let aim = "After the run, to put the plan into the recorder's log:";
    step(sent, aim, &["join", "RUN.mcap", "--plan", &log, "-o", run])
}

/// After `fit`; `trusted` says that a command can be made for a joint, `corrected` that one was sent already. `logs` are the runs of
/// the plan to plan again, or the one to look at; `why_none` says why there is none.
pub(crate) fn limits_written(
    limits: &Path,
    logs: &[&PathBuf],
    why_none: Option<&str>,
    [trusted, corrected]: [bool; 2],
) -> Section {
    let limits = argument(limits);
    let written = match why_none {
        Some(why) => written(&limits).with(Sentence::finding(format!("No command is made from {why}."))),
        None => written(&limits),
    };
    let logs: Vec<String> = logs.iter().map(argument).collect();
    let logs = if logs.is_empty() { "RUN.mcap".to_owned() } else { logs.join(" ") };
    if !trusted {
        let aim = "No joint is predicted well enough for a command. To see how each followed its plan:";
        return step(written, aim, &["report", &logs]);
    }
    let from = if why_none.is_some() { " from another log" } else { "" };
    let again = ["replan", &logs, "--limits", &limits];
    if corrected {
        return step(
            written,
            "To learn the next run from these:",
            &[&again[..], &["-o", "next.mcap"]].concat(),
        );
    }
    let aim = &format!("To plan the next run{from}, with half of the correction at first:");
    step(written, aim, &[&again[..], &["--gain", "0.5", "-o", "next.mcap"]].concat())
}

/// Command lines of a `replan`, in parts.
pub(crate) struct Words<'a> {
    /// Those of the line itself, without what says how much is sent and where it goes.
    pub(crate) again: &'a [String],
    /// Options by which the logs were read.
    pub(crate) reading: &'a [String],
    /// Options of what may change.
    pub(crate) changing: &'a [String],
}

/// What to type before and after a run. Where half of a correction is to go first, `half`, it is made first, and all lines after
/// it are of that command.
pub(crate) fn to_send(next: Option<&Path>, logs: &[PathBuf], words: &Words, half: bool) -> Section {
    let made = |aim, more: &[&str]| {
        let none = Section::new(Id::NEXT, "Commands", std::iter::empty::<Block>());
        let words: Vec<&str> = words.again.iter().map(String::as_str).chain(more.iter().copied()).collect();
        step(none, aim, &words)
    };
    let named = next.map(argument);
    let (section, next) = match named {
        named if half => {
            let careful = unused("careful", 1, logs, named.as_deref().unwrap_or_default());
            let aim = "To send half of the correction first, the careful step:";
            (made(aim, &["--gain", "0.5", "-o", &careful]), careful)
        }
        Some(named) => (Section::new(Id::NEXT, "Commands", std::iter::empty::<Block>()), named),
        None => (made("To write plan and command to a file:", &["-o", "next.mcap"]), "next.mcap".to_owned()),
    };
    let none = Section::plain(Id::NEXT, std::iter::empty::<Block>());
    let after = after_run(none, &next, logs, (words.reading, words.changing)).reading(words.reading);
    section.with_all(after.blocks)
}

/// The same below a result that was written to a file.
pub(crate) fn next_written(next: &Path, logs: &[PathBuf], words: &Words, half: bool) -> Section {
    written(&argument(next)).with_all(to_send(Some(next), logs, words, half).blocks)
}

fn after_run(
    section: Section,
    next: &str,
    logs: &[PathBuf],
    (reading, changing): (&[String], &[String]),
) -> Section {
    let last = logs.last().map_or("RUN.mcap".to_owned(), argument);
    // Where lengths of cylinders are logged the plan is in angles all the same.
    let of_cylinders = reading.iter().any(|option| option.starts_with("--hydraulics"))
        && !reading.iter().any(|option| option == "--as cylinders");
    let lengths = format!("{}-lengths.csv", next.trim_end_matches(".mcap"));
    let (section, plan) = if of_cylinders {
        let aim = "To send it, and to put it beside the recorder's log, as lengths of cylinders:";
        (step(section, aim, &["export", next, "--as", "cylinders", "-o", &lengths]), lengths.as_str())
    } else {
        (section, next)
    };
    let aim = "After the run, to put the plan into the recorder's log:";
    let after = unused("after", 1, logs, next);
    let joined = step(section, aim, &["join", "RUN.mcap", "--plan", plan, "-o", &after]);
    let compared = step(joined, "To see whether the error became smaller:", &["compare", &last, &after]);
    let mut words: Vec<String> = vec!["replan".to_owned()];
    words.extend(logs.iter().map(argument));
    words.push(after);
    words.extend(changing.iter().cloned());
    words.extend(["-o".to_owned(), unused("next", logs.len() + 1, logs, next)]);
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    step(compared, "To learn from it too, until nothing more is to be gained:", &words)
}

/// A name of a log with a number, the first without one, that is none of the logs and not `next`.
fn unused(name: &str, from: usize, logs: &[PathBuf], next: &str) -> String {
    let numbered = |k: usize| if k == 1 { format!("{name}.mcap") } else { format!("{name}-{k}.mcap") };
    let taken = |file: &String| file == next || logs.iter().any(|log| argument(log) == *file);
    // One more than may be taken.
    (from..=from + logs.len() + 1).map(numbered).find(|file| !taken(file)).unwrap_or_default()
}

/// A run as one argument, and the line that makes one log of its files where they are several: most verbs take each for a run
/// of its own.
pub(super) fn as_one(files: &[PathBuf]) -> (Option<String>, String) {
    if let [one] = files {
        return (None, argument(one));
    }
    let names: Vec<String> = files.iter().map(argument).collect();
    let taken = |name: &&str| files.iter().any(|file| file.file_name().is_some_and(|file| *file == **name));
    let one = ["whole.mcap", "run.mcap", "joined.mcap"].into_iter().find(|name| !taken(name));
    let one = one.unwrap_or("whole-run.mcap");
    (Some(command(&["join", &names.join(" "), "-o", one])), one.to_owned())
}

/// After one side of a run was written without the other.
pub(super) fn plan_missing(section: Section, parts: &[impl AsRef<Path>]) -> Section {
    let parts: Vec<String> = parts.iter().map(argument).collect();
    let aim = "A report needs both sides. To put the plan beside the measurement:";
    step(section, aim, &["join", &parts.join(" "), "--plan", "PLAN.mcap", "-o", "with-plan.mcap"])
}

/// After a run was written, or the parts of one.
pub(super) fn report(section: Section, parts: &[impl AsRef<Path>]) -> Section {
    let parts: Vec<String> = parts.iter().map(argument).collect();
    step(section, "To see how the arm followed its plan:", &["report", &parts.join(" ")])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_printed_line_names_a_file_of_another_line() {
        let said = |next: &str, logs: &[&str], half: bool| -> Vec<String> {
            let logs: Vec<PathBuf> = logs.iter().map(PathBuf::from).collect();
            let words = Words { again: &["replan".to_owned()], reading: &[], changing: &[] };
            let lines = next_written(Path::new(next), &logs, &words, half).blocks.into_iter();
            lines
                .filter_map(|block| if let Block::Command(line) = block { Some(line) } else { None })
                .collect()
        };
        let first = said("next.mcap", &["run.mcap"], false);
        assert_eq!(first[1], "hydrotrace compare run.mcap after.mcap");
        let second = said("next-2.mcap", &["run.mcap", "after.mcap"], false);
        assert_eq!(second[0], "hydrotrace join RUN.mcap --plan next-2.mcap -o after-2.mcap");
        assert_eq!(second[1], "hydrotrace compare after.mcap after-2.mcap");
        assert_eq!(second[2], "hydrotrace replan run.mcap after.mcap after-2.mcap -o next-3.mcap");
        assert!(said("next-2.mcap", &["run.mcap"], false)[2].ends_with("-o next-3.mcap"));
        let half = said("next.mcap", &["run.mcap"], true);
        assert_eq!(half[0], "hydrotrace replan --gain 0.5 -o careful.mcap");
        assert!(
            half[1].contains("--plan careful.mcap ") && !half[1..].join(" ").contains(" next.mcap"),
            "{half:?}"
        );
    }
}
