//! Text from logs and paths, made fit for where it goes: a terminal, a shell, a spreadsheet.

use std::{borrow::Cow, path::Path};

/// The character, or one in its place if it would steer a terminal or turn the reading direction of what follows.
pub(crate) fn harmless(c: char) -> char {
    let turns = matches!(c, '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
        | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}');
    if c.is_control() || turns { char::REPLACEMENT_CHARACTER } else { c }
}

/// A cell of a table that no spreadsheet takes for a formula: text that would be one begins with an apostrophe.
/// Numbers stay as they are.
pub(crate) fn spreadsheet_cell(text: &str) -> Cow<'_, str> {
    let formula = text.starts_with(['=', '+', '-', '@', '\t', '\r']) && text.parse::<f64>().is_err();
    if !formula && text.chars().all(|c| harmless(c) == c) {
        return text.into();
    }
    let start = if formula { "'" } else { "" };
    start.chars().chain(text.chars().map(harmless)).collect::<String>().into()
}

/// The text of a cell that [`spreadsheet_cell`] wrote.
pub(crate) fn of_spreadsheet_cell(cell: &str) -> &str {
    cell.strip_prefix('\'').filter(|text| text.starts_with(['=', '+', '-', '@'])).unwrap_or(cell)
}

/// A path as an argument in a POSIX shell: quoted if it holds anything but plain characters. A name that starts with a
/// dash would be taken for an option.
pub(crate) fn shell_argument(path: impl AsRef<Path>) -> String {
    let text = path.as_ref().to_string_lossy();
    if text.starts_with('-') { shell_word(&format!("./{text}")) } else { shell_word(&text) }
}

/// A text as one word of a POSIX shell: an option, or the value of one.
pub(crate) fn shell_word(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "._-/+:@%=,".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

/// Decimals that a small number has more at most.
const MORE_DECIMALS: usize = 6;

/// A number with so many decimals, or with two digits where it is so small that these would hide it.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    let least = crate::math::whole((1.0 - value.abs().log10().floor()).clamp(0.0, 99.0));
    let more = least > decimals && least <= decimals + MORE_DECIMALS;
    let text = format!("{value:.*}", if more { least } else { decimals });
    let nothing = text.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.'));
    text.strip_prefix('-').filter(|_| nothing).map_or(text.clone(), str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_number_shows_two_digits_and_rounding_none() {
        for (value, decimals, text) in [
            (12.345, 2, "12.35"),
            (0.123, 2, "0.12"),
            (0.0123, 2, "0.012"),
            (-4.56e-5, 4, "-0.000046"),
            (3e-12, 2, "0.00"),
            (0.0, 2, "0.00"),
            (-3e-12, 2, "0.00"),
            (0.43, 0, "0.43"),
        ] {
            assert_eq!(fixed(value, decimals), text);
        }
    }

    #[test]
    fn what_steers_a_terminal_or_turns_text_round_is_replaced_and_other_scripts_stay() {
        let text = "a\u{1b}[31m\u{202e}b\u{200b}\u{2066}c\u{9b}";
        let found: String = text.chars().map(harmless).collect();
        assert_eq!(found, "a\u{fffd}[31m\u{fffd}b\u{fffd}\u{fffd}c\u{fffd}");
        let scripts = "Ausleger größer Стрела 臂 ذراع";
        assert_eq!(scripts.chars().map(harmless).collect::<String>(), scripts);
    }

    #[test]
    fn a_cell_is_a_formula_for_no_spreadsheet_and_numbers_are_numbers() {
        for (text, cell) in [
            ("=cmd|' /C calc'!A0", "'=cmd|' /C calc'!A0"),
            ("@SUM(1)", "'@SUM(1)"),
            ("-1+2", "'-1+2"),
            ("-1.5e-3", "-1.5e-3"),
            ("+7", "+7"),
            ("joint_1", "joint_1"),
            ("a\u{1b}]0;x\u{7}", "a\u{fffd}]0;x\u{fffd}"),
        ] {
            assert_eq!(spreadsheet_cell(text), cell);
            assert!(of_spreadsheet_cell(cell) == text || text.contains('\u{1b}'), "{cell}");
        }
    }

    #[test]
    fn a_shell_takes_every_path_as_one_word() {
        for (path, word) in [
            ("a/run-1.mcap", "a/run-1.mcap"),
            ("my run.mcap", "'my run.mcap'"),
            ("it's 1.mcap", "'it'\\''s 1.mcap'"),
            ("$HOME;rm", "'$HOME;rm'"),
            ("-o", "./-o"),
            ("", "''"),
        ] {
            assert_eq!(shell_argument(path), word);
        }
    }
}
