//! What a fit found: tables, JSON, and the file that brings it back.

mod page;
mod tables;

pub(super) use page::fitted;
pub(crate) use page::page;
pub(crate) use tables::document;

use crate::fit::{Estimated, JointFit};

/// How a quantity is shown.
pub(in crate::render) struct Shown {
    /// As in tables.
    pub(in crate::render) name: &'static str,
    /// Of a joint.
    pub(in crate::render) of: fn(&JointFit) -> Estimated,
    /// From SI to what people read.
    pub(in crate::render) scale: fn(f64) -> f64,
    /// Decimals.
    pub(in crate::render) decimals: usize,
}

impl Shown {
    /// The value with its interval, a bound, or nothing.
    pub(in crate::render) fn cell(&self, joint: &JointFit) -> String {
        let found = (self.of)(joint);
        let number = |si: f64| format!("{:.*}", self.decimals, (self.scale)(si));
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
