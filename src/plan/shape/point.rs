//! A curve with its values.

use super::{
    aim::{Aim, Pace},
    curve::{Curve, Frame},
    interior::PRICE,
};
use crate::{
    plan::mesh::Mesh,
    spline::Motion,
    task::{Objective, Objectives},
};

/// The factor of time of a segment that nothing bounds.
const LEAST_FACTOR: f64 = 1e-3;
/// A segment whose torques or forces have come this near to a limit is not taken faster.
const FORCED: f64 = 0.99;

/// A curve with its values.
pub(super) struct Point {
    pub(super) curve: Curve,
    pub(super) motion: Motion,
    /// State and loads at the Gauss nodes of every piece.
    pub(super) mesh: Mesh,
    pub(super) objectives: Objectives,
    /// Root mean square jerk by joint, rad/s³.
    pub(super) joint_jerk: Vec<f64>,
    /// Root mean square power by joint, W.
    pub(super) joint_power: Vec<f64>,
    /// Of the limit that is nearest to being broken: of angles and rates between all instants.
    share: f64,
    /// Logarithm of the ceiling that is broken most.
    beyond: f64,
    merit: f64,
}

impl Point {
    /// Takes a curve at the pace of the aim: at a duration that is given, or each of its segments as fast as the limits
    /// allow, or no faster than that within the ceiling on time; angles stay as they are. `None` if that is no motion.
    pub(super) fn look(frame: &Frame<'_>, mut curve: Curve, aim: &Aim) -> Option<Self> {
        let mut motion = frame.motion(&curve).ok()?;
        if !matches!(aim.pace, Pace::Within(_)) {
            let mut mesh = Mesh::new(frame.setup);
            mesh.integrate(frame.setup, &motion);
            for (index, [_, rates]) in frame.stretch(&motion).into_iter().enumerate() {
                let [forces, speeds] = mesh.largest(index).map(|share| aim.guard * share);
                let (first, last) = motion.segments()[index].ends();
                // Nothing bounds what does not move.
                let mut by = rates.max(speeds).max(LEAST_FACTOR);
                if aim.pace == Pace::Sought || forces > FORCED {
                    by = by.max(1.0);
                }
                for s in &mut curve.interval_s[first..last] {
                    *s *= by;
                }
            }
        }
        let most_s = match aim.pace {
            Pace::Within(within_s) => within_s,
            _ => aim.ceilings[Objective::Duration],
        } - frame.resting_s();
        let moving_s: f64 = curve.interval_s.iter().sum();
        if moving_s > most_s || matches!(aim.pace, Pace::Within(_)) {
            curve.interval_s.iter_mut().for_each(|s| *s *= most_s / moving_s);
        }
        frame.clamp(&mut curve.interval_s);
        motion.retime(&frame.times_s(&curve.interval_s)).ok()?;
        Self::of(frame, curve, motion, aim)
    }

    /// At the times that the curve has.
    pub(super) fn as_it_is(frame: &Frame<'_>, curve: Curve, aim: &Aim) -> Option<Self> {
        let motion = frame.motion(&curve).ok()?;
        Self::of(frame, curve, motion, aim)
    }

    fn of(frame: &Frame<'_>, curve: Curve, motion: Motion, aim: &Aim) -> Option<Self> {
        let mut mesh = Mesh::new(frame.setup);
        mesh.integrate(frame.setup, &motion);
        let mut joint_jerk = vec![0.0; frame.joints()];
        motion.rms_jerk(&mut joint_jerk);
        let duration_s = motion.duration_s();
        let joint_power: Vec<f64> = mesh.squared_power.iter().map(|sum| (sum / duration_s).sqrt()).collect();
        let objectives = Objectives::NONE
            .with(Objective::Duration, duration_s)
            .with(Objective::RmsJerk, joint_jerk.iter().sum())
            .with(Objective::RmsPower, joint_power.iter().sum());
        let mut share =
            frame.stretch(&motion).iter().flatten().fold(0.0, |most: f64, share| most.max(*share));
        for index in 0..motion.segments().len() {
            share = mesh.largest(index).into_iter().fold(share, |most, load| most.max(aim.guard * load));
        }
        let merit = aim.merit(&objectives);
        let beyond = aim.beyond(&objectives).fold(0.0, |most: f64, (_, beyond)| most.max(beyond));
        let known = merit.is_finite() && share.is_finite() && beyond.is_finite();
        known.then_some(Self {
            curve,
            motion,
            mesh,
            objectives,
            joint_jerk,
            joint_power,
            share,
            beyond,
            merit,
        })
    }

    pub(super) fn duration_s(&self) -> f64 {
        self.objectives[Objective::Duration]
    }

    /// The price of the most broken limit or ceiling.
    pub(super) fn broken(&self) -> f64 {
        PRICE * (self.share - 1.0).max(self.beyond).max(0.0)
    }

    /// Merit and penalty.
    pub(super) fn worth(&self) -> f64 {
        self.merit + self.broken()
    }
}
