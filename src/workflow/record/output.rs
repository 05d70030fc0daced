//! A file whose flush waits for the disk.

use std::{
    fs::{File, OpenOptions},
    io::{self, BufWriter, Write},
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
};

/// What is flushed is on the disk: a power cut takes nothing of it.
#[derive(Debug)]
pub(super) struct Synced {
    file: BufWriter<File>,
    written: Arc<AtomicU64>,
}

impl Synced {
    /// A new file; with `replace` also in the place of another.
    pub(super) fn create(path: &Path, replace: bool) -> io::Result<Self> {
        let file = OpenOptions::new()
            .write(true)
            .create(replace)
            .truncate(replace)
            .create_new(!replace)
            .open(path)?;
        Ok(Self { file: BufWriter::new(file), written: Arc::default() })
    }

    /// Counts the bytes so far.
    pub(super) fn counter(&self) -> Arc<AtomicU64> {
        self.written.clone()
    }
}

impl Write for Synced {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.file.write(bytes)?;
        self.written.fetch_add(count as u64, Ordering::Relaxed);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()?;
        self.file.get_ref().sync_data()
    }
}
