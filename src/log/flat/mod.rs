//! Messages of types that are not known, as a table: a row an instant, a column for each number. The words of the fields
//! then tell plan from measurement, as the headers of a table do.

mod leaves;
mod message;
mod rows;

use std::{collections::BTreeMap, path::Path, sync::Arc};

use super::{
    channel::{Definitions, OwnedSchema},
    csv::{CsvError, CsvOptions, CsvRun, read_csv_bytes},
    decode::{LayoutCache, Program, Whole},
    error::LogError,
    file::{Blocks, ChannelRecord, MessageRecord, Opcode, records},
    files::{LogFiles, ScannedLog, file_name},
    import_line::Given,
    schema::{Definition, plain_name},
    source::spec_for,
};
use crate::remark::Code;
use leaves::Leaves;
use message::Message;
pub(in crate::log) use rows::LONE;
use rows::Rows;

/// Steps of one program: messages of joints take some hundred.
const MOST_STEPS: usize = 5_000;

/// More schemas and topics than any machine has are not looked at.
const MOST_SCHEMAS: usize = 300;
const MOST_TOPICS: usize = 3_000;

/// Packages whose messages hold no joints that are not known already.
const OTHERS: [&str; 14] = [
    "sensor_msgs", "geometry_msgs", "nav_msgs", "tf2_msgs", "tf", "visualization_msgs", "diagnostic_msgs",
    "rosgraph_msgs", "rcl_interfaces", "action_msgs", "foxglove", "foxglove_msgs", "shape_msgs",
    "trajectory_msgs",
];

/// Types that are known, and that a message of another type may go with.
const KNOWN: [&str; 2] = ["sensor_msgs/JointState", "std_msgs/Float64MultiArray"];

/// How the messages of a channel are read.
enum Reader {
    Program(Box<Program>, Leaves),
    Json,
    Protobuf(Whole),
}

/// The run that the messages of a log hold by the words of their fields; `None` if no field is one of a joint.
///
/// With `lone` a measurement alone, which goes with a plan that is known: words for the side are enough.
pub(super) fn run(
    log: &ScannedLog<'_>,
    name: &str,
    options: &CsvOptions,
    lone: bool,
) -> Option<Result<CsvRun, CsvError>> {
    let stamped = rows(log, lone, true)?;
    // By the stamps of the messages if all topics have such that move; else by when they were published.
    let rows = if stamped.run() { stamped } else { rows(log, lone, false)? };
    let not_finite = rows.not_finite;
    let run = read_csv_bytes(name, &rows.table()?, options);
    Some(run.map(|mut run| {
        let message = "values of joints in messages that are NaN or infinite, dropped";
        run.remarks.add(Code::NotFinite, not_finite, message);
        run
    }))
}

/// Reads the messages of a log or of a bag as a table, by the words of their fields and by what the options say.
///
/// # Errors
///
/// [`LogError`] if it is no log; [`CsvError`] within says what its fields lack and which option gives it.
pub fn read_messages(path: &Path, options: &CsvOptions) -> Result<CsvRun, LogError> {
    let files = LogFiles::open(&[path.to_owned()])?;
    let fault =
        |source| LogError::Table { path: path.to_owned(), source: Box::new(source), given: Given::default() };
    run(&files.scan()?, &file_name(path), options, false)
        .unwrap_or_else(|| {
            let present = "none whose words are those of a joint".to_owned();
            Err(CsvError::NoJoints { why: String::new(), present })
        })
        .map_err(fault)
}

/// Whether all messages that could be read by words are of a type whose angles are radians by its definition.
pub(super) fn in_radians(log: &ScannedLog<'_>) -> bool {
    log.files.iter().all(|file| {
        let Definitions { schemas, channels } = Definitions::gather(&file.layout, file.source, false);
        let name = |id: u16| schemas.get(&id).map_or("", |schema| schema.name.as_str());
        let joints = |id: u16| plain_name(&name(id).replace('.', "/")) == KNOWN[0];
        let read =
            |channel: &ChannelRecord| reader(schemas.get(&channel.schema_id), channel, false).is_some();
        channels.values().filter(|channel| !joints(channel.schema_id)).all(|channel| !read(channel))
    })
}

fn rows(log: &ScannedLog<'_>, lone: bool, stamped: bool) -> Option<Rows> {
    let mut rows = Rows::default();
    rows.lone = lone;
    for file in &log.files {
        let Definitions { schemas, channels } = Definitions::gather(&file.layout, file.source, false);
        let readers = readers(&schemas, channels, lone);
        if readers.is_empty() {
            continue;
        }
        let mut caches: BTreeMap<u16, LayoutCache> = BTreeMap::new();
        let mut blocks = Blocks::new();
        for (number, &block) in file.layout.blocks.iter().enumerate() {
            let held =
                file.layout.held.as_ref().and_then(|held| held.get(number)).filter(|held| !held.is_empty());
            if held.is_some_and(|held| held.iter().all(|one| !readers.contains_key(&one.channel))) {
                continue;
            }
            for record in records(blocks.open(block, file.source).0) {
                if record.opcode != Opcode::MESSAGE {
                    continue;
                }
                let Some(one) = MessageRecord::parse(record.body) else { continue };
                let Some((topic, reader)) = readers.get(&one.channel_id) else { continue };
                let mut message = Message::default();
                let read = match &**reader {
                    Reader::Program(program, leaves) => {
                        let cache = caches.entry(one.channel_id).or_default();
                        let read = program.run(one.data, cache, &mut message).is_ok();
                        read.then(|| message.cells(leaves))
                    }
                    Reader::Json => {
                        serde_json::from_slice(one.data).ok().map(|value| message::of_value(&value))
                    }
                    Reader::Protobuf(whole) => whole.value(one.data).map(|value| message::of_value(&value)),
                };
                let Some((stamp_ns, cells)) = read else { continue };
                let stamp_ns = stamp_ns.filter(|ns| *ns > 0 && stamped);
                rows.add(stamp_ns, one.publish_time_ns.cast_signed(), topic, cells)?;
            }
        }
    }
    Some(rows)
}

/// Topics that are read, by channel; those of one schema share how.
fn readers(
    schemas: &BTreeMap<u16, OwnedSchema>,
    channels: BTreeMap<u16, ChannelRecord>,
    lone: bool,
) -> BTreeMap<u16, (String, Arc<Reader>)> {
    let mut known: BTreeMap<(u16, String), Option<Arc<Reader>>> = BTreeMap::new();
    let mut found = BTreeMap::new();
    for (id, channel) in channels {
        let key = (channel.schema_id, channel.encoding.clone());
        if known.len() >= MOST_SCHEMAS && !known.contains_key(&key) || found.len() >= MOST_TOPICS {
            continue;
        }
        let new = || reader(schemas.get(&channel.schema_id), &channel, lone).map(Arc::new);
        if let Some(reader) = known.entry(key).or_insert_with(new) {
            found.insert(id, (channel.topic, reader.clone()));
        }
    }
    found
}

fn reader(schema: Option<&OwnedSchema>, channel: &ChannelRecord, lone: bool) -> Option<Reader> {
    let name = schema.map_or("", |schema| schema.name.as_str());
    let plain = name.replace('.', "/");
    let other = plain.split('/').next().is_some_and(|package| OTHERS.contains(&package));
    // Of types that are known those whose topics may say something in words.
    let known = spec_for(name, None, (&[], false)).is_some() || other;
    if known && (lone || !KNOWN.contains(&plain_name(&plain).as_str())) {
        return None;
    }
    match channel.encoding.as_str() {
        "json" => Some(Reader::Json),
        "cdr" | "ros1" => {
            let schema = schema?;
            let definition = Definition::parse(&schema.name, &schema.encoding, &schema.data).ok()?;
            let leaves = Leaves::of(&definition)?;
            let program = Program::compile(&definition, &leaves.wants(), MOST_STEPS).ok()?;
            Some(Reader::Program(Box::new(program), leaves))
        }
        "protobuf" => Whole::of(name, &schema?.data).map(Reader::Protobuf),
        _ => None,
    }
}
