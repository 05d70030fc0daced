//! The paper's tasks on the three presets: how large errors are, and where.

use hydrotrace::{
    plant::{PayloadChange, Plant, simulate},
    replay::{Rules, replay},
    series::Series,
    units::degrees_from_radians,
};

use crate::support::machine::{REST_S, pairs, paper_plan as plan};

/// Within so long after a planned start an error counts as one of the start, s.
const INSIDE_S: f64 = 3.0;

/// Figures of a preset on a task, degrees.
#[derive(Debug)]
struct Figures {
    mean_peak: f64,
    most: f64,
    from_home: f64,
    inside: f64,
    outside: f64,
}

fn figures(preset: &str, (plan, payload): &(Series, Vec<PayloadChange>), seeds: u64) -> Figures {
    let plant = Plant::preset(preset).unwrap();
    let (mut peaks, mut most, mut home) = (Vec::new(), 0.0, Vec::new());
    let (mut inside, mut outside) = (Vec::new(), Vec::new());
    for seed in 1..=seeds {
        let record = simulate(&plant, plan, payload, seed).unwrap();
        let pairs = pairs(plan, &record);
        let found = replay(&pairs, &Rules::default());
        let mut run_most = 0.0_f64;
        for transition in &found.transitions {
            let peak = degrees_from_radians(transition.peak_error);
            peaks.push(peak);
            run_most = run_most.max(peak);
            if transition.planned_onset_s < REST_S + 1.5 {
                home.push(peak);
            }
        }
        most += run_most / seeds as f64;
        for pair in &pairs {
            let starts =
                || found.transitions.iter().filter(|t| t.joint == pair.name).map(|t| t.planned_onset_s);
            for ((t, planned), measured) in pair.t_s.iter().zip(&pair.planned).zip(&pair.measured) {
                let within = starts().any(|start| (start..start + INSIDE_S).contains(t));
                let error = degrees_from_radians(planned - measured);
                if within { &mut inside } else { &mut outside }.push(error * error);
            }
        }
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    Figures {
        mean_peak: mean(&peaks),
        most,
        from_home: mean(&home),
        inside: mean(&inside).sqrt(),
        outside: mean(&outside).sqrt(),
    }
}

#[test]
fn presets_keep_to_their_regimes_and_errors_live_in_the_starts() {
    for (preset, peaks) in
        [("dead-band-limited", [0.30, 0.46]), ("default", [0.38, 0.56]), ("lag-limited", [0.46, 0.78])]
    {
        for task in 0..2 {
            let found = figures(preset, &plan(task, 1.0), 2);
            println!("{preset}, task {}: {found:.3?}", task + 1);
            assert!((peaks[0]..peaks[1]).contains(&found.mean_peak), "{preset} {task}: {found:?}");
            assert!(found.most > 1.5 * found.mean_peak && found.most < 2.4, "{preset} {task}: {found:?}");
            assert!(found.inside > found.outside, "{preset} {task}: {found:?}");
            assert!((0.25..0.75).contains(&found.from_home), "{preset} {task}: {found:?}");
            if preset != "lag-limited" {
                assert!(found.inside > 1.3 * found.outside, "{preset} {task}: {found:?}");
            }
        }
    }
}

#[test]
fn slower_plans_have_smaller_peaks_but_never_below_the_dead_band() {
    let peaks = [1.0, 1.5, 2.5].map(|slower| figures("default", &plan(0, slower), 1));
    assert!(peaks[1].mean_peak < peaks[0].mean_peak, "{peaks:?}");
    assert!(peaks[2].most < peaks[0].most, "{peaks:?}");
    assert!(peaks[2].mean_peak > 0.25, "{peaks:?}");
}
