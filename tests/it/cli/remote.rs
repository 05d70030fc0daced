//! Logs in object stores, read from a server on this machine.

use std::{fs, process::Output};

use crate::support::{
    command,
    fleet::{cells, files, small_log},
    said, sample,
    store::Store,
};

/// The binary with the environment of an S3 store on this machine.
fn run(store: &Store, folder: &std::path::Path, line: &str) -> Output {
    command(folder)
        .args(line.split_whitespace())
        .env("AWS_ENDPOINT", format!("http://{}", store.host))
        .env("AWS_ALLOW_HTTP", "true")
        .env("AWS_SKIP_SIGNATURE", "true")
        .output()
        .unwrap()
}

/// Two machines with three days each, and what is no log.
fn filled() -> Store {
    let store = Store::new();
    for (machine, days) in [("M00", 0..3), ("M 01", 0..3)] {
        for day in days {
            let log = small_log(machine, day, day.unsigned_abs(), [0.2, 0.3]);
            store.put(&format!("bucket/logs/machine={machine}/{day:02}.mcap"), log);
        }
    }
    store.put("bucket/logs/notes.txt", b"none".to_vec());
    store
}

#[test]
fn a_scan_of_a_store_is_that_of_the_same_files() {
    let store = filled();
    let folder = tempfile::tempdir().unwrap();
    for (path, bytes) in store.files.lock().unwrap().iter() {
        let path = folder.path().join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    let scan = |source: &str, into: &str| {
        let line = format!("fleet scan {source} --into {into} --machine-from path:machine");
        let (code, out, err) = said(&run(&store, folder.path(), &line));
        assert_eq!(code, 0, "{source}: {out}{err}");
        out
    };
    scan("bucket/logs", "of-files");
    for (source, into) in [
        ("s3://bucket/logs".to_owned(), "of-s3"),
        ("s3://bucket/logs/*/0?.mcap".replace('?', "*"), "of-pattern"),
        (format!("http://{}/bucket/logs", store.host), "of-web"),
    ] {
        assert!(scan(&source, into).contains("6 logs: 6 analysed now, 0 known already."), "{source}");
        for column in ["log_sha256", "machine", "plan_id", "error"] {
            let [ours, theirs] =
                [into, "of-files"].map(|data| cells(&folder.path().join(data), "runs", column));
            let sorted = |mut cells: Vec<String>| {
                cells.sort();
                cells
            };
            assert_eq!(sorted(ours), sorted(theirs), "{source} {column}");
        }
        // One request a log, and the list.
        store.requests.lock().unwrap().clear();
        let before = files(&folder.path().join(into));
        assert!(scan(&source, into).contains("0 analysed now, 6 known already."), "{source}");
        assert_eq!(files(&folder.path().join(into)), before);
        assert_eq!(store.requests.lock().unwrap().len(), 1, "{source}");
    }
    // Another content has another tag.
    store.put("bucket/logs/machine=M00/00.mcap", small_log("M00", 0, 99, [0.1, 0.1]));
    assert!(scan("s3://bucket/logs", "of-s3").contains("1 analysed now, 1 of them again, 5 known already."));
    // A list may name both.
    fs::write(
        folder.path().join("list.txt"),
        "s3://bucket/logs/machine=M00/01.mcap\nbucket/logs/machine=M00/01.mcap\n",
    )
    .unwrap();
    assert!(scan("list.txt", "of-list").contains("2 logs: 2 analysed now"));
}

#[test]
fn a_store_that_fails_for_a_while_costs_patience_only() {
    let store = filled();
    let folder = tempfile::tempdir().unwrap();
    *store.faults.lock().unwrap() = 4;
    let (code, out, err) = said(&run(&store, folder.path(), "fleet scan s3://bucket/logs --into data"));
    assert_eq!(code, 0, "{out}{err}");
    assert!(out.contains("6 analysed now"), "{out}");
}

#[test]
fn a_bag_in_a_store_is_one_log_and_a_large_one_is_read_in_parts() {
    let store = Store::new();
    let bag = fs::read(sample("task-1-run.mcap")).unwrap();
    store.put("bucket/day/bag/metadata.yaml", b"rosbag2_bagfile_information: {}\n".to_vec());
    store.put("bucket/day/bag/bag_0.mcap", bag.clone());
    let folder = tempfile::tempdir().unwrap();
    let (code, out, err) = said(&run(&store, folder.path(), "fleet scan s3://bucket/day --into data"));
    // The bag names no machine.
    assert_eq!(code, 3, "{out}{err}");
    assert_eq!(cells(&folder.path().join("data"), "runs", "log_uri"), ["s3://bucket/day/bag"]);
    assert_eq!(
        store.requests.lock().unwrap().iter().filter(|r| r.starts_with("GET bucket/day/bag")).count(),
        1
    );
    // A fit reads it from the same place.
    store.put("bucket/short/bag/metadata.yaml", b"rosbag2_bagfile_information: {}\n".to_vec());
    store.put("bucket/short/bag/bag_0.mcap", small_log("M00", 0, 1, [0.2, 0.3]));
    let (_, out, err) = said(&run(&store, folder.path(), "fleet scan s3://bucket/short --into fitted --fit"));
    let remarks = cells(&folder.path().join("fitted"), "remarks", "message").join("\n");
    assert!(!remarks.contains("cannot") && out.contains("1 analysed now"), "{remarks}{out}{err}");
    // 40 MB that are no joints, at the end: an attachment.
    let mut big = bag[..bag.len() - 8].to_vec();
    big.extend(std::iter::repeat_n(0_u8, 40 << 20));
    store.put("bucket/big.mcap", big);
    store.requests.lock().unwrap().clear();
    let (code, out, err) = said(&run(&store, folder.path(), "info s3://bucket/big.mcap"));
    assert!(code == 0 || code == 3, "{out}{err}");
    let requests = store.requests.lock().unwrap().clone();
    assert!(requests.iter().any(|request| request.contains("bytes=")), "{requests:?}");
}

#[test]
fn any_verb_reads_an_address_as_the_file() {
    let store = Store::new();
    store.put("bucket/task-1-run.mcap", fs::read(sample("task-1-run.mcap")).unwrap());
    let folder = tempfile::tempdir().unwrap();
    for name in ["task-1-run.mcap", "precompensated-run.mcap"] {
        fs::copy(sample(name), folder.path().join(name)).unwrap();
    }
    // A fit takes minutes in a build without optimising, as this one is run.
    for line in [
        "report LOG --json",
        "compare LOG precompensated-run.mcap --json",
        "export LOG -o out.csv",
        "info LOG --json",
    ] {
        let [there, here] = ["s3://bucket/task-1-run.mcap", "task-1-run.mcap"]
            .map(|log| said(&run(&store, folder.path(), &line.replace("LOG", log))));
        assert_eq!(there.0, here.0, "{line}: {}", there.2);
        let same = there.1.replace("s3://bucket/", "");
        assert_eq!(same, here.1, "{line}");
    }
}

#[test]
fn what_is_not_there_and_what_is_no_address_is_said() {
    let store = filled();
    let folder = tempfile::tempdir().unwrap();
    for (line, expected) in [
        (
            "fleet scan s3://bucket/nothing --into data",
            "cannot find s3://bucket/nothing: there is no such object",
        ),
        ("fleet scan s3://bucket/logs/*.bag --into data", "found no log in"),
        ("fleet scan ftp://host/logs --into data", "\"ftp://host/logs\" is no address of logs"),
        ("report s3://bucket/nothing.mcap", "cannot find s3://bucket/nothing.mcap"),
        ("report https://host/run.mcap?signature=1", "it has a query"),
    ] {
        let (code, out, err) = said(&run(&store, folder.path(), line));
        assert_eq!((code, out.as_str()), (1, ""), "{line}: {err}");
        assert!(err.contains(expected), "{line}: {err}");
        assert!(!folder.path().join("data/runs").exists());
    }
}
