//! The simulated arm: its tasks, its trials, its runs, and fits to them.

use hydrotrace::{
    arm::Arm,
    fit::{Excitation, Fit, JointRoom, Observation, excite, fit},
    plan::Setup,
    plant::{Parameters, PayloadChange, Plant, Record, simulate},
    series::{Pair, Series, Track, align},
    spline::{Degree, Dwell, Ends, KeyPoints, Motion, Quantity, Samples},
    task::{Place, Task},
    units::{DEGREE_RAD, degrees_from_radians},
};

/// Rest before and after a task, s.
pub(crate) const REST_S: f64 = 2.0;

/// The paper's tasks and times.
const TASKS: [(&str, &[f64]); 2] = [
    (include_str!("../../../sample-logs/tasks/task-1.toml"), &[0.0, 7.744, 15.307, 22.863, 30.976, 38.72]),
    (include_str!("../../../sample-logs/tasks/task-2.toml"), &[0.0, 9.431, 19.334, 34.66, 39.14, 49.043]),
];

/// Where the joints go from when they are tried one after another, degrees.
pub(crate) const HOME_DEG: [f64; 6] = [60.0, 110.0, -20.0, 10.0, 10.0, 10.0];

/// What is sent, and what is carried from when on.
pub(crate) struct Job {
    pub(crate) plan: Series,
    pub(crate) payload: Vec<PayloadChange>,
}

pub(crate) fn task(number: usize) -> Job {
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

pub(crate) fn excitation(excitation: &Excitation) -> Job {
    let joints: Vec<JointRoom> = HOME_DEG
        .iter()
        .enumerate()
        .map(|(j, home)| {
            let range_rad = [-30.0, 30.0].map(|by| (home + by) * DEGREE_RAD);
            JointRoom::turning(format!("J{}", j + 1), home * DEGREE_RAD, range_rad)
        })
        .collect();
    Job { plan: excite(&joints, excitation).unwrap(), payload: Vec::new() }
}

/// Runs a command on a machine.
pub(crate) fn run(plant: &Plant, command: &Series, job: &Job, seed: u64) -> Series {
    measured(&simulate(plant, command, &job.payload, seed).unwrap())
}

pub(crate) fn measured(record: &Record) -> Series {
    let track = |joint: &hydrotrace::plant::JointRecord| {
        Track::new(&joint.name, record.t_s.clone(), joint.measured_rad.clone(), &[]).unwrap()
    };
    Series { tracks: record.joints.iter().map(track).collect() }
}

/// A fit to what came of what was sent.
pub(crate) fn fitted(logs: &[(&Series, &Series)]) -> Fit {
    let logs: Vec<Observation> =
        logs.iter().map(|(sent, measured)| Observation { sent, measured, valve: &[] }).collect();
    fit(&logs).unwrap()
}

/// The joints of the sample arm amid their ranges, degrees.
pub(crate) const POSE_DEG: [f64; 6] = [60.0, 110.0, -20.0, 8.0, 8.0, 8.0];

/// The sample arm with a preset that a test changes.
pub(crate) fn plant(preset: &str, change: impl FnOnce(&mut Parameters)) -> Plant {
    let mut parameters = Parameters::preset(preset).unwrap();
    change(&mut parameters);
    Plant::new(&Arm::sample().unwrap(), parameters).unwrap()
}

/// Sensors and log that lose and add nothing.
pub(crate) fn ideal(parameters: &mut Parameters) {
    (parameters.cycle.jitter_s, parameters.cycle.loss) = (0.0, 0.0);
    for joint in &mut parameters.joints {
        (joint.encoder.noise_rad, joint.encoder.count_rad) = (0.0, 1e-9);
    }
}

/// A command at 100 Hz from angles and speeds, degrees and degrees a second, by joint and time.
pub(crate) fn command(duration_s: f64, state_deg: impl Fn(usize, f64) -> (f64, f64)) -> Series {
    let t_s: Vec<f64> = (0..=(duration_s * 100.0).round() as u32).map(|k| f64::from(k) * 0.01).collect();
    let track = |j: usize| {
        let (q, qd): (Vec<f64>, Vec<f64>) = t_s.iter().map(|&t| state_deg(j, t)).unzip();
        let radians = |values: Vec<f64>| values.iter().map(|x| x * DEGREE_RAD).collect::<Vec<f64>>();
        let track = Track::new(format!("J{}", j + 1), t_s.clone(), radians(q), &[]).unwrap();
        track.with_velocity(radians(qd)).unwrap()
    };
    Series { tracks: (0..6).map(track).collect() }
}

/// Plan and measurement, by joint.
pub(crate) fn pairs(plan: &Series, record: &Record) -> Vec<Pair> {
    let pair = |joint: &hydrotrace::plant::JointRecord| {
        let measured = Track::new(&joint.name, record.t_s.clone(), joint.measured_rad.clone(), &[]).unwrap();
        align(plan.track(&joint.name).unwrap(), &measured).unwrap()
    };
    record.joints.iter().map(pair).collect()
}

/// The motion of a task (0 or 1) at the paper's times, and what it carries from each key point on; `slower` stretches time.
pub(crate) fn paper_plan(task: usize, slower: f64) -> (Series, Vec<PayloadChange>) {
    let (text, t_s) = TASKS[task];
    let task = Task::parse(text).unwrap();
    let (mut angles, mut dwells, mut payload) = (Vec::new(), Vec::new(), Vec::new());
    for (point, key_point) in task.points.iter().enumerate() {
        let Place::Joints(position_rad) = &key_point.place else { panic!("no angles") };
        angles.extend_from_slice(position_rad);
        if let Some(length_s) = key_point.dwell_s {
            dwells.push(Dwell { point, length_s: slower * length_s });
        }
        if let Some(mass_kg) = key_point.payload_kg {
            payload.push(PayloadChange { at_s: REST_S + slower * t_s[point], mass_kg });
        }
    }
    let t_s: Vec<f64> = t_s.iter().map(|t| slower * t).collect();
    let points = KeyPoints::new(6, angles).unwrap();
    let motion = Motion::new(Degree::Sextic, points, &Ends::at_rest(6), &dwells, &t_s).unwrap();
    let duration_s = motion.duration_s();
    let mut samples = Samples::default();
    let whole_s = 2.0 * REST_S + duration_s;
    let at_s: Vec<f64> =
        (0..=(whole_s * 100.0).round() as u32).map(|k| f64::from(k) * 0.01 - REST_S).collect();
    motion.sample(&at_s, Quantity::Velocity, &mut samples);
    let plan = command(whole_s, |j, t| {
        let k = (t * 100.0).round() as usize;
        let moving = (0.0..=duration_s).contains(&at_s[k]);
        let of = |quantity| degrees_from_radians(samples.of(quantity, j)[k]);
        (of(Quantity::Position), if moving { of(Quantity::Velocity) } else { 0.0 })
    });
    (plan, payload)
}
