//! Plans of an arm that starts and ends at the end of a joint's range, as homed axes do.

use std::{fs, path::Path};

use serde_json::Value;

use crate::support::{run_line as hydrotrace, said};

const ARM: &str = r#"<?xml version="1.0"?>
<robot name="two">
<link name="base"/>
<joint name="a" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" effort="160" velocity="3"/><dynamics damping="1.0" friction="RUBS"/></joint>
<link name="upper"><inertial><origin xyz="0.25 0 0"/><mass value="5"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
<joint name="b" type="revolute"><parent link="upper"/><child link="tool"/><origin xyz="0.5 0 0"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" effort="60" velocity="4"/></joint>
<link name="tool"><inertial><origin xyz="0.2 0 0"/><mass value="3"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.06" iyz="0" izz="0.06"/></inertial></link>
</robot>"#;

/// A task whose joint `b` starts at the end of its range, and stands there at its end `b_deg`.
fn task(folder: &Path, within_s: f64, more: &str) {
    fs::write(folder.join("arm.urdf"), ARM.replace("RUBS", "8")).unwrap();
    let points = [(0, 0), (30, 10), (60, 80), (90, 10), (0, 20)];
    let points = points.map(|(a, b)| format!("[[point]]\nangles_deg = {{ a = {a}, b = {b} }}\n"));
    let text = format!(
        "title = \"two\"\narm = \"arm.urdf\"\njoints = [\"a\", \"b\"]\ninterval_s = [0.05, 20]\n{}{more}[limits]\n\
         speed_deg_s = {{ a = 120, b = 150 }}\nacceleration_deg_s2 = {{ a = 600, b = 800 }}\n\
         jerk_deg_s3 = {{ a = 6000, b = 8000 }}\nrange_deg = {{ b = [0, 170] }}\n[objectives]\nmax_duration_s = {within_s}\n",
        points.concat()
    );
    fs::write(folder.join("task.toml"), text).unwrap();
}

fn chosen(folder: &Path, words: &str) -> Value {
    let (code, text, error) = said(&hydrotrace(folder, &format!("plan task.toml --json {words}")));
    assert!(code == 0 || code == 3, "{words}: {error}");
    serde_json::from_str::<Value>(&text).unwrap()["chosen"].clone()
}

#[test]
fn the_smoothest_plan_is_smoother_than_the_fastest_slowed_down() {
    let folder = tempfile::tempdir().unwrap();
    task(folder.path(), 6.0, "");
    let jerk = |plan: &Value| plan["rms_jerk_rad_s3"].as_f64().unwrap();
    let fastest = chosen(folder.path(), "--choose fastest");
    let times_s: Vec<f64> =
        fastest["times_s"].as_array().unwrap().iter().map(|s| s.as_f64().unwrap()).collect();
    let slower = times_s.iter().map(|s| (s * 5.999 / times_s[4]).to_string()).collect::<Vec<_>>().join(",");
    let slowed = chosen(folder.path(), &format!("--times {slower}"));
    let smoothest = chosen(folder.path(), "--choose smoothest");
    assert!(jerk(&smoothest) < jerk(&slowed), "{} {}", jerk(&smoothest), jerk(&slowed));
}

#[test]
fn a_free_shape_keeps_each_ceiling_that_its_fastest_plan_keeps() {
    let folder = tempfile::tempdir().unwrap();
    for within_s in [3.2, 3.5] {
        task(folder.path(), within_s, "");
        for rule in ["ideal", "smoothest", "fastest"] {
            let plan = chosen(folder.path(), &format!("--shape free --choose {rule}"));
            assert!(plan["duration_s"].as_f64().unwrap() <= within_s, "{within_s} {rule}: {plan}");
        }
    }
}

#[test]
fn a_key_point_a_rounding_beside_the_end_of_a_range_is_at_it() {
    let folder = tempfile::tempdir().unwrap();
    task(folder.path(), 20.0, "");
    let text = fs::read_to_string(folder.path().join("task.toml")).unwrap();
    fs::write(folder.path().join("task.toml"), text.replace("b = 80", "b = 169.9999")).unwrap();
    let (code, text, error) = said(&hydrotrace(folder.path(), "plan task.toml --evaluations 1000"));
    assert!(code == 3 && text.contains("ends at key point 3"), "{code}: {text}\n{error}");
}

#[test]
fn friction_that_no_torque_has_is_told_and_a_dwell_of_zero_stops() {
    let folder = tempfile::tempdir().unwrap();
    task(folder.path(), 60.0, "dwell_s = 0\n");
    let told = || said(&hydrotrace(folder.path(), "plan task.toml --choose fastest"));
    let (code, text, error) = told();
    assert!(
        code == 3 && text.contains("damping and friction that the arm's file gives to a"),
        "{code} {text}{error}"
    );
    fs::write(folder.path().join("arm.urdf"), ARM.replace("RUBS", "0").replace("1.0", "0.01")).unwrap();
    let (_, text, error) = told();
    assert!(text.contains("All limits are kept") && !text.contains("damping"), "{text}{error}");
}
