//! `fleet` at the built binary: what a scan writes, what it leaves, and what the dataset answers.

use std::{collections::BTreeSet, fs};

use serde_json::Value;

use crate::support::{
    clean,
    fleet::{cells, files, is_whole, small_fleet, small_log},
    hold_to_schema, json, run_line, said,
};

fn fleet(machines: u64, days: i64) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    small_fleet(&folder.path().join("logs"), machines, days);
    folder
}

#[test]
fn a_scan_writes_each_log_once_and_the_next_one_does_nothing() {
    let folder = fleet(3, 6);
    let first = json(folder.path(), "fleet scan logs --into data");
    hold_to_schema(&first, "fleet-scan.v1");
    assert_eq!(
        (&first["logs"], &first["analysed"], &first["unchanged"]),
        (&18.into(), &18.into(), &0.into())
    );
    assert_eq!(first["machines"], serde_json::json!(["M00", "M01", "M02"]));
    let data = folder.path().join("data");
    is_whole(&data, 18);
    let before = files(&data);
    assert!(before.keys().all(|path| path.to_string_lossy().contains("/schema=1/date=2026-03/bucket=")));
    let next = json(folder.path(), "fleet scan logs --into data");
    assert_eq!((&next["analysed"], &next["unchanged"]), (&0.into(), &18.into()));
    assert_eq!(files(&data), before);
    // The number of threads changes nothing.
    json(folder.path(), "fleet scan logs --into other --workers 3");
    assert_eq!(files(&folder.path().join("other")), before);
}

#[test]
fn new_changed_and_broken_logs_are_taken_up_and_old_rows_give_way() {
    let folder = fleet(2, 5);
    let (logs, data) = (folder.path().join("logs"), folder.path().join("data"));
    json(folder.path(), "fleet scan logs --into data");
    fs::write(logs.join("M01/02.mcap"), small_log("M01", 2, 99, [0.3, 0.3])).unwrap();
    fs::write(logs.join("M01/05.mcap"), small_log("M01", 5, 98, [0.2, 0.2])).unwrap();
    fs::write(logs.join("M00/broken.mcap"), "no log").unwrap();
    let run = run_line(folder.path(), "fleet scan logs --into data");
    let (code, out, _) = said(&run);
    assert_eq!(code, 3, "{out}");
    assert!(out.contains("12 logs: 3 analysed now, 1 of them again, 9 known already."), "{out}");
    assert!(out.contains("broken.mcap") && out.contains("is not an MCAP file"), "{out}");
    assert_eq!(cells(&data, "runs", "log_uri").len(), 12);
    let errors = cells(&data, "runs", "error");
    assert_eq!(errors.iter().filter(|error| !error.is_empty()).count(), 1);
    fs::remove_file(logs.join("M00/broken.mcap")).unwrap();
    // A log that is gone keeps its rows; a broken one is not tried again.
    let next = json(folder.path(), "fleet scan logs --into data");
    assert_eq!((&next["analysed"], &next["unchanged"]), (&0.into(), &11.into()));
    // All of it again under another analysis: nothing is there twice.
    let again = json(folder.path(), "fleet scan logs --into data --machine-from path:1");
    assert_eq!((&again["analysed"], &again["replaced"]), (&11.into(), &11.into()));
    let uris = cells(&data, "runs", "log_uri");
    assert_eq!((uris.len(), uris.iter().collect::<BTreeSet<_>>().len()), (12, 12));
    assert_eq!(cells(&data, "transitions", "run_id").len(), 11 * 4);
}

#[test]
fn a_run_whose_clocks_differ_is_no_part_of_the_history() {
    let folder = fleet(1, 5);
    let log = small_log("M00", 5, 97, [3.0, 3.0]);
    fs::write(folder.path().join("logs/M00/05.mcap"), log).unwrap();
    json(folder.path(), "fleet scan logs --into data");
    let worst = json(folder.path(), "fleet worst data");
    assert!(worst["remarks"].to_string().contains("other-time"), "{}", worst["remarks"]);
    assert_eq!(worst["runs"], 5, "{worst}");
}

#[test]
fn parts_of_many_scans_are_joined_and_every_row_stays() {
    let folder = fleet(3, 1);
    let (logs, data) = (folder.path().join("logs"), folder.path().join("data"));
    for day in 0..4 {
        for machine in 0..3 {
            let log = small_log(&format!("M0{machine}"), day, 10 * machine + 1, [0.2, 0.2]);
            fs::write(logs.join(format!("M0{machine}/{day:02}.mcap")), log).unwrap();
        }
        json(folder.path(), "fleet scan logs --into data");
    }
    let rows = |name: &str, column: &'static str| {
        let mut all = cells(&data, name, column);
        all.sort();
        all
    };
    let tables =
        [("runs", "log_uri"), ("joints", "run_id"), ("transitions", "event_id"), ("transitions", "run_id")];
    let before = tables.map(|(name, column)| rows(name, column));
    let worst = json(folder.path(), "fleet worst data");
    let done = json(folder.path(), "fleet compact data");
    hold_to_schema(&done, "fleet-compact.v1");
    assert!(done["files_before"].as_u64() > done["files_after"].as_u64(), "{done:#}");
    assert_eq!(done["runs"], 12);
    assert_eq!(tables.map(|(name, column)| rows(name, column)), before);
    assert_eq!(json(folder.path(), "fleet worst data"), worst);
    is_whole(&data, 12);
    // The same again does nothing, and the next scan knows all logs.
    let files_of = files(&data);
    let (code, out, _) = said(&run_line(folder.path(), "fleet compact data"));
    assert!(code == 0 && out.contains("nothing to join"), "{out}");
    assert_eq!(json(folder.path(), "fleet scan logs --into data")["analysed"], 0);
    assert_eq!(files(&data), files_of);
    // One scan of all logs gives the same files.
    json(folder.path(), "fleet scan logs --into once");
    assert_eq!(files(&folder.path().join("once")), files_of);
    let (code, _, err) = said(&run_line(folder.path(), "fleet compact none"));
    assert!(code == 1 && err.contains("holds no dataset") && !folder.path().join("none").exists(), "{err}");
}

#[test]
fn pages_show_machines_by_day_and_link_the_pages_of_runs() {
    let folder = fleet(4, 8);
    clean(folder.path(), "fleet scan logs --into data");
    fs::write(folder.path().join("logs/M00/03.html"), "a page").unwrap();
    clean(folder.path(), "fleet drift data -o drift.html");
    let page = fs::read_to_string(folder.path().join("drift.html")).unwrap();
    for text in [
        "2 drifts found", "Machines by day", "M00 boom: dead time", "class=\"heat3\"",
        "M00/03.html\">03.mcap",
    ] {
        assert!(page.contains(text), "{text}");
    }
    let map = &json(folder.path(), "fleet drift data --by delay")["maps"][0];
    assert_eq!(
        (map["columns"].as_array().unwrap().len(), &map["machines"][0]["machine"]),
        (8, &"M00".into())
    );
    for line in [
        "fleet worst data --html -o worst.html",
        "fleet effect data --machine M00 --at 2026-03-05 -o effect.html",
    ] {
        clean(folder.path(), line);
    }
    let worst = fs::read_to_string(folder.path().join("worst.html")).unwrap();
    assert!(worst.contains("Machines by day") && !worst.contains("http://"), "{worst}");
    assert!(fs::read_to_string(folder.path().join("effect.html")).unwrap().contains("Change by joint"));
}

#[test]
fn the_dataset_tells_which_machine_drifts_and_whether_that_breaks_a_limit() {
    let folder = fleet(6, 10);
    clean(folder.path(), "fleet scan logs --into data");
    let drift = json(folder.path(), "fleet drift data --by delay");
    hold_to_schema(&drift, "fleet-drift.v1");
    let trends = drift["trends"].as_array().unwrap();
    assert_eq!(trends.len(), 12);
    let found: Vec<&Value> = trends.iter().filter(|trend| trend["found"] == true).collect();
    assert_eq!(found.len(), 1, "{found:#?}");
    assert_eq!((&found[0]["machine"], &found[0]["joint"]), (&"M00".into(), &"boom".into()));
    let slope = found[0]["slope_per_day"].as_f64().unwrap();
    assert!((slope - 0.02).abs() < 0.002, "{slope}");
    let text = clean(folder.path(), "fleet drift data");
    assert!(text.contains("M00 boom: the dead time grows by ") && text.contains(", over all runs"), "{text}");
    let csv = clean(folder.path(), "fleet drift data --csv");
    assert!(csv.starts_with("machine,joint,metric,unit,slope_per_day,"), "{csv}");
    let worst = json(folder.path(), "fleet worst data --by delay");
    hold_to_schema(&worst, "fleet-worst.v1");
    assert_eq!(
        (&worst["joints"][0]["machine"], &worst["joints"][0]["joint"]),
        (&"M00".into(), &"boom".into())
    );

    let kept = run_line(folder.path(), "fleet gate data --max-drift-delay-ms 30");
    assert_eq!(said(&kept).0, 0);
    let broken = json_of(&run_line(folder.path(), "fleet gate data --max-drift-delay-ms 5 --json"), 4);
    hold_to_schema(&broken, "fleet-gate.v1");
    assert_eq!(
        (&broken["gates"][0]["broken_by"], &broken["gates"][0]["worst"]["machine"]),
        (&1.into(), &"M00".into())
    );
    let nothing = run_line(folder.path(), "fleet gate data --max-drift-peak-mm 5");
    assert_eq!(said(&nothing).0, 4);
    let allowed = run_line(folder.path(), "fleet gate data --max-drift-peak-mm 5 --allow-empty");
    assert_eq!(said(&allowed).0, 0);
}

fn json_of(run: &std::process::Output, code: i32) -> Value {
    let (found, out, error) = said(run);
    assert_eq!(found, code, "{error}");
    serde_json::from_str(&out).unwrap()
}

#[test]
fn a_repair_is_told_from_what_the_rest_of_the_fleet_does() {
    let folder = fleet(6, 10);
    // The stick of M05 was slow until the sixth of March.
    for day in 0..5 {
        let bytes = small_log("M05", day, 5000 + day as u64, [0.15, 0.32]);
        fs::write(folder.path().join(format!("logs/M05/{day:02}.mcap")), bytes).unwrap();
    }
    clean(folder.path(), "fleet scan logs --into data");
    let effect = json(folder.path(), "fleet effect data --machine M05 --at 2026-03-06 --by delay");
    hold_to_schema(&effect, "fleet-effect.v1");
    assert_eq!((&effect["runs_before"], &effect["runs_after"]), (&5.into(), &5.into()));
    let [stick, boom] = [0, 1].map(|k| &effect["effects"][k]);
    assert_eq!(
        (&stick["joint"], &stick["found"], &boom["found"]),
        (&"stick".into(), &true.into(), &false.into())
    );
    assert!((stick["change"].as_f64().unwrap() + 0.12).abs() < 0.02, "{stick}");
    assert_eq!((&stick["rank"], &stick["of"]), (&1.into(), &6.into()));
    let healthy = json(folder.path(), "fleet effect data --machine M03 --at 2026-03-06");
    assert!(
        healthy["effects"].as_array().unwrap().iter().all(|effect| effect["found"] == false),
        "{healthy:#}"
    );
}

#[test]
fn what_is_wrong_with_a_question_is_said() {
    let folder = fleet(1, 1);
    for (line, code, words) in [
        (
            "fleet drift nothing",
            1,
            "nothing holds no dataset; `hydrotrace fleet scan LOGS --into nothing` makes one",
        ),
        ("fleet scan none*.mcap --into data", 1, "found no log in \"none*.mcap\""),
        ("fleet scan logs --into data --machine-from nowhere.csv", 1, "nowhere.csv"),
        ("fleet effect data --machine M00 --at yesterday", 2, "neither a day as 2026-03-01"),
        ("fleet gate data", 2, "no limit is given"),
    ] {
        let (found, _, error) = said(&run_line(folder.path(), line));
        assert!(found == code && error.contains(words), "{line}: {found} {error}");
    }
    if !cfg!(feature = "cloud") {
        let (code, _, error) = said(&run_line(folder.path(), "fleet scan s3://bucket/logs --into data"));
        assert!(code == 1 && error.contains("build it with `--features cloud`"), "{error}");
    }
    clean(folder.path(), "fleet scan logs --into data");
    fs::write(folder.path().join("logs/May.zip"), "PK").unwrap();
    let (code, out, _) = said(&run_line(folder.path(), "fleet scan logs --into data"));
    assert!(
        code == 3 && out.contains("archives are not looked into, as ") && out.contains("May.zip: unpack"),
        "{out}"
    );
    let (code, _, error) = said(&run_line(folder.path(), "fleet drift data --machine M01"));
    assert!(code == 1 && error.contains("did you mean \"M00\"?"), "{error}");
    let (code, out, _) = said(&run_line(folder.path(), "fleet drift data"));
    assert!(
        code == 0 && out.contains("no joint has five runs of one plan, begun at different times,"),
        "{out}"
    );
}

#[test]
fn answers_say_that_a_scan_did_not_end_until_it_does() {
    use hydrotrace::workflow::fleet::{Inputs, scan};
    let folder = fleet(4, 6);
    let logs = folder.path().join("logs").to_string_lossy().into_owned();
    let inputs = Inputs { sources: vec![logs], into: folder.path().join("data"), ..Inputs::default() };
    scan(&inputs, &|_| std::ops::ControlFlow::Break(())).unwrap();
    json(folder.path(), "fleet scan logs/M00/00.mcap --into data");
    for line in [
        "gate data --max-drift-delay-ms 30 --allow-empty",
        "drift data",
        "worst data",
        "effect data --machine M00 --at 2026-03-03",
    ] {
        let (code, out, _) = said(&run_line(folder.path(), &format!("fleet {line}")));
        assert!(code == 3 && out.contains("/logs --into data` with the options"), "{line}: {code} {out}");
    }
    json(folder.path(), "fleet scan logs --into data");
    let gate = "fleet gate data --max-drift-delay-ms 30 --allow-empty";
    assert_eq!(said(&run_line(folder.path(), gate)).0, 0);
}

#[cfg(unix)]
#[test]
fn a_scan_that_is_killed_and_repeated_holds_every_row_once() {
    let folder = fleet(4, 10);
    for round in 0_u64..6 {
        let into = format!("data-{round}");
        let mut scan = crate::support::command(folder.path());
        scan.args(["fleet", "scan", "logs", "--into", &into, "--quiet"]).stdout(std::process::Stdio::null());
        let mut scan = scan.spawn().unwrap();
        std::thread::sleep(std::time::Duration::from_millis(15 + 40 * round));
        scan.kill().unwrap();
        scan.wait().unwrap();
        json(folder.path(), &format!("fleet scan logs --into {into}"));
        is_whole(&folder.path().join(&into), 40);
    }
}

#[test]
fn what_is_noted_is_asked_for_by_its_effect_and_stays() {
    let folder = fleet(4, 8);
    let data = folder.path().join("data");
    json(folder.path(), "fleet scan logs --into data");
    let (code, out, err) = said(&run_line(folder.path(), "fleet effect data --machine M01"));
    assert!(code == 1 && out.is_empty() && err.contains("holds no note of M01"), "{err}");
    assert!(clean(folder.path(), "fleet note data").contains("Nothing is noted."));
    let noted = clean(folder.path(), "fleet note data --machine M01 --at 2026-03-05 --joint boom repair");
    assert!(
        noted.contains("2026-03-05")
            && noted.contains("hydrotrace fleet effect data --machine=M01 --at=2026-03-05 --joint=boom"),
        "{noted}"
    );
    let before = files(&data);
    // The same twice is one note; another machine has another.
    clean(folder.path(), "fleet note data --machine M01 --at 2026-03-05 --joint boom repair");
    assert_eq!(files(&data), before);
    clean(folder.path(), "fleet note data --machine M02 --at 2026-03-03 oil");
    let notes = json(folder.path(), "fleet note data");
    hold_to_schema(&notes, "fleet-notes.v1");
    assert_eq!(notes["interventions"][0]["at"], "2026-03-03T00:00:00Z");
    let what =
        |k: usize| (notes["interventions"][k]["machine"].clone(), notes["interventions"][k]["what"].clone());
    assert_eq!([what(0), what(1)], [("M02".into(), "oil".into()), ("M01".into(), "repair".into())]);
    let effect = json(folder.path(), "fleet effect data --machine M01");
    hold_to_schema(&effect, "fleet-effect.v1");
    assert_eq!((&effect["what"], &effect["at"]), (&"repair".into(), &"2026-03-05T00:00:00Z".into()));
    assert_eq!(json(folder.path(), "fleet effect data")["machine"], "M01");
    let asked = json(folder.path(), "fleet effect data --machine M01 --at 2026-03-05");
    let of_boom = json(folder.path(), "fleet effect data --machine=M01 --at=2026-03-05 --joint=boom");
    assert_eq!(of_boom["effects"], effect["effects"]);
    assert_ne!(asked["effects"], effect["effects"]);
    // Joining the other parts, and logs that come later, leave the notes.
    json(folder.path(), "fleet compact data");
    fs::write(folder.path().join("logs/M01/09.mcap"), small_log("M01", 9, 7, [0.2, 0.2])).unwrap();
    json(folder.path(), "fleet scan logs --into data");
    assert_eq!(json(folder.path(), "fleet note data"), notes);
    for (line, expected) in [
        ("fleet note data --machine M11 --at 2026-03-05 repair", "no machine \"M11\""),
        ("fleet note none --machine M01 --at 2026-03-05 repair", "holds no dataset"),
    ] {
        let (code, _, err) = said(&run_line(folder.path(), line));
        assert!(code == 1 && err.contains(expected), "{line}: {err}");
    }
    assert!(!folder.path().join("none").exists());
}

#[test]
fn fitted_numbers_of_each_run_are_rows_if_they_are_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let logs = folder.path().join("logs");
    fs::create_dir(&logs).unwrap();
    for name in ["task-1-run.mcap", "trajectory-only.mcap"] {
        fs::copy(crate::support::sample(name), logs.join(name)).unwrap();
    }
    let data = folder.path().join("data");
    json(folder.path(), "fleet scan logs --into data");
    assert!(!data.join("limits").exists());
    // Another question of the same logs analyses them again.
    assert_eq!(json(folder.path(), "fleet scan logs --into data --fit")["analysed"], 2);
    let quantities: BTreeSet<String> = cells(&data, "limits", "quantity").into_iter().collect();
    assert!(
        quantities.contains("lag_s") && quantities.contains("speed_limit_growing_rad_s"),
        "{quantities:?}"
    );
    let runs: BTreeSet<String> = cells(&data, "limits", "run_id").into_iter().collect();
    assert!(runs.is_subset(&cells(&data, "runs", "run_id").into_iter().collect()) && !runs.is_empty());
    assert_eq!(json(folder.path(), "fleet scan logs --into data --fit")["unchanged"], 2);
    // A later scan without them keeps them.
    assert_eq!(json(folder.path(), "fleet scan logs --into data")["unchanged"], 2);
    assert!(!cells(&data, "limits", "quantity").is_empty());
}
