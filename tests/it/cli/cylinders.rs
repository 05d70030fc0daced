//! Logs of cylinder lengths read as joint angles, and logs of angles reported at the cylinder.

use std::{fmt::Write as _, fs, fs::File, path::Path};

use hydrotrace::log::{LogWriter, Role, WriteOptions};
use serde_json::Value;

use super::csv::{report, sample};
use crate::support::{clean, json, run_line, said};

/// Of `sample-logs/arm/hydraulics.toml`: joint, a m, b m, delta deg. The angle between the mounts is delta less the joint's.
type Mounts = (&'static str, f64, f64, f64);
const MOUNTS: [Mounts; 6] = [
    ("J1", 0.4, 0.55, 170.0),
    ("J2", 0.7, 0.22, 180.0),
    ("J3", 0.6, 0.14, 57.5),
    ("J4", 0.22, 0.12, 90.0),
    ("J5", 0.22, 0.12, 90.0),
    ("J6", 0.22, 0.11, 90.0),
];

fn length_m((_, a, b, delta_deg): Mounts, angle_rad: f64) -> f64 {
    (a * a + b * b - 2.0 * a * b * (delta_deg.to_radians() - angle_rad).cos()).sqrt()
}

/// A table of plan and measurement: header and value of each joint by its angle.
fn table(run: &str, header: impl Fn(Mounts, &str) -> String, value: impl Fn(Mounts, f64) -> f64) -> String {
    let mut rows = csv::Reader::from_reader(run.as_bytes());
    let headers = rows.headers().unwrap().clone();
    let sides = [("planned", "set"), ("measured", "act")];
    let columns: Vec<(Mounts, usize, String)> = MOUNTS
        .into_iter()
        .flat_map(|mounts| sides.map(|(side, word)| (mounts, format!("{}_{side}_rad", mounts.0), word)))
        .map(|(mounts, name, word)| {
            (mounts, headers.iter().position(|other| other == name).unwrap(), header(mounts, word))
        })
        .collect();
    let names: Vec<&str> = columns.iter().map(|(.., name)| name.as_str()).collect();
    let mut text = format!("time_s,{}\n", names.join(","));
    for row in rows.records() {
        let row = row.unwrap();
        text += &row[1];
        for (mounts, at, _) in &columns {
            let cell = row[*at].parse().map(|angle| value(*mounts, angle).to_string());
            write!(text, ",{}", cell.unwrap_or_default()).unwrap();
        }
        text.push('\n');
    }
    text
}

/// A folder with the file of cylinders, `h.toml`, a run of the sample arm as `angles.csv`, and as a PLC logs it that has
/// sensors in all cylinders but the last: `lengths.csv`, in mm.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    put("h.toml", &fs::read_to_string(sample("arm/hydraulics.toml")).unwrap());
    let run = clean(folder.path(), &format!("export {} --csv", sample("task-1-run.mcap")));
    put("angles.csv", &table(&run, |(joint, ..), word| format!("{joint}_{word}_rad"), |_, angle| angle));
    let sensed = |(joint, ..): Mounts| joint != "J6";
    let header = |mounts: Mounts, word: &str| {
        let [mark, unit] = if sensed(mounts) { ["_cylinder", "mm"] } else { ["", "rad"] };
        format!("{}{mark}_{word}_{unit}", mounts.0)
    };
    let value = |mounts, angle| if sensed(mounts) { 1e3 * length_m(mounts, angle) } else { angle };
    put("lengths.csv", &table(&run, header, value));
    folder
}

/// Whether two documents hold the same, numbers within a share of 1e-5 or within 1e-7 of what they are.
fn same(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            (a - b).abs() <= 1e-7 + 1e-5 * a.abs().max(b.abs())
        }
        (Value::Array(a), Value::Array(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b)),
        (Value::Object(a), Value::Object(b)) => {
            a.len() == b.len()
                && a.iter().all(|(key, value)| b.get(key).is_some_and(|other| same(value, other)))
        }
        (a, b) => a == b,
    }
}

fn errors(report: &Value) -> Vec<(String, Value)> {
    let joints = report["joints"].as_array().unwrap().iter();
    joints
        .map(|joint| (joint["name"].as_str().unwrap().to_owned(), joint["tracking_error"].clone()))
        .collect()
}

fn fails(folder: &Path, line: &str) -> String {
    let (code, _, error) = said(&run_line(folder, line));
    assert_eq!(code, 1, "{line}: {error}");
    error
}

#[test]
fn lengths_of_cylinders_report_the_errors_of_the_angles() {
    let folder = folder();
    let angles = report(folder.path(), "angles.csv");
    let lengths = json(folder.path(), "report lengths.csv --hydraulics h.toml");
    assert_eq!(lengths["joints"][0]["unit"], "rad");
    for ((name, of_angles), (other, of_lengths)) in errors(&angles).iter().zip(&errors(&lengths)) {
        assert!(name == other && same(of_angles, of_lengths), "{name}: {of_angles} {of_lengths}");
    }
    let starts = |report: &Value| report["transitions"].as_array().unwrap().len();
    assert!(starts(&angles) > 15 && starts(&angles) == starts(&lengths));
    let peaks = |report: &Value| -> Vec<f64> {
        report["transitions"].as_array().unwrap().iter().map(|t| t["peak_error"].as_f64().unwrap()).collect()
    };
    for (a, b) in peaks(&angles).iter().zip(peaks(&lengths)) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
    // Without the file they are lengths under their own name.
    let (_, text, _) = said(&run_line(folder.path(), "report lengths.csv"));
    assert!(text.contains("J1_cylinder ") && text.contains(" 5.13 mm "), "{text}");
}

/// A stroke counts from the cylinder drawn in; lengths alone do not tell.
#[test]
fn a_length_called_a_stroke_is_doubted() {
    let folder = folder();
    let table = fs::read_to_string(folder.path().join("lengths.csv")).unwrap();
    fs::write(folder.path().join("strokes.csv"), table.replace("J2_cylinder", "J2_stroke")).unwrap();
    let remarks =
        |log: &str| json(folder.path(), &format!("report {log} --hydraulics h.toml"))["remarks"].to_string();
    let said = remarks("strokes.csv");
    assert!(
        said.contains("J2_stroke is called a stroke") && said.contains("sensor_zero_m of [joint.J2]"),
        "{said}"
    );
    assert!(!remarks("lengths.csv").contains("stroke"));
}

#[test]
fn a_run_in_angles_is_reported_at_the_cylinder_and_its_table_reads_back() {
    let folder = folder();
    let found = json(folder.path(), "report angles.csv --hydraulics h.toml --as cylinders");
    let table = fs::read_to_string(folder.path().join("angles.csv")).unwrap();
    for (at, mounts) in MOUNTS.into_iter().enumerate() {
        let joint = &found["joints"][at];
        assert_eq!((joint["name"].as_str(), joint["unit"].as_str()), (Some(mounts.0), Some("m")));
        let errors = table.lines().skip(1).filter_map(|row| {
            let mut cells = row.split(',').skip(1 + 2 * at).map(|cell| cell.parse::<f64>().ok());
            let [planned, measured] = [cells.next()??, cells.next()??].map(|angle| length_m(mounts, angle));
            Some((planned - measured).abs())
        });
        let peak_m = errors.fold(0.0, f64::max);
        let reported_m = joint["tracking_error"]["peak"].as_f64().unwrap();
        assert!((reported_m / peak_m - 1.0).abs() < 1e-3, "{joint}: {peak_m}");
    }
    // Out and back, speeds and command included.
    let log = sample("task-1-run.mcap");
    let out = format!("export {log} --hydraulics h.toml --as cylinders -o out.csv");
    clean(folder.path(), &out);
    let head = fs::read_to_string(folder.path().join("out.csv")).unwrap();
    assert!(
        head.starts_with("stamp_ns,time_s,J1_planned_m,J1_planned_m_s,J1_measured_m,J1_command_m,"),
        "{head:.200}"
    );
    clean(folder.path(), "import out.csv -o out.mcap");
    let (before, after) =
        (report(folder.path(), &log), json(folder.path(), "report out.mcap --hydraulics h.toml"));
    for ((name, before), (_, after)) in errors(&before).iter().zip(&errors(&after)) {
        assert!(same(before, after), "{name}: {before} {after}");
    }
}

#[test]
fn a_plan_in_angles_meets_a_measurement_of_lengths_by_the_words_of_their_names() {
    let folder = folder();
    let log = |name: &str, role, joint: &str, value: &dyn Fn(f64) -> f64| {
        let file = File::create(folder.path().join(name)).unwrap();
        let mut log = LogWriter::new(file, &[joint, "other"], WriteOptions::default()).unwrap();
        for k in 0..800_i64 {
            let angle_rad = 0.5 + 0.4 * (1.0 - (0.01 * k as f64).cos()).min(1.0);
            log.joint_sample(role, 10_000_000 * (k + 1), &[value(angle_rad), 0.0], &[], &[]).unwrap();
        }
        log.finish().unwrap();
    };
    log("plan.mcap", Role::Planned, "j1_joint", &|angle| angle);
    log("run.mcap", Role::Measured, "J1-Stroke", &|angle| length_m(MOUNTS[0], angle + 1e-3) - 0.8);
    let text = fs::read_to_string(folder.path().join("h.toml")).unwrap();
    let text = text.replacen("angle_sign = -1", "angle_sign = -1\nsensor_zero_m = 0.8", 1);
    fs::write(folder.path().join("strokes.toml"), text).unwrap();
    let found = json(folder.path(), "report plan.mcap run.mcap --hydraulics strokes.toml --joints J1-stroke");
    let error = &found["joints"][0]["tracking_error"];
    assert_eq!((&found["joints"][0]["name"], &found["joints"][0]["unit"]), (&"J1".into(), &"rad".into()));
    assert!((error["peak"].as_f64().unwrap() - 1e-3).abs() < 1e-9, "{error}");
    // At the cylinder, too.
    let found =
        json(folder.path(), "report plan.mcap run.mcap --hydraulics strokes.toml --as cylinders --joints J1");
    assert_eq!(found["joints"][0]["unit"], "m");
    // Taken as from mount to mount, strokes are no triangle at all.
    let error = fails(folder.path(), "report plan.mcap run.mcap --hydraulics h.toml --joints J1");
    assert!(
        error.contains("measured positions of J1 run 0.0")
            && error.contains("expected 0.1500 to 0.9500 m by the triangle")
            && error.contains("sensor_zero_m of [joint.J1]"),
        "{error}"
    );
}

#[test]
fn lengths_that_no_cylinder_has_are_dropped_and_counted() {
    let folder = folder();
    let text = fs::read_to_string(folder.path().join("lengths.csv")).unwrap();
    let rows = text.lines().enumerate().map(|(row, line)| {
        let mut cells: Vec<&str> = line.split(',').collect();
        // A sensor that says nothing for half a second.
        if (500..550).contains(&row) {
            cells[2] = "0";
        }
        cells.join(",") + "\n"
    });
    fs::write(folder.path().join("gap.csv"), rows.collect::<String>()).unwrap();
    let found = json(folder.path(), "report gap.csv --hydraulics h.toml");
    let remarks = found["remarks"].as_array().unwrap();
    let of =
        remarks.iter().find(|remark| remark["message"].as_str().unwrap().contains("cannot have")).unwrap();
    assert_eq!((&of["code"], &of["count"]), (&"implausible".into(), &50.into()));
    assert!(of["message"].as_str().unwrap().starts_with("measured samples of J1 "), "{of}");
    assert!(found["joints"][0]["tracking_error"]["peak"].as_f64().unwrap() < 0.1);
}

#[test]
fn what_does_not_fit_the_file_is_named() {
    let folder = folder();
    let path = folder.path();
    let h = fs::read_to_string(path.join("h.toml")).unwrap();
    fs::write(path.join("other.toml"), h.replace("joint.J", "joint.boom_")).unwrap();
    let error = fails(path, "report lengths.csv --hydraulics other.toml");
    assert!(
        error.contains("found no joint of other.toml (boom_1, boom_2,") && error.contains("J1_cylinder"),
        "{error}"
    );
    let error = fails(path, "report lengths.csv --hydraulics none.toml");
    assert!(error.contains("cannot read none.toml"), "{error}");
    // Of the sample arm the URDF in the log tells the limits, within which J1 passes a dead centre here.
    fs::write(path.join("dead.toml"), h.replacen("delta_rad = 2.96", "delta_rad = 3.96", 1)).unwrap();
    fs::copy(sample("arm/arm.urdf"), path.join("arm.urdf")).unwrap();
    let error = fails(path, "report lengths.csv --hydraulics dead.toml --urdf arm.urdf");
    assert!(
        error.contains("dead.toml: [joint.J1] delta_rad: found") && error.contains("no dead centre"),
        "{error}"
    );
    let in_mm = fs::read_to_string(path.join("lengths.csv")).unwrap().replace("_mm", "_m");
    fs::write(path.join("mm.csv"), in_mm).unwrap();
    let error = fails(path, "report mm.csv --hydraulics h.toml");
    assert!(error.contains("none is left; they fit as mm"), "{error}");
    assert_eq!(said(&run_line(path, "report angles.csv --as cylinders")).0, 2);
    // Angles that nothing says are angles stay so, with a remark.
    let remarks = json(path, "report angles.csv --hydraulics h.toml")["remarks"].to_string();
    assert!(remarks.contains("all are taken as angles; --slides NAME"), "{remarks}");
}
