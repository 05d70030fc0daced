//! What `view` shows of a log, and what it says where it cannot.

use std::path::{Path, PathBuf};

use hydrotrace::{
    arm::Arm,
    log::{LogWriter, Role, WriteOptions},
    remark::Code,
    workflow::view::{ArmOrigin, Inputs, Scene, ViewFailure, run},
};

use crate::support::{command, root, sample};

const JOINTS: [&str; 6] = ["J1", "J2", "J3", "J4", "J5", "J6"];

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

/// An arm of one joint of the log, beneath a joint that is in no log, whose links have meshes.
const MESHES: &str = r#"<robot name="r"><link name="base"/>
  <link name="mast"><visual><geometry><mesh filename="package://crane/meshes/mast.stl"/></geometry></visual></link>
  <link name="boom"><visual><geometry><mesh filename="package://crane/meshes/boom.stl"/></geometry></visual></link>
  <joint name="slew" type="continuous"><parent link="base"/><child link="mast"/><axis xyz="0 0 1"/></joint>
  <joint name="J2" type="continuous"><parent link="mast"/><child link="boom"/><origin xyz="0 0 3"/>
    <axis xyz="0 1 0"/></joint></robot>"#;

#[test]
fn an_arm_that_is_given_is_drawn_with_the_meshes_around_it_and_what_is_missing_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let (path, package) = (folder.path().join("run.mcap"), folder.path().join("crane"));
    log(&path, true, Some(&std::fs::read_to_string(sample("arm/arm.urdf")).unwrap()));
    for name in ["urdf", "meshes"] {
        std::fs::create_dir_all(package.join(name)).unwrap();
    }
    let (urdf, mast) = (package.join("urdf/crane.urdf"), package.join("meshes/mast.stl"));
    std::fs::write(&urdf, MESHES).unwrap();
    std::fs::write(&mast, "solid mast\nendsolid mast\n").unwrap();
    let inputs = Inputs { logs: vec![path], urdf: Some(urdf.clone()), ..Inputs::default() };
    let scene = run(&inputs).unwrap().remove(0);
    let arm = scene.arm.unwrap();
    assert_eq!(
        (arm.source, arm.links.as_slice()),
        (ArmOrigin::File, ["base", "mast", "boom"].map(str::to_owned).as_slice())
    );
    assert_eq!(arm.meshes.iter().map(|(mesh, _)| mesh.link).collect::<Vec<_>>(), [1]);
    assert_eq!(arm.meshes[0].1.canonicalize().unwrap(), mast.canonicalize().unwrap());
    assert!(
        !arm.shapes.is_empty() && arm.shapes.iter().all(|shape| shape.link == 2),
        "only the boom has blocks"
    );
    let said: Vec<(Code, u64)> =
        scene.remarks.as_slice().iter().map(|remark| (remark.code, remark.count)).collect();
    assert!(said.ends_with(&[(Code::Guessed, 1), (Code::MissingFile, 1)]), "{said:?}");

    std::fs::write(&urdf, MESHES.replace("J2", "other")).unwrap();
    assert!(matches!(run(&inputs), Err(ViewFailure::Arm { joints, .. }) if joints == JOINTS));
    std::fs::remove_file(&urdf).unwrap();
    assert!(matches!(run(&inputs), Err(ViewFailure::Read { .. })));
}

#[test]
fn the_eye_sees_the_whole_arm_all_the_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    log(&path, true, None);
    for path in [path, sample("task-1-run.mcap")] {
        let arm = seen(&[path]).remove(0).arm.unwrap();
        let sight = arm.sight().unwrap();
        let [from_m, to_m] = [sight.from_m, sight.to_m].map(nalgebra::Vector3::from);
        for pose in arm.planned.poses.iter().chain(&arm.measured.poses).flatten() {
            let angle_rad = (pose.translation.vector - from_m).angle(&(to_m - from_m));
            // Half of what Rerun's eye sees across is 27.5 degrees.
            assert!(angle_rad < 27.5_f64.to_radians(), "{angle_rad} rad");
        }
    }
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
    let run =
        command(root()).args(["view".as_ref(), sample("panel-install.mcap").as_os_str()]).output().unwrap();
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
    let run = command(root())
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

#[cfg(feature = "viewer")]
fn view(arguments: &[&str], path: &Path) -> (Option<i32>, String) {
    let log = sample("panel-install.mcap");
    let run = command(root())
        .args(["view".as_ref(), log.as_os_str()])
        .args(arguments)
        .env("PATH", path)
        .output()
        .unwrap();
    (run.status.code(), String::from_utf8(run.stderr).unwrap())
}

#[cfg(feature = "viewer")]
#[test]
fn without_the_program_rerun_the_command_that_brings_it_is_named() {
    let nothing = tempfile::tempdir().unwrap();
    for target in ["--spawn", "--web"] {
        // A viewer that listens here would be used.
        if target == "--spawn" && std::net::TcpStream::connect("127.0.0.1:9876").is_ok() {
            continue;
        }
        let (code, said) = view(&[target], nothing.path());
        assert_eq!(code, Some(1), "{said}");
        assert!(said.contains("pip install rerun-sdk==0.36.3"), "{said}");
    }
}

#[cfg(all(feature = "viewer", unix))]
#[test]
fn a_program_that_ends_at_once_is_an_error() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("rerun");
    std::fs::write(&program, "#!/bin/sh\nexit 7\n").unwrap();
    std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).unwrap();
    let (code, said) = view(&["--web"], folder.path());
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("rerun ended at once (exit status: 7)"), "{said}");
}

#[cfg(feature = "viewer")]
#[test]
fn an_address_where_nobody_listens_is_an_error_that_names_it() {
    let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let url = format!("rerun+http://127.0.0.1:{port}/proxy");
    let (code, said) = view(&["--connect", &url], Path::new(""));
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains(&url) && said.contains("start one there"), "{said}");
}

/// The messages of the blueprint that is exported with a sample log.
#[cfg(feature = "viewer")]
fn blueprint(name: &str) -> Vec<rerun::log::LogMsg> {
    use rerun::external::re_log_encoding::Decoder;
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.rbl");
    let log = sample(name);
    let arguments = ["export".as_ref(), log.as_os_str(), "--rerun-blueprint".as_ref(), file.as_os_str()];
    let run = command(root()).args(arguments).output().unwrap();
    assert!(matches!(run.status.code(), Some(0 | 3)), "{}", String::from_utf8_lossy(&run.stderr));
    let bytes = std::fs::read(file).unwrap();
    Decoder::decode_eager(std::io::Cursor::new(bytes)).unwrap().map(Result::unwrap).collect()
}

#[cfg(feature = "viewer")]
#[test]
fn a_blueprint_is_of_the_application_that_rerun_names_after_the_file() {
    use rerun::{StoreKind, log::LogMsg};
    let messages = blueprint("pressures-run.mcap");
    for message in &messages {
        let id = message.store_id();
        assert_eq!((id.kind(), id.application_id().as_str()), (StoreKind::Blueprint, "pressures-run"));
    }
    let active = |message: &LogMsg| matches!(message, LogMsg::BlueprintActivationCommand(command) if command.make_active);
    assert!(active(messages.last().unwrap()), "what comes before it is whole");
}

#[cfg(feature = "viewer")]
#[test]
fn views_of_a_blueprint_are_of_what_the_log_holds() {
    let seen = |name: &str| -> Vec<String> {
        let text = |message| match message {
            rerun::log::LogMsg::ArrowMsg(_, message) => Some(format!("{:?}", message.batch)),
            _ => None,
        };
        blueprint(name).into_iter().filter_map(text).collect()
    };
    let has = |texts: &[String], word: &str| texts.iter().any(|text| text.contains(word));
    let pressures = seen("pressures-run.mcap");
    for word in [
        "+ /planned/joint_states/position",
        "+ /joint_states/velocity",
        "control_msgs.msg.DynamicJointState:message",
        ".interface_values[5].values[1]",
    ] {
        assert!(has(&pressures, word), "{word}");
    }
    assert!(!has(&pressures, "effort") && !has(&pressures, "\"3D\""), "{pressures:?}");
    assert!(!has(&seen("panel-install.mcap"), "+ /joint_states/velocity"));
}
