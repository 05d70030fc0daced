//! How right the parts of a late start are, against machines from which the cause was taken away.

use hydrotrace::{
    fit::{Excitation, Fit},
    math::median,
    plant::{JointParameters, Plant},
    replay::{Replay, Rules, Transition, replay},
    series::{Pair, Series},
    workflow::report::Why,
};

use super::machine::{Job, excitation, fitted, plant, run, task};

/// A valve and a controller that leave no dead band; the friction that holds a joint at rest is that of its motion.
fn without_dead_band(joint: &mut JointParameters) {
    (joint.valve.hysteresis, joint.valve.overlap_extend, joint.valve.overlap_retract) = (0.0, 0.0, 0.0);
    joint.control.compensation = 0.0;
    joint.friction.breakaway_n = joint.friction.coulomb_n;
}

/// The same, and next to nothing that holds it: dry friction of a motion is static friction too, and moves the oil until
/// it is overcome.
fn without_both(joint: &mut JointParameters) {
    joint.friction.coulomb_n *= 0.05;
    without_dead_band(joint);
}

fn changed(preset: &str, change: fn(&mut JointParameters)) -> Plant {
    plant(preset, |parameters| parameters.joints.iter_mut().for_each(change))
}

fn paired(job: &Job, measured: &Series) -> Vec<Pair> {
    let both = job
        .plan
        .tracks
        .iter()
        .filter_map(|planned| hydrotrace::series::align(planned, measured.track(planned.name())?));
    both.collect()
}

fn replayed(job: &Job, measured: &Series) -> Replay {
    replay(&paired(job, measured), &Rules::default())
}

/// The same start of another run.
fn delay_s(other: &Replay, start: &Transition) -> Option<f64> {
    let same = |other: &&Transition| {
        (&other.joint, other.kind, other.direction) == (&start.joint, start.kind, start.direction)
            && (other.planned_onset_s - start.planned_onset_s).abs() <= 0.3
    };
    other.transitions.iter().find(same)?.onset_delay_s
}

/// The delays of one start, s.
struct Start {
    came: Transition,
    /// Without both, each with noise of its own.
    free_s: Vec<f64>,
    /// With dry friction left.
    held_s: Option<f64>,
}

/// A run that is explained, and what it would have been.
struct Tried {
    job: Job,
    came: Series,
    found: Replay,
    starts: Vec<Start>,
}

/// Noise of the runs without dead band; the first is that of the run.
const SEEDS: [u64; 3] = [1, 101, 201];

fn tried(preset: &str, number: usize) -> Tried {
    let job = task(number);
    let came = run(&changed(preset, |_| {}), &job.plan, &job, SEEDS[0]);
    let found = replayed(&job, &came);
    let freed = changed(preset, without_both);
    let free = SEEDS.map(|seed| replayed(&job, &run(&freed, &job.plan, &job, seed)));
    let held = replayed(&job, &run(&changed(preset, without_dead_band), &job.plan, &job, SEEDS[0]));
    let timed = found.transitions.iter().filter(|start| start.onset_delay_s.is_some());
    let starts = timed.map(|came| Start {
        came: came.clone(),
        free_s: free.iter().filter_map(|run| delay_s(run, came)).collect(),
        held_s: delay_s(&held, came),
    });
    let starts = starts.collect();
    Tried { job, came, found, starts }
}

/// What a machine is known to be from a run that is made to identify it and two others.
fn identified(preset: &str) -> Fit {
    let machine = changed(preset, |_| {});
    let jobs = [excitation(&Excitation::minimal()), task(1), task(2)];
    let came: Vec<Series> =
        jobs.iter().zip(7..).map(|(job, seed)| run(&machine, &job.plan, job, seed)).collect();
    let logs: Vec<(&Series, &Series)> = jobs.iter().map(|job| &job.plan).zip(&came).collect();
    fitted(&logs)
}

/// How wrong the parts of the dead band are.
#[derive(Default)]
struct Tally {
    timed: usize,
    /// Against the median of machines without both, and whether the interval holds it.
    wrong_s: Vec<(f64, bool)>,
    /// Against one machine of them, and with dry friction left.
    against_one_s: Vec<f64>,
    against_held_s: Vec<f64>,
    /// One machine of them against another: no split comes closer to the first.
    noise_s: Vec<f64>,
}

impl Tally {
    fn add(&mut self, fit: &Fit, tried: &Tried) {
        let plan = &tried.job.plan;
        let why = Why::of(fit, plan, plan, &paired(&tried.job, &tried.came), &tried.found).unwrap();
        self.timed += tried.starts.len();
        for split in &why.starts {
            let Some(start) = tried.starts.iter().find(|start| start.came.id == split.id) else { continue };
            let parts = [split.dead_band, split.lag, split.limit, split.unexplained];
            let sum_s: f64 = parts.iter().map(|part| part.delay_s).sum();
            assert!((sum_s - split.onset_delay_s).abs() < 1e-9, "{split:?}");
            let Some([low_s, high_s]) = split.dead_band.interval_s else { continue };
            let off_s = |free_s: f64| split.dead_band.delay_s - (split.onset_delay_s - free_s);
            if !start.free_s.is_empty() {
                let truth_s = split.onset_delay_s - median(start.free_s.clone());
                let held = (low_s..=high_s).contains(&truth_s);
                self.wrong_s.push((split.dead_band.delay_s - truth_s, held));
            }
            self.against_one_s.extend(start.free_s.first().copied().map(off_s));
            self.against_held_s.extend(start.held_s.map(off_s));
            self.noise_s.extend(start.free_s.windows(2).take(1).map(|two| two[0] - two[1]));
        }
    }

    /// Shares of all starts with a time that are split, of those right within 0.1 s and 0.2 s, and of intervals that
    /// hold the truth.
    fn shares(&self, name: &str) -> [f64; 4] {
        let share = |all: &[f64], most_s: f64| {
            all.iter().filter(|s| s.abs() <= most_s).count() as f64 / all.len() as f64
        };
        let wrong_s: Vec<f64> = self.wrong_s.iter().map(|(wrong_s, _)| *wrong_s).collect();
        let held = self.wrong_s.iter().filter(|(_, held)| *held).count() as f64 / wrong_s.len() as f64;
        let split = wrong_s.len() as f64 / self.timed as f64;
        let shares = [split, share(&wrong_s, 0.1), share(&wrong_s, 0.2), held];
        println!(
            "{name}: of {} starts {:.2} split; {:.2} within 0.1 s, {:.2} within 0.2 s, {:.2} in their interval; against one \
             run {:.2} within 0.1 s, with dry friction left {:.2}, one run against another {:.2}",
            self.timed,
            shares[0],
            shares[1],
            shares[2],
            shares[3],
            share(&self.against_one_s, 0.1),
            share(&self.against_held_s, 0.1),
            share(&self.noise_s, 0.1),
        );
        shares
    }
}

/// Fits to the run itself, and to runs that identify its machine if `known`: shares of all starts of presets and tasks of the
/// paper as [`Tally::shares`] has them, none below its least.
pub(crate) fn parts_are_right(presets: &[&str], tasks: &[usize], known: bool, least: [f64; 4]) {
    let (mut of_run, mut of_machine) = (Tally::default(), Tally::default());
    for preset in presets {
        let identified = known.then(|| identified(preset));
        for number in tasks {
            let tried = tried(preset, *number);
            of_run.add(&fitted(&[(&tried.job.plan, &tried.came)]), &tried);
            if let Some(identified) = &identified {
                of_machine.add(identified, &tried);
            }
        }
    }
    let of_machine = known.then_some(("a known machine", of_machine));
    for (name, tally) in [("a fit to the run", of_run)].into_iter().chain(of_machine) {
        let shares = tally.shares(name);
        assert!(shares.iter().zip(least).all(|(share, least)| *share >= least), "{name}: {shares:?}");
    }
}
