//! Thirty loops of `simulate`, `replan`, `simulate`, `compare` through the built binary.

use std::path::Path;

use crate::support::{clean, json, scratch};

#[test]
#[ignore = "minutes in release"]
fn fifteen_loops_of_two_tasks_take_six_tenths_off_in_every_cell_and_no_run_is_worse() {
    loops("");
}

#[test]
#[ignore = "minutes in release"]
fn so_does_the_command_alone() {
    loops("--keep-plan");
}

/// Three machines, two tasks, five seeds.
fn loops(lever: &str) {
    let folder = scratch();
    let folder = folder.path();
    clean(folder, "plan task-1.toml --times 0,7.744,15.307,22.863,30.976,38.72 -o 1.mcap");
    clean(folder, "plan task-2.toml --times 0,9.431,19.334,34.66,39.14,49.043 -o 2.mcap");
    for plant in ["dead-band-limited", "default", "lag-limited"] {
        for task in ["1", "2"] {
            let changes: Vec<f64> = (1..=5).map(|seed| one_loop(folder, lever, plant, task, seed)).collect();
            let mean = changes.iter().sum::<f64>() / changes.len() as f64;
            let least = changes.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let percent = [mean, least].map(|change| 100.0 * change);
            println!(
                "{plant}, task {task} {lever}: {:.0} % in the mean, {:.0} % at least",
                percent[0], percent[1]
            );
            assert!(mean <= -0.6 && least <= -0.5, "{plant} {task} {lever}: {changes:?}");
        }
    }
}

/// Relative change of the mean peak over the transitions of one loop.
fn one_loop(folder: &Path, lever: &str, plant: &str, task: &str, seed: u32) -> f64 {
    clean(folder, &format!("simulate {task}.mcap -o before.mcap --plant {plant} --seed {seed}"));
    let promised = json(folder, &format!("replan before.mcap -o next.mcap --force {lever}"));
    let (was, is) = (&promised["before"]["duration_s"], &promised["duration_s"]);
    assert!(is.as_f64().unwrap() <= was.as_f64().unwrap() * (1.0 + 1e-9), "{was} {is}");
    clean(folder, &format!("simulate next.mcap -o after.mcap --plant {plant} --seed {}", seed + 100));
    let comparison = json(folder, "compare before.mcap after.mcap");
    let (all, run) = (&comparison["summaries"][0], &comparison["whole_run"][0]);
    assert!(all["pairs"].as_u64().unwrap() >= 12, "{all}");
    for (ratio, most) in [("rms", 0.6), ("peak", 0.8)] {
        assert!(run[ratio]["ratio"].as_f64().unwrap() < most, "{plant} {task} {seed}: {}", run[ratio]);
    }
    all["relative_change"].as_f64().unwrap()
}
