//! Messages of types that are not known, as a table: a row an instant, a column for each number. The words of the fields
//! then tell plan from measurement, as the headers of a table do.

mod leaves;
mod message;
mod rows;

use std::{collections::BTreeMap, path::Path};

use super::{
    channel::{Definitions, OwnedSchema},
    csv::{CsvError, CsvOptions, CsvRun, read_csv_bytes},
    decode::{LayoutCache, Program},
    error::LogError,
    file::{Blocks, ChannelRecord, MessageRecord, Opcode, records},
    files::{LogFiles, ScannedLog, file_name},
    schema::Definition,
    source::spec_for,
};
use leaves::Leaves;
use message::Message;
use rows::Rows;

/// Steps of one program: messages of joints take some hundred.
const MOST_STEPS: usize = 5_000;

/// Packages whose messages hold no joints that are not known already.
const OTHERS: [&str; 14] = [
    "sensor_msgs",
    "geometry_msgs",
    "nav_msgs",
    "tf2_msgs",
    "tf",
    "visualization_msgs",
    "diagnostic_msgs",
    "rosgraph_msgs",
    "rcl_interfaces",
    "action_msgs",
    "foxglove",
    "foxglove_msgs",
    "shape_msgs",
    "trajectory_msgs",
];

/// How the messages of a channel are read.
enum Reader {
    Program(Box<Program>, Leaves),
    Json,
}

/// The run that the messages of a log hold by the words of their fields; `None` if no field is one of a joint.
pub(super) fn run(
    log: &ScannedLog<'_>,
    name: &str,
    options: &CsvOptions,
) -> Option<Result<CsvRun, CsvError>> {
    let text = text(log)?;
    Some(read_csv_bytes(name, &text, options))
}

/// Reads the messages of a log or of a bag as a table, by the words of their fields and by what the options say.
///
/// # Errors
///
/// [`LogError`] if it is no log; [`CsvError`] within says what its fields lack and which option gives it.
pub fn read_messages(path: &Path, options: &CsvOptions) -> Result<CsvRun, LogError> {
    let files = LogFiles::open(&[path.to_owned()])?;
    let fault = |source| LogError::Table { path: path.to_owned(), source: Box::new(source) };
    run(&files.scan()?, &file_name(path), options)
        .unwrap_or_else(|| {
            Err(CsvError::NoJoints { present: "none whose words are those of a joint".to_owned() })
        })
        .map_err(fault)
}

/// The table.
fn text(log: &ScannedLog<'_>) -> Option<Vec<u8>> {
    let mut rows = Rows::default();
    for file in &log.files {
        let Definitions { schemas, channels } = Definitions::gather(&file.layout, file.source, false);
        let readers: BTreeMap<u16, (String, Reader)> = channels
            .into_iter()
            .filter_map(|(id, channel)| {
                let reader = reader(schemas.get(&channel.schema_id), &channel)?;
                Some((id, (channel.topic, reader)))
            })
            .collect();
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
                let read = match reader {
                    Reader::Program(program, leaves) => {
                        let cache = caches.entry(one.channel_id).or_default();
                        let read = program.run(one.data, cache, &mut message).is_ok();
                        read.then(|| message.cells(leaves))
                    }
                    Reader::Json => message::of_json(one.data),
                };
                let Some((stamp_ns, cells)) = read else { continue };
                let stamp_ns =
                    stamp_ns.filter(|ns| *ns > 0).unwrap_or_else(|| one.publish_time_ns.cast_signed());
                rows.add(stamp_ns, topic, cells)?;
            }
        }
    }
    rows.table()
}

fn reader(schema: Option<&OwnedSchema>, channel: &ChannelRecord) -> Option<Reader> {
    let name = schema.map_or("", |schema| schema.name.as_str());
    let plain = name.replace('.', "/");
    let other = plain.split('/').next().is_some_and(|package| OTHERS.contains(&package));
    if other || spec_for(name, None, (&[], false)).is_some() {
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
        _ => None,
    }
}
