//! Copies everything of a damaged log that is whole into a sound one.

use std::{
    io::{BufWriter, Seek, Write},
    path::Path,
};

use super::copy::{Copier, CopyError, copy_files};
use crate::{
    atomic_file::write_atomically,
    log::{
        error::LogError,
        file::{Blocks, Layout, Loss, MappedFile, MessageRecord, Opcode, records},
        files::ScannedFile,
    },
    remark::{Code, Remarks},
};

/// Counts of a recovery.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Recovered {
    /// Messages in the new log.
    pub messages: u64,
    /// Chunks, or runs of messages outside chunks, that were read.
    pub blocks: usize,
    /// Of these, dropped whole.
    pub dropped_blocks: u64,
    /// Attachments in the new log.
    pub attachments: usize,
    /// Losses and doubts; empty if there are none.
    pub remarks: Remarks,
}

/// Writes all whole messages of `log`, those of a partial last chunk included, to `output`.
///
/// Messages keep their bytes, times and sequence numbers; attachments and metadata are copied.
///
/// # Errors
///
/// [`LogError`] if `log` is no log at all, or `output` cannot be written.
pub fn recover(log: &Path, output: &Path) -> Result<Recovered, LogError> {
    let map = MappedFile::open(log).map_err(LogError::file("open", log))?;
    let file = ScannedFile::of(log, &map)?;
    let layout = &file.layout;
    let mut remarks = Remarks::default();
    file.remark_damage(&mut remarks);
    let mut saved = Recovered {
        messages: 0,
        blocks: layout.blocks.len(),
        dropped_blocks: 0,
        attachments: layout.attachments.len(),
        remarks,
    };
    let written = write_atomically::<_, CopyError>(output, |file| copy(layout, file, &mut saved));
    written.map_err(|error| error.of(output))?;
    Ok(saved)
}

fn copy<W: Write + Seek>(
    layout: &Layout<'_>,
    file: &mut BufWriter<W>,
    saved: &mut Recovered,
) -> Result<(), CopyError> {
    let mut writer = mcap::WriteOptions::new()
        .profile(layout.profile.as_str())
        .library(concat!("hydrotrace ", env!("CARGO_PKG_VERSION")))
        .compression(Some(mcap::Compression::Zstd))
        .compression_threads(0)
        .create(file)?;
    copy_files(&mut writer, layout, &[])?;
    let mut copier = Copier::of(layout);
    let mut blocks = Blocks::new();
    for block in &layout.blocks {
        let (bytes, loss) = blocks.open(*block);
        let before = saved.messages;
        let mut end = 0;
        for record in records(bytes) {
            end = record.end;
            if record.opcode != Opcode::MESSAGE {
                continue;
            }
            let Some(message) = MessageRecord::parse(record.body) else { continue };
            saved.messages += u64::from(copier.message(&mut writer, &message)?);
        }
        match loss {
            Loss::Nothing if end < bytes.len() => {
                let left = bytes.len() - end;
                let message = "bytes at the ends of chunks that are no record";
                saved.remarks.add(Code::DamagedChunk, left as u64, message);
            }
            Loss::Nothing => {}
            Loss::Cut => {
                let kept = saved.messages - before;
                let message =
                    format!("the file ends within a chunk; {kept} whole messages before the cut were kept");
                saved.remarks.add(Code::PartialChunk, 1, message);
            }
            Loss::Dropped(reason) => {
                saved.dropped_blocks += 1;
                saved.remarks.add(Code::DamagedChunk, 1, format!("a chunk was dropped: {reason}"));
            }
        }
    }
    saved.remarks.add(
        Code::UnknownChannel,
        copier.unknown,
        "messages of channels that the file does not define",
    );
    writer.finish()?;
    Ok(())
}
