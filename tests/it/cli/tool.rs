//! The error at the tool through the built program: where the arm comes from, limits, forms.

use std::{fs, path::Path};

use crate::support::{hold_to_schema, json, root, run_line, said, samples};

/// Holds an arm.
const ARMED: &str = "task-1-run.mcap";
/// Holds none.
const PLAIN: &str = "panel-install.mcap";

/// The sample arm with the names of the log without one.
fn urdf() -> String {
    let text = fs::read_to_string(root().join("sample-logs/arm/arm.urdf")).unwrap();
    (1..=6).fold(text, |text, k| text.replace(&format!("name=\"J{k}\""), &format!("name=\"joint_{k}\"")))
}

fn report(folder: &Path, more: &str) -> (i32, String, String) {
    said(&run_line(folder, &format!("report {} {more}", samples().join(PLAIN).display())))
}

#[test]
fn limits_at_the_tool_are_kept_at_their_value_and_not_below() {
    let found = json(samples(), &format!("report {ARMED}"))["tool"].clone();
    let worst_mm = 1e3 * found["worst"]["error_m"].as_f64().unwrap();
    let end = found["rests"].as_array().unwrap().iter().find(|rest| rest["at_end"] == true).unwrap().clone();
    let end_mm = 1e3 * end["error_m"].as_f64().unwrap();
    let verb = |words: &str| said(&run_line(samples(), words));
    for (option, value_mm, name) in [
        ("--max-tool-error-mm", worst_mm, "error of the tool"),
        ("--max-end-error-mm", end_mm, "error of the tool at rest at the end"),
    ] {
        let (code, text, _) = verb(&format!("report {ARMED} {option} {}", value_mm + 1e-6));
        assert!(code == 0 && text.contains(&format!("Limit on {name} kept: ")), "{code}: {text}");
        let (code, _, error) = verb(&format!("report {ARMED} {option} {}", value_mm - 1e-6));
        let shown =
            format!("tool at {:.2} s has a little more than {value_mm:.2} mm", found_s(&found, &end, option));
        assert!(code == 4 && error.contains("NOT KEPT") && error.contains(&shown), "{code}: {error}");
        let compare = format!("compare {ARMED} {ARMED} {option}");
        assert!(verb(&format!("{compare} {}", value_mm + 1e-6)).1.contains("after kept: "), "{option}");
        assert_eq!(verb(&format!("{compare} {}", value_mm - 1e-6)).0, 4, "{option}");
        // Without an arm there is nothing to judge.
        assert_eq!(verb(&format!("compare {PLAIN} still-joint.mcap {option} 1000")).0, 4);
        let (code, text, _) = verb(&format!("report {PLAIN} {option} 1000"));
        assert!(code == 4 && text.contains("NOT KEPT: nothing to judge"), "{text}");
        assert_eq!(verb(&format!("report {PLAIN} {option} 0 --allow-empty")).0, 0);
    }
}

fn found_s(found: &serde_json::Value, end: &serde_json::Value, option: &str) -> f64 {
    let of = if option.contains("end") { &end["to_s"] } else { &found["worst"]["time_s"] };
    of.as_f64().unwrap()
}

#[test]
fn a_urdf_that_is_given_places_the_tool_of_a_log_without_one() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("arm.urdf", &urdf());
    let (code, text, _) = report(folder.path(), "--urdf arm.urdf");
    assert!(code == 0 && text.contains("\nAt the tool: ") && text.contains("\nAT THE TOOL\n"), "{text}");
    let (_, text, _) = report(folder.path(), "");
    assert!(!text.to_lowercase().contains("at the tool"), "{text}");
    // Of a link before the wrist no wrist is a cause.
    let (_, text, _) = report(folder.path(), "--urdf arm.urdf --tool link3 --json");
    let tool = serde_json::from_str::<serde_json::Value>(&text).unwrap()["tool"].clone();
    assert_eq!((&tool["tool"], tool["worst"]["causes"].as_array().unwrap().len()), (&"link3".into(), 3));
    for (more, said) in [
        ("--urdf no.urdf", "cannot read no.urdf"),
        ("--urdf arm.urdf --tool hook", "found hook, expected a link of this file"),
        ("--urdf broken.urdf", "broken.urdf cannot be read"),
    ] {
        write("broken.urdf", "<robot");
        let (code, text, error) = report(folder.path(), more);
        assert!(code == 1 && text.is_empty() && error.contains(said), "{more}: {error}");
    }
    let (code, _, error) = report(folder.path(), "--urdf arm.urdf -o arm.urdf --json");
    assert!(code == 1 && error.contains("is an input"), "{error}");
}

#[test]
fn a_joint_that_the_log_lacks_is_named_and_nothing_is_claimed() {
    let folder = tempfile::tempdir().unwrap();
    let text = urdf().replace("name=\"joint_6\"", "name=\"wrist\"");
    fs::write(folder.path().join("arm.urdf"), text).unwrap();
    let (code, text, _) = report(folder.path(), "--urdf arm.urdf");
    assert_eq!(code, 0);
    assert!(text.contains("At the tool: the error is not known") && text.contains("wrist"), "{text}");
    assert!(!text.contains("AT THE TOOL"), "{text}");
    let (_, text, _) = report(folder.path(), "--urdf arm.urdf --json");
    let document: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert!(document["tool"].is_null() && document["no_tool"].as_str().unwrap().contains("wrist"));
    hold_to_schema(&document, "report.v2");
}

#[test]
fn a_joint_that_slides_by_the_urdf_is_read_in_metres() {
    let folder = tempfile::tempdir().unwrap();
    let rows: String = (0..600)
        .map(|k| {
            let t_s = 0.01 * f64::from(k);
            let at = 0.1 * (t_s - 2.0).clamp(0.0, 2.0);
            format!("{t_s},{at},{}\n", at - 0.004)
        })
        .collect();
    fs::write(folder.path().join("a.csv"), format!("time_s,lift_planned_rad,lift_measured_rad\n{rows}"))
        .unwrap();
    fs::write(
        folder.path().join("lift.urdf"),
        "<robot name='r'><link name='base'/><link name='fork'/><joint name='lift' type='prismatic'>\
         <parent link='base'/><child link='fork'/><axis xyz='0 0 1'/></joint></robot>",
    )
    .unwrap();
    run_line(folder.path(), "import a.csv -o a.mcap");
    let document = json(folder.path(), "report a.mcap --urdf lift.urdf");
    assert_eq!(document["joints"][0]["unit"], "m");
    let tool = &document["tool"];
    assert!((tool["worst"]["error_m"].as_f64().unwrap() - 0.004).abs() < 1e-9, "{tool}");
    assert_eq!((&tool["tool"], &tool["worst"]["causes"][0]["unit"]), (&"fork".into(), &"m".into()));
}

#[test]
fn every_form_tells_the_tool() {
    let document = json(samples(), &format!("report {ARMED}"));
    hold_to_schema(&document, "report.v2");
    let comparison = json(samples(), &format!("compare {ARMED} precompensated-run.mcap"));
    hold_to_schema(&comparison, "compare.v2");
    assert_eq!(comparison["tool"]["worst_m"]["before"], document["tool"]["worst"]["error_m"]);
    let form = |more: &str| said(&run_line(samples(), &format!("report {ARMED} {more}"))).1;
    assert!(form("--markdown").contains("## At the tool"));
    let page = form("--html");
    for part in ["id=\"tool\"", "data-scene=\"", "class=\"label\">At the tool", "The path as a table"] {
        assert!(page.contains(part), "{part}");
    }
    let plain = said(&run_line(samples(), &format!("report {PLAIN} --html"))).1;
    assert!(!plain.contains("id=\"tool\"") && !plain.contains("data-scene=\""));
}

/// 4 mm and 2 deg off in one half of the run, 2 mm and 1 deg in the other: largest, mean and root mean square differ.
#[test]
fn a_tool_measured_as_a_pose_has_its_figures_in_text_document_and_csv() {
    let folder = tempfile::tempdir().unwrap();
    let rows: String = (0..1000)
        .map(|k| {
            let t_s = 0.01 * f64::from(k);
            let x_mm = 100.0 * (t_s - 2.0).clamp(0.0, 4.0);
            let half = if k < 500 { 2.0 } else { 1.0 };
            format!("{t_s:.2},{x_mm},0,0,0,0,0,{x_mm},{},0,0,0,{half}\n", -2.0 * half)
        })
        .collect();
    let columns = |side: &str| {
        ["x_mm", "y_mm", "z_mm", "roll_deg", "pitch_deg", "yaw_deg"].map(|name| format!("{side}_{name}"))
    };
    let header = [columns("planned"), columns("measured")].concat().join(",");
    fs::write(folder.path().join("a.csv"), format!("time_s,{header}\n{rows}")).unwrap();
    let document = json(folder.path(), "report a.csv");
    hold_to_schema(&document, "report.v2");
    let tool = &document["tool"];
    let near = |found: &serde_json::Value, truth: f64| {
        assert!((found.as_f64().unwrap() - truth).abs() < 2e-3 * truth, "{found} in place of {truth}");
    };
    let rms = 2.5_f64.sqrt();
    for (found, truth) in [
        (&tool["worst"]["error_m"], 0.004),
        (&tool["mean_m"], 0.003),
        (&tool["rms_m"], 0.002 * rms),
        (&tool["path_error"]["rms"], 0.002 * rms),
        (&tool["path_error"]["peak"], 0.004),
        (&tool["worst_orientation_rad"], 2_f64.to_radians()),
        (&tool["mean_orientation_rad"], 1.5_f64.to_radians()),
        (&tool["rms_orientation_rad"], rms.to_radians()),
    ] {
        near(found, truth);
    }
    // By axis.
    let y = &document["joints"][1];
    assert_eq!((&y["name"], &y["unit"]), (&"y".into(), &"m".into()));
    near(&y["tracking_error"]["rms"], 0.002 * rms);
    near(&y["tracking_error"]["mean_abs"], 0.003);
    near(&y["tracking_error"]["peak"], 0.004);
    let form = |more: &str| said(&run_line(folder.path(), &format!("report a.csv {more}"))).1;
    let text = form("");
    let line = text.lines().skip_while(|line| *line != "AT THE TOOL").nth(2).unwrap();
    let cells: Vec<&str> = line.split_whitespace().collect();
    for shown in ["4.00", "3.00", "3.16", "2.000", "1.500", "1.581"] {
        assert!(cells.contains(&shown), "{shown}: {line}");
    }
    let csv = form("--csv");
    let figure = |key: &str| {
        let line = csv.lines().find_map(|line| line.strip_prefix(&format!("# tool {key} ")));
        line.unwrap_or_else(|| panic!("{key}: {csv}")).parse::<f64>().unwrap()
    };
    assert!((figure("mean_m") - 0.003).abs() < 1e-5 && (figure("path_worst_m") - 0.004).abs() < 1e-5);
    assert!((figure("mean_orientation_rad") - 1.5_f64.to_radians()).abs() < 1e-4);
    assert!(csv.lines().next().unwrap().starts_with("run,"));
}
