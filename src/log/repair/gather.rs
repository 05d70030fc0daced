//! The files of one run as one log.

use std::{
    io::{Seek, Write},
    path::Path,
};

use super::copy::{Copier, CopyError, copy_files, writer};
use crate::{
    atomic_file::write_atomically,
    log::{
        error::LogError,
        file::{Blocks, MessageRecord, Opcode, records},
        files::ScannedLog,
    },
};

impl ScannedLog<'_> {
    /// Writes all messages, files and metadata of the run to `output`; of files and metadata of one name the first. Returns
    /// the numbers of files, of messages, and of those left out because their file does not define their channel.
    ///
    /// # Errors
    ///
    /// [`LogError`] if `output` cannot be written.
    pub fn gather(&self, output: &Path) -> Result<(usize, u64, u64), LogError> {
        let (messages, unknown) = write_atomically::<_, CopyError>(output, |file| self.gather_into(file))
            .map_err(|error| error.of(output))?;
        Ok((self.files.len(), messages, unknown))
    }

    fn gather_into<W: Write + Seek>(&self, output: W) -> Result<(u64, u64), CopyError> {
        let profile = self.files.first().map_or("", |file| file.layout.profile.as_str());
        let mut log = writer(output, profile)?;
        let (mut copied, mut unknown, mut kept, mut blocks) = (0, 0, Vec::new(), Blocks::new());
        for file in self.in_order() {
            copy_files(&mut log, file, &kept)?;
            let layout = &file.layout;
            let files = layout.attachments.iter().map(|one| one.name.as_str());
            kept.extend(files.chain(layout.metadata.iter().map(|one| one.name.as_str())));
            let mut copier = Copier::of(file);
            for block in &layout.blocks {
                let messages = records(blocks.open(*block, file.source).0)
                    .filter(|record| record.opcode == Opcode::MESSAGE);
                for message in messages.filter_map(|record| MessageRecord::parse(record.body)) {
                    copied += u64::from(copier.message(&mut log, &message)?);
                }
            }
            unknown += copier.unknown;
        }
        log.finish()?;
        Ok((copied, unknown))
    }
}
