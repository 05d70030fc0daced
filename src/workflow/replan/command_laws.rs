//! What holds for every command: made from random plans, answers, models and gains.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal, Uniform};

use super::command::{Commanded, Subject, commanded};
use crate::{
    arm::Arm,
    fit::{Fit, Learning, Observation, STEP_S, Trial, fit},
    math::State,
    plan::{Interpolation, KEPT_SHARE, Setup},
    rng::{Stream, stream},
    series::{Series, Track},
    task::Task,
    workflow::{
        carried::rest::PLAN_LEAD_S,
        replan::{ReplanFailure, samples::sampled},
    },
};

const TASK: &str = include_str!("../../../sample-logs/tasks/task-1.toml");

/// Arrivals at the key points of the paper, s.
const TIMES_S: [f64; 6] = [0.0, 7.744, 15.307, 22.863, 30.976, 38.72];

/// Commands of one call of the tests; with `HYDROTRACE_COMMANDS` so many.
fn count() -> u64 {
    std::env::var("HYDROTRACE_COMMANDS").ok().and_then(|count| count.parse().ok()).unwrap_or(6)
}

struct Case {
    setup: Setup,
    plan: Series,
    command: Commanded,
}

fn uniform(rng: &mut ChaCha8Rng, low: f64, high: f64) -> f64 {
    Uniform::new(low, high).unwrap().sample(rng)
}

/// What a machine of some dead time, sag, noise and swing answers.
fn answer(sent: &Series, rng: &mut ChaCha8Rng) -> Series {
    let one = |track: &Track| {
        let (late_s, gain) = (uniform(rng, 0.0, 0.5), uniform(rng, 0.8, 1.1));
        let (sag_rad, swing_hz) = (uniform(rng, -0.02, 0.02), uniform(rng, 0.3, 4.0));
        let swing_rad = if uniform(rng, 0.0, 1.0) < 0.2 { uniform(rng, 0.0, 0.03) } else { 0.0 };
        let noise_rad = uniform(rng, 0.0, 2e-3);
        let start_rad = track.position()[0];
        let position = (track.t_s().iter())
            .map(|t_s| {
                let noise: f64 = StandardNormal.sample(rng);
                let moved = gain * (track.held_at(t_s - late_s).position - start_rad);
                let swing = swing_rad * (2.0 * std::f64::consts::PI * swing_hz * t_s).sin();
                start_rad + moved + sag_rad + swing + noise_rad * noise
            })
            .collect();
        Track::new(track.name(), track.t_s(), position, &[]).unwrap()
    };
    Series { tracks: sent.tracks.iter().map(one).collect() }
}

fn machine(plan: &Series, rng: &mut ChaCha8Rng) -> Fit {
    let measured = answer(plan, rng);
    let mut fit = fit(&[Observation { sent: plan, measured: &measured, valve: &[] }]).unwrap();
    for joint in &mut fit.joints {
        joint.held_out_r2 = uniform(rng, -1.0, 1.0);
    }
    fit
}

/// One command of a task whose times are stretched at random, from up to three runs.
fn case(fit: &Fit, base: &Setup, seed: u64) -> Result<Case, ReplanFailure> {
    let mut rng = stream(seed, Stream::SensorNoise);
    let stretch = uniform(&mut rng, 1.0, 1.3);
    let times_s: Vec<f64> = TIMES_S.iter().map(|t_s| stretch * t_s).collect();
    let setup = base.clone();
    let motion = setup.motion(&times_s)?;
    let plan = sampled(&setup, &motion)?;
    let mut runs = vec![(plan.clone(), answer(&plan, &mut rng))];
    let settings = Learning {
        gain: uniform(&mut rng, 0.1, 1.0),
        most_rad: seed.is_multiple_of(2).then(|| uniform(&mut rng, 0.0, 0.2)),
        ..Learning::default()
    };
    let made = |runs: &[(Series, Series)]| {
        let trials: Vec<Trial> = runs.iter().map(|(sent, measured)| Trial { sent, measured }).collect();
        let motion = Some((setup.motion(&times_s)?, PLAN_LEAD_S));
        let subject = Subject { plan: &plan, motion, setup: Some(&setup) };
        commanded(fit, &subject, &trials, settings)
    };
    let mut command = made(&runs)?;
    for _ in 0..seed % 3 {
        let sent = command.series.clone();
        let measured = answer(&sent, &mut rng);
        runs.push((sent, measured));
        command = made(&runs)?;
    }
    Ok(Case { setup, plan, command })
}

#[test]
fn no_command_breaks_a_limit_of_its_plan_or_ends_elsewhere_or_in_motion() {
    let setup = Setup::new(&Task::parse(TASK).unwrap(), Arm::sample().unwrap()).unwrap();
    let plan = sampled(&setup, &setup.motion(&TIMES_S).unwrap()).unwrap();
    let fit = machine(&plan, &mut stream(0, Stream::SensorNoise));
    let mut corrected = 0;
    for seed in 1..=count() {
        let Case { setup, plan, command } = case(&fit, &setup, seed).unwrap();
        corrected += usize::from(command.applied());
        let names = setup.joint_names();
        let mut sent = Vec::new();
        for (name, (track, acceleration)) in
            names.iter().zip(command.series.tracks.iter().zip(&command.acceleration_rad_s2))
        {
            let (planned, speed) = (plan.track(name).unwrap(), track.velocity().unwrap());
            let last = track.len() - 1;
            assert_eq!(track.name(), name);
            assert_eq!((track.len(), acceleration.len()), (planned.len(), planned.len()));
            for k in [0, last] {
                assert_eq!(
                    track.position()[k].to_bits(),
                    planned.position()[k].to_bits(),
                    "seed {seed}, {name}: an end is moved"
                );
                assert!(
                    speed[k].abs() < 1e-12 && acceleration[k].abs() < 1e-12,
                    "seed {seed}, {name}: an end moves"
                );
            }
            let state = |k: usize| State {
                position: track.position()[k],
                velocity: speed[k],
                acceleration: acceleration[k],
            };
            sent.push((0..track.len()).map(state).collect::<Vec<State>>());
        }
        for how in Interpolation::ALL {
            for stride in [1, 4] {
                let points: Vec<Vec<State>> =
                    sent.iter().map(|all| all.iter().copied().step_by(stride).collect()).collect();
                for margin in setup.command_margins(&points, stride as f64 * STEP_S, how) {
                    assert!(margin.share <= KEPT_SHARE, "seed {seed}, {how:?} {stride}: {margin:?}");
                }
            }
        }
    }
    assert!(corrected as u64 > count() / 2, "{corrected}");
}
