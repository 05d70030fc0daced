//! Metrics as columns and cells: degrees for joints that turn, millimetres for joints that slide, milliseconds.

use super::kit::{Align, Column, Sentence, Table, deg, ms, optional, share};
use crate::{
    replay::{Dimension, Metric, Read, Rules},
    series::JointKind::{self, Slides, Turns},
    units::degrees_from_radians,
};

pub(super) fn number(dimension: Dimension, kind: JointKind, value: f64) -> String {
    match (dimension, kind) {
        (Dimension::Position | Dimension::Area, Turns) | (Dimension::Angle, _) => deg(value),
        (Dimension::Position | Dimension::Area, Slides) | (Dimension::Distance, _) => {
            format!("{:.2}", 1e3 * value)
        }
        (Dimension::Speed | Dimension::Acceleration, _) => format!("{:.1}", on_paper(kind, value)),
        (Dimension::Instant, _) => format!("{value:.2}"),
        (Dimension::Duration, _) => ms(value),
        (Dimension::Share, _) => share(value),
        (Dimension::Correlation, _) => format!("{value:.3}"),
        (Dimension::Sign, _) => if value < 0.0 { "-" } else { "+" }.to_owned(),
        (Dimension::Count | Dimension::Word, _) => format!("{value:.0}"),
    }
}

/// Its unit; empty if it has none.
pub(super) fn unit(dimension: Dimension, kind: JointKind) -> &'static str {
    match (dimension, kind) {
        (Dimension::Position, Turns) | (Dimension::Angle, _) => "deg",
        (Dimension::Position, Slides) | (Dimension::Distance, _) => "mm",
        (Dimension::Speed, Turns) => "deg/s",
        (Dimension::Speed, Slides) => "mm/s",
        (Dimension::Acceleration, Turns) => "deg/s2",
        (Dimension::Acceleration, Slides) => "mm/s2",
        (Dimension::Area, Turns) => "deg s",
        (Dimension::Area, Slides) => "mm s",
        (Dimension::Instant, _) => "s",
        (Dimension::Duration, _) => "ms",
        _ => "",
    }
}

pub(super) fn with_unit(dimension: Dimension, kind: JointKind, value: f64) -> String {
    format!("{} {}", number(dimension, kind, value), unit(dimension, kind)).trim_end().to_owned()
}

pub(super) fn position(kind: JointKind, value: f64) -> String {
    with_unit(Dimension::Position, kind, value)
}

/// How joints that turn and joints that slide are told apart from worse ones, where there are both.
pub(super) fn weighed(rules: &Rules, kinds: impl Iterator<Item = JointKind>) -> Option<Sentence> {
    let [turns, slides] = [Turns, Slides].map(|kind| position(kind, rules.sizes(kind).settle_band));
    has_both(kinds).then(|| Sentence::note(format!("To tell the worst, {turns} counts as much as {slides}.")))
}

fn has_both(kinds: impl Iterator<Item = JointKind>) -> bool {
    let seen: Vec<JointKind> = kinds.collect();
    [Turns, Slides].iter().all(|kind| seen.contains(kind))
}

/// What a mean over joints of both kinds takes a length for; `None` for joints of one kind.
pub(super) fn lengths_as_angles(kinds: impl Iterator<Item = JointKind>) -> Option<String> {
    has_both(kinds).then(|| format!("{} counts as {}", position(Slides, 0.01), position(Turns, 0.01)))
}

/// A position, speed or acceleration in degrees or millimetres.
pub(super) fn on_paper(kind: JointKind, value: f64) -> f64 {
    match kind {
        Turns => degrees_from_radians(value),
        Slides => 1e3 * value,
    }
}

/// How joints show numbers side by side: a unit in the heading if they share one, else behind each number.
#[derive(Clone, Copy)]
pub(super) struct Units(Option<JointKind>);

impl Units {
    /// Of joints of these kinds.
    pub(super) fn of(mut kinds: impl Iterator<Item = JointKind>) -> Self {
        let first = kinds.next().unwrap_or_default();
        Self(kinds.all(|kind| kind == first).then_some(first))
    }

    /// Whether some turn and some slide.
    pub(super) fn mixed(self) -> bool {
        self.0.is_none()
    }

    /// A mean over all joints, with its unit; of both kinds no unit of one is true.
    pub(super) fn mean(self, value: f64) -> String {
        self.0.map_or_else(|| format!("{value:.4} (rad, m)"), |kind| position(kind, value))
    }

    /// The number of it alone.
    pub(super) fn mean_number(self, value: f64) -> String {
        self.0.map_or_else(|| format!("{value:.4}"), |kind| number(Dimension::Position, kind, value))
    }

    /// The heading of such numbers.
    pub(super) fn mean_heading(self, heading: &str) -> String {
        if self.mixed() { format!("{heading} (rad, m)") } else { self.heading(heading, Dimension::Position) }
    }

    /// `peak deg`.
    pub(super) fn heading(self, heading: &str, dimension: Dimension) -> String {
        let kind = if dimension.is_of_joint() { self.0 } else { Some(Turns) };
        kind.map_or(heading.to_owned(), |kind| {
            format!("{heading} {}", unit(dimension, kind)).trim_end().to_owned()
        })
    }

    /// A number of a joint.
    pub(super) fn cell(self, dimension: Dimension, kind: JointKind, value: f64) -> String {
        if dimension.is_of_joint() && self.0.is_none() {
            with_unit(dimension, kind, value)
        } else {
            number(dimension, kind, value)
        }
    }

    /// The columns of a table of metrics that have a heading, a row for each of `all`.
    pub(super) fn table<'a, T: 'a>(
        self,
        metrics: &'static [Metric<T>],
        all: impl Iterator<Item = (&'a T, JointKind)>,
    ) -> Table {
        let shown: Vec<&Metric<T>> = metrics.iter().filter(|metric| !metric.heading.is_empty()).collect();
        let columns = shown.iter().map(|metric| Column {
            align: if matches!(metric.dimension, Dimension::Word | Dimension::Sign) {
                Align::Left
            } else {
                Align::Right
            },
            ..Column::words(self.heading(metric.heading, metric.dimension)).meaning(metric.explanation)
        });
        let row =
            |(one, kind): (&T, JointKind)| shown.iter().map(|metric| self.shown(metric, one, kind)).collect();
        Table::of(columns.collect::<Vec<_>>(), all.map(row).collect::<Vec<_>>())
    }

    fn shown<T>(self, metric: &Metric<T>, one: &T, kind: JointKind) -> String {
        let show = |value: f64| self.cell(metric.dimension, kind, value);
        match metric.read {
            Read::Word(read) => read(one),
            Read::Interval(_, read) => {
                read(one).map_or("-".to_owned(), |[low, high]| format!("{}..{}", show(low), show(high)))
            }
            Read::Number(read) => {
                let interval = metric.interval.and_then(|read| read(one));
                let behind =
                    interval.map_or(String::new(), |[low, high]| format!(" ({}..{})", show(low), show(high)));
                read(one).map_or((metric.missing)(one).to_owned(), |value| show(value) + &behind)
            }
        }
    }

    pub(super) fn optional(self, dimension: Dimension, kind: JointKind, value: Option<f64>) -> String {
        optional(value, |value| self.cell(dimension, kind, value))
    }
}

/// The columns of every metric in a CSV.
pub(super) fn csv_columns<T>(metrics: &'static [Metric<T>]) -> impl Iterator<Item = &'static str> {
    metrics.iter().flat_map(|metric| match metric.read {
        Read::Interval(ends, _) => ends.to_vec(),
        Read::Word(_) | Read::Number(_) => vec![metric.key],
    })
}

/// The cells under them, in SI units.
pub(super) fn csv_cells<T>(metrics: &'static [Metric<T>], one: &T) -> Vec<String> {
    let number = |value: Option<f64>| value.map_or(String::new(), |v| format!("{v}"));
    let cells = metrics.iter().flat_map(|metric| match metric.read {
        Read::Word(read) => vec![read(one)],
        Read::Number(read) => vec![number(read(one))],
        Read::Interval(_, read) => {
            read(one).map_or(vec![String::new(); 2], |ends| ends.map(|end| number(Some(end))).to_vec())
        }
    });
    cells.collect()
}
