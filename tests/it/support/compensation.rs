//! Commands made from fits, on the machines that the fits are of.

use hydrotrace::{
    arm::Arm,
    fit::{Learning, Trial, learn},
    plant::{Parameters, Plant},
    replay::{Rules, replay},
    series::{Pair, Series, align, local_quadratic},
    units::DEGREE_RAD,
};

use super::{
    machine::{Job, fitted, run},
    variation::Variation,
};

/// Errors of a run, degrees and degrees per square second.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Figures {
    pub(crate) mean_peak: f64,
    pub(crate) worst_peak: f64,
    #[allow(dead_code, reason = "shown by the slow tests only")]
    pub(crate) rms: f64,
    pub(crate) acceleration: [f64; 6],
}

pub(crate) fn figures(job: &Job, measured: &Series) -> Figures {
    let pairs: Vec<Pair> = measured
        .tracks
        .iter()
        .map(|track| align(job.plan.track(track.name()).unwrap(), track).unwrap())
        .collect();
    let found = replay(&pairs, &Rules::default());
    let peaks: Vec<f64> = found.transitions.iter().map(|t| t.peak_error / DEGREE_RAD).collect();
    let mut acceleration = [0.0; 6];
    for (most, pair) in acceleration.iter_mut().zip(&pairs) {
        let fits = local_quadratic(&pair.t_s, &pair.measured, &pair.segments, 0.15, 9);
        *most = fits.iter().map(|fit| fit.acceleration.abs() / DEGREE_RAD).fold(0.0, f64::max);
    }
    Figures {
        mean_peak: peaks.iter().sum::<f64>() / peaks.len() as f64,
        worst_peak: peaks.iter().copied().fold(0.0, f64::max),
        rms: found.whole_run.tracking_error.unwrap().rms / DEGREE_RAD,
        acceleration,
    }
}

pub(crate) const PRESETS: [&str; 3] = ["dead-band-limited", "default", "lag-limited"];

/// The command that a fit to a run of the plan makes.
pub(crate) fn learnt(plant: &Plant, job: &Job, seed: u64) -> Series {
    let plain = run(plant, &job.plan, job, seed);
    let trial = Trial { sent: &job.plan, measured: &plain };
    let fit = fitted(&[(&job.plan, &plain)]);
    let found = learn(&fit, &job.plan, &[trial], Learning::default(), |_| None).unwrap();
    found.command(&job.plan, |_| 1.0).unwrap()
}

/// Runs of the plan and of a command on a machine as it is then.
pub(crate) fn tried(plant: &Plant, job: &Job, command: &Series, seed: u64) -> (Figures, Figures) {
    let before = run(plant, &job.plan, job, seed + 50);
    let after = run(plant, command, job, seed + 100);
    let ends = |series: &Series| series.tracks.iter().map(|t| *t.t_s().last().unwrap()).collect::<Vec<_>>();
    assert_eq!(ends(command), ends(&job.plan));
    (figures(job, &before), figures(job, &after))
}

/// The machine as it has become, and what it carries then.
pub(crate) fn changed(preset: &str, job: &Job, variation: Variation) -> (Plant, Job) {
    let parameters = variation.parameters(&Parameters::preset(preset).unwrap());
    let plant = Plant::new(&Arm::sample().unwrap(), parameters).unwrap();
    (plant, Job { plan: job.plan.clone(), payload: variation.payload(&job.payload) })
}

pub(crate) fn ratio(before: &Figures, after: &Figures) -> f64 {
    after.acceleration.iter().zip(before.acceleration).map(|(a, b)| a / b).fold(0.0, f64::max)
}

/// What every command must do: leave so much of the mean peak, and accelerate the joints so much more.
pub(crate) fn check(title: &str, before: &Figures, after: &Figures, (most, faster): (f64, f64)) {
    assert!(after.mean_peak <= most * before.mean_peak, "{title}: {before:?} {after:?}");
    assert!(after.worst_peak <= before.worst_peak, "{title}: {before:?} {after:?}");
    assert!(ratio(before, after) <= faster, "{title}: {before:?} {after:?}");
}
