//! Layouts for Foxglove: every panel draws what the log holds, and nothing else.

use std::{collections::BTreeSet, fs, path::Path};

use hydrotrace::log::{LogWriter, Role, Transform, WriteOptions};
use serde_json::Value;

use crate::support::{clean, run_line, said, sample, scratch};

/// Reads CDR of the types that our own logs have.
struct Cdr<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Cdr<'_> {
    fn u32(&mut self) -> usize {
        self.at = self.at.next_multiple_of(4);
        let bytes: [u8; 4] = self.bytes[4..][self.at..][..4].try_into().unwrap();
        self.at += 4;
        u32::from_le_bytes(bytes) as usize
    }

    fn text(&mut self) -> String {
        let length = self.u32();
        let text = self.bytes[4..][self.at..][..length - 1].to_vec();
        self.at += length;
        String::from_utf8(text).unwrap()
    }

    fn texts(&mut self) -> Vec<String> {
        (0..self.u32()).map(|_| self.text()).collect()
    }

    fn numbers(&mut self) -> Vec<f64> {
        let count = self.u32();
        if count > 0 {
            self.at = self.at.next_multiple_of(8);
        }
        let bytes = &self.bytes[4..][self.at..][..8 * count];
        self.at += 8 * count;
        bytes.chunks(8).map(|eight| f64::from_le_bytes(eight.try_into().unwrap())).collect()
    }
}

/// The joint and the number that a path of one of our logs leads to in a message.
fn followed(type_name: &str, data: &[u8], steps: &str) -> (String, f64) {
    let mut cdr = Cdr { bytes: data, at: 0 };
    let _stamp = [cdr.u32(), cdr.u32()];
    let _frame = cdr.text();
    let names = cdr.texts();
    let place = |text: &str| text.trim_end_matches(']').parse::<usize>().unwrap();
    let steps = steps.trim_end_matches(".@rad2deg");
    match type_name {
        "sensor_msgs/msg/JointState" => {
            let lists = [cdr.numbers(), cdr.numbers(), cdr.numbers()];
            let (field, at) = steps.split_once('[').unwrap();
            let field = [".position", ".velocity", ".effort"].iter().position(|name| *name == field).unwrap();
            (names[place(at)].clone(), lists[field][place(at)])
        }
        "control_msgs/msg/DynamicJointState" => {
            let values: Vec<Vec<f64>> = (0..cdr.u32()).map(|_| (cdr.texts(), cdr.numbers()).1).collect();
            let (joint, value) =
                steps.strip_prefix(".interface_values[").unwrap().split_once("].values[").unwrap();
            (names[place(joint)].clone(), values[place(joint)][place(value)])
        }
        other => panic!("{other}"),
    }
}

fn layout(folder: &Path, log: &str) -> Value {
    let (code, text, error) = said(&run_line(folder, &format!("export {log} --foxglove-layout layout.json")));
    assert!(matches!(code, 0 | 3), "{text}{error}");
    serde_json::from_str(&fs::read_to_string(folder.join("layout.json")).unwrap()).unwrap()
}

/// Ids of panels that a part of a layout shows.
fn shown(node: &Value, into: &mut BTreeSet<String>) {
    match node {
        Value::String(id) => assert!(into.insert(id.clone()), "{id} twice"),
        Value::Null => {}
        node => ["first", "second"].iter().for_each(|side| shown(&node[side], into)),
    }
}

/// All panels, each of which is shown once.
fn panels(layout: &Value) -> Vec<(String, Value)> {
    let all = layout["configById"].as_object().unwrap();
    let mut ids = BTreeSet::new();
    shown(&layout["layout"], &mut ids);
    for panel in all.values() {
        panel["tabs"].as_array().into_iter().flatten().for_each(|tab| shown(&tab["layout"], &mut ids));
    }
    assert_eq!(ids, all.keys().cloned().collect());
    all.iter().map(|(id, panel)| (id.clone(), panel.clone())).collect()
}

/// Every path of every plot leads to a number of its joint; returns how many there are.
fn check(folder: &Path, log: &str) -> usize {
    let bytes = fs::read(folder.join(log)).unwrap();
    let messages: Vec<mcap::Message<'_>> =
        mcap::MessageStream::new(&bytes).unwrap().map(Result::unwrap).collect();
    let mut count = 0;
    for (id, panel) in panels(&layout(folder, log)) {
        let Some(paths) = panel["paths"].as_array() else { continue };
        assert!(!paths.is_empty(), "{id} is empty");
        for path in paths {
            let value = path["value"].as_str().unwrap();
            let (topic, steps) = value.split_at(value.find('.').unwrap());
            let message = messages.iter().find(|message| message.channel.topic == topic).expect(topic);
            let type_name = &message.channel.schema.as_ref().unwrap().name;
            if type_name.ends_with("JointTrajectoryControllerState") {
                // Its lists are of messages that are built by hand in the tests of the reader.
                continue;
            }
            let (joint, number) = followed(type_name, &message.data, steps);
            let (title, label) =
                (panel["foxglovePanelTitle"].as_str().unwrap(), path["label"].as_str().unwrap());
            let worst = format!("Worst start: {joint},");
            assert!(title == joint || label == joint || title.starts_with(&worst), "{id} {value}: {joint}");
            assert!(number.is_finite(), "{value}");
            count += 1;
        }
    }
    count
}

#[test]
fn every_path_of_a_layout_leads_to_a_number_of_its_joint() {
    let folder = scratch();
    for (name, least) in
        [("pressures-run", 50), ("still-joint", 18), ("panel-install", 18), ("gaps", 18), ("power-loss", 18)]
    {
        let log = format!("{name}.mcap");
        fs::copy(sample(&log), folder.path().join(&log)).unwrap();
        if name == "power-loss" {
            // Whose end the crate `mcap` does not read past.
            layout(folder.path(), &log);
            continue;
        }
        let count = check(folder.path(), &log);
        assert!(count >= least, "{name}: {count}");
    }
}

/// A log with all that a layout draws.
fn full(path: &Path) {
    let mut log = LogWriter::new(Vec::new(), &["boom", "stick"], WriteOptions::default()).unwrap();
    let urdf = "<robot name=\"r\"><link name=\"base\"/></robot>";
    log.description(Role::Measured, 10_000_000, urdf).unwrap();
    let place = Transform {
        parent: "world",
        child: "base",
        translation_m: [0.0; 3],
        rotation_xyzw: [0.0, 0.0, 0.0, 1.0],
    };
    log.transforms(10_000_000, &[place]).unwrap();
    for k in 0..400_i64 {
        // A stamp of zero is none.
        let ns = (k + 1) * 10_000_000;
        let swing = 0.2 * (0.01 * (k - 100).max(0) as f64).sin();
        let (planned, measured) = ([swing, 0.5], [0.9 * swing, 0.5]);
        log.joint_sample(Role::Planned, ns, &planned, &[0.1, 0.0], &[]).unwrap();
        log.joint_sample(Role::Measured, ns, &measured, &[], &[3.0, 4.0]).unwrap();
        log.tracking_error(ns, &[planned[0] - measured[0], 0.0]).unwrap();
    }
    fs::write(path, log.finish().unwrap()).unwrap();
}

#[test]
fn a_layout_has_the_arm_the_error_and_the_worst_start_where_the_log_does_and_the_same_bytes() {
    let folder = scratch();
    full(&folder.path().join("full.mcap"));
    let found = panels(&layout(folder.path(), "full.mcap"));
    let ids: Vec<&str> = found.iter().map(|(id, _)| id.as_str()).collect();
    let expected = [
        "3D!arm", "Plot!effort1", "Plot!error1", "Plot!position1", "Plot!position2", "Plot!speed1",
        "Plot!speed2", "Plot!worst", "Tab!signals",
    ];
    assert_eq!(ids, expected);
    let panel = |id: &str| &found.iter().find(|(known, _)| known == id).unwrap().1;
    assert_eq!(panel("3D!arm")["layers"]["robot1"]["topic"], "/robot_description");
    let worst = panel("Plot!worst");
    let window_s = ["minXValue", "maxXValue"].map(|end| worst[end].as_f64().unwrap());
    assert!(window_s[0] < 1.0 && window_s[1] > 1.0 && window_s[1] < 10.0, "{window_s:?}");
    assert_eq!((&worst["isSynced"], &panel("Plot!error1")["isSynced"]), (&false.into(), &true.into()));
    assert!(check(folder.path(), "full.mcap") >= 10);
    let first = fs::read(folder.path().join("layout.json")).unwrap();
    layout(folder.path(), "full.mcap");
    assert_eq!(first, fs::read(folder.path().join("layout.json")).unwrap());
    assert_eq!(clean(folder.path(), "export full.mcap --foxglove-layout -").as_bytes(), first);
}

#[test]
fn a_layout_has_no_panel_for_what_the_log_does_not_hold() {
    let folder = scratch();
    fs::copy(sample("panel-install.mcap"), folder.path().join("run.mcap")).unwrap();
    for (id, panel) in panels(&layout(folder.path(), "run.mcap")) {
        assert!(!["3D", "valve", "pressure", "effort"].iter().any(|part| id.contains(part)), "{id}");
        let empty = "/joint_states.velocity";
        let paths = panel["paths"].as_array().into_iter().flatten();
        paths.for_each(|path| assert!(!path["value"].as_str().unwrap().starts_with(empty), "{path}"));
    }
    fs::copy(sample("trajectory-only.mcap"), folder.path().join("whole.mcap")).unwrap();
    let (code, _, error) = said(&run_line(folder.path(), "export whole.mcap --foxglove-layout whole.json"));
    assert_eq!(code, 3);
    assert!(error.contains("remark: not-supported") && error.contains("hydrotrace import"), "{error}");
}

#[test]
fn a_layout_is_refused_for_tables_for_logs_without_joints_and_over_an_input() {
    let folder = scratch();
    fs::copy(sample("plc-trace.csv"), folder.path().join("trace.csv")).unwrap();
    fs::copy(sample("still-joint.mcap"), folder.path().join("run.mcap")).unwrap();
    let refused = |line: &str, code: i32, words: &[&str]| {
        let (found, text, error) = said(&run_line(folder.path(), line));
        assert_eq!((found, text.as_str()), (code, ""), "{line}: {error}");
        words.iter().for_each(|word| assert!(error.contains(word), "{line}: {error}"));
    };
    let table = ["is a table, which Foxglove does not open", "hydrotrace import trace.csv -o run.mcap"];
    refused("export trace.csv --foxglove-layout layout.json", 1, &table);
    refused("export run.mcap --foxglove-layout run.mcap", 1, &["is an input of this command"]);
    refused("export run.mcap --foxglove-layout a.json --csv", 2, &["cannot be used with"]);
    refused("export run.mcap --foxglove-layout a.json --command /nowhere", 1, &["/nowhere"]);
    assert!(!folder.path().join("layout.json").exists());
    #[cfg(not(feature = "viewer"))]
    refused("export run.mcap --rerun-blueprint run.rbl", 1, &["cargo install --path . --features viewer"]);
    #[cfg(feature = "viewer")]
    {
        let said = clean(folder.path(), "export run.mcap --rerun-blueprint run.rbl");
        assert_eq!(said, "run.rbl written; rerun run.mcap run.rbl opens both.\n");
        assert!(fs::read(folder.path().join("run.rbl")).unwrap().starts_with(b"RRF2"));
        refused("export run.mcap --rerun-blueprint run.mcap", 1, &["is an input of this command"]);
    }
}
