//! A crane whose last joint slides, from its task to a better run: degrees and millimetres, each where it belongs.

use std::{fmt::Write as _, fs, path::Path};

use crate::support::{clean, json, root, run_line, said, scratch};

const JOINTS: [&str; 3] = ["slew", "boom", "telescope"];

/// A folder with the crane, and its task with a change.
fn crane(from: &str, to: &str) -> tempfile::TempDir {
    let folder = scratch();
    for name in ["crane.urdf", "hydraulics.toml", "lift.toml"] {
        let text = fs::read_to_string(root().join("sample-logs/crane").join(name)).unwrap();
        assert!(name != "lift.toml" || from.is_empty() || text.contains(from), "{from}");
        fs::write(folder.path().join(name), if from.is_empty() { text } else { text.replace(from, to) })
            .unwrap();
    }
    folder
}

/// A run of what a log sends, as a PLC has it: every joint lags by 0.3 s and starts once it is asked for a part of a degree, or
/// for some millimetres.
fn driven(folder: &Path, log: &str, out: &str) {
    let (_, text, _) = said(&run_line(folder, &format!("export {log} --csv")));
    let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let unit = |joint: &str| if joint == "telescope" { "m" } else { "rad" };
    let place = |joint: &str| {
        let named = ["command", "planned"].map(|side| format!("{joint}_{side}_{}", unit(joint)));
        named.iter().find_map(|name| header.iter().position(|own| own == name)).unwrap()
    };
    let places = JOINTS.map(place);
    let rows: Vec<[f64; 3]> = text
        .lines()
        .skip(1)
        .map(|row| {
            let cells: Vec<&str> = row.split(',').collect();
            places.map(|place| cells[place].parse().unwrap())
        })
        .collect();
    let mut table = String::from("time_s");
    for (joint, unit) in JOINTS.into_iter().zip(["deg", "deg", "mm"]) {
        write!(table, ",{joint}_cmd_{unit},{joint}_act_{unit}").unwrap();
    }
    let scale = [1f64.to_degrees(), 1f64.to_degrees(), 1e3];
    let band = [0.3, 0.2, 6.0];
    let mut at = [0, 1, 2].map(|j| rows[0][j] * scale[j]);
    let rest = rows[rows.len() - 1];
    for (k, row) in rows.iter().chain(std::iter::repeat_n(&rest, 300)).enumerate() {
        write!(table, "\n{:.3}", 0.01 * k as f64).unwrap();
        for j in 0..3 {
            let sent = row[j] * scale[j];
            let off = sent - at[j];
            at[j] += (off - off.clamp(-band[j], band[j])) * 0.01 / 0.3;
            write!(table, ",{sent:.6},{:.6}", at[j]).unwrap();
        }
    }
    fs::write(folder.join(out), table + "\n").unwrap();
}

#[test]
fn a_crane_with_a_telescope_is_planned_run_and_better_for_its_next_command() {
    let folder = crane("", "");
    let folder = folder.path();
    let (code, plan, _) = said(&run_line(folder, "plan lift.toml --choose fastest --shape free"));
    assert_eq!(code, 0, "{plan}");
    for part in [
        "boom speed",
        " mm/s     350.0 mm/s",
        " mm/s3 ",
        "In the RMS jerk of all joints 1 m counts as 1 rad",
        "All limits are kept.",
    ] {
        assert!(plan.contains(part), "{part}: {plan}");
    }
    // One that leaves a command some room.
    clean(folder, "plan lift.toml -o plan.mcap");
    let (_, info, _) = said(&run_line(folder, "info plan.mcap"));
    assert!(info.contains("robot.urdf, hydraulics.toml"), "{info}");
    driven(folder, "plan.mcap", "run.csv");
    clean(folder, "join run.csv --plan plan.mcap -o run.mcap");
    let (_, report, _) = said(&run_line(folder, "report run.mcap"));
    assert!(report.contains("At the tool: ") && report.contains("Joints that slide: "), "{report}");
    // Its task lets other timings be sought, held to what was reached: in the unit of each joint.
    let (code, next, error) = said(&run_line(folder, "replan run.mcap -o other.mcap"));
    assert!(code != 1, "{error}");
    let row = next.lines().rfind(|line| line.starts_with("telescope")).unwrap();
    assert!(row.contains(" mm/s ") && row.contains(" mm/s2 "), "{next}");
    // What is expected is told of each kind in its unit; of both together no unit of one is true.
    let next = clean(folder, "replan run.mcap --keep-plan -o next.mcap");
    for part in ["worst transition peak deg ", "worst transition peak mm ", " % of the last is expected"] {
        assert!(next.contains(part), "{part}: {next}");
    }
    driven(folder, "next.mcap", "came.csv");
    clean(folder, "join came.csv --plan next.mcap -o after.mcap");
    let compared = json(folder, "compare run.mcap after.mcap");
    for scope in ["turning", "sliding"] {
        let of = |one: &&serde_json::Value| one["measure"] == "peak_error" && one["scope"] == scope;
        let peak = compared["summaries"].as_array().unwrap().iter().find(of).unwrap();
        let [before, after] = ["mean_before", "mean_after"].map(|key| peak[key].as_f64().unwrap());
        assert!(after < 0.3 * before, "{peak}");
    }
}

#[test]
fn a_task_that_no_log_holds_is_checked_as_far_as_samples_tell_and_goes_with_the_next_line() {
    let folder = crane("", "");
    let folder = folder.path();
    let task = fs::read_to_string(folder.join("lift.toml")).unwrap();
    let from = "acceleration_deg_s2 = { slew = 25";
    assert!(task.contains(from), "{task}");
    fs::write(folder.join("tight.toml"), task.replace(from, "acceleration_deg_s2 = { slew = 0.5")).unwrap();
    clean(folder, "plan lift.toml --times 0,9,18 -o plan.mcap");
    driven(folder, "plan.mcap", "run.csv");
    // A table holds neither task nor motion.
    let (_, next, error) =
        said(&run_line(folder, "replan run.csv --keep-plan --task tight.toml -o next.mcap"));
    for part in [
        "CARE  Limits",
        "By its samples slew is accelerated to about ",
        "its limit is 0.500 deg/s2",
        "Not checked, for the plan is known by its samples alone: acceleration, jerk",
        "mm (telescope at ",
        "deg (slew at ",
        "replan run.csv after.mcap --task tight.toml --keep-plan",
    ] {
        assert!(next.contains(part), "{part}: {next}{error}");
    }
    assert!(!next.contains("No limit is known of: acceleration"), "{next}");
}

#[test]
fn a_command_for_some_joints_takes_nothing_from_the_task_of_all() {
    let folder = crane("", "");
    let folder = folder.path();
    clean(folder, "plan lift.toml --times 0,9,18 -o plan.mcap");
    driven(folder, "plan.mcap", "run.csv");
    clean(folder, "join run.csv --plan plan.mcap -o run.mcap");
    let line = "replan run.mcap --joints boom -o next.mcap";
    let (code, _, error) = said(&run_line(folder, line));
    assert!(code == 1 && error.contains("leave out --joints, or keep the plan with --keep-plan"), "{error}");
    let (code, next, error) = said(&run_line(folder, &format!("{line} --keep-plan")));
    assert!(code != 1 && next.contains("Without a task the limits of the arm are unknown"), "{next}{error}");
}

#[test]
fn its_identification_run_has_strokes_in_millimetres() {
    let folder = crane("", "");
    let said_of = clean(folder.path(), "excite --task lift.toml -o id.mcap");
    assert!(said_of.contains("+-60.0 mm at 30.0 mm/s; +-100.0 mm at 555.6 mm/s"), "{said_of}");
    assert!(said_of.contains("of 12.0 deg/s") && said_of.contains("of 350.0 mm/s"), "{said_of}");
    assert!(said_of.contains("--max-speed-deg-s, --max-speed-mm-s."), "{said_of}");
}

#[test]
fn the_document_says_which_joints_slide_and_the_page_draws_them_in_millimetres() {
    let folder = crane("", "");
    let folder = folder.path();
    let plan = json(folder, "plan lift.toml --evaluations 500");
    assert_eq!(plan["sliding_joints"], serde_json::json!(["telescope"]));
    let margins = plan["chosen"]["margins"].as_array().unwrap();
    for margin in margins {
        assert_eq!(margin["kind"] == "slides", margin["joint"] == "telescope", "{margin}");
    }
    // Pump and rods know it, too.
    assert!(margins.iter().any(|m| m["joint"] == "telescope" && m["limit"] == "rod_speed"));
    let (_, _, error) = said(&run_line(folder, "plan lift.toml --evaluations 500 -o plan.html"));
    let page = fs::read_to_string(folder.join("plan.html")).unwrap_or_else(|_| panic!("{error}"));
    assert!(page.contains("Position (mm)") && page.contains("Speed (mm/s)") && page.contains("Angle (deg)"));
}

#[test]
fn a_joint_in_the_unit_of_the_other_kind_is_refused_with_its_line_and_keys() {
    let fault = |from: &str, to: &str| {
        let folder = crane(from, to);
        let (code, _, error) = said(&run_line(folder.path(), "plan lift.toml"));
        assert_eq!(code, 1, "{error}");
        error
    };
    let error = fault("speed_mm_s = { telescope = 350 }", "speed_deg_s = { telescope = 350 }");
    assert!(error.contains("duplicate key"), "{error}");
    let error = fault("{ slew = 20, boom = 12 }", "{ slew = 20, boom = 12, telescope = 350 }");
    assert!(
        error.contains(
            "limits.speed_deg_s names the joint \"telescope\", which line 11 has under positions_mm"
        ),
        "{error}"
    );
    assert!(error.contains("degrees are for a joint that turns, millimetres for one that slides"), "{error}");
    let error = fault("positions_mm = { telescope = 800 }\n", "");
    assert!(
        error.contains(
            "positions_mm has no value for the joint \"telescope\"; give one for each of telescope"
        ),
        "{error}"
    );
    let error = fault("positions_mm = { telescope = 800 }", "positions_mm = { telescope = 2800 }");
    assert!(error.contains("telescope at 2800.0 mm, its range is 0.0 mm to 2400.0 mm"), "{error}");
    let error = fault("positions_mm = { telescope = ", "positions_mm = { mast = ");
    assert!(
        error.contains("names the joint \"mast\"; the task's joints are slew, boom, telescope"),
        "{error}"
    );
}

#[test]
fn a_task_all_in_degrees_for_an_arm_that_slides_says_which_keys_it_needs() {
    let folder = crane("", "");
    let folder = folder.path();
    let text = fs::read_to_string(folder.join("lift.toml")).unwrap();
    let mut lines: Vec<String> = Vec::new();
    for line in text.lines().filter(|line| !line.contains("_mm")) {
        let turns = line.starts_with("angles_deg") || line.contains("_deg_s");
        lines.push(if turns { line.replace(" }", ", telescope = 10 }") } else { line.to_owned() });
    }
    fs::write(folder.join("lift.toml"), lines.join("\n")).unwrap();
    let (code, _, error) = said(&run_line(folder, "plan lift.toml"));
    assert_eq!(code, 1);
    assert!(
        error.contains("the joint telescope slides by the arm's description, and the task has it in degrees")
            && error.contains("positions_mm"),
        "{error}"
    );
}

/// A column of a PLC that says no unit is that of the option that calls its joint one that slides.
#[test]
fn a_column_without_a_unit_is_a_length_where_an_option_says_so_and_is_not_joined_as_an_angle() {
    let folder = crane("", "");
    let folder = folder.path();
    clean(folder, "plan lift.toml -o plan.mcap");
    driven(folder, "plan.mcap", "run.csv");
    let text = fs::read_to_string(folder.join("run.csv")).unwrap();
    fs::write(folder.join("bare.csv"), text.replacen("_cmd_mm", "_cmd", 1).replacen("_act_mm", "_act", 1))
        .unwrap();
    let peak = |line: &str| {
        let report = json(folder, line);
        let joints = report["joints"].as_array().unwrap().clone();
        let joint = joints.into_iter().find(|joint| joint["name"] == "telescope").unwrap();
        (joint["unit"].clone(), joint["tracking_error"]["peak"].as_f64().unwrap())
    };
    let known = peak("report run.csv");
    assert!(known.0 == "m" && known.1 > 0.03, "{known:?}");
    let told = peak("report bare.csv --slides telescope=mm");
    assert!(told.0 == "m" && (told.1 - known.1).abs() < 1e-9, "{told:?} {known:?}");
    let metres = text.replacen("_cmd_mm", "_cmd", 1).replacen("_act_mm", "_act", 1);
    let mut rows = metres.lines();
    let mut table = rows.next().unwrap().to_owned();
    for row in rows {
        let cells: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
        write!(
            table,
            "\n{},{},{},{},{},{},{}",
            cells[0],
            cells[1],
            cells[2],
            cells[3],
            cells[4],
            1e-3 * cells[5],
            1e-3 * cells[6]
        )
        .unwrap();
    }
    fs::write(folder.join("metres.csv"), table + "\n").unwrap();
    let told = peak("report metres.csv --slides telescope");
    assert!(told.0 == "m" && (told.1 - known.1).abs() < 1e-8, "{told:?} {known:?}");
    let (code, _, error) = said(&run_line(folder, "join bare.csv --plan plan.mcap -o run.mcap"));
    assert!(
        code == 1 && error.contains("say --slides telescope if it slides (in m; with =mm behind it"),
        "{error}"
    );
    assert!(!folder.join("run.mcap").exists());
    let joined = clean(folder, "join bare.csv --plan plan.mcap -o run.mcap --slides telescope=mm");
    assert!(joined.contains("rms apart on 3 joints (10.00 mm counts as 0.573 deg)"), "{joined}");
}

#[test]
fn rods_that_chains_double_are_half_as_long_as_their_joints_travel_both_ways() {
    let folder = crane("", "");
    let folder = folder.path();
    let cylinders = fs::read_to_string(folder.join("hydraulics.toml")).unwrap();
    clean(folder, "plan lift.toml -o plan.mcap");
    fs::write(folder.join("half.toml"), cylinders.replace("rod_per_travel = 1.0", "rod_per_travel = 0.5"))
        .unwrap();
    driven(folder, "plan.mcap", "run.csv");
    clean(folder, "export run.csv --hydraulics half.toml --as cylinders -o rods.csv");
    let rods = fs::read_to_string(folder.join("rods.csv")).unwrap();
    let first = |text: &str, column: &str| -> f64 {
        let at = text.lines().next().unwrap().split(',').position(|own| own == column).unwrap();
        text.lines().nth(1).unwrap().split(',').nth(at).unwrap().parse().unwrap()
    };
    assert!((first(&rods, "telescope_measured_m") - 0.1).abs() < 1e-6, "0.2 m of travel");
    // As a PLC calls them.
    fs::write(folder.join("rods.csv"), rods.replace("telescope_", "telescope_cyl_")).unwrap();
    clean(folder, "export rods.csv --hydraulics half.toml -o back.csv");
    let back = fs::read_to_string(folder.join("back.csv")).unwrap();
    assert!((first(&back, "telescope_measured_m") - 0.2).abs() < 1e-6, "{}", back.lines().next().unwrap());
    let alone = cylinders.split("[joint.boom]").next().unwrap().to_owned()
        + "[joint.telescope]\nbore_m = 0.08\nrod_m = 0.05\nrod_per_travel = 0.5\n";
    fs::write(folder.join("alone.toml"), alone).unwrap();
    clean(folder, "export run.csv --hydraulics alone.toml --as cylinders -o alone.csv");
}

#[test]
fn a_bound_in_a_unit_that_no_joint_has_is_refused_and_no_machine_of_it_is_simulated() {
    let folder = crane("", "");
    let folder = folder.path();
    let (code, _, error) =
        said(&run_line(folder, "excite --joint mast=1500:0:3000mm --max-speed-deg-s 10 -o id.mcap"));
    assert!(
        code == 1 && error.contains("no joint of the run turns, so that --max-speed-deg-s bounds nothing"),
        "{error}"
    );
    clean(folder, "plan lift.toml -o plan.mcap");
    driven(folder, "plan.mcap", "run.csv");
    let text = fs::read_to_string(folder.join("run.csv")).unwrap();
    fs::write(folder.join("turns.csv"), text.replace("_cmd_", "_planned_")).unwrap();
    let (code, _, error) =
        said(&run_line(folder, "replan turns.csv --joints slew,boom --max-correction-mm 5 -o next.mcap"));
    assert!(code == 1 && error.contains("no joint of the plan slides"), "{error}");
    let (code, _, error) = said(&run_line(folder, "simulate plan.mcap -o run-2.mcap"));
    assert!(
        code == 1 && error.contains("joint telescope slides; only arms whose joints all turn are simulated"),
        "{error}"
    );
}
