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

#[test]
fn words_and_units_of_other_languages_are_known() {
    let degrees = 180.0 / std::f64::consts::PI;
    for unit in ["º", "graden", "graus", "derece", "град"] {
        let said = assert_run(
            trace(&format!("t,J1 target [{unit}],J1 actual [{unit}]"), 1.0, ",", degrees).as_bytes(),
            "",
            &["J1"],
        );
        assert!(!said.contains("guessed"), "{said}");
    }
    for (header, name) in [
        ("t,Asse 1 posizione desiderata [deg],Asse 1 posizione reale [deg]", "Asse_1"),
        ("t,Axe 1 position théorique [deg],Axe 1 position réelle [deg]", "Axe_1"),
        ("t,boom_control_position_deg,boom_actual_position_deg", "boom"),
    ] {
        assert_run(trace(header, 1.0, ",", degrees).as_bytes(), "", &[name]);
    }
    assert_run(trace("t,boom_set [ft],boom_act [ft]", 1.0, ",", 1.0 / 0.3048).as_bytes(), "", &["boom"]);
    // Degrees of German, and, under English names, perhaps gons.
    for (header, doubt) in
        [("t,J1 target [grad],J1 actual [grad]", true), ("t,J1 Soll [Grad],J1 Ist [Grad]", false)]
    {
        let said = assert_run(trace(header, 1.0, ",", degrees).as_bytes(), "", &["J1"]);
        assert_eq!(said.contains("gons"), doubt, "{said}");
    }
}

#[test]
fn an_error_by_any_word_makes_the_plan() {
    for (came, error) in
        [("ActPos", "PosDiff"), ("Istwert", "Regelabweichung"), ("actual", "lag"), ("actual", "track_err")]
    {
        let text = timed(&format!("t,Axis1.{came} [deg],Axis1.{error} [deg]"), (500, 0.02), |t_s| {
            let [plan, came] = moves(t_s).map(f64::to_degrees);
            format!("{t_s:.2},{came},{}", plan - came)
        });
        assert_run(text.as_bytes(), "--planned Axis1=measured+error", &["Axis1"]);
    }
}

#[test]
fn speeds_filters_and_lengths_without_a_unit_are_told() {
    let text = timed("t,J1 v_soll,J1 s_soll,J1 v_ist,J1 s_ist", (500, 0.02), |t_s| {
        let [now, next] = [t_s, t_s + 0.02].map(|t_s| moves(t_s).map(f64::to_degrees));
        let speed = |side: usize| (next[side] - now[side]) / 0.02;
        format!("{t_s:.2},{},{},{},{}", speed(0), now[0], speed(1), now[1])
    });
    let said = assert_run(text.as_bytes(), "--degrees", &["J1_s"]);
    assert!(said.contains("taken for speeds of J1_s"), "{said}");
    let header =
        "t,J1_set_deg,J2_set_deg,J1_act_filtered_deg,J2_act_filtered_deg,J1_act_raw_deg,J2_act_raw_deg";
    let text = timed(header, (500, 0.02), |t_s| {
        let [plan, came] = moves(t_s).map(f64::to_degrees);
        let filtered = moves(t_s - 0.1)[1].to_degrees();
        format!("{t_s:.2},{plan},{},{filtered},{},{came},{}", -plan, -filtered, -came)
    });
    let folder = tempfile::tempdir().unwrap();
    let (_, said) = peaks(folder.path(), text.as_bytes(), "");
    let (_, line) = said.split_once("import with ").unwrap_or_else(|| panic!("{said}"));
    let said = assert_run(text.as_bytes(), line.lines().next().unwrap_or_default(), &["J1", "J2"]);
    assert!(!said.contains("are filtered"), "{said}");
    let text = timed("t,swing_set_deg,swing_act_deg,boom_set,boom_act", (500, 0.02), |t_s| {
        let [plan, came] = moves(t_s);
        format!("{t_s:.2},{plan},{came},{},{}", 1000.0 + plan, 1000.0 + came)
    });
    let (_, said) = peaks(folder.path(), text.as_bytes(), "");
    assert!(said.contains("--slides boom=mm"), "{said}");
}

#[test]
fn a_counter_that_begins_again_is_one_run() {
    for (header, per_second, full) in
        [("micros,boom_set_rad,boom_act_rad", 1e6, 32), ("t_ms,boom_set_rad,boom_act_rad", 1e3, 16)]
    {
        let full = f64::from(2_u32.pow(16)).powi(full / 16);
        let text = timed(header, (500, 0.02), |t_s| {
            let [plan, came] = moves(t_s);
            format!("{:.0},{plan},{came}", (full + (t_s - 3.0) * per_second).rem_euclid(full))
        });
        let said = assert_run(text.as_bytes(), "", &["boom"]);
        assert!(said.contains("begins again; the time goes on there"), "{said}");
    }
}
