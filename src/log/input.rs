//! What a log is read from: a file, bytes, or anything that gives bytes at a place.

use std::path::{Path, PathBuf};

use super::{
    csv::CsvOptions,
    error::LogError,
    file::{ReadAt, Source},
    foreign,
};
use crate::remark::Remarks;

/// One file of a run, wherever its bytes are.
#[derive(Debug)]
pub enum Input {
    /// A file, or the directory of a bag, which stands for its files.
    Path(PathBuf),
    /// Bytes in memory.
    Bytes {
        /// What remarks and errors call them.
        name: String,
        /// All of the log.
        data: Vec<u8>,
    },
    /// Bytes that are read where they are wanted.
    Reader {
        /// What remarks and errors call them.
        name: String,
        /// Gives them.
        reader: Box<dyn ReadAt>,
    },
}

impl From<PathBuf> for Input {
    fn from(path: PathBuf) -> Self {
        Self::Path(path)
    }
}

impl Input {
    /// Its path, or what its bytes are called.
    pub fn name(&self) -> &Path {
        match self {
            Self::Path(path) => path,
            Self::Bytes { name, .. } | Self::Reader { name, .. } => Path::new(name),
        }
    }

    /// Opens it as a log, whatever its form; a table by its columns.
    pub(super) fn open(
        self,
        columns: &CsvOptions,
        remarks: &mut Remarks,
    ) -> Result<(PathBuf, Source), LogError> {
        let (name, source) = match self {
            Self::Path(path) => {
                let source = Source::open(&path).map_err(LogError::file("open", &path))?;
                (path, source)
            }
            Self::Bytes { name, data } => (name.into(), data.into()),
            Self::Reader { name, reader } => {
                let name = PathBuf::from(name);
                let source = Source::of_reader(reader).map_err(LogError::file("open", &name))?;
                (name, source)
            }
        };
        let source = foreign::log_of(&name, source, columns, remarks)?;
        Ok((name, source))
    }
}
