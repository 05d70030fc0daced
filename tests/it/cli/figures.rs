//! `--figures` of the built binary: which files it writes, what is in them, what is left where it fails.

use std::{collections::BTreeMap, fs, path::Path};

use hydrotrace::log::{LogWriter, Role, WriteOptions};

use crate::support::run_at_root as hydrotrace;

const RUN: &str = "sample-logs/task-1-run.mcap";
const CHANGED: &str = "sample-logs/precompensated-run.mcap";
const TASK: &str = "sample-logs/tasks/task-1.toml";
const TIMES: &str = "0,5.5,10,15.2,23,27";

/// What a verb writes with `--figures` into a new folder, by name.
fn figures(args: &[&str]) -> BTreeMap<String, Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join("new/figures");
    let run = hydrotrace(&[args, &["--figures", to.to_str().unwrap()]].concat());
    assert!(matches!(run.status.code(), Some(0 | 3)), "{}", String::from_utf8_lossy(&run.stderr));
    files(&to)
}

fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(Result::unwrap);
    entries.map(|f| (f.file_name().into_string().unwrap(), fs::read(f.path()).unwrap())).collect()
}

fn names(files: &BTreeMap<String, Vec<u8>>) -> Vec<&str> {
    files.keys().map(String::as_str).collect()
}

/// The root, and all texts within.
fn svg(bytes: &[u8]) -> (xml::Element, Vec<String>) {
    let root: xml::Element = std::str::from_utf8(bytes).unwrap().parse().unwrap();
    let texts =
        root.get_children("text", root.ns.as_deref()).map(|text| text.content_str().trim().to_owned());
    let texts = texts.collect();
    (root, texts)
}

/// A log of one joint of this name, which rests, moves and is followed with some lag.
fn log(path: &Path, joint: &str) {
    let mut log = LogWriter::new(Vec::new(), &[joint], WriteOptions::default()).unwrap();
    let angle = |t_s: f64| 0.2 * (1.0 - (t_s - 1.0).clamp(0.0, std::f64::consts::PI).cos());
    for k in 0..600_i64 {
        let (stamp_ns, t_s) = (k * 10_000_000, 0.01 * k as f64);
        log.joint_sample(Role::Planned, stamp_ns, &[angle(t_s)], &[], &[]).unwrap();
        log.joint_sample(Role::Measured, stamp_ns, &[angle(t_s - 0.2)], &[], &[]).unwrap();
    }
    fs::write(path, log.finish().unwrap()).unwrap();
}

#[test]
fn every_verb_writes_the_plots_of_its_page() {
    let report = figures(&["report", RUN]);
    let expected: Vec<String> = (1..=6).map(|k| format!("joint-{k:02}-J{k}.svg")).collect();
    let mut expected: Vec<&str> = expected.iter().map(String::as_str).collect();
    expected.extend(["lag.svg", "tool.svg", "transitions-01.svg", "transitions-02.svg"]);
    // The log carries the plans that its own was chosen from.
    expected.splice(0..0, ["front-jerk-power.svg", "front-time-jerk.svg", "front-time-power.svg"]);
    assert_eq!(names(&report), expected);

    let compare = figures(&["compare", RUN, CHANGED]);
    let expected: Vec<String> = (1..=6).map(|k| format!("error-{k:02}-J{k}.svg")).collect();
    let mut all: Vec<&str> = expected.iter().map(String::as_str).collect();
    all.extend(["pairs-peak-error.svg", "pairs-rms-error.svg", "pairs-start-delay.svg"]);
    all.insert(0, "change-of-peak-error.svg");
    assert_eq!(names(&compare), all);

    let motions: Vec<String> = (1..=6).map(|k| format!("motion-{k:02}-J{k}.svg")).collect();
    let times = figures(&["plan", TASK, "--times", TIMES]);
    assert_eq!(names(&times), motions);
    let plan = figures(&["plan", TASK, "--evaluations", "1000"]);
    let fronts = ["convergence", "front-jerk-power", "front-time-jerk", "front-time-power"];
    let all: Vec<String> = fronts.iter().map(|name| format!("{name}.svg")).chain(motions).collect();
    assert_eq!(names(&plan), all);

    for (name, bytes) in report.iter().chain(&compare).chain(&plan) {
        let (root, texts) = svg(bytes);
        let wide = if name.starts_with("transitions") { "180mm" } else { "85mm" };
        assert_eq!(root.get_attribute("width", None), Some(wide), "{name}");
        let named = |label: &&String| {
            label.ends_with(')') || ["Evaluations", "Hypervolume"].contains(&label.as_str())
        };
        assert!(texts.iter().filter(named).count() >= 1, "{name} has axes without units: {texts:?}");
    }
}

#[test]
fn a_joint_whose_name_is_markup_and_a_path_becomes_text_and_a_plain_file() {
    let folder = tempfile::tempdir().unwrap();
    let [before, after] = ["a.mcap", "b.mcap"].map(|name| folder.path().join(name));
    let name = "../../</text><script>\u{7}&\"'";
    log(&before, name);
    log(&after, name);
    let [before, after] = [&before, &after].map(|path| path.to_str().unwrap());
    for args in [&["report", before][..], &["compare", before, after]] {
        let files = figures(args);
        assert!(files.len() >= 3, "{args:?}: {:?}", names(&files));
        for (file, bytes) in &files {
            assert!(file.chars().all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c)), "{file}");
            assert!(!file.contains(".."), "{file}");
            let (root, texts) = svg(bytes);
            assert!(root.get_children("script", root.ns.as_deref()).next().is_none(), "{file}");
            let title = root.get_child("title", root.ns.as_deref()).map(xml::Element::content_str);
            let said = title.into_iter().chain(texts).any(|text| text.contains("../../</te"));
            assert!(said || file.starts_with("pairs"), "{file}");
        }
    }
}

#[test]
fn where_the_folder_is_no_folder_nothing_is_left_and_the_old_file_stands() {
    let folder = tempfile::tempdir().unwrap();
    let taken = folder.path().join("taken");
    fs::write(&taken, "old").unwrap();
    for to in [taken.clone(), taken.join("below")] {
        for args in [&["report", RUN][..], &["compare", RUN, CHANGED], &["plan", TASK, "--times", TIMES]] {
            let run = hydrotrace(&[args, &["--figures", to.to_str().unwrap()]].concat());
            assert_eq!((run.status.code(), run.stdout.len()), (Some(1), 0));
            let said = String::from_utf8(run.stderr).unwrap();
            assert!(said.contains("cannot make the folder") && said.contains("taken"), "{said}");
        }
    }
    assert_eq!(names(&files(folder.path())), ["taken"]);
    assert_eq!(fs::read_to_string(taken).unwrap(), "old");
}

#[test]
fn a_figure_that_cannot_be_replaced_leaves_no_half_of_it() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("lag.svg")).unwrap();
    let run = hydrotrace(&["report", RUN, "--figures", folder.path().to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(1));
    assert!(String::from_utf8(run.stderr).unwrap().contains("lag.svg is a folder"));
    for entry in fs::read_dir(folder.path()).unwrap().map(Result::unwrap) {
        let name = entry.file_name().into_string().unwrap();
        assert!(!name.starts_with('.'), "{name}");
        assert!(name == "lag.svg" || fs::read_to_string(entry.path()).unwrap().ends_with("</svg>"), "{name}");
    }
}

#[test]
fn pixels_without_a_folder_or_of_no_sense_are_bad_usage() {
    for args in [
        &["--figures-png"][..],
        &["--figures", "x", "--figures-png=0"],
        &["--figures", "x", "--figures-png=a"],
    ] {
        assert_eq!(hydrotrace(&[&["report", RUN], args].concat()).status.code(), Some(2), "{args:?}");
    }
}

/// Width, height and pixels a metre of a PNG file.
#[cfg(feature = "png")]
fn measures(bytes: &[u8]) -> [u32; 3] {
    assert_eq!(bytes[..8], *b"\x89PNG\r\n\x1a\n");
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    let physical = bytes.windows(4).position(|word| word == b"pHYs").unwrap();
    assert_eq!(bytes[physical + 12], 1, "per metre");
    [number(16), number(20), number(physical + 4)]
}

#[cfg(feature = "png")]
#[test]
fn pixels_stand_beside_the_lines_and_have_their_size_on_paper() {
    for (option, dots_per_inch, per_metre) in
        [("--figures-png", 300.0, 11811), ("--figures-png=600", 600.0, 23622)]
    {
        let files = figures(&["report", RUN, option]);
        let lines: Vec<&str> =
            names(&files).into_iter().filter_map(|name| name.strip_suffix(".svg")).collect();
        let pixels: Vec<&str> =
            names(&files).into_iter().filter_map(|name| name.strip_suffix(".png")).collect();
        assert_eq!(lines, pixels);
        for name in lines {
            let (root, _) = svg(&files[&format!("{name}.svg")]);
            let [wide, high, metre] = measures(&files[&format!("{name}.png")]);
            assert_eq!(metre, per_metre);
            for (attribute, pixels) in [("width", wide), ("height", high)] {
                let mm = root.get_attribute(attribute, None).unwrap().strip_suffix("mm").unwrap();
                let exact = mm.parse::<f64>().unwrap() / 25.4 * dots_per_inch;
                assert!((f64::from(pixels) - exact).abs() <= 1.0, "{name}: {pixels}, not {exact}");
            }
        }
    }
}

#[cfg(feature = "png")]
#[test]
fn what_the_font_of_the_pixels_lacks_is_said_and_is_no_failure() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    log(&path, "\u{81c2}1");
    let to = folder.path().join("figures");
    let [path, to] = [&path, &to].map(|path| path.to_str().unwrap());
    let run = hydrotrace(&["report", path, "--figures", to, "--figures-png"]);
    let without = hydrotrace(&["report", path, "--figures", to]);
    assert_eq!(run.status.code(), without.status.code());
    let [said, without] = [run.stderr, without.stderr].map(|said| String::from_utf8(said).unwrap());
    let lacking = "PNG figures show boxes for \u{81c2}, which their font lacks; the SVG files have them\n";
    assert_eq!(said, format!("{lacking}{without}"));
}

#[cfg(feature = "png")]
#[test]
fn equal_calls_give_equal_figures() {
    let files = || figures(&["compare", RUN, CHANGED, "--figures-png"]);
    assert!(files() == files());
}

#[cfg(not(feature = "png"))]
#[test]
fn a_build_without_pixels_names_the_command_that_adds_them_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join("figures");
    for args in [&["report", RUN][..], &["compare", RUN, CHANGED], &["plan", TASK]] {
        let run = hydrotrace(&[args, &["--figures", to.to_str().unwrap(), "--figures-png"]].concat());
        assert_eq!(run.status.code(), Some(1));
        assert!(String::from_utf8(run.stderr).unwrap().contains("cargo install --path . --features png"));
        assert!(!to.exists());
    }
}
