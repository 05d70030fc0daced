//! What a recovery saved.

use super::kit::{Document, Id, Section, Sentence};
use crate::log::Recovered;

pub(crate) fn document(output: &str, recovered: &Recovered) -> Document {
    let Recovered { messages, doubtful, blocks, dropped_blocks, attachments, remarks } = recovered;
    let lost = match dropped_blocks {
        0 => "none is lost whole".to_owned(),
        lost => format!("{lost} are damaged and lost"),
    };
    let saved = format!(
        "{messages} messages and {attachments} attachments saved to {output}, from {blocks} chunks, of which {lost}."
    );
    let doubt = (*doubtful > 0).then(|| {
        Sentence::finding(format!(
            "{doubtful} of the messages are from chunks that are not as they were written."
        ))
    });
    let whole = remarks.is_empty().then(|| Sentence::finding("Nothing was lost: the log was whole."));
    let section = Section::plain(Id::SUMMARY, [Sentence::finding(saved)]).with_all(doubt).with_all(whole);
    Document::default().with(section).remarked(remarks)
}
