//! Whether two runs are one: nothing can have changed between them.

use std::{
    fs,
    io::{self, BufReader, Read},
    path::{Path, PathBuf},
};

use super::Side;
use crate::{
    input_file,
    remark::{Code, Remarks},
};

/// The runs of a side, each once: one that is counted twice says no more of how runs differ.
pub(super) fn each_once(side: Side, logs: &[PathBuf], remarks: &mut Remarks) -> Vec<PathBuf> {
    let mut once: Vec<PathBuf> = Vec::new();
    for log in logs {
        if once.iter().any(|other| is_same(other, log)) {
            let message = format!("{} is given again {side} the change; it counts once", log.display());
            remarks.add(Code::SameRun, 1, message);
        } else {
            once.push(log.clone());
        }
    }
    once
}

/// Whether two paths lead to one file or bag, or to files of equal content.
pub(super) fn is_same(a: &Path, b: &Path) -> bool {
    let whole = |path: &Path| fs::canonicalize(path);
    if matches!((whole(a), whole(b)), (Ok(a), Ok(b)) if a == b) {
        return true;
    }
    let length = |path: &Path| fs::metadata(path).ok().filter(fs::Metadata::is_file).map(|found| found.len());
    length(a).is_some() && length(a) == length(b) && equal(a, b).unwrap_or(false)
}

fn equal(a: &Path, b: &Path) -> io::Result<bool> {
    let bytes = |path: &Path| input_file::open(path).map(|file| BufReader::new(file).bytes());
    let (mut a, mut b) = (bytes(a)?, bytes(b)?);
    loop {
        match (a.next().transpose()?, b.next().transpose()?) {
            (None, None) => return Ok(true),
            (one, other) if one != other => return Ok(false),
            _ => {}
        }
    }
}
