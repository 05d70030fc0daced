//! Copies everything of a damaged log that is whole into a sound one.

use std::{
    collections::BTreeMap,
    io::{BufWriter, Seek, Write},
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

use super::copy::{Copier, CopyError, copy_files, writer};
use crate::{
    atomic_file::write_atomically,
    log::{
        error::LogError,
        file::{Blocks, Loss, MessageRecord, Opcode, records},
        files::{LogFiles, ScannedFile, ScannedLog},
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

/// Writes all whole messages of the files of a run, those of partial last chunks included, to `output`; a bag directory
/// stands for its files, and what is no log among several is left out.
///
/// Messages keep their bytes, times and sequence numbers; attachments and metadata are copied.
///
/// # Errors
///
/// [`LogError`] if nothing is a log, nothing of one is left, or `output` cannot be written.
pub fn recover(logs: &[PathBuf], output: &Path) -> Result<Recovered, LogError> {
    let files = LogFiles::open(logs)?;
    let (log, mut others) = files.scan_logs();
    if log.files.is_empty() && !others.is_empty() {
        return Err(others.swap_remove(0));
    }
    let mut remarks = log.remarks.clone();
    for other in others {
        remarks.add(Code::DamagedBytes, 1, format!("{other}; left out"));
    }
    let mut saved = Recovered {
        messages: 0,
        doubtful: 0,
        blocks: log.files.iter().map(|file| file.layout.blocks.len()).sum(),
        dropped_blocks: 0,
        attachments: 0,
        remarks,
    };
    let mut is_nothing = false;
    let written = write_atomically::<_, CopyError>(output, |output| {
        copy(&log, output, &mut saved)?;
        is_nothing = saved.messages == 0 && saved.attachments == 0 && !saved.remarks.is_empty();
        if is_nothing { Err(std::io::Error::other("nothing is left").into()) } else { Ok(()) }
    });
    if is_nothing {
        let damage = saved.remarks.as_slice().iter().map(|one| format!("{} x{}", one.message, one.count));
        let damage = damage.collect::<Vec<_>>().join("; ");
        return Err(LogError::NothingLeft { path: logs.first().cloned().unwrap_or_default(), damage });
    }
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
    log: &ScannedLog<'_>,
    output: &mut BufWriter<W>,
    saved: &mut Recovered,
) -> Result<(), CopyError> {
    let files = log.in_order();
    let mut writer = writer(output, files.first().map_or("", |file| file.layout.profile.as_str()))?;
    let (mut kept, mut blocks) = (Vec::new(), Blocks::new());
    for file in &files {
        file.remark_damage(&mut saved.remarks);
        // Parts of a run each tell the same of it.
        saved.attachments += copy_files(&mut writer, file, &kept)?;
        let layout = &file.layout;
        let names = layout.attachments.iter().map(|one| one.name.as_str());
        kept.extend(names.chain(layout.metadata.iter().map(|one| one.name.as_str())));
        let of = if files.len() > 1 { format!("{}, ", file.name()) } else { String::new() };
        copy_messages(file, &of, &mut writer, &mut blocks, saved)?;
    }
    if saved.doubtful > 0 {
        writer.write_metadata(&mcap::records::Metadata {
            name: recovered::METADATA.to_owned(),
            metadata: recovered::metadata(saved.doubtful),
        })?;
    }
    writer.finish()?;
    Ok(())
}

/// `of`: what says which file is meant, in front of its chunks.
fn copy_messages<W: Write + Seek>(
    file: &ScannedFile<'_>,
    of: &str,
    writer: &mut mcap::Writer<W>,
    blocks: &mut Blocks,
    saved: &mut Recovered,
) -> Result<(), CopyError> {
    let mut copier = Copier::of(file);
    let (mut doubtful, mut dropped) = (Places::new(), Places::new());
    for (number, block) in (1..).zip(&file.layout.blocks) {
        let (bytes, loss) = blocks.open_doubtful(*block, file.source);
        let before = saved.messages;
        let mut end = 0;
        for record in records(bytes) {
            end = record.end;
            if record.opcode != Opcode::MESSAGE {
                continue;
            }
            let Some(message) = MessageRecord::parse(record.body) else { continue };
            saved.messages += u64::from(copier.message(writer, &message)?);
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
                saved.dropped_blocks += u64::from(kept == 0);
                let message = format!(
                    "{of}the file ends within a chunk; {kept} whole messages before the cut were kept"
                );
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
            format!("messages of chunks were kept of which some may be wrong: of {of}{places} {reason}");
        saved.remarks.add(Code::DamagedChunk, kept.max(1), message);
    }
    for (reason, chunks) in &dropped {
        let (count, places) = places(chunks);
        let message = format!("chunks were dropped: of {of}{places} {reason}");
        saved.remarks.add(Code::DamagedChunk, count, message);
    }
    let message = "messages of channels that the file does not define; left out";
    saved.remarks.add(Code::UnknownChannel, copier.unknown, message);
    Ok(())
}
