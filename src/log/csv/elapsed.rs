//! Spans of time as controllers and tables write them.

use crate::units::{NS_PER_S, whole_ns};

/// For a person.
pub(super) const NAME: &str = "time passed, as T#1m2s or 0 days 00:01:02";

/// Of minutes and seconds alone.
pub(super) const MINUTES: &str = "time passed, as mm:ss.s";

/// Whether a span is told in minutes and seconds alone, whose clock may begin again after the hour.
pub(super) fn is_minutes(text: &str) -> bool {
    text.bytes().all(|byte| byte.is_ascii_digit() || matches!(byte, b':' | b'.' | b',' | b' '))
}

/// Units of a span such as `1m2s500ms`, in ns; a name that begins another stands behind it.
const UNITS: [(&str, f64); 7] =
    [("d", 86_400e9), ("h", 3_600e9), ("ms", 1e6), ("m", 60e9), ("us", 1e3), ("ns", 1.0), ("s", NS_PER_S)];

/// The span that a text gives, ns: `T#1m2s500ms` of controllers, `0 days 00:01:02.5` of tables, `01:02.5`.
pub(super) fn elapsed_ns(text: &str) -> Option<i64> {
    let text = text.trim().to_lowercase();
    let plc = ["t#", "time#", "ltime#", "lt#"].iter().find_map(|mark| text.strip_prefix(mark));
    let days = text.split_once(" days ").or_else(|| text.split_once(" day "));
    let ns = match (plc, days) {
        (Some(parts), _) => parts_ns(parts)?,
        (None, Some((days, clock))) => {
            clock_ns(clock.trim().trim_start_matches('+'), 3)? + days.trim().parse::<f64>().ok()? * 86_400e9
        }
        (None, None) if text.contains(['.', ',']) => clock_ns(&text, 2)?,
        (None, None) => return None,
    };
    whole_ns(ns)
}

/// `1m2s500ms`
fn parts_ns(text: &str) -> Option<f64> {
    let (sign, mut rest) = text.strip_prefix('-').map_or((1.0, text), |rest| (-1.0, rest));
    let mut sum_ns = 0.0;
    if rest.is_empty() {
        return None;
    }
    while !rest.is_empty() {
        let digits = rest.find(|c: char| !(c.is_ascii_digit() || c == '.'))?;
        let value: f64 = rest[..digits].parse().ok()?;
        let (name, unit_ns) = UNITS.iter().find(|(name, _)| rest[digits..].starts_with(name))?;
        sum_ns += value * unit_ns;
        rest = rest[digits + name.len()..].trim_start_matches('_');
    }
    Some(sign * sum_ns)
}

/// `hh:mm:ss.s` or `mm:ss.s`
fn clock_ns(text: &str, parts: usize) -> Option<f64> {
    if text.split(':').count() != parts {
        return None;
    }
    let seconds = text.split(':').enumerate().try_fold(0.0, |sum, (k, part)| {
        let last = k + 1 == parts;
        let digits = part.bytes().all(|byte| byte.is_ascii_digit() || last && matches!(byte, b'.' | b','));
        let value: f64 = part.replace(',', ".").parse().ok().filter(|_| digits)?;
        (k == 0 || value < 60.0).then_some(60.0 * sum + value)
    })?;
    Some(seconds * NS_PER_S)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_span_in_every_spelling_is_one_span() {
        for text in
            ["T#1m2s500ms", "t#1M_2.5S", "LTIME#62s500000us", "0 days 00:01:02.500000", "01:02.5", "1:02,500"]
        {
            assert_eq!(elapsed_ns(text), Some(62_500_000_000), "{text}");
        }
        assert_eq!(elapsed_ns("T#0ms"), Some(0));
        assert_eq!(elapsed_ns("2 days 00:00:01"), Some(172_801_000_000_000));
        assert_eq!(elapsed_ns("-1 days +23:59:59"), Some(-1_000_000_000));
        for text in ["", "T#", "T#5", "T#5x", "12:30", "1:75.0", "1:2:3.0", "a:b.c", "0.5", "3 days"] {
            assert_eq!(elapsed_ns(text), None, "{text}");
        }
    }
}
