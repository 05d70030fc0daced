//! CSV files into logs and logs into tables, at the built binary and in the library.

use std::{fs, path::Path};

use hydrotrace::log::{CsvOptions, read_csv_bytes};
use proptest::prelude::*;
use serde_json::Value;

use crate::support::{run_args as hydrotrace, said, timed};

const SAMPLES: [&str; 5] = ["panel-install", "still-joint", "gaps", "power-loss", "trajectory-only"];

pub(super) fn report(folder: &Path, log: &str) -> Value {
    serde_json::from_slice(&hydrotrace(folder, &["report", log, "--json"]).stdout).unwrap()
}

pub(super) fn sample(name: &str) -> String {
    crate::support::sample(name).to_str().unwrap().to_owned()
}

/// Imports a text and gives exit code, standard output, standard error.
pub(super) fn import(text: impl AsRef<[u8]>, args: &[&str]) -> (i32, String, String) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.csv"), text).unwrap();
    said(&hydrotrace(folder.path(), &[&["import", "a.csv", "-o", "a.mcap"], args].concat()))
}

/// A joint that is asked to move by 0.5 rad at 2 s and follows 0.1 s later, sampled at 50 Hz.
pub(super) fn moves(t_s: f64) -> [f64; 2] {
    let at = |t_s: f64| 0.25 * (1.0 - ((t_s - 2.0).clamp(0.0, 3.0) / 3.0 * std::f64::consts::PI).cos());
    [at(t_s), at(t_s - 0.1)]
}

/// Rows of that joint below a header, with a time in the given unit.
pub(super) fn trace(header: &str, per_second: f64, separator: &str, scale: f64) -> String {
    timed(header, (500, 0.02), |t_s| {
        let [planned, measured] = moves(t_s).map(|q| q * scale);
        format!("{}{separator}{planned}{separator}{measured}", t_s * per_second)
    })
}

#[test]
fn an_exported_log_that_is_imported_again_reports_the_same_numbers() {
    for name in SAMPLES {
        let folder = tempfile::tempdir().unwrap();
        let log = sample(&format!("{name}.mcap"));
        let exported = hydrotrace(folder.path(), &["export", &log, "--csv", "-o", "a.csv"]);
        let (code, _, error) = said(&exported);
        assert!(code == 0 || code == 3, "{name}: {error}");
        let (code, text, error) = said(&hydrotrace(folder.path(), &["import", "a.csv", "-o", "a.mcap"]));
        assert_eq!((code, error.as_str()), (0, ""), "{name}: {text}");
        let (before, after) = (report(folder.path(), &log), report(folder.path(), "a.mcap"));
        for part in ["alignment", "joints", "transitions", "stops", "whole_run", "rules"] {
            assert_eq!(before[part], after[part], "{part} of {name}");
        }
        assert_eq!(before["source"]["epoch_ns"], after["source"]["epoch_ns"]);
        assert_eq!(before["source"]["duration_s"], after["source"]["duration_s"]);
    }
}

#[test]
fn degrees_and_radians_of_an_export_mean_the_same_run() {
    let folder = tempfile::tempdir().unwrap();
    let log = sample("gaps.mcap");
    hydrotrace(folder.path(), &["export", &log, "--csv", "--degrees", "-o", "a.csv"]);
    let head = fs::read_to_string(folder.path().join("a.csv")).unwrap();
    assert!(
        head.starts_with("stamp_ns,time_s,joint_1_planned_deg,joint_1_planned_deg_s,joint_1_measured_deg,")
    );
    assert_eq!(said(&hydrotrace(folder.path(), &["import", "a.csv", "-o", "a.mcap"])).0, 0);
    let (before, after) = (report(folder.path(), &log), report(folder.path(), "a.mcap"));
    let rms = |report: &Value| report["joints"][2]["tracking_error"]["rms"].as_f64().unwrap();
    assert!((rms(&before) / rms(&after) - 1.0).abs() < 1e-9);
    assert_eq!(before["alignment"], after["alignment"]);
}

#[test]
fn the_error_of_an_export_is_the_one_that_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let log = sample("panel-install.mcap");
    let (_, text, _) = said(&hydrotrace(folder.path(), &["export", &log, "--csv", "--joints", "joint_3"]));
    let mut table = csv::Reader::from_reader(text.as_bytes());
    let names = table.headers().unwrap().clone();
    assert_eq!(
        names.iter().collect::<Vec<_>>(),
        [
            "stamp_ns", "time_s", "joint_3_planned_rad", "joint_3_planned_rad_s", "joint_3_measured_rad",
            "joint_3_error_rad"
        ]
    );
    let errors = table.records().filter_map(|row| row.unwrap()[5].parse::<f64>().ok());
    let peak = errors.fold(0.0_f64, |most, error| most.max(error.abs()));
    let reported = &report(folder.path(), &log)["joints"][2];
    assert_eq!(reported["name"], "joint_3");
    assert_eq!(reported["tracking_error"]["peak"].as_f64(), Some(peak));
}

#[test]
fn a_parquet_file_holds_what_the_csv_file_holds() {
    use parquet::{
        file::reader::{FileReader, SerializedFileReader},
        record::RowAccessor,
    };
    let folder = tempfile::tempdir().unwrap();
    let log = sample("gaps.mcap");
    let bytes = || {
        let (code, text, _) =
            said(&hydrotrace(folder.path(), &["export", &log, "--parquet", "-o", "a.parquet"]));
        assert_eq!((code, text.as_str()), (3, "4001 rows, 26 columns written to a.parquet.\n"));
        fs::read(folder.path().join("a.parquet")).unwrap()
    };
    let first = bytes();
    assert!(first == bytes(), "two exports of one log differ");
    let (_, text, _) = said(&hydrotrace(folder.path(), &["export", &log, "--csv"]));
    let mut table = csv::Reader::from_reader(text.as_bytes());
    let reader = SerializedFileReader::new(fs::File::open(folder.path().join("a.parquet")).unwrap()).unwrap();
    let mut rows = 0;
    for (row, record) in reader.get_row_iter(None).unwrap().zip(table.records()) {
        let (row, record) = (row.unwrap(), record.unwrap());
        assert_eq!(row.get_long(0).unwrap().to_string(), record[0]);
        assert_eq!(row.get_double(1).unwrap().to_string(), record[1]);
        for column in 2..26 {
            let cell = row.get_double(column).map(|value| value.to_string()).unwrap_or_default();
            assert_eq!(cell, record[column], "row {rows}, column {column}");
        }
        rows += 1;
    }
    assert_eq!(rows, 4001);
    assert!(table.records().next().is_none());
}

#[test]
fn the_trace_of_a_plc_is_understood_without_help() {
    let folder = tempfile::tempdir().unwrap();
    let (code, text, error) =
        said(&hydrotrace(folder.path(), &["import", &sample("plc-trace.csv"), "-o", "a.mcap"]));
    assert_eq!((code, error.as_str()), (0, ""), "{text}");
    assert!(text.contains("separated by semicolon, decimal comma"), "{text}");
    assert!(text.contains("line 2, units below it"), "{text}");
    assert!(text.contains("Zeitstempel: dd.mm.yyyy hh:mm:ss, no zone, taken as UTC"), "{text}");
    let report = report(folder.path(), "a.mcap");
    assert_eq!(report["source"]["epoch_ns"], 1_750_000_000_000_000_000_i64);
    assert_eq!(report["remarks"], Value::Array(Vec::new()));
    // As sample-logs/README.md says: joint_3 is asked at 3.241 s and leaves 0.25 s later.
    let transitions = report["transitions"].as_array().unwrap();
    let first = transitions.iter().find(|t| t["joint"] == "joint_3").unwrap();
    let of = |key: &str| first[key].as_f64().unwrap();
    assert!((of("planned_onset_s") - 3.241).abs() < 0.04, "{first}");
    assert!((of("onset_delay_s") - 0.25).abs() < 0.04, "{first}");
}

#[test]
fn an_rtde_recording_is_in_radians_and_seconds() {
    let header = "timestamp target_q_0 actual_q_0";
    let (code, text, _) = import(trace(header, 1.0, " ", 1.0), &[]);
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("target_q_0  planned position   joint_0   rad (RTDE)"), "{text}");
    assert!(text.contains("9.98 s at 50.0 Hz"), "{text}");
}

#[test]
fn pairs_of_many_names_are_found() {
    for (planned, measured) in [
        ("J1 Soll [deg]", "J1 Ist [deg]"),
        ("q_ref_deg", "q_meas_deg"),
        ("planned.J1 (deg)", "measured.J1 (deg)"),
        ("Achse1SollPos [°]", "Achse1IstPos [°]"),
        ("J1_set_deg", "J1_act_deg"),
        ("GVL.fSetPos[1] in °", "GVL.fActPos[1] in °"),
        ("/planned/joint_states/J1/position [deg]", "/joint_states/J1/position [deg]"),
    ] {
        let (code, text, error) = import(trace(&format!("t;{planned};{measured}"), 1.0, ";", 30.0), &[]);
        assert_eq!((code, error.as_str()), (0, ""), "{planned}: {text}");
        assert!(text.contains("planned position") && text.contains("measured position"), "{text}");
    }
}

#[test]
fn times_in_any_unit_are_the_same_run() {
    let mut logs = Vec::new();
    for (header, per_second, args) in [
        ("t [s];J1 soll [deg];J1 ist [deg]", 1.0, &[][..]),
        ("t [ms];J1 soll [deg];J1 ist [deg]", 1e3, &[]),
        ("time_us;J1 soll [deg];J1 ist [deg]", 1e6, &[]),
        ("Zeit;J1 soll [deg];J1 ist [deg]", 1e3, &["--time-unit", "ms"]),
        ("zyklus;J1 soll [deg];J1 ist [deg]", 1.0, &["--rate", "50"]),
        ("zyklus;J1 soll [deg];J1 ist [deg]", 1e9, &["--time", "Zyklus", "--time-unit", "ns"]),
    ] {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.csv"), trace(header, per_second, ";", 30.0)).unwrap();
        let run = hydrotrace(folder.path(), &[&["import", "a.csv", "-o", "a.mcap"], args].concat());
        assert_eq!(said(&run).0, 0, "{header}: {run:?}");
        let mut report = report(folder.path(), "a.mcap");
        logs.push(report["transitions"].take());
    }
    assert_eq!(logs[0].as_array().unwrap().len(), 1);
    assert!(logs.iter().all(|log| *log == logs[0]));
}

#[test]
fn flags_and_a_map_file_say_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let rows = trace("a;b;c", 1e3, ";", 30.0);
    let rows: String = rows.lines().map(|line| format!("{line};2,5\n").replace('.', ",")).collect();
    fs::write(folder.path().join("a.csv"), rows.replacen("2,5", "p [bar]", 1)).unwrap();
    let map = "time = \"a\"\ntime_unit = \"ms\"\nangle_unit = \"deg\"\nseparator = \";\"\ndecimal_comma = true\n\
               [planned]\nJ1 = \"b\"\n[measured]\nJ1 = \"#3\"\n[interface.cap_pressure_pa]\nJ1 = \"p [bar]\"\n";
    fs::write(folder.path().join("a.toml"), map).unwrap();
    let by_map = hydrotrace(folder.path(), &["import", "a.csv", "-o", "a.mcap", "--map", "a.toml"]);
    assert_eq!(said(&by_map).0, 0, "{by_map:?}");
    let flags = "import a.csv -o b.mcap --time a --time-unit ms --degrees --separator ; --decimal-comma \
                 --planned J1=b --measured J1=#3";
    let mut flags: Vec<&str> = flags.split_whitespace().collect();
    flags.extend(["--interface", "cap_pressure_pa:J1=p [bar]"]);
    assert_eq!(said(&hydrotrace(folder.path(), &flags)).0, 0);
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(bytes("a.mcap") == bytes("b.mcap"), "the logs differ");
    let field = ["report", "a.mcap", "--json", "--measured", "/dynamic_joint_states:cap_pressure_pa"];
    let text = said(&hydrotrace(folder.path(), &field)).1;
    let report: Value = serde_json::from_str(&text).unwrap();
    let peak = report["joints"][0]["tracking_error"]["peak"].as_f64().unwrap();
    assert!((peak - 2.5e5).abs() < 1e3, "2.5 bar are {peak} Pa");
}

#[test]
fn what_is_guessed_is_a_remark() {
    let header = "t [s];q1_soll;q1_ist";
    for (text, args, code, hint) in [
        (trace(header, 1.0, ";", 1.0), &[][..], "guessed", "--degrees"),
        (trace("t;J1 soll [rad];J1 ist [rad]", 1e3, ";", 1.0), &[], "guessed", "--time-unit"),
        (trace("t [s];J1 soll [rad];J1 ist", 1.0, ";", 1.0), &[], "guessed", "taken as rad"),
        (trace("t [s];J1 ist [rad];druck", 1.0, ";", 1.0), &[], "one-side", "--planned J1=COLUMN"),
        (
            trace("t [s];J1 soll [rad];J1 ist [rad]", 1.0, ";", 1.0) + "11;0\n",
            &[],
            "length-mismatch",
            "line 502",
        ),
        (
            trace("t [s];J1 soll [rad];J1 ist [rad]", 1.0, ";", 1.0) + "11;x;0\n",
            &[],
            "not-finite",
            "\"x\" in line 502",
        ),
        (
            trace("t [s];J1 soll [rad];J1 ist [rad]", 1.0, ";", 1.0) + "nie;0;0\n",
            &[],
            "unusable-stamp",
            "\"nie\"",
        ),
        (trace("t [s];J1 soll [rad];J1 ist [rad]", 1.0, ";", 1.0) + "1;0;0\n", &[], "reordered", "earlier"),
    ] {
        let (exit, said, _) = import(&text, args);
        assert_eq!(exit, 3, "{code}: {said}");
        assert!(said.contains(code) && said.contains(hint), "{code}: {said}");
    }
}

#[test]
fn what_is_not_understood_is_an_error_that_names_the_way_out() {
    let good = trace("t [s];J1 soll [deg];J1 ist [deg]", 1.0, ";", 30.0);
    let headless = good.split_once('\n').unwrap().1.to_owned();
    for (text, args, column, fix) in [
        (trace("t;q1_soll;q1_ist", 1.0, ";", 30.0), &[][..], "\"q1_soll\"", "say --degrees, --radians"),
        (trace("x;J1 soll;J1 ist", 1.0, ";", 1.0), &[], "x, J1 soll", "--time COLUMN, or --rate HZ"),
        (trace("t;alpha;beta", 1.0, ";", 1.0), &[], "t, alpha, beta", "--planned JOINT=COLUMN"),
        (trace("t;J1 soll;J2 ist", 1.0, ";", 1.0), &[], "of J1", "--measured JOINT=COLUMN"),
        (trace("t;J1 soll;J1 target", 1.0, ";", 1.0), &[], "\"J1 target\" (#3)", "--planned J1=#N"),
        (
            good.clone(),
            &["--planned", "J1=J1 sol [deg]"],
            "\"J1 sol [deg]\"",
            "did you mean \"J1 soll [deg]\"",
        ),
        (good.clone(), &["--decimal-comma"], "\"t [s]\"", "--decimal-point"),
        (
            good.replace('.', ","),
            &["--decimal-point", "--rate", "50"],
            "\"J1 soll [deg]\"",
            "--decimal-comma",
        ),
        (good.clone(), &["--time", "J1 ist [deg]"], "\"J1 ist [deg]\"", "no time"),
        (
            trace("t [s];J1 soll [mm];J1 ist [deg]", 1.0, ";", 1.0),
            &["--planned", "J1=#2"],
            "J1 are in mm and in deg",
            "a joint turns",
        ),
        (trace("t;J1 soll;J1 ist", 0.0, ";", 1.0), &["--degrees"], "\"t\"", "--time-unit"),
        (headless, &[], "column_2", "--time '#1'"),
        (good.clone(), &["--separator", "|"], "two columns", "--separator CHAR"),
        (good.clone(), &["--rate", "0"], "--rate 0", "samples a second"),
        (good.clone(), &["--time-unit", "deg"], "--time-unit deg", "s, ms, us, ns, min, h"),
        (good.clone(), &["--planned", "J1=#2", "--measured", "J1=#2"], "(#2)", "two things"),
        (good, &["--map", "missing.toml"], "missing.toml", "map"),
        (String::new(), &[], "empty", "--separator"),
        ("t;q\0;1\n".to_owned(), &[], "byte 4 is zero", "text file"),
    ] {
        let (code, said, error) = import(&text, args);
        assert_eq!((code, said.as_str()), (1, ""), "{args:?} {fix}");
        assert!(
            error.starts_with("error: ") && error.contains(column) && error.contains(fix),
            "{fix}: {error}"
        );
    }
    assert_eq!(import("", &["--separator", "ab"]).0, 2);
    assert_eq!(import("", &["--rate", "50", "--time", "t"]).0, 2);
}

#[test]
fn a_failed_import_leaves_nothing_and_the_source_is_never_written_over() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.csv"), "no table").unwrap();
    assert_eq!(said(&hydrotrace(folder.path(), &["import", "a.csv", "-o", "b.mcap"])).0, 1);
    assert_eq!(said(&hydrotrace(folder.path(), &["import", "a.csv", "-o", "a.csv"])).0, 1);
    let names: Vec<_> =
        fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(names, ["a.csv"]);
    assert_eq!(fs::read_to_string(folder.path().join("a.csv")).unwrap(), "no table");
    let log = sample("still-joint.mcap");
    fs::copy(&log, folder.path().join("a.mcap")).unwrap();
    assert_eq!(said(&hydrotrace(folder.path(), &["export", "a.mcap", "--csv", "-o", "a.mcap"])).0, 1);
    assert!(fs::read(&log).unwrap() == fs::read(folder.path().join("a.mcap")).unwrap());
}

#[test]
fn the_understanding_is_one_json_document() {
    let (code, text, error) = import(trace("t;q1_soll;q1_ist", 1.0, ";", 1.0), &["--json"]);
    assert_eq!(code, 3);
    assert!(error.contains("remark: guessed x2"), "{error}");
    let document: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(document["format"], "hydrotrace.import.v1");
    let understood = &document["understood"];
    assert_eq!(understood["rows"], 500);
    assert_eq!(understood["columns"][0]["becomes"], "planned position");
    assert_eq!(understood["columns"][1]["unit_from"], "guess");
    assert_eq!(document["remarks"][0]["code"], "guessed");
}

#[test]
fn hostile_files_end_in_an_answer() {
    let rows = trace("t;J1 soll [deg];J1 ist [deg]", 1.0, ";", 30.0);
    let huge = format!("{rows}\"{}\n", "9".repeat(2_000_000));
    let unclosed = rows.replacen("0.02;", "\"0.02;", 1);
    let nan: String = rows.replace(";0\n", ";NaN\n");
    for text in
        [huge, unclosed, nan, "\"".repeat(10_000), ";".repeat(100_000), "1;2\n".repeat(3), "#\n#\n".into()]
    {
        let (code, _, error) = import(&text, &[]);
        assert!(code == 1 || code == 3, "{code} {error}");
        assert!(code == 3 || error.starts_with("error: "), "{error}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_bytes_make_the_reader_panic(bytes in proptest::collection::vec(any::<u8>(), 0..600)) {
        let _ = read_csv_bytes("a.csv", &bytes, &CsvOptions::default()).map(|run| run.write(Vec::new()));
    }

    #[test]
    fn no_text_of_the_kind_makes_the_reader_panic(text in "([#tqJ1solit \\[\\]°_a-f]{0,9}[;, \t]){1,4}\n(([-+0-9.,e:TZ\"#]{0,12}[;, \t]){1,4}[\r]?\n){0,12}") {
        let _ = read_csv_bytes("a.csv", text.as_bytes(), &CsvOptions::default()).map(|run| run.write(Vec::new()));
    }

    #[test]
    fn no_damage_to_a_trace_makes_the_reader_panic(
        at in 0_usize..4000,
        with in proptest::collection::vec(any::<u8>(), 0..8),
        cut in 0_usize..8000,
    ) {
        let mut bytes = trace("t;J1 soll [deg];J1 ist [deg]", 1.0, ";", 30.0).into_bytes();
        bytes.splice(at..at + 4, with);
        bytes.truncate(cut);
        let options = CsvOptions { rate_hz: (at % 3 == 0).then_some(50.0), ..CsvOptions::default() };
        let _ = read_csv_bytes("a.csv", &bytes, &options).map(|run| run.write(Vec::new()));
    }
}
