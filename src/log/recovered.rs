//! What a log carries of its own recovery: messages whose values may be wrong.

use std::collections::BTreeMap;

use crate::remark::{Code, Remarks};

/// The name of the metadata record.
pub(super) const METADATA: &str = "hydrotrace.recover";
const DOUBTFUL: &str = "doubtful_messages";

/// Metadata of a log with messages from chunks that were not as they were written.
pub(super) fn metadata(doubtful: u64) -> BTreeMap<String, String> {
    BTreeMap::from([(DOUBTFUL.to_owned(), doubtful.to_string())])
}

/// Remarks what was doubtful when the log was recovered.
pub(super) fn remark(metadata: &BTreeMap<String, BTreeMap<String, String>>, remarks: &mut Remarks) {
    let count = metadata.get(METADATA).and_then(|entries| entries.get(DOUBTFUL)?.parse().ok()).unwrap_or(0);
    let message = "messages were recovered from chunks that are not as they were written: values of theirs may be wrong";
    remarks.add(Code::DamagedChunk, count, message);
}
