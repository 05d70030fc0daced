//! What the evolutionary algorithms reach: text, JSON, CSV and pictures.

mod document;
mod paper;
mod picture;
mod rows;
mod tables;

pub use document::moea_json;
pub(super) use picture::colour;
pub use picture::curve_svg;
pub use rows::{curves_csv, front_csv};
pub use tables::moea_document;

use super::sample::{AGAINST, few, seeds};
use crate::workflow::moea::Inputs;

/// What a reader of the figures must know.
fn notes(inputs: &Inputs) -> Vec<String> {
    let seeds = seeds(inputs.first_seed, inputs.seeds);
    let operators = &inputs.operators;
    let mut notes = vec![
        format!(
            "{seeds}; simulated binary crossover with rate {} and eta {}, polynomial mutation with eta {}; a run of \
             its own for every budget, because the focus of nsga3-fo fades over it.",
            operators.crossover_rate, operators.crossover_eta, operators.mutation_eta
        ),
        "Less IGD and IGD+ is better, more hypervolume (HV) is better; HV is a share of the box from 0 to the \
         reference point, which is 1.1 times the front's largest objectives."
            .to_owned(),
        AGAINST.to_owned(),
    ];
    notes.extend(few(inputs.seeds));
    notes
}
