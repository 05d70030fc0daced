//! What the algorithms reach on tasks of the arm: text, JSON, CSV and pictures.

mod document;
mod picture;
mod published;
mod rows;
mod tables;

pub use document::contest_json;
pub use picture::contest_svg;
pub use rows::contest_csv;
pub use tables::contest_document;

use super::sample::{AGAINST, few, seeds};
use crate::{
    plan::{BEYOND, Search},
    workflow::contest::{Inputs, MEASURED_PLANS},
};

/// What a reader of the figures must know.
fn notes(inputs: &Inputs) -> Vec<String> {
    let mut notes = vec![
        format!(
            "{}; a run of its own for every budget. All but `seeded` start from random plans and get no descent, as \
             the paper's; `seeded` is what `hydrotrace plan` does: descents, then NSGA-III-FO, then descents, all \
             counted as evaluations; in parentheses the evaluations made where they are not those asked for.",
            seeds(inputs.first_seed, inputs.seeds)
        ),
        format!(
            "HV is a share of the box from the reference front's best to {BEYOND} times its range; more is better. \
             First that of the last population, of `seeded` {MEASURED_PLANS} plans spread evenly over its front; then \
             that of all that a run found, at most {} plans, as `plan` hands them over, also as a share of the \
             reference front's. Fastest and smoothest (f1, f2) are medians of the ends found; less is better.",
            Search::default().front
        ),
        format!(
            "The reference front is one seeded search of {} evaluations: no true front is known.",
            inputs.reference_evaluations
        ),
        AGAINST.to_owned(),
    ];
    notes.extend(few(inputs.seeds));
    notes
}

/// What the paper's Table 3 cannot be.
const FINDING: &str = "The paper prints f2 in N and f3 in J. No reading of its equations reproduces its f2 or f3 (29 \
     constructions of the spline and 54 functionals were tried). Nor can its table be an optimum of mean jerk: with rest \
     at both ends any mean of the jerk falls with the cube of the duration, and by the paper's own f2 of A its A stretched \
     to the duration of B has less than half of what it prints for B.";
