//! Commands that a reader can paste into a shell.

use std::path::Path;

/// A word as a POSIX shell takes it: quoted if it holds anything but plain characters.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "._-/+:@%=,".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

/// A path as an argument; a name that starts with a dash would be taken for an option.
pub fn argument(path: impl AsRef<Path>) -> String {
    let text = path.as_ref().to_string_lossy();
    quoted(&if text.starts_with('-') { format!("./{text}") } else { text.into_owned() })
}

/// `hydrotrace` with these words; each is an option or from [`argument`].
pub fn command(words: &[&str]) -> String {
    format!("hydrotrace {}", words.join(" "))
}

#[cfg(test)]
mod tests {
    use super::argument;

    #[test]
    fn a_shell_takes_every_path_as_one_word() {
        for (path, word) in [
            ("a/run-1.mcap", "a/run-1.mcap"),
            ("my run.mcap", "'my run.mcap'"),
            ("it's 1.mcap", "'it'\\''s 1.mcap'"),
            ("$HOME;rm", "'$HOME;rm'"),
            ("-o", "./-o"),
            ("", "''"),
        ] {
            assert_eq!(argument(path), word);
        }
    }
}
