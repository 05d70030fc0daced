//! A plan that a command is made for: its samples, and their derivatives as exactly as they are known.

use crate::{
    fit::STEP_S,
    math::lowpass,
    plan::{POINTS_HZ, Setup},
    series::{Series, Track},
    spline::{Motion, Quantity, Samples},
};

/// Accelerations of samples are told below this, Hz.
const KNOWN_HZ: f64 = 2.0;

/// A plan and a motion are the same if their angles differ by no more, rad.
const SAME_RAD: f64 = 1e-6;

/// A plan with what is known of it.
pub(super) struct Subject<'a> {
    pub(super) plan: &'a Series,
    /// Its motion and when that starts, s.
    pub(super) motion: Option<(Motion, f64)>,
    pub(super) setup: Option<&'a Setup>,
    /// Points a second of a trajectory to send: what the plan needs, where its motion is known.
    pub(super) points_hz: f64,
}

impl<'a> Subject<'a> {
    pub(super) fn new(plan: &'a Series, motion: Option<(Motion, f64)>, setup: Option<&'a Setup>) -> Self {
        let known = motion.as_ref().zip(setup);
        let points_hz = known
            .map_or(POINTS_HZ[0], |((motion, starts_s), setup)| setup.points_hz_after(motion, *starts_s));
        Self { plan, motion, setup, points_hz }
    }

    /// Angle, speed, acceleration and jerk of each joint's plan every step, and whether they are those of its motion; otherwise
    /// they are smoothed differences.
    pub(super) fn derivatives(&self) -> (Vec<Vec<[f64; 4]>>, bool) {
        let exact: Option<Vec<Vec<[f64; 4]>>> =
            self.plan.tracks.iter().map(|track| self.by_motion(track)).collect();
        let Some(exact) = exact else {
            return (self.plan.tracks.iter().map(by_differences).collect(), false);
        };
        (exact, true)
    }

    /// `None` if the samples are not those of the motion.
    fn by_motion(&self, track: &Track) -> Option<Vec<[f64; 4]>> {
        let (motion, starts_s) = self.motion.as_ref()?;
        let joint = self.setup?.joint_names().iter().position(|name| name == track.name())?;
        let local_s: Vec<f64> = track.t_s().iter().map(|t_s| t_s - starts_s).collect();
        let mut samples = Samples::default();
        motion.sample(&local_s, Quantity::Jerk, &mut samples);
        let position = samples.of(Quantity::Position, joint);
        let same = track.position().iter().zip(position).all(|(a, b)| (a - b).abs() < SAME_RAD);
        let end_s = motion.duration_s();
        let state = |k: usize| {
            let inside = |quantity| {
                let within = (0.0..=end_s).contains(&local_s[k]);
                if within { samples.of(quantity, joint)[k] } else { 0.0 }
            };
            let speed = track.velocity().map_or_else(|| inside(Quantity::Velocity), |speed| speed[k]);
            [track.position()[k], speed, inside(Quantity::Acceleration), inside(Quantity::Jerk)]
        };
        same.then(|| (0..track.len()).map(state).collect())
    }
}

/// Angle, speed, acceleration and jerk by differences.
fn by_differences(track: &Track) -> Vec<[f64; 4]> {
    let (position, last) = (track.position(), track.len().saturating_sub(1));
    let slopes = |values: &[f64]| -> Vec<f64> {
        let slope = |k: usize| {
            let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
            (values[after] - values[before]) / ((after - before).max(1) as f64 * STEP_S)
        };
        (0..values.len()).map(slope).collect()
    };
    let speed = track.velocity().map_or_else(|| slopes(position), <[f64]>::to_vec);
    let mut smooth = speed.clone();
    lowpass(&mut smooth, KNOWN_HZ, STEP_S);
    let acceleration = slopes(&smooth);
    let jerk = slopes(&acceleration);
    (0..track.len()).map(|k| [position[k], speed[k], acceleration[k], jerk[k]]).collect()
}
