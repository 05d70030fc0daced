//! Axes and numbers of charts.

use std::ops::Range;

use plotters::{
    coord::{
        ranged1d::{DefaultFormatting, KeyPointHint, Ranged},
        types::RangedCoordf64,
    },
    prelude::RGBColor,
};

pub(super) const INK: RGBColor = RGBColor(51, 51, 51);
pub(super) const GRID: RGBColor = RGBColor(225, 225, 225);
pub(super) const FONT: &str = "sans-serif";

/// A linear axis with ticks of our own.
pub(super) struct Axis {
    linear: RangedCoordf64,
    ticks: Vec<f64>,
}

impl Axis {
    pub(super) fn new(range: Range<f64>, ticks: Vec<f64>) -> Self {
        Self { linear: range.into(), ticks }
    }
}

impl Ranged for Axis {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        self.linear.map(value, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        self.linear.range()
    }
}

/// Multiples of 1, 2 or 5 times a power of ten, at most `most` of them.
pub(super) fn steps(low: f64, high: f64, most: u32) -> Vec<f64> {
    let rough = (high - low) / f64::from(most.max(1));
    let power = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|k| k * power).into_iter().find(|s| *s >= rough).unwrap_or(rough);
    let first = (low / step).ceil();
    (0..=most).map(|k| (first + f64::from(k)) * step).filter(|v| *v <= high * (1.0 + 1e-12)).collect()
}

/// Without the zeros at the end.
pub(super) fn short(value: f64) -> String {
    let text = significant(value, 4);
    if text.contains('.') && !text.contains('e') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// So many significant digits.
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
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(steps(0.0, 50_000.0, 5), [0.0, 10_000.0, 20_000.0, 30_000.0, 40_000.0, 50_000.0]);
        assert_eq!(
            steps(0.11, 0.39, 6),
            [0.15, 0.2, 0.25, 0.3, 0.35].map(|v: f64| (v / 0.05).round() * 0.05)
        );
    }

    #[test]
    fn figures_keep_their_digits_at_every_size() {
        let values = [343.91, 19.4134, 1.18, 0.0557, 0.000_123_45, 12_345.6, 0.0, f64::INFINITY];
        let shown = values.map(|value| significant(value, 4));
        assert_eq!(shown, ["343.9", "19.41", "1.180", "0.05570", "1.234e-4", "12346", "0.000", "inf"]);
    }
}
