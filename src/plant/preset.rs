//! The machines that come with the program, around the sample arm.

use super::{Parameters, Plant, PlantError};
use crate::{arm::Arm, suggest::nearest};

/// A name, and the text of the file of that name.
macro_rules! presets {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../sample-logs/plant/", $name, ".toml")))),*]
    };
}

/// Names and texts: by what limits the machine, then by what its structure has that the first three lack.
const PRESETS: [(&str, &str); 14] = presets![
    "dead-band-limited", "default", "lag-limited", "backlash", "cascade", "changing", "counterbalance",
    "flexible-link", "held-set-values", "position-only", "positioning-window", "progressive-edges", "soft",
    "stick-slip",
];

impl Parameters {
    /// Names of the presets: by what limits them, or by their structure.
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
            let nearest = nearest(name, known.iter().copied());
            let (name, known) = (name.to_owned(), known.join(", "));
            return Err(PlantError::UnknownPreset { name, nearest, known });
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
        assert!(error.starts_with(
            "there is no plant \"fast\"; there are dead-band-limited, default, lag-limited, backlash, cascade, "
        ));
        let error = Plant::preset("laglimited").unwrap_err().to_string();
        assert!(error.contains("did you mean \"lag-limited\"?"), "{error}");
    }
}
