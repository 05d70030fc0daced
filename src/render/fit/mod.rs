//! What a fit found: tables, JSON, and the file that brings it back.

mod page;
mod supply;
mod tables;

pub(super) use page::fitted;
pub(crate) use page::page;
pub(in crate::render) use supply::{litres, supply};
pub(crate) use tables::document;
pub(in crate::render) use tables::shared;

use super::metric::{Units, on_paper, unit};
use crate::{
    fit::{Estimated, JointFit},
    replay::Dimension,
    series::JointKind,
};

pub(in crate::render) struct Shown {
    /// Above a column, without the unit.
    heading: &'static str,
    /// In a sentence.
    name: &'static str,
    of: fn(&JointFit) -> Estimated,
    dimension: Dimension,
    /// Of degrees; of millimetres one less.
    decimals: usize,
}

impl Shown {
    fn number(&self, kind: JointKind, si: f64) -> String {
        let of_length = self.dimension.is_of_joint() && kind == JointKind::Slides;
        let shown = match self.dimension {
            Dimension::Duration => 1e3 * si,
            Dimension::Share => 100.0 * si,
            of_joint if of_joint.is_of_joint() => on_paper(kind, si),
            _ => si,
        };
        format!("{:.*}", self.decimals - usize::from(of_length), shown)
    }

    /// The value with its interval, a bound, or nothing; with its unit where the joints of a table share none.
    fn cell(&self, joint: &JointFit, units: Units) -> String {
        let shown = self.alone(joint);
        let of_joint = self.dimension.is_of_joint() && units.mixed() && shown != crate::render::kit::NONE;
        if of_joint { format!("{shown} {}", unit(self.dimension, joint.kind)) } else { shown }
    }

    fn alone(&self, joint: &JointFit) -> String {
        let found = (self.of)(joint);
        let number = |si: f64| self.number(joint.kind, si);
        match (found.value, found.interval, found.lower_bound) {
            (Some(value), Some([low, high]), _) if found.identified => {
                format!("{} ({}..{})", number(value), number(low), number(high))
            }
            (_, _, Some(bound)) => format!(">= {}", number(bound)),
            (Some(value), ..) => match found.upper_bound {
                Some(bound) => format!("<= {}", number(bound)),
                None => format!("({})", number(value)),
            },
            _ => crate::render::kit::NONE.to_owned(),
        }
    }
}
