//! Finds the plan and the measurement among the topics of a log, and says why.

use std::collections::BTreeSet;

use super::{
    LogError, ReadOptions, Selector, TopicInfo,
    read::{Content, Extracted, Source, TopicCount},
    source::{Form, Role},
};
use crate::suggest::nearest;

/// A topic and field that could serve.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Candidate {
    /// Index into the sources.
    pub(super) source: usize,
    /// Field of the table; `None` for whole trajectories.
    pub(super) field: Option<usize>,
    /// How well its type and name fit, 0 best.
    rank: u32,
    pub(super) joints: Vec<String>,
    messages: usize,
    topic: String,
}

/// What was chosen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Choice {
    pub(super) planned: Vec<Candidate>,
    pub(super) measured: Vec<Candidate>,
    pub(super) why: String,
    /// Topics of another namespace that measure the same joints as well, and were not chosen.
    pub(super) rivals: Vec<String>,
}

impl Choice {
    /// Topics that are the plan for want of a better one: what was sent.
    pub(super) fn commanded(&self) -> impl Iterator<Item = &str> {
        let sent = |c: &&Candidate| c.rank == COMMAND;
        self.planned.iter().filter(sent).map(|c| c.topic.as_str())
    }
}

/// Rank of a plan by a name that says command.
const COMMAND: u32 = 8;
/// Rank of what is only used when the caller names it.
const ONLY_IF_NAMED: u32 = 9;

const PLAN_WORDS: [&str; 8] =
    ["planned", "plan", "desired", "reference", "ref", "target", "setpoint", "goal"];
const COMMAND_WORDS: [&str; 3] = ["command", "commands", "cmd"];

fn has_word(topic: &str, words: &[&str]) -> bool {
    topic.to_ascii_lowercase().split(['/', '_', '-', '.']).any(|word| words.contains(&word))
}

pub(super) fn choose(extracted: &Extracted, options: &ReadOptions) -> Result<Choice, LogError> {
    let planned = candidates(extracted, &options.planned, Role::Planned)?;
    let measured = candidates(extracted, &options.measured, Role::Measured)?;
    let missing = |missing, flag| LogError::Missing { missing, present: present(extracted), flag };
    if planned.is_empty() {
        return Err(missing("planned", "--planned"));
    }
    if measured.is_empty() {
        return Err(missing("measured", "--measured"));
    }
    let measured_joints: BTreeSet<&String> = measured.iter().flat_map(|c| &c.joints).collect();
    let first = planned.iter().find(|c| c.joints.iter().any(|joint| measured_joints.contains(joint)));
    let Some(first) = first else {
        let list = |all: &[Candidate]| {
            let names: BTreeSet<&str> = all.iter().flat_map(|c| &c.joints).map(String::as_str).collect();
            names.into_iter().collect::<Vec<_>>().join(", ")
        };
        return Err(LogError::NoCommonJoint { planned: list(&planned), measured: list(&measured) });
    };
    // Several controllers each plan joints of their own: all of one kind are used.
    let explicit = !options.planned.is_empty();
    let planned = cover(planned.iter().filter(|c| explicit || c.rank == first.rank), None, Some(first));
    let wanted: BTreeSet<&String> = planned.iter().flat_map(|c| &c.joints).collect();
    // The message that holds the plan holds the measurement of the same instant, if any does.
    let mut ordered: Vec<&Candidate> = measured.iter().collect();
    let kinship =
        |c: &Candidate| planned.iter().map(|p| shared_namespace(&p.topic, &c.topic)).max().unwrap_or(0);
    ordered.sort_by_key(|c| (!planned.iter().any(|p| p.source == c.source), std::cmp::Reverse(kinship(c))));
    let all_measured = measured.clone();
    let measured = cover(ordered.into_iter(), Some(&wanted), None);
    if let (Some(p), Some(m)) = (planned.first(), measured.first())
        && (p.source, p.field) == (m.source, m.field)
    {
        return Err(LogError::SameField { field: p.topic.clone() });
    }
    let why = why(extracted, options, &planned, &measured);
    let rivals = rivals(&all_measured, &measured, &wanted);
    Ok(Choice { planned, measured, why, rivals })
}

/// The plan alone, of a log that need not hold a measurement.
pub(super) fn choose_plan(extracted: &Extracted, options: &ReadOptions) -> Result<Choice, LogError> {
    let planned = candidates(extracted, &options.planned, Role::Planned)?;
    let Some(first) = planned.first() else {
        return Err(LogError::Missing { missing: "planned", present: present(extracted), flag: "--planned" });
    };
    let explicit = !options.planned.is_empty();
    let chosen = cover(planned.iter().filter(|c| explicit || c.rank == first.rank), None, Some(first));
    let why = why(extracted, options, &chosen, &[]);
    Ok(Choice { planned: chosen, measured: Vec::new(), why, rivals: Vec::new() })
}

/// The measurement alone, of a log that need not hold a plan.
pub(super) fn choose_measured(extracted: &Extracted, options: &ReadOptions) -> Result<Choice, LogError> {
    let measured = candidates(extracted, &options.measured, Role::Measured)?;
    if measured.is_empty() {
        let present = present(extracted);
        return Err(LogError::Missing { missing: "measured", present, flag: "--measured" });
    }
    let chosen = cover(measured.iter(), None, None);
    let why = why(extracted, options, &[], &chosen);
    Ok(Choice { planned: Vec::new(), measured: chosen, why, rivals: Vec::new() })
}

/// Leading parts of their names that two topics share.
fn shared_namespace(a: &str, b: &str) -> usize {
    namespace(a).zip(namespace(b)).take_while(|(a, b)| a == b).count()
}

/// The parts of a topic's name but the last.
fn namespace(topic: &str) -> impl Iterator<Item = &str> {
    let stem = topic.rsplit_once('/').map_or("", |(stem, _)| stem);
    stem.split('/').filter(|part| !part.is_empty())
}

/// What would have served as well as what was chosen, elsewhere.
fn rivals(all: &[Candidate], chosen: &[Candidate], wanted: &BTreeSet<&String>) -> Vec<String> {
    let same_home = |a: &Candidate, b: &Candidate| namespace(&a.topic).eq(namespace(&b.topic));
    let rival = |c: &&Candidate| {
        chosen.iter().all(|m| m.source != c.source)
            && chosen.iter().any(|m| m.rank == c.rank && !same_home(m, c))
            && c.joints.iter().any(|joint| wanted.contains(joint))
    };
    all.iter().filter(rival).map(|c| c.topic.clone()).collect()
}

/// Most topics that one side is put together from.
const MAX_TOPICS: usize = 64;

/// Takes candidates in order as long as each adds joints that no earlier one had.
fn cover<'a>(
    candidates: impl Iterator<Item = &'a Candidate>,
    wanted: Option<&BTreeSet<&String>>,
    first: Option<&'a Candidate>,
) -> Vec<Candidate> {
    let mut covered: BTreeSet<&String> = BTreeSet::new();
    let mut chosen = Vec::new();
    for candidate in first.into_iter().chain(candidates) {
        if chosen.len() == MAX_TOPICS {
            break;
        }
        let adds =
            |joint: &&String| !covered.contains(joint) && wanted.is_none_or(|wanted| wanted.contains(joint));
        let overlaps = candidate.joints.iter().any(|joint| covered.contains(joint));
        if candidate.joints.iter().any(|joint| adds(&joint))
            && (chosen.is_empty() || !overlaps || wanted.is_some())
        {
            covered.extend(&candidate.joints);
            chosen.push(candidate.clone());
        }
    }
    chosen
}

fn why(
    extracted: &Extracted,
    options: &ReadOptions,
    planned: &[Candidate],
    measured: &[Candidate],
) -> String {
    let topic = |c: &Candidate| extracted.topics[extracted.sources[c.source].topic].topic.as_str();
    let list = |all: &[Candidate]| all.iter().map(topic).collect::<Vec<_>>().join(", ");
    let same =
        planned.len() == measured.len() && planned.iter().zip(measured).all(|(p, m)| p.source == m.source);
    let plan = match (options.planned.is_empty(), planned.first().map(|c| c.rank)) {
        (false, _) => "plan as given".to_owned(),
        (true, Some(1)) => format!("plan from {}, by its name", list(planned)),
        (true, Some(3 | 6)) if planned.iter().all(|c| c.field.is_none()) => {
            format!("plan sampled from the trajectory messages of {}", list(planned))
        }
        _ => format!("plan from {}", list(planned)),
    };
    match (options.measured.is_empty(), same) {
        (false, _) => format!("{plan}; measurement as given"),
        (true, true) => format!("{plan}; each message holds plan and measurement of the same instant"),
        (true, false) => format!("{plan}; measurement from {}", list(measured)),
    }
}

/// All that could serve in a role, best first; those the caller named, if any.
fn candidates(extracted: &Extracted, named: &[Selector], role: Role) -> Result<Vec<Candidate>, LogError> {
    let mut found = Vec::new();
    if named.is_empty() {
        for source in 0..extracted.sources.len() {
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
    for selector in named {
        let topic = extracted.topics.iter().position(|t| t.topic == selector.topic).ok_or_else(|| {
            LogError::NoTopic {
                topic: selector.topic.clone(),
                nearest: nearest(&selector.topic, extracted.topics.iter().map(|t| t.topic.as_str())),
                present: present(extracted),
            }
        })?;
        let sources = (0..extracted.sources.len()).filter(|&s| extracted.sources[s].topic == topic);
        let mut fitting: Vec<Candidate> =
            sources.flat_map(|s| of_source(extracted, s, role, selector.field.as_deref())).collect();
        fitting.sort_by_key(|c| (c.rank, c.field));
        let TopicCount { topic: name, type_name, .. } = &extracted.topics[topic];
        let none = || {
            let fields = topic_info(extracted, topic, of_topic(extracted, topic)).joint_fields;
            LogError::NoField {
                topic: name.clone(),
                type_name: type_name.as_str().into(),
                nearest: selector
                    .field
                    .as_ref()
                    .and_then(|f| nearest(f, fields.iter().map(String::as_str)))
                    .map(String::into_boxed_str),
                field: selector.field.as_deref().map(Box::from),
                present: if fields.is_empty() { "none".to_owned() } else { fields.join(", ") },
            }
        };
        found.push(fitting.into_iter().next().ok_or_else(none)?);
    }
    Ok(found)
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
        Content::Versioned(_) => Vec::new(),
        Content::Plans(plans) => {
            let joints: BTreeSet<&String> = plans.trajectories.iter().flat_map(|t| &t.joints).collect();
            let joints: Vec<String> = joints.into_iter().cloned().collect();
            if role == Role::Measured || joints.is_empty() {
                return Vec::new();
            }
            let rank = if topic.type_name.ends_with("JointTrajectory") { 3 } else { 6 };
            vec![candidate(None, rank, joints, plans.trajectories.len())]
        }
        Content::Table(table) => {
            let positions = table.fields.iter().enumerate().filter(|(_, f)| !f.is_velocity);
            positions
                .filter(|(_, f)| field.is_none_or(|path| f.path == path))
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

/// How well a field fits a role, 1 best, [`ONLY_IF_NAMED`] worst.
fn rank(topic: &TopicCount, form: Form, field: Role, role: Role) -> u32 {
    let feedback = topic.type_name.contains("Feedback");
    let array = topic.type_name.ends_with("Float64MultiArray");
    let (plan, command) = (has_word(&topic.topic, &PLAN_WORDS), has_word(&topic.topic, &COMMAND_WORDS));
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
        (Role::Measured, Role::Either) if !plan && !command && !array => {
            if has_word(&topic.topic, &["error"]) { ONLY_IF_NAMED } else { 2 }
        }
        _ => ONLY_IF_NAMED,
    }
}

/// Topics with joints, for messages; all topics if there is none.
fn present(extracted: &Extracted) -> String {
    let with_joints: BTreeSet<usize> = extracted.sources.iter().map(|s| s.topic).collect();
    let describe = |index: usize| {
        let topic = &extracted.topics[index];
        let messages = if topic.messages == 1 { "message" } else { "messages" };
        format!("{} ({}, {} {messages})", topic.topic, topic.type_name, topic.messages)
    };
    let listed: Vec<String> = if with_joints.is_empty() {
        (0..extracted.topics.len()).map(describe).collect()
    } else {
        with_joints.into_iter().map(describe).collect()
    };
    if listed.is_empty() { "no topics at all".to_owned() } else { listed.join(", ") }
}

fn of_topic(extracted: &Extracted, topic: usize) -> impl Iterator<Item = &Source> {
    extracted.sources.iter().filter(move |source| source.topic == topic)
}

/// What `info` says of each topic, by name.
pub(super) fn topic_infos(extracted: &Extracted) -> Vec<TopicInfo> {
    let mut sources: Vec<Vec<&Source>> = vec![Vec::new(); extracted.topics.len()];
    extracted.sources.iter().for_each(|source| sources[source.topic].push(source));
    let infos = sources.into_iter().enumerate();
    let mut infos: Vec<TopicInfo> =
        infos.map(|(index, sources)| topic_info(extracted, index, sources.into_iter())).collect();
    infos.sort_by(|a, b| (&a.topic, &a.type_name).cmp(&(&b.topic, &b.type_name)));
    infos
}

fn topic_info<'a>(
    extracted: &Extracted,
    index: usize,
    sources: impl Iterator<Item = &'a Source>,
) -> TopicInfo {
    let count = &extracted.topics[index];
    let mut info = TopicInfo {
        topic: count.topic.clone(),
        type_name: count.type_name.clone(),
        encoding: count.encoding.clone(),
        messages: count.messages,
        rate_hz: 0.0,
        joint_fields: Vec::new(),
        joints: Vec::new(),
    };
    let spread_s = count.last_log_ns.saturating_sub(count.first_log_ns) as f64 / crate::units::NS_PER_S;
    if count.messages > 1 && spread_s > 0.0 {
        info.rate_hz = (count.messages - 1) as f64 / spread_s;
    }
    for source in sources {
        match &source.content {
            Content::Table(table) => {
                info.joints.extend(table.joints.iter().cloned());
                for (k, field) in table.fields.iter().enumerate() {
                    if !field.is_velocity && (0..table.joints.len()).any(|j| !table.column(k, j).is_empty()) {
                        info.joint_fields.push(field.path.clone());
                    }
                }
            }
            Content::Plans(plans) => {
                let joints: BTreeSet<&String> = plans.trajectories.iter().flat_map(|t| &t.joints).collect();
                info.joints.extend(joints.into_iter().cloned());
                info.joint_fields.push("points.positions".to_owned());
            }
            Content::Versioned(_) => {}
        }
    }
    info
}
