//! Commands made from fits, on the machines that the fits are of.

use cpu_time::ProcessTime;

use hydrotrace::{
    arm::Arm,
    fit::{Compensation, Excitation, compensate},
    plant::{Parameters, PayloadChange, Plant, Variation},
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
        let fits = local_quadratic(&pair.t_s, &pair.measured_rad, &pair.segments, 0.15, 9);
        *most = fits.iter().map(|fit| fit.acceleration_rad_s2.abs() / DEGREE_RAD).fold(0.0, f64::max);
    }
    Figures {
        mean_peak: peaks.iter().sum::<f64>() / peaks.len() as f64,
        worst_peak: peaks.iter().copied().fold(0.0, f64::max),
        rms: found.whole_run.tracking_error.unwrap().rms_rad / DEGREE_RAD,
        acceleration,
    }
}

const PRESETS: [&str; 3] = ["dead-band-limited", "default", "lag-limited"];

/// A run as planned, and one with the command that a fit to it makes, on the machine as it is then.
fn before_and_after(
    (plant, later): (&Plant, &Plant),
    job: &Job,
    payload: &[PayloadChange],
    seed: u64,
) -> (Figures, Figures) {
    let plain = run(plant, &job.plan, job, seed);
    let fit = fitted(&[(&job.plan, &plain)]);
    let made = compensate(&fit, &job.plan, Compensation::default()).unwrap();
    let later_job = Job { plan: job.plan.clone(), payload: payload.to_vec() };
    let before = run(later, &job.plan, &later_job, seed + 50);
    let after = run(later, &made.command, &later_job, seed + 100);
    (figures(job, &before), figures(job, &after))
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

/// What every command made from the log of the same task must do.
fn check(title: &str, before: &Figures, after: &Figures, most: f64) {
    assert!(after.mean_peak <= most * before.mean_peak, "{title}: {before:?} {after:?}");
    assert!(after.worst_peak <= before.worst_peak, "{title}: {before:?} {after:?}");
    assert!(ratio(before, after) <= 2.0, "{title}: {before:?} {after:?}");
}

#[test]
fn a_command_from_one_log_of_the_task_takes_six_tenths_off_the_mean_transition_peak() {
    for preset in PRESETS {
        let plant = Plant::preset(preset).unwrap();
        for number in [1, 2] {
            let job = task(number);
            let (before, after) = before_and_after((&plant, &plant), &job, &job.payload, 1);
            check(&format!("{preset} {number}"), &before, &after, 0.4);
        }
    }
}

#[test]
fn a_command_still_helps_once_the_machine_has_changed() {
    for variation in [Variation::ColdOil, Variation::HeavyPayload] {
        let base = Parameters::preset("default").unwrap();
        let plant = Plant::new(&Arm::sample().unwrap(), base.clone()).unwrap();
        let later = Plant::new(&Arm::sample().unwrap(), variation.parameters(&base)).unwrap();
        let job = task(1);
        let (before, after) = before_and_after((&plant, &later), &job, &variation.payload(&job.payload), 1);
        check(&format!("{variation:?}"), &before, &after, 0.5);
    }
}

#[test]
#[ignore = "prints a table; minutes in release"]
fn table_of_commands() {
    println!("plant, task, seed {HEAD}");
    for preset in PRESETS {
        let plant = Plant::preset(preset).unwrap();
        for number in [1, 2] {
            let job = task(number);
            for seed in 1..=5 {
                let (before, after) = before_and_after((&plant, &plant), &job, &job.payload, seed);
                row(&format!("{preset} {number} {seed}"), &before, &after);
            }
        }
    }
}

#[test]
#[ignore = "prints a table; minutes in release"]
fn table_of_changed_machines() {
    println!("plant, task, change {HEAD}");
    for preset in PRESETS {
        let base = Parameters::preset(preset).unwrap();
        let plant = Plant::new(&Arm::sample().unwrap(), base.clone()).unwrap();
        for number in [1, 2] {
            let job = task(number);
            for variation in Variation::ALL {
                let later = Plant::new(&Arm::sample().unwrap(), variation.parameters(&base)).unwrap();
                let payload = variation.payload(&job.payload);
                let (before, after) = before_and_after((&plant, &later), &job, &payload, 1);
                row(&format!("{preset} {number} {variation:?}"), &before, &after);
            }
        }
    }
}

#[test]
#[ignore = "prints a table; minutes in release"]
fn table_of_other_tasks() {
    println!("plant, fitted to, commanded {HEAD}; processor time of the fit");
    for preset in PRESETS {
        let plant = Plant::preset(preset).unwrap();
        let jobs = [task(1), task(2), excitation(&Excitation::minimal())];
        let logs: Vec<Series> = jobs.iter().map(|job| run(&plant, &job.plan, job, 1)).collect();
        for (title, learnt, done) in [
            ("task 1 to 2", &[0][..], 1),
            ("task 2 to 1", &[1], 0),
            ("trial to 1", &[2], 0),
            ("trial to 2", &[2], 1),
            ("trial and 1 to 1", &[2, 0], 0),
            ("trial and 1 to 2", &[2, 0], 1),
        ] {
            let clock = ProcessTime::now();
            let sets: Vec<(&Series, &Series)> = learnt.iter().map(|&i| (&jobs[i].plan, &logs[i])).collect();
            let fit = fitted(&sets);
            let spent_s = clock.elapsed().as_secs_f64();
            let made = compensate(&fit, &jobs[done].plan, Compensation::default()).unwrap();
            let after = run(&plant, &made.command, &jobs[done], 101);
            let before = run(&plant, &jobs[done].plan, &jobs[done], 51);
            let title = format!("{preset} {title}, {spent_s:.2} s, margin {:.2}", fit.peak_margin);
            row(&title, &figures(&jobs[done], &before), &figures(&jobs[done], &after));
        }
    }
}
