//! The file of a plant as it is written: degrees, joints by name, lines.

use std::{collections::BTreeMap, ops::Range, path::Path};

use serde::Deserialize;
use toml::Spanned;

use super::{
    JointParameters, Parameters, PlantError,
    quantity::{Place, QUANTITIES, Quantity, check},
};
use crate::input_file;

const LARGEST_TEXT: usize = 1 << 20;

type Table = BTreeMap<String, Spanned<Values>>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    title: String,
    base: Option<Spanned<String>>,
    joints: Option<Spanned<Vec<String>>>,
    #[serde(default)]
    supply: Table,
    #[serde(default)]
    valve: Table,
    #[serde(default)]
    cylinder: Table,
    #[serde(default)]
    friction: Table,
    #[serde(default)]
    link: Table,
    #[serde(default)]
    control: Table,
    #[serde(default)]
    encoder: Table,
    #[serde(default)]
    log: Table,
    #[serde(default)]
    payload: Table,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a number, or a table with a number for each joint")]
enum Values {
    All(f64),
    ByJoint(BTreeMap<String, f64>),
}

impl Parameters {
    /// Reads the text of a plant file: every quantity of `sample-logs/plant/default.toml`, as one number or, where
    /// joints may differ, as a table by joint. Angles are in degrees. What only some machines have may be left out. A
    /// file with `base`, the name of a preset, holds only what differs from it.
    ///
    /// # Errors
    ///
    /// [`PlantError`], naming the line, what was found and what belongs there.
    pub fn parse(text: &str) -> Result<Self, PlantError> {
        if text.len() > LARGEST_TEXT {
            let message = format!("{} bytes, at most {LARGEST_TEXT} are read", text.len());
            return Err(PlantError::Syntax { line: 1, message });
        }
        let file: File = toml::from_str(text).map_err(|error| PlantError::Syntax {
            line: line_of(text, &error.span().unwrap_or(0..0)),
            message: error.message().trim().replace('\n', " "),
        })?;
        let mut parameters = begin(text, &file)?;
        let joints = parameters.joints.iter().map(|joint| joint.name.clone()).collect();
        let mut reader = Reader { text, joints, whole: file.base.is_none(), lines: BTreeMap::new() };
        let tables = [
            ("supply", &file.supply),
            ("valve", &file.valve),
            ("cylinder", &file.cylinder),
            ("friction", &file.friction),
            ("link", &file.link),
            ("control", &file.control),
            ("encoder", &file.encoder),
            ("log", &file.log),
            ("payload", &file.payload),
        ];
        for (name, table) in tables {
            reader.table(name, table, &mut parameters)?;
        }
        check(&parameters).map_err(|flaw| {
            let line = reader.lines.get(&flaw.key).copied();
            flaw.at(line)
        })?;
        Ok(parameters)
    }

    /// Reads a plant file.
    ///
    /// # Errors
    ///
    /// [`PlantError`] if the file cannot be read or describes no plant.
    pub fn read(path: &Path) -> Result<Self, PlantError> {
        let text = input_file::read_to_string(path)
            .map_err(|source| PlantError::Read { path: path.to_owned(), reason: source.to_string() })?;
        let limits =
            |line: &str| line.trim_start().starts_with("format") && line.contains("hydrotrace.limits");
        if text.lines().any(limits) {
            return Err(PlantError::Limits { path: path.to_owned() });
        }
        Self::parse(&text).map_err(|error| PlantError::File { path: path.to_owned(), error: Box::new(error) })
    }
}

/// The line, from 1, in which a span starts.
fn line_of(text: &str, span: &Range<usize>) -> usize {
    1 + memchr::memchr_iter(b'\n', &text.as_bytes()[..span.start.min(text.len())]).count()
}

/// The base's numbers, else joints all of whose numbers are zero.
fn begin(text: &str, file: &File) -> Result<Parameters, PlantError> {
    let title = file.title.clone();
    let refuse =
        |span: Range<usize>, message| Err(PlantError::Syntax { line: line_of(text, &span), message });
    match (&file.base, &file.joints) {
        (Some(base), None) => match Parameters::preset(base.get_ref()) {
            Ok(base) => Ok(Parameters { title, ..base }),
            Err(error) => refuse(base.span(), format!("base: {error}")),
        },
        (None, Some(given)) => {
            let joint = |name: &String| JointParameters { name: name.clone(), ..JointParameters::default() };
            let joints = given.get_ref().iter().map(joint).collect();
            match twice(given.get_ref()) {
                None => Ok(Parameters { title, joints, ..Parameters::default() }),
                Some(found) => refuse(
                    given.span(),
                    format!("joints: found {found}; name every joint of the arm once, in its order"),
                ),
            }
        }
        (Some(_), Some(given)) => refuse(
            given.span(),
            "joints: found beside base, whose joints are those of the sample arm: leave them out, or give every number \
             of a machine with other joints in place of base, as sample-logs/plant/default.toml does"
                .into(),
        ),
        (None, None) => refuse(0..0, "missing field `joints`".into()),
    }
}

/// What is wrong with the names of joints.
fn twice(names: &[String]) -> Option<String> {
    let mut sorted: Vec<&String> = names.iter().collect();
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Some(format!("{:?} twice", pair[0])),
        None => sorted.is_empty().then(|| "none".to_owned()),
    }
}

struct Reader<'a> {
    text: &'a str,
    joints: Vec<String>,
    /// Whether the file has no base and so all that a machine cannot lack.
    whole: bool,
    /// Where each quantity stands.
    lines: BTreeMap<(&'static str, &'static str), usize>,
}

impl Reader<'_> {
    /// Takes the numbers of one table, which holds nothing else.
    fn table(&mut self, name: &str, table: &Table, into: &mut Parameters) -> Result<(), PlantError> {
        let known = || QUANTITIES.iter().filter(|quantity| quantity.key.0 == name);
        let stray = table.iter().find(|(key, _)| !known().any(|quantity| quantity.key.1 == key.as_str()));
        if let Some((key, values)) = stray {
            let alike = |quantity: &Quantity| strsim::jaro(quantity.key.1, key);
            let nearest = known().max_by(|a, b| alike(a).total_cmp(&alike(b))).filter(|q| alike(q) > 0.7);
            let (line, key) = (line_of(self.text, &values.span()), format!("{name}.{key}"));
            let nearest = nearest.map(|quantity| quantity.key.1.to_owned());
            return Err(PlantError::UnknownKey { line, key, nearest });
        }
        known().try_for_each(|quantity| self.quantity(quantity, table.get(quantity.key.1), into))
    }

    fn quantity(
        &mut self,
        quantity: &Quantity,
        given: Option<&Spanned<Values>>,
        into: &mut Parameters,
    ) -> Result<(), PlantError> {
        let key = || format!("{}.{}", quantity.key.0, quantity.key.1);
        let Some(given) = given else {
            // Zero, or as in the base.
            if quantity.optional || !self.whole {
                return Ok(());
            }
            let ((least, most), by_joint) = (quantity.range, matches!(quantity.place, Place::Joint(_)));
            return Err(PlantError::MissingKey { key: key(), least, most, by_joint });
        };
        let line = line_of(self.text, &given.span());
        self.lines.insert(quantity.key, line);
        match (quantity.place, given.get_ref()) {
            (Place::Machine(of), Values::All(value)) => *of(into) = quantity.unit * value,
            (Place::Machine(_), Values::ByJoint(_)) => {
                let message = format!("{} holds for the whole machine: give one number", key());
                return Err(PlantError::Syntax { line, message });
            }
            (Place::Joint(of), Values::All(value)) => {
                into.joints.iter_mut().for_each(|joint| *of(joint) = quantity.unit * value);
            }
            (Place::Joint(of), Values::ByJoint(values)) => {
                if !values.keys().all(|name| self.joints.contains(name)) || values.len() < self.joints.len() {
                    let found = values.keys().map(String::as_str).collect::<Vec<_>>().join(", ");
                    let declared = self.joints.join(", ");
                    return Err(PlantError::Joints { line, key: key(), found, declared });
                }
                for joint in &mut into.joints {
                    let value = values.get(&joint.name).copied().unwrap_or(f64::NAN);
                    *of(joint) = quantity.unit * value;
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = include_str!("../../sample-logs/plant/default.toml");

    fn message(from: &str, to: &str) -> String {
        assert!(TEXT.contains(from), "{from}");
        Parameters::parse(&TEXT.replace(from, to)).unwrap_err().to_string()
    }

    fn line(word: &str) -> usize {
        1 + TEXT.lines().position(|line| line.starts_with(word)).unwrap()
    }

    #[test]
    fn angles_become_radians_and_a_number_alone_holds_for_all_joints() {
        let parameters = Parameters::parse(TEXT).unwrap();
        assert!(parameters.joints.iter().all(|joint| (joint.encoder.noise_rad - 1.745e-4).abs() < 1e-7));
        assert_eq!(parameters.joints[5].name, "J6");
    }

    #[test]
    fn what_was_written_as_json_reads_back() {
        let parameters = Parameters::parse(TEXT).unwrap();
        let text = serde_json::to_string(&parameters).unwrap();
        assert_eq!(serde_json::from_str::<Parameters>(&text).unwrap(), parameters);
    }

    #[test]
    fn errors_name_line_key_and_what_belongs_there() {
        let at = line("hysteresis");
        assert_eq!(
            message("hysteresis = 0.006", "hysteresis = 6"),
            format!("line {at}: valve.hysteresis of J1 is 6; a number from 0 to 0.5 is expected")
        );
        assert_eq!(
            message("hysteresis = 0.006", "hysteresis = nan"),
            format!("line {at}: valve.hysteresis of J1 is NaN; a number from 0 to 0.5 is expected")
        );
        assert_eq!(
            message("hysteresis = 0.006", "histeresis = 0.006"),
            format!("line {at}: unknown key valve.histeresis; is hysteresis meant?")
        );
        assert_eq!(
            message("hysteresis = 0.006", ""),
            "valve.hysteresis is missing: give a number from 0 to 0.5, or a table with one for each joint"
        );
        assert_eq!(
            message("hysteresis = 0.006", "hysteresis = { J1 = 0.006, J9 = 1 }"),
            format!(
                "line {at}: valve.hysteresis is for J1, J9; the plant's joints are J1, J2, J3, J4, J5, J6"
            )
        );
        assert_eq!(
            message("hysteresis = 0.006", "hysteresis = \"much\""),
            format!("line {at}: expected a number, or a table with a number for each joint")
        );
    }

    #[test]
    fn numbers_must_agree_with_each_other() {
        let at = line("period_s");
        assert_eq!(
            message("period_s = 0.01", "period_s = 0.01005"),
            format!(
                "line {at}: control.period_s is 0.01005; a multiple of the simulation's step, 0.0001 s, is expected"
            )
        );
        let at = line("breakaway_n");
        assert_eq!(
            message("breakaway_n = { J1 = 1150", "breakaway_n = { J1 = 500"),
            format!(
                "line {at}: friction.breakaway_n of J1 is 500; no less than coulomb_n, 650 N, is expected"
            )
        );
    }

    #[test]
    fn a_file_with_a_base_holds_what_differs() {
        let parse = |text: &str| Parameters::parse(text).map_err(|error| error.to_string());
        let late = parse("title = \"late\"\nbase = \"default\"\n[valve]\ndead_time_s = 0.3").unwrap();
        let mut expected = Parameters::preset("default").unwrap();
        expected.title = "late".into();
        expected.joints.iter_mut().for_each(|joint| joint.valve.dead_time_s = 0.3);
        assert_eq!(late, expected);
        let error = parse("title = \"\"\nbase = \"softt\"").unwrap_err();
        assert!(
            error.starts_with("line 2: base: there is no plant \"softt\", did you mean \"soft\"?"),
            "{error}"
        );
        let error = parse("title = \"\"\nbase = \"default\"\njoints = [\"J1\"]").unwrap_err();
        assert!(error.starts_with("line 3: joints: found beside base"), "{error}");
        assert_eq!(parse("title = \"\"").unwrap_err(), "line 1: missing field `joints`");
    }

    #[test]
    fn joints_are_named_once() {
        let names = r#"joints = ["J1", "J2", "J3", "J4", "J5", "J6"]"#;
        assert!(message(names, r#"joints = ["J1", "J1"]"#).contains(r#"found "J1" twice"#));
        assert!(message(names, "joints = []").contains("found none"));
    }
}
