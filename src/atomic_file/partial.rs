//! A file that is being written, under a name beside the one that it is to get.

use std::{
    collections::BTreeSet,
    fs::{self, File, Metadata},
    io,
    path::{Path, PathBuf},
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
};

/// Around the process and a count. Short, so that a target may have the longest name that a file system takes.
const START: &str = ".hydrotrace-";
const END: &str = ".partial";
/// More names than this that are taken are no chance.
const MOST_NAMES: u32 = 10_000;

/// No thread gets a name that another one had: who removes what is left may still know that.
static COUNT: AtomicU64 = AtomicU64::new(0);
static WRITTEN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

pub(super) fn written() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    WRITTEN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the files that this process is writing. None can be written or finished after that: for a process that was
/// told to end.
pub fn give_up() {
    let files = written();
    for file in files.iter() {
        let _ = fs::remove_file(file);
    }
    std::mem::forget(files);
}

/// A file that is gone once this goes out of scope, unless it was put in its place. It is locked while it is written:
/// one that is not locked was left behind by a process that was killed, and the next one removes it.
pub(super) struct Partial(PathBuf);

impl Partial {
    /// Makes one in the folder of `place`, with the mode of the file there.
    pub(super) fn beside(place: &Path) -> io::Result<(Self, File)> {
        let folder = folder_of(place);
        remove_left(folder);
        for _ in 0..MOST_NAMES {
            let count = COUNT.fetch_add(1, Ordering::Relaxed);
            let path = folder.join(format!("{START}{}-{count}{END}", std::process::id()));
            let (partial, file) = {
                let mut files = written();
                let file = match File::create_new(&path) {
                    Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
                    made => made?,
                };
                files.insert(path.clone());
                (Self(path), file)
            };
            // File systems without locks keep what is left behind.
            let _ = file.lock();
            // Another process may have taken it for one left behind before it was locked.
            if partial.0.exists() {
                if let Ok(old) = fs::metadata(place) {
                    take_after(&file, &old)?;
                }
                return Ok((partial, file));
            }
        }
        Err(io::Error::new(io::ErrorKind::AlreadyExists, "every temporary name is taken"))
    }

    /// Its name until then.
    pub(super) fn path(&self) -> &Path {
        &self.0
    }

    /// Puts the file in its place, for good.
    pub(super) fn put(self, place: &Path) -> io::Result<()> {
        {
            let mut files = written();
            fs::rename(&self.0, place)?;
            files.remove(&self.0);
        }
        sync(folder_of(place))
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
        // `false` after it was put in its place.
        if written().remove(&self.0) {
            let _ = fs::remove_file(&self.0);
        }
    }
}

fn folder_of(place: &Path) -> &Path {
    place.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Removes what processes left behind that were killed while they wrote into a folder.
fn remove_left(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let ours = name.to_str().is_some_and(|name| name.starts_with(START) && name.ends_with(END));
        if !ours || !entry.file_type().is_ok_and(|kind| kind.is_file()) {
            continue;
        }
        // Another thread of this process may have made it and not locked it yet.
        if written().iter().any(|path| path.file_name() == Some(&name)) {
            continue;
        }
        // Held until it is removed, so that who makes one of this name waits and then sees that it is gone.
        if let Ok(file) = File::open(entry.path())
            && file.try_lock().is_ok()
        {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Mode, and owner where that is allowed.
fn take_after(file: &File, old: &Metadata) -> io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt as _, fchown};
        let _ = fchown(file, Some(old.uid()), Some(old.gid()));
    }
    file.set_permissions(old.permissions())
}

/// Makes a rename last through a loss of power.
fn sync(folder: &Path) -> io::Result<()> {
    // A folder that may be written but not read cannot be opened, nor can any on some systems.
    let Ok(folder) = File::open(folder) else { return Ok(()) };
    match folder.sync_all() {
        Err(error) if matches!(error.kind(), io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported) => {
            Ok(())
        }
        done => done,
    }
}
