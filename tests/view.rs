//! What `view` shows of a log, and what it says where it cannot.
#![allow(clippy::unwrap_used, reason = "what fails here fails the test")]

use std::{
    path::{Path, PathBuf},
    process::Command,
};

use hydrotrace::{
    arm::Arm,
    log::{LogWriter, Role, WriteOptions},
    workflow::view::{ArmOrigin, Inputs, Scene, run},
};

const JOINTS: [&str; 6] = ["J1", "J2", "J3", "J4", "J5", "J6"];

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("sample-logs").join(name)
}

fn seen(logs: &[PathBuf]) -> Vec<Scene> {
    run(&Inputs { logs: logs.to_vec(), ..Inputs::default() }).unwrap()
}

/// A plan of the sample arm, and the run of it where `measured`, with an arm described or not.
fn log(path: &Path, measured: bool, description: Option<&str>) {
    let mut log = LogWriter::new(Vec::new(), &JOINTS, WriteOptions::default()).unwrap();
    if let Some(text) = description {
        log.description(Role::Measured, 0, text).unwrap();
    }
    for k in 0..300_i64 {
        let stamp_ns = k * 10_000_000;
        let swing = 0.1 * (0.01 * k as f64).sin();
        let planned = [1.0, 1.5, -0.5, 0.1, 0.1, 0.1].map(|q| q + swing);
        log.joint_sample(Role::Planned, stamp_ns, &planned, &[], &[]).unwrap();
        if measured {
            log.joint_sample(Role::Measured, stamp_ns, &planned.map(|q| q - 0.01), &[], &[]).unwrap();
        }
    }
    std::fs::write(path, log.finish().unwrap()).unwrap();
}

#[test]
fn every_link_is_where_the_forward_kinematics_of_the_samples_put_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    log(&path, true, None);
    let scene = seen(&[path]).remove(0);
    let (chain, arm) = (Arm::sample().unwrap().chain, scene.arm.unwrap());
    assert_eq!(arm.source, ArmOrigin::Sample);
    for (series, poses) in [(&scene.planned, &arm.planned), (&scene.measured, &arm.measured)] {
        assert_eq!(poses.t_s.len(), 150, "3 s at 50 Hz");
        for (t_s, links) in poses.t_s.iter().zip(&poses.poses) {
            let angles_rad: Vec<f64> =
                JOINTS.iter().map(|name| series.track(name).unwrap().at(*t_s).unwrap().position).collect();
            for (found, expected) in links.iter().zip(chain.link_poses(&angles_rad)) {
                assert!((found.translation.vector - expected.translation.vector).norm() < 1e-12);
            }
            assert_eq!(links.len(), arm.links.len());
        }
    }
    assert!(arm.planned.poses != arm.measured.poses);
}

#[test]
fn a_plan_that_nobody_ran_is_shown_alone_and_runs_of_one_name_stay_apart() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = ["a", "b"].map(|name| folder.path().join(name));
    for folder in [&a, &b] {
        std::fs::create_dir(folder).unwrap();
    }
    let (plan, ran) = (a.join("run.mcap"), b.join("run.mcap"));
    log(&plan, false, None);
    log(&ran, true, None);
    let scenes = seen(&[plan, ran]);
    assert_eq!([scenes[0].name.as_str(), scenes[1].name.as_str()], ["run", "run-2"]);
    let arm = scenes[0].arm.as_ref().unwrap();
    assert!(arm.measured.poses.is_empty() && !arm.planned.poses.is_empty());
    assert!(scenes[0].pairs.is_empty() && scenes[0].transitions.is_empty());
    assert_eq!(scenes[1].pairs.len(), 6);
}

#[test]
fn the_arm_in_the_log_comes_first_and_one_of_other_joints_is_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let text = std::fs::read_to_string(sample("arm/arm.urdf")).unwrap();
    log(&path, true, Some(&text));
    let of = |path: &Path| seen(&[path.to_owned()]).remove(0).arm.map(|arm| arm.source);
    assert_eq!(of(&path), Some(ArmOrigin::Log));
    log(&path, true, Some("no URDF at all"));
    assert_eq!(of(&path), Some(ArmOrigin::Sample));
    assert_eq!(of(&sample("gaps.mcap")), None);
}

#[test]
fn the_same_logs_are_seen_the_same_way_twice() {
    let [a, b] = [0, 1].map(|_| seen(&[sample("panel-install.mcap")]).remove(0));
    assert_eq!((a.planned, a.pairs, a.transitions), (b.planned, b.pairs, b.transitions));
    assert_eq!(a.arm.map(|arm| arm.measured), b.arm.map(|arm| arm.measured));
}

#[cfg(not(feature = "viewer"))]
#[test]
fn a_build_without_the_viewer_names_the_command_that_adds_it_and_the_way_without() {
    let run = Command::new(env!("CARGO_BIN_EXE_hydrotrace"))
        .args(["view".as_ref(), sample("panel-install.mcap").as_os_str()])
        .output()
        .unwrap();
    let said = String::from_utf8(run.stderr).unwrap();
    assert_eq!(run.status.code(), Some(1), "{said}");
    for expected in ["cargo install --path . --features viewer", "pip install rerun-sdk==", "rerun run.mcap"]
    {
        assert!(said.contains(expected), "{said}");
    }
    assert!(run.stdout.is_empty());
}

#[cfg(feature = "viewer")]
#[test]
fn a_sample_log_is_saved_for_the_viewer() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.rrd");
    let run = Command::new(env!("CARGO_BIN_EXE_hydrotrace"))
        .args([
            "view".as_ref(),
            sample("panel-install.mcap").as_os_str(),
            "--save".as_ref(),
            path.as_os_str(),
        ])
        .output()
        .unwrap();
    assert!(matches!(run.status.code(), Some(0 | 3)), "{}", String::from_utf8_lossy(&run.stderr));
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(&bytes[..4], b"RRF2");
    assert!(bytes.len() > 100_000, "{}", bytes.len());
}
