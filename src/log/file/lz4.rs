//! Frames of lz4, unpacked in place: the frame reader of the library copies each block once more.

use lz4_flex::block::decompress_into_with_dict;

const MAGIC: [u8; 4] = [0x04, 0x22, 0x4d, 0x18];
/// How far back a block may refer.
const WINDOW: usize = 1 << 16;
/// A block that is not compressed, by the highest bit of its length.
const STORED: u32 = 1 << 31;

/// Bits of the frame's first byte of flags.
const VERSION: u8 = 0b1100_0000;
const VERSION_1: u8 = 0b0100_0000;
const BLOCK_CHECKSUM: u8 = 0b0001_0000;
const CONTENT_SIZE: u8 = 0b0000_1000;
const CONTENT_CHECKSUM: u8 = 0b0000_0100;
const DICTIONARY: u8 = 0b0000_0001;

/// Unpacks one frame that fills `out` exactly and ends with `packed`; `None` where it is anything else, or broken.
///
/// Checksums are passed over: who calls checks what came out against the chunk's own. Source: LZ4 frame format 1.6.
pub(super) fn unpack(packed: &[u8], out: &mut [u8]) -> Option<()> {
    let (magic, rest) = packed.split_first_chunk::<4>()?;
    let (&[flags, _block_size], rest) = rest.split_first_chunk::<2>()?;
    if *magic != MAGIC || flags & VERSION != VERSION_1 || flags & DICTIONARY != 0 {
        return None;
    }
    let content_size = if flags & CONTENT_SIZE == 0 { 0 } else { 8 };
    // The header ends with a byte of checksum.
    let mut rest = rest.get(content_size + 1..)?;
    let mut done = 0;
    loop {
        let (length, after) = rest.split_first_chunk::<4>()?;
        let length = u32::from_le_bytes(*length);
        if length == 0 {
            let checksum = if flags & CONTENT_CHECKSUM == 0 { 0 } else { 4 };
            return (done == out.len() && after.len() == checksum).then_some(());
        }
        let (block, after) = after.split_at_checked((length & !STORED) as usize)?;
        let (before, room) = out.split_at_mut(done);
        done += if length & STORED == 0 {
            decompress_into_with_dict(block, room, &before[done.saturating_sub(WINDOW)..]).ok()?
        } else {
            room.get_mut(..block.len())?.copy_from_slice(block);
            block.len()
        };
        rest = if flags & BLOCK_CHECKSUM == 0 { after } else { after.get(4..)? };
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use lz4_flex::frame::{BlockMode, BlockSize, FrameEncoder, FrameInfo};
    use proptest::prelude::*;

    use super::*;

    fn frame(plain: &[u8], info: FrameInfo) -> Vec<u8> {
        let mut encoder = FrameEncoder::with_frame_info(info, Vec::new());
        encoder.write_all(plain).unwrap();
        encoder.finish().unwrap()
    }

    proptest! {
        #[test]
        fn every_kind_of_frame_unpacks_and_a_broken_one_neither_panics_nor_is_taken_for_whole(
            pieces in prop::collection::vec((any::<u8>(), 1..40_000_usize, any::<bool>()), 0..8),
            linked in any::<bool>(),
            checks in prop::array::uniform2(any::<bool>()),
            size in any::<bool>(),
            cut in any::<prop::sample::Index>(),
        ) {
            let mut plain = Vec::new();
            for (byte, count, noise) in pieces {
                let fill = |k: usize| if noise { k.wrapping_mul(2_654_435_761).to_le_bytes()[1] } else { byte ^ (k.to_le_bytes()[0] % 7) };
                plain.extend((0..count).map(fill));
            }
            let info = FrameInfo::new()
                .block_mode(if linked { BlockMode::Linked } else { BlockMode::Independent })
                .block_size(BlockSize::Max64KB)
                .block_checksums(checks[0])
                .content_checksum(checks[1])
                .content_size(size.then_some(plain.len() as u64));
            let packed = frame(&plain, info);
            let mut out = vec![1; plain.len()];
            prop_assert_eq!(unpack(&packed, &mut out), Some(()));
            prop_assert_eq!(&out, &plain);
            let cut = cut.index(packed.len());
            prop_assert_eq!(unpack(&packed[..cut], &mut out), None);
            let mut longer = vec![0; plain.len() + 1];
            prop_assert_eq!(unpack(&packed, &mut longer), None);
            let mut broken = packed.clone();
            broken[cut] ^= 0x55;
            let _ = unpack(&broken, &mut out);
        }
    }
}
