//! The logs of folders, patterns and lists, each with what tells whether it changed.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs::{self, Metadata},
    io::ErrorKind,
    path::{Path, PathBuf},
    time::UNIX_EPOCH,
};

use super::{failure::FleetFailure, tables::Log};
use crate::{
    input_file,
    log::{Input, remote},
    remark::Remarks,
};

/// Endings of logs that are looked for in folders; a file that is named counts whatever its ending.
const ENDINGS: [&str; 6] = [".mcap", ".db3", ".mcap.zst", ".mcap.zstd", ".mcap.gz", ".db3.zstd"];
/// Endings of tables, which folders hold of anything; a verb, or a pattern with such an ending, asks for them.
const TABLES: [&str; 4] = [".csv", ".csv.gz", ".jsonl", ".jsonl.gz"];
/// Endings of lists of logs.
const LISTS: [&str; 3] = ["txt", "list", "manifest"];
/// The description that makes a folder a bag.
const BAG: &str = "metadata.yaml";

/// A log to analyse.
#[derive(Debug, Clone)]
pub(in crate::workflow) struct Source {
    /// Its absolute path, or its address.
    pub(in crate::workflow) path: PathBuf,
    pub(super) bytes: u64,
    /// Size and time of change, or the store's tag: another one is another log.
    pub(in crate::workflow) etag: String,
    /// Where it lies in a store, its files there.
    objects: Vec<remote::Object>,
}

impl Source {
    pub(in crate::workflow) fn is_remote(&self) -> bool {
        !self.objects.is_empty()
    }

    /// What it is read from.
    pub(super) fn inputs(&self) -> Vec<Input> {
        if self.objects.is_empty() {
            vec![Input::Path(self.path.clone())]
        } else {
            let input =
                |one: &remote::Object| Input::Reader { name: one.address.clone(), reader: one.open() };
            self.objects.iter().map(input).collect()
        }
    }
}

/// Logs by path, and whether tables count.
#[derive(Default)]
struct Found {
    logs: BTreeMap<PathBuf, Source>,
    tables: bool,
    /// Tables that were not asked for.
    left_out: BTreeSet<PathBuf>,
    /// Folders in folders that this user may not list, as a disk has for its repairs.
    closed: Vec<PathBuf>,
    archives: Vec<PathBuf>,
}

const ARCHIVES: [&str; 6] = [".zip", ".7z", ".rar", ".tar", ".tar.gz", ".tgz"];

impl Found {
    fn is_log(&self, name: &str) -> bool {
        let tables = TABLES.iter().filter(|_| self.tables);
        ENDINGS.iter().chain(tables).any(|ending| ends(name, ending))
    }

    /// The logs by path; of links to one log the first, and none beside the log itself.
    fn each_once(self) -> Vec<Source> {
        let own = |path: &Path| fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let mut first: BTreeMap<PathBuf, PathBuf> = BTreeMap::new();
        for path in self.logs.keys() {
            let own = own(path);
            if !first.contains_key(&own) || *path == own {
                first.insert(own, path.clone());
            }
        }
        let kept: BTreeSet<PathBuf> = first.into_values().collect();
        self.logs.into_values().filter(|log| kept.contains(&log.path)).collect()
    }
}

/// Whether a name has an ending; disks of controllers write capitals.
fn ends(name: &str, ending: &str) -> bool {
    name.to_lowercase().ends_with(ending)
}

/// The logs of all sources, each once, in the order of their paths; how many tables beside them were not asked for; and what is to be
/// said of sources that lead to no log, where others do, and of folders that may not be listed.
pub(super) fn sources(texts: &[String]) -> Result<(Vec<Source>, usize, Vec<String>), FleetFailure> {
    let (mut found, mut empty) = (Found::default(), Vec::new());
    for text in texts {
        let mut own = Found::default();
        add(text, Path::new(""), &mut own)?;
        if own.logs.is_empty() && !Path::new(text).exists() {
            empty.push(format!("no log in {text:?}"));
        }
        found.left_out.extend(own.left_out);
        let closed =
            |path: &PathBuf| format!("{} may not be listed: what lies in it is left out", path.display());
        empty.extend(own.closed.iter().map(closed));
        let packed =
            |first: &PathBuf| format!("archives are not looked into, as {}: unpack them", first.display());
        empty.extend(own.archives.first().map(packed));
        for (path, source) in own.logs {
            found.logs.entry(path).or_insert(source);
        }
    }
    let left_out = found.left_out.iter().filter(|table| !found.logs.contains_key(*table)).count();
    if found.logs.is_empty() {
        Err(FleetFailure::NoLogs { text: texts.first().cloned().unwrap_or_default() })
    } else {
        Ok((found.each_once(), left_out, empty))
    }
}

/// The logs that are there now, tables among them; none is no fault.
pub(in crate::workflow) fn sources_now(texts: &[String]) -> Result<Vec<Source>, FleetFailure> {
    let mut found = Found { tables: true, ..Found::default() };
    texts.iter().try_for_each(|text| add(text, Path::new(""), &mut found))?;
    Ok(found.each_once())
}

/// Adds the logs of one source; a relative path counts from `base`.
fn add(text: &str, base: &Path, found: &mut Found) -> Result<(), FleetFailure> {
    let others = found.tables;
    let lower = text.to_lowercase();
    found.tables |= TABLES.iter().any(|ending| lower.ends_with(ending));
    let done = add_asked(text, base, found);
    found.tables = others;
    done
}

fn add_asked(text: &str, base: &Path, found: &mut Found) -> Result<(), FleetFailure> {
    let path = base.join(text);
    if remote::is_address(Path::new(text)) && !path.exists() {
        return stored(text, found);
    }
    let within = path.components().any(|part| part == std::path::Component::ParentDir);
    let path = if within { fs::canonicalize(&path) } else { std::path::absolute(&path) }
        .or_else(|_| std::path::absolute(&path))
        .map_err(FleetFailure::file("find", &path))?;
    match fs::metadata(&path) {
        Ok(is) if is.is_dir() => walk(&path, &mut |_| true, found),
        Ok(_) if LISTS.iter().any(|ending| path.extension().is_some_and(|own| own == *ending)) => {
            let lines = input_file::read_to_string(&path).map_err(FleetFailure::file("read", &path))?;
            let folder = path.parent().unwrap_or(base).to_owned();
            let lines =
                lines.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
            lines.map(str::to_owned).try_for_each(|line| add(&line, &folder, found))
        }
        Ok(is) => {
            put(path, &is, &mut found.logs);
            Ok(())
        }
        Err(_) if text.contains(['*', '?']) => {
            let pattern = path.to_string_lossy().into_owned();
            // The folders before the first sign that stands for others.
            let plain: PathBuf = path
                .components()
                .take_while(|part| !part.as_os_str().to_string_lossy().contains(['*', '?']))
                .collect();
            walk(&plain, &mut |path| matches(&pattern, &path.to_string_lossy()), found)
        }
        Err(error) => Err(FleetFailure::file("find", &path)(error)),
    }
}

/// Adds the logs of a store: what ends as logs do, or is named; the files of a bag are one log.
fn stored(address: &str, found: &mut Found) -> Result<(), FleetFailure> {
    let objects = remote::objects(address)?;
    let folder = |address: &str| address.rsplit_once('/').unwrap_or_default().0.to_owned();
    let bags: BTreeSet<String> =
        objects.iter().filter(|one| one.address.ends_with(BAG)).map(|one| folder(&one.address)).collect();
    for object in objects {
        let within = folder(&object.address);
        let path = if bags.contains(&within) { within } else { object.address.clone() };
        let is_log = found.is_log(&object.address);
        let fits = path == address || !address.contains('*') || matches(address, &path);
        if (is_log || object.address == address) && fits {
            let new =
                || Source { path: path.clone().into(), bytes: 0, etag: String::new(), objects: Vec::new() };
            let source = found.logs.entry(PathBuf::from(&path)).or_insert_with(new);
            // A folder and a file in it may both be named.
            if !source.objects.iter().any(|own| own.address == object.address) {
                source.bytes += object.bytes;
                let parts = [source.etag.as_str(), object.etag.as_str()];
                source.etag = parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("+");
                source.objects.push(object);
            }
        }
    }
    Ok(())
}

fn walk(folder: &Path, wanted: &mut dyn FnMut(&Path) -> bool, found: &mut Found) -> Result<(), FleetFailure> {
    if folder.join(BAG).is_file() {
        if let (true, Ok(is)) = (wanted(folder), fs::metadata(folder)) {
            put(folder.to_owned(), &is, &mut found.logs);
        }
        return Ok(());
    }
    for entry in fs::read_dir(folder).map_err(FleetFailure::file("list", folder))? {
        let entry = entry.map_err(FleetFailure::file("list", folder))?;
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if name.starts_with('.') {
            continue;
        }
        let path = entry.path();
        // What a link leads to counts; one that leads nowhere is none.
        let Ok(is) = fs::metadata(&path) else { continue };
        if is.is_dir() {
            // A link to a folder may lead in a circle.
            if entry.file_type().is_ok_and(|kind| kind.is_symlink()) {
                continue;
            }
            if fs::read_dir(&path).is_err_and(|error| error.kind() == ErrorKind::PermissionDenied) {
                found.closed.push(path);
            } else {
                walk(&path, wanted, found)?;
            }
        } else if is.is_file() && wanted(&path) {
            if found.is_log(&name) {
                put(path, &is, &mut found.logs);
            } else if ARCHIVES.iter().any(|ending| ends(&name, ending)) {
                found.archives.push(path);
            } else {
                found.left_out.extend(TABLES.iter().any(|ending| ends(&name, ending)).then_some(path));
            }
        }
    }
    Ok(())
}

impl Log {
    /// A file or the folder of a bag as it is now; of what is not there only the place is known.
    pub fn at(path: &Path, analysis_id: String) -> Self {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let mut found = BTreeMap::new();
        if let Ok(is) = fs::metadata(&path) {
            put(path.clone(), &is, &mut found);
        }
        let (bytes, etag) = found.remove(&path).map(|one| (one.bytes, one.etag)).unwrap_or_default();
        Self { uri: path.to_string_lossy().into_owned(), etag, bytes, machine: None, analysis_id, tries: 1 }
    }
}

fn put(path: PathBuf, is: &Metadata, found: &mut BTreeMap<PathBuf, Source>) {
    let (mut bytes, mut etag) = tag(is);
    if is.is_dir() {
        // Of a bag all files count.
        let files = crate::log::recording_files(std::slice::from_ref(&path), &mut Remarks::default());
        bytes = 0;
        for (size, own) in
            files.unwrap_or_default().iter().filter_map(|file| fs::metadata(file).ok()).map(|is| tag(&is))
        {
            bytes += size;
            etag = format!("{etag}+{own}");
        }
    }
    found.insert(path.clone(), Source { path, bytes, etag, objects: Vec::new() });
}

fn tag(is: &Metadata) -> (u64, String) {
    let changed = is.modified().ok().and_then(|at| at.duration_since(UNIX_EPOCH).ok());
    (is.len(), format!("{:x}-{:x}", is.len(), changed.map_or(0, |since| since.as_nanos())))
}

/// When the file of a tag was changed last, ns since 1970; `None` of an object in a store, or a bag.
pub(super) fn changed_ns(etag: &str) -> Option<u128> {
    let (_, changed) = etag.split_once('-')?;
    u128::from_str_radix(changed, 16).ok()
}

/// Whether a path fits a pattern: `*` stands for any signs of a name, `?` for one, `**` for any folders or none.
fn matches(pattern: &str, path: &str) -> bool {
    fn all(patterns: &[&str], names: &[&str]) -> bool {
        match patterns.split_first() {
            None => names.is_empty(),
            Some((&"**", rest)) => (0..=names.len()).any(|k| all(rest, &names[k..])),
            Some((one, rest)) => {
                names.split_first().is_some_and(|(name, after)| fits(one, name) && all(rest, after))
            }
        }
    }
    let [patterns, names] = [pattern, path].map(|text| text.split('/').collect::<Vec<&str>>());
    all(&patterns, &names)
}

/// Whether a name fits a pattern of `*` and `?`.
fn fits(pattern: &str, name: &str) -> bool {
    let name: Vec<char> = name.chars().collect();
    // `so_far[k]`: whether the pattern so far fits the first `k` signs.
    let mut so_far = vec![false; name.len() + 1];
    so_far[0] = true;
    for sign in pattern.chars() {
        if sign == '*' {
            (0..name.len()).for_each(|k| so_far[k + 1] |= so_far[k]);
        } else {
            (0..name.len()).rev().for_each(|k| so_far[k + 1] = so_far[k] && (sign == '?' || sign == name[k]));
            so_far[0] = false;
        }
    }
    so_far[name.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_stand_for_names_within_a_folder_or_for_folders() {
        for (pattern, path, fits) in [
            ("/a/*.mcap", "/a/run.mcap", true),
            ("/a/*.mcap", "/a/b/run.mcap", false),
            ("/a/**/run.mcap", "/a/b/c/run.mcap", true),
            ("/a/**/run.mcap", "/a/run.mcap", true),
            ("/a/**/run.mcap", "/a/other-run.mcap", false),
            ("/a/*/run-?.mcap", "/a/m1/run-7.mcap", true),
            ("/a/*/run-?.mcap", "/a/m1/run-17.mcap", false),
            ("/a/m*/*", "/a/m1/x", true),
        ] {
            assert_eq!(matches(pattern, path), fits, "{pattern} {path}");
        }
    }

    #[test]
    fn folders_patterns_and_lists_lead_to_each_log_once() {
        let temporary = tempfile::tempdir().unwrap();
        let folder = fs::canonicalize(temporary.path()).unwrap();
        let at = |name: &str| folder.join(name);
        for name in
            ["m1/a.mcap", "m1/b.txt", "m2/a.mcap", "m2/.hidden.mcap", "bag/metadata.yaml", "bag/bag_0.mcap"]
        {
            fs::create_dir_all(at(name).parent().unwrap()).unwrap();
            fs::write(at(name), "x").unwrap();
        }
        fs::write(at("m1/b.txt"), "# mine\na.mcap\n\n../m2/a.mcap\n").unwrap();
        let names = |texts: &[&str]| -> Vec<String> {
            let texts: Vec<String> =
                texts.iter().map(|text| at(text).to_string_lossy().into_owned()).collect();
            let (found, _, _) = sources(&texts).unwrap();
            found
                .iter()
                .map(|s| s.path.strip_prefix(&folder).unwrap().to_string_lossy().into_owned())
                .collect()
        };
        assert_eq!(names(&[""]), ["bag", "m1/a.mcap", "m2/a.mcap"]);
        assert_eq!(names(&["m1", "m1/a.mcap"]), ["m1/a.mcap"]);
        assert_eq!(names(&["*/a.mcap"]), ["m1/a.mcap", "m2/a.mcap"]);
        assert_eq!(names(&["m1/b.txt"]), ["m1/a.mcap", "m2/a.mcap"]);
        assert!(matches!(sources(&["ftp://bucket/logs".into()]), Err(FleetFailure::Remote { .. })));
        let nothing = at("nothing*").to_string_lossy().into_owned();
        assert!(matches!(sources(&[nothing]), Err(FleetFailure::NoLogs { .. })));
    }

    #[cfg(unix)]
    #[test]
    fn a_log_that_links_lead_to_counts_once_and_by_its_own_name_if_it_is_among_them() {
        let temporary = tempfile::tempdir().unwrap();
        let at = |name: &str| temporary.path().join(name);
        for folder in ["logs", "else"] {
            fs::create_dir(at(folder)).unwrap();
        }
        for (log, links) in [("logs/m.mcap", ["a.mcap", "z.mcap"]), ("else/b.mcap", ["b.mcap", "c.mcap"])] {
            fs::write(at(log), "x").unwrap();
            for link in links {
                std::os::unix::fs::symlink(at(log), at("logs").join(link)).unwrap();
            }
        }
        let texts = [at("logs").to_string_lossy().into_owned()];
        for found in [sources(&texts).unwrap().0, sources_now(&texts).unwrap()] {
            let names: Vec<_> = found.iter().map(|one| one.path.file_name().unwrap()).collect();
            assert_eq!(names, ["b.mcap", "m.mcap"]);
        }
    }

    #[test]
    fn a_log_that_changed_has_another_tag() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mcap");
        let tag = |text: &str| {
            fs::write(&path, text).unwrap();
            sources(&[path.to_string_lossy().into_owned()]).unwrap().0[0].etag.clone()
        };
        assert_ne!(tag("one"), tag("three"));
    }
}
