//! Names, units, clocks and ends of lines as programs and controllers spell them: the same run, or a refusal that says what
//! to do.

use std::{fs, path::Path};

use super::csv::{import, moves, report, trace};
use crate::support::{run_line as hydrotrace, said, timed};

/// Rows at 50 Hz of a time and two joints, plan first, deg.
fn two_joints(header: &str) -> String {
    timed(header, (500, 0.02), |t_s| {
        let [plan, came] = moves(t_s).map(f64::to_degrees);
        format!("{t_s:.2},{plan},{},{came},{}", -plan, -came)
    })
}

/// Peaks of the tracking errors, rad, of an import with these options, and what it said.
#[track_caller]
fn peaks(folder: &Path, text: &[u8], options: &str) -> (Vec<(String, f64)>, String) {
    fs::write(folder.join("a.csv"), text).unwrap();
    let (code, said, error) = said(&hydrotrace(folder, &format!("import a.csv -o a.mcap --force {options}")));
    assert!(code == 0 || code == 3, "{said}{error}");
    let found = report(folder, "a.mcap");
    let joints = found["joints"].as_array().unwrap_or_else(|| panic!("{said}")).iter();
    let peak = |joint: &serde_json::Value| joint["tracking_error"]["peak"].as_f64().unwrap();
    (joints.map(|joint| (joint["name"].as_str().unwrap().to_owned(), peak(joint))).collect(), said)
}

/// The measurement is 0.1 s late at up to 0.26 rad/s.
#[track_caller]
fn assert_run(text: &[u8], options: &str, names: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let (found, said) = peaks(folder.path(), text, options);
    assert_eq!(found.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), names, "{said}");
    assert!(found.iter().all(|(_, peak)| (peak - 0.026).abs() < 0.001), "{found:?} {said}");
    said
}

#[test]
fn plan_and_measurement_are_paired_by_the_last_part_of_their_names_where_that_is_clear() {
    for (header, names) in [
        (
            "t,robot/arm/joint1_set_deg,robot/arm/joint2_set_deg,joint1_act_deg,joint2_act_deg",
            ["robot/arm/joint1", "robot/arm/joint2"],
        ),
        (
            "t,/left/boom_set_deg,/left/stick_set_deg,boom_joint_act_deg,stick_joint_act_deg",
            ["left/boom", "left/stick"],
        ),
    ] {
        let said = assert_run(two_joints(header).as_bytes(), "", &names);
        assert!(said.contains("paired by the last part of their names"), "{said}");
    }
    let one = trace("t,robot/arm/joint1_set_rad,joint1_act_rad", 1.0, ",", 1.0);
    assert_run(one.as_bytes(), "", &["robot/arm/joint1"]);
    // Which of the two is meant nobody knows.
    let (code, _, error) =
        import(two_joints("t,left/boom_set_deg,right/boom_set_deg,boom_act_deg,grip_act_deg"), &[]);
    assert!(code == 1 && error.contains("no joint has both"), "{error}");
}

#[test]
fn joints_counted_from_0_and_from_1_are_asked_about_with_the_line_that_pairs_them() {
    let table = two_joints("t,q_des_0_deg,q_des_1_deg,q_meas_1_deg,q_meas_2_deg");
    let (code, _, error) = import(table.clone(), &[]);
    assert!(code == 1 && error.contains("counted from different numbers"), "{error}");
    let (_, options) = error.split_once("such as ").unwrap_or_else(|| panic!("{error}"));
    let options = options.lines().next().unwrap_or_default();
    assert_run(table.as_bytes(), options, &["joint_1", "joint_2"]);
}

#[test]
fn one_quantity_in_two_units_is_taken_once_and_the_number_of_a_signal_is_no_name() {
    let degrees = trace("t_s,boom_set_rad,boom_act_rad", 1.0, ",", 1.0);
    let both: String = degrees
        .lines()
        .enumerate()
        .map(|(k, line)| {
            let cells: Vec<&str> = line.split(',').collect();
            let degrees = |cell: &str| cell.parse::<f64>().map_or(0.0, f64::to_degrees);
            match k {
                0 => "t_s,boom_set_rad,boom_set_deg,boom_act_rad,boom_act_deg\n".to_owned(),
                _ => format!(
                    "{},{},{:.4},{},{:.4}\n",
                    cells[0],
                    cells[1],
                    degrees(cells[1]),
                    cells[2],
                    degrees(cells[2])
                ),
            }
        })
        .collect();
    let said = assert_run(both.as_bytes(), "", &["boom"]);
    assert!(said.contains("repeats #2"), "{said}");
    let other = both.replace("boom_set_deg", "boom_set_gon");
    let (code, _, error) = import(other, &[]);
    assert!(code == 1 && error.contains("both look like"), "{error}");
    assert_run(
        trace("t_s,[0:0] boom set [rad],[0:1] boom act [rad]", 1.0, ",", 1.0).as_bytes(),
        "",
        &["boom"],
    );
}

#[test]
fn lines_may_end_as_on_old_macs() {
    let text = trace("t_s,boom_set_rad,boom_act_rad", 1.0, ",", 1.0).replace('\n', "\r");
    assert_run(text.as_bytes(), "", &["boom"]);
    let folder = tempfile::tempdir().unwrap();
    for (name, separator) in [("a.txt", "\t"), ("b.dat", ";"), ("c.txt", " ")] {
        let text = trace("t_s,boom_set_rad,boom_act_rad", 1.0, ",", 1.0).replace(',', separator);
        fs::write(folder.path().join(name), text.replace('\n', "\r")).unwrap();
        assert_eq!(report(folder.path(), name)["joints"][0]["name"], "boom", "{name}");
    }
}

#[test]
fn turns_are_angles_in_brackets_and_parts_of_a_rating_are_refused() {
    let turns = |unit: &str| {
        let header = format!("t_s,boom_set [{unit}],boom_act [{unit}]");
        trace(&header, 1.0, ",", 1.0 / std::f64::consts::TAU)
    };
    for unit in ["U", "tr", "tours", "revs", "Umdrehungen"] {
        let said = assert_run(turns(unit).as_bytes(), "", &["boom"]);
        assert!(!said.contains("guess"), "{unit}: {said}");
    }
    for unit in ["pu", "p.u."] {
        let (code, _, error) = import(turns(unit), &[]);
        assert!(code == 1 && error.contains("is in p"), "{unit}: {error}");
        assert!(error.contains("--planned JOINT=FACTOR*COLUMN"), "{unit}: {error}");
    }
}

#[test]
fn days_since_the_year_0_are_a_clock_and_told() {
    for (name, digits) in [("t", 10), ("datenum", 10), ("Time", 9)] {
        let text = timed(&format!("{name},boom_set_rad,boom_act_rad"), (500, 0.02), |t_s| {
            let [plan, came] = moves(t_s);
            format!("{:.digits$},{plan},{came}", 739_323.4 + t_s / 86_400.0)
        });
        let said = assert_run(text.as_bytes(), "", &["boom"]);
        assert!(said.contains("counts days since year 0"), "{said}");
        assert_eq!(said.contains("guessed x1"), name != "datenum", "{said}");
        assert_run(text.as_bytes(), &format!("--time {name} --time-unit datenum"), &["boom"]);
    }
}

#[test]
fn the_type_of_a_variable_is_no_part_of_its_joint_and_no_measurement() {
    for names in [
        ["boom_set_REAL32", "boom_act_REAL32"],
        ["boom_set_LREAL", "boom_act_LREAL"],
        ["REAL_boom_set", "REAL_boom_act"],
        ["boom_set_REAL", "boom_act_REAL"],
        ["boom_set (REAL)", "boom_act (REAL)"],
        ["boom_set:REAL", "boom_act:REAL"],
        ["boom_set_INT16", "boom_act_INT16"],
        ["boom_set_rad_F32", "boom_act_rad_F32"],
        // In Spanish it is the measurement.
        ["boom_consigna", "boom_REAL"],
    ] {
        let text = trace(&format!("t_s,{}", names.join(",")), 1.0, ",", 1.0);
        assert_run(text.as_bytes(), "--radians", &["boom"]);
    }
}

#[test]
fn letters_of_an_orientation_beside_the_place_of_a_tool_are_no_joints() {
    let pose = |header: &str| {
        timed(header, (500, 0.02), |t_s| {
            let [plan, came] = moves(t_s).map(f64::to_degrees);
            let side = |q: f64| format!("{},{q},{q},{q},{},{}", 1000.0 + q, q / 2.0, q / 3.0);
            format!("{t_s:.2},{plan},{came},{},{}", side(plan), side(came))
        })
    };
    let folder = tempfile::tempdir().unwrap();
    for header in [
        "t,A1_set_deg,A1_act_deg,RSol.X,RSol.Y,RSol.Z,RSol.A,RSol.B,RSol.C,RIst.X,RIst.Y,RIst.Z,RIst.A,RIst.B,RIst.C",
        "t,A1_set_deg,A1_act_deg,X_set,Y_set,Z_set,A_set,B_set,C_set,X_act,Y_act,Z_act,A_act,B_act,C_act",
    ] {
        let (found, said) = peaks(folder.path(), pose(header).as_bytes(), "");
        assert_eq!(found.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["A1"], "{said}");
        assert!(said.contains("orientation"), "{said}");
    }
    // Alone they are joints.
    let alone = two_joints("t,A_set_deg,B_set_deg,A_act_deg,B_act_deg");
    assert_run(alone.as_bytes(), "", &["A", "B"]);
}
