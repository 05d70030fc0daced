//! Tables that count from zero, in a fleet: their dates, and what changes at once.

use std::fs;

use serde_json::Value;

use crate::support::{
    clean,
    fleet::{cells, files, log, small_log, smooth},
    hold_to_schema, json, run_line, said, timed,
};

/// Of a PLC that counts from zero: the boom starts 15 ms later each day.
fn table(day: u32) -> String {
    timed("t_s,boom_planned_rad,boom_measured_rad", (600, 0.02), |t_s| {
        let at = |late_s: f64| {
            let stroke = |from_s: f64| smooth((t_s - from_s - late_s) / 2.0);
            0.2 * stroke(2.0) - 0.2 * stroke(6.0)
        };
        format!("{t_s:.2},{:.6},{:.6}", at(0.0), at(0.1 + 0.015 * f64::from(day)))
    })
}

#[test]
fn tables_that_count_from_zero_have_the_dates_of_their_names_and_those_without_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let logs = folder.path().join("logs/M07");
    fs::create_dir_all(&logs).unwrap();
    for day in 1..=9 {
        fs::write(logs.join(format!("trace_2026-03-{day:02}_0600.csv")), table(day)).unwrap();
    }
    json(folder.path(), "fleet scan logs/*/*.csv --into data --machine-from path:1");
    let drift = json(folder.path(), "fleet drift data --by delay");
    let trends = drift["trends"].as_array().unwrap();
    let late = trends.iter().find(|trend| trend["found"] == true && trend["metric"] == "delay").unwrap();
    assert!((late["slope_per_day"].as_f64().unwrap() - 0.015).abs() < 0.003, "{late}");
    assert_eq!(late["days"], 8.0);
    fs::create_dir_all(folder.path().join("others/M08")).unwrap();
    for day in 1..=3 {
        fs::write(folder.path().join(format!("others/M08/trace{day}.csv")), table(day)).unwrap();
    }
    run_line(folder.path(), "fleet scan others/*/*.csv --into more --machine-from path:1");
    let (code, out, _) = said(&run_line(folder.path(), "fleet drift more"));
    assert!(
        code == 3 && out.contains("undated") && out.contains("undated x3  runs that say no date"),
        "{code}: {out}"
    );
    let data = folder.path().join("more");
    let of_day = |path: &std::path::PathBuf| path.to_string_lossy().contains("date=20");
    assert!(!files(&data).keys().any(of_day), "no date is made up");
    assert_eq!(cells(&data, "remarks", "code").iter().filter(|code| *code == "undated").count(), 3);
}

#[test]
fn a_clock_that_is_set_on_the_way_dates_its_run() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir_all(folder.path().join("logs/M1")).unwrap();
    let t_s: Vec<f64> = (0..500).map(|k| 0.02 * f64::from(k)).collect();
    let boom = |late_s: f64| vec![t_s.iter().map(|t| smooth((t - 2.0 - late_s) / 2.0)).collect()];
    // The first second counts from 20 s after the start of the controller.
    let stamps: Vec<f64> =
        t_s.iter().map(|t| if *t < 1.0 { t + 20.0 - 1_772_352_000.0 } else { *t }).collect();
    let bytes = log("M1", 0, &["boom"], &stamps, [&boom(0.0), &boom(0.2)]);
    fs::write(folder.path().join("logs/M1/run.mcap"), bytes).unwrap();
    run_line(folder.path(), "fleet scan logs --into data");
    let paths: Vec<_> = files(&folder.path().join("data")).into_keys().collect();
    assert!(paths.iter().all(|path| path.to_string_lossy().contains("date=2026-03")), "{paths:?}");
}

#[test]
fn times_before_zero_and_of_long_running_controllers_are_no_dates() {
    let folder = tempfile::tempdir().unwrap();
    let logs = folder.path().join("logs/M07");
    fs::create_dir_all(&logs).unwrap();
    for (name, day, from_s) in [("before", 3, -2.0), ("long", 4, 259_200.0)] {
        let shifted = table(day).lines().fold(String::new(), |all, row| {
            let (t_s, rest) = row.split_once(',').unwrap();
            let t_s = t_s.parse::<f64>().map_or(t_s.to_owned(), |t_s| format!("{:.2}", t_s + from_s));
            all + &format!("{t_s},{rest}\n")
        });
        fs::write(logs.join(format!("{name}.csv")), shifted).unwrap();
        // The same through an import.
        run_line(folder.path(), &format!("import logs/M07/{name}.csv -o logs/M07/{name}.mcap"));
    }
    run_line(folder.path(), "fleet scan logs/*/*.csv logs/*/*.mcap --into data --machine-from path:1");
    let undated = cells(&folder.path().join("data"), "remarks", "code");
    assert_eq!(undated.iter().filter(|code| *code == "undated").count(), 4, "{undated:?}");
    let worst = json(folder.path(), "fleet worst data --by delay");
    assert!(worst["joints"][0]["at"].is_null() && worst["joints"][0]["runs"] == 2, "{worst}");
    assert!(worst["remarks"].to_string().contains("same-run"), "a table and its import: {worst}");
}

#[test]
fn a_level_that_changes_at_once_is_told_and_breaks_a_limit() {
    let folder = tempfile::tempdir().unwrap();
    for machine in ["M1", "M2", "M3"] {
        let logs = folder.path().join("logs").join(machine);
        fs::create_dir_all(&logs).unwrap();
        for day in 1..=12 {
            // The delay of a day of the table grows by 15 ms a day: four days on, 60 ms.
            let wears = machine == "M2" && day > 8;
            let text = table(if wears { 5 } else { 1 });
            fs::write(
                logs.join(format!("trace_2026-03-{day:02}_0600.csv")),
                text + &format!("# {machine} {day}\n"),
            )
            .unwrap();
        }
    }
    json(folder.path(), "fleet scan logs/*/*.csv --into data --machine-from path:1");
    let drift = json(folder.path(), "fleet drift data --by delay");
    hold_to_schema(&drift, "fleet-drift.v1");
    let found: Vec<&Value> =
        drift["trends"].as_array().unwrap().iter().filter(|trend| trend["found"] == true).collect();
    let [step] = found[..] else { panic!("{found:?}") };
    assert_eq!((&step["machine"], &step["is_step"]), (&"M2".into(), &true.into()));
    assert!(step["since"].as_str().unwrap().starts_with("2026-03-09"), "{step}");
    assert!((step["step"]["change"].as_f64().unwrap() - 0.06).abs() < 0.01, "{step}");
    let (_, table, _) = said(&run_line(folder.path(), "fleet drift data --by delay --csv"));
    assert!(
        table.lines().any(|row| row.starts_with("M2,boom,dead_time") && row.contains(",true,2026-03-08")),
        "{table}"
    );
    run_line(folder.path(), "fleet drift data --by delay -o page.html");
    let page = fs::read_to_string(folder.path().join("page.html")).unwrap();
    assert!(
        page.contains("from 2026-03-08 to 2026-03-09") && page.contains("\"level\""),
        "no level is drawn"
    );
    let (code, out, _) = said(&run_line(folder.path(), "fleet gate data --max-drift-peak-mm 5"));
    assert!(code == 4 && out.contains("no joint that slides"), "{out}");
    let gate = run_line(folder.path(), "fleet gate data --max-drift-delay-ms 10");
    let (code, out, _) = said(&gate);
    assert!(code == 4 && out.contains("from 2026-03-08 to 2026-03-09"), "{code}: {out}");
}

/// Nine days, of which the fourth brought oil and the seventh a valve.
#[test]
fn a_repair_is_told_by_the_runs_between_what_was_done_before_and_after_it() {
    let folder = tempfile::tempdir().unwrap();
    let logs = folder.path().join("logs/M07");
    fs::create_dir_all(&logs).unwrap();
    for day in 0..9 {
        let late_s = if day < 3 { 0.4 } else { 0.2 };
        fs::write(logs.join(format!("{day}.mcap")), small_log("M07", day, 50 + day as u64, [late_s, late_s]))
            .unwrap();
    }
    json(folder.path(), "fleet scan logs --into data");
    for (day, what) in [(4, "oil"), (7, "valve")] {
        clean(folder.path(), &format!("fleet note data --machine M07 --at 2026-03-0{day} {what}"));
    }
    let effect = json(folder.path(), "fleet effect data --machine M07");
    assert_eq!(
        (&effect["what"], &effect["runs_before"], &effect["runs_after"]),
        (&"valve".into(), &3.into(), &3.into())
    );
    assert_eq!(effect["between"][0]["what"], "oil");
    let (_, out, _) = said(&run_line(folder.path(), "fleet effect data --machine M07"));
    assert!(out.contains("Runs before 2026-03-04 (oil) are left out; `--since DATE` takes them."), "{out}");
    let whole = json(folder.path(), "fleet effect data --machine M07 --since 2026-03-01");
    assert_eq!((&whole["runs_before"], whole["between"].as_array().map(Vec::len)), (&6.into(), Some(0)));
    // A day later there are two runs between: the effect is that of both.
    clean(folder.path(), "fleet note data --machine M07 --at 2026-03-09 seal");
    let both = json(folder.path(), "fleet effect data --machine M07 --at 2026-03-07");
    assert_eq!(both["together"][0]["what"], "seal", "{both}");
    clean(folder.path(), "fleet note data --machine M07 --at 2026-03-09 seal --remove");
    assert_eq!(json(folder.path(), "fleet note data")["interventions"].as_array().unwrap().len(), 2);
    for (line, expected) in [
        ("fleet note data --machine M07 --at 2026-03-09 seal --remove", "nothing is noted of M07"),
        ("fleet note data --machine M07 --at 2036-03-09 seal", "2036"),
        ("fleet note data --machine M07 --at 2026-03-09 --joint bom seal", "bom"),
    ] {
        let (code, _, err) = said(&run_line(folder.path(), line));
        assert!(code == 1 && err.contains(expected), "{line}: {code} {err}");
    }
}
