//! The metrics, one row each: of a transition, of a joint over the whole run, and of the tool.
//!
//! A row gives a column of the tables on terminal and page, the column of the CSV, the key in the document, what
//! `compare` compares, the limit with its option, and the explanation of all of them. A new metric is a row here, a
//! field beside it, and the line that computes it.

mod joint;
mod tool;
mod transition;

pub use joint::JOINT;
pub use tool::TOOL;
pub use transition::{ONSET_DELAY, ONSET_DELAY_LIMIT, PEAK_ERROR, TRANSITION};

use super::{JointReplay, ToolReplay, TrackingError, Transition, WholeRun, keyed::Keyed};
use crate::series::JointKind;

/// What a number is, and so its unit: that of a position is the joint's, rad or m.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// In the joint's unit.
    Position,
    /// In the joint's unit a second.
    Speed,
    /// In the joint's unit a second squared.
    Acceleration,
    /// In the joint's unit times seconds.
    Area,
    /// Between two places, m.
    Distance,
    /// Between two orientations, rad.
    Angle,
    /// Time since the first sample of the run, s.
    Instant,
    /// Time between two instants, s.
    Duration,
    /// Part of a whole, 0 to 1.
    Share,
    /// Between -1 and 1.
    Correlation,
    /// How many.
    Count,
    /// The sign of a direction.
    Sign,
    /// A name or a word.
    Word,
}

impl Dimension {
    /// Whether its unit depends on whether the joint turns or slides.
    pub const fn is_of_joint(self) -> bool {
        matches!(self, Self::Position | Self::Speed | Self::Acceleration | Self::Area)
    }

    /// Its SI unit in documents, where positions are those of joints of a kind.
    pub const fn unit(self, kind: JointKind) -> &'static str {
        match self {
            Self::Distance => JointKind::Slides.unit(),
            Self::Angle => JointKind::Turns.unit(),
            _ if self.is_of_joint() => kind.unit(),
            _ => "s",
        }
    }
}

/// How a metric is read.
#[derive(Debug)]
pub enum Read<T: 'static> {
    /// A name or a word, as in documents.
    Word(fn(&T) -> String),
    /// A number, if it could be measured.
    Number(fn(&T) -> Option<f64>),
    /// Both ends of an interval, and the key of each.
    Interval([&'static str; 2], fn(&T) -> Option<[f64; 2]>),
}

/// How the values of all joints make one of the arm.
#[derive(Debug, Clone, Copy)]
pub enum Together {
    /// Not at all.
    Nothing,
    /// Root mean square, weighted by time.
    Rms(fn(&JointReplay) -> Option<TrackingError>),
    /// What the replay has found of all joints.
    Whole(fn(&WholeRun) -> Option<f64>),
    /// The largest.
    Most,
    /// The mean.
    Mean,
}

/// Reads the interval of a figure.
pub type ReadInterval<T> = fn(&T) -> Option<[f64; 2]>;

/// A metric of `T`.
#[derive(Debug)]
pub struct Metric<T: 'static> {
    /// As in documents and CSV.
    pub key: &'static str,
    /// Of its column, without the unit; a column without a heading is left out of tables.
    pub heading: &'static str,
    /// What it is called in sentences.
    pub name: &'static str,
    /// What it means, in one sentence.
    pub explanation: &'static str,
    /// What the number is.
    pub dimension: Dimension,
    /// How it is read.
    pub read: Read<T>,
    /// Shown behind it in tables, in brackets.
    pub interval: Option<ReadInterval<T>>,
    /// Shown in tables in place of a number that could not be measured.
    pub missing: fn(&T) -> &'static str,
    /// Whether `compare` compares it.
    pub compared: bool,
    /// How `compare` makes one value of all joints.
    pub together: Together,
    /// Its limit, if it can be limited.
    pub limit: Option<Judged<T>>,
}

/// A limit on a metric, from above.
#[derive(Debug)]
pub struct Limit {
    /// As in documents.
    pub key: &'static str,
    /// Of the command line, in degrees, milliseconds or, at the tool, millimetres.
    pub option: &'static str,
    /// The same in millimetres, for joints that slide.
    pub sliding_option: Option<&'static str>,
    /// What is limited, in sentences.
    pub name: &'static str,
    /// What is limited, on the help page.
    pub help: &'static str,
    /// What the number is.
    pub dimension: Dimension,
    /// What it says of a joint where nothing could be measured, which keeps no limit.
    pub missing: &'static str,
}

/// A limit, and what it judges.
#[derive(Debug)]
pub struct Judged<T: 'static> {
    /// The limit.
    pub limit: Limit,
    /// Whether it is judged.
    pub counts: fn(&T) -> bool,
    /// When it was found, s; for a mean over the run, when the error peaked.
    pub at_s: fn(&T) -> Option<f64>,
}

impl<T> Metric<T> {
    const fn new(
        key: &'static str,
        heading: &'static str,
        name: &'static str,
        explanation: &'static str,
        dimension: Dimension,
        read: Read<T>,
    ) -> Self {
        Self {
            key,
            heading,
            name,
            explanation,
            dimension,
            read,
            interval: None,
            missing: |_| "-",
            compared: false,
            together: Together::Nothing,
            limit: None,
        }
    }

    const fn compared(mut self, together: Together) -> Self {
        self.compared = true;
        self.together = together;
        self
    }

    const fn within(mut self, interval: fn(&T) -> Option<[f64; 2]>) -> Self {
        self.interval = Some(interval);
        self
    }

    const fn limited(mut self, limit: Judged<T>) -> Self {
        self.limit = Some(limit);
        self
    }

    const fn or(mut self, missing: fn(&T) -> &'static str) -> Self {
        self.missing = missing;
        self
    }

    /// The number, if it is one and could be measured.
    pub fn number(&self, of: &T) -> Option<f64> {
        match self.read {
            Read::Number(read) => read(of),
            Read::Word(_) | Read::Interval(..) => None,
        }
    }
}

impl Limit {
    const fn new(
        key: &'static str,
        option: &'static str,
        sliding_option: Option<&'static str>,
        name: &'static str,
        help: &'static str,
        dimension: Dimension,
    ) -> Self {
        Self { key, option, sliding_option, name, help, dimension, missing: "nothing measured" }
    }

    const fn or(mut self, missing: &'static str) -> Self {
        self.missing = missing;
        self
    }
}

impl<T> Judged<T> {
    const fn new(limit: Limit, counts: fn(&T) -> bool, at_s: fn(&T) -> Option<f64>) -> Self {
        Self { limit, counts, at_s }
    }
}

/// Every limit, of transitions, of joints, then of the tool.
pub fn limits() -> impl Iterator<Item = &'static Limit> {
    let transitions = TRANSITION.iter().filter_map(|metric| Some(&metric.limit.as_ref()?.limit));
    let joints = JOINT.iter().filter_map(|metric| Some(&metric.limit.as_ref()?.limit));
    transitions.chain(joints).chain(TOOL.iter().filter_map(|metric| Some(&metric.limit.as_ref()?.limit)))
}

impl Keyed for Limit {
    fn key(&self) -> &'static str {
        self.key
    }

    fn rows() -> Vec<&'static Self> {
        limits().collect()
    }
}

macro_rules! keyed {
    ($($of:ty: $table:ident),*) => {
        $(impl Keyed for Metric<$of> {
            fn key(&self) -> &'static str {
                self.key
            }

            fn rows() -> Vec<&'static Self> {
                $table.iter().filter(|metric| metric.compared).collect()
            }
        })*
    };
}

keyed!(Transition: TRANSITION, JointReplay: JOINT, ToolReplay: TOOL);
