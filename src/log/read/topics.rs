//! Lists the topics of a log.

use std::{collections::BTreeSet, path::Path};

use super::{
    content::{Content, Extracted, Source, TopicCount},
    origin::Imported,
    recording::TopicInfo,
};
use crate::{
    log::{
        channel::unread,
        error::LogError,
        import_line::Given,
        options::{ReadOptions, Selector},
        source::{Form, Table},
    },
    suggest::nearest,
    text::shell_argument,
    units::NS_PER_S,
};

/// Topics with joints, or such as may hold some and cannot be read, for messages; all topics if there is none.
pub(super) fn present(extracted: &Extracted) -> String {
    let mut listed: BTreeSet<usize> = extracted.sources.iter().map(|s| s.topic).collect();
    listed.extend((0..extracted.topics.len()).filter(|topic| unreadable(extracted, *topic).is_some()));
    let describe = |index: usize| {
        let topic = &extracted.topics[index];
        let messages = if topic.messages == 1 { "message" } else { "messages" };
        let known = if topic.type_name.is_empty() { "no type" } else { &topic.type_name };
        let lacks = lacking(extracted, index).map(|lacks| format!("of {lacks}"));
        let lacks =
            lacks.or_else(|| unreadable(extracted, index)).map_or(String::new(), |why| format!(", {why}"));
        format!("{} ({known}, {} {messages}{lacks})", topic.topic, topic.messages)
    };
    let listed: Vec<String> = if listed.is_empty() {
        (0..extracted.topics.len()).map(describe).collect()
    } else {
        listed.into_iter().map(describe).collect()
    };
    if listed.is_empty() { "no topics at all".to_owned() } else { listed.join(", ") }
}

/// Why the messages of a topic cannot be read that may hold joints.
pub(super) fn unreadable(extracted: &Extracted, topic: usize) -> Option<String> {
    let topic = &extracted.topics[topic];
    let of_no_type = || unread(&topic.encoding).filter(|_| topic.type_name.is_empty());
    topic.problem.clone().or_else(of_no_type)
}

/// What the messages of a topic have that name joints and never tell where they are; `None` if they do.
pub(super) fn lacking(extracted: &Extracted, topic: usize) -> Option<&'static str> {
    let lacks = |table: &Table| {
        let positions = table.fields.iter().enumerate().filter(|(_, field)| !field.is_velocity);
        let columns = positions.flat_map(|(k, _)| &table.columns[k]);
        !table.joints.is_empty() && !columns.flatten().any(|value| value.is_finite())
    };
    let sources = extracted.sources.iter().filter(|source| source.topic == topic);
    let mut found = sources.filter_map(|source| match &source.content {
        Content::Table(table) => Some(lacks(table).then_some("joints without positions, at most speeds")),
        Content::Plans(plans) => Some(plans.fault()),
        _ => None,
    });
    let first = found.next()?;
    first.filter(|_| found.all(|lacks| lacks.is_some()))
}

/// How a topic of one number a message is named, as a controller of each joint has it.
pub(super) fn of_one_number(topic: &TopicCount) -> Option<String> {
    const NUMBERS: [&str; 2] = ["Float64", "Float32"];
    let kind = topic.type_name.strip_prefix("std_msgs/")?;
    let kind = kind.strip_prefix("msg/").unwrap_or(kind);
    NUMBERS.contains(&kind).then(|| {
        format!(
            "as {0}:data, one of each joint for each side, and --joints JOINT,... in that order",
            topic.topic
        )
    })
}

/// Fields of a topic that hold numbers by joint.
pub(super) fn fields_of(extracted: &Extracted, topic: usize) -> Vec<String> {
    let sources = extracted.sources.iter().filter(|source| source.topic == topic);
    topic_info(extracted, topic, sources).joint_fields
}

/// The topics for `info`, by name.
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
    let spread_s = count.last_log_ns.saturating_sub(count.first_log_ns) as f64 / NS_PER_S;
    if count.messages > 1 && spread_s > 0.0 {
        info.rate_hz = (count.messages - 1) as f64 / spread_s;
    }
    for source in sources {
        match &source.content {
            Content::Table(table) => {
                info.joints.extend(table.joints.iter().cloned());
                for (k, field) in table.fields.iter().enumerate() {
                    let filled = || (0..table.joints.len()).any(|j| !table.column(k, j).is_empty());
                    // That a frame is there is known of those that nobody named, too.
                    let told = info.joint_fields.contains(&field.path);
                    if !field.is_velocity && !told && (table.form == Form::Poses || filled()) {
                        info.joint_fields.push(field.path.clone());
                    }
                }
            }
            Content::Plans(plans) => {
                let joints: BTreeSet<&String> = plans.trajectories.iter().flat_map(|t| &t.joints).collect();
                info.joints.extend(joints.into_iter().cloned());
                if plans.fault().is_none() {
                    info.joint_fields.push("points.positions".to_owned());
                }
            }
            Content::Versioned(_) | Content::Poses(_) => {}
        }
    }
    info
}

/// What makes one log of two.
fn in_another(log: &Path) -> String {
    format!("`hydrotrace join {} OTHER -o whole.mcap` makes one log of both", shell_argument(log))
}

/// What a log lacks, and how to say where it is: of a table by its columns, which is for `import`.
pub(super) fn missing(
    extracted: &Extracted,
    options: &ReadOptions,
    missing: &'static str,
    flag: &str,
) -> LogError {
    let (present, fix) = match Imported::of(&extracted.tables) {
        Some(table) if flag.contains(' ') => {
            (table.columns(), format!("{flag} JOINT=COLUMN,... of `hydrotrace import`"))
        }
        Some(table) => {
            let line = table.import_line(&extracted.path, Some(flag), &Given::of(options));
            let own = format!(
                "; or, if they are in a file of their own with the same zero of time, {}",
                in_another(&table.place(&extracted.path))
            );
            (table.columns(), line + &own)
        }
        // Plan and measurement may be in a table each.
        None if extracted.tables.len() > 1 && !flag.contains(' ') => {
            let tables: Vec<Imported<'_>> = extracted.tables.iter().filter_map(Imported::one).collect();
            let line = |table: &Imported<'_>| {
                format!("`{}`", table.import_line(&extracted.path, Some(flag), &Given::default()))
            };
            let lines = tables.iter().map(line).collect::<Vec<_>>().join(" or ");
            let both = match tables.as_slice() {
                [one, other] if missing == "planned" => format!(
                    "; or, if all of one of them is the plan, `hydrotrace join {} --plan {} --at 0 -o run.mcap`, or the other way \
                     round",
                    shell_argument(one.place(&extracted.path)),
                    shell_argument(other.place(&extracted.path))
                ),
                _ => String::new(),
            };
            let fix = format!(
                "{lines}, whichever of the tables has them, and give its log with the other table{both}"
            );
            (tables.iter().map(Imported::columns).collect::<Vec<_>>().join("; "), fix)
        }
        None if flag.contains(' ') => (present(extracted), format!("{flag} TOPIC[:FIELD]")),
        None => {
            let own = format!("; or, if they are in a log of their own, {}", in_another(&extracted.path));
            let number = extracted.topics.iter().find_map(of_one_number);
            let topic = number.map_or_else(|| "TOPIC[:FIELD]".to_owned(), |how| format!("TOPIC:data, {how}"));
            (present(extracted), format!("{flag} {topic}{own}"))
        }
    };
    LogError::Missing { missing, present, fix }
}

/// Of columns of the table that the log is made of, named as if they were topics; `None` if there are none.
pub(super) fn columns_named(extracted: &Extracted, options: &ReadOptions) -> Option<LogError> {
    let table = Imported::of(&extracted.tables)?;
    let is_topic = |one: &Selector| extracted.topics.iter().any(|topic| topic.topic == one.topic);
    let named = options.planned.iter().chain(&options.measured);
    let columns: Vec<String> = named
        .filter(|one| (one.topic.contains('=') || table.has(&one.to_string())) && !is_topic(one))
        .map(ToString::to_string)
        .collect();
    let fix = || table.import_line(&extracted.path, None, &Given::of(options));
    (!columns.is_empty()).then(|| LogError::ColumnsNamed { fix: fix(), columns: columns.join(", ") })
}

/// Of a topic that is not in the log.
pub(super) fn not_there(extracted: &Extracted, selector: &Selector) -> LogError {
    let topic = selector.topic.clone();
    LogError::NoTopic {
        nearest: nearest(&topic, extracted.topics.iter().map(|t| t.topic.as_str())),
        present: present(extracted),
        topic,
    }
}
