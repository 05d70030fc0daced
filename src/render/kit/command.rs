//! Commands that a reader can paste into a shell.

pub(crate) use crate::text::shell_argument as argument;

/// `hydrotrace` with these words; each is an option or from [`argument`].
pub(crate) fn command(words: &[&str]) -> String {
    format!("hydrotrace {}", words.join(" "))
}
