//! Which files are worth more than to be replaced in passing: records of a machine, and what was sent to it. A plan
//! or a simulated run can be made again.

use std::{collections::BTreeSet, path::Path};

use super::{PROVENANCE, TRUTH};
use crate::log::{Contents, Topics, contents};

/// How the tables begin that the program writes; others are records.
const OWN_TABLES: [&str; 4] =
    ["stamp_ns,time_s", "run,joint,", "machine,joint,metric,unit,", "machine,at,joint,metric,unit,"];
/// What the head of a page holds that the program wrote.
const OWN_PAGE: &str = "<meta name=\"generator\" content=\"hydrotrace ";

/// What an existing file is, if it is to be kept.
pub fn worth(path: &Path) -> Option<String> {
    match contents(path).ok()? {
        Contents::Log { topics, metadata } => {
            let ours = Topics::default();
            let plan = || only_planned(&topics, &ours) && metadata.contains(PROVENANCE);
            match topics.contains(&ours.command) {
                _ if metadata.contains(TRUTH) || plan() => None,
                true if metadata.contains(PROVENANCE) => Some("a log with a command".to_owned()),
                _ => Some("a log that was recorded or imported".to_owned()),
            }
        }
        Contents::Recording(what) => Some(what.to_owned()),
        Contents::Parquet(own) => (!own).then(|| "a Parquet table of another program".to_owned()),
        Contents::Table(head) if OWN_TABLES.iter().any(|own| head.starts_with(own)) => None,
        Contents::Table(_) => Some("a table that this program did not write".to_owned()),
        Contents::Page(head) if head.contains(OWN_PAGE) => None,
        Contents::Page(_) => Some("a page that this program did not write".to_owned()),
        Contents::Foreign => Some("a file that this program did not write".to_owned()),
        Contents::Other => None,
    }
}

/// Whether no topic is of a run or a command.
fn only_planned(topics: &BTreeSet<String>, ours: &Topics) -> bool {
    let planned = [
        &ours.planned, &ours.trajectory, &ours.description, &ours.planned_description, &ours.transforms,
        &ours.fixed_transforms,
    ];
    !topics.is_empty() && topics.iter().all(|topic| planned.contains(&topic))
}
