//! From the document to a checked task: degrees become radians, names become indices.

use std::{collections::BTreeMap, ops::Range, path::Path};

use toml::Spanned;

use super::{
    ArmSource, Boundary, ByObjective, Ceilings, JointLimits, KeyPoint, Objective, Place, Task, TaskError,
    Weights,
    document::{ByJoint, Document, End, Limits, Point, Tool},
    objective::Row,
};
use crate::{input_file, units::radians_from_degrees};

/// Shortest and longest interval where the file gives none, s.
const INTERVAL_S: [f64; 2] = [0.3, 20.0];

impl Task {
    /// Reads the text of a task file.
    ///
    /// # Errors
    ///
    /// [`TaskError`], naming the line, what was found and what belongs there.
    pub fn parse(text: &str) -> Result<Self, TaskError> {
        parse(text)
    }

    /// Reads a task file.
    ///
    /// # Errors
    ///
    /// [`TaskError`] if the file cannot be read or is no task.
    pub fn read(path: &Path) -> Result<Self, TaskError> {
        let text = input_file::read_to_string(path)
            .map_err(|source| TaskError::Read { path: path.to_owned(), reason: source.to_string() })?;
        Self::parse(&text)
    }
}

fn parse(text: &str) -> Result<Task, TaskError> {
    let file: Document = toml::from_str(text).map_err(|error| TaskError::Syntax {
        line: line_of(text, &error.span().unwrap_or(0..0)),
        message: syntax(error.message()),
    })?;
    let reader = Reader { text, joints: file.joints.get_ref() };
    reader.joints(&file.joints)?;
    let degree = match &file.degree {
        None => 6,
        Some(degree) if (5..=7).contains(degree.get_ref()) => *degree.get_ref(),
        Some(degree) => return Err(reader.value("degree", degree, "5, 6 or 7 is expected")),
    };
    let payload_kg = file.payload_kg;
    if !(payload_kg.is_finite() && payload_kg >= 0.0) {
        let expected = "a mass of zero or more is expected";
        return Err(TaskError::Value {
            line: 1,
            key: "payload_kg".into(),
            found: payload_kg.to_string(),
            expected,
        });
    }
    let interval_s = match &file.interval_s {
        None => INTERVAL_S,
        Some(given) => {
            let [low, high] = *given.get_ref();
            if !(low > 0.0 && high.is_finite() && high >= low) {
                let found = format!("[{low}, {high}]");
                let expected = "0 < shortest <= longest is expected";
                let line = line_of(text, &given.span());
                return Err(TaskError::Value { line, key: "interval_s".into(), found, expected });
            }
            [low, high]
        }
    };
    let points = file.points.iter().map(|point| reader.point(point)).collect::<Result<Vec<_>, _>>()?;
    if points.len() < 2 {
        let (key, why) = ("point".to_owned(), "a plan leads from one key point to another");
        return Err(TaskError::Length { line: 1, key, found: points.len(), expected: 2, why });
    }
    let times_s = match &file.times_s {
        None => None,
        Some(times) => Some(reader.times(times, points.len())?),
    };
    let bound = |key, value: &Option<Spanned<f64>>| match value {
        Some(given) => reader.positive(key, given).map(Some),
        None => Ok(None),
    };
    let arm = reader.arm(&file)?;
    Ok(Task {
        title: file.title,
        arm,
        joints: file.joints.get_ref().clone(),
        degree,
        points,
        payload_kg,
        payload_size_m: reader.size(file.payload_size_m.as_ref())?,
        start: reader.boundary("start", file.start.as_ref())?,
        end: reader.boundary("end", file.end.as_ref())?,
        interval_s,
        limits: reader.limits(&file.limits)?,
        tool_speed_m_s: bound("limits.tool_speed_m_s", &file.limits.tool_speed_m_s)?.unwrap_or(f64::INFINITY),
        ceilings: reader.ceilings(&file.objectives)?,
        weights: reader.weights(file.weights.as_ref())?,
        times_s,
    })
}

/// The line, from 1, in which a span starts.
fn line_of(text: &str, span: &Range<usize>) -> usize {
    let start = span.start.min(text.len());
    1 + memchr::memchr_iter(b'\n', &text.as_bytes()[..start]).count()
}

/// A key without its unit is the commonest slip: say which keys there are.
fn syntax(message: &str) -> String {
    let mut message = message.trim().replace('\n', " ");
    if message.contains("unknown field") {
        message.push_str("; every quantity carries its unit in its key");
    }
    message
}

struct Reader<'a> {
    text: &'a str,
    joints: &'a [String],
}

impl Reader<'_> {
    fn declared(&self) -> String {
        self.joints.join(", ")
    }

    fn value<T: std::fmt::Display>(
        &self,
        key: &str,
        given: &Spanned<T>,
        expected: &'static str,
    ) -> TaskError {
        let line = line_of(self.text, &given.span());
        TaskError::Value { line, key: key.to_owned(), found: given.get_ref().to_string(), expected }
    }

    fn positive(&self, key: &str, given: &Spanned<f64>) -> Result<f64, TaskError> {
        let value = *given.get_ref();
        if value.is_finite() && value > 0.0 {
            Ok(value)
        } else {
            Err(self.value(key, given, "a number above zero is expected"))
        }
    }

    /// Numbers by objective of a plan; `key` is the objective's key in this table, `otherwise` what those left out get.
    fn by_objective(
        &self,
        table: &BTreeMap<String, Spanned<f64>>,
        key: fn(&Row) -> &'static str,
        otherwise: f64,
    ) -> Result<ByObjective, TaskError> {
        let known = || Objective::OF_PLAN.iter().copied();
        if let Some((name, value)) =
            table.iter().find(|(name, _)| known().all(|objective| key(objective.row()) != name.as_str()))
        {
            let keys: Vec<String> = known().map(|objective| format!("`{}`", key(objective.row()))).collect();
            let message = format!("unknown field `{name}`, expected one of {}", keys.join(", "));
            return Err(TaskError::Syntax {
                line: line_of(self.text, &value.span()),
                message: syntax(&message),
            });
        }
        let value = |objective: Objective| table.get(key(objective.row())).map(|value| *value.get_ref());
        Ok(ByObjective::NONE.map_plan(|objective| value(objective).unwrap_or(otherwise)))
    }

    fn ceilings(&self, given: &BTreeMap<String, Spanned<f64>>) -> Result<Ceilings, TaskError> {
        let shown = self.by_objective(given, |row| row.ceiling, f64::INFINITY)?;
        given.iter().try_for_each(|(key, value)| self.positive(key, value).map(drop))?;
        Ok(Ceilings::NONE.map_plan(|objective| objective.si_of_shown(shown[objective])))
    }

    fn weights(
        &self,
        given: Option<&Spanned<BTreeMap<String, Spanned<f64>>>>,
    ) -> Result<Option<Weights>, TaskError> {
        let Some(given) = given else { return Ok(None) };
        let weights = self.by_objective(given.get_ref(), |row| row.weight, 0.0)?;
        if weights.are_weights() {
            return Ok(Some(weights));
        }
        Err(TaskError::Value {
            line: line_of(self.text, &given.span()),
            key: "weights".into(),
            found: format!("{:?}", weights.plan()),
            expected: "weights of zero or more, not all zero, are expected",
        })
    }

    fn arm(&self, file: &Document) -> Result<ArmSource, TaskError> {
        let name = file.arm.get_ref();
        if name != "sample" {
            let (urdf, hydraulics, tool) = (name.clone(), file.hydraulics.clone(), file.tool.clone());
            return Ok(ArmSource::File { urdf, hydraulics, tool });
        }
        if file.hydraulics.is_some() || file.tool.is_some() {
            let expected = "a URDF file is expected where hydraulics or tool are given";
            return Err(self.value("arm", &file.arm, expected));
        }
        Ok(ArmSource::Sample)
    }

    fn joints(&self, given: &Spanned<Vec<String>>) -> Result<(), TaskError> {
        let line = line_of(self.text, &given.span());
        let key = "joints".to_owned();
        if given.get_ref().is_empty() {
            return Err(TaskError::Length { line, key, found: 0, expected: 1, why: "an arm has joints" });
        }
        let mut sorted = given.get_ref().clone();
        sorted.sort_unstable();
        match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => {
                let expected = "every joint is expected once";
                Err(TaskError::Value { line, key, found: format!("{:?} twice", pair[0]), expected })
            }
            None => Ok(()),
        }
    }

    /// Values in the order of the joints; `otherwise` for those left out, an error if it is none.
    fn by_joint<T: Copy>(
        &self,
        key: &str,
        given: &Spanned<BTreeMap<String, T>>,
        otherwise: Option<T>,
    ) -> Result<Vec<T>, TaskError> {
        let line = line_of(self.text, &given.span());
        let values = given.get_ref();
        if let Some(joint) = values.keys().find(|name| !self.joints.contains(name)) {
            let (key, joint) = (key.to_owned(), joint.clone());
            return Err(TaskError::UnknownJoint { line, key, joint, declared: self.declared() });
        }
        let of = |joint: &String| {
            values.get(joint).copied().or(otherwise).ok_or_else(|| TaskError::MissingJoint {
                line,
                key: key.to_owned(),
                joint: joint.clone(),
                declared: self.declared(),
            })
        };
        self.joints.iter().map(of).collect()
    }

    /// As [`Self::by_joint`], finite and in radians.
    fn angles(
        &self,
        key: &str,
        given: &Spanned<ByJoint>,
        otherwise: Option<f64>,
    ) -> Result<Vec<f64>, TaskError> {
        let values = self.by_joint(key, given, otherwise)?;
        match values.iter().find(|value| !value.is_finite()) {
            Some(value) => {
                let line = line_of(self.text, &given.span());
                let expected = "finite numbers are expected";
                Err(TaskError::Value { line, key: key.to_owned(), found: value.to_string(), expected })
            }
            None => Ok(values.into_iter().map(radians_from_degrees).collect()),
        }
    }

    fn point(&self, given: &Spanned<Point>) -> Result<KeyPoint, TaskError> {
        let line = line_of(self.text, &given.span());
        let point = given.get_ref();
        let place = match (&point.angles_deg, &point.tool) {
            (Some(angles), None) => Place::Joints(self.angles("angles_deg", angles, None)?),
            (None, Some(tool)) => {
                let Tool { x_m, z_m, pitch_deg, fixed_angles } = *tool;
                if ![x_m, z_m, pitch_deg].iter().all(|v| v.is_finite()) {
                    let found = format!("{x_m}, {z_m}, {pitch_deg}");
                    let expected = "finite numbers are expected";
                    return Err(TaskError::Value { line, key: "tool".into(), found, expected });
                }
                Place::Tool { x_m, z_m, pitch_rad: radians_from_degrees(pitch_deg), fixed_angles }
            }
            (Some(_), Some(_)) => return Err(TaskError::Place { line, found: "both" }),
            (None, None) => return Err(TaskError::Place { line, found: "neither" }),
        };
        let dwell_s = point.dwell_s.as_ref().map(|dwell| self.positive("dwell_s", dwell)).transpose()?;
        let payload_kg = match &point.payload_kg {
            Some(payload) if !(payload.get_ref().is_finite() && *payload.get_ref() >= 0.0) => {
                return Err(self.value("payload_kg", payload, "a mass of zero or more is expected"));
            }
            Some(payload) if dwell_s.is_none() => {
                return Err(self.value(
                    "payload_kg",
                    payload,
                    "a payload changes at a dwell: give dwell_s too",
                ));
            }
            payload => payload.as_ref().map(|p| *p.get_ref()),
        };
        Ok(KeyPoint { name: point.name.clone(), place, dwell_s, payload_kg })
    }

    fn size(&self, given: Option<&Spanned<[f64; 3]>>) -> Result<[f64; 3], TaskError> {
        let Some(given) = given else { return Ok([0.0; 3]) };
        let size_m = *given.get_ref();
        if size_m.iter().all(|m| (0.0..1e3).contains(m)) {
            return Ok(size_m);
        }
        let (key, found) = ("payload_size_m".to_owned(), format!("{size_m:?}"));
        let expected = "three lengths of zero or more are expected";
        Err(TaskError::Value { line: line_of(self.text, &given.span()), key, found, expected })
    }

    fn times(&self, given: &Spanned<Vec<f64>>, points: usize) -> Result<Vec<f64>, TaskError> {
        let times = given.get_ref();
        let line = line_of(self.text, &given.span());
        let key = "times_s".to_owned();
        if times.len() != points {
            let why = "one for each key point: its arrival, dwells counted";
            return Err(TaskError::Length { line, key, found: times.len(), expected: points, why });
        }
        let bad = |pair: &&[f64]| !(pair[1] > pair[0] && pair[1].is_finite());
        if let Some([before, after]) = times.windows(2).find(bad) {
            let found = format!("{after} after {before}");
            return Err(TaskError::Value { line, key, found, expected: "increasing times are expected" });
        }
        Ok(times.clone())
    }

    fn boundary(&self, end: &str, given: Option<&End>) -> Result<Boundary, TaskError> {
        let rest = vec![0.0; self.joints.len()];
        let of = |quantity: &str, values: Option<&Spanned<ByJoint>>| match values {
            None => Ok(rest.clone()),
            Some(values) => self.angles(&format!("{end}.{quantity}"), values, Some(0.0)),
        };
        Ok(Boundary {
            velocity_rad_s: of("speed_deg_s", given.and_then(|e| e.speed_deg_s.as_ref()))?,
            acceleration_rad_s2: of(
                "acceleration_deg_s2",
                given.and_then(|e| e.acceleration_deg_s2.as_ref()),
            )?,
            jerk_rad_s3: of("jerk_deg_s3", given.and_then(|e| e.jerk_deg_s3.as_ref()))?,
        })
    }

    fn limits(&self, given: &Limits) -> Result<Vec<JointLimits>, TaskError> {
        let of = |key: &str, values: &Option<Spanned<ByJoint>>| -> Result<Vec<f64>, TaskError> {
            let Some(values) = values else { return Ok(vec![f64::INFINITY; self.joints.len()]) };
            let found = self.by_joint(key, values, Some(f64::INFINITY))?;
            match found.iter().find(|value| value.is_nan() || **value <= 0.0) {
                Some(value) => {
                    let line = line_of(self.text, &values.span());
                    let expected = "limits above zero are expected";
                    Err(TaskError::Value { line, key: key.to_owned(), found: value.to_string(), expected })
                }
                None => Ok(found),
            }
        };
        let ranges = match &given.range_deg {
            None => vec![None; self.joints.len()],
            Some(ranges) => {
                let wide = [f64::NEG_INFINITY, f64::INFINITY];
                let found = self.by_joint("range_deg", ranges, Some(wide))?;
                if let Some([low, high]) =
                    found.iter().find(|[low, high]| low >= high || low.is_nan() || high.is_nan())
                {
                    let line = line_of(self.text, &ranges.span());
                    let found = format!("[{low}, {high}]");
                    let expected = "the lowest angle is expected first";
                    return Err(TaskError::Value { line, key: "range_deg".into(), found, expected });
                }
                found
                    .into_iter()
                    .map(|range| range[0].max(-range[1]).is_finite().then(|| range.map(radians_from_degrees)))
                    .collect()
            }
        };
        let speed = of("limits.speed_deg_s", &given.speed_deg_s)?;
        let acceleration = of("limits.acceleration_deg_s2", &given.acceleration_deg_s2)?;
        let jerk = of("limits.jerk_deg_s3", &given.jerk_deg_s3)?;
        let torque = of("limits.torque_n_m", &given.torque_n_m)?;
        let rod_speed = of("limits.rod_speed_m_s", &given.rod_speed_m_s)?;
        Ok((0..self.joints.len())
            .map(|j| JointLimits {
                range_rad: ranges[j],
                velocity_rad_s: radians_from_degrees(speed[j]),
                acceleration_rad_s2: radians_from_degrees(acceleration[j]),
                jerk_rad_s3: radians_from_degrees(jerk[j]),
                torque_n_m: torque[j],
                rod_speed_m_s: rod_speed[j],
            })
            .collect())
    }
}
