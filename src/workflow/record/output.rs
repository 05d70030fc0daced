//! A file whose flush waits for the disk.

use std::{
    fs::{self, File, OpenOptions},
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
    /// Whether it is a file of a disk, no device or pipe.
    on_disk: bool,
}

impl Synced {
    /// A new file; with `replace` also in the place of another, which keeps what another program still writes to it.
    pub(super) fn create(path: &Path, replace: bool) -> io::Result<Self> {
        let is_file = path.metadata().map(|found| found.is_file());
        let file = match is_file {
            Ok(true) if replace => {
                // Where a link leads to, so that it stays one.
                let place = fs::canonicalize(path)?;
                let mode = fs::metadata(&place)?.permissions();
                match fs::remove_file(&place) {
                    Ok(()) => {
                        let file = File::create_new(place)?;
                        file.set_permissions(mode)?;
                        file
                    }
                    // In a folder that is another's the file itself may be ours.
                    Err(_) => OpenOptions::new().write(true).truncate(true).open(place)?,
                }
            }
            Ok(false) if replace => OpenOptions::new().write(true).open(path)?,
            _ => File::create_new(path)?,
        };
        let on_disk = file.metadata()?.is_file();
        Ok(Self { file: BufWriter::new(file), written: Arc::default(), on_disk })
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
        if !self.on_disk {
            return Ok(());
        }
        self.file.get_ref().sync_data()?;
        if is_removed(self.file.get_ref())? {
            return Err(io::Error::new(
                io::ErrorKind::NotFound,
                "the file was removed or replaced meanwhile",
            ));
        }
        Ok(())
    }
}

/// Whether no name leads to an open file any more.
#[cfg(unix)]
fn is_removed(file: &File) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt as _;
    Ok(file.metadata()?.nlink() == 0)
}

#[cfg(not(unix))]
fn is_removed(_: &File) -> io::Result<bool> {
    Ok(false)
}
