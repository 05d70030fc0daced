//! `man`: a manual page for the program and for each verb.

use std::{io::Write, path::Path};

use clap::{Command, CommandFactory};
use clap_mangen::Man;

use super::{Args, CliError, Outcome, args::ManArgs};
use crate::atomic_file::write_atomically;

pub(super) fn run(args: &ManArgs, out: &mut impl Write) -> Result<Outcome, CliError> {
    let folder = &args.folder;
    std::fs::create_dir_all(folder).map_err(|source| CliError::Folder { path: folder.clone(), source })?;
    let mut root = Args::command();
    root.build();
    let pages = write_pages(&root, folder)?;
    writeln!(out, "{pages} pages written to {}.", folder.display())?;
    Ok(Outcome::Clean)
}

/// Writes the page of a command and those of all below it; returns how many.
fn write_pages(command: &Command, folder: &Path) -> Result<usize, CliError> {
    let man = Man::new(command.clone());
    let mut page = Vec::new();
    man.render(&mut page)?;
    write_atomically(&folder.join(man.get_filename()), |file| Ok::<(), CliError>(file.write_all(&page)?))?;
    let below = command.get_subcommands().filter(|one| !one.is_hide_set() && one.get_name() != "help");
    below.map(|one| write_pages(one, folder)).sum::<Result<usize, _>>().map(|pages| pages + 1)
}
