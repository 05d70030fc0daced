//! Commands that a reader can paste into a shell.

use std::path::Path;

use crate::text::shell_argument;
pub(crate) use crate::text::shell_word as word;

/// A path as an argument; what came from standard input has no name to give again.
pub(crate) fn argument(path: impl AsRef<Path>) -> String {
    if path.as_ref() == Path::new("-") { "RUN.mcap".to_owned() } else { shell_argument(path) }
}

/// `hydrotrace` with these words; each is an option or from [`argument`].
pub(crate) fn command(words: &[&str]) -> String {
    format!("hydrotrace {}", words.join(" "))
}

/// Verbs that take the options on what to read of a log.
pub(crate) const READERS: [&str; 9] =
    ["answer", "compare", "export", "fit", "info", "replan", "report", "view", "watch"];

/// Of these, those on how joints, units, columns and clock are recorded: they hold for the recorder's next log, too.
const OF_RECORDER: [&str; 6] =
    ["--continuous", "--slides", "--planned-degrees", "--measured-degrees", "--time", "--map"];

/// Those that leave something out.
const LEAVE_OUT: [&str; 2] = ["--from ", "--to "];

/// A command with the options on what to read, where its verb takes them.
pub(crate) fn reading(line: &str, options: &[String]) -> String {
    let verb = line.split(' ').nth(1).unwrap_or_default();
    let of_recorder = |option: &&String| OF_RECORDER.iter().any(|one| option.starts_with(one));
    let taken: Vec<&str> = match verb {
        "join" if line.contains(" --plan ") => {
            options.iter().filter(of_recorder).map(String::as_str).collect()
        }
        // A plan of ours, whose topics are not those of the logs.
        "export" if line.contains("--as cylinders") => {
            options.iter().filter(|option| option.starts_with("--hydraulics")).map(String::as_str).collect()
        }
        // All of the files is joined.
        "join" => {
            let leaves_out = |option: &&String| LEAVE_OUT.iter().any(|one| option.starts_with(one));
            options.iter().filter(|option| !leaves_out(option)).map(String::as_str).collect()
        }
        _ if READERS.contains(&verb) => {
            // What a line says itself counts.
            let said = |option: &&String| {
                line.contains(&format!(" {} ", option.split([' ', '=']).next().unwrap_or_default()))
            };
            options.iter().filter(|option| !said(option)).map(String::as_str).collect()
        }
        _ => Vec::new(),
    };
    [line].into_iter().chain(taken).collect::<Vec<_>>().join(" ")
}
