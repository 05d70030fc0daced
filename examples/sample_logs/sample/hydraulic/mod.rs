//! Logs of the simulated hydraulic arm, made as `hydrotrace plan --times` and `simulate` make them.

mod readme;

use std::{error::Error, path::Path};

use hydrotrace::{
    arm::Arm,
    fit::{Excitation, JointRoom, Learning, Observation, Trial, excite, fit, learn},
    log::WriteOptions,
    plan::PlanEvaluation,
    plant::{JointRecord, Parameters, Plant},
    series::{Series, Track},
    units::DEGREE_RAD,
    workflow::{
        carried::{
            Carried,
            plan_log::{PlanLog, Planned},
            rest::RUN_LEAD_S,
        },
        plan::{PlanDocument, PlanRequest},
        simulate::log::{Prepared, prepare},
        simulate::{Content, Inputs, Outputs, run},
    },
};

pub(super) use readme::{rows, sections};

/// The machine of all these logs.
const PRESET: &str = "default";

/// Samples of the plan a second.
const RATE_HZ: f64 = 100.0;

/// Steps in which the driver gives speeds, rad/s: a thousandth of a degree a second.
const SPEED_STEP_RAD_S: f64 = 1.0 / 65536.0;

/// Where the joints go from when they are tried one after another, degrees.
const HOME_DEG: [f64; 6] = [60.0, 110.0, -20.0, 10.0, 10.0, 10.0];

type Task = (&'static str, &'static [f64]);

/// The paper's tasks and times.
const TASK_1: Task =
    (include_str!("../../../../sample-logs/tasks/task-1.toml"), &[0.0, 7.744, 15.307, 22.863, 30.976, 38.72]);
const TASK_2: Task =
    (include_str!("../../../../sample-logs/tasks/task-2.toml"), &[0.0, 9.431, 19.334, 34.66, 39.14, 49.043]);
const SIMULATION: Task = (
    include_str!("../../../../sample-logs/tasks/simulation.toml"),
    &[0.0, 2.01, 3.77, 5.79, 6.53, 8.85, 10.48],
);

/// Name and content of a log.
type Title = (&'static str, &'static str);

const TASK_1_RUN: Title = (
    "task-1-run.mcap",
    "Task 1 of the paper at its times, sent as planned; with the task and the plan's document. For `report` and for making the next plan or command.",
);
const TASK_2_RUN: Title =
    ("task-2-run.mcap", "Task 2 in the same way: to be predicted from a fit to the other, or to fit both.");
const IDENTIFICATION_RUN: Title = (
    "identification-run.mcap",
    "Every joint in turn at 3 and at 60 deg/s to both sides, no task. Shows lag, dead band and speed limits; the smooth runs do not.",
);
const PRECOMPENSATED_RUN: Title = (
    "precompensated-run.mcap",
    "Task 1 again, the same plan, with a command pre-compensated by a fit to `task-1-run.mcap`. For comparing the two.",
);
const PRESSURES_RUN: Title = (
    "pressures-run.mcap",
    "The paper's seven key points in 10.48 s, with pressures, signals to the valves and spools at 100 Hz.",
);

/// A log of the arm and what the README says of it.
pub(super) struct PlantLog {
    pub(super) name: &'static str,
    pub(super) bytes: Vec<u8>,
    story: &'static str,
    seed: u64,
    outputs: Outputs,
}

/// All of them.
pub(super) fn logs(options: &WriteOptions) -> Result<Vec<PlantLog>, Box<dyn Error>> {
    let first = prepared(TASK_1, 11)?;
    let again = first.clone();
    let first = task_run(options, TASK_1_RUN, first, Content::Joints)?;
    let again = precompensated(options, again, &first)?;
    Ok(vec![
        first,
        task_run(options, TASK_2_RUN, prepared(TASK_2, 12)?, Content::Joints)?,
        identification(options)?,
        again,
        task_run(options, PRESSURES_RUN, prepared(SIMULATION, 15)?, Content::Everything)?,
    ])
}

/// A run of a task, by way of the log of its plan.
fn prepared((text, times_s): Task, seed: u64) -> Result<Prepared, Box<dyn Error>> {
    let request = PlanRequest::parse(Path::new("task.toml"), text.to_owned())?;
    let evaluation = PlanEvaluation::of(&request.setup, times_s)?;
    let joints = request.setup.joint_names();
    let document = PlanDocument::evaluated(&request.task.title, &joints, &evaluation, true);
    let motion = request.setup.motion(times_s)?;
    let plan = PlanLog {
        plan: Planned::Motion(&motion, &joints),
        command: None,
        arm: Some(&request.setup.arm().chain),
        trajectory: None,
        carried: &Carried::default().with_plan(&request.files, &document),
        rate_hz: RATE_HZ,
        points_hz: request.setup.points_hz(&motion),
    };
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("plan.mcap");
    std::fs::write(&path, plan.bytes()?)?;
    Ok(prepare(&path, Parameters::preset(PRESET)?, seed)?)
}

fn task_run(
    options: &WriteOptions,
    title: Title,
    prepared: Prepared,
    content: Content,
) -> Result<PlantLog, Box<dyn Error>> {
    let seed = prepared.inputs.seed;
    let run = prepared.run()?;
    written(options, title, seed, run.outputs, &run.prepared.carried, content)
}

fn identification(options: &WriteOptions) -> Result<PlantLog, Box<dyn Error>> {
    let joints: Vec<JointRoom> = Arm::sample()?
        .chain
        .joints()
        .iter()
        .zip(HOME_DEG)
        .map(|(joint, home_deg)| {
            let range_rad = [joint.limit.lower_rad, joint.limit.upper_rad];
            JointRoom::turning(&joint.name, home_deg * DEGREE_RAD, range_rad)
        })
        .collect();
    let plan = excite(&joints, &Excitation { rest_s: RUN_LEAD_S, ..Excitation::minimal() })?;
    let (plant, command, seed) = (Plant::preset(PRESET)?, plan.clone(), 13);
    let outputs = run(&Inputs { plant, plan, command, payload: Vec::new(), seed })?;
    written(
        options,
        IDENTIFICATION_RUN,
        seed,
        outputs,
        &Carried::default().with_starts_s(0.0),
        Content::Joints,
    )
}

/// The plan of a run again, with the command that a fit to the run makes of it.
fn precompensated(
    options: &WriteOptions,
    again: Prepared,
    before: &PlantLog,
) -> Result<PlantLog, Box<dyn Error>> {
    let record = &before.outputs.record;
    let track =
        |joint: &JointRecord| Track::new(&joint.name, record.t_s.clone(), joint.measured_rad.clone(), &[]);
    let measured = Series { tracks: record.joints.iter().map(track).collect::<Result<_, _>>()? };
    let plan = &again.inputs.plan;
    let fit = fit(&[Observation { sent: plan, measured: &measured, valve: &[] }])?;
    let trial = Trial { sent: plan, measured: &measured };
    let command = learn(&fit, plan, &[trial], Learning::default(), |_| None)?.command(plan, |_| 1.0)?;
    let seed = 14;
    let outputs = run(&Inputs { command, seed, ..again.inputs })?;
    written(options, PRECOMPENSATED_RUN, seed, outputs, &again.carried, Content::Joints)
}

/// Writes a run, small: numbers as `f32`.
fn written(
    options: &WriteOptions,
    (name, story): Title,
    seed: u64,
    mut outputs: Outputs,
    carried: &Carried,
    content: Content,
) -> Result<PlantLog, Box<dyn Error>> {
    let pairs = outputs.planned.iter_mut().chain(&mut outputs.command).flatten();
    pairs.for_each(|(angle, speed)| (*angle, *speed) = (short(*angle), short(*speed)));
    outputs.record.supply_pa.iter_mut().for_each(|x| *x = short(*x));
    for joint in &mut outputs.record.joints {
        let columns = [
            &mut joint.measured_rad, &mut joint.cap_pressure_pa, &mut joint.rod_pressure_pa,
            &mut joint.valve_command, &mut joint.spool,
        ];
        columns.into_iter().flatten().for_each(|x| *x = short(*x));
        joint.measured_rad_s.iter_mut().for_each(|x| *x = (*x / SPEED_STEP_RAD_S).round() * SPEED_STEP_RAD_S);
    }
    let bytes = outputs.log(carried, None, content, options.clone())?;
    Ok(PlantLog { name, bytes, story, seed, outputs })
}

/// The nearest number that has fewer digits.
#[expect(clippy::cast_possible_truncation, reason = "that is what it is for")]
fn short(x: f64) -> f64 {
    f64::from(x as f32)
}
