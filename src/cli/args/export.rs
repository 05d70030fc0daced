//! Arguments of `export`.

use std::path::PathBuf;

use super::{ReadArgs, ends, selector};
use crate::log::Selector;

pub(super) const EXAMPLES: &str = "\
Examples:
  hydrotrace export run.mcap -o run.csv
  hydrotrace export run.mcap -o run.parquet
  hydrotrace export run.mcap --csv --degrees --joints joint_3
  hydrotrace export next.mcap --csv --degrees -o next.csv

A row for every instant at which anything was sampled: stamp_ns (since 1970), time_s (since the
start), and for each joint J_planned_rad, J_planned_rad_s, J_measured_rad, J_command_rad and
J_error_rad, as far as the log has them: of what plan and replan write, plan and command. A cell
without a sample is empty. The error is planned minus measured, the plan interpolated. `hydrotrace
import` makes a log of the table again, of which a report has the same numbers.";

/// Arguments of `export`.
#[derive(Debug, clap::Args)]
pub struct ExportArgs {
    /// Logs of one run: MCAP files or ROS 2 bag directories
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,

    /// Form of the table.
    #[command(flatten)]
    pub format: ExportFormat,

    /// Write to FILE, of which .csv or .parquet say the form without an option; without FILE CSV goes to
    /// standard output
    #[arg(short, long, value_name = "FILE", required_unless_present = "csv")]
    pub output: Option<PathBuf>,

    /// Angles in degrees; the names of the columns say so
    #[arg(long)]
    pub degrees: bool,

    /// Topic of what was really sent, with a field where it has several
    #[arg(long, value_name = "TOPIC[:FIELD]", value_parser = selector)]
    pub command: Option<Selector>,

    /// What to read.
    #[command(flatten)]
    pub read: ReadArgs,
}

/// At most one of these.
#[derive(Debug, clap::Args)]
#[group(multiple = false)]
pub struct ExportFormat {
    /// Comma-separated values
    #[arg(long)]
    pub csv: bool,

    /// Apache Parquet, compressed with zstd
    #[arg(long)]
    pub parquet: bool,
}

impl ExportArgs {
    /// Whether the table is to be Parquet; `None` if neither option nor ending says the form.
    pub fn wants_parquet(&self) -> Option<bool> {
        let file = self.output.as_deref();
        match (self.format.csv, self.format.parquet) {
            (true, _) => Some(false),
            (_, true) => Some(true),
            _ if ends(file, "parquet") => Some(true),
            _ if ends(file, "csv") => Some(false),
            _ => None,
        }
    }
}
