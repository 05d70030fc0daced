//! The text of the arm's URDF, where a log carries it.

use std::path::PathBuf;

use super::{
    LogError, bag,
    channel::Definitions,
    file::{Blocks, MappedFile, MessageRecord, Opcode, records, scan},
    read::not_mcap,
};
use crate::remark::Remarks;

/// What a topic is called that holds a URDF.
const TOPIC: &str = "robot_description";

/// The first message on the topic of the robot's description in the files of one run; of several such
/// topics the one with the shortest name. `None` if there is none that can be read.
///
/// # Errors
///
/// [`LogError`] if a file cannot be opened or is no log.
pub fn read_description(paths: &[PathBuf]) -> Result<Option<String>, LogError> {
    let mut best: Option<(String, String)> = None;
    for path in bag::recording_files(paths, &mut Remarks::default())? {
        let map = MappedFile::open(&path).map_err(LogError::file("open", &path))?;
        let layout = scan(&map).ok_or_else(|| not_mcap(&path, &map))?;
        let definitions = Definitions::gather(&layout, false);
        let described = definitions
            .channels
            .iter()
            .filter(|(_, channel)| channel.topic.rsplit('/').next() == Some(TOPIC));
        let shortest = described.min_by_key(|(id, channel)| (channel.topic.len(), **id));
        let Some((&id, channel)) = shortest else { continue };
        if best.as_ref().is_some_and(|(topic, _)| topic.len() < channel.topic.len()) {
            continue;
        }
        let mut blocks = Blocks::new();
        let first = layout.blocks.iter().find_map(|block| {
            let messages = records(blocks.open(*block).0)
                .filter(|record| record.opcode == Opcode::MESSAGE)
                .filter_map(|record| MessageRecord::parse(record.body));
            messages.filter(|message| message.channel_id == id).find_map(|message| text(message.data))
        });
        if let Some(text) = first {
            best = Some((channel.topic.clone(), text));
        }
    }
    Ok(best.map(|(_, text)| text))
}

/// `std_msgs/msg/String` in plain CDR, of either byte order.
fn text(data: &[u8]) -> Option<String> {
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
