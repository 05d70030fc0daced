//! Finds the plan and the measurement among the topics of a log, and says why.

use std::collections::BTreeSet;

use super::{
    content::{Content, Extracted, TopicCount},
    frames,
    topics::{columns_named, fields_of, lacks_positions, missing, not_there},
};
use crate::{
    log::{
        error::LogError,
        options::{ReadOptions, Selector, Sides},
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
    rank: u32,
    pub(super) joints: Vec<String>,
    messages: usize,
    topic: String,
}

/// The chosen topics and fields.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Choice {
    pub(super) planned: Vec<Candidate>,
    pub(super) measured: Vec<Candidate>,
    pub(super) why: String,
    /// Topics of another namespace that measure the same joints as well, and were not chosen.
    pub(super) rivals: Vec<String>,
}

impl Choice {
    /// Whether poses of a tool are among it.
    pub(super) fn of_poses(&self, extracted: &Extracted) -> bool {
        let all = self.planned.iter().chain(&self.measured);
        let mut tables = all.map(|c| &extracted.sources[c.source].content);
        tables.any(|content| matches!(content, Content::Table(table) if table.form == Form::Poses))
    }

    /// Topics of commands that serve as the plan because the log has no other.
    pub(super) fn commanded(&self) -> impl Iterator<Item = &str> {
        let sent = |c: &&Candidate| c.rank == COMMAND;
        self.planned.iter().filter(sent).map(|c| c.topic.as_str())
    }
}

/// Rank of a plan by a name that says command.
const COMMAND: u32 = 8;
/// Rank of fields that are used only if the caller names them.
const ONLY_IF_NAMED: u32 = 99;
/// Rank of poses of a tool, which count where there are no joints.
const POSE: u32 = 10;

const PLAN_WORDS: [&str; 8] =
    ["planned", "plan", "desired", "reference", "ref", "target", "setpoint", "goal"];
const COMMAND_WORDS: [&str; 3] = ["command", "commands", "cmd"];

fn has_word(topic: &str, words: &[&str]) -> bool {
    topic.to_ascii_lowercase().split(['/', '_', '-', '.']).any(|word| words.contains(&word))
}

/// Whether a topic is a measurement by its name, if it holds joints at all.
pub(super) fn is_measured(topic: &str) -> bool {
    !has_word(topic, &PLAN_WORDS) && !has_word(topic, &COMMAND_WORDS)
}

/// Chooses the topics of the sides that are wanted.
pub(super) fn choose(extracted: &Extracted, options: &ReadOptions) -> Result<Choice, LogError> {
    if let Some(error) = columns_named(extracted, options) {
        return Err(error);
    }
    let plan = || choose_one(extracted, options, Role::Planned);
    let measurement = || choose_one(extracted, options, Role::Measured);
    let lacks = |error: &LogError| match error {
        LogError::Missing { missing, .. } => Some(*missing),
        _ => None,
    };
    if options.sides == Sides::Plan {
        return plan();
    }
    let both = choose_both(extracted, options);
    match (options.sides, both.as_ref().err().and_then(lacks)) {
        (Sides::PlanAtLeast | Sides::Any, Some(MEASURED)) => plan(),
        (Sides::MeasurementAtLeast, Some(PLANNED)) => measurement(),
        (Sides::Any, Some(PLANNED)) => measurement().map_err(|error| match error {
            LogError::Missing { .. } => {
                missing(extracted, options, "planned, commanded or measured", "--planned or --measured")
            }
            other => other,
        }),
        _ => both,
    }
}

const PLANNED: &str = "planned";
pub(super) const MEASURED: &str = "measured";

fn choose_both(extracted: &Extracted, options: &ReadOptions) -> Result<Choice, LogError> {
    let planned = candidates(extracted, &options.planned, Role::Planned)?;
    let measured = candidates(extracted, &options.measured, Role::Measured)?;
    if planned.is_empty() {
        return Err(missing(extracted, options, PLANNED, "--planned"));
    }
    if measured.is_empty() {
        return Err(missing(extracted, options, MEASURED, "--measured"));
    }
    let measured_joints: BTreeSet<&String> = measured.iter().flat_map(|c| &c.joints).collect();
    let common = |c: &&Candidate| c.joints.iter().any(|joint| measured_joints.contains(joint));
    let best = planned.iter().find(common);
    // Of several arms that of the measurement, if the caller names one.
    let near = |c: &Candidate| measured.iter().map(|m| kinship(&c.topic, &m.topic)).max().unwrap_or(0);
    let named = !options.measured.is_empty() && options.planned.is_empty();
    let alike =
        planned.iter().filter(|c| named && best.is_some_and(|best| best.rank == c.rank)).filter(common);
    // The first of the nearest.
    let first = alike.rev().max_by_key(|c| near(c)).or(best);
    let Some(first) = first else {
        let list = |all: &[Candidate]| {
            let names: BTreeSet<&str> = all.iter().flat_map(|c| &c.joints).map(String::as_str).collect();
            names.into_iter().collect::<Vec<_>>().join(", ")
        };
        return Err(LogError::NoCommonJoint { planned: list(&planned), measured: list(&measured) });
    };
    // Several controllers each plan joints of their own: all of one kind are used, and others of joints that are measured.
    let explicit = !options.planned.is_empty();
    let serves = |c: &&Candidate| explicit || c.rank == first.rank || c.rank < COMMAND && common(c);
    let planned = cover(planned.iter().filter(serves), None, Some(first));
    let wanted: BTreeSet<&String> = planned.iter().flat_map(|c| &c.joints).collect();
    // The message that holds the plan holds the measurement of the same instant, if any does.
    let mut ordered: Vec<&Candidate> = measured.iter().collect();
    let near = |c: &Candidate| planned.iter().map(|p| kinship(&p.topic, &c.topic)).max().unwrap_or(0);
    ordered.sort_by_key(|c| (!planned.iter().any(|p| p.source == c.source), std::cmp::Reverse(near(c))));
    let all_measured = measured.clone();
    let measured = cover(ordered.into_iter(), Some(&wanted), None);
    if let (Some(p), Some(m)) = (planned.first(), measured.first())
        && (p.source, p.field) == (m.source, m.field)
    {
        return Err(LogError::SameField { field: p.topic.clone() });
    }
    let source = |c: &Candidate| c.source;
    frames::check_sides(extracted, planned.iter().map(source), measured.iter().map(source))?;
    let why = why(extracted, options, &planned, &measured);
    let rivals = rivals(&all_measured, &measured, &wanted);
    Ok(Choice { planned, measured, why, rivals })
}

/// One side alone.
fn choose_one(extracted: &Extracted, options: &ReadOptions, role: Role) -> Result<Choice, LogError> {
    let (asked, side, flag) = match role {
        Role::Measured => (&options.measured, MEASURED, "--measured"),
        _ => (&options.planned, PLANNED, "--planned"),
    };
    let found = candidates(extracted, asked, role)?;
    let Some(first) = found.first() else {
        return Err(missing(extracted, options, side, flag));
    };
    let (mut planned, mut measured) = (Vec::new(), Vec::new());
    if role == Role::Measured {
        measured = cover(found.iter(), None, None);
    } else {
        let alike = found.iter().filter(|c| !asked.is_empty() || c.rank == first.rank);
        planned = cover(alike, None, Some(first));
    }
    let why = why(extracted, options, &planned, &measured);
    Ok(Choice { planned, measured, why, rivals: Vec::new() })
}

/// Leading words of their namespaces that two topics share: two of `/arm_right/joint_states` and
/// `/arm_right_controller/joint_trajectory`.
fn kinship(a: &str, b: &str) -> usize {
    let [a, b] = [a, b].map(|topic| namespace(topic).flat_map(|part| part.split('_')));
    a.zip(b).take_while(|(a, b)| a == b).count()
}

/// The parts of a topic's name but the last.
fn namespace(topic: &str) -> impl Iterator<Item = &str> {
    let stem = topic.rsplit_once('/').map_or("", |(stem, _)| stem);
    stem.split('/').filter(|part| !part.is_empty())
}

/// Topics of other namespaces that would have served as well.
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
    let given = |c: &Candidate| options.planned.iter().any(|named| named.topic == topic(c));
    let plan = match (options.planned.is_empty(), planned.first().map(|c| c.rank)) {
        (false, _) if planned.iter().all(given) => "plan as given".to_owned(),
        (false, _) => {
            let sent: Vec<&str> = options.planned.iter().map(|named| named.topic.as_str()).collect();
            format!("plan from {}, joined for what was sent on {}", list(planned), sent.join(", "))
        }
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
    meant.iter().map(|selector| self::named(extracted, selector, role)).collect()
}

/// The candidate of a selector.
pub(super) fn named(extracted: &Extracted, selector: &Selector, role: Role) -> Result<Candidate, LogError> {
    let topic = extracted.topics.iter().position(|t| t.topic == selector.topic);
    let topic = topic.ok_or_else(|| not_there(extracted, selector))?;
    frames::check_selector(extracted, topic, selector)?;
    let sources = (0..extracted.sources.len()).filter(|&s| extracted.sources[s].topic == topic);
    let fitting = sources.flat_map(|s| of_source(extracted, s, role, selector.field.as_deref()));
    fitting.min_by_key(|c| (c.rank, c.field)).ok_or_else(|| {
        let TopicCount { topic: name, type_name, .. } = &extracted.topics[topic];
        let fields = fields_of(extracted, topic);
        let near =
            |field: &String| nearest(field, fields.iter().map(String::as_str)).map(String::into_boxed_str);
        LogError::NoField {
            topic: name.clone(),
            type_name: type_name.as_str().into(),
            nearest: selector.field.as_ref().and_then(near),
            field: selector.field.as_deref().map(Box::from),
            present: match fields.as_slice() {
                [] if lacks_positions(extracted, topic) => {
                    "joints without positions, at most speeds".to_owned()
                }
                [] => "none".to_owned(),
                fields => fields.join(", "),
            },
        }
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
            if role != Role::Planned || joints.is_empty() {
                return Vec::new();
            }
            let rank = if topic.type_name.ends_with("JointTrajectory") { 3 } else { 6 };
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
            if has_word(&topic.topic, &["error"]) { ONLY_IF_NAMED } else { 2 }
        }
        _ => ONLY_IF_NAMED,
    }
}
