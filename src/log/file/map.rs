//! Read-only memory maps: the one place with `unsafe`.

use std::{fs::File, io, ops::Deref, path::Path};

use memmap2::Mmap;

/// A file mapped into memory, or nothing for an empty one.
#[derive(Debug)]
pub(in crate::log) struct MappedFile(Option<Mmap>);

impl MappedFile {
    /// Maps a file for reading.
    ///
    /// A log that another process is still appending to may be mapped: the bytes present at the
    /// call is seen. A file that another process *shortens* while it is mapped ends this process
    /// with SIGBUS; recorders do not do that.
    #[expect(unsafe_code, reason = "Mmap::map; soundness argued below")]
    pub(in crate::log) fn open(path: &Path) -> io::Result<Self> {
        let file = File::open(path)?;
        if file.metadata()?.len() == 0 {
            return Ok(Self(None));
        }
        // SAFETY: the map is read-only and every byte value is a valid u8. Records are parsed from
        // it with checked lengths, so a concurrent change by another process can yield wrong
        // numbers or a decode error, never an access outside the map.
        unsafe { Mmap::map(&file) }.map(|map| Self(Some(map)))
    }
}

impl Deref for MappedFile {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        self.0.as_deref().unwrap_or_default()
    }
}
