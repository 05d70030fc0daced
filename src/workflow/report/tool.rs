//! The arm of a run, and what it makes of the joints' errors at the tool.

use super::Inputs;
use crate::{
    arm::{ArmError, Kinematics},
    log::Recording,
    math::range,
    replay::{Rules, ToolPath, ToolReplay, pose_replay, tool_replay},
    series::{JointKind, Pair, PosePair},
    units::DEGREE_RAD,
    workflow::carried::Carried,
};

/// What is known of the tool.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Tool {
    /// The log holds no arm, and none was given.
    #[default]
    NoArm,
    /// There is an arm, whose tool cannot be placed.
    Unplaced(ArmError),
    /// The arm's joints are never known at one instant.
    Apart,
    /// It stays in one place, measured and planned, though joints move: its frame lies on their axes.
    OnAxes,
    /// The tool against its plan, and its way for plots.
    Placed(Box<ToolReplay>, ToolPath),
}

impl Tool {
    /// What was found at the tool.
    pub fn found(&self) -> Option<&ToolReplay> {
        match self {
            Self::Placed(found, _) => Some(found),
            _ => None,
        }
    }

    /// Why nothing is said of it although there is an arm.
    pub fn why_not(&self) -> Option<String> {
        match self {
            Self::Unplaced(why) => Some(why.to_string()),
            Self::Apart => Some("the joints of the arm share no instant".to_owned()),
            Self::OnAxes => Some(
                "its frame stays in one place though joints move, for it lies on their axes: --tool LINK, or --urdf with a link at the end of \
                 what they carry, tells it"
                    .to_owned(),
            ),
            Self::NoArm | Self::Placed(..) => None,
        }
    }

    /// The tool of a run whose log holds its poses.
    pub(super) fn of_poses(poses: &PosePair, rules: &Rules) -> Self {
        pose_replay(poses, rules).map_or(Self::Apart, |(found, path)| Self::Placed(Box::new(found), path))
    }

    /// The tool of a run whose joints are these pairs.
    pub(super) fn of(arm: Option<Result<Kinematics, ArmError>>, pairs: &[Pair], rules: &Rules) -> Self {
        match arm {
            None => Self::NoArm,
            Some(Err(why)) => Self::Unplaced(why),
            Some(Ok(arm)) => match tool_replay(&arm, pairs, rules) {
                None => Self::Apart,
                Some((_, path)) if stays(&path) && pairs.iter().any(moves) => Self::OnAxes,
                Some((found, path)) => Self::Placed(Box::new(found), path),
            },
        }
    }
}

/// A tool that goes no farther stays, m; a joint that goes farther moves, rad or m.
const STAYS_M: f64 = 1e-4;
const MOVES: f64 = DEGREE_RAD;

fn stays(path: &ToolPath) -> bool {
    (0..3).all(|axis| {
        let places = path.planned_m.iter().chain(&path.measured_m).map(|place| place[axis]);
        let [low, high] = range(places);
        high - low < STAYS_M
    })
}

fn moves(pair: &Pair) -> bool {
    let [low, high] = range(pair.planned.iter().chain(&pair.measured).copied());
    high - low > MOVES
}

/// What stands for the URDF of a log in errors.
const IN_LOG: &str = "the URDF in the log";

/// The arm that was given, else that of the log's task, else that of its URDF; `None` without any.
pub(super) fn arm(
    recording: &Recording,
    carried: &Carried,
    inputs: &Inputs,
    pairs: &[Pair],
) -> Option<Result<Kinematics, ArmError>> {
    let known: Vec<(&str, JointKind)> = pairs.iter().map(|pair| (pair.name.as_str(), pair.kind)).collect();
    let tool = inputs.tool.as_deref();
    let given = inputs.urdf.as_ref().map(|path| path.display().to_string());
    let described = recording
        .description
        .as_deref()
        .map(|text| Kinematics::from_urdf(text, given.as_deref().unwrap_or(IN_LOG), tool, &known));
    if let Some(tool) = tool.filter(|_| described.is_none()) {
        let (file, element, found) = ("the log".to_owned(), format!("link {tool:?}"), "no URDF".to_owned());
        return Some(Err(ArmError::Unexpected { file, element, found, expected: "one".to_owned() }));
    }
    if given.is_some() || tool.is_some() {
        return described;
    }
    // A task names its tool, which a URDF does not.
    let of_task =
        carried.task_arm().map(|arm| Kinematics::of(arm.chain, "the arm of the task in the log", &known));
    match of_task {
        Some(Ok(arm)) => Some(Ok(arm)),
        of_task => described.or(of_task),
    }
}
