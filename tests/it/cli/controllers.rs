//! Tables as controllers, simulators, robots and databases write them, two joints each: the same run whatever the form.

use std::{fmt::Write as _, fs};

use serde_json::Value;

use super::csv::{moves, report};
use crate::support::{run_args as hydrotrace, said};

/// Angles, deg, of plan and measurement of two joints.
fn row(k: u32) -> [f64; 4] {
    let [planned, measured] = moves(f64::from(k) * 0.02).map(f64::to_degrees);
    [planned, measured, -planned, -measured]
}

/// A row for each instant below `head`: its time, then the cells, all by `time` and `cell`.
fn rows(head: &str, separator: &str, time: impl Fn(u32) -> String, cell: impl Fn(f64) -> String) -> String {
    let mut text = format!("{head}\n");
    for k in 0..500 {
        let cells: Vec<String> = std::iter::once(time(k)).chain(row(k).map(&cell)).collect();
        writeln!(text, "{}", cells.join(separator)).unwrap();
    }
    text
}

fn seconds(k: u32) -> String {
    format!("{:.2}", f64::from(k) * 0.02)
}

fn millis(k: u32) -> String {
    (20 * k).to_string()
}

fn comma_s(k: u32) -> String {
    seconds(k).replace('.', ",")
}

fn with_unit(k: u32) -> String {
    format!("{} sec", seconds(k))
}

fn counter(k: u32) -> String {
    (4_208_163_634 + u64::from(k) * 20).to_string()
}

fn nanos(k: u32) -> String {
    (1_700_000_000_000_000_000 + u64::from(k) * 20_000_000).to_string()
}

fn degrees(q: f64) -> String {
    format!("{q:.4}")
}

fn comma(q: f64) -> String {
    degrees(q).replace('.', ",")
}

/// The run with a row for each joint, and with a block for each signal.
fn by_row() -> [String; 2] {
    let mut long = "time,joint,planned_deg,actual_deg\n".to_owned();
    let mut blocks = "#group,false,false,true,true\n".to_owned();
    for k in 0..500 {
        let [a, b, c, d] = row(k);
        let t = seconds(k);
        writeln!(long, "{t},Boom,{a:.4},{b:.4}\n{t},Arm,{c:.4},{d:.4}").unwrap();
    }
    for (signal, name) in ["Boom_set", "Boom_actual", "Arm_set", "Arm_actual"].iter().enumerate() {
        writeln!(blocks, "\n,result,table,_time,_value,_field").unwrap();
        for k in 0..500 {
            let (s, ms) = (k / 50, k % 50 * 20);
            let value = row(k)[signal];
            writeln!(blocks, ",,{signal},2026-11-20T10:00:{s:02}.{ms:03}Z,{value:.4},{name}").unwrap();
        }
    }
    [long, blocks]
}

/// Forms as in [`tables`], without a unit where a loop writes radians.
fn loops() -> Vec<(&'static str, Vec<u8>, &'static [&'static str], &'static str)> {
    let none: &[&str] = &[];
    let deg: &[&str] = &["--degrees"];
    let rad = |q: f64| format!("{:.6}", q.to_radians());
    let described = rows("time,Boom Ref,Boom Meas,Arm Ref,Arm Meas", ",", seconds, degrees);
    let described = described.replacen(
        '\n',
        "\n,Unit: deg,Unit: deg,Unit: deg,Unit: deg\n,Interp: linear,Interp: linear,\
                                              Interp: linear,Interp: linear\n",
        1,
    );
    let demand = "Time (ms),Boom.Position demand value,Boom.Position actual value,Arm.Position demand value,\
                  Arm.Position actual value";
    let process = "%time,boom_set_point,boom_process_value,arm_set_point,arm_process_value";
    vec![
        ("a letter for the side", rows("t,q1_d,q1_m,q2_d,q2_m", ",", seconds, rad).into(), none, "joint_1"),
        (
            "a letter for the plan",
            rows("t,theta1_d,theta1,theta2_d,theta2", ",", seconds, rad).into(),
            none,
            "joint_1",
        ),
        ("set point and process value", rows(process, ",", nanos, rad).into(), none, "boom"),
        ("demand and actual value", rows(demand, ",", millis, degrees).into(), deg, "Boom"),
        (
            "milliseconds by name",
            rows("millis,a_target,a_angle,b_target,b_angle", ",", millis, degrees).into(),
            deg,
            "a",
        ),
        ("rows of what columns are", described.into(), none, "Boom"),
        (
            "blanks between, names in a comment",
            rows("# ts  q1d  q1  q2d  q2", "  ", seconds, rad).into(),
            none,
            "joint_1",
        ),
    ]
}

/// Name, bytes, options of `import`, the first joint's name.
fn tables() -> Vec<(&'static str, Vec<u8>, &'static [&'static str], &'static str)> {
    let none: &[&str] = &[];
    let deg: &[&str] = &["--degrees"];
    let wide = |text: &str| {
        let units = text.encode_utf16().flat_map(u16::to_le_bytes);
        [0xff, 0xfe].into_iter().chain(units).collect::<Vec<u8>>()
    };
    let clock = |k: u32| format!("\"Data\",\"11/20/2026\",\"10:00:{:02};{:03}\"", k / 50, k % 50 * 20);
    let quoted = |q: f64| format!("\"{q:.4}\"");
    let [long, blocks] = by_row();
    let lab = "LabVIEW Measurement\nWriter_Version\t2\nSeparator\tTab\nTime\t10:00:00.0\n***End_of_Header***\n\n\
               Channels\t4\nSamples\t500\t500\t500\t500\nX0\t0\t0\t0\t0\nDelta_X\t0.02\t0.02\t0.02\t0.02\n\
               ***End_of_Header***\nX_Value\tBoom Set\tBoom Actual\tArm Set\tArm Actual\tComment";
    let trend = "\"Controller Name: \",\"Arm\"\n\"Sample Period: \",\"20 ms\"\n\n\"Header: \",\"Date\",\"Time\",\
                 \"Boom.DesiredPosition\",\"Boom.ActualPosition\",\"Arm.DesiredPosition\",\"Arm.ActualPosition\"";
    let drive = |name: &str| {
        format!(
            "{name}: S-0-0047, Position set value [Deg];{name}: S-0-0051, Position feedback value 1 [Deg]"
        )
    };
    let gbk = b"\xca\xb1\xbc\xe4(s),\
                \xb9\xd8\xbd\xda1\xb9\xe6\xbb\xae\xbd\xc7\xb6\xc8(\xa1\xe3),\
                \xb9\xd8\xbd\xda1\xca\xb5\xbc\xca\xbd\xc7\xb6\xc8(\xa1\xe3),\
                \xb9\xd8\xbd\xda2\xb9\xe6\xbb\xae\xbd\xc7\xb6\xc8(\xa1\xe3),\
                \xb9\xd8\xbd\xda2\xca\xb5\xbc\xca\xbd\xc7\xb6\xc8(\xa1\xe3)";
    let chinese = "时间(s),关节1规划角度(°),关节1实际角度(°),关节2规划角度(°),关节2实际角度(°)";
    let french = &b"Temps (s);Fl\xe8che consigne (\xb0);Fl\xe8che mesure (\xb0);Bras consigne (\xb0);\
                    Bras mesure (\xb0)"[..];
    let plc = "Time [ms];Boom.Position [°];Boom.ActualPosition [°];Arm.Position [°];Arm.ActualPosition [°]";
    let soft_plc =
        "Time;GVL.Boom.fSetPosition;GVL.Boom.fActPosition;GVL.Arm.fSetPosition;GVL.Arm.fActPosition";
    let tenths = "Timestamp (s),Boom_SP_0.1deg,Boom_PV_0.1deg,Arm_SP_0.1deg,Arm_PV_0.1deg";
    let echo = "%time,field.desired.positions0,field.actual.positions0,field.desired.positions1,\
                field.actual.positions1";
    let below = rows("", ",", seconds, degrees).into_bytes();
    vec![
        (
            "axes of a PLC whose set value has no word of its own",
            rows(plc, ";", millis, comma).into(),
            none,
            "Boom",
        ),
        ("axes of a soft PLC", rows(soft_plc, ";", millis, degrees).into(), deg, "GVL_Boom"),
        ("a trend with a day and a time of day", rows(trend, ",", clock, quoted).into(), deg, "Boom"),
        (
            "numbers of parameters of a drive",
            rows(&format!("Time [ms];{};{}", drive("Boom"), drive("Arm")), ";", millis, degrees).into(),
            none,
            "Boom",
        ),
        (
            "sensor interface of a robot",
            rows("IPOC;ASPos.A1;AIPos.A1;ASPos.A2;AIPos.A2", ";", counter, degrees).into(),
            deg,
            "A1",
        ),
        (
            "a timetable with the unit in each cell",
            rows("Time,Boom_ref,Boom_meas,Arm_ref,Arm_meas", ",", with_unit, degrees).into(),
            deg,
            "Boom",
        ),
        ("a measurement below two headers", rows(lab, "\t", seconds, degrees).into(), deg, "Boom"),
        ("a row for each joint", long.into(), none, "Boom"),
        ("a block for each signal", blocks.into(), deg, "Boom"),
        (
            "UTF-16",
            wide(&rows("Zeit;Boom Soll [°];Boom Ist [°];Arm Soll [°];Arm Ist [°]", ";", comma_s, comma)),
            none,
            "Boom",
        ),
        ("Chinese", rows(chinese, ",", seconds, degrees).into(), none, "关节1"),
        ("Chinese of an old program", [&gbk[..], &below].concat(), none, "关节1"),
        (
            "French of an old program",
            [french, rows("", ";", comma_s, comma).as_bytes()].concat(),
            none,
            "Flèche",
        ),
        (
            "tenths of a degree",
            rows(tenths, ",", seconds, |q| format!("{:.3}", q * 10.0)).into(),
            none,
            "Boom",
        ),
        (
            "rostopic echo -p",
            rows(echo, ",", nanos, |q| format!("{:.6}", q.to_radians())).into(),
            none,
            "joint_0",
        ),
    ]
}

#[test]
fn one_run_is_the_same_in_every_form() {
    for (form, bytes, options, joint) in tables().into_iter().chain(loops()) {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.csv"), bytes).unwrap();
        let (code, text, error) =
            said(&hydrotrace(folder.path(), &[&["import", "a.csv", "-o", "a.mcap"], options].concat()));
        assert!(code == 0 || code == 3, "{form}: {error}");
        let log: Value = report(folder.path(), "a.mcap");
        let joints = log["joints"].as_array().unwrap();
        assert_eq!(joints.len(), 2, "{form}: {text}");
        assert_eq!(joints[0]["name"], joint, "{form}");
        for of_joint in joints {
            // The measurement is 0.1 s late at up to 0.26 rad/s.
            let peak = of_joint["tracking_error"]["peak"].as_f64().unwrap();
            assert!((peak - 0.026).abs() < 0.001, "{form}: {peak}");
        }
    }
}

#[test]
fn a_table_that_lacks_a_unit_gets_a_command_that_reads_it() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("a.csv"),
        rows("t,B_set,B_act,A_set,A_act", ",", seconds, |q| degrees(q + 20.0)),
    )
    .unwrap();
    let (code, _, error) = said(&hydrotrace(folder.path(), &["report", "a.csv"]));
    assert!(code == 1 && error.contains("`hydrotrace import a.csv --degrees -o a.mcap` reads it"), "{error}");
    let (code, text, error) =
        said(&hydrotrace(folder.path(), &["import", "a.csv", "--degrees", "-o", "run.mcap"]));
    assert_eq!(code, 0, "{text}{error}");
    let counts = rows("t,B_set,B_act,A_set,A_act", ",", seconds, |q| format!("{:.0}", 2048.0 + 11.4 * q));
    fs::write(folder.path().join("c.csv"), counts).unwrap();
    let (code, _, error) = said(&hydrotrace(folder.path(), &["report", "c.csv"]));
    assert!(
        code == 1
            && error.contains("steps of an encoder")
            && !error.contains("`hydrotrace import c.csv --degrees"),
        "{error}"
    );
    let errors = rows("t,B_pos,B_err,A_pos,A_err", ",", seconds, |q| format!("{:.5}", q.to_radians()));
    fs::write(folder.path().join("d.csv"), errors).unwrap();
    let (_, text, error) = said(&hydrotrace(folder.path(), &["import", "d.csv", "-o", "d.mcap"]));
    assert!(text.contains("say --planned B=measured+error,A=measured+error if the error"), "{text}{error}");
}

/// The run as `ros2 topic echo` and `rostopic echo` print the state of a controller: lists a line a number, or in brackets.
fn echoed(in_brackets: bool) -> String {
    let list = |values: [f64; 2]| match (in_brackets, values.map(|q| format!("{:e}", q.to_radians()))) {
        (true, [a, b]) => format!(" [{a}, {b}]"),
        (false, [a, b]) => format!("\n  - {a}\n  - {b}"),
    };
    let [sec, nanosec] = if in_brackets { ["secs", "nsecs"] } else { ["sec", "nanosec"] };
    let message = |k: u32| {
        let [a_planned, a_measured, b_planned, b_measured] = row(k);
        let (planned, measured) = (list([a_planned, b_planned]), list([a_measured, b_measured]));
        let (s, ns) = (1_790_000_000 + k / 50, k % 50 * 20_000_000);
        let since = format!("\n  time_from_start:\n    {sec}: 0\n    {nanosec}: 0\n");
        format!(
            "header:\n  stamp:\n    {sec}: {s}\n    {nanosec}: {ns}\n  frame_id: ''\njoint_names:\n- boom\n- 'arm'\n\
             desired:\n  positions:{planned}\n  velocities: []{since}actual:\n  positions:{measured}{since}---\n"
        )
    };
    (0..500).map(message).collect()
}

#[test]
fn a_topic_that_was_echoed_into_a_file_is_a_log() {
    let lost = "A message was lost!!!\n\ttotal count change:1\n\ttotal count: 1---\n";
    for text in
        [echoed(false), echoed(true), format!("{lost}{}", echoed(false)), echoed(false) + "header:\n  st"]
    {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("state.txt"), &text).unwrap();
        let log: Value = report(folder.path(), "state.txt");
        let joints = log["joints"].as_array().unwrap();
        assert_eq!(
            joints.iter().map(|joint| &joint["name"]).collect::<Vec<_>>(),
            ["boom", "arm"],
            "{text:.100}"
        );
        let duration_s = log["source"]["duration_s"].as_f64().unwrap();
        assert!((duration_s - 9.98).abs() < 1e-6, "{duration_s} s");
        for joint in joints {
            let peak = joint["tracking_error"]["peak"].as_f64().unwrap();
            assert!((peak - 0.026).abs() < 0.001, "{text:.100}: {peak}");
        }
    }
}
