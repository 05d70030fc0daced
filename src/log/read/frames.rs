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

/// Rejects sources whose transforms are not told in one frame: their difference would be that of the frames.
pub(super) fn check_sides(
    extracted: &Extracted,
    mut planned: impl Iterator<Item = usize>,
    mut measured: impl Iterator<Item = usize>,
) -> Result<(), LogError> {
    let of = |source: usize| Some((source, transform(&extracted.sources[source].content)?));
    let (Some((source, plan)), Some((_, came))) = (planned.find_map(of), measured.find_map(of)) else {
        return Ok(());
    };
    let [a, b] = [plan, came].map(|path| path.split_once(IN).map(|(_, parent)| parent));
    if a == b {
        return Ok(());
    }
    let present = of_topic(extracted, extracted.sources[source].topic).join(", ").into();
    Err(LogError::FramesApart { planned: plan.into(), measured: came.into(), present })
}
