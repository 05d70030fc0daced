//! `man`

use std::path::{Path, PathBuf};

use clap::{Command, CommandFactory};
use clap_mangen::Man;

use super::{
    CliError, Outcome, Run,
    console::{Console, make_folder, write_file},
};

/// Write a manual page for each verb
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  hydrotrace man ~/.local/share/man/man1\n  man hydrotrace-report")]
pub(super) struct Args {
    /// Folder to write to; it is made if needed
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        make_folder(&self.folder)?;
        let mut root = super::Args::command();
        root.build();
        let pages = write_pages(&root, &self.folder)?;
        console.print(&format!("{pages} pages written to {}.\n", self.folder.display()))?;
        Ok(Outcome::Clean)
    }
}

/// Writes the page of a command and those of its subcommands; returns their number.
fn write_pages(command: &Command, folder: &Path) -> Result<usize, CliError> {
    let man = Man::new(command.clone());
    let mut page = Vec::new();
    man.render(&mut page)?;
    write_file(&folder.join(man.get_filename()), &page)?;
    let below = command.get_subcommands().filter(|one| !one.is_hide_set() && one.get_name() != "help");
    below.map(|one| write_pages(one, folder)).sum::<Result<usize, _>>().map(|pages| pages + 1)
}
