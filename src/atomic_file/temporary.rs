//! Files that are gone when nobody uses them: for what may be larger than memory.

use std::{
    env,
    fs::{self, File, OpenOptions},
    io,
    path::{Path, PathBuf},
    process,
    sync::atomic::{AtomicU64, Ordering},
};

use super::partial::written;

static COUNT: AtomicU64 = AtomicU64::new(0);

/// A file in the system's folder for such; its name is gone once this is, or the process is interrupted.
#[derive(Debug)]
pub(crate) struct Temporary {
    path: PathBuf,
}

impl Temporary {
    /// A name that is not taken, and its file, empty, to be written and read.
    pub(crate) fn new() -> io::Result<(Self, File)> {
        loop {
            let number = COUNT.fetch_add(1, Ordering::Relaxed);
            let path = env::temp_dir().join(format!("hydrotrace-{}-{number}", process::id()));
            match OpenOptions::new().read(true).write(true).create_new(true).open(&path) {
                Ok(file) => {
                    written().insert(path.clone());
                    return Ok((Self { path }, file));
                }
                // Left by a process of that number that was killed.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(Self::fault(&error)),
            }
        }
    }

    /// Why one takes no more: it is the folder for such that does not, not the file that is read.
    pub(crate) fn fault(error: &io::Error) -> io::Error {
        let folder = env::temp_dir();
        io::Error::other(format!(
            "a temporary file is needed in {}, which failed: {error}; set TMPDIR to a folder with room",
            folder.display()
        ))
    }

    #[cfg_attr(not(feature = "sqlite"), expect(dead_code, reason = "only SQLite opens by name"))]
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // What cannot be removed stays in the system's folder for temporary files.
        let _ = fs::remove_file(&self.path);
        written().remove(&self.path);
    }
}
