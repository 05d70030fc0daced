//! The one clock of all topics: two clocks would differ by more than the lag that is measured.

use super::{
    content::{Content, Extracted},
    select_topics::Choice,
};
use crate::{
    log::{error::LogError, options::TimeBase, source::Stamps},
    remark::{Code, Remarks},
};

/// Chooses the clock, and says why.
pub(super) fn time_base(
    extracted: &Extracted,
    choice: &Choice,
    asked: Option<TimeBase>,
    remarks: &mut Remarks,
) -> Result<(TimeBase, String), LogError> {
    let tables = choice.measured.iter().chain(&choice.planned).filter_map(|c| {
        let Content::Table(table) = &extracted.sources[c.source].content else { return None };
        Some((extracted.topic_of(c.source).topic.as_str(), &table.stamps))
    });
    let tables: Vec<(&str, &Stamps)> = tables.collect();
    let unusable = |base| tables.iter().find(|(_, stamps)| !stamps.runs(base)).map(|(name, _)| *name);
    if let Some(base) = asked {
        return match unusable(base) {
            Some(topic) => Err(LogError::NoClock { clock: base.name(), topic: topic.to_owned() }),
            None => Ok((base, "as given".to_owned())),
        };
    }
    let Some(topic) = unusable(TimeBase::Header) else {
        return Ok((TimeBase::Header, "header stamps move; they say when a sample was taken".to_owned()));
    };
    let base = if unusable(TimeBase::Publish).is_none() { TimeBase::Publish } else { TimeBase::Log };
    let why = format!("the header stamps of {topic} are absent, zero or constant");
    remarks.add(
        Code::UnusableStamp,
        1,
        format!("{why}; {} time is used, transport delay included", base.name()),
    );
    Ok((base, why))
}
