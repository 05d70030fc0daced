//! The robot's URDF, where a log carries it.

use super::content::Extracted;

/// Last part of the names of topics that hold a URDF.
const TOPIC: &str = "robot_description";

/// Ending of the names of files that hold a URDF.
const FILE: &str = ".urdf";

/// Whether the messages of a topic are URDFs.
pub(super) fn is_topic(topic: &str) -> bool {
    topic.rsplit('/').next() == Some(TOPIC)
}

/// The description that a log holds: that of a message, else that of a file.
pub(super) fn of(extracted: &Extracted) -> Option<String> {
    let message = extracted.description.as_ref().map(|(_, text)| text.clone());
    message.or_else(|| {
        let file = extracted.attachments.iter().find(|file| file.name.ends_with(FILE))?;
        Some(String::from_utf8_lossy(&file.data).into_owned())
    })
}

/// `std_msgs/msg/String` in plain CDR, of either byte order.
pub(super) fn text(data: &[u8]) -> Option<String> {
    let little_endian = match data.get(..2)? {
        [0, 1] => true,
        [0, 0] => false,
        _ => return None,
    };
    let length = data.get(4..8)?.first_chunk::<4>()?;
    let length = if little_endian { u32::from_le_bytes(*length) } else { u32::from_be_bytes(*length) };
    let bytes = data.get(8..)?.get(..usize::try_from(length).ok()?)?;
    let bytes = bytes.strip_suffix(&[0]).unwrap_or(bytes);
    Some(String::from_utf8_lossy(bytes).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_read_in_either_byte_order_and_a_broken_one_is_none() {
        let little = [0, 1, 0, 0, 3, 0, 0, 0, b'a', b'b', 0];
        let big = [0, 0, 0, 0, 0, 0, 0, 3, b'a', b'b', 0];
        assert_eq!([text(&little), text(&big)], [Some("ab".to_owned()), Some("ab".to_owned())]);
        for end in 0..little.len() {
            assert_eq!(text(&little[..end]), None);
        }
        assert_eq!(text(&[0, 7, 0, 0, 1, 0, 0, 0, 0]), None);
        assert_eq!(text(&[0, 1, 0, 0, 255, 255, 255, 255, 0]), None);
    }
}
