//! Poses of a tool as plan and as measurement, in every form in which they come, with a truth that is known: the tool is
//! 5 mm beside its plan in y, and turned by 2 degrees.

use hydrotrace::workflow::report::{Inputs, Report, run};
use mcap::WriteOptions;

use super::{
    cdr::{Cdr, Kind},
    file::store,
    *,
};

const BESIDE_M: f64 = 0.005;
const TURNED_RAD: f64 = 2.0 * std::f64::consts::PI / 180.0;
pub(super) const INSTANTS: i64 = 600;

const HEADER: &str = "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n";
const POSE: &str =
    "MSG: geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n";
const POINT: &str = "MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n";
const QUATERNION: &str = "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n";

/// A channel of a type by its root and what that needs.
pub(super) fn channel(topic: &str, type_name: &str, root: &str, parts: &[&str]) -> Channel {
    let rule = format!("{}\n", "=".repeat(80));
    let parts = [&[HEADER], parts, &[QUATERNION]].concat();
    let text: String = std::iter::once(root).chain(parts).collect::<Vec<_>>().join(&rule);
    Channel {
        topic: topic.into(),
        type_name: type_name.into(),
        schema_encoding: "ros2msg".into(),
        schema: text.into_bytes(),
        encoding: "cdr".into(),
    }
}

pub(super) fn stamped(topic: &str) -> Channel {
    let root = "std_msgs/Header header\ngeometry_msgs/Pose pose\n";
    channel(topic, "geometry_msgs/msg/PoseStamped", root, &[POSE, POINT])
}

/// Position and quaternion of the plan: on along x in 4 s of every 6, turning about z.
pub(super) fn planned(k: i64) -> [f64; 7] {
    let (cycle, rest_s) = ((k / 300) as f64, (k % 300) as f64 * 0.02);
    let part = ((rest_s - 1.0) / 4.0).clamp(0.0, 1.0);
    let way = cycle + part * part * part * (10.0 - 15.0 * part + 6.0 * part * part);
    let half_rad = 0.2 * way;
    [1.0 + 0.5 * way, 0.3, 0.8, 0.0, 0.0, half_rad.sin(), half_rad.cos()]
}

/// What came of it; with the other sign of the quaternion at times, as some estimators have it.
pub(super) fn measured(k: i64) -> [f64; 7] {
    let [x, y, z, .., sine, cosine] = planned(k);
    let half_rad = sine.atan2(cosine) + 0.5 * TURNED_RAD;
    let sign = if k % 100 < 50 { 1.0 } else { -1.0 };
    [x, y + BESIDE_M, z, 0.0, 0.0, sign * half_rad.sin(), sign * half_rad.cos()]
}

pub(super) fn numbers(cdr: &mut Cdr, values: &[f64]) {
    values.iter().for_each(|value| cdr.f64(*value));
}

pub(super) fn pose_stamped(ns: i64, pose: [f64; 7]) -> Vec<u8> {
    Cdr::message(Kind::LittleEndian, |cdr| {
        cdr.header(ns);
        numbers(cdr, &pose);
    })
}

fn odometry(topic: &str) -> Channel {
    let root = "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n";
    let part = "MSG: geometry_msgs/PoseWithCovariance\ngeometry_msgs/Pose pose\nfloat64[36] covariance\n";
    channel(topic, "nav_msgs/msg/Odometry", root, &[part, POSE, POINT])
}

fn odometry_message(ns: i64, pose: [f64; 7]) -> Vec<u8> {
    Cdr::message(Kind::LittleEndian, |cdr| {
        cdr.header(ns);
        cdr.text("tool0");
        numbers(cdr, &pose);
        numbers(cdr, &[0.0; 36]);
    })
}

fn path_message(poses: std::ops::Range<i64>, of: impl Fn(i64) -> i64) -> Vec<u8> {
    let all: Vec<i64> = poses.collect();
    Cdr::message(Kind::LittleEndian, |cdr| {
        cdr.header(START_NS);
        cdr.list(&all, |cdr, &k| {
            cdr.header(of(k));
            numbers(cdr, &planned(k));
        });
    })
}

fn path(topic: &str) -> Channel {
    let root = "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n";
    let part = "MSG: geometry_msgs/PoseStamped\nstd_msgs/Header header\ngeometry_msgs/Pose pose\n";
    channel(topic, "nav_msgs/msg/Path", root, &[part, POSE, POINT])
}

pub(super) fn reported(log: &Log, read: ReadOptions) -> Result<Report, String> {
    let stored = store(&[("run.mcap", &log.bytes(WriteOptions::new()))]);
    run(&Inputs { logs: stored.paths.clone(), read, ..Inputs::default() }).map_err(|error| error.to_string())
}

#[track_caller]
pub(super) fn assert_truth(report: &Report) {
    let tool = report.tool.found().unwrap();
    let angles = [tool.worst_orientation_rad, tool.mean_orientation_rad, tool.rms_orientation_rad];
    for found in angles {
        assert!((found.unwrap() - TURNED_RAD).abs() < 1e-6, "{angles:?}");
    }
    assert_place(report);
}

/// The position alone.
#[track_caller]
fn assert_place(report: &Report) {
    assert_eq!(report.remarks.as_slice(), &[]);
    let tool = report.tool.found().unwrap();
    for (found, truth) in [
        (tool.worst.deviation.error_m, BESIDE_M),
        (tool.rms_m, BESIDE_M),
        (tool.mean_m, BESIDE_M),
        (tool.path_error.unwrap().rms, BESIDE_M),
        (tool.path_error.unwrap().peak, BESIDE_M),
        (tool.split.unwrap().rms_across_m, BESIDE_M),
        (tool.end().unwrap().deviation.error_m, BESIDE_M),
    ] {
        assert!((found - truth).abs() < 1e-6, "{found} in place of {truth}");
    }
    let joints: Vec<&str> = report.replay.joints.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(joints, ["x", "y", "z"]);
    let [x, y, z] = [0, 1, 2].map(|k| report.replay.joints[k].tracking_error.rms);
    assert!(x < 1e-6 && (y - BESIDE_M).abs() < 1e-6 && z < 1e-6, "{x} {y} {z}");
    // Whatever the time, and as one distance.
    let whole = &report.replay.whole_run;
    let path = whole.path_error.as_ref().unwrap();
    assert!((path.rms - BESIDE_M).abs() < 1e-6, "{path:?}");
    let starts = report.replay.transitions.iter().filter(|start| start.joint == "x").count();
    assert_eq!(starts, 2);
}

#[test]
fn stamped_poses_are_found_by_their_names() {
    let mut log = Log::default();
    let [plan, came] = ["/planned/tool_pose", "/tool_pose"].map(|topic| log.channel(stamped(topic)));
    for k in 0..INSTANTS {
        log.send(plan, stamp(k), pose_stamped(stamp(k), planned(k)));
        log.send(came, stamp(k), pose_stamped(stamp(k), measured(k)));
    }
    assert_truth(&reported(&log, ReadOptions::default()).unwrap());
}

#[test]
fn poses_of_different_frames_are_not_subtracted_without_a_word() {
    let log_of = |frames: [&str; 2]| {
        let mut log = Log::default();
        let ids = ["/planned/tool_pose", "/tool_pose"].map(|topic| log.channel(stamped(topic)));
        for k in 0..INSTANTS {
            for ((id, frame), pose) in ids.into_iter().zip(frames).zip([planned(k), measured(k)]) {
                let message = Cdr::message(Kind::LittleEndian, |cdr| {
                    cdr.record(|cdr| {
                        cdr.time(stamp(k));
                        cdr.text(frame);
                    });
                    numbers(cdr, &pose);
                });
                log.send(id, stamp(k), message);
            }
        }
        log
    };
    let apart =
        "the poses of /planned/tool_pose are told in world, those of /tool_pose are told in base_link: ";
    let log = log_of(["world", "base_link"]);
    let found = reported(&log, ReadOptions::default()).unwrap_err();
    assert!(found.starts_with(apart), "{found}");
    let both = options(&["/planned/tool_pose"], &["/tool_pose"], &[]);
    let remarks = reported(&log, both).unwrap().remarks;
    assert_eq!(codes(&remarks), [Code::UnlikePlan]);
    assert!(remarks.as_slice()[0].message.starts_with(apart), "{remarks:?}");
    for same in [["world", "/world"], ["world", ""], ["", "base_link"]] {
        assert_truth(&reported(&log_of(same), ReadOptions::default()).unwrap());
    }
}

/// The delay is of all that was measured, orientations included.
#[test]
fn a_known_delay_is_taken_off_a_pose_too() {
    const LATE_NS: i64 = 40_000_000;
    let mut log = Log::default();
    let [plan, came] = ["/planned/tool_pose", "/tool_pose"].map(|topic| log.channel(stamped(topic)));
    for k in 0..INSTANTS {
        log.send(plan, stamp(k), pose_stamped(stamp(k), planned(k)));
        log.send(came, stamp(k) + LATE_NS, pose_stamped(stamp(k) + LATE_NS, measured(k)));
    }
    assert_truth(
        &reported(&log, ReadOptions { measured_delay_ns: Some(LATE_NS), ..ReadOptions::default() }).unwrap(),
    );
}

#[test]
fn a_path_is_a_plan_and_odometry_a_measurement() {
    let mut log = Log::default();
    let [plan, came] = [path("/plan"), odometry("/odom")].map(|channel| log.channel(channel));
    // A second path replaces the rest of the first.
    log.send(plan, stamp(0), path_message(0..400, stamp));
    for k in 0..INSTANTS {
        log.send(came, stamp(k), odometry_message(stamp(k), measured(k)));
        if k == 200 {
            log.send(plan, stamp(k), path_message(200..INSTANTS, stamp));
        }
    }
    assert_truth(&reported(&log, ReadOptions::default()).unwrap());
}

#[test]
fn a_path_without_times_is_said() {
    let mut log = Log::default();
    log.add(path("/plan"), 0..1, |_| path_message(0..400, |_| START_NS));
    log.add(odometry("/odom"), 0..INSTANTS, |k| odometry_message(stamp(k), measured(k)));
    let bytes = log.bytes(WriteOptions::new());
    let survey = survey_bytes(&bytes);
    assert_eq!(codes(&survey.remarks), [Code::UnusableStamp]);
    assert!(survey.recording.is_err());
}

#[test]
fn where_there_are_joints_poses_count_only_if_named() {
    let mut log = plain_log();
    let [plan, came] = ["/planned/tool_pose", "/tool_pose"].map(|topic| log.channel(stamped(topic)));
    for k in 0..SAMPLES {
        log.send(plan, stamp(k), pose_stamped(stamp(k), planned(k)));
        log.send(came, stamp(k), pose_stamped(stamp(k), measured(k)));
    }
    let usual = read(&log);
    assert_eq!(joints(&usual.planned), NAMES);
    assert!(usual.poses.is_none());
    let sides = [["/planned/joint_states", "/planned/tool_pose"], ["/joint_states", "/tool_pose"]];
    let both = read_with(&log, &options(&sides[0], &sides[1], &[]));
    assert_eq!(joints(&both.planned), ["a", "b", "x", "y", "z"]);
    assert!(both.poses.is_some());
}

/// A table of both sides: position in mm, then what tells the orientation.
fn table(turns: &[&str], orientation: impl Fn([f64; 4]) -> Vec<f64>) -> Report {
    let names = [&["x_mm", "y_mm", "z_mm"], turns].concat();
    let of = |side: &str| names.iter().map(|name| format!("{side}_{name}")).collect::<Vec<_>>().join(",");
    let mut text = format!("time_s,{},{}\n", of("planned"), of("measured"));
    for k in 0..INSTANTS {
        let cells = [planned(k), measured(k)].map(|[x, y, z, turn @ ..]| {
            let all = [1e3 * x, 1e3 * y, 1e3 * z].into_iter().chain(orientation(turn));
            all.map(|value| format!("{value:.12}")).collect::<Vec<_>>().join(",")
        });
        text += &format!("{:.2},{}\n", k as f64 * 0.02, cells.join(","));
    }
    let stored = store(&[("run.csv", text.as_bytes())]);
    run(&Inputs { logs: stored.paths.clone(), ..Inputs::default() }).unwrap()
}

#[test]
fn columns_of_a_table_are_poses_by_their_names() {
    assert_truth(&table(&["qx", "qy", "qz", "qw"], |turn| turn.to_vec()));
}

/// The yaw leaves 180 degrees on its way, which is no jump.
#[test]
fn columns_of_roll_pitch_and_yaw_are_an_orientation() {
    let yaw_deg = |[.., sine, cosine]: [f64; 4]| {
        let deg = (2.0 * sine.atan2(cosine)).to_degrees() + 165.0;
        vec![180.0, 0.0, (deg + 180.0).rem_euclid(360.0) - 180.0]
    };
    assert_truth(&table(&["roll_deg", "pitch_deg", "yaw_deg"], yaw_deg));
}

#[test]
fn columns_of_a_position_alone_have_no_angle() {
    let report = table(&[], |_| Vec::new());
    assert_place(&report);
    let tool = report.tool.found().unwrap();
    let angles =
        [tool.worst_orientation_rad, tool.mean_orientation_rad, tool.worst.deviation.orientation_rad];
    assert_eq!(angles, [None; 3]);
}

#[test]
fn stamped_transforms_have_an_angle_and_stamped_points_none() {
    let vector = "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";
    let part = "MSG: geometry_msgs/Transform\ngeometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n";
    let root = "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n";
    let transform = |topic| channel(topic, "geometry_msgs/msg/TransformStamped", root, &[part, vector]);
    let root = "std_msgs/Header header\ngeometry_msgs/Point point\n";
    let point = |topic| channel(topic, "geometry_msgs/msg/PointStamped", root, &[POINT]);
    let topics = ["/planned/tool", "/tool"];
    let log_of = |channels: [Channel; 2], frame: Option<&str>, most: usize| {
        let mut log = Log::default();
        let ids = channels.map(|channel| log.channel(channel));
        for k in 0..INSTANTS {
            for (id, pose) in ids.into_iter().zip([planned(k), measured(k)]) {
                let message = Cdr::message(Kind::LittleEndian, |cdr| {
                    cdr.header(stamp(k));
                    frame.into_iter().for_each(|frame| cdr.text(frame));
                    numbers(cdr, &pose[..most]);
                });
                log.send(id, stamp(k), message);
            }
        }
        reported(&log, ReadOptions::default()).unwrap()
    };
    assert_truth(&log_of(topics.map(transform), Some("tool"), 7));
    let report = log_of(topics.map(point), None, 3);
    assert_place(&report);
    assert_eq!(report.tool.found().unwrap().rms_orientation_rad, None);
}
