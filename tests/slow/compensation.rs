//! Commands made from fits: every machine, task and change of the machine.

use cpu_time::ProcessTime;
use hydrotrace::{
    fit::{Excitation, Learning, learn},
    plant::Plant,
};

use crate::support::{
    compensation::{Figures, PRESETS, changed, check, learnt, ratio, tried},
    machine::{excitation, fitted, run, task},
    variation::Variation,
};

fn row(title: &str, before: &Figures, after: &Figures) {
    let change = |of: fn(&Figures) -> f64| 100.0 * (of(after) / of(before) - 1.0);
    println!(
        "{title} | {:.3} {:.3} {:.3} | {:.3} {:.3} {:.3} | {:.0} {:.0} {:.0} | {:.2}",
        before.mean_peak,
        before.worst_peak,
        before.rms,
        after.mean_peak,
        after.worst_peak,
        after.rms,
        change(|f| f.mean_peak),
        change(|f| f.worst_peak),
        change(|f| f.rms),
        ratio(before, after),
    );
}

const HEAD: &str = "| plain mean peak, worst peak, rms, deg | with command | change, % | acceleration ratio";

#[test]
#[ignore = "minutes; in release by .ci/run"]
fn commands_from_task_logs_take_six_tenths_off_for_every_machine_and_task() {
    let clock = ProcessTime::now();
    println!("plant, task, seed {HEAD}");
    let mut all = Vec::new();
    for preset in PRESETS {
        let plant = Plant::preset(preset).unwrap();
        for number in [1, 2] {
            let (job, mut left) = (task(number), 0.0);
            for seed in 1..=5 {
                let (before, after) = tried(&plant, &job, &learnt(&plant, &job, seed), seed);
                let title = format!("{preset} {number} {seed}");
                row(&title, &before, &after);
                // No run is worse than the plan sent as it is; each cell must do better below.
                check(&title, &before, &after, (1.0, 2.0));
                left += after.mean_peak / before.mean_peak / 5.0;
            }
            println!("{preset} {number}: {:.0} % off the mean peak", 100.0 * (1.0 - left));
            assert!(left <= 0.4, "{preset} {number}: {left}");
            all.push(left);
        }
    }
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    println!("all: {:.0} %; {:.0} s of processor time", 100.0 * (1.0 - mean), clock.elapsed().as_secs_f64());
    assert!(mean <= 0.35, "{mean}");
}

#[test]
#[ignore = "minutes; in release by .ci/run"]
fn commands_take_half_off_for_every_machine_as_it_has_become() {
    let clock = ProcessTime::now();
    println!("plant, task, change {HEAD}");
    for preset in PRESETS {
        for number in [1, 2] {
            let job = task(number);
            let command = learnt(&Plant::preset(preset).unwrap(), &job, 1);
            for variation in Variation::ALL {
                let (plant, job) = changed(preset, &job, variation);
                let (before, after) = tried(&plant, &job, &command, 1);
                let title = format!("{preset} {number} {variation:?}");
                row(&title, &before, &after);
                check(&title, &before, &after, (0.5, 2.0));
            }
        }
    }
    println!("{:.0} s of processor time", clock.elapsed().as_secs_f64());
}

#[test]
#[ignore = "minutes; in release by .ci/run"]
fn commands_from_other_runs_of_the_machine_help_too() {
    let clock = ProcessTime::now();
    println!("plant, fitted to, commanded {HEAD}");
    for preset in PRESETS {
        let plant = Plant::preset(preset).unwrap();
        let jobs = [task(1), task(2), excitation(&Excitation::minimal())];
        let fits = jobs.each_ref().map(|job| fitted(&[(&job.plan, &run(&plant, &job.plan, job, 1))]));
        for (title, learnt, done) in
            [("task 1 to 2", 0, 1), ("task 2 to 1", 1, 0), ("trial to 1", 2, 0), ("trial to 2", 2, 1)]
        {
            let job = &jobs[done];
            let made = learn(&fits[learnt], &job.plan, &[], Learning::default(), |_| None).unwrap();
            let (before, after) = tried(&plant, job, &made.command(&job.plan, |_| 1.0).unwrap(), 1);
            let title = format!("{preset} {title}");
            row(&title, &before, &after);
            check(&title, &before, &after, (0.6, 3.0));
        }
    }
    println!("{:.0} s of processor time", clock.elapsed().as_secs_f64());
}
