//! The arm of a run and where its links are.

use std::path::{Path, PathBuf};

use nalgebra::{Vector2, Vector3};

use super::{ViewFailure, mesh::Places};
use crate::{
    arm::{Arm, Chain, Mesh, Pose, Shape},
    log::Recording,
    remark::Code,
    series::{Series, Track},
    workflow::carried::Carried,
};

/// How often an arm is placed, a second; enough for the eye.
const RATE_HZ: f64 = 50.0;
/// More instants of an arm than anybody looks at; a longer run is placed less often.
const MOST_INSTANTS: f64 = 90_000.0;

/// An arm and where its links are at some instants.
#[derive(Debug, Clone)]
pub struct MovingArm {
    /// Where the arm comes from.
    pub source: ArmOrigin,
    /// Names of its links, the base first.
    pub links: Vec<String>,
    /// Its shapes but for meshes.
    pub shapes: Vec<Shape>,
    /// Its meshes that are at hand, and their files.
    pub meshes: Vec<(Mesh, PathBuf)>,
    /// How far it may reach, m.
    pub reach_m: f64,
    /// By the plan.
    pub planned: Poses,
    /// By the measurement; without instants for a plan that was not run.
    pub measured: Poses,
}

/// Where the arm of a log comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ArmOrigin {
    /// The URDF that was given.
    File,
    /// The URDF in the log.
    Log,
    /// The task in the log.
    Task,
    /// The sample arm, whose joints have the names of those in the log.
    Sample,
}

impl MovingArm {
    /// The view point that shows the arm and its tool's path best; `None` without poses.
    ///
    /// From the side of the way that the tool is on, and a little from above.
    pub fn sight(&self) -> Option<Sight> {
        let all = || self.planned.poses.iter().chain(&self.measured.poses);
        let (mut least_m, mut most_m) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
        for pose in all().flatten() {
            (least_m, most_m) = (least_m.inf(&pose.translation.vector), most_m.sup(&pose.translation.vector));
        }
        let tools = || all().filter_map(|links| links.last());
        let tool_m =
            tools().map(|pose| pose.translation.vector).sum::<Vector3<f64>>() / tools().count() as f64;
        let to_m = 0.5 * (least_m + most_m);
        let distance_m = FAR * (most_m - least_m).norm().max(MARGIN * self.reach_m);
        let base_m = all().next()?.first()?.translation.vector;
        let out = (tool_m - base_m).xy().try_normalize(1e-6).unwrap_or(Vector2::x());
        let from = (0.35 * out + Vector2::new(out.y, -out.x)).normalize();
        let from_m = to_m + distance_m * Vector3::new(from.x, from.y, 0.3);
        from_m
            .iter()
            .chain(&to_m)
            .all(|v| v.is_finite())
            .then(|| Sight { from_m: from_m.into(), to_m: to_m.into() })
    }
}

/// Where to look from and to, m in the base's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// The eye.
    pub from_m: [f64; 3],
    /// The middle of the picture.
    pub to_m: [f64; 3],
}

/// Distance of the eye by the diagonal of the scene.
const FAR: f64 = 1.0;
/// Least diagonal of the scene by the arm's reach.
const MARGIN: f64 = 0.3;

/// Poses of all links in the base's frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Poses {
    /// Ascending, s since the start of the log.
    pub t_s: Vec<f64>,
    /// By instant and link.
    pub poses: Vec<Vec<Pose>>,
}

/// The arm of a log, by the given description with its file, else by the log; `None` if there is neither.
///
/// # Errors
///
/// [`ViewFailure`] if the description is of no arm of its joints.
pub(super) fn find(
    recording: &mut Recording,
    given: Option<(&Path, &str)>,
    packages: &[PathBuf],
) -> Result<Option<MovingArm>, ViewFailure> {
    let (arm, folder) = match given {
        Some((file, text)) => {
            let names: Vec<&str> = recording.planned.tracks.iter().map(Track::name).collect();
            let of_joints = Chain::of_joints(text, &file.display().to_string(), &names);
            let (chain, still) = of_joints.map_err(|source| ViewFailure::Arm {
                joints: names.iter().map(ToString::to_string).collect(),
                source,
            })?;
            (Some(FoundArm { origin: ArmOrigin::File, chain, still }), file.parent())
        }
        None => (found(recording), None),
    };
    // Packages are looked for around the folder, so it must have a place.
    let folder = folder.and_then(|folder| Path::new(".").join(folder).canonicalize().ok());
    Ok(arm.map(|arm| moving(arm, recording, Places { folder: folder.as_deref(), packages })))
}

struct FoundArm {
    origin: ArmOrigin,
    chain: Chain,
    /// Joints between base and tool that are not in the log.
    still: Vec<String>,
}

/// The first arm of joints in the log: that of the log, of its task, of the samples. Only of the log's own
/// may joints be missing.
fn found(recording: &Recording) -> Option<FoundArm> {
    let whole =
        |chain: &Chain| chain.joints().iter().all(|joint| recording.planned.track(&joint.name).is_some());
    let names: Vec<&str> = recording.planned.tracks.iter().map(Track::name).collect();
    let own = || {
        let (chain, still) =
            Chain::of_joints(recording.description.as_deref()?, "robot_description", &names).ok()?;
        Some(FoundArm { origin: ArmOrigin::Log, chain, still })
    };
    let tasks = || {
        let chain = Carried::of(recording).arm()?.ok()?.chain;
        whole(&chain).then_some(FoundArm { origin: ArmOrigin::Task, chain, still: Vec::new() })
    };
    let sample = || {
        let chain = Arm::sample().ok()?.chain;
        whole(&chain).then_some(FoundArm { origin: ArmOrigin::Sample, chain, still: Vec::new() })
    };
    own().or_else(tasks).or_else(sample)
}

fn moving(arm: FoundArm, recording: &mut Recording, places: Places<'_>) -> MovingArm {
    let FoundArm { origin, chain, still } = arm;
    let remarks = &mut recording.remarks;
    let count = still.len() as u64;
    let message = format!("joints of the arm are not in the log, drawn at zero: {}", still.join(", "));
    remarks.add(Code::Guessed, count, message);
    let (mut meshes, mut absent) = (Vec::new(), Vec::new());
    for mesh in chain.meshes() {
        match places.find(&mesh.uri) {
            Some(file) => meshes.push((mesh, file)),
            None => absent.push(mesh.uri),
        }
    }
    if let Some(first) = absent.first() {
        let message = format!(
            "meshes of the arm are not at hand, blocks stand in for them: {first} first; --urdf FILE, the \
             URDF beside its package or with AMENT_PREFIX_PATH set, finds them (no path is followed that a log names)"
        );
        remarks.add(Code::MissingFile, absent.len() as u64, message);
    }
    let drawn: Vec<Mesh> = meshes.iter().map(|(mesh, _)| mesh.clone()).collect();
    MovingArm {
        source: origin,
        links: chain.link_names().map(str::to_owned).collect(),
        shapes: chain.shapes(&drawn),
        meshes,
        reach_m: chain.reach_m(),
        planned: poses(&chain, &recording.planned),
        measured: poses(&chain, &recording.measured),
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
