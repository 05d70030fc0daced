//! Commands made from fits, on the machines that the fits are of.

use std::time::Instant;

use hydrotrace::{
    fit::{Compensation, compensate},
    plant::Plant,
    replay::{Rules, replay},
    series::{Pair, Series, align, local_quadratic},
    units::DEGREE_RAD,
};

use super::{Job, fitted, run, task};

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

#[test]
#[ignore = "prints a table; minutes in release"]
fn table_of_commands_from_task_logs() {
    println!(
        "plant task seed | plain peak worst rms | compensated peak worst rms | change % | accel ratio | s"
    );
    for preset in ["dead-band-limited", "default", "lag-limited"] {
        let plant = Plant::preset(preset).unwrap();
        for number in [1, 2] {
            let job = task(number);
            for seed in 1..=1 {
                let plain = run(&plant, &job.plan, &job, seed);
                let clock = Instant::now();
                let fit = fitted(&[(&job.plan, &plain)]);
                let spent = clock.elapsed().as_secs_f64();
                let made = compensate(&fit, &job.plan, Compensation::default()).unwrap();
                let after = run(&plant, &made.command, &job, seed + 100);
                let (before, after) = (figures(&job, &plain), figures(&job, &after));
                let ratio: Vec<f64> =
                    after.acceleration.iter().zip(before.acceleration).map(|(a, b)| a / b).collect();
                println!(
                    "{preset} {number} {seed} | {:.3} {:.3} {:.3} | {:.3} {:.3} {:.3} | {:.0} {:.0} {:.0} | {ratio:.2?} | {spent:.2}",
                    before.mean_peak,
                    before.worst_peak,
                    before.rms,
                    after.mean_peak,
                    after.worst_peak,
                    after.rms,
                    100.0 * (after.mean_peak / before.mean_peak - 1.0),
                    100.0 * (after.worst_peak / before.worst_peak - 1.0),
                    100.0 * (after.rms / before.rms - 1.0),
                );
                for joint in &fit.joints {
                    println!(
                        "   {} r2 {:.2} lag {:.3} {:.3?} {} d {:.2} {} limits {:?} kappa {:.0} residual {:.4}",
                        joint.name,
                        joint.held_out_r2,
                        joint.model.lag_s(),
                        joint.lag_s.interval.unwrap(),
                        joint.lag_s.identified,
                        joint.model.dead_band_rad_s / DEGREE_RAD,
                        joint.dead_band_rad_s.identified,
                        joint.model.speed_limit_rad_s,
                        joint.inefficiency,
                        joint.residual_rad / DEGREE_RAD,
                    );
                }
            }
        }
    }
}
