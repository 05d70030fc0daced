//! Files made to exhaust the reader: work and memory stay in proportion to the file.

use allocation_counter::measure;
use hydrotrace::log::survey_bytes as survey;

use super::{
    cdr::{Cdr, Kind},
    encode,
    file::*,
    *,
};

/// Peak and total bytes allocated by reading, on one thread.
fn cost(bytes: &[u8]) -> (u64, u64) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let info = pool.install(|| measure(|| drop(survey(bytes, &ReadOptions::default()))));
    (info.bytes_max, info.bytes_total)
}

fn joint_state_log(schema: &[u8], encoding: &str, data: &[u8]) -> Vec<u8> {
    let mut log = plain_log();
    let channel = Channel::cdr("/bomb", "sensor_msgs/msg/JointState").with_schema(encoding, schema);
    log.add(channel, 0..10, |_| data.to_vec());
    log.bytes(mcap::WriteOptions::new())
}

/// Frames of zeros, 8 GiB in all, from a few hundred kilobytes.
fn bomb() -> Vec<u8> {
    let one = zstd::bulk::compress(&vec![0; 128 << 20], 3).unwrap();
    one.repeat(64)
}

#[test]
fn a_decompression_bomb_costs_no_more_than_it_promises() {
    let bomb = bomb();
    for promised in [8_u64 << 30, 1 << 40, u64::MAX] {
        let bytes = [MAGIC.to_vec(), chunk_with("zstd", promised, 0, &bomb), end()].concat();
        let (peak, total) = cost(&bytes);
        println!("bomb of {} bytes promising {promised}: peak {peak}, total {total}", bytes.len());
        assert!(peak < 1 << 20, "{peak}");
        assert_eq!(count(&survey(&bytes, &ReadOptions::default()).unwrap().remarks, Code::DamagedChunk), 1);
    }
    let bytes = [MAGIC.to_vec(), chunk_with("zstd", 1 << 20, 0, &bomb), end()].concat();
    let (peak, _) = cost(&bytes);
    assert!(peak < 4 << 20, "{peak}");
    // A bomb that promises all that is believed, cut or not.
    for bytes in [&bytes[..], &bytes[..bytes.len() - 60]] {
        assert!(cost(bytes).0 < 4 << 20);
    }
}

#[test]
fn schemas_that_unfold_without_end_are_refused() {
    let rule = format!("\n{}\nMSG: ", "=".repeat(80));
    let mut nested = String::from("x/A0 a\nfloat64[] position\nstring[] name\n");
    for k in 0..60 {
        nested += &format!("{rule}x/A{k}\nx/A{0} a\nx/A{0} b\n", k + 1);
    }
    nested += &format!("{rule}x/A60\nfloat64 z\n");
    let recursive = format!("x/A a\nstring[] name\nfloat64[] position\n{rule}x/A\nx/A[] a\n");
    let own = "sensor_msgs/JointState a\nstring[] name\nfloat64[] position\n".to_owned();
    let wide = format!(
        "x/B[] b\nstring[] name\nfloat64[] position\n{rule}x/B\n{}{rule}x/C\n{}",
        "x/C c\n".repeat(20_000),
        "uint8 d\n".repeat(50_000)
    );
    let long = "float64 a\n".repeat(200_000);
    let zero = "float64[0] position\nstring[] name\n".to_owned();
    for text in [nested, recursive, own, wide, long, zero] {
        let bytes = joint_state_log(text.as_bytes(), "ros2msg", &[0, 1, 0, 0, 9, 9, 9, 9]);
        let (_, total) = cost(&bytes);
        assert!(total < 100 << 20, "{total} bytes allocated for {} of schema", text.len());
        let survey = survey(&bytes, &ReadOptions::default()).unwrap();
        assert_eq!(count(&survey.remarks, Code::UnreadableSchema), 10, "{:?}", survey.remarks);
        assert!(survey.recording.is_ok());
    }
}

#[test]
fn idl_that_unfolds_without_end_is_refused_or_small() {
    let mut chain = String::from("typedef double a0;\n");
    for k in 0..200 {
        chain += &format!("typedef sequence<sequence<sequence<sequence<a{k}>>>> a{};\n", k + 1);
    }
    let fields = "a200 x;\n".repeat(20_000);
    let chain = format!(
        "{chain}module sensor_msgs {{ module msg {{ struct JointState {{ {fields} sequence<string> name; sequence<double> position; }}; }}; }};"
    );
    let itself = "typedef sequence<a> a; struct JointState { a b; sequence<string> name; sequence<double> position; };".to_owned();
    let deep =
        format!("struct JointState {{ {}double{} b; }};", "sequence<".repeat(100_000), ">".repeat(100_000));
    let modules = "module a { ".repeat(50_000);
    for text in [chain, itself, deep, modules] {
        let bytes = joint_state_log(text.as_bytes(), "ros2idl", &[0, 1, 0, 0, 9, 9, 9, 9]);
        let (_, total) = cost(&bytes);
        assert!(total < 100 << 20, "{total} bytes allocated for {} of schema", text.len());
        let survey = survey(&bytes, &ReadOptions::default()).unwrap();
        assert_eq!(count(&survey.remarks, Code::UnreadableSchema), 10, "{:?}", survey.remarks);
    }
}

#[test]
fn lists_that_promise_more_than_the_message_holds_are_refused() {
    let rule = format!("\n{}\nMSG: ", "=".repeat(80));
    let arrays = "float64[4294967295] effort\nstring[] name\nfloat64[] position\n".to_owned();
    let texts = "string[4294967295] effort\nstring[] name\nfloat64[] position\n".to_owned();
    let empties = format!("x/E[4294967295] effort\nstring[] name\nfloat64[] position\n{rule}x/E\n");
    let twice = format!(
        "x/E[65535] e\nstring[] name\nfloat64[] position\n{rule}x/E\nx/F[65535] f\n{rule}x/F\nx/G[65535] g\n{rule}x/G\n"
    );
    for text in [arrays, texts, empties, twice] {
        let bytes = joint_state_log(text.as_bytes(), "ros2msg", &[0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
        let (peak, total) = cost(&bytes);
        assert!(peak < 4 << 20 && total < 16 << 20, "{peak} {total}");
        let remarks = survey(&bytes, &ReadOptions::default()).unwrap().remarks;
        assert_eq!(
            count(&remarks, Code::UndecodableMessage) + count(&remarks, Code::UnreadableSchema),
            10,
            "{remarks:?}"
        );
    }
    let counts = Cdr::message(Kind::LittleEndian, |cdr| {
        cdr.header(0);
        cdr.u32(u32::MAX);
    });
    let bytes = joint_state_log(schema::text("sensor_msgs/msg/JointState").as_bytes(), "ros2msg", &counts);
    assert!(cost(&bytes).0 < 4 << 20);
}

#[test]
fn a_hundred_thousand_joints_are_no_arm() {
    let names: Vec<String> = (0..100_000).map(|k| format!("j{k}")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let values = vec![0.5; names.len()];
    let mut log = plain_log();
    log.add(Channel::states("/many/joint_states"), 3..4, |k| states(k, &names, &values));
    let nameless = Channel::cdr("/many/array", "std_msgs/msg/Float64MultiArray");
    log.add(nameless, 3..4, |_| encode::array(Kind::LittleEndian, &values));
    let recording = read(&log);
    assert_values(&recording.measured, measurement);
    let bytes = log.bytes(mcap::WriteOptions::new().compression(None));
    assert!(cost(&bytes).0 < 20 * bytes.len() as u64);
    let asked = read_bytes(&bytes, &options(&[], &["/many/joint_states"], &[])).unwrap_err();
    assert!(asked.to_string().contains("has no joint angles"), "{asked}");
}

#[test]
fn joints_that_differ_in_every_message_end_somewhere() {
    let mut log = Log::of_plan();
    log.add(Channel::states("/joint_states"), 0..20_000, |k| {
        let names = [format!("x{k}"), format!("y{k}")];
        let names: [&str; 2] = [&names[0], &names[1]];
        let names = if k < SAMPLES { NAMES } else { names };
        states(k, &names, &[0.5, 0.6])
    });
    for per_chunk in [1, 100_000] {
        let bytes = log.by_hand("", per_chunk);
        let (peak, total) = cost(&bytes);
        println!("{} bytes: peak {peak}, total {total}", bytes.len());
        assert!(peak < 100 * bytes.len() as u64, "{peak} of {}", bytes.len());
        let recording = read_bytes(&bytes, &ReadOptions::default()).unwrap();
        assert!(count(&recording.remarks, Code::NotSupported) > 0, "{:?}", recording.remarks);
        assert_eq!(recording.measured.track("a").unwrap().len() as i64, SAMPLES);
    }
}

#[test]
fn many_channels_and_many_chunks_do_not_multiply() {
    let schema =
        format!("{}{}", schema::text("sensor_msgs/msg/JointState"), "uint8 x\nstring s\n".repeat(2000));
    let mut bytes =
        [MAGIC.to_vec(), schema_record(1, "sensor_msgs/msg/JointState", "ros2msg", schema.as_bytes())]
            .concat();
    for id in 1..=u16::MAX {
        bytes.extend(channel_record(id, 1, &format!("/{id}"), "cdr"));
    }
    for k in 0..20_000_u16 {
        bytes.extend(chunk_with("", 31, 0, &message_record(k + 1, 0, 0, &[])));
    }
    bytes.extend(end());
    let (peak, total) = cost(&bytes);
    println!("{} bytes: peak {peak}, total {total}", bytes.len());
    assert!(peak < 60 * bytes.len() as u64, "{peak} of {}", bytes.len());
    assert!(total < 200 * bytes.len() as u64, "{total} of {}", bytes.len());
}

#[test]
fn many_small_definitions_do_not_multiply() {
    let rule = "=".repeat(40);
    let sections: String = (0..15_000).map(|_| format!("{rule}\nMSG: x/Y\nuint8 a\n")).collect();
    let bytes = joint_state_log(format!("uint8 a\n{sections}").as_bytes(), "ros2msg", &[0; 20]);
    assert!(cost(&bytes).1 < 200 << 20);
}

#[test]
fn a_clock_that_jumps_back_at_every_message_is_only_slow_to_read_about() {
    let mut log = Log::of_plan();
    let channel = log.channel(Channel::states("/joint_states"));
    for k in 0..100_000 {
        let header = stamp(0) + (100_000 - k) * 2_000_000_000;
        log.send(
            channel,
            stamp(k * 100),
            encode::joint_state(Kind::LittleEndian, header, &NAMES, &[0.5, k as f64 * 1e-5], &[]),
        );
    }
    let survey = survey(&log.by_hand("zstd", 1000), &ReadOptions::default()).unwrap();
    // A jump takes several messages on the new clock; these are wrong stamps.
    assert_eq!(count(&survey.remarks, Code::UnusableStamp), 99_999);
}

#[test]
fn protobuf_fields_that_nobody_wants_are_not_built() {
    let fields: Vec<Vec<u8>> =
        (1..10_000).map(|k| protobuf::field(&format!("f{k}"), k + 10, false, 1, "")).collect();
    let message = protobuf::message("JointStates", &fields);
    let schema = protobuf::descriptor_file("a.proto", "foxglove", &[], &[message]);
    let mut log = plain_log();
    let channel = Channel::cdr("/many", "foxglove.JointStates").with_schema("protobuf", schema);
    log.add(channel.encoded("protobuf"), 0..2000, |_| vec![]);
    let bytes = log.bytes(mcap::WriteOptions::new());
    let (_, total) = cost(&bytes);
    println!("{} bytes: total {total}", bytes.len());
    assert!(total < 100 << 20, "{total}");
}
