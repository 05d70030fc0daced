//! From the document to a checked task: degrees become radians, names become indices.

use std::{collections::BTreeMap, path::Path};

use toml::Spanned;

use super::{
    ArmSource, ByObjective, Ceilings, KeyPoint, Objective, Place, Task, TaskError, Weights,
    document::{Document, Point, Tool},
    joints::{Joints, line_of, positions},
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
    let names = file.joints.get_ref();
    check_joints(text, &file.joints)?;
    let kinds = Joints { text, names, kinds: &[] }.kinds(&file)?;
    let joints = Joints { text, names, kinds: &kinds };
    let reader = Reader { text, joints };
    let degree = match &file.degree {
        None => 6,
        Some(degree) if (5..=7).contains(degree.get_ref()) => *degree.get_ref(),
        Some(degree) => return Err(reader.value("degree", degree, "5, 6 or 7 is expected")),
    };
    let payload_kg = file.payload_kg;
    if !(payload_kg.is_finite() && payload_kg >= 0.0) {
        let (key, found) = ("payload_kg".to_owned(), payload_kg.to_string());
        return Err(TaskError::Value { line: 1, key, found, expected: "a mass of zero or more is expected" });
    }
    let interval_s = match &file.interval_s {
        None => INTERVAL_S,
        Some(given) => {
            let [low, high] = *given.get_ref();
            if !(low > 0.0 && high.is_finite() && high >= low) {
                let found = format!("[{low}, {high}]");
                return Err(reader.wrong("interval_s", given, found, "0 < shortest <= longest is expected"));
            }
            [low, high]
        }
    };
    let points = file.points.iter().map(|point| reader.point(point)).collect::<Result<Vec<_>, _>>()?;
    if points.len() < 2 {
        let (key, why) = ("point".to_owned(), "a plan leads from one key point to another");
        let line = file.points.first().map_or(1, |point| line_of(text, &point.span()));
        return Err(TaskError::Length { line, key, found: points.len(), expected: 2, why });
    }
    let times_s = file.times_s.as_ref().map(|times| reader.times(times, points.len())).transpose()?;
    let tool_speed = file.limits.tool_speed_m_s.as_ref();
    let arm = reader.arm(&file)?;
    Ok(Task {
        title: file.title,
        arm,
        joints: file.joints.get_ref().clone(),
        kinds: kinds.clone(),
        degree,
        points,
        payload_kg,
        payload_size_m: reader.size(file.payload_size_m.as_ref())?,
        start: joints.boundary("start", file.start.as_ref())?,
        end: joints.boundary("end", file.end.as_ref())?,
        interval_s,
        limits: joints.limits(&file.limits)?,
        tool_speed_m_s: tool_speed
            .map_or(Ok(f64::INFINITY), |given| reader.positive("limits.tool_speed_m_s", given))?,
        ceilings: reader.ceilings(&file.objectives)?,
        weights: reader.weights(file.weights.as_ref())?,
        times_s,
    })
}

fn check_joints(text: &str, given: &Spanned<Vec<String>>) -> Result<(), TaskError> {
    let line = line_of(text, &given.span());
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

/// A key without its unit is the commonest slip: say which keys there are.
fn syntax(message: &str) -> String {
    let mut message = message.trim().replace('\n', " ");
    let hints = [
        ("unknown field `fixed_angles`", "; it stands beside the pose, inside tool = { ... }"),
        ("unknown field", "; every quantity carries its unit in its key"),
        ("expected a map", ": values by joint are, as speed_deg_s = { J1 = 8, J2 = 12 }"),
        (
            "missing field `point`",
            ": two [[point]] or more, with angles_deg by joint or a tool's pose, make a plan",
        ),
    ];
    let hint = hints.iter().find(|(found, _)| message.contains(found));
    message.push_str(hint.map_or("", |(_, hint)| hint));
    message
}

struct Reader<'a> {
    text: &'a str,
    joints: Joints<'a>,
}

impl Reader<'_> {
    fn value<T: ToString>(&self, key: &str, given: &Spanned<T>, expected: &'static str) -> TaskError {
        self.wrong(key, given, given.get_ref().to_string(), expected)
    }

    fn wrong<T>(&self, key: &str, given: &Spanned<T>, found: String, expected: &'static str) -> TaskError {
        TaskError::Value { line: line_of(self.text, &given.span()), key: key.to_owned(), found, expected }
    }

    fn positive(&self, key: &str, given: &Spanned<f64>) -> Result<f64, TaskError> {
        let value = *given.get_ref();
        if value.is_finite() && value > 0.0 {
            Ok(value)
        } else {
            Err(self.value(key, given, "a number above zero is expected"))
        }
    }

    /// Zero or more.
    fn not_negative(&self, key: &str, given: &Spanned<f64>) -> Result<f64, TaskError> {
        let value = *given.get_ref();
        if value.is_finite() && value >= 0.0 {
            Ok(value)
        } else {
            Err(self.value(key, given, "zero, which only stops there, or more is expected"))
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
            let line = line_of(self.text, &value.span());
            return Err(TaskError::Syntax { line, message: syntax(&message) });
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
        let expected = "weights of zero or more, not all zero, are expected";
        Err(self.wrong("weights", given, format!("{:?}", weights.plan()), expected))
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

    fn point(&self, given: &Spanned<Point>) -> Result<KeyPoint, TaskError> {
        let line = line_of(self.text, &given.span());
        let point = given.get_ref();
        let positions = positions(point);
        let place = match (positions.is_given(), &point.tool) {
            (true, None) => Place::Joints(self.joints.values(&positions, None)?),
            (false, Some(tool)) => {
                let Tool { x_m, z_m, pitch_deg, fixed_angles } = *tool;
                if ![x_m, z_m, pitch_deg].iter().all(|v| v.is_finite()) {
                    let found = format!("{x_m}, {z_m}, {pitch_deg}");
                    let expected = "finite numbers are expected";
                    return Err(TaskError::Value { line, key: "tool".into(), found, expected });
                }
                Place::Tool { x_m, z_m, pitch_rad: radians_from_degrees(pitch_deg), fixed_angles }
            }
            (true, Some(_)) => return Err(TaskError::Place { line, found: "both" }),
            (false, None) => return Err(TaskError::Place { line, found: "neither" }),
        };
        let dwell_s = point.dwell_s.as_ref().map(|dwell| self.not_negative("dwell_s", dwell)).transpose()?;
        let payload_kg = match &point.payload_kg {
            Some(payload) if !(payload.get_ref().is_finite() && *payload.get_ref() >= 0.0) => {
                return Err(self.value("payload_kg", payload, "a mass of zero or more is expected"));
            }
            Some(payload) if dwell_s.is_none() => {
                let expected = "a payload changes at a dwell: give dwell_s too";
                return Err(self.value("payload_kg", payload, expected));
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
        let expected = "three lengths of zero or more are expected";
        Err(self.wrong("payload_size_m", given, format!("{size_m:?}"), expected))
    }

    fn times(&self, given: &Spanned<Vec<f64>>, points: usize) -> Result<Vec<f64>, TaskError> {
        let times = given.get_ref();
        if times.len() != points {
            let (line, key) = (line_of(self.text, &given.span()), "times_s".to_owned());
            let why = "one for each key point: its arrival, dwells counted";
            return Err(TaskError::Length { line, key, found: times.len(), expected: points, why });
        }
        let bad = |pair: &&[f64]| !(pair[1] > pair[0] && pair[1].is_finite());
        if let Some([before, after]) = times.windows(2).find(bad) {
            let found = format!("{after} after {before}");
            return Err(self.wrong("times_s", given, found, "increasing times are expected"));
        }
        Ok(times.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_of_form_are_told_with_the_form_that_is_expected() {
        let head = "title = \"x\"\narm = \"a.urdf\"\njoints = [\"J1\"]\n";
        for (rest, hint) in [
            (
                "[[point]]\nangles_deg = { J1 = 0 }\n[limits]\nspeed_deg_s = 8\n",
                "as speed_deg_s = { J1 = 8, J2 = 12 }",
            ),
            ("[limits]\nspeed_deg_s = { J1 = 8 }\n", "two [[point]] or more"),
            ("[[point]]\nfixed_angles = true\n", "inside tool = { ... }"),
        ] {
            let error = Task::parse(&format!("{head}{rest}")).unwrap_err().to_string();
            assert!(error.contains(hint), "{error}");
        }
    }
}
