//! Tables as wholes.

use super::*;

fn read(text: &str) -> Result<CsvRun, CsvError> {
    read_csv_bytes("a.csv", text.as_bytes(), &CsvOptions::default())
}

/// A header and so many rows.
fn table(header: &str, rows: u32, row: impl Fn(u32) -> String) -> String {
    (0..rows).fold(format!("{header}\n"), |text, k| format!("{text}{}\n", row(k)))
}

#[test]
fn a_speed_is_no_position_whatever_its_joint_does() {
    let error = read("t_s,setpoint_rpm,actual_rpm\n0,100,0\n1,100,42\n").unwrap_err().to_string();
    assert!(
        error.contains("no column looks like a joint angle (column \"setpoint_rpm\" is a speed)"),
        "{error}"
    );
    let run = read("t_s,boom_set_mm,boom_act_mm,boom_rpm\n0,1,0,9\n1,2,1,9\n").unwrap();
    assert_eq!(run.understood.unused, ["boom_rpm"]);
}

#[test]
fn a_column_that_rises_through_many_rows_is_named_as_the_time() {
    let text = table("", 900, |k| format!("{},{},{}", 900 - k.abs_diff(800), k % 7, 0.001 * f64::from(k)));
    let error = read(text.trim_start()).unwrap_err().to_string();
    assert!(error.contains("--time '#3' --planned 'J1=#1' --measured 'J1=#2' --degrees"), "{error}");
}

#[test]
fn the_load_of_a_controller_is_no_clock_of_few_rows() {
    let text = table("timestamp,target_q_0,actual_q_0,actual_execution_time", 9, |k| {
        format!("{},0.1,0.1,{}", 0.008 * f64::from(k), 0.17 + 0.02 * f64::from(k * 4 % 7))
    });
    let run = read(&text).unwrap();
    let clocks = |code| run.remarks.as_slice().iter().filter(|remark| remark.code == code).count();
    assert_eq!((clocks(Code::Ambiguous), clocks(Code::Guessed)), (0, 0));
}

#[test]
fn words_of_forces_in_a_name_take_no_angle_away_and_what_does_is_said() {
    for text in [
        "Zeit [ms];L-force Achse 1.Sollposition [°];L-force Achse 1.Istposition [°]\n0;1;1\n20;2;1\n40;4;2\n",
        "t_ms,Power arm set [deg],Power arm act [deg]\n0,1,1\n20,2,1\n40,4,2\n",
    ] {
        let run = read(text).unwrap();
        let becomes: Vec<&str> = run.understood.columns.iter().map(|one| one.becomes.as_str()).collect();
        assert_eq!(becomes, ["planned position", "measured position"], "{text}");
    }
    let error =
        read("t_s,boom error set [deg],boom error act [deg]\n0,1,1\n1,2,1\n").unwrap_err().to_string();
    assert!(error.contains("column \"boom error set [deg]\"") && error.contains("\"error\""), "{error}");
}

#[test]
fn filtered_columns_beside_those_of_the_same_joint_are_left_out_and_told() {
    let text = table("time,pos_meas1,pos_meas2,pos_filt1,pos_filt2", 9, |k| {
        format!("{},0.{k},0.2,0.{k},0.2", 0.005 * f64::from(k))
    });
    let run = read(&text).unwrap();
    assert_eq!(run.understood.unused, ["pos_filt1", "pos_filt2"]);
    assert!(run.remarks.as_slice().iter().any(|remark| remark.message.contains("\"pos_filt1\"")));
}

#[test]
fn what_comes_in_is_measured_and_what_goes_out_is_sent() {
    let run = read("t,qIn_0,qOut_0\n0,0.1,0.1\n0.1,0.1,0.2\n0.2,0.2,0.3\n").unwrap();
    let read: Vec<&str> = run.understood.columns.iter().map(|one| one.becomes.as_str()).collect();
    let joints: Vec<&str> = run.understood.columns.iter().map(|one| one.joint.as_str()).collect();
    assert_eq!((read, joints), (vec!["measured position", "command position"], vec!["joint_0"; 2]));
}
