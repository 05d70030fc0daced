//! Numbers as people read them.

use crate::units::degrees_from_radians;

/// A cell for what is not there.
pub const NONE: &str = "-";

/// Without the sign of a zero.
fn unsigned_zero(text: String) -> String {
    let zero = text.starts_with('-') && text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    if zero { text.trim_start_matches('-').to_owned() } else { text }
}

/// Degrees with three decimals.
pub fn deg(rad: f64) -> String {
    unsigned_zero(format!("{:.3}", degrees_from_radians(rad)))
}

/// Millimetres with one decimal.
pub fn mm(m: f64) -> String {
    unsigned_zero(format!("{:.1}", 1e3 * m))
}

/// Whole milliseconds.
pub fn ms(s: f64) -> String {
    unsigned_zero(format!("{:.0}", s * 1e3))
}

/// By how much something is late or early.
pub fn late(s: f64) -> String {
    let ms = ms(s);
    ms.strip_prefix('-').map_or(format!("{ms} ms late"), |early| format!("{early} ms early"))
}

/// A share as whole percent.
pub fn share(share: f64) -> String {
    unsigned_zero(format!("{:.0}", 100.0 * share)) + " %"
}

/// A share as whole percent with its sign, without the unit.
pub fn percent(share: f64) -> String {
    signed(share, |share| unsigned_zero(format!("{:.0}", 100.0 * share)))
}

/// A difference with its sign.
pub fn signed(value: f64, show: impl Fn(f64) -> String) -> String {
    let text = show(value);
    let zero = text.chars().all(|c| matches!(c, '0' | '.'));
    if zero || text.starts_with('-') { text } else { format!("+{text}") }
}

/// A probability: three decimals, or two digits if it is small.
pub fn probability(p: f64) -> String {
    if p < 1e-99 {
        "below 1e-99".to_owned()
    } else if p < 0.001 {
        format!("{p:.1e}")
    } else {
        format!("{p:.3}")
    }
}

/// A value, or [`NONE`].
pub fn optional(value: Option<f64>, show: impl Fn(f64) -> String) -> String {
    value.map_or(NONE.to_owned(), show)
}

/// `one start`, `3 starts`.
pub fn counted(count: usize, noun: &str) -> String {
    if count == 1 { format!("one {noun}") } else { format!("{count} {noun}s") }
}

/// Planned starts of a joint, with the reversals among them.
pub fn starts_of(starts: usize, reversals: usize) -> String {
    let also = if reversals > 0 { " and reversals" } else { "" };
    format!("{}{also}", counted(starts, "planned start"))
}

/// Some of a number of things: `1 of 1 joint`, `3 of 6 joints`.
pub fn some_of(some: usize, count: usize, noun: &str) -> String {
    format!("{some} of {count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// That many significant digits.
pub fn significant(value: f64, digits: u8) -> String {
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

/// Four significant digits without the zeros at the end.
pub fn short(value: f64) -> String {
    let text = significant(value, 4);
    if text.contains('.') && !text.contains('e') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// With a capital in front.
pub(in crate::render) fn capital(name: &str) -> String {
    let (first, rest) = name.split_at(1);
    first.to_uppercase() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_keep_their_digits_at_every_size() {
        let values = [343.91, 19.4134, 1.18, 0.0557, 0.000_123_45, 12_345.6, 0.0, f64::INFINITY];
        let shown = values.map(|value| significant(value, 4));
        assert_eq!(shown, ["343.9", "19.41", "1.180", "0.05570", "1.234e-4", "12346", "0.000", "inf"]);
    }

    #[test]
    fn no_zero_has_a_sign() {
        assert_eq!([deg(-1e-9), ms(-1e-9), percent(-1e-9), signed(-1e-9, deg)], ["0.000", "0", "0", "0.000"]);
        assert_eq!([late(-1e-9), late(0.12), late(-0.072)], ["0 ms late", "120 ms late", "72 ms early"]);
        assert_eq!([deg(-0.1), ms(0.012), percent(0.5), signed(0.1, deg)], ["-5.730", "12", "+50", "+5.730"]);
    }
}
