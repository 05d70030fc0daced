//! A pump that gives less than joints ask for together.

use std::fs;

use serde_json::Value;

use super::replan::check;
use crate::support::{clean, json, scratch};

#[test]
fn a_pump_that_gives_too_little_is_told_by_its_pressure_and_new_timings_are_held_to_what_it_gave() {
    let folder = scratch();
    let folder = folder.path();
    let small = "title = 'small pump'\nbase = 'default'\n[supply]\nflow_m3_s = 0.9e-4\n";
    fs::write(folder.join("small.toml"), small).unwrap();
    clean(folder, "plan task-1.toml --times 0,4.49,8.09,12.39,18.79,21.85 -o plan.mcap");
    clean(folder, "simulate plan.mcap --plant small.toml -o run.mcap");
    clean(folder, "simulate plan.mcap -o sound.mcap");
    assert_eq!(json(folder, "fit sound.mcap")["supply"], Value::Null);
    let kept = json(folder, "replan run.mcap --keep-plan --gain 0.5");
    let supply = check(&kept, "supply");
    assert_eq!(supply["level"], "caution", "{supply}");
    let [low, middle, _] = [0, 1, 2].map(|k| supply["supply"]["flow_m3_s"][k].as_f64().unwrap());
    assert!((middle / 0.9e-4 - 1.0).abs() < 0.1, "{supply}");
    assert!(supply["asked_m3_s"].as_f64().unwrap() > 1.2 * low, "{supply}");
    let next = json(folder, "replan run.mcap --max-time-growth-percent 60 --evaluations 2000 -o next.mcap");
    assert_eq!(next["pump_flow_m3_s"].as_f64(), Some(low), "{next}");
    assert!(!next["checks"].to_string().contains("\"supply\""), "{}", next["checks"]);
    clean(folder, "simulate next.mcap --plant small.toml -o slower.mcap --seed 2");
    assert_eq!(json(folder, "fit slower.mcap")["supply"], Value::Null);
    let worst = |log: &str| {
        let starts = json(folder, &format!("report {log}"))["transitions"].clone();
        starts.as_array().unwrap().iter().filter_map(|start| start["peak_error"].as_f64()).fold(0.0, f64::max)
    };
    assert!(worst("slower.mcap") < 0.5 * worst("run.mcap"), "{} {}", worst("slower.mcap"), worst("run.mcap"));
}
