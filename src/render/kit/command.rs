//! Commands that a reader can paste into a shell.

pub(crate) use crate::text::{shell_argument as argument, shell_word as word};

/// `hydrotrace` with these words; each is an option or from [`argument`].
pub(crate) fn command(words: &[&str]) -> String {
    format!("hydrotrace {}", words.join(" "))
}

/// Verbs that take the options on what to read of a log.
pub(crate) const READERS: [&str; 9] =
    ["answer", "compare", "export", "fit", "info", "replan", "report", "view", "watch"];

/// A command with the options on what to read, where its verb takes them.
pub(crate) fn reading(line: &str, options: &[String]) -> String {
    let reads = line.split(' ').nth(1).is_some_and(|verb| READERS.contains(&verb));
    if options.is_empty() || !reads { line.to_owned() } else { format!("{line} {}", options.join(" ")) }
}
