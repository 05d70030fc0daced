//! Numbers of objects in a drive or of signals of a recorder, which their tools put into headers: `Position actual value (6064h)`,
//! `[0:12] Boom`.

use std::borrow::Cow;

/// Objects of the profile of drives (`CiA` 402) that are positions and speeds of its first axis.
const OBJECTS: [&str; 8] = ["6062", "6063", "6064", "607A", "606B", "606C", "60FC", "60FF"];

/// A header without the numbers of objects of a drive, in brackets or bare, with a subindex or without, and without that of a signal.
pub(super) fn without_object_number(header: &str) -> Cow<'_, str> {
    let header = without_signal_number(header);
    let is_separator = |c: char| c.is_whitespace() || "()[]_".contains(c);
    let number = header.split(is_separator).find(|word| is_object_number(word));
    let Some((before, after)) = number.and_then(|number| header.split_once(number)) else {
        return Cow::Borrowed(header);
    };
    let before = before.trim_end_matches(|c: char| is_separator(c) && !")]".contains(c));
    let after = after.trim_start_matches([')', ']']);
    Cow::Owned(format!("{before}{after}"))
}

/// Of `[0:12] Boom` what is behind module and channel; a point stands before the channel of a digital signal.
fn without_signal_number(header: &str) -> &str {
    let parts = header.strip_prefix('[').and_then(|rest| rest.split_once(']'));
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let named = parts.filter(|(number, name)| {
        let parts = number.split_once([':', '.']);
        !name.trim().is_empty()
            && parts.is_some_and(|(module, channel)| is_number(module) && is_number(channel))
    });
    named.map_or(header, |(_, name)| name.trim_start())
}

/// `6064h`, `0x6064` or `6064:00`.
fn is_object_number(word: &str) -> bool {
    let (index, has_subindex) = match word.split_once(':') {
        Some((index, sub)) if !sub.is_empty() && sub.bytes().all(|byte| byte.is_ascii_hexdigit()) => {
            (index, true)
        }
        Some(_) => return false,
        None => (word, false),
    };
    let plain = index
        .strip_prefix("0x")
        .or_else(|| index.strip_prefix("0X"))
        .or_else(|| index.strip_suffix(['h', 'H']));
    let Some(digits) = plain.or_else(|| has_subindex.then_some(index)) else { return false };
    OBJECTS.iter().any(|object| object.eq_ignore_ascii_case(digits))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_objects_are_no_part_of_a_name_and_other_numbers_are() {
        for (header, left) in [
            ("Axis1 Position actual value (6064h)", "Axis1 Position actual value"),
            ("Axis1 Position actual value [0x6064]", "Axis1 Position actual value"),
            ("Axis1_Position_demand_0x6062", "Axis1_Position_demand"),
            ("6062:00 Position demand [deg]", " Position demand [deg]"),
            ("Achse 1 Sollwert (6062:00) [mm]", "Achse 1 Sollwert [mm]"),
            ("[0:12] Boom Sollposition", "Boom Sollposition"),
            ("[12.3]Boom ist [deg]", "Boom ist [deg]"),
            ("[deg] Boom", "[deg] Boom"),
            ("[0:1]", "[0:1]"),
            ("joint 6064 [deg]", "joint 6064 [deg]"),
            ("pressure (1600h)", "pressure (1600h)"),
            ("planned 7050h [deg]", "planned 7050h [deg]"),
        ] {
            assert_eq!(without_object_number(header), left, "{header}");
        }
    }
}
