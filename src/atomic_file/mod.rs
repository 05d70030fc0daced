//! Files that appear whole or not at all, and never in the place of what is worth more.

mod partial;
mod temporary;

use std::{
    fs::{self, File, OpenOptions},
    io::{self, BufWriter, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
    sync::OnceLock,
};

use thiserror::Error;

use crate::input_file::was_read;
use partial::Partial;
pub use partial::give_up;
pub(crate) use temporary::Temporary;

/// Why a file did not appear.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the message says what each field is")]
pub enum AtomicError {
    #[error("{} is a folder; give the name of a file", path.display())]
    NotAFile { path: PathBuf },
    #[error("cannot write {}: there is no folder {}; make it first", path.display(), folder.display())]
    NoFolder { path: PathBuf, folder: PathBuf },
    /// The target was read, so it is an input.
    #[error("{} is an input of this command, and is not written over; give the output another name", path.display())]
    Input { path: PathBuf },
    /// The target is worth more than to be replaced in passing.
    #[error("{} is {what}; give the output another name, or replace it with --force", path.display())]
    Kept { path: PathBuf, what: String },
    #[error("cannot {action} {}", path.display())]
    Io { action: &'static str, path: PathBuf, source: io::Error },
}

/// An output that remembers why the file system refused it, whatever a writer on top makes of that.
#[derive(Debug)]
pub struct Output {
    file: File,
    fault: Option<io::Error>,
}

impl Output {
    fn noting<T>(&mut self, done: io::Result<T>) -> io::Result<T> {
        if let Err(error) = &done
            && error.kind() != io::ErrorKind::Interrupted
        {
            let known = error.raw_os_error().map(io::Error::from_raw_os_error);
            self.fault = Some(known.unwrap_or_else(|| io::Error::from(error.kind())));
        }
        done
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let done = self.file.write(bytes);
        self.noting(done)
    }

    fn flush(&mut self) -> io::Result<()> {
        let done = self.file.flush();
        self.noting(done)
    }
}

impl Seek for Output {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// Says of an existing file what it is, if it is to be kept.
pub type Worth = fn(&Path) -> Option<String>;

static WORTH: OnceLock<Worth> = OnceLock::new();

/// From now on outputs of this process replace no file that `worth` knows; the first call counts.
pub fn keep(worth: Worth) {
    // A second rule, as of a second start in one process, would be the same.
    let _ = WORTH.set(worth);
}

/// Whether outputs of this process spare what is worth more.
pub fn is_keeping() -> bool {
    WORTH.get().is_some()
}

/// Whether a file may appear at `target`, before any work is done for it. [`write_atomically`] asks again.
///
/// # Errors
///
/// [`AtomicError::Input`] or [`AtomicError::Kept`].
pub fn may_write(target: &Path) -> Result<(), AtomicError> {
    let path = || target.to_owned();
    if was_read(target) {
        return Err(AtomicError::Input { path: path() });
    }
    let kept = WORTH.get().filter(|_| target.is_file()).and_then(|worth| worth(target));
    kept.map_or(Ok(()), |what| Err(AtomicError::Kept { path: path(), what }))
}

/// Has `write` fill a new file beside `target` and then puts it in the place of `target`, which
/// holds its old content, or does not exist, until the new content is on the disk. On failure
/// the new file is removed. It has the mode of the file that it replaces. A symbolic link stays one; the file it leads to is replaced. Devices and
/// pipes, which cannot be replaced, are written to as they are.
///
/// # Errors
///
/// What `write` returns, or [`AtomicError`], which names the target where the file system refuses, or where the
/// target [may not be written](may_write).
pub fn write_atomically<T, E: From<AtomicError>>(
    target: &Path,
    write: impl FnOnce(&mut BufWriter<Output>) -> Result<T, E>,
) -> Result<T, E> {
    may_write(target)?;
    let Some(place) = resolve(target)? else {
        let file = OpenOptions::new().write(true).open(target).map_err(failed("open", target))?;
        let (value, mut output) = fill(file, target, write)?;
        output.flush().map_err(failed("write", target))?;
        return Ok(value);
    };
    let (partial, file) = Partial::beside(&place).map_err(failed("write", target))?;
    let (value, mut output) = fill(file, target, write)?;
    output.flush().and_then(|()| output.get_ref().file.sync_all()).map_err(failed("write", target))?;
    // Where a file that is open cannot be renamed.
    drop(output);
    partial.put(&place).map_err(failed("replace", target))?;
    Ok(value)
}

/// As [`write_atomically`], for a writer that opens its file by itself, under the name that it is given.
///
/// # Errors
///
/// As [`write_atomically`].
pub fn write_by_name<T, E: From<AtomicError>>(
    target: &Path,
    write: impl FnOnce(&Path) -> Result<T, E>,
) -> Result<T, E> {
    may_write(target)?;
    let Some(place) = resolve(target)? else { return write(target) };
    let (partial, file) = Partial::beside(&place).map_err(failed("write", target))?;
    let value = write(partial.path())?;
    file.sync_all().map_err(failed("write", target))?;
    drop(file);
    partial.put(&place).map_err(failed("replace", target))?;
    Ok(value)
}

fn fill<T, E: From<AtomicError>>(
    file: File,
    target: &Path,
    write: impl FnOnce(&mut BufWriter<Output>) -> Result<T, E>,
) -> Result<(T, BufWriter<Output>), E> {
    let mut output = BufWriter::new(Output { file, fault: None });
    match write(&mut output) {
        Ok(value) => Ok((value, output)),
        Err(error) => Err(match output.get_mut().fault.take() {
            Some(source) => failed("write", target)(source).into(),
            None => error,
        }),
    }
}

/// The file that a path leads to; `None` for what cannot be replaced.
fn resolve(target: &Path) -> Result<Option<PathBuf>, AtomicError> {
    match fs::metadata(target) {
        Ok(found) if found.is_file() => fs::canonicalize(target).map(Some).map_err(failed("find", target)),
        Ok(found) if found.is_dir() => Err(AtomicError::NotAFile { path: target.to_owned() }),
        Ok(_) => Ok(None),
        Err(_) if target.file_name().is_none() => Err(AtomicError::NotAFile { path: target.to_owned() }),
        Err(_) => {
            let place = linked(target).map_err(failed("find", target))?;
            let folder = place.parent().filter(|folder| !folder.as_os_str().is_empty());
            match folder.filter(|folder| !folder.is_dir()) {
                Some(folder) => {
                    Err(AtomicError::NoFolder { path: target.to_owned(), folder: folder.to_owned() })
                }
                None => Ok(Some(place)),
            }
        }
    }
}

/// Where symbolic links lead at whose end there is no file yet.
fn linked(target: &Path) -> io::Result<PathBuf> {
    const MOST_LINKS: u32 = 40;
    let mut place = target.to_owned();
    for _ in 0..MOST_LINKS {
        let Ok(next) = fs::read_link(&place) else { return Ok(place) };
        place = place.parent().map_or(next.clone(), |folder| folder.join(&next));
    }
    Err(io::Error::other("its symbolic links lead round in a circle; remove them"))
}

fn failed(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> AtomicError {
    move |source| AtomicError::Io { action, path: path.to_owned(), source: advised(source) }
}

/// With what to do where a folder or a disk takes no more.
fn advised(error: io::Error) -> io::Error {
    let advice = match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => "make room, or ",
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => "",
        _ => return error,
    };
    io::Error::new(error.kind(), format!("{error}; {advice}give the output a name in another folder"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_failure_leaves_the_old_content_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("run.mcap");
        fs::write(&target, "old").unwrap();
        let refused: Result<(), AtomicError> = write_atomically(&target, |file| {
            file.write_all(b"half of the new").map_err(failed("write", &target))?;
            Err(AtomicError::NotAFile { path: "given up".into() })
        });
        assert!(refused.is_err());
        assert_eq!(fs::read_to_string(&target).unwrap(), "old");
        assert_eq!(names(folder.path()), ["run.mcap"]);
    }

    #[test]
    fn until_the_last_moment_the_old_content_stands_and_then_the_new() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("run.mcap");
        fs::write(&target, "old").unwrap();
        let written: Result<(), AtomicError> = write_atomically(&target, |file| {
            file.write_all(b"new").and_then(|()| file.flush()).map_err(failed("write", &target))?;
            assert_eq!(fs::read_to_string(&target).unwrap(), "old");
            Ok(())
        });
        assert!(written.is_ok());
        assert_eq!(fs::read_to_string(&target).unwrap(), "new");
        assert_eq!(names(folder.path()), ["run.mcap"]);
    }

    #[test]
    fn a_folder_is_not_replaced_and_a_missing_one_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let onto_folder: Result<(), AtomicError> = write_atomically(folder.path(), |_| Ok(()));
        assert!(matches!(onto_folder, Err(AtomicError::NotAFile { .. })));
        let nowhere = folder.path().join("missing").join("run.mcap");
        let into_nowhere: Result<(), AtomicError> = write_atomically(&nowhere, |_| Ok(()));
        assert!(matches!(into_nowhere, Err(AtomicError::NoFolder { .. })));
    }

    #[test]
    fn threads_that_write_into_one_folder_take_nothing_from_one_another() {
        let folder = tempfile::tempdir().unwrap();
        let write = &|name: String| -> Result<(), AtomicError> {
            let target = folder.path().join(name);
            write_atomically(&target, |file| file.write_all(b"all").map_err(failed("write", &target)))
        };
        std::thread::scope(|scope| {
            for thread in 0..4 {
                scope.spawn(move || (0..50).for_each(|k| write(format!("{thread}-{k}")).unwrap()));
            }
        });
        assert_eq!(names(folder.path()).len(), 200);
    }

    #[cfg(unix)]
    #[test]
    fn a_symbolic_link_stays_and_its_file_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        let written: Result<(), AtomicError> =
            write_atomically(&link, |output| output.write_all(b"new").map_err(failed("write", &link)));
        assert!(written.is_ok());
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read_to_string(&file).unwrap(), "new");
    }
}
