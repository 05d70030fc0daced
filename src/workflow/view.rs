//! `view`: from the logs of runs to what is to be seen of them: arms that move, series, events, fronts.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use crate::{
    arm::{Chain, Pose, Shape},
    log::{LogError, ReadOptions, Recording, read_description, read_plan, read_recording},
    remark::Remarks,
    replay::{Rules, Transition, replay},
    series::{Pair, Series, align},
    task::Task,
};

use super::{
    plan::arm_of,
    plan_log::{FRONT, TASK},
};

/// How often an arm is placed, a second; enough for the eye.
const RATE_HZ: f64 = 50.0;
/// More instants of an arm than anybody looks at; a longer run is placed less often.
const MOST_INSTANTS: f64 = 90_000.0;

/// What to show.
#[derive(Debug, Clone, Default)]
pub struct Inputs {
    /// Runs or plans, each a file or a bag directory.
    pub logs: Vec<PathBuf>,
    /// What to read, where a log alone does not tell.
    pub read: ReadOptions,
    /// Thresholds of transitions.
    pub rules: Rules,
}

/// One run or plan.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Name of its log, distinct among those shown.
    pub name: String,
    /// The plan.
    pub planned: Series,
    /// The measurement; empty of a plan that nobody ran.
    pub measured: Series,
    /// Plan and measurement where both exist, by joint.
    pub pairs: Vec<Pair>,
    /// Starts and reversals with what came of them.
    pub transitions: Vec<Transition>,
    /// The arm, if there is one of these joints.
    pub arm: Option<MovingArm>,
    /// Plans to choose from, if the log holds them.
    pub front: Option<Front>,
    /// What was doubtful.
    pub remarks: Remarks,
}

/// An arm and where its links are at some instants.
#[derive(Debug, Clone)]
pub struct MovingArm {
    /// Where the arm comes from.
    pub source: ArmOrigin,
    /// Names of its links, the base first.
    pub links: Vec<String>,
    /// What is seen of it.
    pub shapes: Vec<Shape>,
    /// By the plan.
    pub planned: Poses,
    /// By the measurement; without instants of a plan that nobody ran.
    pub measured: Poses,
}

/// Where the arm of a log comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ArmOrigin {
    /// The URDF in the log.
    Log,
    /// The task in the log.
    Task,
    /// The sample arm, whose joints have the names of those in the log.
    Sample,
}

/// Poses of all links in the base's frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Poses {
    /// Ascending, s since the start of the log.
    pub t_s: Vec<f64>,
    /// By instant and link.
    pub poses: Vec<Vec<Pose>>,
}

/// Plans of which none is better than another in everything.
#[derive(Debug, Clone, PartialEq)]
pub struct Front {
    /// Duration, s, root mean square jerk, rad/s³, root mean square power, W; by plan.
    pub objectives: Vec<[f64; 3]>,
    /// The same of the plan that was chosen.
    pub chosen: Option<[f64; 3]>,
}

/// Reads and places everything that is to be seen.
///
/// # Errors
///
/// [`LogError`] if a log cannot be read or holds no planned joints.
pub fn run(inputs: &Inputs) -> Result<Vec<Scene>, LogError> {
    let mut taken: BTreeMap<String, u32> = BTreeMap::new();
    let scenes = inputs.logs.iter().map(|path| {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let count = taken.entry(stem.clone()).or_default();
        *count += 1;
        let name = if *count == 1 { stem } else { format!("{stem}-{count}") };
        scene(path, name, inputs)
    });
    scenes.collect()
}

fn scene(path: &Path, name: String, inputs: &Inputs) -> Result<Scene, LogError> {
    let paths = [path.to_owned()];
    let recording = match read_recording(&paths, &inputs.read) {
        // A plan that nobody ran yet.
        Err(LogError::Missing { missing: "measured", .. }) => read_plan(&paths, &inputs.read)?,
        other => other?,
    };
    let joints = recording.planned.tracks.iter();
    let pairs: Vec<Pair> =
        joints.filter_map(|planned| align(planned, recording.measured.track(planned.name())?)).collect();
    let found = replay(&pairs, &inputs.rules);
    let arm = arm(&paths, path, &recording)?.map(|(source, chain)| moving(source, &chain, &recording));
    let front = recording.attachments.iter().find(|file| file.name == FRONT).and_then(|f| front(&f.data));
    let Recording { planned, measured, remarks, .. } = recording;
    Ok(Scene { name, planned, measured, pairs, transitions: found.transitions, arm, front, remarks })
}

/// The first arm whose joints are all in the log: that of the log, of its task, of the samples.
fn arm(
    paths: &[PathBuf],
    path: &Path,
    recording: &Recording,
) -> Result<Option<(ArmOrigin, Chain)>, LogError> {
    let fits =
        |chain: &Chain| chain.joints().iter().all(|joint| recording.planned.track(&joint.name).is_some());
    let described = read_description(paths)?;
    let own = || Chain::from_urdf(described.as_deref()?, "robot_description", None).ok().filter(fits);
    let tasks = || {
        let file = recording.attachments.iter().find(|file| file.name == TASK)?;
        let task = Task::parse(&String::from_utf8_lossy(&file.data)).ok()?;
        let arm = arm_of(&task, path.parent().unwrap_or(Path::new(""))).ok()?;
        Some(arm.chain).filter(fits)
    };
    let sample = || Some(crate::arm::Arm::sample().ok()?.chain).filter(fits);
    Ok(own()
        .map(|chain| (ArmOrigin::Log, chain))
        .or_else(|| tasks().map(|chain| (ArmOrigin::Task, chain)))
        .or_else(|| sample().map(|chain| (ArmOrigin::Sample, chain))))
}

fn moving(source: ArmOrigin, chain: &Chain, recording: &Recording) -> MovingArm {
    MovingArm {
        source,
        links: chain.link_names().map(str::to_owned).collect(),
        shapes: chain.shapes(),
        planned: poses(chain, &recording.planned),
        measured: poses(chain, &recording.measured),
    }
}

/// The arm at even instants at which all its joints are known.
fn poses(chain: &Chain, series: &Series) -> Poses {
    let tracks: Option<Vec<_>> = chain.joints().iter().map(|joint| series.track(&joint.name)).collect();
    let Some(tracks) = tracks else { return Poses::default() };
    let first_s = tracks.iter().filter_map(|t| t.t_s().first()).fold(f64::NEG_INFINITY, |a, b| a.max(*b));
    let last_s = tracks.iter().filter_map(|t| t.t_s().last()).fold(f64::INFINITY, |a, b| a.min(*b));
    let step_s = (1.0 / RATE_HZ).max((last_s - first_s) / MOST_INSTANTS);
    let mut found = Poses::default();
    let instants = (0_u32..).map(|k| first_s + f64::from(k) * step_s).take_while(|t_s| *t_s <= last_s);
    for t_s in instants {
        let states: Option<Vec<f64>> = tracks.iter().map(|t| Some(t.at(t_s)?.position)).collect();
        if let Some(position_rad) = states {
            found.t_s.push(t_s);
            found.poses.push(chain.link_poses(&position_rad));
        }
    }
    found
}

fn front(document: &[u8]) -> Option<Front> {
    let document: serde_json::Value = serde_json::from_slice(document).ok()?;
    let of = |plan: &serde_json::Value| -> Option<[f64; 3]> {
        let value = |key: &str| plan[key].as_f64();
        Some([value("duration_s")?, value("rms_jerk_rad_s3")?, value("rms_power_w")?])
    };
    let objectives: Vec<[f64; 3]> = document["front"].as_array()?.iter().filter_map(of).collect();
    let chosen = of(&document["chosen"]);
    (!objectives.is_empty() || chosen.is_some()).then_some(Front { objectives, chosen })
}
