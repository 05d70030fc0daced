//! `excite`

use std::path::PathBuf;

use super::{
    CliError, Outcome, Run,
    console::{Console, spare_for_log, write_file},
    number::{speed_deg_s, speed_mm_s},
};
use crate::{
    fit::{Excitation, JointRoom},
    render::excite as words,
    series::JointKind,
    units::radians_from_degrees,
    workflow::excite::{Arm, Inputs, run},
};

const EXAMPLES: &str = "\
Examples:
  hydrotrace excite -o id.mcap --task task.toml
  hydrotrace excite -o id.mcap --joint boom=40:20:60 --joint arm=90:70:110 --max-speed-deg-s 30
  hydrotrace excite -o id.mcap --joint mast=1500:0:3000mm";

/// Samples a second in the log.
const RATE_HZ: f64 = 100.0;

/// Write a run of slow and fast strokes, for `fit` to find limits
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Args {
    /// Write the run to FILE, an MCAP log
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// The arm of this task, about the middle of its key points [default: the sample arm]
    #[arg(long, value_name = "FILE")]
    task: Option<PathBuf>,

    /// A joint, its start and its range, in degrees, or mm of a joint that slides (=1500:0:3000mm); repeat for every joint
    #[arg(long = "joint", value_name = "NAME=HOME:LOW:HIGH", value_parser = room, conflicts_with = "task")]
    joints: Vec<JointRoom>,

    /// Strokes at five speeds, one minute per joint, instead of at two speeds in twenty seconds
    #[arg(long)]
    full: bool,

    /// Largest speed of a joint that turns, 60 if not given; below the machine's own limit, that
    /// limit stays unknown
    #[arg(long, value_name = "DEG/S", value_parser = speed_deg_s, allow_negative_numbers = true)]
    max_speed_deg_s: Option<f64>,

    /// The same of a joint that slides, 600 if not given
    #[arg(long, value_name = "MM/S", value_parser = speed_mm_s, allow_negative_numbers = true)]
    max_speed_mm_s: Option<f64>,
}

impl Args {
    fn request(&self) -> Inputs {
        let arm = match (&self.task, self.joints.is_empty()) {
            (Some(task), _) => Arm::Task(task.clone()),
            (None, false) => Arm::Joints(self.joints.clone()),
            (None, true) => Arm::Sample,
        };
        let excitation = if self.full { Excitation::full() } else { Excitation::minimal() };
        let [most_rad_s, most_m_s] =
            [self.max_speed_deg_s, self.max_speed_mm_s].map(|most| most.unwrap_or(f64::INFINITY));
        Inputs { arm, excitation, most_rad_s, most_m_s }
    }
}

impl Run for Args {
    fn run(&self, console: &mut Console<'_>) -> Result<Outcome, CliError> {
        spare_for_log(Some(&self.output), self.task.as_slice())?;
        let request = self.request();
        let excited = run(&request)?;
        write_file(&self.output, &excited.log(RATE_HZ)?)?;
        console.show(&words::document(&excited, request.arm == Arm::Sample, &self.output))?;
        Ok(Outcome::Clean)
    }
}

fn room(text: &str) -> Result<JointRoom, String> {
    let wrong = || {
        format!(
            "{text:?} is not NAME=HOME:LOW:HIGH in degrees, such as J1=60:30:90, or in mm of a joint that slides, such as \
             mast=1500:0:3000mm"
        )
    };
    let (name, positions) = text.rsplit_once('=').ok_or_else(wrong)?;
    let (kind, positions) = match positions.strip_suffix("mm") {
        Some(lengths) => (JointKind::Slides, lengths),
        None => (JointKind::Turns, positions),
    };
    let positions: Vec<f64> =
        positions.split(':').map(str::parse).collect::<Result<_, _>>().map_err(|_| wrong())?;
    let si = |value: f64| match kind {
        JointKind::Turns => radians_from_degrees(value),
        JointKind::Slides => 1e-3 * value,
    };
    match positions[..] {
        [home, low, high] if low <= high && !(low..=high).contains(&home) => Err(format!(
            "of {text:?} the first position, {home}, where the joint is, lies outside {low} to {high}"
        )),
        [home, low, high] if !name.is_empty() && low <= home && home <= high && (high - low).is_finite() => {
            let [home_rad, low_rad, high_rad] = [home, low, high].map(si);
            let (name, range_rad) = (name.to_owned(), [low_rad, high_rad]);
            Ok(JointRoom { name, kind, home_rad, range_rad, most_rad_s: f64::INFINITY })
        }
        _ => Err(wrong()),
    }
}
