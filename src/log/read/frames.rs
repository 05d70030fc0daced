//! Frames of transforms: which one a caller means, and that both sides are told in one.

use super::content::{Content, Extracted};
use crate::{
    log::{
        error::LogError,
        options::Selector,
        source::{Form, IN, is_field},
    },
    suggest::nearest,
};

/// The transforms of a topic, as CHILD@PARENT.
fn of_topic(extracted: &Extracted, topic: usize) -> Vec<&str> {
    let sources = extracted.sources.iter().filter(|source| source.topic == topic);
    sources.filter_map(|source| transform(&source.content)).collect()
}

fn transform(content: &Content) -> Option<&str> {
    let Content::Table(table) = content else { return None };
    let path = table.fields.first()?.path.as_str();
    (table.form == Form::Poses && path.contains(IN)).then_some(path)
}

/// Rejects a selector of a topic with transforms that fits none of them, or several.
pub(super) fn check_selector(
    extracted: &Extracted,
    topic: usize,
    selector: &Selector,
) -> Result<(), LogError> {
    let present = of_topic(extracted, topic);
    let asked = selector.field.as_deref();
    let fitting = present.iter().filter(|path| asked.is_none_or(|asked| is_field(path, asked))).count();
    if present.is_empty() || fitting == 1 {
        return Ok(());
    }
    let asked = asked.map_or(String::new(), |asked| format!(" of {asked:?}"));
    let frames = present.iter().filter_map(|path| path.split(IN).next());
    Err(LogError::NoTransform {
        topic: selector.topic.clone(),
        found: if fitting == 0 {
            format!("no transform{asked}")
        } else {
            format!("several transforms{asked}")
        },
        nearest: selector.field.as_ref().and_then(|field| nearest(field, frames)).map(Box::from),
        present: present.join(", ").into(),
    })
}

/// Rejects sources whose poses are not told in one frame: their difference would be that of the frames. Where the caller
/// named both sides, two names may be one frame: what to remark.
pub(super) fn check_sides(
    extracted: &Extracted,
    mut planned: impl Iterator<Item = usize>,
    mut measured: impl Iterator<Item = usize>,
    both_named: bool,
) -> Result<Option<String>, LogError> {
    let of = |source: usize| Some((source, told_in(&extracted.sources[source].content)?));
    let (Some((plan, a)), Some((came, b))) = (planned.find_map(of), measured.find_map(of)) else {
        return Ok(None);
    };
    if a.iter().any(|frame| b.contains(frame)) {
        return Ok(None);
    }
    let path = |source: usize| transform(&extracted.sources[source].content).map(Box::from);
    if let (Some(planned), Some(measured)) = (path(plan), path(came)) {
        let present = of_topic(extracted, extracted.sources[plan].topic).join(", ").into();
        return Err(LogError::FramesApart { planned, measured, present });
    }
    let told = |source: usize, frames: &[&str]| {
        format!("{} are told in {}", extracted.topic_of(source).topic, frames.join(" and "))
    };
    let apart = format!("the poses of {}, those of {}", told(plan, &a), told(came, &b));
    if both_named {
        return Ok(Some(format!(
            "{apart}: where these are not one frame by two names, errors are those of the frames"
        )));
    }
    Err(LogError::PosesApart { apart })
}

/// The frames that poses are told in; `None` where they name none.
fn told_in(content: &Content) -> Option<Vec<&str>> {
    if let Some(path) = transform(content) {
        return path.split_once(IN).map(|(_, parent)| vec![parent]);
    }
    let Content::Table(table) = content else { return None };
    (!table.told_in.is_empty()).then(|| table.told_in.iter().map(String::as_str).collect())
}
