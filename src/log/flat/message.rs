//! The numbers of one message, and what each is called.

use chrono::DateTime;
use serde_json::{Number, Value};

use super::leaves::{Kind, Leaves, NANOSECONDS, SECONDS};
use crate::{
    log::decode::{Numbers, Sink, Slot, Texts},
    units::whole_ns,
};

/// Name of a number, parts between slashes, and the number.
pub(super) type Cells = Vec<(String, f64)>;

/// What a message said, in its order.
#[derive(Debug, Default)]
pub(super) struct Message {
    said: Vec<(Slot, Said)>,
}

#[derive(Debug)]
enum Said {
    Number(f64),
    Numbers(Vec<f64>),
    Text(String),
    Texts(Vec<String>),
    Element,
}

impl Message {
    /// The stamp, ns, if there is one, and the numbers.
    pub(super) fn cells(&self, leaves: &Leaves) -> (Option<i64>, Cells) {
        let of = |slot: Slot| leaves.all.get(usize::from(slot));
        let (mut second, mut nanosecond) = (None, 0.0);
        // Names that hold from where they are said: of an element of a list until the next.
        let mut element: Option<(&str, usize)> = None;
        let mut cells = Cells::new();
        for (at, (slot, said)) in self.said.iter().enumerate() {
            let Some((path, kind)) = of(*slot) else { continue };
            match (kind, said) {
                (Kind::Second, Said::Number(value)) => second = Some(*value),
                (Kind::Nanosecond, Said::Number(value)) => nanosecond = *value,
                (Kind::List, Said::Element) => {
                    let next = element.map_or(0, |(list, index)| if list == path { index + 1 } else { 0 });
                    element = Some((path, next));
                }
                (Kind::Number, Said::Number(value)) => {
                    let within = element.filter(|(list, _)| is_within(path, list));
                    let name = self.name(at, path, within.map(|(list, _)| list), leaves);
                    cells.push((called(path, within, name), *value));
                }
                (Kind::Number, Said::Numbers(values)) => {
                    let names = self.names(path, leaves).filter(|names| names.len() == values.len());
                    for (place, value) in values.iter().enumerate() {
                        let name = match names.and_then(|names| names.get(place)) {
                            Some(name) => called(path, None, Some(name)),
                            None => format!("{}[{place}]", path.replace('.', "/")),
                        };
                        cells.push((name, *value));
                    }
                }
                _ => {}
            }
        }
        (second.and_then(|second| stamp_ns(second, nanosecond)), cells)
    }

    /// The text that names the struct of a number: of its element if it is in a list.
    fn name(&self, at: usize, path: &str, list: Option<&str>, leaves: &Leaves) -> Option<&str> {
        let is_start = |(slot, said): &(Slot, Said)| {
            matches!(said, Said::Element)
                && leaves.all.get(usize::from(*slot)).is_some_and(|(path, _)| Some(path.as_str()) == list)
        };
        let from = self.said[..at].iter().rposition(is_start).filter(|_| list.is_some()).unwrap_or(0);
        let ends = self.said[at..].iter().position(is_start).filter(|_| list.is_some());
        let to = ends.map_or(self.said.len(), |ends| at + ends);
        self.said[from..to].iter().find_map(|(slot, said)| match (leaves.all.get(usize::from(*slot)), said) {
            (Some((name, Kind::Name)), Said::Text(text)) if is_beside(name, path) => Some(text.as_str()),
            _ => None,
        })
    }

    /// The texts that name the numbers of a list.
    fn names(&self, path: &str, leaves: &Leaves) -> Option<&[String]> {
        self.said.iter().find_map(|(slot, said)| match (leaves.all.get(usize::from(*slot)), said) {
            (Some((name, Kind::Name)), Said::Texts(texts)) if is_beside(name, path) => Some(&texts[..]),
            _ => None,
        })
    }
}

/// Whether a path leads into a list or struct.
fn is_within(path: &str, list: &str) -> bool {
    path.strip_prefix(list).is_some_and(|rest| rest.starts_with('.'))
}

/// Whether a name stands beside a number, or beside a struct that it is in.
fn is_beside(name: &str, path: &str) -> bool {
    name.rsplit_once('.').is_none_or(|(parent, _)| is_within(path, parent))
}

/// The path of a number with what it is of before its last part.
fn called(path: &str, element: Option<(&str, usize)>, name: Option<&str>) -> String {
    let (parent, last) = path.rsplit_once('.').unwrap_or(("", path));
    let parent = parent.replace('.', "/");
    let of = match (name, element) {
        (Some(name), _) => name.to_owned(),
        (None, Some((_, index))) => index.to_string(),
        (None, None) => return path.replace('.', "/"),
    };
    if parent.is_empty() { format!("{of}/{last}") } else { format!("{parent}/{of}/{last}") }
}

fn stamp_ns(second: f64, nanosecond: f64) -> Option<i64> {
    const MOST_S: f64 = 9e9;
    #[expect(clippy::cast_possible_truncation, reason = "both are within the range of i64")]
    let ns = |value: f64| value as i64;
    let valid = (0.0..MOST_S).contains(&second) && (0.0..1e9).contains(&nanosecond);
    valid.then(|| ns(second).saturating_mul(1_000_000_000).saturating_add(ns(nanosecond)))
}

impl Sink for Message {
    fn number(&mut self, slot: Slot, value: f64) {
        self.said.push((slot, Said::Number(value)));
    }

    fn text(&mut self, slot: Slot, text: &[u8]) {
        self.said.push((slot, Said::Text(String::from_utf8_lossy(text).into_owned())));
    }

    fn numbers(&mut self, slot: Slot, values: Numbers<'_>) {
        self.said.push((slot, Said::Numbers(values.to_vec())));
    }

    fn texts(&mut self, slot: Slot, values: Texts<'_>) {
        self.said.push((slot, Said::Texts(values.to_vec())));
    }

    fn element(&mut self, slot: Slot) {
        self.said.push((slot, Said::Element));
    }
}

/// Fields of an object that date it.
const TIMES: [&str; 6] = ["stamp", "timestamp", "@timestamp", "time", "ts", "t"];

/// The stamp of a parsed message, ns, if it has one that says the date, and its numbers.
pub(super) fn of_value(value: &Value) -> (Option<i64>, Cells) {
    let mut cells = Cells::new();
    walk(value, String::new(), &mut cells);
    let own = TIMES.iter().filter_map(|name| value.get(*name));
    let stamp_ns = value.pointer("/header/stamp").into_iter().chain(own).find_map(instant_ns);
    (stamp_ns, cells)
}

/// An instant as an object of seconds and their parts, as a text, or as a number since 1970.
fn instant_ns(instant: &Value) -> Option<i64> {
    match instant {
        Value::Object(_) => {
            let part = |names: &[&str]| names.iter().find_map(|name| instant.get(*name)?.as_f64());
            stamp_ns(part(&SECONDS)?, part(&NANOSECONDS).unwrap_or(0.0))
        }
        Value::String(text) => DateTime::parse_from_rfc3339(text).ok()?.timestamp_nanos_opt(),
        Value::Number(number) => since_1970_ns(number),
        _ => None,
    }
}

/// `None` of a count from elsewhere. Between 2001 and 2100 the size of a number tells its unit.
fn since_1970_ns(number: &Number) -> Option<i64> {
    const SECONDS: std::ops::Range<f64> = 1.0e9..4.1e9;
    const UNITS_NS: [i64; 4] = [1, 1_000, 1_000_000, 1_000_000_000];
    let value = number.as_f64()?;
    let unit_ns = UNITS_NS.into_iter().find(|unit_ns| SECONDS.contains(&(value * *unit_ns as f64 / 1e9)))?;
    let exact = number.as_i64().and_then(|whole| whole.checked_mul(unit_ns));
    exact.or_else(|| whole_ns(value * unit_ns as f64))
}

/// What an object says it is of.
fn name_of(value: &Value) -> Option<&str> {
    const NAMES: [&str; 4] = ["name", "joint", "joint_name", "axis"];
    NAMES.iter().find_map(|name| value.get(*name)?.as_str())
}

fn walk(value: &Value, path: String, cells: &mut Cells) {
    let join = |part: &str| if path.is_empty() { part.to_owned() } else { format!("{path}/{part}") };
    match value {
        Value::Number(number) => cells.extend(number.as_f64().map(|value| (path, value))),
        Value::Array(all) => {
            for (place, one) in all.iter().enumerate() {
                let of = if name_of(one).is_some() { path.clone() } else { format!("{path}[{place}]") };
                walk(one, of, cells);
            }
        }
        Value::Object(fields) => {
            let name = name_of(value);
            let dates = |field: &String| field == "header" || TIMES.contains(&field.as_str());
            for (field, one) in fields.iter().filter(|(field, _)| !dates(field)) {
                let at = name.map_or_else(|| join(field), |name| format!("{}/{field}", join(name)));
                walk(one, at, cells);
            }
        }
        _ => {}
    }
}
