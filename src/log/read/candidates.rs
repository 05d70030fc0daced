//! The topics and fields of a log that could be the plan or the measurement, and how well they fit.

use std::collections::BTreeSet;

use super::{
    content::{Content, Extracted, TopicCount},
    frames,
    topics::{fields_of, lacking, not_there, of_one_number},
};
use crate::{
    log::{
        channel::unread,
        error::LogError,
        options::{ReadOptions, Selector},
        source::{Form, Role, is_field},
    },
    suggest::nearest,
};

/// A topic and field that could serve.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Candidate {
    /// Index into the sources.
    pub(super) source: usize,
    /// Field of the table; `None` for whole trajectories.
    pub(super) field: Option<usize>,
    /// How well its type and name fit, 0 best.
    pub(super) rank: u32,
    pub(super) joints: Vec<String>,
    pub(super) messages: usize,
    pub(super) topic: String,
}

/// Rank of a plan by a name that says command.
pub(super) const COMMAND: u32 = 8;
/// Rank of trajectories that a planner shows, which need not be those that are executed, nor at once.
const SHOWN: u32 = 7;
/// Rank of fields that are used only if the caller names them.
const ONLY_IF_NAMED: u32 = 99;
/// Rank of poses of a tool, which count where there are no joints.
const POSE: u32 = 10;

const PLAN_WORDS: [&str; 8] =
    ["planned", "plan", "desired", "reference", "ref", "target", "setpoint", "goal"];
/// Word of a topic that is neither plan nor measurement.
const ERROR: &str = "error";
const COMMAND_WORDS: [&str; 3] = ["command", "commands", "cmd"];

fn has_word(topic: &str, words: &[&str]) -> bool {
    topic.to_ascii_lowercase().split(['/', '_', '-', '.']).any(|word| words.contains(&word))
}

/// Whether a topic is a measurement by its name, if it holds joints at all.
pub(super) fn is_measured(topic: &str) -> bool {
    !has_word(topic, &PLAN_WORDS) && !has_word(topic, &COMMAND_WORDS)
}

/// All that could serve as plan and as measurement, best first. What the caller names as one side is not the other; where
/// names tell nothing of the other, it is the only other topic of these joints: then with what to remark.
pub(super) fn of_sides(
    extracted: &Extracted,
    options: &ReadOptions,
) -> Result<([Vec<Candidate>; 2], Option<String>), LogError> {
    let mut planned = candidates(extracted, &options.planned, Role::Planned)?;
    let mut measured = candidates(extracted, &options.measured, Role::Measured)?;
    let (named, other, role, side, flag) = match (options.planned.is_empty(), options.measured.is_empty()) {
        (false, true) => (&planned, &mut measured, Role::Measured, "measurement", "--measured"),
        (true, false) => (&measured, &mut planned, Role::Planned, "plan", "--planned"),
        _ => return Ok(([planned, measured], None)),
    };
    let same = |a: &Candidate, b: &Candidate| (a.source, a.field) == (b.source, b.field);
    other.retain(|one| !named.iter().any(|named| same(named, one)));
    let mut doubt = None;
    if other.is_empty() {
        *other = only_other(extracted, named, role);
        doubt = other.first().map(|one| {
            format!(
                "{} is taken as the {side}: it is the only other topic of these joints; {flag} names another",
                one.topic
            )
        });
    }
    Ok(([planned, measured], doubt))
}

/// The candidates of the only topic, beside those named, that has joints of theirs; none where there are several.
fn only_other(extracted: &Extracted, named: &[Candidate], role: Role) -> Vec<Candidate> {
    let is_either = |c: &Candidate| match (&extracted.sources[c.source].content, c.field) {
        (Content::Table(table), Some(field)) => table.fields[field].role == Role::Either,
        _ => false,
    };
    let fits = |c: &Candidate| {
        let common = named.iter().flat_map(|one| &one.joints).any(|joint| c.joints.contains(joint));
        let other = named.iter().all(|one| one.topic != c.topic);
        common && other && is_either(c) && !has_word(&c.topic, &[ERROR])
    };
    let all = (0..extracted.sources.len()).flat_map(|source| of_source(extracted, source, role, None));
    let mut found: Vec<Candidate> = all.filter(fits).collect();
    if found.iter().any(|c| c.topic != found[0].topic) {
        found.clear();
    }
    found
}

/// All that could serve in a role, best first; those the caller named, if any.
pub(super) fn candidates(
    extracted: &Extracted,
    named: &[Selector],
    role: Role,
) -> Result<Vec<Candidate>, LogError> {
    let sent = extracted.sent().filter(|_| role == Role::Planned);
    if named.is_empty() {
        let mut found = Vec::new();
        let is_sent = |source: usize| sent.is_some_and(|sent| sent.is_on(&extracted.topic_of(source).topic));
        for source in (0..extracted.sources.len()).filter(|source| !is_sent(*source)) {
            found.extend(
                of_source(extracted, source, role, None).into_iter().filter(|c| c.rank < ONLY_IF_NAMED),
            );
        }
        found.sort_by(|a, b| {
            (a.rank, b.messages, &a.topic, a.source, a.field)
                .cmp(&(b.rank, a.messages, &b.topic, b.source, b.field))
        });
        return Ok(found);
    }
    let mut meant: Vec<Selector> = Vec::new();
    for selector in named {
        let plan = sent.and_then(|sent| sent.plan_behind(selector));
        let selector = plan.unwrap_or_else(|| selector.clone());
        if !meant.contains(&selector) {
            meant.push(selector);
        }
    }
    let named = meant.iter().map(|selector| self::named(extracted, selector, role));
    Ok(named.collect::<Result<Vec<_>, _>>()?.concat())
}

/// The candidates of a selector: one for each publisher of the topic that sends joints of its own.
pub(super) fn named(
    extracted: &Extracted,
    selector: &Selector,
    role: Role,
) -> Result<Vec<Candidate>, LogError> {
    let topic = extracted.topics.iter().position(|t| t.topic == selector.topic);
    let topic = topic.ok_or_else(|| not_there(extracted, selector))?;
    frames::check_selector(extracted, topic, selector)?;
    let sources = (0..extracted.sources.len()).filter(|&s| extracted.sources[s].topic == topic);
    let mut fitting: Vec<Candidate> =
        sources.flat_map(|s| of_source(extracted, s, role, selector.field.as_deref())).collect();
    if let Some(best) = fitting.iter().min_by_key(|c| (c.rank, c.field)).cloned() {
        let beside = |c: &Candidate| c.joints.iter().all(|joint| !best.joints.contains(joint));
        fitting.retain(|c| (c.rank, c.field) == (best.rank, best.field) && (*c == best || beside(c)));
        return Ok(fitting);
    }
    let TopicCount { topic: name, type_name, .. } = &extracted.topics[topic];
    let unreadable =
        unread(&extracted.topics[topic].encoding).or_else(|| extracted.topics[topic].problem.clone());
    let mut fields = fields_of(extracted, topic);
    fields.extend(extracted.topics[topic].values.iter().cloned());
    let near = |field: &String| nearest(field, fields.iter().map(String::as_str)).map(String::into_boxed_str);
    Err(LogError::NoField {
        topic: name.clone(),
        type_name: type_name.as_str().into(),
        nearest: selector.field.as_ref().and_then(near),
        field: selector.field.as_deref().map(Box::from),
        present: match fields.as_slice() {
            [] => match lacking(extracted, topic) {
                Some(lacks) => lacks.to_owned(),
                None => match (unreadable, of_one_number(&extracted.topics[topic])) {
                    (Some(why), _) => format!("none that can be read: {why}"),
                    (None, Some(how)) => format!("one number a message, named {how}"),
                    (None, None) => "none".to_owned(),
                },
            },
            fields => fields.join(", "),
        },
    })
}

fn of_source(extracted: &Extracted, source: usize, role: Role, field: Option<&str>) -> Vec<Candidate> {
    let topic = &extracted.topics[extracted.sources[source].topic];
    let candidate = |field, rank, joints, messages| Candidate {
        source,
        field,
        rank,
        joints,
        messages,
        topic: topic.topic.clone(),
    };
    match &extracted.sources[source].content {
        Content::Versioned(_) | Content::Poses(_) => Vec::new(),
        Content::Plans(plans) => {
            let joints: BTreeSet<&String> = plans.trajectories.iter().flat_map(|t| &t.joints).collect();
            let joints: Vec<String> = joints.into_iter().cloned().collect();
            if role != Role::Planned || joints.is_empty() || plans.fault().is_some() {
                return Vec::new();
            }
            let rank = match topic.type_name.as_str() {
                name if is_shown(name) => SHOWN,
                name if name.ends_with("JointTrajectory") => 3,
                _ => 6,
            };
            vec![candidate(None, rank, joints, plans.trajectories.len())]
        }
        Content::Table(table) => {
            let positions = table.fields.iter().enumerate().filter(|(_, f)| !f.is_velocity);
            positions
                .filter(|(_, f)| field.is_none_or(|path| is_field(&f.path, path)))
                .filter_map(|(k, f)| {
                    let filled = |j: &usize| table.column(k, *j).iter().any(|v| v.is_finite());
                    let joints: Vec<String> =
                        (0..table.joints.len()).filter(filled).map(|j| table.joints[j].clone()).collect();
                    let rank = rank(topic, table.form, f.role, role);
                    (!joints.is_empty()).then(|| candidate(Some(k), rank, joints, table.len()))
                })
                .collect()
        }
    }
}

/// Whether messages of a type are trajectories that a planner shows.
pub(super) fn is_shown(type_name: &str) -> bool {
    type_name.ends_with("DisplayTrajectory")
}

/// How well a field fits a role, 1 best, [`ONLY_IF_NAMED`] worst.
fn rank(topic: &TopicCount, form: Form, field: Role, role: Role) -> u32 {
    let feedback = topic.type_name.contains("Feedback");
    let array = topic.type_name.ends_with("Float64MultiArray");
    let (plan, command) = (has_word(&topic.topic, &PLAN_WORDS), has_word(&topic.topic, &COMMAND_WORDS));
    if form == Form::Poses {
        return match (role, field) {
            (Role::Planned, Role::Either) if plan => POSE,
            (Role::Planned, Role::Planned) => POSE + 1,
            (Role::Measured, Role::Either) if is_measured(&topic.topic) => POSE,
            _ => ONLY_IF_NAMED,
        };
    }
    match (role, field) {
        (Role::Planned, Role::Planned) => match form {
            _ if feedback => 4,
            Form::Versioned => 5,
            // Of two topics of one controller the newer name is the one that is always filled.
            _ => 2,
        },
        (Role::Planned, Role::Either) if plan && !array => 1,
        (Role::Planned, Role::Either) if plan => 7,
        (Role::Planned, Role::Either) if command => COMMAND,
        (Role::Measured, Role::Measured) => match form {
            _ if feedback => 6,
            Form::Versioned => 5,
            Form::Interfaces => 4,
            _ => 3,
        },
        (Role::Measured, Role::Either) if is_measured(&topic.topic) && !array => {
            if has_word(&topic.topic, &[ERROR]) { ONLY_IF_NAMED } else { 2 }
        }
        _ => ONLY_IF_NAMED,
    }
}
