//! Reads all joint topics of a recording, in parallel over its blocks, in the order of the file.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use super::{
    candidates::is_measured,
    content::{Content, Extracted, Route, Source, TopicCount},
    description,
    parallel::read_blocks,
    recording::{Attachment, FileInfo},
    window::{Window, may_be_of_run},
};
use crate::{
    log::{
        channel::{Channel, Definitions},
        csv::{DOUBT_OF_ORIGIN, ORIGIN, joint_in},
        file::Held,
        files::{ScannedFile, ScannedLog, count},
        options::{ReadOptions, Selector},
        source::{Role, Rows, Spec, Table, Versioned},
    },
    remark::{Code, Remarks},
};

/// More than any of ours, bytes; of one that is larger only the name is read.
const LARGEST_ATTACHMENT: u64 = 64 << 20;

/// Decodes all that may be wanted, in one pass.
pub(super) fn extract(log: &ScannedLog<'_>, options: &ReadOptions) -> Extracted {
    count(|passes| passes.decoded += log.files.len() as u64);
    let path = log.files.first().map(|file| file.path.to_owned()).unwrap_or_default();
    let described = log.described;
    let mut out = Extracted { path, described, remarks: log.remarks.clone(), ..Extracted::default() };
    let files = log.in_order();
    for file in &files {
        describe(file, &mut out);
    }
    let selectors = selectors(options);
    let before = out.remarks.clone();
    let unknown = read_files(&files, &selectors, options, false, &mut out);
    if unknown > 0 && files.iter().any(|file| file.layout.channels_complete) {
        // A summary that leaves out channels is no summary: look for them in the chunks.
        out = Extracted {
            path: out.path,
            described,
            files: out.files,
            attachments: out.attachments,
            metadata: out.metadata,
            tables: out.tables,
            remarks: before,
            ..Extracted::default()
        };
        read_files(&files, &selectors, options, true, &mut out);
    }
    finish(&mut out, &selectors);
    out
}

/// The fields that the caller named, and the signals that are wanted.
fn selectors(options: &ReadOptions) -> Vec<(Role, Selector)> {
    let of = |role, list: &[Selector]| list.iter().map(move |s| (role, s.clone())).collect::<Vec<_>>();
    let signals = options.signals.iter().map(|wanted| (Role::Beside, wanted.selector()));
    [of(Role::Planned, &options.planned), of(Role::Measured, &options.measured), signals.collect()].concat()
}

/// Reads all blocks; returns how many messages are of no known channel.
fn read_files(
    files: &[&ScannedFile<'_>],
    selectors: &[(Role, Selector)],
    options: &ReadOptions,
    look_inside: bool,
    out: &mut Extracted,
) -> u64 {
    let mut known = Known::default();
    let mut by_file = Vec::new();
    let speeds = |topic: &str| options.measured_velocities || !is_measured(topic);
    for file in files {
        let alone = |topic: &str| alone(topic, options);
        let channels =
            Definitions::gather(&file.layout, file.source, look_inside).plan(selectors, &speeds, &alone);
        by_file.push(Arc::new(routes(channels, &options.joints, &mut known, out)));
    }
    let chunks = || {
        files.iter().zip(&by_file).enumerate().flat_map(|(index, (file, routes))| {
            let held = move |number: usize| file.layout.held.as_ref().map_or(&[][..], |held| &held[number]);
            (0..file.layout.blocks.len()).map(move |number| ((index, number), held(number), routes))
        })
    };
    let named: Vec<&str> =
        options.planned.iter().chain(&options.measured).map(|selector| selector.topic.as_str()).collect();
    let named = (!options.planned.is_empty() && !options.measured.is_empty()).then_some(named.as_slice());
    let of_run = |route: &Route| may_be_of_run(out, named, route);
    let all = chunks().map(|(place, held, routes)| (place, held, &**routes));
    let window =
        Window::of(options.range.widened(options.measured_delay_ns.unwrap_or(0)), all, &known.specs, &of_run);
    let mut work = Vec::new();
    let mut rows = vec![0_usize; known.specs.len()];
    for (place, held, routes) in chunks() {
        let wants = |one: &Held, route: &Route| {
            (route.read.is_some() || route.describes)
                && window.as_ref().is_none_or(|window| window.takes(place, one, route, &known.specs))
        };
        if !counted(held, routes, &wants, out) {
            let file = files[place.0];
            work.push((file.layout.blocks[place.1], file.source, routes.clone(), place.0));
            for one in held {
                let read = routes.get(&one.channel).and_then(|route| route.read.as_ref());
                let Some((source, _)) = read else { continue };
                rows[*source] = rows[*source].saturating_add(usize::try_from(one.messages).unwrap_or(0));
            }
        }
    }
    for (source, rows) in out.sources.iter_mut().zip(rows) {
        source.content.expect(rows);
    }
    count(|passes| passes.blocks += work.len() as u64);
    read_blocks(&work, &known.specs, &options.joints, out)
}

/// Counts the messages of a chunk by its index, if nothing in it is to be read; whether that was so.
fn counted(
    held: &[Held],
    routes: &BTreeMap<u16, Route>,
    wants: &impl Fn(&Held, &Route) -> bool,
    out: &mut Extracted,
) -> bool {
    let is_passed = |held: &Held| routes.get(&held.channel).is_some_and(|route| !wants(held, route));
    if held.is_empty() || !held.iter().all(is_passed) {
        return false;
    }
    for one in held {
        let Some(route) = routes.get(&one.channel) else { continue };
        let [first_log_ns, last_log_ns] = one.log_ns;
        let unread = if route.unreadable { one.messages } else { 0 };
        let messages = one.messages;
        out.topics[route.topic].add(&TopicCount {
            messages,
            first_log_ns,
            last_log_ns,
            unread,
            ..TopicCount::default()
        });
    }
    true
}

/// The joint of a topic that is one of several of a side: the one named in the same place, else as the topic is called.
fn alone(topic: &str, options: &ReadOptions) -> Option<String> {
    let place = [&options.planned, &options.measured].into_iter().find_map(|side| {
        let place = side.iter().position(|selector| selector.topic == topic)?;
        Some((place, side.len()))
    });
    let (place, count) = place?;
    match options.joints.as_slice() {
        [] => Some(joint_in(topic)),
        joints if joints.len() == count => Some(joints[place].clone()),
        _ => None,
    }
}

fn describe(file: &ScannedFile<'_>, out: &mut Extracted) {
    let ScannedFile { path, source, layout } = file;
    // Of a packed file or a table, what was read is another than the file.
    let of_file = std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file);
    let bytes = of_file.map_or_else(|| source.length(), |file| file.len());
    file.remark_damage(&mut out.remarks);
    ::log::info!("opened {}: {bytes} bytes in {} blocks", path.display(), layout.blocks.len());
    out.files.push(FileInfo {
        name: file.name(),
        bytes,
        blocks: layout.blocks.len(),
        closed: !layout.damage.not_closed,
    });
    for attachment in &layout.attachments {
        let (name, media_type, mut data) =
            (attachment.name.clone(), attachment.media_type.clone(), Vec::new());
        if attachment.data.length() > LARGEST_ATTACHMENT {
            out.attachments.push(Attachment { name, media_type, data });
            continue;
        }
        match source.read(attachment.data, &mut data) {
            Ok(()) => out.attachments.push(Attachment { name, media_type, data }),
            Err(error) => {
                let message = format!("attachments that cannot be read, dropped: {error}");
                out.remarks.add(Code::DamagedBytes, 1, message);
            }
        }
    }
    for one in &layout.metadata {
        if one.name == ORIGIN && !out.tables.contains(&one.entries) {
            doubts(&one.entries, &mut out.remarks);
            out.tables.push(one.entries.clone());
        }
        out.metadata.entry(one.name.clone()).or_default().extend(one.entries.clone());
    }
}

/// What was guessed when a table was imported holds until it is settled.
fn doubts(origin: &BTreeMap<String, String>, remarks: &mut Remarks) {
    let file = origin.get("file").map_or("a table", String::as_str);
    for (_, doubt) in origin.iter().filter(|(key, _)| key.starts_with(DOUBT_OF_ORIGIN)) {
        // A table that is read as it is has said so.
        if remarks.as_slice().iter().all(|remark| remark.message != *doubt) {
            remarks.add(Code::Guessed, 1, format!("{doubt} (guessed when {file} was imported)"));
        }
    }
}

/// Topics by name and type, and the sources of each.
#[derive(Default)]
struct Known {
    topics: BTreeMap<(String, String), usize>,
    sources: BTreeMap<usize, Vec<usize>>,
    specs: Vec<Spec>,
}

/// Joins the channels of a file to the topics and sources of the recording.
fn routes(
    channels: BTreeMap<u16, Channel>,
    joints: &[String],
    known: &mut Known,
    out: &mut Extracted,
) -> BTreeMap<u16, Route> {
    let mut routes = BTreeMap::new();
    for (id, channel) in channels {
        let name = (channel.topic.clone(), channel.type_name.clone());
        let topic = *known.topics.entry(name).or_insert_with(|| {
            out.topics.push(TopicCount {
                topic: channel.topic,
                type_name: channel.type_name,
                encoding: channel.encoding,
                ..TopicCount::default()
            });
            out.topics.len() - 1
        });
        let unreadable = channel.problem.is_some();
        if out.topics[topic].problem.is_none() {
            out.topics[topic].problem = channel.problem;
        }
        let read = channel.reader.map(|(spec, decoder)| {
            let of_topic = known.sources.entry(topic).or_default();
            let same = of_topic.iter().copied().find(|&source| known.specs[source] == *spec);
            let source = same.unwrap_or_else(|| {
                out.sources.push(Source { topic, content: Content::new(&spec, joints), parts: Vec::new() });
                known.specs.push((*spec).clone());
                of_topic.push(known.specs.len() - 1);
                known.specs.len() - 1
            });
            (source, decoder)
        });
        let describes = description::is_topic(&out.topics[topic].topic);
        routes.insert(id, Route { topic, read, unreadable, describes });
    }
    routes
}

/// Turns counts into remarks, and versioned values into tables.
fn finish(out: &mut Extracted, selectors: &[(Role, Selector)]) {
    for topic in &out.topics {
        if let Some(problem) = &topic.problem {
            out.remarks.add(
                Code::UnreadableSchema,
                topic.unread.max(1),
                format!("messages of {} ({}) skipped: {problem}", topic.topic, topic.type_name),
            );
        }
        if let Some(error) = &topic.first_error {
            out.remarks.add(
                Code::UndecodableMessage,
                topic.undecodable,
                format!(
                    "messages of {} that do not fit their schema, skipped; the first: {error}",
                    topic.topic
                ),
            );
        }
    }
    let (halves, mut sources): (Vec<_>, Vec<_>) = std::mem::take(&mut out.sources)
        .into_iter()
        .partition(|s| matches!(s.content, Content::Versioned(_)));
    let stem =
        |source: &Source| out.topics[source.topic].topic.rsplit_once('/').map(|(stem, _)| stem.to_owned());
    let mut by_stem: BTreeMap<_, Vec<&Versioned>> = BTreeMap::new();
    for half in &halves {
        if let Content::Versioned(versioned) = &half.content
            && versioned.has_names()
        {
            by_stem.entry(stem(half)).or_default().push(versioned);
        }
    }
    let mut known = Vec::new();
    for half in &halves {
        let Content::Versioned(values) = &half.content else { continue };
        let Some(names) = by_stem.get(&stem(half)) else { continue };
        let topic = &out.topics[half.topic].topic;
        let of_topic = selectors.iter().filter(|(_, selector)| selector.topic == *topic);
        let asked: BTreeSet<&str> = of_topic.filter_map(|(_, selector)| selector.field.as_deref()).collect();
        if let Some((table, by_words)) = values.to_table(names, &asked) {
            let message =
                format!("values of {topic} are told plan or measurement by the words of their names");
            out.remarks.add(Code::Guessed, u64::from(by_words), message);
            let content = Content::Table(Box::new(table));
            sources.push(Source { topic: half.topic, content, parts: Vec::new() });
        }
        known
            .push((half.topic, names.iter().flat_map(|half| half.names()).cloned().collect::<BTreeSet<_>>()));
    }
    for (topic, names) in known {
        out.topics[topic].values = names.into_iter().collect();
    }
    out.sources = by_publisher(poses_as_tables(sources, out));
}

/// Tables of topics on which several publishers each send joints of their own become one for each.
fn by_publisher(sources: Vec<Source>) -> Vec<Source> {
    let apart = |mut source: Source| {
        let Content::Table(table) = &mut source.content else { return vec![source] };
        let tables = table.apart();
        if tables.is_empty() {
            return vec![source];
        }
        let of = |(table, rows): (Table, Rows)| Source {
            topic: source.topic,
            content: Content::Table(Box::new(table)),
            parts: source.parts.iter().map(|(file, row)| (*file, rows.before(*row))).collect(),
        };
        tables.into_iter().map(of).collect()
    };
    sources.into_iter().flat_map(apart).collect()
}

/// Turns poses into tables; what has none is left out.
fn poses_as_tables(sources: Vec<Source>, out: &mut Extracted) -> Vec<Source> {
    let tables = |source: Source| {
        let Content::Poses(poses) = &source.content else { return vec![source] };
        let topic = &out.topics[source.topic];
        let message = format!(
            "paths of {} whose poses have no times that increase, left out: a report compares by time",
            topic.topic
        );
        out.remarks.add(Code::UnusableStamp, poses.untimed, message);
        let tables = poses.to_tables(topic.type_name.ends_with("Path")).into_iter();
        let content = tables.map(|table| Content::Table(Box::new(table)));
        // Where the parts of several files meet is not kept.
        content.map(|content| Source { topic: source.topic, content, parts: Vec::new() }).collect()
    };
    sources.into_iter().flat_map(tables).collect()
}
