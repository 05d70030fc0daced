//! ROS 2 bags in SQLite, the storage of rosbag2 until Iron: `topics`, `messages` and, later, `message_definitions`.

use std::{
    collections::BTreeMap,
    fmt::Write as _,
    fs, io,
    io::BufWriter,
    path::{Path, PathBuf},
};

use mcap::{WriteOptions, Writer, records::MessageHeader};
use rusqlite::{Connection, OpenFlags, Row};

use super::undescribed;
use crate::{
    atomic_file::Temporary,
    input_file,
    log::{error::LogError, file::Source, unread::with_path},
    remark::{Code, Remarks},
};

/// What to do with a database that is no bag.
const SQL: &str = "`sqlite3 FILE .tables` names its tables, and `sqlite3 -csv -header FILE 'SELECT * FROM TABLE' > STEM.csv` makes \
     CSV of one";

/// Definition of a type: its encoding and text.
type Definitions = BTreeMap<String, (String, String)>;

/// The bag as a log, in a temporary file; what comes before a damaged page where the database has one.
pub(super) fn log(path: &Path, source: &Source, remarks: &mut Remarks) -> Result<Source, LogError> {
    let bag = |reason: String| LogError::Form { path: path.to_owned(), reason: with_path(&reason, path) };
    let place = Place::of(path, source).map_err(LogError::file("copy", path))?;
    let database = place.open().map_err(|error| bag(error.to_string()))?;
    let definitions = definitions(&database);
    let (_temporary, file) = Temporary::new().map_err(LogError::file("copy", path))?;
    let again = file.try_clone().map_err(LogError::file("copy", path))?;
    let mut copy = Copy::new(file).map_err(|error| bag(error.to_string()))?;
    copy.topics(&database, &definitions).map_err(bag)?;
    if let Err(fault) = copy.messages(&database) {
        if copy.messages == 0 {
            return Err(bag(fault));
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let count = copy.messages;
        remarks.add(Code::DamagedBytes, 1, format!("{name} is damaged after {count} messages: {fault}"));
    }
    copy.writer.finish().map_err(|error| bag(error.to_string()))?;
    drop(copy);
    Source::of(again).map_err(LogError::file("read", path))
}

/// Where the database is opened: as it lies, read only and without a lock, or, where it was unpacked or what a
/// killed recorder left beside it belongs to it, a copy, so that nothing beside the input changes.
enum Place {
    There(PathBuf),
    Copied { file: Temporary, _beside: Option<Beside> },
}

/// The journal of a copy; gone with it.
struct Beside(PathBuf);

impl Drop for Beside {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

fn with_ending(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    name.into()
}

impl Place {
    fn of(path: &Path, source: &Source) -> io::Result<Self> {
        let journal = with_ending(path, "-wal");
        let journal = fs::metadata(&journal).is_ok_and(|found| found.len() > 0).then_some(journal);
        if journal.is_none() && source.lies_at(path) {
            return Ok(Self::There(path.to_owned()));
        }
        let (file, mut into) = Temporary::new()?;
        source.copy(&mut into)?;
        let beside = journal.map(|journal| {
            let beside = Beside(with_ending(file.path(), "-wal"));
            io::copy(&mut input_file::open(&journal)?, &mut fs::File::create(&beside.0)?).map(|_| beside)
        });
        Ok(Self::Copied { file, _beside: beside.transpose()? })
    }

    fn open(&self) -> rusqlite::Result<Connection> {
        let flags = OpenFlags::SQLITE_OPEN_NO_MUTEX | OpenFlags::SQLITE_OPEN_URI;
        match self {
            Self::There(path) => {
                let mut uri = "file:".to_owned();
                for byte in path.to_string_lossy().bytes() {
                    match byte {
                        b'/' | b'.' | b'-' | b'_' => uri.push(byte.into()),
                        byte if byte.is_ascii_alphanumeric() => uri.push(byte.into()),
                        // Writing to memory does not fail.
                        byte => drop(write!(uri, "%{byte:02X}")),
                    }
                }
                uri.push_str("?immutable=1");
                Connection::open_with_flags(uri, flags | OpenFlags::SQLITE_OPEN_READ_ONLY)
            }
            Self::Copied { file, .. } => {
                Connection::open_with_flags(file.path(), flags | OpenFlags::SQLITE_OPEN_READ_WRITE)
            }
        }
    }
}

/// The definitions that bags carry since Iron; none before.
fn definitions(database: &Connection) -> Definitions {
    let text = "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions";
    let Ok(mut statement) = database.prepare(text) else { return Definitions::new() };
    let one = |row: &Row<'_>| Ok((row.get(0)?, (row.get(1)?, row.get(2)?)));
    let Ok(rows) = statement.query_map([], one) else { return Definitions::new() };
    rows.filter_map(Result::ok).collect()
}

struct Copy<W: io::Write + io::Seek> {
    writer: Writer<W>,
    /// Topic of the bag to channel of the log, and how many messages it has.
    channels: BTreeMap<i64, (u16, u32)>,
    messages: u64,
}

impl Copy<BufWriter<fs::File>> {
    fn new(file: fs::File) -> Result<Self, mcap::McapError> {
        let options = WriteOptions::new().profile("ros2").compression(None).calculate_chunk_crcs(false);
        let writer = options.create(BufWriter::new(file))?;
        Ok(Self { writer, channels: BTreeMap::new(), messages: 0 })
    }

    fn topics(&mut self, database: &Connection, definitions: &Definitions) -> Result<(), String> {
        let fault = |error: rusqlite::Error| match error.sqlite_error_code() {
            Some(rusqlite::ErrorCode::DatabaseCorrupt | rusqlite::ErrorCode::NotADatabase) => {
                format!("{error}; `sqlite3 BROKEN.db3 .recover | sqlite3 WHOLE.db3` saves what can be read")
            }
            _ => format!("it is no bag of ROS 2: {error}; {SQL}"),
        };
        let text = "SELECT id, name, type, serialization_format FROM topics";
        let mut statement = database.prepare(text).map_err(fault)?;
        let one = |row: &Row<'_>| {
            Ok((
                row.get::<_, i64>(0)?,
                row.get::<_, String>(1)?,
                row.get::<_, String>(2)?,
                row.get::<_, String>(3)?,
            ))
        };
        for row in statement.query_map([], one).map_err(fault)? {
            let (id, topic, type_name, encoding) = row.map_err(fault)?;
            let (form, text) = match definitions.get(&type_name) {
                Some((form, text)) => (form.clone(), text.clone()),
                None => ("ros2msg".to_owned(), undescribed(database, id, &type_name)),
            };
            let mut channel = || {
                let schema = self.writer.add_schema(&type_name, &form, text.as_bytes())?;
                self.writer.add_channel(schema, &topic, &encoding, &BTreeMap::new())
            };
            let channel = channel().map_err(|error| error.to_string())?;
            self.channels.insert(id, (channel, 0));
        }
        Ok(())
    }

    fn messages(&mut self, database: &Connection) -> Result<(), String> {
        let fault = |error: rusqlite::Error| error.to_string();
        let mut statement =
            database.prepare("SELECT topic_id, timestamp, data FROM messages").map_err(fault)?;
        let mut rows = statement.query([]).map_err(fault)?;
        while let Some(row) = rows.next().map_err(fault)? {
            let Some((channel_id, sequence)) = self.channels.get_mut(&row.get(0).map_err(fault)?) else {
                continue;
            };
            let stamp_ns = u64::try_from(row.get::<_, i64>(1).map_err(fault)?).unwrap_or_default();
            let data = row.get_ref(2).map_err(fault)?;
            let data = data.as_blob().map_err(|error| error.to_string())?;
            let header = MessageHeader {
                channel_id: *channel_id,
                sequence: *sequence,
                log_time: stamp_ns,
                publish_time: stamp_ns,
            };
            self.writer.write_to_known_channel(&header, data).map_err(|error| error.to_string())?;
            *sequence = sequence.wrapping_add(1);
            self.messages += 1;
        }
        Ok(())
    }
}

/// The definition that fits the first message of a topic whose bag describes none; empty if nothing known fits.
fn undescribed(database: &Connection, topic: i64, type_name: &str) -> String {
    let text = "SELECT data FROM messages WHERE topic_id = ?1 LIMIT 1";
    let first: Vec<u8> = database.query_row(text, [topic], |row| row.get(0)).unwrap_or_default();
    undescribed::definition(type_name, &first)
}
