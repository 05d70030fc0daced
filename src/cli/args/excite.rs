//! Arguments of `excite`.

use std::path::PathBuf;

use super::degrees;
use crate::{
    fit::{Excitation, JointRoom},
    units::radians_from_degrees,
    workflow::excite::{Arm, Inputs},
};

/// Arguments of `excite`.
#[derive(Debug, clap::Args)]
pub struct ExciteArgs {
    /// Write the run to FILE, an MCAP log
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,

    /// The arm of this task, about the middle of its key points [default: the sample arm]
    #[arg(long, value_name = "FILE")]
    pub task: Option<PathBuf>,

    /// A joint, where it starts and how far it may go, degrees; repeat for every joint
    #[arg(long = "joint", value_name = "NAME=HOME:LOW:HIGH", value_parser = room, conflicts_with = "task")]
    pub joints: Vec<JointRoom>,

    /// Strokes at five speeds, a minute a joint, in place of two in twenty seconds
    #[arg(long)]
    pub full: bool,

    /// Send no joint faster; below what the machine can do its speed limits stay unknown
    #[arg(long, value_name = "DEG/S", value_parser = degrees, allow_negative_numbers = true)]
    pub max_speed_deg_s: Option<f64>,
}

impl ExciteArgs {
    /// The same for the workflow.
    pub fn inputs(&self) -> Inputs {
        let arm = match (&self.task, self.joints.is_empty()) {
            (Some(task), _) => Arm::Task(task.clone()),
            (None, false) => Arm::Joints(self.joints.clone()),
            (None, true) => Arm::Sample,
        };
        let excitation = if self.full { Excitation::full() } else { Excitation::minimal() };
        Inputs { arm, excitation, most_rad_s: self.max_speed_deg_s.unwrap_or(f64::INFINITY) }
    }
}

fn room(text: &str) -> Result<JointRoom, String> {
    let wrong = || format!("{text:?} is not NAME=HOME:LOW:HIGH in degrees, such as J1=60:30:90");
    let (name, angles) = text.rsplit_once('=').ok_or_else(wrong)?;
    let angles: Vec<f64> =
        angles.split(':').map(str::parse).collect::<Result<_, _>>().map_err(|_| wrong())?;
    match angles[..] {
        [home, low, high] if !name.is_empty() && low <= home && home <= high && (high - low).is_finite() => {
            let [home_rad, low_rad, high_rad] = [home, low, high].map(radians_from_degrees);
            Ok(JointRoom { name: name.to_owned(), home_rad, range_rad: [low_rad, high_rad] })
        }
        _ => Err(wrong()),
    }
}
