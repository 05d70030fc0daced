//! Finds the plan and the measurement among the topics of a log, and says why.

use std::collections::BTreeSet;

use super::{
    candidates::{COMMAND, Candidate, candidates, of_sides},
    content::{Content, Extracted},
    frames,
    topics::{columns_named, missing},
};
use crate::{
    log::{
        error::LogError,
        options::{ReadOptions, Sides},
        source::{Form, Role},
    },
    remark::Code,
};

/// The chosen topics and fields.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Choice {
    pub(super) planned: Vec<Candidate>,
    pub(super) measured: Vec<Candidate>,
    pub(super) why: String,
    /// Topics of another namespace that measure the same joints as well, and were not chosen.
    pub(super) rivals: Vec<String>,
    pub(super) doubts: Vec<(Code, String)>,
}

impl Choice {
    /// Whether poses of a tool are among it.
    pub(super) fn of_poses(&self, extracted: &Extracted) -> bool {
        let all = self.planned.iter().chain(&self.measured);
        let mut tables = all.map(|c| &extracted.sources[c.source].content);
        tables.any(|content| matches!(content, Content::Table(table) if table.form == Form::Poses))
    }

    /// Whether plan and measurement come from the same files, in which nobody put the plan beside the measurement later.
    pub(super) fn of_one_recorder(&self, extracted: &Extracted) -> bool {
        let files = |side: &[Candidate]| -> BTreeSet<usize> {
            side.iter()
                .flat_map(|one| extracted.sources[one.source].parts.iter().map(|part| part.0))
                .collect()
        };
        let planned = files(&self.planned);
        let same = extracted.files.len() == 1 || !planned.is_empty() && planned == files(&self.measured);
        same && extracted.sent().is_none()
    }

    /// Topics of commands that serve as the plan because the log has no other.
    pub(super) fn commanded(&self) -> impl Iterator<Item = &str> {
        let sent = |c: &&Candidate| c.rank == COMMAND;
        self.planned.iter().filter(sent).map(|c| c.topic.as_str())
    }
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

/// Names as their messages have them: the caller may give these to a topic that has none.
fn names_of(all: &[Candidate]) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for name in all.iter().flat_map(|candidate| &candidate.joints) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    names
}

/// Whether the joints of both sides are counted, those of one from one more than those of the other: by their names each would be paired
/// with its neighbour.
fn numbered_apart(planned: &[&str], measured: &[&str]) -> bool {
    let counted = |names: &[&str]| {
        let part = |name: &&str| {
            let prefix = name.trim_end_matches(|c: char| c.is_ascii_digit());
            Some((prefix.to_owned(), name[prefix.len()..].parse::<u32>().ok()?))
        };
        let mut parts = names.iter().map(part).collect::<Option<Vec<_>>>()?;
        parts.sort_unstable();
        let follows =
            |two: &[(String, u32)]| two[0].0 == two[1].0 && two[1].1.checked_sub(1) == Some(two[0].1);
        (parts.len() > 1 && parts.windows(2).all(follows)).then_some(parts)
    };
    let Some((plan, came)) = counted(planned).zip(counted(measured)) else { return false };
    plan.len() == came.len() && plan[0].0 == came[0].0 && plan[0].1.abs_diff(came[0].1) == 1
}

const PLANNED: &str = "planned";
pub(super) const MEASURED: &str = "measured";

fn choose_both(extracted: &Extracted, options: &ReadOptions) -> Result<Choice, LogError> {
    let ([planned, measured], guess) = of_sides(extracted, options)?;
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
        let [planned, measured] = [names_of(&planned), names_of(&measured)];
        // Which number is which of several joints nobody says.
        let given = match [&planned[..], &measured[..]] {
            [["joint_1"], [name]] | [[name], ["joint_1"]] => (*name).to_owned(),
            _ => "JOINT,JOINT,...".to_owned(),
        };
        let [planned, measured] = [planned, measured].map(|names| names.join(", "));
        return Err(LogError::NoCommonJoint { planned, measured, given });
    };
    let is_told = !options.joints.is_empty() || !options.planned.is_empty() && !options.measured.is_empty();
    let [plan, came] = [names_of(std::slice::from_ref(first)), names_of(&measured)];
    if !is_told && numbered_apart(&plan, &came) {
        let [planned, measured] = [plan, came].map(|names| names.join(", "));
        let common = measured.split(", ").filter(|name| planned.split(", ").any(|plan| plan == *name));
        let common = common.collect::<Vec<_>>().join(",");
        return Err(LogError::NumberedApart { planned, measured, common });
    }
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
    let both_named = !options.planned.is_empty() && !options.measured.is_empty();
    let [plan, came] = [&planned, &measured].map(|side| side.iter().map(source));
    let frames_apart = frames::check_sides(extracted, plan, came, both_named)?;
    let why = why(extracted, options, &planned, &measured);
    let rivals = rivals(&all_measured, &measured, &wanted);
    let guess = guess.map(|guess| (Code::Guessed, guess));
    let doubts = frames_apart.map(|apart| (Code::UnlikePlan, apart)).into_iter().chain(guess).collect();
    Ok(Choice { planned, measured, why, rivals, doubts })
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
    Ok(Choice { planned, measured, why, rivals: Vec::new(), doubts: Vec::new() })
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
    // Of another controller's joints another one says nothing.
    let both = |m: &Candidate, c: &Candidate| {
        c.joints.iter().any(|joint| wanted.contains(joint) && m.joints.contains(joint))
    };
    let rival = |c: &&Candidate| {
        chosen.iter().all(|m| m.source != c.source)
            && chosen.iter().any(|m| m.rank == c.rank && !same_home(m, c) && both(m, c))
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
    let list = |all: &[Candidate]| {
        let first = |(place, c): (usize, &Candidate)| {
            (!all[..place].iter().any(|before| topic(before) == topic(c))).then_some(topic(c))
        };
        all.iter().enumerate().filter_map(first).collect::<Vec<_>>().join(", ")
    };
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
        (true, Some(_)) if planned.iter().all(|c| c.field.is_none()) => {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_topic_is_the_rival_of_one_of_another_home_with_its_joints() {
        let of = |source: usize, topic: &str, joint: &str| Candidate {
            source,
            field: Some(0),
            rank: 3,
            joints: vec![joint.to_owned()],
            messages: 9,
            topic: topic.to_owned(),
        };
        let chosen = [of(0, "/arm/controller_state", "a"), of(1, "/grip/controller_state", "g")];
        let others = [of(2, "/arm/state", "a"), of(3, "/other/state", "g"), of(4, "/other/of_none", "h")];
        let joints: Vec<String> = vec!["a".to_owned(), "g".to_owned(), "h".to_owned()];
        let found = rivals(&[chosen.as_slice(), &others].concat(), &chosen, &joints.iter().collect());
        assert_eq!(found, ["/other/state"]);
    }
}
