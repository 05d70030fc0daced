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
    series::Pair,
    workflow::report::Report,
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

/// The runs of a side without those that another one is in another file: an export, a table that was packed, a copy by another program.
pub(super) fn each_run_once(
    side: Side,
    reports: Vec<Report>,
    remarks: &mut Remarks,
) -> (Vec<PathBuf>, Vec<Report>) {
    let mut once: Vec<Report> = Vec::new();
    for report in reports {
        match once.iter().find(|other| is_one_run(other, &report)) {
            Some(other) => {
                let [one, other] = [other, &report].map(path);
                let message = format!("{one} and {other} {side} the change are one run; it counts once");
                remarks.add(Code::SameRun, 1, message);
            }
            None => once.push(report),
        }
    }
    (once.iter().map(|report| report.paths.first().cloned().unwrap_or_default()).collect(), once)
}

fn path(report: &Report) -> String {
    report.paths.first().map(|path| path.display().to_string()).unwrap_or_default()
}

/// Whether two runs have the same measurement, to the last digit that a table keeps, at whatever times.
pub(super) fn is_one_run(a: &Report, b: &Report) -> bool {
    const WRITTEN: f64 = 1e-9;
    let alike = |a: &Pair, b: &Pair| {
        a.name == b.name
            && a.measured.len() == b.measured.len()
            && a.measured.iter().zip(&b.measured).all(|(a, b)| (a - b).abs() <= WRITTEN)
    };
    // What has no noise comes again to the last digit.
    let noisy = a.replay.joints.iter().any(|joint| joint.noise.sigma > 0.0);
    noisy && a.pairs.len() == b.pairs.len() && a.pairs.iter().zip(&b.pairs).all(|(a, b)| alike(a, b))
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
