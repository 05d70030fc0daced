//! What is said besides results, and what helps at a prompt.

use std::path::PathBuf;

use clap::{ArgAction, ColorChoice};
use clap_complete::Shell;

pub(super) const COMPLETIONS: &str = "Examples:\n  \
    hydrotrace completions bash > ~/.local/share/bash-completion/completions/hydrotrace\n  \
    hydrotrace completions zsh > ~/.zfunc/_hydrotrace\n  \
    hydrotrace completions fish > ~/.config/fish/completions/hydrotrace.fish";

pub(super) const MANUAL: &str =
    "Examples:\n  hydrotrace man ~/.local/share/man/man1\n  man hydrotrace-report";

/// What is said besides results.
#[derive(Debug, Clone, Copy, clap::Args)]
#[command(next_help_heading = "Terminal")]
pub struct TerminalArgs {
    /// Colours: auto (on a terminal, unless `NO_COLOR` is set), always or never
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto", hide_default_value = true)]
    #[arg(hide_possible_values = true)]
    pub color: ColorChoice,

    /// Say nothing but results and errors
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,

    /// Say what is read, chosen and found on the way; twice for more
    #[arg(short, long, global = true, action = ArgAction::Count)]
    pub verbose: u8,
}

/// Arguments of `completions`.
#[derive(Debug, clap::Args)]
pub struct CompletionsArgs {
    /// The shell
    pub shell: Shell,
}

/// Arguments of `man`.
#[derive(Debug, clap::Args)]
pub struct ManArgs {
    /// Folder to write to; made if there is none
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use crate::cli::Args;

    #[test]
    fn every_verb_is_one_line_on_a_narrow_terminal_in_the_order_of_the_work() {
        let order = [
            "demo",
            "report",
            "compare",
            "plan",
            "simulate",
            "fit",
            "excite",
            "replan",
            "join",
            "import",
            "export",
            "info",
            "recover",
            "view",
            "completions",
            "man",
        ];
        let command = Args::command();
        let mut last = 0;
        for verb in command.get_subcommands() {
            let place = order.iter().position(|name| *name == verb.get_name()).unwrap();
            assert!(place >= last, "{} comes too late", verb.get_name());
            last = place;
            let about = verb.get_about().unwrap().to_string();
            assert!(about.len() <= 80 - "  completions  ".len(), "{about}");
        }
    }
}
