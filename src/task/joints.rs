//! Quantities by joint: degrees of joints that turn, millimetres of those that slide. A joint slides if the file says
//! something of it in millimetres.

use std::{collections::BTreeMap, ops::Range};

use toml::Spanned;

use super::{
    Boundary, JointLimits, TaskError,
    document::{Document, End, Limits, Point, Speed},
};
use crate::{series::JointKind, units::radians_from_degrees};

/// One table of the file.
type Table<'a, T> = Option<&'a Spanned<BTreeMap<String, T>>>;

/// A quantity: its tables and their keys, of joints that turn and of joints that slide.
pub(super) struct Given<'a, T> {
    keys: [String; 2],
    tables: [Table<'a, T>; 2],
}

impl<'a, T> Given<'a, T> {
    /// The tables that there are, with their keys and the kind of their joints.
    fn tables(&self) -> impl Iterator<Item = (&str, JointKind, &'a Spanned<BTreeMap<String, T>>)> {
        let kinds = [JointKind::Turns, JointKind::Slides];
        self.keys
            .iter()
            .zip(kinds)
            .zip(self.tables)
            .filter_map(|((key, kind), table)| Some((&**key, kind, table?)))
    }

    /// The same, with where they stand and the joints that they name.
    fn named(&self) -> impl Iterator<Item = (&str, JointKind, Range<usize>, Vec<&'a String>)> {
        self.tables().map(|(key, kind, table)| (key, kind, table.span(), table.get_ref().keys().collect()))
    }

    pub(super) fn is_given(&self) -> bool {
        self.tables.iter().any(Option::is_some)
    }
}

/// Two fields of a part of the file, whose keys they are behind a prefix.
macro_rules! given {
    ($prefix:expr, $part:ident, $turns:ident, $slides:ident) => {
        Given {
            keys: [stringify!($turns), stringify!($slides)].map(|key| [$prefix, key].concat()),
            tables: [$part.$turns.as_ref(), $part.$slides.as_ref()],
        }
    };
}

pub(super) fn positions(point: &Point) -> Given<'_, f64> {
    given!("", point, angles_deg, positions_mm)
}

fn at_end<'a>(end: &str, given: &'a End) -> [Given<'a, f64>; 3] {
    let prefix = &*format!("{end}.");
    [
        given!(prefix, given, speed_deg_s, speed_mm_s),
        given!(prefix, given, acceleration_deg_s2, acceleration_mm_s2),
        given!(prefix, given, jerk_deg_s3, jerk_mm_s3),
    ]
}

fn speeds(given: &Limits) -> Given<'_, Speed> {
    given!("limits.", given, speed_deg_s, speed_mm_s)
}

fn of_limits(given: &Limits) -> [Given<'_, f64>; 3] {
    [
        given!("limits.", given, acceleration_deg_s2, acceleration_mm_s2),
        given!("limits.", given, jerk_deg_s3, jerk_mm_s3),
        given!("limits.", given, torque_n_m, force_n),
    ]
}

fn ranges(given: &Limits) -> Given<'_, [f64; 2]> {
    given!("limits.", given, range_deg, range_mm)
}

/// In rad, or in m, and their derivatives.
fn si(kind: JointKind, shown: f64) -> f64 {
    match kind {
        JointKind::Turns => radians_from_degrees(shown),
        JointKind::Slides => 1e-3 * shown,
    }
}

const ABOVE_ZERO: &str = "limits above zero are expected";

/// The line, from 1, in which a span starts.
pub(super) fn line_of(text: &str, span: &Range<usize>) -> usize {
    let start = span.start.min(text.len());
    1 + memchr::memchr_iter(b'\n', &text.as_bytes()[..start]).count()
}

/// The joints of a task, and its text.
#[derive(Clone, Copy)]
pub(super) struct Joints<'a> {
    pub(super) text: &'a str,
    pub(super) names: &'a [String],
    /// How they move, as far as the file says it.
    pub(super) kinds: &'a [Option<JointKind>],
}

impl Joints<'_> {
    fn declared(&self) -> String {
        self.names.join(", ")
    }

    /// How the joints move, in their order; `None` of those that the file says nothing of.
    ///
    /// # Errors
    ///
    /// [`TaskError`] for a joint that both turns and slides.
    pub(super) fn kinds(&self, file: &Document) -> Result<Vec<Option<JointKind>>, TaskError> {
        let mut known: BTreeMap<&String, (JointKind, usize, &str)> = BTreeMap::new();
        let ends = [("start", &file.start), ("end", &file.end)];
        let ends = ends.into_iter().filter_map(|(name, end)| Some(at_end(name, end.as_ref()?)));
        let numbers = file.points.iter().map(|point| positions(point.get_ref()));
        let numbers: Vec<Given<'_, f64>> =
            numbers.chain(ends.flatten()).chain(of_limits(&file.limits)).collect();
        let (ranges, speeds) = (ranges(&file.limits), speeds(&file.limits));
        let named = numbers.iter().flat_map(Given::named).chain(ranges.named()).chain(speeds.named());
        for (key, kind, span, joints) in named {
            let line = line_of(self.text, &span);
            for joint in joints {
                let (first, said, other) = *known.entry(joint).or_insert((kind, line, key));
                if first != kind {
                    let (key, joint, other) = (key.to_owned(), joint.clone(), other.to_owned());
                    return Err(TaskError::TwoKinds { line, key, joint, said, other });
                }
            }
        }
        Ok(self.names.iter().map(|name| known.get(name).map(|(kind, ..)| *kind)).collect())
    }

    /// Values as the file has them, with how the joints move, in the order of the joints; `otherwise` for those left out, an
    /// error if it is none.
    fn by_joint<T: Copy>(
        &self,
        given: &Given<'_, T>,
        otherwise: Option<T>,
    ) -> Result<Vec<(T, JointKind)>, TaskError> {
        for (key, _, table) in given.tables() {
            if let Some(joint) = table.get_ref().keys().find(|name| !self.names.contains(name)) {
                let (line, key, joint) = (line_of(self.text, &table.span()), key.to_owned(), joint.clone());
                return Err(TaskError::UnknownJoint { line, key, joint, declared: self.declared() });
            }
        }
        let of = |(joint, kind): (&String, &Option<JointKind>)| {
            let own = given.tables().find_map(|(_, kind, table)| Some((*table.get_ref().get(joint)?, kind)));
            own.or_else(|| Some((otherwise?, JointKind::Turns)))
                .ok_or_else(|| self.missing(given, joint, *kind))
        };
        self.names.iter().zip(self.kinds).map(of).collect()
    }

    /// The error of a joint that is left out where all that move as it does are needed.
    fn missing<T>(&self, given: &Given<'_, T>, joint: &str, kind: Option<JointKind>) -> TaskError {
        let kind = kind.or(given.tables().next().map(|(_, kind, _)| kind)).unwrap_or_default();
        let alike = self.names.iter().zip(self.kinds).filter(|(_, own)| own.is_none_or(|own| own == kind));
        let declared: Vec<&str> = alike.map(|(name, _)| &**name).collect();
        let line = given.tables().next().map_or(1, |(_, _, table)| line_of(self.text, &table.span()));
        let key = given.keys[usize::from(kind == JointKind::Slides)].clone();
        TaskError::MissingJoint { line, key, joint: joint.to_owned(), declared: declared.join(", ") }
    }

    /// The error of a value in one of the tables.
    fn wrong<T>(
        &self,
        given: &Given<'_, T>,
        kind: JointKind,
        found: String,
        expected: &'static str,
    ) -> TaskError {
        let own = given.tables().find(|(_, own, _)| *own == kind).or_else(|| given.tables().next());
        let (key, line) = own.map_or((String::new(), 1), |(key, _, table)| {
            (key.to_owned(), line_of(self.text, &table.span()))
        });
        TaskError::Value { line, key, found, expected }
    }

    /// As [`Self::by_joint`], finite, in rad or m.
    pub(super) fn values(
        &self,
        given: &Given<'_, f64>,
        otherwise: Option<f64>,
    ) -> Result<Vec<f64>, TaskError> {
        let values = self.checked(given, otherwise, f64::is_finite, "finite numbers are expected")?;
        Ok(values.into_iter().map(|(value, kind)| si(kind, value)).collect())
    }

    /// As [`Self::by_joint`], each as it may be.
    fn checked(
        &self,
        given: &Given<'_, f64>,
        otherwise: Option<f64>,
        may_be: fn(f64) -> bool,
        expected: &'static str,
    ) -> Result<Vec<(f64, JointKind)>, TaskError> {
        let values = self.by_joint(given, otherwise)?;
        match values.iter().find(|(value, _)| !may_be(*value)) {
            Some((value, kind)) => Err(self.wrong(given, *kind, value.to_string(), expected)),
            None => Ok(values),
        }
    }

    pub(super) fn boundary(&self, end: &str, given: Option<&End>) -> Result<Boundary, TaskError> {
        let Some(given) = given else {
            let rest = || vec![0.0; self.names.len()];
            return Ok(Boundary { velocity_rad_s: rest(), acceleration_rad_s2: rest(), jerk_rad_s3: rest() });
        };
        let [speed, acceleration, jerk] = at_end(end, given);
        Ok(Boundary {
            velocity_rad_s: self.values(&speed, Some(0.0))?,
            acceleration_rad_s2: self.values(&acceleration, Some(0.0))?,
            jerk_rad_s3: self.values(&jerk, Some(0.0))?,
        })
    }

    fn above_zero(&self, given: &Given<'_, f64>) -> Result<Vec<(f64, JointKind)>, TaskError> {
        self.checked(given, Some(f64::INFINITY), |value| value > 0.0, ABOVE_ZERO)
    }

    /// Lowest and highest speed, rad/s or m/s.
    fn speeds(&self, given: &Given<'_, Speed>) -> Result<Vec<[f64; 2]>, TaskError> {
        let found = self.by_joint(given, Some(Speed::Either(f64::INFINITY)))?;
        let checked = found.into_iter().map(|(speed, kind)| match speed {
            Speed::Either(most) if most > 0.0 => Ok([-most, most].map(|end| si(kind, end))),
            Speed::Either(most) => Err(self.wrong(given, kind, most.to_string(), ABOVE_ZERO)),
            Speed::Ways([low, high]) if low < 0.0 && high > 0.0 && (high - low).is_finite() => {
                Ok([low, high].map(|end| si(kind, end)))
            }
            Speed::Ways([low, high]) => {
                let expected =
                    "a lowest speed below zero is expected first, then a highest above it, both finite";
                Err(self.wrong(given, kind, format!("[{low}, {high}]"), expected))
            }
        });
        checked.collect()
    }

    pub(super) fn limits(&self, limits: &Limits) -> Result<Vec<JointLimits>, TaskError> {
        let ranges = ranges(limits);
        let found = self.by_joint(&ranges, Some([f64::NEG_INFINITY, f64::INFINITY]))?;
        let upside_down = |[low, high]: [f64; 2]| low >= high || low.is_nan() || high.is_nan();
        if let Some(([low, high], kind)) = found.iter().find(|(range, _)| upside_down(*range)) {
            let expected = "the lowest is expected first";
            return Err(self.wrong(&ranges, *kind, format!("[{low}, {high}]"), expected));
        }
        let range = |(range, kind): ([f64; 2], JointKind)| {
            range[0].max(-range[1]).is_finite().then(|| range.map(|end| si(kind, end)))
        };
        let [acceleration, jerk, effort] = of_limits(limits);
        let rate = |given: &Given<'_, f64>| -> Result<Vec<f64>, TaskError> {
            Ok(self.above_zero(given)?.into_iter().map(|(value, kind)| si(kind, value)).collect())
        };
        let speed = self.speeds(&speeds(limits))?;
        let (acceleration, jerk) = (rate(&acceleration)?, rate(&jerk)?);
        let effort = self.above_zero(&effort)?;
        let keys = ["limits.rod_speed_m_s"; 2].map(str::to_owned);
        let rod = Given { keys, tables: [limits.rod_speed_m_s.as_ref(), None] };
        let rod_speed = self.above_zero(&rod)?;
        let joints = found.into_iter().enumerate().map(|(j, found)| JointLimits {
            range_rad: range(found),
            velocity_rad_s: speed[j],
            acceleration_rad_s2: acceleration[j],
            jerk_rad_s3: jerk[j],
            torque_n_m: effort[j].0,
            rod_speed_m_s: rod_speed[j].0,
        });
        Ok(joints.collect())
    }
}
