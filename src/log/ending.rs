//! Whether a file ends as its writer ends it: what tells a log that is still being written.

use std::{
    io::{self, Read, Seek, SeekFrom},
    path::Path,
};

use super::file::MAGIC;
use crate::input_file;

/// What the end of a file tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Ending {
    /// It is closed.
    Closed,
    /// Its form has no end: a table, a database, a packed file.
    Untold,
    /// The end is to come, or its writer was killed.
    Open,
}

/// How a file ends, by its first and last bytes.
///
/// # Errors
///
/// As the file system says.
pub(crate) fn ending(path: &Path) -> io::Result<Ending> {
    let mut file = input_file::open(path)?;
    let size = MAGIC.len() as u64;
    let mut first = Vec::new();
    (&mut file).take(size).read_to_end(&mut first)?;
    // An empty file, too, is the start of anything.
    if !MAGIC.starts_with(&first) {
        return Ok(Ending::Untold);
    }
    let length = file.metadata()?.len();
    if length < 2 * size {
        return Ok(Ending::Open);
    }
    let mut last = Vec::new();
    file.seek(SeekFrom::Start(length - size))?;
    file.take(size).read_to_end(&mut last)?;
    Ok(if last == MAGIC { Ending::Closed } else { Ending::Open })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_mcap_file_is_open_until_its_last_bytes_and_a_table_does_not_tell() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let of = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            ending(&path).unwrap()
        };
        assert_eq!(of(b""), Ending::Open);
        assert_eq!(of(b"t_s,boom_set_mm,boom_act_mm\n"), Ending::Untold);
        assert_eq!(of(&[MAGIC.as_slice(), b"half of a log"].concat()), Ending::Open);
        assert_eq!(of(&[MAGIC.as_slice(), b"a log", MAGIC].concat()), Ending::Closed);
        assert_eq!(of(MAGIC), Ending::Open);
        assert!(ending(&folder.path().join("none")).is_err());
    }
}
