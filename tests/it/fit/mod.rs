//! Fits to simulated machines, whose truth is known, and the commands made from them.

mod inversion;
mod matched;
mod recovery;

use hydrotrace::{
    arm::Arm,
    fit::{Excitation, Fit, JointRoom, Observation, excite, fit},
    plan::Setup,
    plant::{PayloadChange, Plant, Record, simulate},
    series::{Series, Track},
    spline::{Quantity, Samples},
    task::Task,
    units::DEGREE_RAD,
};

/// Rest before and after a task, s.
const REST_S: f64 = 2.0;

/// The paper's tasks and times.
const TASKS: [(&str, &[f64]); 2] = [
    (include_str!("../../../sample-logs/tasks/task-1.toml"), &[0.0, 7.744, 15.307, 22.863, 30.976, 38.72]),
    (include_str!("../../../sample-logs/tasks/task-2.toml"), &[0.0, 9.431, 19.334, 34.66, 39.14, 49.043]),
];

/// Where the joints go from when they are tried one after another, degrees.
const HOME_DEG: [f64; 6] = [60.0, 110.0, -20.0, 10.0, 10.0, 10.0];

/// What is sent, and what is carried from when on.
struct Job {
    plan: Series,
    payload: Vec<PayloadChange>,
}

fn task(number: usize) -> Job {
    let (text, times_s) = TASKS[number - 1];
    let setup = Setup::new(&Task::parse(text).unwrap(), Arm::sample().unwrap()).unwrap();
    let motion = setup.motion(times_s).unwrap();
    let duration_s = motion.duration_s();
    let count = ((2.0 * REST_S + duration_s) * 100.0).round() as u32;
    let t_s: Vec<f64> = (0..=count).map(|k| f64::from(k) * 0.01).collect();
    let local_s: Vec<f64> = t_s.iter().map(|t| t - REST_S).collect();
    let mut samples = Samples::default();
    motion.sample(&local_s, Quantity::Velocity, &mut samples);
    let track = |(j, name): (usize, String)| {
        let moving = |(v, t): (&f64, &f64)| if (0.0..=duration_s).contains(t) { *v } else { 0.0 };
        let speed = samples.of(Quantity::Velocity, j).iter().zip(&local_s).map(moving).collect();
        let position = samples.of(Quantity::Position, j).to_vec();
        Track::new(name, t_s.clone(), position, &[]).unwrap().with_velocity(speed).unwrap()
    };
    let plan = Series { tracks: setup.joint_names().into_iter().enumerate().map(track).collect() };
    let mut payload = Vec::new();
    for (segment, &mass_kg) in motion.segments().iter().zip(setup.payload_kg()) {
        payload.push(PayloadChange { at_s: REST_S + segment.start_s, mass_kg });
    }
    Job { plan, payload }
}

fn excitation(excitation: &Excitation) -> Job {
    let joints: Vec<JointRoom> = HOME_DEG
        .iter()
        .enumerate()
        .map(|(j, home)| JointRoom {
            name: format!("J{}", j + 1),
            home_rad: home * DEGREE_RAD,
            range_rad: [(home - 30.0) * DEGREE_RAD, (home + 30.0) * DEGREE_RAD],
        })
        .collect();
    Job { plan: excite(&joints, excitation).unwrap(), payload: Vec::new() }
}

/// Runs a command on a machine.
fn run(plant: &Plant, command: &Series, job: &Job, seed: u64) -> Series {
    measured(&simulate(plant, command, &job.payload, seed).unwrap())
}

fn measured(record: &Record) -> Series {
    let track = |joint: &hydrotrace::plant::JointRecord| {
        Track::new(&joint.name, record.t_s.clone(), joint.measured_rad.clone(), &[]).unwrap()
    };
    Series { tracks: record.joints.iter().map(track).collect() }
}

/// A fit to what came of what was sent.
fn fitted(logs: &[(&Series, &Series)]) -> Fit {
    let logs: Vec<Observation> =
        logs.iter().map(|(sent, measured)| Observation { sent, measured, valve: &[] }).collect();
    fit(&logs).unwrap()
}
