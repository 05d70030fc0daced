//! `completions`

use clap::CommandFactory;
use clap_complete::Shell;

use super::{CliError, Outcome, Run, console::Console};

const EXAMPLES: &str = "\
Examples:
  hydrotrace completions bash > ~/.local/share/bash-completion/completions/hydrotrace
  hydrotrace completions zsh > ~/.zfunc/_hydrotrace
  hydrotrace completions fish > ~/.config/fish/completions/hydrotrace.fish";

/// Print the completions of a shell
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// The shell
    shell: Shell,
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut super::Args::command(), "hydrotrace", &mut script);
        console.print(&String::from_utf8_lossy(&script))?;
        Ok(Outcome::Clean)
    }
}
