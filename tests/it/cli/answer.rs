//! A log without a verb.

use crate::support::{
    fleet::smooth, json, pasted, root, run_args, run_at_root, run_line, said, sample, scratch, stdout, timed,
};

#[test]
fn a_log_without_a_verb_is_answered_in_ten_lines_whose_last_runs() {
    let folder = scratch();
    for name in ["task-1-run", "pressures-run", "identification-run", "gaps", "still-joint", "power-loss"] {
        let file = format!("{name}.mcap");
        std::fs::copy(sample(&file), folder.path().join(&file)).unwrap();
        let (code, text, error) = said(&run_line(folder.path(), &file));
        assert!(code == 0 || code == 3, "{name}: {code} {error}");
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines.len() <= 10 && lines[0] == file, "{name}:\n{text}");
        let next = lines.last().unwrap().trim().strip_prefix("hydrotrace ").unwrap();
        let (code, _, error) = said(&run_line(folder.path(), next));
        assert!(code == 0 || code == 3, "{next}: {code} {error}");
    }
}

/// What the answer was read by is what the next command is read by.
#[test]
fn a_pasted_line_reads_the_log_as_the_one_before_it_did() {
    let folder = scratch();
    std::fs::copy(sample("task-1-run.mcap"), folder.path().join("my run.mcap")).unwrap();
    let shell = |line: &str| pasted(folder.path(), line);
    let options = "--joints J1,J3 --from 1.5 --measured-delay-ms=-2";
    let (code, text, error) = shell(&format!("hydrotrace 'my run.mcap' {options}"));
    assert!(code == 0 || code == 3, "{code} {error}");
    let next = text.lines().last().unwrap().trim();
    assert!(
        next.ends_with("--joints J1,J3 --from 1.5 --measured-delay-ms=-2") && next.contains("'my run.mcap'"),
        "{next}"
    );
    let (code, _, error) = shell(next);
    assert!(code == 0 || code == 3, "{next}: {code} {error}");
    let (code, text, error) = shell(&format!("hydrotrace fit 'my run.mcap' {options} -o limits.toml"));
    assert!(code == 0 || code == 3, "{code} {error}");
    let next = text.lines().find(|line| line.contains("hydrotrace replan")).unwrap().trim();
    assert!(next.ends_with(options), "{next}");
}

/// No fit is of joints that slide, or of a tool: a line that would fail is not suggested.
#[test]
fn a_log_of_the_tool_alone_suggests_what_can_be_done_with_it() {
    let folder = scratch();
    let path_mm = |t_s: f64| 500.0 * smooth((t_s - 2.0) / 4.0);
    let head = "time_s,planned_x_mm,planned_y_mm,planned_z_mm,measured_x_mm,measured_y_mm,measured_z_mm";
    let row = |t_s| format!("{t_s:.2},{:.4},0,800,{:.4},3,800", path_mm(t_s), path_mm(t_s - 0.2));
    let table = timed(head, (500, 0.02), row);
    std::fs::write(folder.path().join("tool.csv"), table).unwrap();
    let (code, text, error) = said(&run_line(folder.path(), "tool.csv"));
    assert!(code == 0 || code == 3, "{code} {error}");
    let next = text.lines().last().unwrap().trim().strip_prefix("hydrotrace ").unwrap();
    assert!(!next.starts_with("fit"), "{text}");
    let (code, text, error) = said(&run_line(folder.path(), next));
    assert!((code == 0 || code == 3) && !text.contains("hydrotrace replan"), "{next}: {code} {error} {text}");
    let (code, page, error) = said(&run_line(folder.path(), "report tool.csv --html"));
    assert!(code == 0 || code == 3, "{code} {error}");
    assert!(page.contains("--max-transition-peak-mm 5") && !page.contains("--max-transition-peak-deg"));
}

#[test]
fn the_answer_in_json_is_the_report_with_why() {
    let answered = json(root(), "sample-logs/task-1-run.mcap");
    let reported = json(root(), "report sample-logs/task-1-run.mcap --why");
    assert_eq!(answered, reported);
    let starts = answered["why"]["starts"].as_array().unwrap();
    assert!(starts.len() > 10);
    for start in starts {
        let parts =
            ["dead_band", "lag", "limit", "unexplained"].map(|part| start[part]["delay_s"].as_f64().unwrap());
        let delay_s = start["onset_delay_s"].as_f64().unwrap();
        assert!((parts.iter().sum::<f64>() - delay_s).abs() < 1e-9, "{start}");
    }
}

#[test]
fn what_is_neither_a_verb_nor_a_file_is_told_so() {
    let (code, _, error) = said(&run_at_root(&["reports", "run.mcap"]));
    assert!(code == 2 && error.contains("'report'"), "{error}");
    let (code, _, error) = said(&run_at_root(&["nowhere.mcap"]));
    assert!(code == 1 && error.contains("nowhere.mcap"), "{error}");
}

#[test]
fn how_the_numbers_are_made_is_said_on_request() {
    let run = run_args(root(), &["sample-logs/task-1-run.mcap", "--explain"]);
    assert!(stdout(&run).contains("\nHOW\n"));
}

#[test]
fn a_joint_that_alone_moves_or_alone_rests_is_named() {
    let folder = scratch();
    let head = "time_s,boom_set_deg,boom_act_deg,arm_set_deg,arm_act_deg,slew_set_deg,slew_act_deg";
    let table = timed(head, (600, 0.02), |t_s| {
        let [on, late] = [2.0, 2.2].map(|from_s: f64| 5.0 * (t_s - from_s).clamp(0.0, 3.0));
        format!("{t_s:.2},{on:.4},{late:.4},{on:.4},1,7,{late:.4}")
    });
    std::fs::write(folder.path().join("run.csv"), table).unwrap();
    let (code, text, error) = said(&run_line(folder.path(), "run.csv"));
    assert!(code == 0 || code == 3, "{code} {error}");
    let line =
        |fact: &str| text.lines().find(|line| line.starts_with(fact)).unwrap_or_else(|| panic!("{text}"));
    assert!(
        line("fault ").ends_with("arm does not move. Its plan does: one planned start, none answered."),
        "{text}"
    );
    assert!(line("joint ").contains("slew moves although its plan rests"), "{text}");
    assert!(!text.contains("hydrotrace replan") && !text.contains("hydrotrace fit"), "{text}");
}

/// Five moves there and back, 12 deg each; the second signal comes so much later, s.
fn moves(later_s: f64, until_s: f64, names: [&str; 2]) -> String {
    let at = |t_s: f64| {
        let one = |k: u32| [12.0, -12.0][k as usize % 2] * smooth((t_s - 2.0 - 6.0 * f64::from(k)) / 3.0);
        (0..5).map(one).sum::<f64>()
    };
    let mut table = format!("time_s,{},{},wrist_set_deg,wrist_act_deg\n", names[0], names[1]);
    for t_s in (0..).map(|k| 0.02 * f64::from(k)).take_while(|t_s| *t_s < until_s) {
        // Both creep more slowly than a start is.
        let [set, act] = [0.05, 0.08].map(|speed| speed * t_s.clamp(0.0, 9.0));
        table += &format!("{t_s:.2},{:.4},{:.4},{set:.4},{act:.4}\n", at(t_s), at(t_s - later_s));
    }
    table
}

#[test]
fn a_joint_that_creeps_is_not_said_to_rest() {
    let folder = scratch();
    std::fs::write(folder.path().join("run.csv"), moves(0.08, 33.0, ["boom_set_deg", "boom_act_deg"]))
        .unwrap();
    let said = "wrist moves by 0.720 deg in all, its plan by 0.450 deg: no start of either can be told.";
    for line in ["run.csv", "report run.csv"] {
        let text = stdout(&run_line(folder.path(), line));
        assert!(text.contains(said) && !text.contains("does not move"), "{text}");
    }
}

#[test]
fn a_measurement_that_leads_its_plan_is_doubted_and_no_number_of_it_is_negative() {
    let folder = scratch();
    let answered = |file: &str, names| {
        std::fs::write(folder.path().join(file), moves(0.08, 33.0, names)).unwrap();
        said(&run_line(folder.path(), file))
    };
    let (code, text, _) = answered("run.csv", ["boom_set_deg", "boom_act_deg"]);
    assert!(code == 0 && text.contains("5 of 5 timed, half of them more than 86 ms late"), "{code} {text}");
    let (code, text, _) = answered("swapped.csv", ["boom_act_deg", "boom_set_deg"]);
    assert!(code == 3 && text.contains("half of them more than 74 ms early"), "{code} {text}");
    let doubt =
        "before-plan x1: boom moves 80 ms (95 %: 80 to 80) before its plan: are plan and measurement swapped";
    assert!(text.contains(doubt) && !text.contains("other-time"), "{text}");
    assert!(text.contains("does not explain why it is early") && !text.contains("more than -"), "{text}");
}

#[test]
fn a_log_that_cannot_be_planned_from_is_said_to_be_none_by_fit() {
    let folder = scratch();
    std::fs::write(folder.path().join("cut.csv"), moves(0.08, 27.5, ["boom_set_deg", "boom_act_deg"]))
        .unwrap();
    let (code, text, error) = said(&run_line(folder.path(), "fit cut.csv -o limits.toml"));
    assert!(code == 0 || code == 3, "{code} {error}");
    assert!(
        text.contains("No command is made from cut.csv: its plan ends at 27.48 s while boom moves"),
        "{text}"
    );
}

#[test]
fn a_limit_is_said_to_be_the_reports() {
    let (code, _, error) = said(&run_at_root(&["answer", "run.mcap", "--max-rms-deg", "0.5"]));
    assert!(code == 2 && error.contains("tip: --max-rms-deg is a limit of `hydrotrace report`"), "{error}");
    assert!(!error.contains("--measured-degrees"), "{error}");
}

#[test]
fn an_option_of_another_verb_is_said_to_be_that_ones() {
    for (args, verb) in [
        (["report", "run.csv", "--rate", "50"], "import"),
        (["import", "run.csv", "--keep-plan", "-q"], "replan"),
    ] {
        let (code, _, error) = said(&run_at_root(&args));
        let tip = format!("tip: {} is an option of `hydrotrace ", args[2]);
        assert!(
            code == 2 && error.contains(&tip) && error.contains(&format!("`hydrotrace {verb}`")),
            "{error}"
        );
    }
}
