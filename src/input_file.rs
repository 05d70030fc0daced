//! Files that are read. Every file is opened here, and so is known when an output would replace it: by what it is
//! (device and inode), not by its name, so that links lead nowhere.

use std::{
    collections::BTreeSet,
    fs::{File, Metadata},
    io::{self, Read},
    path::Path,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
};

/// More than any text that is read whole, bytes.
const LONGEST_TEXT: u64 = 64 << 20;

/// What a file is, whatever its name.
#[cfg(unix)]
type Identity = (u64, u64);
#[cfg(not(unix))]
type Identity = std::path::PathBuf;

static REMEMBERED: AtomicBool = AtomicBool::new(false);
static READ: Mutex<BTreeSet<Identity>> = Mutex::new(BTreeSet::new());

/// From now on this process remembers every file that it opens for reading, and
/// [`write_atomically`](crate::atomic_file::write_atomically) spares them. For programs that do one thing and end:
/// in one that goes on, a file may be read now and rightly be replaced later.
pub fn remember() {
    REMEMBERED.store(true, Ordering::Relaxed);
}

/// From now on it remembers none, and forgets those that it knows: a file that is gone leaves its inode to another.
pub fn forget() {
    REMEMBERED.store(false, Ordering::Relaxed);
    read().clear();
}

/// Opens a file for reading; `-` is standard input where no file has this name.
///
/// # Errors
///
/// As the file system says; [`io::ErrorKind::InvalidInput`] for the pipe that this program writes to.
pub fn open(path: &Path) -> io::Result<File> {
    let file = match File::open(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound && path == Path::new("-") => standard_input()?,
        opened => opened?,
    };
    let found = file.metadata()?;
    if is_own_output(path, &found) {
        // It would wait for ever for what it has not written yet.
        return Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "it is where the output of this command goes",
        ));
    }
    note(path, &found);
    Ok(file)
}

/// Whether a file is the pipe that standard output goes to.
#[cfg(unix)]
fn is_own_output(path: &Path, found: &Metadata) -> bool {
    use std::os::{fd::AsFd as _, unix::fs::FileTypeExt as _};
    found.file_type().is_fifo()
        && io::stdout()
            .as_fd()
            .try_clone_to_owned()
            .and_then(|output| File::from(output).metadata())
            .is_ok_and(|output| identity(path, &output) == identity(path, found))
}

#[cfg(not(unix))]
fn is_own_output(_: &Path, _: &Metadata) -> bool {
    false
}

#[cfg(unix)]
fn standard_input() -> io::Result<File> {
    use std::os::fd::AsFd as _;
    Ok(io::stdin().as_fd().try_clone_to_owned()?.into())
}

#[cfg(windows)]
fn standard_input() -> io::Result<File> {
    use std::os::windows::io::AsHandle as _;
    Ok(io::stdin().as_handle().try_clone_to_owned()?.into())
}

/// The text of a file.
///
/// # Errors
///
/// As the file system says; [`io::ErrorKind::InvalidData`] for what is no UTF-8, or too long to be a text that a
/// person wrote.
pub fn read_to_string(path: &Path) -> io::Result<String> {
    let mut bytes = Vec::new();
    open(path)?.take(LONGEST_TEXT + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > LONGEST_TEXT {
        let why = format!("it is longer than {LONGEST_TEXT} bytes, which no such file is");
        return Err(io::Error::new(io::ErrorKind::InvalidData, why));
    }
    String::from_utf8(bytes).map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "it is no UTF-8 text"))
}

/// Remembers a file that is to be read, or that another program reads for this one; what is not there is not read.
pub fn will_read(path: &Path) {
    if let Ok(found) = path.metadata() {
        note(path, &found);
    }
}

/// Whether the file that a path leads to was opened for reading.
pub(crate) fn was_read(path: &Path) -> bool {
    let Ok(found) = path.metadata() else { return false };
    identity(path, &found).is_some_and(|file| read().contains(&file))
}

/// Whether a name leads to this very file.
pub(crate) fn is_at(file: &File, path: &Path) -> bool {
    let (Ok(opened), Ok(named)) = (file.metadata(), path.metadata()) else { return false };
    opened.len() == named.len() && identity(path, &opened) == identity(path, &named)
}

fn note(path: &Path, found: &Metadata) {
    if REMEMBERED.load(Ordering::Relaxed) && found.is_file() {
        read().extend(identity(path, found));
    }
}

fn read() -> std::sync::MutexGuard<'static, BTreeSet<Identity>> {
    READ.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(unix)]
#[expect(clippy::unnecessary_wraps, reason = "elsewhere a name may lead nowhere")]
fn identity(_: &Path, found: &Metadata) -> Option<Identity> {
    use std::os::unix::fs::MetadataExt as _;
    Some((found.dev(), found.ino()))
}

#[cfg(not(unix))]
fn identity(path: &Path, _: &Metadata) -> Option<Identity> {
    path.canonicalize().ok()
}
