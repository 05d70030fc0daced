//! `watch` at the built binary: logs appear, pages and the index follow, and nothing else does.

use std::{
    collections::BTreeMap,
    fs,
    io::{BufRead, BufReader, Read, Write},
    net::TcpStream,
    path::{Path, PathBuf},
    process::{Child, ChildStdout, Command, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

use serde_json::Value;

use crate::support::{
    clean, command,
    fleet::{cells, is_whole, small_fleet, small_log},
    hold_to_schema, run_line, said, sample,
};

const ONCE: &str = "watch logs --into out --settle 0 --once";

fn empty() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("logs")).unwrap();
    folder
}

fn start(folder: &Path, line: &str) -> Child {
    let mut watch = command(folder);
    watch.args(line.split(' ')).stdout(Stdio::piped()).stderr(Stdio::piped());
    watch.spawn().unwrap()
}

/// The next line that a watch prints.
fn next(lines: &mut BufReader<ChildStdout>) -> String {
    let mut line = String::new();
    lines.read_line(&mut line).unwrap();
    line
}

/// Until a condition holds, 20 s at most.
fn until(what: &str, holds: impl Fn() -> bool) {
    let from = Instant::now();
    while !holds() {
        assert!(from.elapsed() < Duration::from_secs(20), "no {what} after 20 s");
        sleep(Duration::from_millis(20));
    }
}

fn interrupted(mut watch: Child, lines: &mut BufReader<ChildStdout>) -> (i32, String) {
    assert!(Command::new("kill").args(["-INT", &watch.id().to_string()]).status().unwrap().success());
    let mut rest = String::new();
    lines.read_to_string(&mut rest).unwrap();
    (watch.wait().unwrap().code().unwrap(), rest)
}

/// The index and all pages with what is said of them, by name.
fn pages(into: &Path) -> BTreeMap<PathBuf, String> {
    let listed = fs::read_dir(into.join("pages")).unwrap().map(|entry| entry.unwrap().path());
    let shown = listed.filter(|path| path.extension().is_some()).chain([into.join("index.html")]);
    shown
        .map(|path| (path.strip_prefix(into).unwrap().to_owned(), fs::read_to_string(&path).unwrap()))
        .collect()
}

#[test]
fn reports_do_not_lie_among_the_logs_and_a_line_names_the_joint_of_each_number() {
    let folder = empty();
    fs::copy(sample("task-1-run.mcap"), folder.path().join("logs/task-1-run.mcap")).unwrap();
    let (code, _, error) = said(&run_line(folder.path(), "watch logs --into logs --once --settle 0"));
    assert!(code == 1 && error.contains("a folder of its own"), "{error}");
    assert!(!folder.path().join("logs/index.html").exists());
    let (_, out, _) = said(&run_line(folder.path(), ONCE));
    assert!(out.contains("J1 0.920 deg off; J5 2805 ms late"), "{out}");
}

#[test]
fn the_order_in_which_logs_appear_changes_no_byte_of_what_is_shown() {
    let folder = empty();
    let (logs, there) = (folder.path().join("logs"), folder.path().join("there"));
    small_fleet(&there, 2, 8);
    fs::write(there.join("M01/broken.mcap"), "no log").unwrap();
    let mut watch = start(folder.path(), "watch logs --into out --settle 0 --every 0.05 --json");
    let mut lines = BufReader::new(watch.stdout.take().unwrap());
    let mut names: Vec<PathBuf> = Vec::new();
    for machine in ["M01", "M00"] {
        fs::create_dir(logs.join(machine)).unwrap();
        let own = fs::read_dir(there.join(machine)).unwrap();
        names.extend(own.map(|entry| entry.unwrap().path().strip_prefix(&there).unwrap().to_owned()));
    }
    // Newest first, as nobody records them.
    names.sort_by(|a, b| b.cmp(a));
    for name in &names {
        fs::rename(there.join(name), logs.join(name)).unwrap();
        let told: Value = serde_json::from_str(&next(&mut lines)).unwrap();
        hold_to_schema(&told, "watch.v1");
        assert!(told["log"].as_str().unwrap().ends_with(name.to_str().unwrap()), "{told}");
    }
    let (code, rest) = interrupted(watch, &mut lines);
    // One log is broken.
    assert_eq!((code, rest.as_str()), (3, ""));
    let (code, out, _) = said(&run_line(folder.path(), &ONCE.replace("out", "other")));
    assert!(code == 3 && out.contains("17 logs reported now"), "{out}");
    let (one_by_one, at_once) = (pages(&folder.path().join("out")), pages(&folder.path().join("other")));
    assert_eq!(one_by_one.len(), 16 + 17 + 1);
    assert!(one_by_one == at_once);
    let index = &one_by_one[Path::new("index.html")];
    for text in
        ["16 runs", "M00 boom: the dead time grows by", "broken.mcap", "is not an MCAP file", "No limits set"]
    {
        assert!(index.contains(text), "{text}");
    }
    // The page is that of `report`, and the folder a dataset.
    let log = fs::canonicalize(logs.join("M00/03.mcap")).unwrap();
    clean(folder.path(), &format!("report {} -o page.html", log.display()));
    let page = one_by_one.keys().find(|name| name.to_string_lossy().contains("M00-03-")).unwrap();
    assert!(
        fs::read_to_string(folder.path().join("page.html")).unwrap()
            == one_by_one[&page.with_extension("html")]
    );
    let drift = said(&run_line(folder.path(), "fleet drift out --by delay")).1;
    assert!(drift.contains("M00 boom: the dead time grows"), "{drift}");
}

#[test]
fn a_log_that_is_still_being_written_is_reported_when_it_is_whole() {
    let folder = empty();
    let log = folder.path().join("logs/run.mcap");
    let bytes = small_log("M00", 0, 1, [0.2, 0.2]);
    fs::write(&log, &bytes[..bytes.len() - 20]).unwrap();
    // A part of a bag that its recorder has not described yet.
    let bag = folder.path().join("logs/bag");
    fs::create_dir(&bag).unwrap();
    fs::write(bag.join("bag_0.mcap"), small_log("M01", 0, 2, [0.2, 0.2])).unwrap();
    assert!(clean(folder.path(), ONCE).contains("0 logs reported now"));
    let mut watch = start(folder.path(), "watch logs --into out --settle 0 --every 0.05");
    let mut lines = BufReader::new(watch.stdout.take().unwrap());
    until("look", || folder.path().join("out/index.html").exists());
    // At once: what is half written would be reported as it is, and then again.
    let whole = folder.path().join("whole");
    let put = |bytes: &[u8], path: &Path| {
        fs::write(&whole, bytes).unwrap();
        fs::rename(&whole, path).unwrap();
    };
    put(&bytes, &log);
    let line = next(&mut lines);
    assert!(
        line.starts_with("2026-03-01 08:00:00  M00 run.mcap: ") && line.contains(", no limits set  pages/"),
        "{line}"
    );
    let metadata =
        "rosbag2_bagfile_information:\n  storage_identifier: mcap\n  relative_file_paths: [bag_0.mcap]\n";
    // What was put there while it was looked at is reported twice.
    let mut other = || (0..2).map(|_| next(&mut lines)).find(|next| *next != line).unwrap();
    put(metadata.as_bytes(), &bag.join("metadata.yaml"));
    assert!(other().contains("M01 bag: "));
    // What changes is reported again, in the place of what was.
    put(&small_log("M00", 1, 3, [0.2, 0.2]), &log);
    let changed = other();
    assert!(changed.starts_with("2026-03-02"), "{changed}");
    put(b"no log", &log);
    assert!(next(&mut lines).starts_with("run.mcap: FAILED: "));
    assert_eq!(interrupted(watch, &mut lines).0, 3);
    assert_eq!(pages(&folder.path().join("out")).len(), 1 + 2 + 1, "no page of what failed");
    assert_eq!(cells(&folder.path().join("out"), "runs", "log_uri").len(), 2);
}

#[test]
fn a_log_that_links_lead_to_is_reported_once() {
    let folder = empty();
    let at = |name: &str| folder.path().join(name);
    fs::copy(sample("task-1-run.mcap"), at("m.mcap")).unwrap();
    for link in ["logs/a.mcap", "logs/b.mcap"] {
        std::os::unix::fs::symlink(at("m.mcap"), at(link)).unwrap();
    }
    said(&run_line(folder.path(), ONCE));
    let pages = fs::read_dir(at("out/pages")).unwrap().map(|entry| entry.unwrap().path());
    assert_eq!(pages.filter(|page| page.extension().is_some_and(|ending| ending == "json")).count(), 1);
}

#[test]
fn a_pipe_that_is_named_as_a_log_is_none() {
    let folder = empty();
    let pipe = folder.path().join("logs/pipe.csv");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let mut watch = start(folder.path(), ONCE);
    let from = Instant::now();
    while watch.try_wait().unwrap().is_none() {
        if from.elapsed() > Duration::from_secs(20) {
            // One that waits for the pipe hears nothing else.
            watch.kill().unwrap();
            panic!("no end after 20 s");
        }
        sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_log_that_its_recorder_left_is_reported_with_a_remark() {
    let folder = empty();
    let log = folder.path().join("logs/run.mcap");
    let bytes = fs::read(sample("power-loss.mcap")).unwrap();
    fs::write(&log, bytes).unwrap();
    assert!(clean(folder.path(), ONCE).contains("0 logs reported now"));
    let old = std::time::SystemTime::now() - Duration::from_secs(3600);
    fs::File::options().write(true).open(&log).unwrap().set_modified(old).unwrap();
    let (code, out, _) = said(&run_line(folder.path(), ONCE));
    assert!(code == 3 && out.contains("remark") && out.contains("one log reported now"), "{out}");
    let pages = pages(&folder.path().join("out"));
    let page =
        pages.iter().find(|(name, _)| name.starts_with("pages") && name.extension().unwrap() == "html");
    assert!(page.unwrap().1.contains("was not closed"));
}

#[test]
fn a_restart_reports_nothing_twice_and_another_request_all_again() {
    let folder = empty();
    small_fleet(&folder.path().join("logs"), 2, 2);
    fs::copy(sample("plc-trace.csv"), folder.path().join("logs/trace.csv")).unwrap();
    let out = said(&run_line(folder.path(), ONCE)).1;
    assert!(out.contains("trace.csv: ") && out.contains("5 logs reported now"), "{out}");
    let before = pages(&folder.path().join("out"));
    let (_, out, _) = said(&run_line(folder.path(), ONCE));
    assert!(out.starts_with("0 logs reported now") && pages(&folder.path().join("out")) == before, "{out}");
    // A page that is gone comes again, and nothing else.
    let page =
        before.keys().find(|name| name.extension().unwrap() == "html" && name.starts_with("pages")).unwrap();
    fs::remove_file(folder.path().join("out").join(page)).unwrap();
    assert!(said(&run_line(folder.path(), ONCE)).1.contains("one log reported now"));
    assert!(pages(&folder.path().join("out")) == before);
    let (code, out, _) = said(&run_line(folder.path(), &format!("{ONCE} --max-transition-peak-deg 90")));
    assert!(code != 4 && out.matches(", kept").count() == 5, "{code} {out}");
    let (code, out, _) = said(&run_line(folder.path(), &format!("{ONCE} --max-transition-peak-deg 0.001")));
    assert!(code == 4 && out.contains("5 of them over a limit"), "{code} {out}");
    let index = fs::read_to_string(folder.path().join("out/index.html")).unwrap();
    assert!(index.contains("5 of 5 runs NOT within limits"), "{index}");
    // Which limit, and for each run what was found against it.
    let limit = "<p>Limit on transition peak: 0.001 deg</p>";
    assert!(index.contains(limit) && index.matches(" deg, 0.001 deg allowed</p>").count() == 5, "{index}");
    // Nothing is reported in this session: no limit is broken by it.
    assert_eq!(said(&run_line(folder.path(), &format!("{ONCE} --max-transition-peak-deg 0.001"))).0, 0);
}

#[test]
fn a_watch_that_is_killed_and_begun_again_has_every_row_and_page_once() {
    let folder = empty();
    small_fleet(&folder.path().join("logs"), 3, 8);
    for round in 0_u64..3 {
        let mut watch = start(folder.path(), "watch logs --into out --settle 0 --every 0.05");
        sleep(Duration::from_millis(100 + 400 * round));
        watch.kill().unwrap();
        watch.wait().unwrap();
    }
    clean(folder.path(), ONCE);
    is_whole(&folder.path().join("out"), 24);
    clean(folder.path(), &ONCE.replace("out", "other"));
    assert!(pages(&folder.path().join("out")) == pages(&folder.path().join("other")));
    let left = fs::read_dir(folder.path().join("out/pages")).unwrap();
    assert_eq!(left.count(), 2 * 24 + 1, "pages, lines, and the lock");
}

#[test]
fn what_is_not_ours_is_not_written_over_and_two_do_not_write_at_once() {
    let folder = empty();
    let index = folder.path().join("out/index.html");
    fs::create_dir(folder.path().join("out")).unwrap();
    fs::write(&index, "<!DOCTYPE html><title>mine</title>").unwrap();
    let (code, _, error) = said(&run_line(folder.path(), ONCE));
    assert!(code == 1 && error.contains("a page that this program did not write"), "{error}");
    clean(folder.path(), &format!("{ONCE} --force"));
    // Its own it replaces.
    clean(folder.path(), ONCE);
    fs::remove_file(&index).unwrap();
    let mut watch = start(folder.path(), "watch logs --into out --json");
    let mut lines = BufReader::new(watch.stdout.take().unwrap());
    until("index", || index.exists());
    let (code, _, error) = said(&run_line(folder.path(), ONCE));
    assert!(code == 1 && error.contains("another `hydrotrace watch` is writing to out"), "{error}");
    assert_eq!(interrupted(watch, &mut lines), (0, String::new()));
    let (code, _, error) = said(&run_line(folder.path(), &ONCE.replace("logs", "nowhere")));
    assert!(code == 1 && error.contains("nowhere"), "{error}");
}

#[test]
fn a_browser_sees_the_index_and_nothing_beside_the_pages() {
    let folder = empty();
    fs::write(folder.path().join("secret.html"), "secret").unwrap();
    small_fleet(&folder.path().join("logs"), 1, 1);
    let mut watch = start(folder.path(), "watch logs --into out --settle 0 --serve=0");
    let (mut lines, mut err) = (BufReader::new(watch.stdout.take().unwrap()), String::new());
    BufReader::new(watch.stderr.as_mut().unwrap()).read_line(&mut err).unwrap();
    let address = err.split('/').nth(2).unwrap().to_owned();
    assert!(address.starts_with("127.0.0.1:"), "{err}");
    let page = next(&mut lines).split_whitespace().last().unwrap().to_owned();
    until("index", || fs::read_to_string(folder.path().join("out/index.html")).unwrap().contains(&page));
    let ask = |request: &str, host: &str| {
        let mut stream = TcpStream::connect(&address).unwrap();
        write!(stream, "{request} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n").unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        answer
    };
    let index = ask("GET /", &address);
    assert!(index.starts_with("HTTP/1.1 200 ") && index.contains("\r\nRefresh: 5\r\n"), "{index}");
    assert!(index.ends_with(&fs::read_to_string(folder.path().join("out/index.html")).unwrap()));
    let run = ask(&format!("GET /{page}"), &address);
    assert!(run.starts_with("HTTP/1.1 200 ") && !run.contains("Refresh"), "{run}");
    let head = ask("HEAD /index.html", &address);
    assert!(head.starts_with("HTTP/1.1 200 ") && !head.contains("<html"), "{head}");
    for (request, host, status) in [
        ("GET /../secret.html", address.as_str(), 404),
        ("GET /pages/../../secret.html", &address, 404),
        ("GET /pages/..%2f..%2fsecret.html", &address, 404),
        ("GET /pages/none.html", &address, 404),
        ("POST /", &address, 405),
        ("GET /", "elsewhere.example", 403),
    ] {
        let answer = ask(request, host);
        assert!(
            answer.starts_with(&format!("HTTP/1.1 {status} ")) && !answer.contains("secret"),
            "{request}: {answer}"
        );
    }
    assert_eq!(interrupted(watch, &mut lines).0, 0);
}
