//! Plans that stand at zero while there is none: controllers that show nothing else before a trajectory begins.

use crate::{
    remark::{Code, Remarks},
    series::{Series, Track},
};

/// A plan begins so far from zero at least, rad or m: from nearer no step is seen.
const LEAST: f64 = 0.02;
/// And so near the joint, by how far it is from zero.
const NEAR: f64 = 0.2;

/// Leaves out what is no plan: zeros at its beginning while the joint stands where it then begins, and, of such a plan,
/// those at its end.
pub(super) fn of_sides(sides: &mut [(&str, &mut Series); 2], remarks: &mut Remarks) {
    let [(_, planned), (_, measured)] = sides;
    let (mut count, mut names) = (0, Vec::new());
    for plan in &mut planned.tracks {
        let Some(joint) = measured.track(plan.name()) else { continue };
        let Some(part) = set(plan, joint) else { continue };
        count += plan.len() - part.len();
        names.push(plan.name().to_owned());
        *plan = part;
    }
    let message = format!(
        "samples in which the plan of {} stands at 0 while the joint stands where the plan then begins: no plan yet, or \
         no more, left out",
        names.join(", ")
    );
    remarks.add(Code::Implausible, count as u64, message);
}

/// The plan without them; `None` if it has none.
fn set(plan: &Track, joint: &Track) -> Option<Track> {
    let q = plan.position();
    let begins = q.iter().position(|position| *position != 0.0).filter(|begins| *begins > 0)?;
    // From the first sample on, and until the plan begins.
    let stands = |from: usize, to: usize, at: f64| {
        let [from_s, to_s] =
            [from, to].map(|i| plan.t_s()[i].clamp(joint.t_s()[0], joint.t_s()[joint.len() - 1]));
        let near = |t_s: f64| (joint.held_at(t_s).position - at).abs() <= NEAR * at.abs();
        at.abs() >= LEAST && near(from_s) && near(to_s)
    };
    if !stands(0, begins, q[begins]) {
        return None;
    }
    let last = q.iter().rposition(|position| *position != 0.0)?;
    let ended = last + 1 < q.len() && stands(last, q.len() - 1, q[last]);
    plan.part(begins..if ended { last + 1 } else { q.len() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(position: impl Fn(f64) -> f64) -> Track {
        Track::sampled("a", 500, position)
    }

    fn ramp(t_s: f64) -> f64 {
        0.5 + 0.2 * (t_s - 2.0).clamp(0.0, 1.0)
    }

    #[test]
    fn zeros_before_and_after_a_plan_are_none_and_a_set_value_that_steps_stays() {
        let left = |plan: &dyn Fn(f64) -> f64, joint: &dyn Fn(f64) -> f64| {
            let mut planned = Series { tracks: vec![track(plan)] };
            let mut remarks = Remarks::default();
            let mut measured = Series { tracks: vec![track(joint)] };
            of_sides(&mut [("", &mut planned), ("", &mut measured)], &mut remarks);
            (planned.tracks[0].len(), remarks.as_slice().len())
        };
        let joint = |t_s: f64| ramp(t_s - 0.1);
        assert_eq!(left(&|t| if t < 1.0 { 0.0 } else { ramp(t) }, &joint), (400, 1));
        assert_eq!(left(&|t| if (1.0..4.0).contains(&t) { ramp(t) } else { 0.0 }, &joint), (300, 1));
        // The joint is sent from 0 to .5 rad, or back, or fails to go.
        let late = |t_s: f64| if t_s < 1.2 { 0.0 } else { 0.5 };
        assert_eq!(left(&|t| if t < 1.0 { 0.0 } else { 0.5 }, &late), (500, 0));
        assert_eq!(left(&|t| if t > 3.0 { 0.0 } else { ramp(t) }, &joint), (500, 0));
        assert_eq!(left(&|_| 0.0, &|_| 0.5), (500, 0));
    }
}
