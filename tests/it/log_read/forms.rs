//! Files of other forms: packed, SQLite, ROS 1, tables, one number a topic.

use std::io::Write;

use super::{
    cdr::{Cdr, Kind},
    file::store,
    *,
};

fn read_file(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Recording, LogError> {
    let stored = store(&[(name, bytes)]);
    hydrotrace::log::read_recording(&stored.paths, options)
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut writer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    writer.write_all(bytes).unwrap();
    writer.finish().unwrap()
}

fn zstd(bytes: &[u8]) -> Vec<u8> {
    zstd::encode_all(bytes, 1).unwrap()
}

#[test]
fn a_packed_log_is_read_as_the_log_itself() {
    let bytes = plain_log().bytes(mcap::WriteOptions::new());
    let usual = read(&plain_log());
    for (name, packed) in [("run.mcap.gz", gzip(&bytes)), ("run.mcap.zstd", zstd(&bytes))] {
        assert_eq!(read_file(name, &packed, &ReadOptions::default()).unwrap(), usual, "{name}");
        // What is cut gives what came before.
        let cut = read_file(name, &packed[..packed.len() * 3 / 4], &ReadOptions::default());
        let why = |error: LogError| std::error::Error::source(&error).map(ToString::to_string);
        let is_told = |why: Option<String>| why.is_some_and(|why| why.contains("copy it again"));
        assert!(cut.is_ok() || cut.is_err_and(|error| is_told(why(error))), "{name}");
    }
    let bomb = zstd(&vec![0; 300 << 20]);
    let error = read_file("run.mcap.zst", &bomb, &ReadOptions::default()).unwrap_err();
    let why = std::error::Error::source(&error).map(ToString::to_string).unwrap_or_default();
    assert!(why.contains("more than 1000 times"), "{error}: {why}");
}

#[test]
fn messages_that_are_packed_each_are_read() {
    let mut log = plain_log();
    let usual = read(&log);
    log.messages.iter_mut().for_each(|message| message.data = zstd(&message.data));
    assert_eq!(read(&log), usual);
}

/// A bag as rosbag2 writes it; with the definitions of the types, as since Iron, or without, as before.
fn bag(log: &Log, described: bool) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.db3");
    let database = rusqlite::Connection::open(&path).unwrap();
    let tables = "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
            serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
        CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
            data BLOB NOT NULL);";
    database.execute_batch(tables).unwrap();
    if described {
        let table = "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL,
            encoding TEXT NOT NULL, encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);";
        database.execute_batch(table).unwrap();
    }
    for (id, channel) in log.channels.iter().enumerate() {
        let row = (id as i64, &channel.topic, &channel.type_name, &channel.encoding);
        database.execute("INSERT INTO topics VALUES(?1, ?2, ?3, ?4, '')", row).unwrap();
        if described {
            let text = String::from_utf8_lossy(&channel.schema).into_owned();
            let row = (&channel.type_name, &channel.schema_encoding, text);
            let sql = "INSERT INTO message_definitions(topic_type, encoding, encoded_message_definition, \
                       type_description_hash) VALUES(?1, ?2, ?3, '')";
            database.execute(sql, row).unwrap();
        }
    }
    for message in &log.messages {
        let row = (message.channel as i64, message.log_ns as i64, &message.data);
        database.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(?1, ?2, ?3)", row).unwrap();
    }
    database.close().unwrap();
    std::fs::read(path).unwrap()
}

#[test]
fn a_bag_in_sqlite_is_read_as_one_in_mcap() {
    let mut log = plain_log();
    let usual = read(&log);
    for described in [true, false] {
        let bytes = bag(&log, described);
        assert_eq!(read_file("run.db3", &bytes, &ReadOptions::default()).unwrap(), usual, "{described}");
    }
    let folder = store(&[
        ("run_0.db3.zstd", &zstd(&bag(&log, false))),
        (
            "metadata.yaml",
            b"rosbag2_bagfile_information:\n  storage_identifier: sqlite3\n  relative_file_paths: [run_0.db3.zstd]\n",
        ),
    ]);
    let found = hydrotrace::log::read_recording(&[folder.folder.path().to_owned()], &ReadOptions::default());
    assert_eq!(found.unwrap(), usual);
    // Nothing is left beside the bag.
    assert_eq!(std::fs::read_dir(folder.folder.path()).unwrap().count(), 2);
    log.messages.clear();
    assert!(read_file("run.db3", &bag(&log, true), &ReadOptions::default()).is_err());
    let broken = &bag(&plain_log(), true)[..5000];
    let error = read_file("run.db3", broken, &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("malformed") && error.contains(".recover"), "{error}");
}

#[test]
fn a_controllers_state_without_a_definition_is_told_by_its_bytes() {
    let mut log = Log::default();
    let point = |cdr: &mut Cdr, position: &[f64]| {
        cdr.f64s(position);
        (0..3).for_each(|_| cdr.f64s(&[]));
        cdr.time(0);
    };
    let channel = Channel::cdr("/c/state", "control_msgs/msg/JointTrajectoryControllerState");
    log.add(channel, 0..SAMPLES, |k| {
        Cdr::message(Kind::LittleEndian, |cdr| {
            cdr.header(stamp(k));
            cdr.texts(&NAMES);
            [plan(k), measurement(k), vec![0.0; 2]].iter().for_each(|position| point(cdr, position));
        })
    });
    // As Foxy and Humble write it: desired, actual, error.
    let found = read_file("run.db3", &bag(&log, false), &ReadOptions::default()).unwrap();
    assert_usual(&found);
    assert_eq!(found.source.planned_field, "desired.positions");
}

#[test]
fn messages_of_ros_1_are_read() {
    let schema = "Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n\
                  ====\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";
    let mut log = plain_log();
    for channel in &mut log.channels {
        *channel = channel.clone().encoded("ros1").with_schema("ros1msg", schema);
        channel.type_name = "sensor_msgs/JointState".to_owned();
    }
    let plan_topic = log.channels.iter().position(|channel| channel.topic.starts_with("/planned")).unwrap();
    for message in &mut log.messages {
        let k = (message.log_ns as i64 - START_NS) / STEP_NS;
        let values = if message.channel == plan_topic { plan(k) } else { measurement(k) };
        let mut data = Vec::new();
        let mut put = |value: u32| data.extend(value.to_le_bytes());
        put(7);
        put((message.log_ns / 1_000_000_000) as u32);
        put((message.log_ns % 1_000_000_000) as u32);
        // A frame of three letters leaves nothing aligned.
        put(3);
        data.extend(b"arm");
        data.extend((NAMES.len() as u32).to_le_bytes());
        for name in NAMES {
            data.extend((name.len() as u32).to_le_bytes());
            data.extend(name.as_bytes());
        }
        data.extend((values.len() as u32).to_le_bytes());
        values.iter().for_each(|value| data.extend(value.to_le_bytes()));
        data.extend([0; 8]);
        message.data = data;
    }
    let found = read(&log);
    assert_usual(&found);
}

#[test]
fn a_table_is_read_as_the_log_that_import_makes_of_it() {
    let mut text = "time_s,a_planned_rad,a_measured_rad,b_planned_rad,b_measured_rad\n".to_owned();
    for k in 0..SAMPLES {
        let (plan, real) = (plan(k), measurement(k));
        text += &format!("{},{},{},{},{}\n", k as f64 * 0.02, plan[0], real[0], plan[1], real[1]);
    }
    for (name, bytes) in [("a.csv", text.clone().into_bytes()), ("a.csv.gz", gzip(text.as_bytes()))] {
        let found = read_file(name, &bytes, &ReadOptions::default()).unwrap();
        assert_usual(&found);
    }
    let error = read_file("a.csv", b"x,y\n1,2\n3,4\n5,6\n", &ReadOptions::default()).unwrap_err();
    assert!(error.to_string().contains("hydrotrace import"), "{error}");
}

#[test]
fn topics_of_one_number_each_are_joints() {
    let mut log = Log::default();
    for (joint, name) in NAMES.iter().enumerate() {
        for (role, values) in [("set", plan as fn(i64) -> Vec<f64>), ("actual", measurement)] {
            let channel = Channel::cdr(&format!("/{name}/{role}"), "std_msgs/msg/Float64");
            log.add(channel.with_schema("ros2msg", "float64 data\n"), 0..SAMPLES, |k| {
                Cdr::message(Kind::LittleEndian, |cdr| cdr.f64(values(k)[joint]))
            });
        }
    }
    log.messages.sort_by_key(|message| message.log_ns);
    let (planned, measured) = (["/a/set:data", "/b/set:data"], ["/a/actual:data", "/b/actual:data"]);
    for joints in [&NAMES[..], &[]] {
        let found = read_with(&log, &options(&planned, &measured, joints));
        assert_usual(&found);
    }
    let found = read_with(&log, &options(&planned[..1], &measured[..1], &["boom"]));
    assert_eq!((joints(&found.planned), joints(&found.measured)), (vec!["boom"], vec!["boom"]));
    let error = super::error(&log, &options(&["/a/set"], &["/a/actual"], &[]));
    assert!(error.contains("/a/set:data, one of each joint"), "{error}");
}

#[test]
fn numbers_in_json_one_a_topic_are_joints() {
    let mut log = Log::default();
    for (role, values) in [("set", plan as fn(i64) -> Vec<f64>), ("actual", measurement)] {
        for (joint, name) in NAMES.iter().enumerate() {
            let said = |k| format!("{{\"value\": {}}}", values(k)[joint]).into_bytes();
            log.add(Channel::json(&format!("/{name}/{role}"), "plc.Value"), 0..SAMPLES, said);
        }
    }
    log.messages.sort_by_key(|message| message.log_ns);
    let (planned, measured) = (["/a/set:value", "/b/set:value"], ["/a/actual:value", "/b/actual:value"]);
    let found = read_with(&log, &options(&planned, &measured, &NAMES));
    assert_usual(&found);
}

#[test]
fn a_topic_nobody_asked_for_is_no_doubt() {
    let mut log = plain_log();
    let service = Channel::cdr("/reset/_service_event", "std_srvs/srv/Trigger_Event");
    log.channel(service.with_schema("ros2msg", "---\nbool success\nstring message\n"));
    let odd = Channel::cdr("/odd", "mine/msg/Odd").with_schema("ros2msg", "float64[ x\n");
    log.channel(odd);
    for (channel, _) in log.channels.clone().iter().enumerate().skip(2) {
        log.send(channel, stamp(3), vec![0, 1, 0, 0, 1]);
    }
    log.messages.sort_by_key(|message| message.log_ns);
    assert_eq!(codes(&read(&log).remarks), Vec::<Code>::new());
}

#[test]
fn a_log_of_speeds_alone_says_so() {
    let mut log = Log::default();
    for topic in ["/planned/joint_states", "/joint_states"] {
        log.add(Channel::states(topic), 0..SAMPLES, |k| {
            encode::joint_state(Kind::LittleEndian, stamp(k), &NAMES, &[], &[0.1, 0.2])
        });
    }
    let said = error(&log, &ReadOptions::default());
    assert!(said.contains("without positions"), "{said}");
    let said = error(&log, &options(&["/planned/joint_states"], &[], &[]));
    assert!(said.contains("joints without positions, at most speeds"), "{said}");
}

#[test]
fn joints_that_slide_are_named_by_option_or_by_an_imported_table() {
    let found = read_with(
        &plain_log(),
        &ReadOptions {
            slides: [("b".to_owned(), hydrotrace::log::LengthUnit::Metres)].into(),
            ..ReadOptions::default()
        },
    );
    let units = |series: &Series| series.tracks.iter().map(|track| track.kind().unit()).collect::<Vec<_>>();
    assert_eq!((units(&found.planned), units(&found.measured)), (vec!["rad", "m"], vec!["rad", "m"]));
    let in_mm = ReadOptions {
        slides: [("b".to_owned(), hydrotrace::log::LengthUnit::Millimetres)].into(),
        ..ReadOptions::default()
    };
    let b = |series: &Series| series.tracks[1].position()[9];
    assert!((1e3 * b(&read_with(&plain_log(), &in_mm).planned) - b(&found.planned)).abs() < 1e-12);
    let mut text = "time_s,boom set [mm],boom act [mm],a_set_deg,a_act_deg\n".to_owned();
    for k in 0..SAMPLES {
        text += &format!("{},{},{},{},{}\n", k as f64 * 0.02, 10 * k, 10 * k - 1, k, k);
    }
    let found = read_file("a.csv", text.as_bytes(), &ReadOptions::default()).unwrap();
    assert_eq!(joints(&found.planned), ["boom", "a"]);
    assert_eq!(units(&found.measured), ["m", "rad"]);
    assert!((found.planned.tracks[0].position()[3] - 0.03).abs() < 1e-12);
    let again = ReadOptions {
        slides: [("boom".to_owned(), hydrotrace::log::LengthUnit::Millimetres)].into(),
        ..ReadOptions::default()
    };
    let error = read_file("a.csv", text.as_bytes(), &again).unwrap_err().to_string();
    assert!(error.contains("--slides would convert \"boom set [mm]\""), "{error}");
    // What is called a cylinder and is told no unit is doubted, and what the caller says settles it.
    let bare = text.replace("boom set [mm],boom act [mm]", "boom_cylinder_set,boom_cylinder_act");
    let said = |slides: &[(&str, hydrotrace::log::LengthUnit)]| {
        let slides = slides.iter().map(|(joint, unit)| ((*joint).to_owned(), *unit)).collect();
        let found = read_file("a.csv", bare.as_bytes(), &ReadOptions { slides, ..ReadOptions::default() });
        let found = found.unwrap();
        let doubt = |remark: &&hydrotrace::remark::Remark| remark.message.contains("--slides");
        (units(&found.planned)[0], found.remarks.as_slice().iter().find(doubt).map(|one| one.message.clone()))
    };
    let (unit, doubt) = said(&[]);
    assert!(unit == "rad" && doubt.is_some_and(|doubt| doubt.contains("--slides boom_cylinder=mm")));
    let mm = hydrotrace::log::LengthUnit::Millimetres;
    assert_eq!(said(&[("boom_cylinder", mm)]), ("m", None));
    assert!(said(&[("boom_cylinder", mm), ("bucket", mm)]).1.is_some_and(|doubt| doubt.contains("bucket")));
}

#[test]
fn a_broken_parquet_table_is_an_error_wherever_it_is_broken() {
    use hydrotrace::log::{AngleUnit, RunTable};
    let mut whole = Vec::new();
    RunTable::new(&read(&plain_log()), AngleUnit::Radians).write_parquet(&mut whole).unwrap();
    let found = read_file("a.parquet", &whole, &ReadOptions::default()).unwrap();
    assert_values(&found.planned, plan);
    // The library panics on some of these, which its caller must not.
    let metadata = whole.len() - whole.len() / 3;
    for at in (metadata..whole.len()).step_by(3) {
        for broken in [0x00, 0x7F, 0xFF] {
            let mut bytes = whole.clone();
            bytes[at] = broken;
            let _ = read_file("a.parquet", &bytes, &ReadOptions::default());
        }
    }
}
