//! Finds a machine that was stopped while its plan went on.

use crate::{
    remark::{Code, Remarks},
    series::{JointKind, Series, Track},
    units::DEGREE_RAD,
};

/// A joint within this of where it ends stands: rad, and m.
const STANDS: [f64; 2] = [0.3 * DEGREE_RAD, 0.005];

/// Motion of machine and plan that is worth a remark: rad, and m.
const MOVES: [f64; 2] = [3.0 * DEGREE_RAD, 0.03];

/// For so long after a stop a plan may go on: machines lag, s.
const LAGS_S: f64 = 1.0;

/// Remarks a run in which all joints stand from some instant on, though the plan goes on, of one joint at least, for
/// longer and farther than machines lag.
pub(super) fn of_sides(planned: &Series, measured: &Series, remarks: &mut Remarks) {
    let both = |track| Some((track, measured.track(Track::name(track))?));
    let joints: Vec<(&Track, &Track)> = planned.tracks.iter().filter_map(both).collect();
    let Some(stood_s) = joints.iter().filter_map(|(_, came)| stands_from_s(came)).reduce(f64::max) else {
        return;
    };
    let moved =
        |(_, came): &(&Track, &Track)| travel(came, [f64::NEG_INFINITY, stood_s]) > least(came.kind(), MOVES);
    if !joints.iter().any(moved) {
        return;
    }
    let mut names = Vec::new();
    for (plan, came) in &joints {
        let end_s = came.t_s().last().copied().unwrap_or_default();
        if travel(plan, [stood_s + LAGS_S, end_s]) > least(plan.kind(), MOVES) {
            names.push(plan.name());
        }
    }
    if !names.is_empty() {
        let message = format!(
            "no joint moves after {stood_s:.2} s, though the plan of {} goes on: the machine was stopped (emergency stop, \
             fault, hold)",
            names.join(", ")
        );
        remarks.add(Code::Stopped, 1, message);
    }
}

fn least(kind: JointKind, of: [f64; 2]) -> f64 {
    match kind {
        JointKind::Turns => of[0],
        JointKind::Slides => of[1],
    }
}

/// When a joint is where it ends and stays there, s.
fn stands_from_s(track: &Track) -> Option<f64> {
    let end = track.position().last()?;
    let away = |q: &f64| (q - end).abs() > least(track.kind(), STANDS);
    let last = track.position().iter().rposition(away).map_or(0, |at| at + 1);
    track.t_s().get(last).copied()
}

/// Between lowest and highest position in a span of time.
fn travel(track: &Track, [from_s, to_s]: [f64; 2]) -> f64 {
    let at = |t_s: f64| track.t_s().partition_point(|t| *t < t_s);
    let [lowest, highest] =
        crate::math::range(track.position().get(at(from_s)..at(to_s)).unwrap_or_default().iter().copied());
    (highest - lowest).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said of a machine that follows, 0.2 s late, until it is stopped.
    fn said(stopped_s: f64, ends_s: f64) -> Vec<String> {
        let plan = |size: f64, t: f64| {
            size * (((t - 3.0) / 10.0).clamp(0.0, 1.0) - ((t - 15.0) / 5.0).clamp(0.0, 0.4))
        };
        let of = |ends_s: f64, came: &dyn Fn(f64) -> f64| {
            let t_s: Vec<f64> = (0..3000).map(|k| f64::from(k) * 0.01).filter(|t| *t < ends_s).collect();
            let track = |name: &str, size: f64| {
                let noise = |t: f64| 1e-4 * (1e3 * t).sin();
                let q = t_s.iter().map(|&t| plan(size, came(t)) + noise(t)).collect();
                Track::new(name, t_s.clone(), q, &[]).unwrap()
            };
            Series { tracks: vec![track("swing", 1.0), track("boom", -0.5)] }
        };
        let mut remarks = Remarks::default();
        of_sides(&of(30.0, &|t| t), &of(ends_s, &|t| t.min(stopped_s) - 0.2), &mut remarks);
        remarks.as_slice().iter().map(|remark| remark.message.clone()).collect()
    }

    #[test]
    fn a_machine_that_was_stopped_is_told_and_one_that_ended_is_not() {
        for stopped_s in [6.0, 15.5] {
            let found = said(stopped_s, 30.0);
            let one = found.first().map_or("", String::as_str);
            let at_s = one.trim_start_matches("no joint moves after ").split(' ').next().unwrap_or_default();
            let late_s = stopped_s - at_s.parse::<f64>().unwrap_or(f64::NAN);
            assert!(found.len() == 1 && late_s.abs() < 0.2, "{stopped_s}: {found:?}");
        }
        assert_eq!(said(f64::INFINITY, 30.0), Vec::<String>::new());
        assert_eq!(said(f64::INFINITY, 9.0), Vec::<String>::new(), "a log that ends early");
        assert_eq!(said(16.9, 30.0), Vec::<String>::new(), "almost at the end");
        assert_eq!(said(0.0, 30.0), Vec::<String>::new(), "it never moved");
    }
}
