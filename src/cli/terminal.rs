//! Colours and the log of a run, for the whole program.

use std::{
    borrow::Cow,
    ffi::OsString,
    fmt::Write as _,
    io::{self, Write},
};

use anstream::{AutoStream, ColorChoice};
use anstyle::{AnsiColor, Style};
use clap::ArgAction;
use log::{Level, LevelFilter};

use crate::text;

/// Starts a line on a failure.
pub(super) const FAILED: Style = AnsiColor::Red.on_default().bold();
/// Starts a line on a doubt.
pub(super) const DOUBT: Style = AnsiColor::Yellow.on_default();

/// Colours, and how much is said besides results.
#[derive(Debug, Clone, Copy, clap::Args)]
#[command(next_help_heading = "Terminal")]
pub(super) struct TerminalArgs {
    /// Colours: auto (on a terminal, unless `NO_COLOR` is set), always or never
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto", hide_default_value = true)]
    #[arg(hide_possible_values = true)]
    color: clap::ColorChoice,

    /// Print only results and errors
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub(super) quiet: bool,

    /// Print what is read, chosen and found; twice for more
    #[arg(short, long, global = true, action = ArgAction::Count)]
    verbose: u8,
}

/// The colour choice before arguments are parsed, for help and usage errors.
pub(super) fn early_choice(words: impl IntoIterator<Item = OsString>) -> clap::ColorChoice {
    let words: Vec<String> = words.into_iter().map(|word| word.to_string_lossy().into_owned()).collect();
    let apart = words.iter().zip(words.iter().skip(1)).filter(|(name, _)| *name == "--color");
    let joined = words.iter().filter_map(|word| word.strip_prefix("--color="));
    let last = apart.map(|(_, value)| value.as_str()).chain(joined).last();
    last.and_then(|value| value.parse().ok()).unwrap_or_default()
}

/// Sets the colours of standard output and starts the log; returns the colour choice for standard error.
pub(super) fn set_up(args: TerminalArgs) -> ColorChoice {
    let choice = match args.color {
        clap::ColorChoice::Auto => ColorChoice::Auto,
        clap::ColorChoice::Always => ColorChoice::Always,
        clap::ColorChoice::Never => ColorChoice::Never,
    };
    let of = |choice, auto| if choice == ColorChoice::Auto { auto } else { choice };
    of(choice, AutoStream::choice(&io::stdout())).write_global();
    let level = match (args.quiet, args.verbose) {
        (true, _) => LevelFilter::Off,
        (false, 0) => LevelFilter::Warn,
        (false, 1) => LevelFilter::Info,
        (false, _) => LevelFilter::Debug,
    };
    // A second start, as in tests, keeps the first log.
    let _ = env_logger::Builder::new()
        .filter_module("hydrotrace", level)
        .format(|out, record| {
            let word = if record.level() <= Level::Info { "info" } else { "debug" };
            writeln!(out, "{word}: {}", harmless(&record.args().to_string()))
        })
        .try_init();
    log::set_max_level(level);
    of(choice, AutoStream::choice(&io::stderr()))
}

/// Digits in a row that no number in a message needs.
const MOST_DIGITS: usize = 40;
/// Of these, shown.
const SHOWN_DIGITS: usize = 6;

/// Text from logs without characters that could steer a terminal, and without endless numbers.
pub(super) fn harmless(text: &str) -> String {
    let line = |c| if c == '\n' { c } else { text::harmless(c) };
    with_short_numbers(text).chars().map(line).collect()
}

/// With numbers of hundreds of digits cut short.
fn with_short_numbers(text: &str) -> Cow<'_, str> {
    let is_digit = |c: char| c.is_ascii_digit();
    if !text.as_bytes().windows(MOST_DIGITS + 1).any(|run| run.iter().all(u8::is_ascii_digit)) {
        return text.into();
    }
    let (mut out, mut rest) = (String::new(), text);
    while let Some(start) = rest.find(is_digit) {
        let (before, from) = rest.split_at(start);
        let (digits, after) = from.split_at(from.find(|c| !is_digit(c)).unwrap_or(from.len()));
        out.push_str(before);
        if digits.len() > MOST_DIGITS {
            // Writing to memory does not fail.
            let _ = write!(out, "{}... ({} digits)", &digits[..SHOWN_DIGITS], digits.len());
        } else {
            out.push_str(digits);
        }
        rest = after;
    }
    (out + rest).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_hundreds_of_digits_are_cut() {
        let long = format!("found {}, 12 expected", 1e300);
        assert_eq!(with_short_numbers(&long), "found 100000... (301 digits), 12 expected");
        assert_eq!(with_short_numbers("1760000000000000000 ns"), "1760000000000000000 ns");
    }

    #[test]
    fn the_last_choice_of_colours_is_the_one_that_holds() {
        let choice = |words: &str| early_choice(words.split_whitespace().map(OsString::from));
        assert_eq!(choice("hydrotrace report a.mcap"), clap::ColorChoice::Auto);
        assert_eq!(choice("hydrotrace --color never report"), clap::ColorChoice::Never);
        assert_eq!(choice("hydrotrace report --color=always"), clap::ColorChoice::Always);
        assert_eq!(choice("hydrotrace report --color"), clap::ColorChoice::Auto);
        assert_eq!(choice("hydrotrace report --color sometimes"), clap::ColorChoice::Auto);
    }
}
