//! Commands made from fits, on the machines that the fits are of.

use cpu_time::ProcessTime;

use hydrotrace::{
    arm::Arm,
    fit::{Compensation, Excitation, compensate},
    plant::{Parameters, Plant, Variation},
    replay::{Rules, replay},
    series::{Pair, Series, align, local_quadratic},
    units::DEGREE_RAD,
};

use super::{Job, excitation, fitted, run, task};

/// Errors of a run, degrees and degrees per square second.
#[derive(Debug, Clone, Copy, Default)]
struct Figures {
    mean_peak: f64,
    worst_peak: f64,
    rms: f64,
    acceleration: [f64; 6],
}

fn figures(job: &Job, measured: &Series) -> Figures {
    let pairs: Vec<Pair> = measured
        .tracks
        .iter()
        .map(|track| align(job.plan.track(track.name()).unwrap(), track).unwrap())
        .collect();
    let found = replay(&pairs, &Rules::default());
    let peaks: Vec<f64> = found.transitions.iter().map(|t| t.peak_error_rad / DEGREE_RAD).collect();
    let mut acceleration = [0.0; 6];
    for (most, pair) in acceleration.iter_mut().zip(&pairs) {
        let fits = local_quadratic(&pair.t_s, &pair.measured, &pair.segments, 0.15, 9);
        *most = fits.iter().map(|fit| fit.acceleration.abs() / DEGREE_RAD).fold(0.0, f64::max);
    }
    Figures {
        mean_peak: peaks.iter().sum::<f64>() / peaks.len() as f64,
        worst_peak: peaks.iter().copied().fold(0.0, f64::max),
        rms: found.whole_run.tracking_error.unwrap().rms_rad / DEGREE_RAD,
        acceleration,
    }
}

const PRESETS: [&str; 3] = ["dead-band-limited", "default", "lag-limited"];

/// The command that a fit to a run of the plan makes.
fn learnt(plant: &Plant, job: &Job, seed: u64) -> Series {
    let plain = run(plant, &job.plan, job, seed);
    compensate(&fitted(&[(&job.plan, &plain)]), &job.plan, Compensation::default()).unwrap().command
}

/// Runs of the plan and of a command on a machine as it is then.
fn tried(plant: &Plant, job: &Job, command: &Series, seed: u64) -> (Figures, Figures) {
    let before = run(plant, &job.plan, job, seed + 50);
    let after = run(plant, command, job, seed + 100);
    let ends = |series: &Series| series.tracks.iter().map(|t| *t.t_s().last().unwrap()).collect::<Vec<_>>();
    assert_eq!(ends(command), ends(&job.plan));
    (figures(job, &before), figures(job, &after))
}

/// The machine as it has become, and what it carries then.
fn changed(preset: &str, job: &Job, variation: Variation) -> (Plant, Job) {
    let parameters = variation.parameters(&Parameters::preset(preset).unwrap());
    let plant = Plant::new(&Arm::sample().unwrap(), parameters).unwrap();
    (plant, Job { plan: job.plan.clone(), payload: variation.payload(&job.payload) })
}

fn ratio(before: &Figures, after: &Figures) -> f64 {
    after.acceleration.iter().zip(before.acceleration).map(|(a, b)| a / b).fold(0.0, f64::max)
}

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

/// What every command must do: leave so much of the mean peak, and accelerate the joints so much more.
fn check(title: &str, before: &Figures, after: &Figures, (most, faster): (f64, f64)) {
    assert!(after.mean_peak <= most * before.mean_peak, "{title}: {before:?} {after:?}");
    assert!(after.worst_peak <= before.worst_peak, "{title}: {before:?} {after:?}");
    assert!(ratio(before, after) <= faster, "{title}: {before:?} {after:?}");
}

#[test]
fn a_command_from_one_log_of_the_task_takes_six_tenths_off_the_mean_transition_peak() {
    for preset in PRESETS {
        let plant = Plant::preset(preset).unwrap();
        for number in [1, 2] {
            let job = task(number);
            let (before, after) = tried(&plant, &job, &learnt(&plant, &job, 1), 1);
            check(&format!("{preset} {number}"), &before, &after, (0.4, 2.0));
        }
    }
}

#[test]
fn a_command_still_helps_once_the_machine_has_changed() {
    let job = task(1);
    let command = learnt(&Plant::preset("default").unwrap(), &job, 1);
    for variation in [Variation::ColdOil, Variation::HeavyPayload] {
        let (plant, job) = changed("default", &job, variation);
        let (before, after) = tried(&plant, &job, &command, 1);
        check(&format!("{variation:?}"), &before, &after, (0.5, 2.0));
    }
}

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
            let made = compensate(&fits[learnt], &job.plan, Compensation::default()).unwrap();
            let (before, after) = tried(&plant, job, &made.command, 1);
            let title = format!("{preset} {title}");
            row(&title, &before, &after);
            check(&title, &before, &after, (0.6, 3.0));
        }
    }
    println!("{:.0} s of processor time", clock.elapsed().as_secs_f64());
}
