//! The name that was meant by one that does not exist.

/// Likeness (Jaro-Winkler, 0 to 1) from which a name may have been meant.
const LIKE: f64 = 0.8;

/// The name most like the one looked for, whatever the case of its letters, if any is like it.
pub(crate) fn nearest<'a>(name: &str, present: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let wanted = name.to_lowercase();
    present
        .into_iter()
        .map(|other| (strsim::jaro_winkler(&wanted, &other.to_lowercase()), other))
        .filter(|(likeness, _)| *likeness > LIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, other)| other.to_owned())
}

/// `, did you mean "x"?` for the middle of an error, or nothing.
pub(crate) fn suggestion(nearest: Option<&str>) -> String {
    nearest.map(|name| format!(", did you mean {name:?}?")).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_is_mended_and_another_word_is_not_taken_for_one() {
        let topics = ["/planned/joint_states", "/joint_states", "/tf"];
        assert_eq!(nearest("/planed/joint_states", topics).as_deref(), Some("/planned/joint_states"));
        assert_eq!(nearest("/Joint_State", topics).as_deref(), Some("/joint_states"));
        assert_eq!(nearest("J11", ["J1", "j2"]).as_deref(), Some("J1"));
        assert_eq!(nearest("wheel", topics), None);
        assert_eq!(nearest("", topics), None);
    }
}
