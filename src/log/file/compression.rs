//! Chunk decompression: whole, or as far as a cut chunk goes.

use std::io::Read;

use super::lz4;

/// Buffers and contexts of one thread, reused from chunk to chunk.
pub(super) struct Decompressor {
    zstd: Option<zstd::bulk::Decompressor<'static>>,
    out: Vec<u8>,
    /// As `out`, of a length that only grows, so that nothing is filled in vain.
    frame: Vec<u8>,
}

/// How much of a chunk came out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Yield {
    /// Everything the chunk promised.
    Whole,
    /// Less: the compressed bytes end early or are broken.
    Part,
}

/// Messages differ at least in their times, which keeps real chunks far below this; one that
/// promises more is not believed, so that a few bytes cannot ask for gigabytes.
const MAX_EXPANSION: u64 = 1000;
/// The same of lz4, by its format.
const MAX_EXPANSION_LZ4: u64 = 256;
const ALWAYS_ALLOWED: u64 = 1 << 20;
/// A chunk is held in memory, by every thread; recorders write one or a few megabytes.
const NEVER_MORE: u64 = 1 << 28;

impl Decompressor {
    pub(super) fn new() -> Self {
        Self { zstd: None, out: Vec::new(), frame: Vec::new() }
    }

    /// Decompresses up to the promised size. `Err` names a compression that is not understood
    /// or a size that is not believed; that of a cut chunk is only lowered. Of chunks that are `checked` by a sum of
    /// their own, sums within the compressed bytes are passed over.
    pub(super) fn run<'a>(
        &'a mut self,
        compression: &[u8],
        compressed: &'a [u8],
        promised: u64,
        (cut, checked): (bool, bool),
    ) -> Result<(&'a [u8], Yield), String> {
        if compression.is_empty() {
            let whole = if compressed.len() as u64 >= promised { Yield::Whole } else { Yield::Part };
            let end = usize::try_from(promised).unwrap_or(usize::MAX).min(compressed.len());
            return Ok((&compressed[..end], whole));
        }
        let expansion = if compression == b"lz4" { MAX_EXPANSION_LZ4 } else { MAX_EXPANSION };
        let allowed = (compressed.len() as u64).saturating_mul(expansion).saturating_add(ALWAYS_ALLOWED);
        let allowed = allowed.min(NEVER_MORE);
        let size = match usize::try_from(if cut { promised.min(allowed) } else { promised }) {
            Ok(size) if size as u64 <= allowed => size,
            _ => {
                return Err(format!("it promises over {expansion} times its size or {NEVER_MORE} bytes"));
            }
        };
        if compression == b"lz4" && checked && self.lz4(compressed, size) {
            return Ok((&self.frame[..size], Yield::Whole));
        }
        self.out.clear();
        match compression {
            b"zstd" => self.zstd(compressed, size),
            b"lz4" => read_up_to(lz4_flex::frame::FrameDecoder::new(compressed), size, &mut self.out),
            other => return Err(format!("compression {:?}", String::from_utf8_lossy(other))),
        }
        let whole = if self.out.len() == size { Yield::Whole } else { Yield::Part };
        Ok((&self.out, whole))
    }

    fn lz4(&mut self, compressed: &[u8], size: usize) -> bool {
        if self.frame.len() < size {
            self.frame.resize(size, 0);
        }
        lz4::unpack(compressed, &mut self.frame[..size]).is_some()
    }

    fn zstd(&mut self, compressed: &[u8], size: usize) {
        if self.zstd.is_none() {
            self.zstd = zstd::bulk::Decompressor::new().ok();
        }
        self.out.reserve(size);
        let Some(context) = &mut self.zstd else { return };
        // The one-shot call is faster than streaming; it fails on cut, broken or oversized
        // frames, which are then streamed to keep what is whole.
        // So is a frame of more than was promised: whether it fits depends on earlier chunks.
        if context.decompress_to_buffer(compressed, &mut self.out).is_ok() && self.out.len() == size {
            return;
        }
        self.out.clear();
        if let Ok(decoder) = zstd::stream::read::Decoder::with_buffer(compressed) {
            read_up_to(decoder, size, &mut self.out);
        }
    }
}

/// Appends until `size` bytes are there, the input ends, or it proves broken.
fn read_up_to(from: impl Read, size: usize, out: &mut Vec<u8>) {
    out.reserve_exact(size);
    // An error ends the reading; what came before it stays in `out`.
    let _ = from.take(size as u64).read_to_end(out);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise() -> Vec<u8> {
        (0..4_000_000_u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 24) as u8 & 0x1f).collect()
    }

    #[test]
    fn a_cut_zstd_chunk_yields_what_lies_before_the_cut() {
        let plain = noise();
        let packed = zstd::bulk::compress(&plain, 3).unwrap();
        let mut decompressor = Decompressor::new();
        let (out, amount) = decompressor
            .run(b"zstd", &packed[..packed.len() * 2 / 3], plain.len() as u64, (false, true))
            .unwrap();
        assert_eq!(amount, Yield::Part);
        assert!(out.len() > plain.len() / 3, "only {} bytes", out.len());
        assert_eq!(out, &plain[..out.len()]);
        let (out, amount) = decompressor.run(b"zstd", &packed, plain.len() as u64, (false, true)).unwrap();
        assert_eq!((out.len(), amount), (plain.len(), Yield::Whole));
    }

    #[test]
    fn a_bomb_of_lz4_is_stopped_by_what_its_chunk_says_and_by_what_its_codec_can() {
        let mut encoder = lz4_flex::frame::FrameEncoder::new(Vec::new());
        std::io::Write::write_all(&mut encoder, &vec![0; 64 << 20]).unwrap();
        let bomb = encoder.finish().unwrap();
        let mut decompressor = Decompressor::new();
        let (out, _) = decompressor.run(b"lz4", &bomb, 1 << 20, (false, true)).unwrap();
        assert_eq!(out.len(), 1 << 20);
        assert!(decompressor.out.capacity() < 2 << 20);
        let most = bomb.len() as u64 * MAX_EXPANSION_LZ4 + ALWAYS_ALLOWED;
        assert!(decompressor.run(b"lz4", &bomb, most + 1, (false, true)).is_err());
        assert!(decompressor.run(b"lz4", &vec![0; 4 << 20], 1 << 30, (false, true)).is_err());
    }

    #[test]
    fn an_unknown_compression_is_named() {
        assert_eq!(Decompressor::new().run(b"xz", &[], 0, (false, true)).unwrap_err(), "compression \"xz\"");
    }
}
