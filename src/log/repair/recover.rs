//! Copies everything of a damaged log that is whole into a sound one.

use std::{
    collections::BTreeMap,
    io::{BufWriter, Seek, Write},
    path::Path,
};

use serde::{Deserialize, Serialize};

use super::copy::{Copier, CopyError, copy_files, writer};
use crate::{
    atomic_file::write_atomically,
    log::{
        csv::CsvOptions,
        error::LogError,
        file::{Blocks, Loss, MessageRecord, Opcode, records},
        files::ScannedFile,
        input::Input,
        recovered,
    },
    remark::{Code, Remarks},
};

/// Counts of a recovery.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Recovered {
    /// Messages in the new log.
    pub messages: u64,
    /// Of these, from chunks that are not as they were written: some may be wrong.
    #[serde(rename = "doubtful_messages", default)]
    pub doubtful: u64,
    /// Chunks, or runs of messages outside chunks, that were read.
    pub blocks: usize,
    /// Blocks that could not be read at all.
    pub dropped_blocks: u64,
    /// Attachments in the new log.
    pub attachments: usize,
    /// Losses and doubts; empty if there are none.
    #[cfg_attr(test, schemars(with = "Vec<crate::remark::Remark>"))]
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
    let mut doubts = Remarks::default();
    let (_, source) = Input::Path(log.to_owned()).open(&CsvOptions::default(), &mut doubts)?;
    let file = ScannedFile::of(log, &source)?;
    let layout = &file.layout;
    let mut remarks = doubts;
    file.remark_damage(&mut remarks);
    let mut saved = Recovered {
        messages: 0,
        doubtful: 0,
        blocks: layout.blocks.len(),
        dropped_blocks: 0,
        attachments: layout.attachments.len(),
        remarks,
    };
    let written = write_atomically::<_, CopyError>(output, |output| copy(&file, output, &mut saved));
    written.map_err(|error| error.of(output))?;
    Ok(saved)
}

/// Chunks by what is wrong with them: number, first byte, and a count.
type Places = BTreeMap<String, Vec<(usize, u64, u64)>>;

/// The sum of the counts, and the first chunks in words.
fn places(chunks: &[(usize, u64, u64)]) -> (u64, String) {
    const MOST: usize = 5;
    let named = |(number, at, _): &(usize, u64, u64)| format!("chunk {number} (at byte {at})");
    let first: Vec<String> = chunks.iter().take(MOST).map(named).collect();
    let more = match chunks.len().saturating_sub(MOST) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    (chunks.iter().map(|(.., count)| count).sum(), format!("{}{more}", first.join(", ")))
}

fn copy<W: Write + Seek>(
    file: &ScannedFile<'_>,
    output: &mut BufWriter<W>,
    saved: &mut Recovered,
) -> Result<(), CopyError> {
    let layout = &file.layout;
    let mut writer = writer(output, &layout.profile)?;
    copy_files(&mut writer, file, &[])?;
    let mut copier = Copier::of(file);
    let mut blocks = Blocks::new();
    let (mut doubtful, mut dropped) = (Places::new(), Places::new());
    for (number, block) in (1..).zip(&layout.blocks) {
        let (bytes, loss) = blocks.open_doubtful(*block, file.source);
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
            // Nothing of it could be unpacked.
            Loss::Doubtful(reason) if saved.messages == before => {
                saved.dropped_blocks += 1;
                dropped.entry(reason).or_default().push((number, block.span.start, 1));
            }
            Loss::Doubtful(reason) => {
                let kept = saved.messages - before;
                saved.doubtful += kept;
                doubtful.entry(reason).or_default().push((number, block.span.start, kept));
            }
            Loss::Dropped(reason) => {
                saved.dropped_blocks += 1;
                dropped.entry(reason).or_default().push((number, block.span.start, 1));
            }
        }
    }
    for (reason, chunks) in &doubtful {
        let (kept, places) = places(chunks);
        let message =
            format!("messages of chunks were kept of which some may be wrong: of {places} {reason}");
        saved.remarks.add(Code::DamagedChunk, kept.max(1), message);
    }
    for (reason, chunks) in &dropped {
        let (count, places) = places(chunks);
        saved.remarks.add(Code::DamagedChunk, count, format!("chunks were dropped: of {places} {reason}"));
    }
    saved.remarks.add(
        Code::UnknownChannel,
        copier.unknown,
        "messages of channels that the file does not define",
    );
    if saved.doubtful > 0 {
        writer.write_metadata(&mcap::records::Metadata {
            name: recovered::METADATA.to_owned(),
            metadata: recovered::metadata(saved.doubtful),
        })?;
    }
    writer.finish()?;
    Ok(())
}
