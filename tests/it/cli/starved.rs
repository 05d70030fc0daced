//! A pump that gives less than joints ask for together.

use std::fs;

use serde_json::Value;

use super::replan::{check, table};
use crate::support::{clean, json, sample, scratch};

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
    let reported = json(folder, "report run.mcap");
    assert!(reported["supply"]["flow_m3_s"].is_array(), "{}", reported["supply"]);
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

#[test]
fn a_pressure_of_the_supply_in_a_table_is_known_by_its_header() {
    let folder = scratch();
    let folder = folder.path();
    fs::copy(sample("task-1-run.mcap"), folder.join("sound.mcap")).unwrap();
    // A joint that is held for a while is behind.
    table(folder, "sound.mcap", "held.csv", |joint, t_s, angle_rad| {
        let held = (t_s - 7.0).clamp(0.0, 1.0) * (13.0 - t_s).clamp(0.0, 1.0);
        if joint == 1 { angle_rad - 0.1 * held } else { angle_rad }
    });
    let text = fs::read_to_string(folder.join("held.csv")).unwrap();
    let at = text.lines().next().unwrap().split(',').position(|name| name == "time_s").unwrap();
    for (head, falls) in [("P_supply [bar]", true), ("Systemdruck (bar)", true), ("Charge pump [bar]", false)]
    {
        let row = |(k, row): (usize, &str)| {
            let t_s: f64 = row.split(',').nth(at).unwrap().parse().unwrap_or(0.0);
            let pressure = if (7.0..13.0).contains(&t_s) { "61.5" } else { "160" };
            format!("{row},{}\n", if k == 0 { head } else { pressure })
        };
        fs::write(folder.join("plc.csv"), text.lines().enumerate().map(row).collect::<String>()).unwrap();
        let supply = json(folder, "report plc.csv")["supply"].clone();
        assert_eq!(supply.is_object(), falls, "{head}: {supply}");
        if falls {
            assert_eq!(supply["least_pa"].as_f64().map(f64::round), Some(61.5e5), "{head}: {supply}");
            assert_eq!(supply["flow_m3_s"], Value::Null, "{head}: {supply}");
        }
    }
    // Nothing in a table tells the cylinders; the task does.
    let text = fs::read_to_string(folder.join("plc.csv")).unwrap().replace("Charge pump", "P_pump");
    fs::write(folder.join("plc.csv"), text).unwrap();
    let next = json(folder, "replan plc.csv --task task-1.toml --keep-plan --gain 0.5");
    assert!(check(&next, "supply")["supply"]["flow_m3_s"].is_array(), "{}", next["checks"]);
}
