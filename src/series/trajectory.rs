//! Whole plans, as trajectory messages give them, sampled as the controller samples them.
//!
//! The ROS 2 joint trajectory controller interpolates between neighbouring points with a quintic
//! where both have velocity and acceleration, a cubic where both have velocity, a line otherwise;
//! starts from the state it is in; drops a running trajectory for a newer one; holds the last
//! point; and stops on an empty trajectory.

use super::{Series, Track};
use crate::math::{State, cubic, linear, quintic};

/// One point of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlannedPoint {
    /// When, s since the start of the log.
    pub t_s: f64,
    /// Position, in the joint's unit.
    pub position: f64,
    /// Velocity, if given.
    pub velocity: Option<f64>,
    /// Acceleration, if given with the velocity.
    pub acceleration: Option<f64>,
}

/// One trajectory: times strictly increase, everything is finite; no joint means "stop".
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedTrajectory {
    /// When it takes over, s since the start of the log; not after its first point.
    pub start_s: f64,
    /// Points by joint.
    pub joints: Vec<(String, Vec<PlannedPoint>)>,
}

/// How long before its start a plan is taken to hold its first angle, s: long enough for the
/// start to be seen as one.
const HOLD_BEFORE_S: f64 = 1.0;

/// The plan of every measured joint at its measured stamps, and how many trajectories were cut
/// short. `trajectories` in order of their start.
pub fn plan_tracks(trajectories: &[PlannedTrajectory], measured: &Series) -> (Series, u64) {
    let mut tracks = Vec::new();
    for track in &measured.tracks {
        let pieces = pieces(trajectories, track);
        let Some(first) = pieces.first() else { continue };
        let from_s = first.start_s - HOLD_BEFORE_S;
        let start = track.t_s().partition_point(|&t| t < from_s);
        let t_s = &track.t_s()[start..];
        let states: Vec<State> = t_s.iter().map(|&t| state_at(&pieces, t)).collect();
        let cuts: Vec<usize> = track
            .segments()
            .iter()
            .filter_map(|s| s.start.checked_sub(start))
            .filter(|&cut| cut > 0)
            .collect();
        // Where lines join the points, the slope of the one that begins there is no speed.
        let curves = pieces.iter().flat_map(|piece| &piece.knots).all(|knot| knot.has_velocity);
        let planned =
            Track::of(track.kind(), track.name(), t_s, states.iter().map(|s| s.position).collect(), &cuts);
        let speeds = || states.iter().map(|s| s.velocity).collect();
        tracks
            .extend(planned.and_then(|own| if curves { own.with_velocity(speeds()) } else { Ok(own) }).ok());
    }
    let replaced = trajectories
        .windows(2)
        .filter(|pair| {
            // Trajectories of other joints run on; one without joints stops all.
            let concerned =
                |name: &String| pair[1].joints.is_empty() || pair[1].joints.iter().any(|(n, _)| n == name);
            let joints = pair[0].joints.iter().filter(|(name, _)| concerned(name));
            let ends = joints.filter_map(|(_, points)| points.last().map(|p| p.t_s));
            ends.fold(f64::NEG_INFINITY, f64::max) > pair[1].start_s
        })
        .count() as u64;
    (Series { tracks }, replaced)
}

/// The part of one trajectory for one joint, from its start until the next one starts.
struct Piece {
    start_s: f64,
    knots: Vec<Knot>,
}

#[derive(Clone, Copy)]
struct Knot {
    t_s: f64,
    state: State,
    has_velocity: bool,
    has_acceleration: bool,
}

fn pieces(trajectories: &[PlannedTrajectory], measured: &Track) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::new();
    for trajectory in trajectories {
        let points = match trajectory.joints.iter().find(|(name, _)| name == measured.name()) {
            Some((_, points)) => points.as_slice(),
            None if trajectory.joints.is_empty() && !pieces.is_empty() => &[],
            None => continue,
        };
        let start_s = trajectory.start_s;
        let mut knots: Vec<Knot> = points
            .iter()
            .map(|p| Knot {
                t_s: p.t_s,
                state: State {
                    position: p.position,
                    velocity: p.velocity.unwrap_or(0.0),
                    acceleration: p.acceleration.unwrap_or(0.0),
                },
                has_velocity: p.velocity.is_some(),
                has_acceleration: p.velocity.is_some() && p.acceleration.is_some(),
            })
            .collect();
        if knots.first().is_none_or(|first| first.t_s > start_s) {
            let fallback =
                knots.first().map(|first| State { position: first.state.position, ..State::default() });
            let running = (!pieces.is_empty()).then(|| state_at(&pieces, start_s));
            let resting = measured.at(start_s).map(|s| State { position: s.position, ..State::default() });
            let Some(mut state) = running.or(resting).or(fallback) else { continue };
            if knots.is_empty() {
                state = State { position: state.position, ..State::default() };
            }
            knots.insert(0, Knot { t_s: start_s, state, has_velocity: true, has_acceleration: true });
        }
        pieces.push(Piece { start_s, knots });
    }
    pieces
}

/// The planned state; the first angle before the plan, the last one after it.
fn state_at(pieces: &[Piece], t_s: f64) -> State {
    let current = pieces.partition_point(|piece| piece.start_s <= t_s).saturating_sub(1);
    let hold = |knot: &Knot| State { position: knot.state.position, ..State::default() };
    let Some(piece) = pieces.get(current) else { return State::default() };
    let above = piece.knots.partition_point(|knot| knot.t_s <= t_s);
    match (above.checked_sub(1).map(|below| piece.knots[below]), piece.knots.get(above)) {
        (Some(a), Some(b)) => {
            let (span_s, at_s) = (b.t_s - a.t_s, t_s - a.t_s);
            if a.has_acceleration && b.has_acceleration {
                quintic(a.state, b.state, span_s, at_s)
            } else if a.has_velocity && b.has_velocity {
                cubic(a.state, b.state, span_s, at_s)
            } else {
                linear(a.state.position, b.state.position, span_s, at_s)
            }
        }
        (Some(last), None) if last.t_s < t_s => hold(&last),
        (Some(only), _) => only.state,
        (None, first) => first.map(hold).unwrap_or_default(),
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "exact by construction")]
mod tests {
    use super::*;

    fn measured() -> Series {
        let t_s: Vec<f64> = (0..=100).map(|k| f64::from(k) * 0.1).collect();
        Series { tracks: vec![Track::new("a", t_s, vec![0.25; 101], &[]).unwrap()] }
    }

    fn trajectory(start_s: f64, points: &[(f64, f64, Option<f64>)]) -> PlannedTrajectory {
        let points = points
            .iter()
            .map(|&(t_s, position, velocity)| PlannedPoint { t_s, position, velocity, acceleration: None })
            .collect();
        PlannedTrajectory { start_s, joints: vec![("a".into(), points)] }
    }

    fn plan_at(trajectories: &[PlannedTrajectory], t_s: f64) -> Option<State> {
        plan_tracks(trajectories, &measured()).0.tracks[0].at(t_s)
    }

    #[test]
    fn a_plan_starts_from_where_the_joint_is_and_holds_its_last_point() {
        let plan = [trajectory(2.0, &[(4.0, 1.25, Some(0.0))])];
        assert_eq!(plan_at(&plan, 0.5), None);
        assert_eq!(plan_at(&plan, 1.5).unwrap().position, 0.25);
        assert!((plan_at(&plan, 3.0).unwrap().position - 0.75).abs() < 1e-12);
        assert_eq!(plan_at(&plan, 9.0).unwrap(), State { position: 1.25, ..State::default() });
    }

    #[test]
    fn points_without_velocity_are_joined_by_lines() {
        let plan = [trajectory(2.0, &[(2.0, 0.0, None), (4.0, 1.0, None)])];
        assert!((plan_at(&plan, 2.5).unwrap().position - 0.25).abs() < 1e-12);
        let speeds =
            |plan: &[PlannedTrajectory]| plan_tracks(plan, &measured()).0.tracks[0].velocity().is_some();
        assert!(
            !speeds(&plan) && speeds(&[trajectory(2.0, &[(2.0, 0.0, Some(0.0)), (4.0, 1.0, Some(0.0))])])
        );
    }

    #[test]
    fn a_newer_plan_takes_over_from_the_running_one_and_an_empty_one_stops() {
        let plan = [
            trajectory(0.0, &[(0.0, 0.0, None), (4.0, 4.0, None)]),
            trajectory(2.0, &[(3.0, 0.0, None)]),
            PlannedTrajectory { start_s: 2.5, joints: vec![] },
        ];
        assert!((plan_at(&plan, 1.0).unwrap().position - 1.0).abs() < 1e-12);
        assert!((plan_at(&plan, 2.5).unwrap().position - 1.0).abs() < 1e-12);
        let stopped = plan_at(&plan, 3.5).unwrap();
        assert!((stopped.position - 1.0).abs() < 1e-12 && stopped.velocity.abs() < 1e-12);
        assert_eq!(plan_tracks(&plan, &measured()).1, 2);
    }
}
