//! Why a start comes late, against machines from which the cause was taken away.

use hydrotrace::{
    plant::{Parameters, Plant},
    replay::{Replay, Rules, replay},
    series::{Pair, Series},
    workflow::report::Why,
};

use crate::support::machine::{Job, fitted, plant, run, task};

/// A machine that has no dead band.
fn without_dead_band(parameters: &mut Parameters) {
    for joint in &mut parameters.joints {
        (joint.valve.hysteresis, joint.valve.overlap_extend, joint.valve.overlap_retract) = (0.0, 0.0, 0.0);
        joint.control.compensation = 0.0;
        joint.friction.breakaway_n = joint.friction.coulomb_n;
    }
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

/// Seconds by which the part of the dead band is wrong, start by start, and whether its interval holds the truth.
fn wrong_s(preset: &str, number: usize, seed: u64) -> Vec<(f64, bool)> {
    let job = task(number);
    let machines: [Plant; 2] = [plant(preset, |_| {}), plant(preset, without_dead_band)];
    let [came, freed] = machines.map(|machine| run(&machine, &job.plan, &job, seed));
    let fit = fitted(&[(&job.plan, &came)]);
    let found = replayed(&job, &came);
    let free = replayed(&job, &freed);
    let why = Why::of(&fit, &job.plan, &job.plan, &paired(&job, &came), &found).unwrap();
    let truth_s = |id: &str, delay_s: f64| {
        let other = free.transitions.iter().find(|other| other.id == id)?;
        Some(delay_s - other.onset_delay_s?)
    };
    why.starts
        .iter()
        .filter_map(|start| {
            let truth_s = truth_s(&start.id, start.onset_delay_s)?;
            let [low, high] = start.dead_band.interval_s?;
            Some((start.dead_band.delay_s - truth_s, (low..=high).contains(&truth_s)))
        })
        .collect()
}

#[test]
fn the_part_of_the_dead_band_is_what_goes_with_it() {
    let mut all = Vec::new();
    for preset in ["default", "dead-band-limited", "lag-limited"] {
        for number in [1, 2] {
            let wrong = wrong_s(preset, number, 1);
            println!("{preset}, task {number}: {wrong:.3?}");
            all.extend(wrong);
        }
    }
    let within = |most_s: f64| all.iter().filter(|(wrong_s, _)| wrong_s.abs() <= most_s).count();
    let held = all.iter().filter(|(_, held)| *held).count();
    println!(
        "of {}: {} within 0.1 s, {} within 0.2 s, {held} in their interval",
        all.len(),
        within(0.1),
        within(0.2)
    );
    assert!(10 * held >= 9 * all.len() && 2 * within(0.1) >= all.len());
}
