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
