//! Lines that are printed to be pasted, in folders with blanks and for arms that the samples are not; and what is refused.

use std::fs;

use crate::support::{fleet::small_fleet, pasted, run_line, said, sample, scratch, timed};

const URDF: &str = r#"<robot name="r"><link name="base"/><link name="l1"/>
<joint name="turn" type="continuous"><parent link="base"/><child link="l1"/><axis xyz="0 0 1"/></joint></robot>"#;

const TASK: &str = "title = \"t\"\narm = \"r.urdf\"\njoints = [\"turn\"]\n[[point]]\nangles_deg = { turn = 0.0 }\n\
    [[point]]\nangles_deg = { turn = 40.0 }\n[limits]\nspeed_deg_s = { turn = 30.0 }\n\
    acceleration_deg_s2 = { turn = 40.0 }\njerk_deg_s3 = { turn = 80.0 }\n";

#[test]
fn after_a_plan_of_another_arm_the_next_lines_run() {
    let folder = scratch();
    let folder = folder.path().join("an arm's");
    fs::create_dir(&folder).unwrap();
    fs::write(folder.join("r.urdf"), URDF).unwrap();
    fs::write(folder.join("t.toml"), TASK).unwrap();
    let (code, text, error) = pasted(&folder, "hydrotrace plan t.toml -o 'my plan.mcap' --evaluations 1000");
    assert!(code == 0 || code == 3, "{error}");
    let lines: Vec<&str> = text.lines().filter(|line| line.starts_with("  hydrotrace")).collect();
    assert!(lines.len() == 2 && !text.contains("hydrotrace simulate"), "{text}");
    let (code, _, error) = pasted(&folder, lines[0]);
    assert_eq!(code, 0, "{}: {error}", lines[0]);
    assert!(
        fs::read_to_string(folder.join("plan.csv")).unwrap().starts_with("stamp_ns,time_s,turn_planned_rad")
    );
    // The recorder's log is what was sent, a second late.
    let (_, table, _) = pasted(&folder, "hydrotrace export 'my plan.mcap'");
    let mut log = "t_s,turn_command_rad,turn_measured_rad\n".to_owned();
    for row in table.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        log += &format!("{},{},{}\n", 3.0 + cells[1].parse::<f64>().unwrap(), cells[2], cells[2]);
    }
    fs::write(folder.join("log.csv"), log).unwrap();
    let join = lines[1].replace("RUN.mcap", "log.csv");
    let (code, _, error) = pasted(&folder, &join);
    assert!(code == 0 || code == 3, "{join}: {error}");
    let (code, _, error) = pasted(&folder, "hydrotrace report run.mcap");
    assert!(code == 0 || code == 3, "{error}");
}

#[test]
fn what_a_fleet_without_notes_asks_for_may_be_pasted() {
    let folder = scratch();
    small_fleet(&folder.path().join("logs"), 1, 2);
    let (code, _, error) = pasted(folder.path(), "hydrotrace fleet scan logs --into 'my data'");
    assert!(code == 0 || code == 3, "{error}");
    let (code, _, error) = pasted(folder.path(), "hydrotrace fleet effect 'my data' --machine M00");
    let line = error.split('`').nth(1).unwrap_or_default();
    assert!(code == 1 && line.contains("'my data' --machine M00"), "{error}");
    let (code, _, error) = pasted(folder.path(), line);
    assert!(code == 0 || code == 3, "{line}: {error}");
}

#[test]
fn what_is_not_written_and_a_joint_that_is_named_twice_are_refused() {
    let folder = scratch();
    fs::copy(sample("task-1-run.mcap"), folder.path().join("-run.mcap")).unwrap();
    let of = |line: &str| said(&run_line(folder.path(), line));
    let (code, _, error) = of("report ./-run.mcap -o run.pdf");
    assert!(code == 2 && error.contains(".html") && !folder.path().join("run.pdf").exists(), "{error}");
    let (code, _, error) = of("report ./-run.mcap --joints J1,J2,J1");
    assert!(code == 1 && error.contains("\"J1\" is named twice"), "{error}");
    let (code, out, _) = of("export ./-run.mcap");
    assert!(code == 0 && out.starts_with("stamp_ns,time_s,"), "{code}");
    assert_eq!(of("export ./-run.mcap --parquet").0, 2);
    let (code, out, error) = of("-- -run.mcap");
    assert!(code == 0 && out.starts_with("-run.mcap"), "{error}");
}

/// Lines of the page of a report, as they are shown.
fn lines_of_page(folder: &std::path::Path, log: &str) -> Vec<String> {
    let (code, page, error) = said(&run_line(folder, &format!("report {log} --html")));
    assert!(code == 0 || code == 3, "{error}");
    let next = page.split("class=\"next\">").nth(1).unwrap().split("</ol>").next().unwrap();
    let line = |rest: &str| rest.split("</code>").next().unwrap_or_default().to_owned();
    next.split("<code>").skip(1).map(line).collect()
}

#[test]
fn of_a_plan_that_no_command_corrects_the_machine_is_learnt() {
    let folder = scratch();
    let folder = folder.path();
    fs::copy(sample("identification-run.mcap"), folder.join("strokes.mcap")).unwrap();
    // Each step is answered by a ramp.
    let set = |t_s: f64| if (t_s / 4.0).floor() % 2.0 == 0.0 { 0.0 } else { 20.0 };
    let steps = timed("t_s,boom_set_deg,boom_act_deg", (2400, 0.01), |t_s| {
        let since_s = t_s % 4.0;
        let from = if t_s < 4.0 { 0.0 } else { 20.0 - set(t_s) };
        let came = from + (set(t_s) - from) * ((since_s - 0.2) / 1.0).clamp(0.0, 1.0);
        format!("{t_s:.2},{:.1},{came:.3}", set(t_s))
    });
    fs::write(folder.join("steps.csv"), steps).unwrap();
    for log in ["strokes.mcap", "steps.csv"] {
        let lines = lines_of_page(folder, log);
        assert!(!lines.iter().any(|line| line.contains("replan")), "{lines:?}");
        let fit = lines.iter().find(|line| line.starts_with("hydrotrace fit "));
        let Some(fit) = fit else { panic!("{log}: {lines:?}") };
        let (code, _, error) = pasted(folder, &format!("{fit} --force"));
        assert!(code == 0 || code == 3, "{fit}: {error}");
    }
    let (_, text, _) = said(&run_line(folder, "strokes.mcap"));
    assert!(text.contains("hydrotrace fit strokes.mcap -o limits.toml"), "{text}");
}
