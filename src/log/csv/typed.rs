//! The type of a variable that a controller writes into its name: `boom_set_REAL32`, `LREAL_boom_set`, `boom_set (INT)`.

use super::says_side;

/// Types that are no other word.
const TYPES: [&str; 22] = [
    "real32", "real64", "lreal", "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64",
    "sint", "usint", "uint", "dint", "udint", "lint", "ulint", "float32", "float64", "f32", "f64",
];

/// Types that are other words, too, and count beside one that says a side: `REAL` is the measurement in Spanish, and valves
/// float.
const WORDS: [&str; 4] = ["REAL", "INT", "FLOAT", "DOUBLE"];

const SEPARATORS: [char; 4] = ['_', '.', ' ', ':'];

/// The header without the type.
pub(super) fn without_type(header: &str) -> &str {
    let is = |name: &str, text: &str| is_type(text) || WORDS.contains(&text.trim()) && says_side(name);
    let inner = header.strip_suffix([')', ']']).and_then(|text| text.rsplit_once(['(', '[']));
    let apart = inner.or_else(|| header.rsplit_once(':'));
    if let Some((name, _)) = apart.filter(|(name, text)| is(name, text)) {
        return name.trim_end();
    }
    let behind = header.rsplit_once(SEPARATORS).filter(|(name, text)| is(name, text));
    let before = || header.split_once(SEPARATORS).filter(|(text, name)| is(name, text));
    let name = behind.map(|(name, _)| name).or_else(|| before().map(|(_, name)| name));
    name.map(|name| name.trim_matches(SEPARATORS)).filter(|name| !name.is_empty()).unwrap_or(header)
}

fn is_type(text: &str) -> bool {
    TYPES.iter().any(|one| text.trim().eq_ignore_ascii_case(one))
}

/// Whether a cell below a name is the type of the numbers, in letters of any case.
pub(super) fn names_type(cell: &str) -> bool {
    is_type(cell) || WORDS.iter().chain(&["BOOL"]).any(|one| cell.trim().eq_ignore_ascii_case(one))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_type_stands_apart_and_is_no_side() {
        for (header, name) in [
            ("boom_set_REAL32", "boom_set"),
            ("boom_set_lreal", "boom_set"),
            ("LREAL_boom_set", "boom_set"),
            ("boom_set (REAL)", "boom_set"),
            ("GVL.boom_set : DINT", "GVL.boom_set"),
            ("boom_set_REAL", "boom_set"),
            ("boom_set_FLOAT", "boom_set"),
            ("boom_REAL", "boom_REAL"),
            ("boom_float", "boom_float"),
            ("POSICION (REAL)", "POSICION (REAL)"),
            ("boom_set_real", "boom_set_real"),
            ("boom_surreal", "boom_surreal"),
            ("boom_set [deg]", "boom_set [deg]"),
            ("q[0]", "q[0]"),
            ("float", "float"),
            ("_float", "_float"),
        ] {
            assert_eq!(without_type(header), name, "{header}");
        }
    }
}
