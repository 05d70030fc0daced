//! The documents of `fit`: what logs say of a machine, and the file with limits that `replan` and `report` read.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{FitFailure, Fitted, FittedRun, LIMITS_FORMAT, torque::JointTorque};
use crate::{
    document::{PROGRAM, pretty},
    fit::{Fit, JointFit, LEAST_SKILL, LeftOut, SharedLimit, Supply},
    input_file,
    remark::Remark,
    series::JointKind,
};

const FORMAT: &str = "hydrotrace.fit.v1";
/// A fitted machine. Angles are radians, times seconds; pairs are for growing and for
/// shrinking angles. Of a joint that slides a radian stands for a metre.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FitDocument {
    /// Always "hydrotrace.fit.v1".
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// The runs.
    pub runs: Vec<FittedRun>,
    /// Each joint; every quantity has `value`, `interval` (95 %), `identified` and `lower_bound`.
    pub joints: Vec<JointFit>,
    /// Torques of cylinders; empty without pressures and a task with cylinders in a log.
    pub torques: Vec<JointTorque>,
    /// Joints that are sent and measured but hardly moved.
    pub left_out: Vec<LeftOut>,
    /// Factor on predicted peak errors: 90 % of the measured ones stay below.
    pub peak_margin: f64,
    /// Number of held-out starts behind the margin.
    pub margin_starts: usize,
    /// The limit that joints share, such as a pump, where the logs show one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shared: Option<SharedLimit>,
    /// The supply, where its pressure was logged and fell while joints moved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub supply: Option<Supply>,
    /// Least held-out R2 for which commands are made.
    pub least_held_out_r2: f64,
    /// Doubts; any makes the exit code 3.
    pub remarks: Vec<Remark>,
}

impl FitDocument {
    /// Of a fit.
    pub fn of(fitted: &Fitted) -> Self {
        let Fit { joints, left_out, peak_margin, margin_starts, shared, supply } = fitted.fit.clone();
        Self {
            format: FORMAT.to_owned(),
            program: PROGRAM.to_owned(),
            runs: fitted.runs.clone(),
            joints,
            torques: fitted.torques.clone(),
            left_out,
            peak_margin,
            margin_starts,
            shared,
            supply,
            least_held_out_r2: LEAST_SKILL,
            remarks: fitted.remarks.as_slice().to_vec(),
        }
    }

    /// The document as text.
    pub fn json(&self) -> String {
        pretty(self)
    }
}

/// A file with limits, TOML.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct LimitsFile {
    /// Always "hydrotrace.limits.v1".
    pub format: String,
    /// Names of the logs that were fitted.
    pub logs: Vec<String>,
    /// Torques from pressures, where the logs have them.
    #[serde(default)]
    pub torques: Vec<JointTorque>,
    /// The fitted machine.
    #[serde(flatten)]
    pub fit: Fit,
}

/// What people should know who open the file.
const HEAD: &str = "# What a machine does with what it is sent, as `hydrotrace fit` found it in logs; for
# `hydrotrace replan --limits`. Radians and seconds. A quantity has a value and its 95 % interval, or
# the lower_bound that was reached; identified = false: the logs do not decide it. Pairs are for
# growing and for shrinking angles; inf: no limit showed. What will
# come is predicted by the numbers of joints.model; the others say what is known of them. Of a
# joint of kind slides a radian stands for a metre.
";

impl LimitsFile {
    /// Of a fit.
    pub fn of(fitted: &Fitted) -> Self {
        Self {
            format: LIMITS_FORMAT.to_owned(),
            logs: fitted.runs.iter().map(|run| run.log.clone()).collect(),
            torques: fitted.torques.clone(),
            fit: fitted.fit.clone(),
        }
    }

    /// The file as text.
    ///
    /// # Errors
    ///
    /// A number that TOML cannot hold.
    pub fn toml(&self) -> Result<String, toml::ser::Error> {
        Ok(format!("{HEAD}{}", toml::to_string(self)?))
    }

    /// Reads a file with limits.
    ///
    /// # Errors
    ///
    /// [`FitFailure`] naming the file, and the line or joint.
    pub fn read(path: &Path) -> Result<Self, FitFailure> {
        let read = |source| FitFailure::Read { path: path.to_owned(), source };
        Self::parse(path, &input_file::read_to_string(path).map_err(read)?)
    }

    /// Reads the text of such a file.
    ///
    /// # Errors
    ///
    /// As [`LimitsFile::read`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, FitFailure> {
        let path = path.to_owned();
        let file: Self = match toml::from_str(text) {
            Ok(file) => file,
            Err(_) if text.trim_start().starts_with('{') => return Err(FitFailure::Document { path }),
            Err(source) => return Err(FitFailure::Limits { path, source: Box::new(source) }),
        };
        if file.format != LIMITS_FORMAT {
            return Err(FitFailure::Format { path, found: file.format });
        }
        match file.fit.check() {
            Ok(()) => Ok(file),
            Err(source) => Err(FitFailure::Values { path, source }),
        }
    }

    /// Checks that a log is of the machine, or of one that shares a joint with it.
    ///
    /// # Errors
    ///
    /// [`FitFailure::OtherJoints`], and [`FitFailure::OtherKind`] if a joint turns in one and slides in the other.
    pub fn check_joints<'a>(
        &self,
        path: &Path,
        joints: impl Iterator<Item = (&'a str, JointKind)> + Clone,
    ) -> Result<(), FitFailure> {
        let mut known =
            joints.clone().filter_map(|(name, kind)| Some((self.fit.joint(name)?, kind))).peekable();
        if known.peek().is_some() {
            let other = known.find(|(joint, kind)| joint.kind != *kind).map(|(joint, _)| joint.name.clone());
            return other.map_or(Ok(()), |joint| Err(FitFailure::OtherKind { path: path.to_owned(), joint }));
        }
        let joints = joints.map(|(name, _)| name);
        let found: Vec<&str> = self.fit.joints.iter().map(|joint| joint.name.as_str()).collect();
        let (found, expected) = (found.join(", "), joints.collect::<Vec<_>>().join(", "));
        Err(FitFailure::OtherJoints { path: path.to_owned(), found, expected })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workflow::fit::{Inputs, run};

    #[test]
    fn documents_and_files_with_limits_read_back_as_they_were_written() {
        let log = concat!(env!("CARGO_MANIFEST_DIR"), "/sample-logs/pressures-run.mcap");
        let fitted = run(&Inputs { logs: vec![log.into()], ..Inputs::default() }).unwrap();
        let document = FitDocument::of(&fitted);
        assert_eq!(serde_json::from_str::<FitDocument>(&document.json()).unwrap(), document);
        let folder = tempfile::tempdir().unwrap();
        let (path, file) = (folder.path().join("limits.toml"), LimitsFile::of(&fitted));
        std::fs::write(&path, file.toml().unwrap()).unwrap();
        assert_eq!(LimitsFile::read(&path).unwrap(), file);
        let json = LimitsFile::parse(&path, &document.json()).unwrap_err();
        assert!(json.to_string().contains("is JSON, the document of a fit"), "{json}");
        for (value, said) in [(f64::NAN, "lag_s of joint J1 is NaN"), (-1.0, "lag_s of joint J1 is -1")] {
            let mut edited = file.clone();
            edited.fit.joints[0].lag_s.value = Some(value);
            let refused = LimitsFile::parse(&path, &edited.toml().unwrap()).unwrap_err();
            assert!(crate::document::explained(&refused).contains(said), "{refused:?}");
        }
    }
}
