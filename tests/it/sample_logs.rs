//! The committed sample logs are what their generator writes, and hold what they say.

#[path = "../../examples/sample_logs/sample/mod.rs"]
mod sample;

use std::{collections::BTreeMap, fs};

use mcap::{MessageStream, Summary, read, records};

use crate::support::{sample as sample_file, samples};

const AGAIN: &str = "run: cargo run --release --example sample_logs -- sample-logs";

fn committed(name: &str) -> Vec<u8> {
    fs::read(sample_file(name)).unwrap()
}

/// Names of the committed files, in order.
fn present() -> Vec<String> {
    let mut present: Vec<String> = fs::read_dir(samples())
        .unwrap()
        .map(Result::unwrap)
        .filter(|entry| entry.file_type().unwrap().is_file())
        .map(|entry| entry.file_name().into_string().unwrap())
        .collect();
    present.sort();
    present
}

/// Messages by topic, as far as a plain reader gets.
fn counts(name: &str) -> BTreeMap<String, usize> {
    let bytes = committed(name);
    let options = read::Options::IgnoreEndMagic.into();
    let mut counts = BTreeMap::new();
    for message in MessageStream::new_with_options(&bytes, options).unwrap().map_while(Result::ok) {
        *counts.entry(message.channel.topic.clone()).or_default() += 1;
    }
    counts
}

/// Every record of a log but those that say where others stand in it.
fn inside(log: &[u8]) -> Vec<(String, Vec<u8>)> {
    let records = read::ChunkFlattener::new(log).unwrap().map(Result::unwrap);
    let content = records.filter(|record| {
        use records::Record as R;
        !matches!(
            record,
            R::MessageIndex(_)
                | R::ChunkIndex(_)
                | R::AttachmentIndex(_)
                | R::MetadataIndex(_)
                | R::SummaryOffset(_)
                | R::DataEnd(_)
                | R::Footer(_)
        )
    });
    content
        .map(|record| match record {
            records::Record::Message { header, data } => (format!("{header:?}"), data.into_owned()),
            other => (format!("{other:?}"), Vec::new()),
        })
        .collect()
}

#[test]
fn the_committed_files_are_those_that_the_generator_writes() {
    // Compressed quickly: what is inside is compared.
    let files = sample::files(1).unwrap();
    let names: Vec<String> = files.keys().cloned().collect();
    assert_eq!(present(), names, "{AGAIN}");
    let lengths: Vec<(String, usize)> =
        files.iter().map(|(name, bytes)| (name.clone(), bytes.len())).collect();
    for (name, mut bytes) in files {
        let committed = committed(&name);
        if name == "README.md" {
            let mut text = String::from_utf8(bytes).unwrap();
            for (name, length) in &lengths {
                let is = fs::metadata(sample_file(name)).unwrap().len();
                text = text.replace(&format!("| `{name}` | {length} |"), &format!("| `{name}` | {is} |"));
            }
            bytes = text.into_bytes();
        }
        let whole = name.strip_suffix(".mcap").is_some_and(|name| name != "power-loss");
        let same = if whole { inside(&bytes) == inside(&committed) } else { bytes == committed };
        assert!(same, "{name} differs; {AGAIN}");
    }
}

#[test]
fn logs_stay_small() {
    let sizes: Vec<usize> = present().iter().map(|name| committed(name).len()).collect();
    assert!(sizes.iter().all(|size| *size < 1_500_000), "{sizes:?}");
    assert!(sizes.iter().sum::<usize>() < 5_500_000, "{sizes:?}");
}

#[test]
fn the_cut_log_has_no_end_and_gives_a_plain_reader_what_came_before_its_last_chunk() {
    assert!(Summary::read(&committed("power-loss.mcap")).is_err());
    let counts = counts("power-loss.mcap");
    let text = String::from_utf8(committed("README.md")).unwrap();
    let said = text.lines().find_map(|line| line.strip_prefix("* measured before cut chunk: ")).unwrap();
    assert!(counts["/joint_states"] >= said.parse::<usize>().unwrap());
    assert!(counts["/joint_states"] < 3500);
}

#[test]
fn a_log_with_the_plan_in_one_message_has_no_other_plan() {
    let counts = counts("trajectory-only.mcap");
    assert_eq!(counts.keys().collect::<Vec<_>>(), ["/arm_controller/joint_trajectory", "/joint_states"]);
    assert_eq!(counts["/arm_controller/joint_trajectory"], 1);
}
