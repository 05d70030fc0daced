//! What holds of every page: nothing from a log is markup, nothing is fetched, peaks are kept.

use std::path::{Path, PathBuf};

use super::{figures, page as report_page};
use crate::{
    fit::{Estimated, Fit, JointFit, Model},
    log::ReadOptions,
    remark::Code,
    render::kit::{Figure, page::chart},
    workflow::{
        compare,
        fit::Fitted,
        report::{Inputs, Report, run},
    },
};

const SPIKE_RAD: f64 = 7.123;
const HOSTILE: &str = "</script><script>alert(1)</script><img onerror=x>&\"'";

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("sample-logs").join(name)
}

fn report(name: &str) -> Report {
    run(&Inputs { logs: vec![sample(name)], ..Inputs::default() }).unwrap()
}

/// The same with a joint, a topic and a remark that look like markup.
fn hostile() -> Report {
    let mut report = report("gaps.mcap");
    let name = report.pairs[0].name.clone();
    let renamed = |text: &mut String| {
        if *text == name {
            HOSTILE.clone_into(text);
        }
    };
    report.pairs.iter_mut().for_each(|pair| renamed(&mut pair.name));
    report.alignment.iter_mut().for_each(|a| renamed(&mut a.joint));
    report.replay.joints.iter_mut().for_each(|joint| renamed(&mut joint.name));
    report.replay.transitions.iter_mut().for_each(|t| renamed(&mut t.joint));
    HOSTILE.clone_into(&mut report.source.planned_topic);
    report.remarks.add(Code::Guessed, 1, HOSTILE);
    report
}

/// Elements by name, as a parser that knows scripts would see them.
fn tags(page: &str, name: &str) -> usize {
    page.matches(&format!("<{name}")).count()
}

#[test]
fn nothing_from_a_log_is_markup() {
    let page = report_page(HOSTILE, &hostile(), None, 60, &[]);
    assert_eq!((tags(&page, "script"), page.matches("</script").count()), (2, 2));
    assert_eq!(tags(&page, "img"), 0);
    assert!(page.contains("&lt;/script&gt;&lt;script&gt;alert(1)"), "the name is still shown");
    let data = page.split("type=\"application/json\">").nth(1).unwrap().split("</script>").next().unwrap();
    let charts: serde_json::Value = serde_json::from_str(data).unwrap();
    let titles: Vec<&str> = charts.as_array().unwrap().iter().map(|c| c["title"].as_str().unwrap()).collect();
    assert!(titles.contains(&HOSTILE), "{titles:?}");
}

#[test]
fn a_page_fetches_nothing_and_the_policy_lets_only_its_own_script_run() {
    let page = report_page("a", &report("gaps.mcap"), None, 60, &[]);
    for word in ["http://", "https://", "src=", "@import", "url(", " style=\"", "javascript:"] {
        assert!(!page.contains(word), "{word}");
    }
    assert!(page.contains("default-src 'none'; script-src 'sha256-"));
    let before = page.find("Content-Security-Policy").unwrap();
    assert!(before < page.find("<style").unwrap() && before < page.find("<script").unwrap());
}

#[test]
fn equal_runs_give_equal_pages_of_a_modest_size() {
    let report = report("panel-install.mcap");
    let page = report_page("a", &report, None, 60, &[]);
    assert_eq!(page, report_page("a", &report, None, 60, &[]));
    assert!(page.len() < 4_000_000, "{} bytes for 40 s of six joints", page.len());
}

#[test]
fn a_spike_of_one_sample_stays_in_the_plot_of_its_joint() {
    let mut report = report("panel-install.mcap");
    let pair = &mut report.pairs[1];
    // As often as an hour would be.
    let repeat = 60;
    let n = pair.t_s.len();
    let long = |values: &[f64]| values.iter().copied().cycle().take(repeat * n).collect::<Vec<f64>>();
    pair.planned = long(&pair.planned);
    pair.measured = long(&pair.measured);
    pair.t_s = (0..repeat * n).map(|i| i as f64 * 1e-2).collect();
    pair.segments = std::iter::once(0..repeat * n).collect();
    pair.measured[100_003] = SPIKE_RAD;
    let page = report_page("a", &report, None, 60, &[]);
    let spike = chart::rounded(crate::units::degrees_from_radians(SPIKE_RAD));
    assert!(page.contains(&format!("{spike}")), "{spike}");
    assert!(page.len() < 6_000_000, "{}", page.len());
    assert!(page.contains("samples drawn, most at the worst starts") && page.contains("--from, --to"));
    let worst = report.replay.worst_first()[0];
    let pair = report.pairs.iter().find(|pair| pair.name == worst.joint).unwrap();
    let [from, to] = worst.window_s.map(|at_s| pair.t_s.partition_point(|t_s| *t_s < at_s));
    let parts = super::windows::windows(pair, &report.replay);
    assert!(parts.iter().any(|part| part.start < from && part.end >= to), "{parts:?}");
}

#[test]
fn every_figure_is_xml_and_its_name_holds_nothing_but_letters() {
    let drawn = figures(&hostile()).unwrap();
    assert!(drawn.len() >= 2, "{}", drawn.len());
    for Figure { name, svg } in drawn {
        assert!(name.chars().all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c)), "{name}");
        svg.parse::<xml::Element>().unwrap();
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{name}");
    }
}

#[test]
fn a_comparison_draws_every_joint_before_and_after() {
    let logs = |name: &str| vec![sample(name)];
    let inputs = compare::Inputs {
        before: logs("panel-install.mcap"),
        after: logs("gaps.mcap"),
        read: ReadOptions::default(),
        ..compare::Inputs::default()
    };
    let comparison = compare::run(&inputs).unwrap();
    let logs = ["before it.mcap", "after.mcap"].map(PathBuf::from);
    let page = crate::render::compare::page(&comparison, 60, [&logs[..1], &logs[1..]], &[]);
    let more = "hydrotrace compare &#39;before it.mcap&#39; after.mcap --more-before RUN_BEFORE --more-after RUN_AFTER";
    assert!(page.contains("What to do next") && page.contains(&more.replace("&#39;", "'")), "{page}");
    for joint in &comparison.joints {
        assert!(page.contains(&format!("data-name=\"{joint}\"")), "{joint}");
    }
    assert_eq!(tags(&page, "script"), 2);
}

#[test]
fn a_fit_shows_its_numbers_intervals_and_what_was_never_reached() {
    let known = |value: f64| Estimated {
        value: Some(value),
        interval: Some([0.9 * value, 1.1 * value]),
        identified: true,
        ..Estimated::default()
    };
    let reached = Estimated { lower_bound: Some(0.25), ..Estimated::default() };
    let model: Model = serde_json::from_value(serde_json::json!({
        "dead_time_s": 0.1, "time_constant_s": 0.1, "position_gain_1_s": 2.0, "integral_gain_1_s2": 0.5,
        "feed_forward": 1.0, "asymmetry": 0.0, "dead_band_rad_s": 0.01, "dead_band_centre_rad_s": 0.0,
        "stiction_rad_s": 0.0, "offset_rad": 0.0, "pose_rad": [0.0, 1.0], "pose_slope_1_rad": 0.0,
        "pose_asymmetry_1_rad": 0.0, "pose_curve_1_rad2": 0.0, "speed_limit_rad_s": [null, null],
        "acceleration_limit_rad_s2": [null, null], "backlash_rad": 0.0,
    }))
    .unwrap();
    let joint = JointFit {
        name: "boom".to_owned(),
        kind: crate::series::JointKind::Turns,
        runs: 1,
        samples: 10,
        residual_rad: 0.0,
        inefficiency: 1.0,
        held_out_r2: 0.875,
        model_holds: true,
        unexplained_peak_rad: None,
        lag_s: known(0.2),
        dead_band_rad_s: known(0.01),
        dead_band_error_rad: known(0.01),
        position_gain_1_s: known(2.0),
        integral_gain_1_s2: known(0.5),
        feed_forward: known(1.0),
        set_values_late_s: known(0.0),
        gain_ratio: known(1.0),
        speed_limit_growing_rad_s: reached,
        speed_limit_shrinking_rad_s: reached,
        acceleration_limit_growing_rad_s2: reached,
        acceleration_limit_shrinking_rad_s2: reached,
        valve_dead_band: None,
        model,
    };
    let fit = Fit {
        joints: vec![joint],
        left_out: vec![],
        peak_margin: 1.25,
        margin_starts: 12,
        shared: None,
        supply: None,
    };
    let mut fitted = Fitted {
        fit: fit.clone(),
        held_out: vec![],
        torques: vec![],
        runs: vec![],
        again: vec![],
        corrected: false,
        not_again: None,
        remarks: crate::remark::Remarks::default(),
    };
    assert_eq!(fitted.known(), [4, 4]);
    fitted.fit.joints[0].feed_forward.identified = false;
    assert_eq!(fitted.known(), [3, 4]);
    fitted.fit.joints[0].model_holds = false;
    let page = crate::render::fit::page(&fitted, None);
    assert!(page.contains("0 of 4"), "no number of a model that does not hold is known");
    let page = report_page("a", &report("gaps.mcap"), Some(&fit), 60, &[]);
    for text in ["Fitted machine", "200 (180..220)", "&gt;= 14.3", "0.88"] {
        assert!(page.contains(text), "{text}");
    }
}

/// What a page says is to be done next, as text.
fn next(report: &Report) -> String {
    let page = report_page("a", report, None, 60, &[]);
    page.split("class=\"next\">").nth(1).unwrap().split("</ol>").next().unwrap().to_owned()
}

#[test]
fn advice_names_the_log_and_a_gentler_plan_only_where_the_log_holds_its_task() {
    let without = next(&report("panel-install.mcap"));
    assert!(without.contains("panel-install.mcap --keep-plan --gain 0.5 -o next.mcap"), "{without}");
    assert!(!without.contains("gentler plan too"), "{without}");
    let with = next(&report("task-1-run.mcap"));
    assert!(with.contains("task-1-run.mcap") && with.contains("gentler plan too"), "{with}");
    let mut spaced = report("task-1-run.mcap");
    spaced.paths = vec!["it's 1.mcap".into(), "2.mcap".into()];
    // Files of one run are one log first: `replan` takes each for a run.
    let joined =
        "join 'it'\\''s 1.mcap' 2.mcap -o whole.mcap &amp;&amp; hydrotrace replan whole.mcap --keep-plan";
    assert!(next(&spaced).contains(joined), "{}", next(&spaced));
}

#[test]
fn where_a_lag_explains_most_of_the_error_that_is_said_and_advised() {
    let mut report = report("panel-install.mcap");
    let starts = next(&report);
    assert!(starts.contains("Work on starts") && !starts.contains("feed-forward"), "{starts}");
    let share = report.replay.whole_run.lag_share.as_mut().unwrap();
    assert!(!share.mostly && share.share < 0.75, "{share:?}");
    (share.share, share.mostly) = (0.9, true);
    let page = report_page("a", &report, None, 60, &[]);
    assert!(page.contains("Mostly lag") && page.contains("The error is mostly lag"));
    let lag = next(&report);
    assert!(lag.contains("feed-forward") && !lag.contains("Work on starts"), "{lag}");
}

/// The first card of a page.
fn first_card(page: &str) -> &str {
    page.split("<div class=\"card ").nth(1).unwrap()
}

#[test]
fn a_start_that_is_never_answered_is_the_first_that_is_seen() {
    let page = report_page("a", &report("task-1-run.mcap"), None, 60, &[]);
    let card = first_card(&page);
    assert!(card.starts_with("bad\"") && card.contains("J3: 2 of 4 starts never answered"), "{card}");
    let at = |text: &str| page.find(text).unwrap_or_else(|| panic!("{text} is not in the page"));
    assert!(at("class=\"next\"") < at("table class=\"lanes\""));
    for text in ["\"shade\":\"never\"", "rect class=\"never\"", "<td class=\"number bad\">2 never</td>"] {
        at(text);
    }
    // Sorted, such a delay is longer than all.
    at("data-sort=\"Infinity\">never</td>");
}

#[test]
fn lanes_of_small_errors_are_drawn_small_and_of_many_joints_the_least_are_folded() {
    let mut still = report("still-joint.mcap");
    assert!(report_page("a", &still, None, 60, &[]).contains(">no start</td>"));
    let fold = "7 more joints, with smaller errors";
    assert!(!report_page("a", &still, None, 60, &[]).contains(fold));
    let (pair, joint) = (still.pairs[0].clone(), still.replay.joints[0].clone());
    let n = still.pairs.len();
    for k in n..15 {
        still.pairs.push(crate::series::Pair { name: format!("more {k}"), ..pair.clone() });
        still.replay.joints.push(crate::replay::JointReplay { name: format!("more {k}"), ..joint.clone() });
    }
    let page = report_page("a", &still, None, 60, &[]);
    assert!(page.contains(fold) && page.matches("<td class=\"lane\">").count() == 15);
}

#[test]
fn a_p_value_is_shown_where_the_verdict_goes_by_it() {
    let page = report_page("a", &report("gaps.mcap"), None, 60, &[]);
    let card = page.split("No clear difference").nth(1).unwrap().split("class=\"card").next().unwrap();
    assert!(
        card.contains("while the plan moves the error is no smaller elsewhere") && !card.contains("p = "),
        "{card}"
    );
    assert!(report_page("a", &report("task-1-run.mcap"), None, 60, &[]).contains("p = 0.073"));
}

#[test]
fn what_was_sent_lies_below_what_was_measured() {
    let inputs =
        Inputs { logs: vec![sample("precompensated-run.mcap")], with_signals: true, ..Inputs::default() };
    let page = report_page("a", &run(&inputs).unwrap(), None, 60, &[]);
    let data = page.split("type=\"application/json\">").nth(1).unwrap().split("</script>").next().unwrap();
    let charts: serde_json::Value = serde_json::from_str(data).unwrap();
    let chart = charts.as_array().unwrap().iter().find(|chart| chart["title"] == "J1").unwrap();
    let series = chart["panels"][0]["series"].as_array().unwrap();
    let roles: Vec<&str> = series.iter().map(|series| series["role"].as_str().unwrap()).collect();
    assert_eq!(roles, ["planned", "command", "measured"]);
}
