//! A row of numbers as a row of bars, one character each.

const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// Bars from 0 to `most`; a blank where there is no number.
pub(in crate::render) fn spark(values: &[Option<f64>], most: f64) -> String {
    values.iter().map(|value| value.map_or(' ', |value| bar(value, most))).collect()
}

/// The lowest bar is for what reaches at most an eighth of `most`, or is no number.
fn bar(value: f64, most: f64) -> char {
    let share = if most > 0.0 { value / most } else { 0.0 };
    let reached = BARS.iter().enumerate().rev().find(|(k, _)| share * BARS.len() as f64 > *k as f64);
    reached.map_or('▁', |(_, bar)| *bar)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_grow_with_the_number_by_eighths_of_the_most() {
        let values = [0.0, 0.1, 0.25, 0.26, 0.5, 0.875, 0.88, 1.0].map(Some);
        assert_eq!(spark(&values, 1.0), "▁▁▂▃▄▇██");
        assert_eq!(spark(&[Some(1.0), None, Some(2.0)], 2.0), "▄ █");
    }

    #[test]
    fn no_error_at_all_and_what_is_no_number_are_low_bars() {
        assert_eq!(spark(&[Some(0.0), Some(0.0)], 0.0), "▁▁");
        assert_eq!(spark(&[Some(f64::NAN)], 1.0), "▁");
    }
}
