//! Message paths of Foxglove: a topic, fields and places in lists, and what is done to the number.

use std::fmt::Write as _;

use crate::log::Step;

/// What is done to a number before it is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Modifier {
    None,
    /// From radians.
    Degrees,
}

/// The path to a number; `None` if no path can express it.
pub(super) fn message_path(topic: &str, steps: &[Step], modifier: Modifier) -> Option<String> {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let is_topic = !topic.is_empty() && topic.chars().all(|c| bare(c) || c == '/');
    let mut path = if is_topic { topic.to_owned() } else { quoted(topic) };
    for step in steps {
        match step {
            Step::Field(name) if !name.is_empty() && name.chars().all(bare) => {
                path.push('.');
                path.push_str(name);
            }
            Step::Field(name) => {
                path.push('.');
                path.push_str(&quoted(name));
            }
            Step::Place(place) => {
                let _ = write!(path, "[{place}]");
            }
            // Such a string has no escapes.
            Step::Named { name, .. } => {
                let quote = ['"', '\''].into_iter().find(|quote| !name.contains(*quote))?;
                let _ = write!(path, "[:]{{name=={quote}{name}{quote}}}");
            }
        }
    }
    if modifier == Modifier::Degrees {
        path.push_str(".@rad2deg");
    }
    Some(path)
}

fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('\\', "\\\\").replace('"', "\\\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(topic: &str, steps: &[Step]) -> Option<String> {
        message_path(topic, steps, Modifier::None)
    }

    #[test]
    fn fields_places_and_names_are_spelt_as_foxglove_reads_them() {
        let field = |name: &str| Step::Field(name.to_owned());
        let named = |name: &str| Step::Named { name: name.to_owned(), place: None };
        let position = [field("position"), Step::Place(2)];
        assert_eq!(path("/joint_states", &position).unwrap(), "/joint_states.position[2]");
        assert_eq!(message_path("/a", &position, Modifier::Degrees).unwrap(), "/a.position[2].@rad2deg");
        assert_eq!(path("/a.b c", &[field("x y")]).unwrap(), "\"/a.b c\".\"x y\"");
        assert_eq!(path("a\"\\", &[]).unwrap(), r#""a\"\\""#);
        let of = |name: &str| path("/a", &[field("joints"), named(name), field("position")]);
        assert_eq!(of("J1").unwrap(), "/a.joints[:]{name==\"J1\"}.position");
        assert_eq!(of("J\"1").unwrap(), "/a.joints[:]{name=='J\"1'}.position");
        assert_eq!(of("'J\"1"), None);
    }
}
