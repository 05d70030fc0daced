//! Tables as historians, databases, spreadsheets and scopes write them: the same run, or a refusal that says what to do.

use std::{fmt::Write as _, fs, path::Path};

use serde_json::Value;

use super::csv::{moves, report};
use crate::support::{run_args as hydrotrace, said};

/// Planned and measured angle of the boom, deg, 50 times a second; the measurement is 0.1 s late at up to 0.26 rad/s.
fn angles(k: u32) -> [f64; 2] {
    moves(f64::from(k) * 0.02).map(f64::to_degrees)
}

const ROWS: u32 = 500;

/// A header and a line for each row.
fn table(head: &str, line: impl Fn(u32, [f64; 2]) -> String) -> String {
    (0..ROWS).fold(format!("{head}\n"), |mut text, k| {
        writeln!(text, "{}", line(k, angles(k))).unwrap();
        text
    })
}

/// Peak of the tracking error of the first joint, rad, after an import with these options.
fn peak(folder: &Path, name: &str, text: &str, options: &[&str]) -> f64 {
    fs::write(folder.join(name), text).unwrap();
    let line = [&["import", name, "-o", "a.mcap", "--force"], options].concat();
    let (code, out, error) = said(&hydrotrace(folder, &line));
    assert!(code == 0 || code == 3, "{name}: {out}{error}");
    let log: Value = report(folder, "a.mcap");
    assert_eq!(log["joints"].as_array().map(Vec::len), Some(1), "{name}");
    log["joints"][0]["tracking_error"]["peak"].as_f64().unwrap()
}

fn assert_peak(name: &str, text: &str, options: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let found = peak(folder.path(), name, text, options);
    assert!((found - 0.026).abs() < 0.001, "{name}: {found}");
}

#[test]
fn times_in_any_unit_and_in_parts_are_one_run() {
    let head = |time: &str| format!("{time},boom_set_deg,boom_act_deg");
    let of = |time: &str, cell: &dyn Fn(u32) -> String| {
        table(&head(time), |k, [plan, came]| format!("{},{plan:.4},{came:.4}", cell(k)))
    };
    let s = |k: u32| f64::from(k) * 0.02;
    let whole = |k: u32| (k / 50, k % 50 * 20);
    for (name, text) in [
        ("minutes.csv", of("elapsed_min", &|k| format!("{:.9}", s(k) / 60.0))),
        ("hours.csv", of("time [h]", &|k| format!("{:.12}", s(k) / 3600.0))),
        ("ticks.csv", of("time [10 ms]", &|k| (2 * k).to_string())),
        ("hundredths.csv", of("Time [1/100 s]", &|k| (2 * k).to_string())),
        ("filetime.csv", of("Time", &|k| (133_932_816_000_000_000_u64 + u64::from(k) * 200_000).to_string())),
        ("dotnet.csv", of("Time", &|k| (638_844_336_000_000_000_u64 + u64::from(k) * 200_000).to_string())),
        ("excel.csv", of("Time", &|k| format!("{:.10}", 45_811.375 + s(k) / 86_400.0))),
        ("matlab.csv", of("Time", &|k| format!("03-Jun-2025 09:00:{:02}.{:03}", whole(k).0, whole(k).1))),
        ("index.csv", of("", &|k| format!("{:.2}", s(k)))),
        ("dates.csv", of("", &|k| format!("2025-06-03 09:00:{:02}.{:03}", whole(k).0, whole(k).1))),
        ("deltas.csv", of("index", &|k| format!("0 days 00:00:{:02}.{:03}000", whole(k).0, whole(k).1))),
        ("plc.csv", of("time", &|k| format!("T#{}S{}MS", whole(k).0, whole(k).1))),
        ("passed.csv", of("time", &|k| format!("00:{:02}.{:03}", whole(k).0, whole(k).1))),
        ("digits.csv", of("time", &|k| format!("202506030900{:02}{:03}", whole(k).0, whole(k).1))),
        ("basic.csv", of("Time", &|k| format!("20250603T0900{:02}.{:03}Z", whole(k).0, whole(k).1))),
        (
            "stamp.csv",
            of("header.stamp.sec,header.stamp.nanosec", &|k| {
                format!("{},{}", 1_749_000_000 + whole(k).0, whole(k).1 * 1_000_000)
            }),
        ),
        (
            "millis.csv",
            of("Date,Time,Millitm", &|k| format!("06/03/2025,09:00:{:02},{}", whole(k).0, whole(k).1)),
        ),
    ] {
        assert_peak(name, &text, &[]);
    }
}

#[test]
fn the_newest_row_may_come_first() {
    let head = "time_s,boom_set_deg,boom_act_deg";
    let text = table(head, |k, _| {
        let k = ROWS - 1 - k;
        let [plan, came] = angles(k);
        format!("{:.2},{plan:.4},{came:.4}", f64::from(k) * 0.02)
    });
    assert_peak("newest.csv", &text, &[]);
}

#[test]
fn thousands_may_be_set_apart() {
    let of = |separator: &str, number: &dyn Fn(f64) -> String| {
        let head = ["t_ms", "boom_set [0.001 deg]", "boom_act [0.001 deg]"].join(separator);
        table(&head, |k, both| {
            let [plan, came] = both.map(|deg| number((1000.0 * deg).round()));
            [(20 * k).to_string(), plan, came].join(separator)
        })
    };
    // Never below a thousand but at rest, where whole numbers tell.
    let grouped = |mark: &str, value: f64| {
        let (sign, size) = (if value < 0.0 { "-" } else { "" }, value.abs());
        let (thousands, rest) = ((size / 1000.0).floor(), size % 1000.0);
        if thousands > 0.0 { format!("{sign}{thousands}{mark}{rest:03}") } else { format!("{sign}{rest}") }
    };
    assert_peak("points.csv", &of(";", &|value| grouped(".", value)), &[]);
    assert_peak("commas.csv", &of(";", &|value| grouped(",", value)), &[]);
    assert_peak("quoted.csv", &of(",", &|value| format!("\"{}.0\"", grouped(",", value))), &[]);
    assert_peak("apostrophes.csv", &of(",", &|value| grouped("'", value)), &[]);
    assert_peak("blanks.csv", &of(";", &|value| grouped("\u{202f}", value).replace('-', "\u{2212}")), &[]);
}

#[test]
fn a_long_table_may_have_words_beside_each_value_and_each_signal_a_clock() {
    let long = table("time_s,signal,value,quality,unit", |k, [plan, came]| {
        let t = f64::from(k) * 0.02;
        format!("{t:.2},boom_set_deg,{plan:.4},Good,deg\n{t:.2},boom_act_deg,{came:.4},Good,deg")
    });
    assert_peak("long.csv", &long, &[]);
    let stamp = |k: u32| format!("31-Aug-2024 10:59:{:02}.{:03}", 50 + k / 50 % 10, k % 50 * 20);
    let named = |tag: &str, k: u32, value: f64| format!("{tag},{},{value:.3}", stamp(k));
    let turns = table("Tag,Timestamp,Value", |k, [plan, came]| {
        [named("BOOM_PV", k, came), named("BOOM_SP", k, plan)].join("\n")
    });
    assert_peak("turns.csv", &turns, &["--degrees"]);
    let block = |tag: &str, side: usize| table("", |k, both| named(tag, k, both[side]));
    let blocks = format!("Tag,Timestamp,Value{}{}", block("BOOM_SP", 0), block("BOOM_PV", 1).trim_start());
    assert_peak("blocks.csv", &blocks, &["--degrees"]);
    let clocks = table("t_set_s,boom_set_deg,t_act_s,boom_act_deg", |k, [plan, _]| {
        // The second channel was begun a quarter of a second later.
        let [_, came] = moves(f64::from(k) * 0.02 + 0.25).map(f64::to_degrees);
        let t = f64::from(k) * 0.02;
        format!("{t:.2},{plan:.4},{:.2},{came:.4}", t + 0.25)
    });
    assert_peak("clocks.csv", &clocks, &[]);
}

#[test]
fn an_archive_counts_millionths_of_days_beside_a_date() {
    let line = |k: u32, signal, value| {
        let number = |value: f64| format!("{value:.6}").replace('.', ",");
        let days = number(45_811.375e6 + f64::from(k) * 0.02 / 0.0864);
        format!("\"boom_{signal}\";\"03.06.2025 09:00:{:02}\";{};1;{days}", k / 50, number(value))
    };
    let of = |k: u32, [plan, came]: [f64; 2]| {
        format!("{}\n{}", line(k, "set_deg", plan), line(k, "act_deg", came))
    };
    assert_peak(
        "wincc.csv",
        &table("\"VarName\";\"TimeString\";\"VarValue\";\"Validity\";\"Time_ms\"", of),
        &[],
    );
}

#[test]
fn units_may_stand_behind_the_numbers() {
    let text = table("Time,boom set,boom act", |k, [plan, came]| {
        format!("{:.2} s,{plan:.4}\u{b0},{came:.4}\u{b0}", f64::from(k) * 0.02)
    });
    assert_peak("board.csv", &text, &[]);
    let text = table("t_s,boom_set [deg*10],boom_act [deg*10]", |k, [plan, came]| {
        format!("{:.2},{:.3},{:.3}", f64::from(k) * 0.02, 10.0 * plan, 10.0 * came)
    });
    assert_peak("tenths.csv", &text, &[]);
}

#[test]
fn a_column_that_counts_rows_is_no_time() {
    let folder = tempfile::tempdir().unwrap();
    // All rows, those of a part of a run, every tenth row.
    for (from, step) in [(0, 1), (1500, 1), (0, 10)] {
        let text = table(",boom_set_deg,boom_act_deg", |k, [plan, came]| {
            format!("{},{plan:.4},{came:.4}", from + step * k)
        });
        fs::write(folder.path().join("rows.csv"), text).unwrap();
        let (code, _, error) = said(&hydrotrace(folder.path(), &["report", "rows.csv"]));
        assert!(code == 1 && error.contains("--rate HZ"), "{from}, {step}: {error}");
    }
}

#[test]
fn objects_a_line_each_are_a_table() {
    let of = |k: u32, [plan, came]: [f64; 2]| {
        let t = f64::from(k) * 0.02;
        let came = if k == 0 { String::new() } else { format!(", \"boom_act_deg\": {came:.4}") };
        format!("{{\"t_s\": {t:.2}, \"boom_set_deg\": {plan:.4}{came}}}")
    };
    let lines = table("", of);
    assert_peak("lines.jsonl", lines.trim_start(), &[]);
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("lines.jsonl"), lines.trim_start()).unwrap();
    let (code, text, error) = said(&hydrotrace(folder.path(), &["report", "lines.jsonl"]));
    assert!(code == 0 && text.contains("boom"), "{text}{error}");
}

#[test]
fn objects_of_one_side_each_are_a_table_and_a_map_keeps_both() {
    let one = |t: f64, side: &str, q: f64| match side {
        "" => String::new(),
        side if side.starts_with('+') => {
            format!("{{\"t_s\": {t:.3}, \"kind\": \"{}\", \"boom_deg\": {q:.4}}}\n", &side[1..])
        }
        side => format!("{{\"t_s\": {t:.3}, \"{side}\": {{\"boom_deg\": {q:.4}}}}}\n"),
    };
    for [plan, came] in [["planned", "measured"], ["+plan", "+actual"]] {
        let lines = table("", |k, q| {
            let t = f64::from(k) * 0.02;
            one(t, plan, q[0]) + one(t + 0.005, came, q[1]).trim_end()
        });
        let folder = tempfile::tempdir().unwrap();
        let save = ["--save-map", "arm.toml"];
        let first = peak(folder.path(), "lines.jsonl", lines.trim_start(), &save);
        let again = peak(folder.path(), "lines.jsonl", lines.trim_start(), &["--map", "arm.toml"]);
        // The measurement is stamped 5 ms later than it is.
        assert!((first - 0.0275).abs() < 0.001 && first == again, "{plan}: {first} {again}");
    }
}

#[test]
fn a_plan_that_is_written_only_where_it_changes_is_held() {
    let head = "time_s,boom_set_deg,boom_act_deg";
    let text = table(head, |k, [plan, came]| {
        let same = k > 0 && angles(k - 1)[0] == plan;
        let plan = if same { String::new() } else { format!("{plan:.6}") };
        format!("{:.2},{plan},{came:.4}", f64::from(k) * 0.02)
    });
    let folder = tempfile::tempdir().unwrap();
    let found = peak(folder.path(), "changes.csv", &text, &[]);
    assert!((found - 0.026).abs() < 0.001, "{found}");
    let (code, text, _) = said(&hydrotrace(folder.path(), &["report", "a.mcap"]));
    assert!(code == 3 && text.contains("written only where it changes"), "{text}");
    let starts = report(folder.path(), "a.mcap")["joints"][0]["starts"].clone();
    assert!(starts.as_u64().is_some_and(|starts| starts > 0), "{starts}");
}

#[test]
fn a_table_of_two_machines_is_read_of_one() {
    let head = "time_s,machine,boom_set_deg,boom_act_deg";
    let text = table(head, |k, [plan, came]| {
        let t = f64::from(k) * 0.02;
        format!("{t:.2},EX1,{plan:.4},{came:.4}\n{:.3},EX2,{plan:.4},{:.4}", t + 0.004, 0.5 * came)
    });
    assert_peak("one.csv", &text, &["--only", "machine=EX1"]);
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("two.csv"), &text).unwrap();
    for line in [&["report", "two.csv"][..], &["import", "two.csv", "-o", "a.mcap"]] {
        let (code, _, error) = said(&hydrotrace(folder.path(), line));
        assert!(code == 1 && error.contains("--only 'machine=EX1'"), "{error}");
    }
    let (code, _, error) =
        said(&hydrotrace(folder.path(), &["import", "two.csv", "--only", "machine=EX9", "-o", "a.mcap"]));
    assert!(code == 1 && error.contains("EX1, EX2"), "{error}");
}

#[test]
fn counts_are_refused_and_a_sensor_that_jumps_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let counts = table("time_s,boom_set [counts],boom_act [counts]", |k, both| {
        let [plan, came] = both.map(|deg| (100.0 * deg).round());
        format!("{:.2},{plan},{came}", f64::from(k) * 0.02)
    });
    fs::write(folder.path().join("counts.csv"), counts).unwrap();
    let (code, _, error) = said(&hydrotrace(folder.path(), &["report", "counts.csv"]));
    assert!(code == 1 && error.contains("is in counts, which is no angle or length"), "{error}");
    let fault = table("time_s,boom_set_deg,boom_act_deg", |k, [plan, came]| {
        let came = if (200..210).contains(&k) { -999.0 } else { came };
        format!("{:.2},{plan:.4},{came:.4}", f64::from(k) * 0.02)
    });
    fs::write(folder.path().join("fault.csv"), fault).unwrap();
    let (code, text, error) = said(&hydrotrace(folder.path(), &["report", "fault.csv"]));
    assert!(code == 3 && text.contains("steps of the measured boom within one sample"), "{text}{error}");
}

#[test]
fn a_unit_or_a_role_may_stand_within_a_name() {
    let angles = |scale: f64| {
        move |k: u32, [plan, came]: [f64; 2]| {
            format!("{:.2},{:.5},{:.5}", f64::from(k) * 0.02, scale * plan, scale * came)
        }
    };
    let (degrees, radians) = (angles(1.0), angles(1.0_f64.to_radians()));
    for head in [
        "j1_deg_target,j1_deg_actual", "target_angle_deg_1,angle_deg_1", "boom_deg_soll,boom_deg_ist",
        "target_angle_degrees_1,angle_degrees_1", "target_angle_deg,current_angle_deg",
        "target_deg_j1,current_deg_j1", "A1_RSol [deg],A1_RIst [deg]",
    ] {
        assert_peak("deg.csv", &table(&format!("time_s,{head}"), degrees), &[]);
    }
    for head in ["target_angle_rad_1,angle_rad_1", "vorn_rad_soll,vorn_rad_ist"] {
        assert_peak("rad.csv", &table(&format!("time_s,{head}"), radians), &[]);
    }
    // A joint that slides: 1 deg is 1 mm here.
    let folder = tempfile::tempdir().unwrap();
    let found = peak(folder.path(), "mm.csv", &table("time_s,boom_mm_set,boom_mm_act", degrees), &[]);
    assert!((found - 0.026_f64.to_degrees() / 1000.0).abs() < 1e-4, "{found} m");
}

#[test]
fn a_speed_is_no_angle_and_a_format_of_times_is_no_length() {
    let folder = tempfile::tempdir().unwrap();
    let import = |text: &str| {
        fs::write(folder.path().join("a.csv"), text).unwrap();
        said(&hydrotrace(folder.path(), &["import", "a.csv", "-o", "a.mcap", "--force"]))
    };
    let (_, out, error) = import("time,elbow_angle_target,elbow_angle_vel\n0,0.1,0\n0.1,0.2,1\n0.2,0.3,1\n");
    assert!(out.contains("measured velocity"), "{out}{error}");
    let (_, out, error) = import("time,q1,q1_dot,q1_dot_dot\n0,0.1,0,0\n0.1,0.2,0,0\n0.2,0.2,0,0\n");
    assert!(out.contains("Not used: q1_dot_dot"), "{out}{error}");
    for pair in ["j1_deg_s_set,j1_deg_s_act", "v_rad_per_s_1_set,v_rad_per_s_1_act", "a_mm_s_set,a_mm_s_act"]
    {
        let (code, out, error) = import(&format!("time_s,{pair}\n0,1,0\n0.1,2,1\n0.2,3,1\n"));
        assert!(code == 1 && error.contains("no column looks like a joint angle"), "{pair}: {out}{error}");
    }
    let (code, out, error) =
        import("Zeit_hh_mm_ss,a_set_deg,a_act_deg\n12:00:01.0,1,2\n12:00:01.1,1,2\n12:00:01.2,1,2\n");
    assert!(code == 0 && out.contains("Zeit_hh_mm_ss: hh:mm:ss"), "{out}{error}");
}

#[test]
fn a_header_that_lacks_a_name_is_refused_and_one_that_comes_again_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let import = |text: &str, options: &[&str]| {
        fs::write(folder.path().join("a.csv"), text).unwrap();
        said(&hydrotrace(folder.path(), &[&["import", "a.csv", "-o", "a.mcap", "--force"], options].concat()))
    };
    // As R writes rows with their names.
    let short = "t_s,j_set_deg,j_act_deg\n1,0.01,1,2\n2,0.02,1,2\n3,0.03,1,2\n";
    let (code, out, error) = import(short, &[]);
    assert!(code == 1 && error.contains("3 names and every row has 4 cells"), "{code}: {out}{error}");
    let by_number =
        ["--time", "#2", "--time-unit", "s", "--planned", "j=#3", "--measured", "j=#4", "--degrees"];
    let (code, out, error) = import(short, &by_number);
    assert!(code == 0 && out.contains("0.02 s at 100.0 Hz"), "{code}: {out}{error}");
    // A separator at the end of every row is no cell.
    let (code, out, error) = import("t_s,j_set_deg,j_act_deg\n0.0,1,2,\n0.1,1,2,\n0.2,1,2,\n", &[]);
    assert_eq!(code, 0, "{out}{error}");
    for (head, row) in [("t_s,j_set_deg,j_act_deg,by,note", ""), (",t_s,j_set_deg,j_act_deg", "0,")] {
        let rows = |from: u32| -> String { (from..from + 5).map(|k| format!("{row}{k},1,2\n")).collect() };
        let (code, out, error) = import(&format!("{head}\n{}{head}\n{}", rows(0), rows(5)), &[]);
        assert!(code == 3 && out.starts_with("10 rows"), "{head}: {out}{error}");
    }
}

#[test]
fn what_a_column_of_quality_of_each_signal_calls_bad_is_left_out_and_is_no_joint() {
    let bad = |k: u32| k % 50 == 7;
    let value = |k: u32, came: f64| if bad(k) { 0.0 } else { came };
    for (word, good, not) in [
        ("Quality", "192", "0"),
        ("StatusCode", "0", "2150891520"),
        ("Quality", "Good", "Bad"),
        ("Valid", "1", "0"),
    ] {
        let head = format!("t_s,boom_set_deg,boom_set_{word},boom_act_deg,boom_act_{word}");
        let text = table(&head, |k, [plan, came]| {
            let judged = if bad(k) { not } else { good };
            format!("{:.2},{plan:.4},{good},{:.4},{judged}", f64::from(k) * 0.02, value(k, came))
        });
        assert_peak(&format!("{word}-{good}.csv"), &text, &[]);
    }
}

#[test]
fn times_of_signals_that_are_named_after_them_count_and_not_that_of_the_row() {
    let day = |ms: u32| format!("2025-06-03 09:{:02}:{:02}.{:03}", ms / 60_000, ms / 1000 % 60, ms % 1000);
    let head = "Time,boom_set_deg,boom_set_deg_SourceTimestamp,boom_act_deg,boom_act_deg_SourceTimestamp";
    let text = table(head, |k, [plan, came]| {
        let ms = 20 * k;
        format!("{},{plan:.4},{},{came:.4},{}", day(ms + 150), day(ms), day(ms + 5))
    });
    let folder = tempfile::tempdir().unwrap();
    // 5 ms later at up to 0.26 rad/s.
    let found = peak(folder.path(), "opc.csv", &text, &[]);
    assert!((found - 0.0273).abs() < 0.0006, "{found}");
}
