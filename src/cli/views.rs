//! Options of `export` for programs that open the log itself.

use std::path::{Path, PathBuf};

use super::{
    CliError, Outcome,
    console::{Console, Form, Target, spare_for_file, spare_inputs, write_file},
};
use crate::{
    document::pretty,
    render::export as words,
    workflow::export::{For, Inputs, charts},
};

/// What a table has and a view has not.
const OF_TABLES: [&str; 4] = ["output", "csv", "parquet", "degrees"];

/// Views of the log in other programs.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Views of the log itself, in place of a table")]
pub(super) struct ViewArgs {
    /// Write a layout that Foxglove and Lichtblick import: plots of each joint, and the arm
    #[arg(long, value_name = "FILE.json", conflicts_with_all = OF_TABLES)]
    foxglove_layout: Option<PathBuf>,

    /// Write a blueprint for `rerun LOG FILE.rbl`, with the same plots
    #[arg(long, value_name = "FILE.rbl", conflicts_with_all = OF_TABLES)]
    rerun_blueprint: Option<PathBuf>,
}

impl ViewArgs {
    pub(super) fn are_asked(&self) -> bool {
        self.foxglove_layout.is_some() || self.rerun_blueprint.is_some()
    }

    pub(super) fn write(&self, inputs: &Inputs, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        spare_inputs(self.foxglove_layout.as_deref(), &inputs.logs)?;
        spare_for_file(self.rerun_blueprint.as_deref(), &inputs.logs)?;
        let asked = [(&self.foxglove_layout, For::Foxglove), (&self.rerun_blueprint, For::Rerun)];
        if self.foxglove_layout == self.rerun_blueprint {
            return Err(CliError::Usage("one file cannot be both a layout and a blueprint".to_owned()));
        }
        #[cfg(not(feature = "viewer"))]
        if self.rerun_blueprint.is_some() {
            return Err(CliError::failed(super::view::NO_VIEWER));
        }
        let programs: Vec<For> =
            asked.iter().filter(|(file, _)| file.is_some()).map(|(_, program)| *program).collect();
        let found = charts(inputs, &programs)?;
        let mut said = String::new();
        if let Some(file) = &self.foxglove_layout {
            let layout = pretty(&words::foxglove(&found));
            match Target::new(Form::Json, Some(file))?.file {
                None => console.print(&layout)?,
                Some(file) => {
                    write_file(file, layout.as_bytes())?;
                    said += &words::foxglove_written(file);
                }
            }
        }
        if let Some(file) = &self.rerun_blueprint {
            write_blueprint(&found, file)?;
            said += &words::rerun_written(&inputs.logs, file);
        }
        // As of JSON: remarks go beside it.
        console.finish(&Target::stdout(true), &said, &found.remarks, &[])
    }
}

#[cfg(feature = "viewer")]
fn write_blueprint(found: &crate::workflow::export::Charts, file: &Path) -> Result<(), CliError> {
    Ok(crate::viewer::write_blueprint(found, file)?)
}

#[cfg(not(feature = "viewer"))]
fn write_blueprint(_: &crate::workflow::export::Charts, _: &Path) -> Result<(), CliError> {
    Err(CliError::failed(super::view::NO_VIEWER))
}
