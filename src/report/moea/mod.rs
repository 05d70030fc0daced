//! What the evolutionary algorithms reach: text, JSON, CSV and pictures.

mod document;
mod paper;
mod picture;
mod rows;
mod tables;

pub use document::moea_json;
pub use picture::curve_svg;
pub use rows::{curves_csv, front_csv};
pub use tables::moea_parts;

use crate::workflow::moea::{FEW_SEEDS, Inputs};

/// What a reader of the figures must know.
fn notes(inputs: &Inputs) -> Vec<String> {
    let seeds = match inputs.seeds {
        1 => format!("One seed, {}", inputs.first_seed),
        n => format!(
            "Medians and quartiles of {n} seeds, {} to {}",
            inputs.first_seed,
            inputs.first_seed.wrapping_add(n - 1)
        ),
    };
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
        "Against nsga3: win or loss where the two-sided rank-sum test gives p < 0.05, not corrected for the number \
         of comparisons; A is the probability that a run is better than one of nsga3 (Vargha and Delaney), 0.5 for \
         no difference."
            .to_owned(),
    ];
    if inputs.seeds < FEW_SEEDS {
        notes.push(format!(
            "Fewer than {FEW_SEEDS} seeds: quartiles and p say little; more come with --seeds."
        ));
    }
    notes
}

/// That many significant digits.
fn significant(value: f64, digits: u8) -> String {
    if !value.is_finite() {
        return value.to_string();
    }
    #[expect(clippy::cast_possible_truncation, reason = "an exponent")]
    let exponent = if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 };
    let after = i32::from(digits.max(1)) - 1;
    let places = |count: i32| usize::try_from(count).unwrap_or(0);
    if exponent < -2 {
        format!("{value:.*e}", places(after))
    } else {
        format!("{value:.*}", places(after - exponent))
    }
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn figures_keep_their_digits_at_every_size() {
        let values = [343.91, 19.4134, 1.18, 0.0557, 0.000_123_45, 12_345.6, 0.0, f64::INFINITY];
        let shown = values.map(|value| significant(value, 4));
        assert_eq!(shown, ["343.9", "19.41", "1.180", "0.05570", "1.234e-4", "12346", "0.000", "inf"]);
    }
}
