//! What holds for every command: made from random tasks, plans, answers, models and gains.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal, Uniform};

use super::{
    command::{Commanded, commanded},
    points::{Checked, checked},
    subject::Subject,
};
use crate::{
    arm::Arm,
    fit::{Fit, Learning, Observation, Trial, fit},
    math::State,
    plan::{BETWEEN, Limit, Margin, PlanEvaluation, Setup},
    rng::{Stream, stream},
    series::{Series, Track},
    task::{KeyPoint, Place, Task},
    threads,
    workflow::{
        carried::{
            Carried,
            plan_log::{Command, PlanLog, Planned},
            rest::PLAN_LEAD_S,
        },
        replan::samples::sampled,
    },
};

const TASK: &str = include_str!("../../../sample-logs/tasks/task-1.toml");

/// Arrivals at the key points of the paper, s.
const TIMES_S: [f64; 6] = [0.0, 7.744, 15.307, 22.863, 30.976, 38.72];

/// Commands of one call of the tests; with `HYDROTRACE_COMMANDS` so many.
fn count() -> u64 {
    std::env::var("HYDROTRACE_COMMANDS").ok().and_then(|count| count.parse().ok()).unwrap_or(12)
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

/// A model of each joint, to be varied.
fn machine(plan: &Series, rng: &mut ChaCha8Rng) -> Fit {
    let measured = answer(plan, rng);
    fit(&[Observation { sent: plan, measured: &measured, valve: &[] }]).unwrap()
}

/// Another machine.
fn varied(fit: &Fit, rng: &mut ChaCha8Rng) -> Fit {
    let mut fit = fit.clone();
    for joint in &mut fit.joints {
        joint.held_out_r2 = uniform(rng, -1.0, 1.0);
        let model = &mut joint.model;
        model.dead_time_s = uniform(rng, 0.0, 0.5);
        model.time_constant_s = uniform(rng, 0.01, 0.5);
        model.feed_forward = uniform(rng, 0.0, 1.3);
        model.position_gain_1_s = uniform(rng, 0.2, 4.0);
        model.integral_gain_1_s2 = uniform(rng, 0.0, 1.5);
        model.dead_band_rad_s = uniform(rng, 0.0, 0.05);
        model.asymmetry = uniform(rng, -0.4, 0.4);
    }
    fit
}

/// Poses within those of the paper's task, some with a rest; limits from half to twice the paper's arm's.
fn task(rng: &mut ChaCha8Rng) -> Task {
    let mut task = Task::parse(TASK).unwrap();
    let pose_of = |point: &KeyPoint| match &point.place {
        Place::Joints(angle_rad) => angle_rad.clone(),
        Place::Tool { .. } => Vec::new(),
    };
    let poses: Vec<Vec<f64>> = task.points.iter().map(pose_of).collect();
    let count = [2, 3, 4, 5].into_iter().find(|_| uniform(rng, 0.0, 1.0) < 0.3).unwrap_or(6);
    task.points = (0..count)
        .map(|k| {
            let between = |j: usize| {
                let all = || poses.iter().map(|pose| pose[j]);
                let (low, high) =
                    (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
                (low, high)
            };
            let angle_rad = (0..task.joints.len())
                .map(|j| {
                    let (low, high) = between(j);
                    uniform(rng, low, high)
                })
                .collect();
            let rests = k > 0 && k + 1 < count && uniform(rng, 0.0, 1.0) < 0.4;
            KeyPoint {
                name: format!("{k}"),
                place: Place::Joints(angle_rad),
                dwell_s: rests.then(|| uniform(rng, 0.5, 4.0)),
                payload_kg: None,
            }
        })
        .collect();
    for limits in &mut task.limits {
        limits.velocity_rad_s = limits.velocity_rad_s.map(|most| most * uniform(rng, 0.5, 2.0));
        limits.acceleration_rad_s2 *= uniform(rng, 0.5, 2.0);
        limits.jerk_rad_s3 *= uniform(rng, 0.5, 2.0);
        limits.rod_speed_m_s = uniform(rng, 0.05, 0.5);
    }
    task.tool_speed_m_s = uniform(rng, 0.3, 3.0);
    task.times_s = None;
    task
}

/// A task and times at which its plan keeps what a command has to keep, by a margin of up to a third or by next to nothing;
/// `None` where its poses are none for the arm.
fn planned(rng: &mut ChaCha8Rng) -> Option<(Setup, Vec<f64>)> {
    let setup = Setup::new(&task(rng), Arm::sample().unwrap()).ok()?;
    let mut interval_s: Vec<f64> = (0..setup.interval_count()).map(|_| uniform(rng, 1.0, 4.0)).collect();
    for _ in 0..14 {
        let times_s = setup.times_s(&interval_s);
        let keeps = keeps(&setup, &times_s)?;
        let by = match keeps {
            true if uniform(rng, 0.0, 1.0) < 0.5 => at_limit(&setup, &interval_s)?,
            true => uniform(rng, 1.002, 1.1),
            false => 1.15,
        };
        for interval in &mut interval_s {
            *interval = (by * *interval).min(20.0);
        }
        if keeps {
            return Some((setup.clone(), setup.times_s(&interval_s)));
        }
    }
    None
}

fn keeps(setup: &Setup, times_s: &[f64]) -> Option<bool> {
    let evaluation = PlanEvaluation::of(setup, times_s).ok()?;
    let loads = [Limit::Torque, Limit::RodForce];
    Some(evaluation.broken().iter().all(|margin| loads.contains(&margin.limit)))
}

/// How many times as long a plan is that keeps its limits by less than one in a million.
fn at_limit(setup: &Setup, interval_s: &[f64]) -> Option<f64> {
    let (mut least, mut most) = (0.5, 1.0);
    for _ in 0..20 {
        let by = 0.5 * (least + most);
        let times_s = setup.times_s(&interval_s.iter().map(|s| by * s).collect::<Vec<_>>());
        if keeps(setup, &times_s)? { most = by } else { least = by }
    }
    Some(most)
}

struct Case {
    setup: Setup,
    plan: Series,
    command: Commanded,
    /// The plan itself as a command.
    plain: Commanded,
    points_hz: f64,
}

/// One command of a random task, from up to three runs.
fn case(fit: &Fit, seed: u64) -> Case {
    let mut rng = stream(seed, Stream::SensorNoise);
    let (setup, times_s) = (0..50).find_map(|_| planned(&mut rng)).unwrap();
    let fit = varied(fit, &mut rng);
    let plan = sampled(&setup, &setup.motion(&times_s).unwrap()).unwrap();
    let mut runs = vec![(plan.clone(), answer(&plan, &mut rng))];
    let settings = Learning {
        gain: uniform(&mut rng, 0.1, 1.0),
        most_rad: seed.is_multiple_of(2).then(|| uniform(&mut rng, 0.0, 0.2)),
        ..Learning::default()
    };
    let motion = Some((setup.motion(&times_s).unwrap(), PLAN_LEAD_S));
    let subject = Subject::new(&plan, motion, Some(&setup));
    let points_hz = subject.points_hz;
    let made = |runs: &[(Series, Series)], settings: Learning| {
        let trials: Vec<Trial> = runs.iter().map(|(sent, measured)| Trial { sent, measured }).collect();
        commanded(&fit, &subject, &trials, settings).unwrap()
    };
    let mut command = made(&runs, settings);
    for _ in 0..seed % 3 {
        let sent = command.series.clone();
        let measured = answer(&sent, &mut rng);
        runs.push((sent, measured));
        command = made(&runs, settings);
    }
    let plain = made(&runs, Learning { gain: 0.0, ..settings });
    Case { setup, plan, command, plain, points_hz }
}

/// One broken law of a command, if there is one.
fn broken(seed: u64, Case { setup, plan, command, plain, points_hz }: &Case) -> Option<String> {
    let names = setup.joint_names();
    for (name, (track, acceleration)) in
        names.iter().zip(command.series.tracks.iter().zip(&command.acceleration_rad_s2))
    {
        let (own, speed) = (plan.track(name)?, track.velocity()?);
        if track.name() != name || track.len() != own.len() || acceleration.len() != own.len() {
            return Some(format!("{seed}: {name} has {} samples, its plan {}", track.len(), own.len()));
        }
        for k in [0, track.len() - 1] {
            if track.position()[k].to_bits() != own.position()[k].to_bits() {
                return Some(format!("{seed}: an end of {name} is moved"));
            }
            if speed[k].abs() > 1e-12 || acceleration[k].abs() > 1e-12 {
                return Some(format!("{seed}: an end of {name} moves"));
            }
        }
    }
    let margins = |of: &Commanded| checked(setup, &states(of).collect::<Vec<_>>(), *points_hz);
    let own = margins(plain);
    let over = |(how, margin): &&(Checked, Margin)| {
        let same = |(other, own): &&(Checked, Margin)| {
            (other, own.limit, own.joint) == (how, margin.limit, margin.joint)
        };
        let plain = own.iter().find(same).map_or(0.0, |(_, own)| own.share);
        margin.share > plain.max(1.0) + BETWEEN
    };
    if let Some(((how, every), margin)) = margins(command).iter().find(over) {
        return Some(format!("{seed}: {how:?} every {every}: {margin:?}"));
    }
    refused(plan, (command, *points_hz), &names).map(|rule| format!("{seed}: {rule}"))
}

fn states(of: &Commanded) -> impl Iterator<Item = Vec<State>> {
    of.series.tracks.iter().zip(&of.acceleration_rad_s2).map(|(track, acceleration)| {
        let speed = track.velocity().unwrap();
        (0..track.len())
            .map(|k| State {
                position: track.position()[k],
                velocity: speed[k],
                acceleration: acceleration[k],
            })
            .collect()
    })
}

/// Why a trajectory controller would refuse a command; its rules, with their source, are those of `cli::trajectory`.
fn refused(plan: &Series, (command, points_hz): (&Commanded, f64), names: &[String]) -> Option<&'static str> {
    let log = PlanLog {
        plan: Planned::Series(plan),
        command: Some(Command { series: &command.series, acceleration_rad_s2: &command.acceleration_rad_s2 }),
        arm: None,
        trajectory: None,
        carried: &Carried::default(),
        rate_hz: 100.0,
        points_hz,
    };
    let sent = log.to_send();
    let mut before_ns = -1;
    for point in sent.points() {
        if point.time_from_start_ns <= before_ns {
            return Some("times do not increase");
        }
        before_ns = point.time_from_start_ns;
        for values in [point.position_rad, point.velocity_rad_s, point.acceleration_rad_s2] {
            if values.len() != names.len() || values.iter().any(|value| !value.is_finite()) {
                return Some("a point lacks a number");
            }
        }
    }
    let at_end =
        sent.points().last()?.velocity_rad_s.iter().fold(0.0_f64, |most, speed| most.max(speed.abs()));
    (at_end > f64::from(f32::EPSILON)).then_some("it ends in motion")
}

#[test]
fn no_command_breaks_a_limit_a_rule_of_the_controller_or_the_end_of_its_plan() {
    let setup = Setup::new(&Task::parse(TASK).unwrap(), Arm::sample().unwrap()).unwrap();
    let plan = sampled(&setup, &setup.motion(&TIMES_S).unwrap()).unwrap();
    let fit = machine(&plan, &mut stream(0, Stream::SensorNoise));
    let of = |k: usize| {
        let seed = k as u64 + 1;
        let case = case(&fit, seed);
        (broken(seed, &case), [case.command.applied(), case.command.smaller.is_some()].map(usize::from))
    };
    let found: Vec<(Option<String>, [usize; 2])> = threads::numbered(usize::try_from(count()).unwrap(), of);
    let [corrected, smaller] = [0, 1].map(|k| found.iter().map(|(_, is)| is[k]).sum::<usize>());
    let broken: Vec<String> = found.into_iter().filter_map(|(broken, _)| broken).collect();
    println!(
        "{} commands, {corrected} of them no plain plan, {smaller} of a smaller step, {} break a law",
        count(),
        broken.len()
    );
    assert!(broken.is_empty(), "{broken:#?}");
    assert!(corrected as u64 > count() / 2, "{corrected}");
}
