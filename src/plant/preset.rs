//! The machines that come with the program, around the sample arm.

use super::{Parameters, Plant, PlantError};
use crate::{arm::Arm, suggest::nearest};

/// Names and texts.
const PRESETS: [(&str, &str); 3] = [
    ("dead-band-limited", include_str!("../../sample-logs/plant/dead-band-limited.toml")),
    ("default", include_str!("../../sample-logs/plant/default.toml")),
    ("lag-limited", include_str!("../../sample-logs/plant/lag-limited.toml")),
];

impl Parameters {
    /// Names of the presets: by what limits them.
    pub fn preset_names() -> impl Iterator<Item = &'static str> {
        PRESETS.iter().map(|(name, _)| *name)
    }

    /// A preset for the sample arm.
    ///
    /// # Errors
    ///
    /// [`PlantError::UnknownPreset`].
    pub fn preset(name: &str) -> Result<Self, PlantError> {
        let Some((_, text)) = PRESETS.iter().find(|(known, _)| *known == name) else {
            let known: Vec<&str> = Self::preset_names().collect();
            return Err(PlantError::UnknownPreset {
                name: name.to_owned(),
                nearest: nearest(name, known.iter().copied()),
                known: known.join(", "),
            });
        };
        Self::parse(text)
    }
}

impl Plant {
    /// The sample arm with a preset.
    ///
    /// # Errors
    ///
    /// [`PlantError::UnknownPreset`].
    pub fn preset(name: &str) -> Result<Self, PlantError> {
        let parameters = Parameters::preset(name)?;
        // The sample arm is part of the program, and a test reads it.
        let arm =
            Arm::sample().map_err(|error| PlantError::Syntax { line: 1, message: error.to_string() })?;
        Self::new(&arm, parameters)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_fits_the_sample_arm() {
        for name in Parameters::preset_names() {
            assert_eq!(Plant::preset(name).unwrap().joints().count(), 6);
        }
        let error = Plant::preset("fast").unwrap_err().to_string();
        assert_eq!(error, "there is no plant \"fast\"; there are dead-band-limited, default, lag-limited");
        let error = Plant::preset("laglimited").unwrap_err().to_string();
        assert!(error.contains("did you mean \"lag-limited\"?"), "{error}");
    }
}
