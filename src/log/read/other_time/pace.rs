//! Finds a run that took another time than its plan throughout.

use super::both::{BEGUN, Both, LEFT, LESS_THAN_LAG, apart};
use crate::series::Track;

/// Durations by planned durations that machines keep.
const USUAL_PACE: [f64; 2] = [0.97, 1.03];

/// Says that the run took another time than its plan, if that explains what is left.
pub(super) fn another_pace(joints: &[Both], as_it_is: f64, left_by_lag: f64) -> Option<String> {
    let pace = Pace::of(joints)?;
    let usual = (USUAL_PACE[0]..=USUAL_PACE[1]).contains(&pace.ratio);
    let planned_s = |t_s: f64| pace.planned_s + (t_s - pace.measured_s) / pace.ratio;
    let left = apart(joints, |joint, t_s| joints[joint].planned.held_at(planned_s(t_s)).position);
    // The lag of a machine smears a short motion, which then seems to take longer.
    (!usual && left < LEFT[1] * as_it_is && left < LESS_THAN_LAG * left_by_lag).then(|| {
        format!(
            "the joints take {:.2} times as long as their plan: was the machine run at another speed (override)? Errors at \
             the same instant say little then, the distance to the path does",
            pace.ratio
        )
    })
}

/// Where a motion begins in plan and measurement, s, and how much longer the measured one takes.
struct Pace {
    planned_s: f64,
    measured_s: f64,
    ratio: f64,
}

impl Pace {
    /// Of the joint that moves most.
    fn of(joints: &[Both]) -> Option<Self> {
        let joint = joints.iter().max_by(|a, b| a.motion.total_cmp(&b.motion))?;
        let [planned, measured] = [motion_s(joint.planned)?, motion_s(joint.measured)?];
        let ratio = (measured[1] - measured[0]) / (planned[1] - planned[0]);
        ratio.is_finite().then_some(Self { planned_s: planned[0], measured_s: measured[0], ratio })
    }
}

/// When a joint has left where it begins, and when it is not yet where it ends, s.
fn motion_s(track: &Track) -> Option<[f64; 2]> {
    let (t_s, q) = (track.t_s(), track.position());
    let (lowest, highest) =
        q.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &q| (a.min(q), b.max(q)));
    let far = |from: f64, q: f64| (q - from).abs() > BEGUN * (highest - lowest);
    let first = q.iter().position(|x| far(q[0], *x))?;
    let last = q.iter().rposition(|x| far(q[q.len() - 1], *x))?;
    Some([t_s[first], t_s[last]])
}
