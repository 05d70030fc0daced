//! Why no joint of a run can be predicted, as far as the run tells.

use crate::{
    fit::{Character, Oscillation},
    log::Recording,
    replay::{Rules, replay},
    series::JointKind,
};

/// Share of a joint's RMS error from which on the noise of its sensor hides how it answers.
const HIDES: f64 = 0.5;

/// What may be the reason that no joint is predicted.
#[derive(Debug, Clone, PartialEq)]
pub enum Unclear {
    /// A joint that oscillates by itself.
    Hunts {
        /// The joint.
        joint: String,
        /// How fast, Hz.
        frequency_hz: f64,
    },
    /// Noise of the measurement, of the joint that has least of it, beside its RMS error, rad.
    Noise {
        /// Standard deviation, rad.
        noise_rad: f64,
        /// RMS error, rad.
        error_rad: f64,
        /// Of the joint.
        kind: JointKind,
    },
    /// The logs may be of different machines.
    Logs,
    /// What was sent may be missing in the log.
    Sent,
}

impl Unclear {
    /// Of the newest of so many logs.
    pub(super) fn of(logs: usize, newest: &Recording, rules: &Rules) -> Self {
        let joints = replay(&newest.pairs(), rules).joints;
        let both = joints.iter().map(|joint| (joint.noise.sigma, joint.tracking_error.rms, joint.kind));
        let least = both.min_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1)));
        let hunts = newest.measured.tracks.iter().find_map(|track| {
            let found = Oscillation::of_error(newest.planned.track(track.name())?, track);
            let (joint, frequency_hz) = (track.name().to_owned(), found.frequency_hz);
            (found.character == Character::Hunts).then_some(Self::Hunts { joint, frequency_hz })
        });
        match least {
            Some((noise_rad, error_rad, kind)) if noise_rad >= HIDES * error_rad => {
                Self::Noise { noise_rad, error_rad, kind }
            }
            _ => hunts.unwrap_or(if logs > 1 { Self::Logs } else { Self::Sent }),
        }
    }
}

impl std::fmt::Display for Unclear {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Hunts { joint, frequency_hz } => write!(
                f,
                "{joint} oscillates by itself at {frequency_hz:.2} Hz, which no command calms: lower the gains of its loop, or look for \
                 play and stiction of its valve, and log another run"
            ),
            &Self::Noise { noise_rad, error_rad, kind } => write!(
                f,
                "the measurement has {} of noise, of an RMS error of {}: mend or filter the sensor, or log a run whose error is \
                 larger than that",
                kind.says(noise_rad),
                kind.says(error_rad)
            ),
            Self::Logs => {
                f.write_str("was something else sent than the plan (--command), or did valves or controller change between the logs?")
            }
            Self::Sent => f.write_str("was something else sent than the plan (--command), or does the machine answer differently each time?"),
        }
    }
}
