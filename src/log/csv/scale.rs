//! A scale that a header writes as words before its unit: `[tenths of deg]`, `boom_set_milli_rad`, `[pi rad]`.

use std::f64::consts::PI;

use super::{
    unit::{ANOTHER, Measure, REVOLUTION, Unit, parse_unit, scale_by},
    word::{Meaning, words},
};

/// Words that stand for a factor, and compounds begin with: `zehntelgrad`.
const SCALES: [(f64, &str); 9] = [
    (0.1, "tenths tenth deci dezi zehntel"),
    (0.01, "hundredths hundredth centi zenti hundertstel"),
    (1e-3, "thousandths thousandth milli tausendstel"),
    (1e-6, "micro mikro"),
    (1e-9, "nano"),
    (1e3, "kilo"),
    (0.5, "half halbe"),
    (0.25, "quarter"),
    (PI, "pi π"),
];
/// Between a scale and its unit.
const FILLERS: [&str; 6] = ["of", "a", "an", "one", "the", "eines"];

/// A compound of a scale and a unit of fewer letters may be any word.
const SHORTEST: usize = 3;

/// Runs of letters and digits, and where they begin.
fn tokens(text: &str) -> Vec<(usize, &str)> {
    let separates = |c: char| !(c.is_alphanumeric() || ['°', 'º'].contains(&c));
    let mut start = 0;
    let pieces = text.split_inclusive(separates).map(|piece| {
        start += piece.len();
        (start - piece.len(), piece.trim_end_matches(separates))
    });
    pieces.filter(|(_, token)| !token.is_empty()).collect()
}

fn scales() -> impl Iterator<Item = (&'static str, f64)> {
    SCALES.iter().flat_map(|(factor, words)| words.split(' ').map(|word| (word, *factor)))
}

/// The scaled unit that begins at a token, and its last token; `text` is in lower case.
fn scaled_at(text: &str, tokens: &[(usize, &str)], at: usize) -> Option<(usize, Unit)> {
    let word = tokens.get(at)?.1;
    let Some((name, factor)) = scales().find(|(scale, _)| *scale == word) else {
        let unit = scales().find_map(|(scale, factor)| {
            let name = word.strip_prefix(scale).filter(|name| name.chars().count() >= SHORTEST)?;
            scale_by(factor, name)
        });
        return Some((at, unit?));
    };
    let unit_at = (at + 1..tokens.len()).find(|&at| !FILLERS.contains(&tokens[at].1))?;
    let ends = [unit_at + 1, unit_at].into_iter().filter(|end| *end < tokens.len());
    let found = ends.map(|end| (end, &text[tokens[unit_at].0..tokens[end].0 + tokens[end].1.len()]));
    let fits = |unit: &str| !["pi", "π"].contains(&name) || unit.starts_with("rad");
    let (end, unit) = found
        .filter(|(_, unit)| fits(unit))
        .find_map(|(end, unit)| Some((end, scale_by(factor, &unit.replace(['°', 'º'], "deg"))?)))?;
    // Of `milli_deg_per_s` the unit is not all that is meant.
    let more = tokens.get(end + 1).is_some_and(|(_, next)| ["s", "sec", "per"].contains(next));
    Some((end, if more { ANOTHER } else { unit }))
}

/// The unit that a text names, in words of a scale too.
pub(super) fn unit_named(text: &str) -> Option<Unit> {
    parse_unit(text).or_else(|| in_words(&text.to_lowercase()))
}

/// The same of a text that is a unit and nothing else, in brackets or below a header: there a letter is one, too.
pub(super) fn unit_alone(text: &str) -> Option<Unit> {
    const REVOLUTIONS: [&str; 3] = ["U", "tr", "tour"];
    // TwinCAT puts the quantity behind it: `deg (Angle)`.
    let alone = text.trim().strip_suffix(')').and_then(|text| text.split_once('('));
    let alone = alone.filter(|(_, quantity)| quantity.chars().all(|c| c.is_alphabetic() || c == ' '));
    let text = alone.map_or(text, |(unit, _)| unit).trim();
    unit_named(text).or_else(|| REVOLUTIONS.contains(&text).then_some(REVOLUTION))
}

/// The unit that a text in lower case is, if it is words of a scale and a unit.
fn in_words(text: &str) -> Option<Unit> {
    let tokens = tokens(text);
    scaled_at(text, &tokens, 0).filter(|(end, _)| end + 1 == tokens.len()).map(|(_, unit)| unit)
}

/// The unit within a header whose scale is words, and the header without both.
pub(super) fn in_header(header: &str) -> Option<(String, Unit)> {
    let lower = header.to_lowercase();
    // Lower case may be longer or shorter than the name in some scripts.
    let lower = if lower.len() == header.len() { lower } else { header.to_owned() };
    let tokens = tokens(&lower);
    // `degx10` counts tenths.
    let times = |at: usize| {
        let word = tokens[at].1;
        let unit = parse_unit(word).filter(|unit| unit.measure != Measure::Other || unit.is_odd());
        Some((at, unit.filter(|_| word.contains('x') && word.ends_with('0'))?))
    };
    let found = |at: usize| Some((at, scaled_at(&lower, &tokens, at).or_else(|| times(at))?));
    let (at, (end, unit)) = (0..tokens.len()).find_map(found)?;
    let before = header.get(..tokens[at].0)?;
    let behind = header.get(tokens[end].0 + tokens[end].1.len()..)?.trim_start_matches([']', ')', '）']);
    let name = format!("{before}{behind}");
    let name = name.trim_matches([' ', '_', '.', '[', '(', '（']);
    name.contains(char::is_alphanumeric).then(|| (name.to_owned(), unit))
}

/// Whether the unit in brackets stands behind a word that may be a scale: `[dozens of deg]`, `[x10 deg]`.
pub(super) fn is_unclear(text: &str) -> bool {
    const SAY_NOTHING: [&str; 4] = ["in", "unit", "units", "einheit"];
    let text = text.to_lowercase();
    let tokens = tokens(&text);
    let [.., (_, before), (_, unit)] = tokens.as_slice() else { return false };
    let measures = [Measure::Angle, Measure::AngularSpeed, Measure::Length, Measure::LinearSpeed];
    let is_unit =
        unit.chars().count() > 1 && parse_unit(unit).is_some_and(|unit| measures.contains(&unit.measure));
    let is_known = SAY_NOTHING.contains(before)
        || parse_unit(before).is_some()
        || words(before).iter().all(|word| word.meaning != Meaning::Name);
    // Numbers are of a range, `(0-360 deg)`, unless they multiply.
    let counts = before.bytes().all(|byte| byte.is_ascii_digit());
    let multiplies = tokens.iter().any(|(_, token)| *token == "x");
    is_unit && if counts { multiplies } else { !is_known }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scale_in_words_makes_another_unit_and_leaves_the_name_of_the_joint() {
        for (header, name, unit) in [
            ("boom_set [tenths of deg]", "boom_set", "0.1 deg"),
            ("boom_set [hundredths of a degree]", "boom_set", "0.01 deg"),
            ("boom_set [milli deg]", "boom_set", "0.001 deg"),
            ("boom_set [pi rad]", "boom_set", "pi rad"),
            ("boom_set (half turns)", "boom_set", "pi rad"),
            ("boom_set_tenth_deg", "boom_set", "0.1 deg"),
            ("boom_set_deci_deg", "boom_set", "0.1 deg"),
            ("Boom Set centi degrees", "Boom Set", "0.01 deg"),
            ("boom_set_centidegrees", "boom_set", "0.01 deg"),
            ("boom_set_milli_rad", "boom_set", "mrad"),
            ("boom_milli_rad/s_set", "boom__set", "mrad/s"),
            ("boom_tenth_mm_set", "boom__set", "0.1 mm"),
            ("q_milli_deg[0]", "q_[0]", "0.001 deg"),
            ("Zeit [tausendstel s]", "Zeit", "ms"),
            ("boom_set_degx10", "boom_set", "0.1 deg"),
            ("boom_quarter_deg_set", "boom__set", "another unit"),
            ("boom_milli_deg_per_s", "boom__per_s", "another unit"),
        ] {
            let found = in_header(header).map(|(name, unit)| (name, unit.name));
            assert_eq!(found, Some((name.to_owned(), unit)), "{header}");
        }
        for header in ["boom_set_deg", "pi_set_rad", "pi_deg", "half_set", "milli deg", "micro_1_deg", "deg"]
        {
            assert_eq!(in_header(header), None, "{header}");
        }
        assert_eq!(in_words("milli deg").map(|unit| unit.name), Some("0.001 deg"));
    }

    #[test]
    fn what_may_be_a_scale_before_a_unit_in_brackets_is_told_from_what_is_none() {
        for text in ["dozens of deg", "x10 deg", "x 10 deg", "electrical deg"] {
            assert!(is_unclear(text), "{text}");
        }
        for text in
            ["deg", "deg abs", "in deg", "angle, deg", "0-360 deg", "0 to 360 deg", "boom", "rad/s", ""]
        {
            assert!(!is_unclear(text), "{text}");
        }
    }
}
