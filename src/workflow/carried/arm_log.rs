//! The arm in a log, so that tools that know nothing of hydrotrace draw it: descriptions at the start, then
//! where its links are.

use std::io::Write;

use crate::{
    arm::{ArmError, Chain, GHOST, Pose, quaternion_xyzw},
    log::{LogWriter, Role, Transform, WriteError},
};

/// How often links are placed, a second; enough for the eye.
pub const RATE_HZ: i64 = 50;

/// One link and the one before it.
struct Step {
    parent: String,
    child: String,
    moves: bool,
}

/// Writes an arm beside the samples of its joints.
pub struct ArmLog<'a> {
    chain: &'a Chain,
    /// Index among the log's joints, by joint of the chain.
    order: Vec<usize>,
    steps: Vec<Step>,
    ghost: Option<Vec<Step>>,
    start_ns: i64,
    next_ns: i64,
}

impl<'a> ArmLog<'a> {
    /// Writes the descriptions and what stands still; `ghost` asks for a second arm where the plan wants the
    /// first. `None` of a log that lacks a joint of the arm.
    ///
    /// # Errors
    ///
    /// [`WriteError`], for one of names that no log can hold.
    pub fn begin<W: Write>(
        log: &mut LogWriter<W>,
        chain: &'a Chain,
        joints: &[&str],
        start_ns: i64,
        ghost: bool,
    ) -> Result<Option<Self>, WriteError> {
        let place = |name: &str| joints.iter().position(|joint| *joint == name);
        let order: Option<Vec<usize>> = chain.joints().iter().map(|joint| place(&joint.name)).collect();
        let Some(order) = order else { return Ok(None) };
        let unwritable =
            |error: ArmError| WriteError::Text { kind: "robot description", name: error.to_string() };
        log.description(Role::Measured, start_ns, &chain.description().map_err(unwritable)?)?;
        let own = steps(chain, "");
        let ghost = ghost.then(|| steps(chain, GHOST));
        if ghost.is_some() {
            log.description(Role::Planned, start_ns, &chain.ghost_description().map_err(unwritable)?)?;
        }
        let poses = chain.link_poses(&[]);
        let mut fixed = Vec::new();
        let root = chain.link_names().next().unwrap_or_default();
        let ghost_root = format!("{GHOST}{root}");
        if ghost.is_some() {
            fixed.push(transform(root, &ghost_root, &Pose::identity()));
        }
        for steps in std::iter::once(&own).chain(&ghost) {
            fixed.extend(placed(steps, &poses, false));
        }
        if !fixed.is_empty() {
            log.fixed_transforms(start_ns, &fixed)?;
        }
        Ok(Some(Self { chain, order, steps: own, ghost, start_ns, next_ns: start_ns }))
    }

    /// Places the links if that is due: the arm by what was measured, or by the plan where there is no
    /// measurement, and the ghost by the plan; angles, rad, in the order of the log's joints.
    ///
    /// # Errors
    ///
    /// [`WriteError`].
    pub fn sample<W: Write>(
        &mut self,
        log: &mut LogWriter<W>,
        stamp_ns: i64,
        planned_rad: &[f64],
        measured_rad: Option<&[f64]>,
    ) -> Result<(), WriteError> {
        if stamp_ns < self.next_ns {
            return Ok(());
        }
        let posture = |angles_rad: &[f64]| -> Option<Vec<Pose>> {
            let known = |&i: &usize| angles_rad.get(i).copied().filter(|q| q.is_finite());
            let position_rad: Option<Vec<f64>> = self.order.iter().map(known).collect();
            Some(self.chain.link_poses(&position_rad?))
        };
        let own = posture(measured_rad.unwrap_or(planned_rad));
        let ghost = self.ghost.as_ref().and_then(|steps| Some((steps, posture(planned_rad)?)));
        let mut moving = Vec::new();
        if let Some(poses) = &own {
            moving.extend(placed(&self.steps, poses, true));
        }
        if let Some((steps, poses)) = &ghost {
            moving.extend(placed(steps, poses, true));
        }
        if moving.is_empty() {
            return Ok(());
        }
        self.next_ns = stamp_ns - (stamp_ns - self.start_ns).rem_euclid(PERIOD_NS) + PERIOD_NS;
        log.transforms(stamp_ns, &moving)
    }
}

const PERIOD_NS: i64 = 1_000_000_000 / RATE_HZ;

fn steps(chain: &Chain, prefix: &str) -> Vec<Step> {
    let links: Vec<(&str, bool)> = chain.link_names().zip(chain.link_moves()).collect();
    let pairs = links.iter().zip(links.iter().skip(1));
    pairs
        .map(|((parent, _), (child, moves))| Step {
            parent: format!("{prefix}{parent}"),
            child: format!("{prefix}{child}"),
            moves: *moves,
        })
        .collect()
}

/// Transforms of the links that turn, or of those that do not, from the poses of all links.
fn placed<'s>(steps: &'s [Step], poses: &'s [Pose], moves: bool) -> impl Iterator<Item = Transform<'s>> {
    let pairs = poses.iter().zip(poses.iter().skip(1));
    let kind = steps.iter().zip(pairs).filter(move |(step, _)| step.moves == moves);
    kind.map(|(step, (before, after))| transform(&step.parent, &step.child, &before.inv_mul(after)))
}

fn transform<'s>(parent: &'s str, child: &'s str, pose: &Pose) -> Transform<'s> {
    let translation_m: [f64; 3] = pose.translation.vector.into();
    Transform {
        parent,
        child,
        translation_m: translation_m.map(rounded),
        rotation_xyzw: quaternion_xyzw(pose).map(rounded),
    }
}

/// To single precision: places are for the eye, and half the digits compress to half the log.
#[expect(clippy::cast_possible_truncation, reason = "that is the point")]
fn rounded(value: f64) -> f64 {
    f64::from(value as f32)
}
