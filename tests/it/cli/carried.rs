//! A plan carries its arm: its log is all that is needed, and nothing is read that a log names.

use std::{fs, path::Path};

use crate::support::{clean, run_line, said, sample, scratch, stderr};

const TIMES: &str = "--times 0,20,40,60,82,102";

/// A plan of the task on an arm with files of its own.
fn planned(folder: &Path) {
    for file in ["arm.urdf", "hydraulics.toml"] {
        fs::copy(sample("arm").join(file), folder.join(file)).unwrap();
    }
    let task = fs::read_to_string(folder.join("task-1.toml")).unwrap();
    let arm = "arm = \"arm.urdf\"\nhydraulics = \"hydraulics.toml\"";
    fs::write(folder.join("own.toml"), task.replace("arm = \"sample\"", arm)).unwrap();
    clean(folder, &format!("plan own.toml {TIMES} -o plan.mcap"));
}

/// What `simulate` and then `replan` make of the plan in a folder.
fn next(folder: &Path) -> [Vec<u8>; 2] {
    for line in ["simulate plan.mcap -o run.mcap", "replan run.mcap --evaluations 1000 -o next.mcap"] {
        let (code, _, error) = said(&run_line(folder, line));
        assert!(code == 0 || code == 3, "{line}: {error}");
        assert!(!error.contains("other-file"), "{error}");
    }
    ["run.mcap", "next.mcap"].map(|file| fs::read(folder.join(file)).unwrap())
}

#[test]
fn a_log_that_was_moved_gives_the_same_run_and_the_same_next_plan() {
    let (home, away) = (scratch(), tempfile::tempdir().unwrap());
    planned(home.path());
    fs::copy(home.path().join("plan.mcap"), away.path().join("plan.mcap")).unwrap();
    let [run, plan] = next(home.path());
    let [moved_run, moved_plan] = next(away.path());
    assert!(run == moved_run && plan == moved_plan);
    assert_eq!(fs::read_dir(away.path()).unwrap().count(), 3);
    let recording = hydrotrace::log::read_plan(
        &[away.path().join("next.mcap")],
        &hydrotrace::log::ReadOptions::default(),
    )
    .unwrap();
    let hashes = &recording.metadata["hydrotrace.plan"];
    for name in ["task.toml", "robot.urdf", "hydraulics.toml", "plan.json"] {
        let file = recording.attachments.iter().find(|file| file.name == name).unwrap();
        assert!(!file.data.is_empty() && hashes[&format!("sha256.{name}")].len() == 64, "{name}");
    }
}

#[test]
fn another_arm_beside_the_log_is_noticed_and_not_used() {
    let folder = scratch();
    let path = folder.path();
    planned(path);
    let [run, _] = next(path);
    let urdf = fs::read_to_string(path.join("arm.urdf")).unwrap();
    let heavy = urdf.replacen("mass value=\"", "mass value=\"9", 1);
    assert_ne!(urdf, heavy);
    fs::write(path.join("arm.urdf"), heavy).unwrap();
    for line in ["simulate plan.mcap -o again.mcap", "replan run.mcap --evaluations 1000 -o again-next.mcap"]
    {
        let said = run_line(path, line);
        assert_eq!(said.status.code(), Some(3), "{line}: {}", stderr(&said));
        let text = String::from_utf8_lossy(&said.stdout).into_owned() + &stderr(&said);
        assert!(text.contains("other-file x1") && text.contains("arm.urdf beside the log"), "{line}: {text}");
    }
    assert!(fs::read(path.join("again.mcap")).unwrap() == run);
}

#[test]
fn what_a_log_names_is_not_read() {
    let folder = scratch();
    let path = folder.path();
    let task = fs::read_to_string(path.join("task-1.toml")).unwrap();
    planned(path);
    for named in ["/dev/zero", "../secret.urdf", "/etc/passwd"] {
        let text = task.replace("arm = \"sample\"", &format!("arm = \"{named}\""));
        let log = with_task(&text);
        fs::write(path.join("hostile.mcap"), log).unwrap();
        for line in ["simulate hostile.mcap -o x.mcap", "replan hostile.mcap -o x.mcap"] {
            let (code, _, error) = said(&run_line(path, line));
            assert_eq!(code, 1, "{line}: {error}");
            let known = error.contains("which the log does not hold") || line.starts_with("replan");
            assert!(known && error.len() < 1000, "{line}: {error}");
        }
    }
}

#[test]
fn a_file_in_a_log_that_is_not_the_one_that_was_written_is_noticed() {
    use std::collections::BTreeMap;
    let folder = scratch();
    let task = fs::read_to_string(folder.path().join("task-1.toml")).unwrap();
    let sound = format!("{:x}", <sha2::Sha256 as sha2::Digest>::digest(&task));
    for (hash, noticed) in [(sound, false), ("0".repeat(64), true)] {
        let entries = BTreeMap::from([("sha256.task.toml".to_owned(), hash)]);
        fs::write(folder.path().join("run.mcap"), with_task_and(&task, &entries)).unwrap();
        let (_, text, error) = said(&run_line(folder.path(), "report run.mcap"));
        let says = text.contains("task.toml in the log is not the one that was written");
        assert_eq!(says, noticed, "{text} {error}");
    }
}

/// A log of a short plan with this task attached.
fn with_task(task: &str) -> Vec<u8> {
    with_task_and(task, &std::collections::BTreeMap::new())
}

/// The same with these entries of the plan's provenance.
fn with_task_and(task: &str, provenance: &std::collections::BTreeMap<String, String>) -> Vec<u8> {
    use hydrotrace::log::{LogWriter, Role, WriteOptions};
    let mut log = LogWriter::new(Vec::new(), &["joint_1"], WriteOptions::default()).unwrap();
    log.metadata("hydrotrace.plan", provenance).unwrap();
    for k in 0..400_i32 {
        let stamp_ns = 1_760_000_000_000_000_000 + i64::from(k) * 10_000_000;
        let angle_rad = 0.1 * (0.01 * f64::from(k) - 1.0).clamp(0.0, 2.0);
        for role in [Role::Planned, Role::Measured] {
            log.joint_sample(role, stamp_ns, &[angle_rad], &[], &[]).unwrap();
        }
    }
    log.attach("task.toml", "application/toml", task.as_bytes(), 0).unwrap();
    log.finish().unwrap()
}
