//! A task under the limits that its machine has shown.

use serde::{Deserialize, Serialize};

use crate::{
    fit::{Estimated, Fit},
    plan::Setup,
    series::{JointKind, Series, Track},
    spline::{Motion, Quantity},
    task::Task,
};

/// Where a limit comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// The task's or the arm's own.
    Task,
    /// The lower end of a fitted limit's interval.
    Fitted,
    /// The largest value that the joint reached; nothing is known beyond it.
    Shown,
    /// What the last plan asked for, where that is more than the joint reached.
    Asked,
}

/// Limits of a joint in the search.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct HeldTo {
    /// The joint.
    pub joint: String,
    /// How it moves: of one that slides read m for rad; left out if it turns.
    #[serde(default, skip_serializing_if = "JointKind::turns")]
    pub kind: JointKind,
    /// Largest speed in the slower direction, rad/s; null for none.
    #[serde(with = "crate::document::unbounded")]
    #[cfg_attr(test, schemars(with = "Option<f64>"))]
    pub speed_rad_s: f64,
    /// Where it comes from.
    pub speed_origin: Origin,
    /// Lowest and highest speed, rad/s, where the two directions differ.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speeds_rad_s: Option<[f64; 2]>,
    /// Largest acceleration, rad/s²; null for none.
    #[serde(with = "crate::document::unbounded")]
    #[cfg_attr(test, schemars(with = "Option<f64>"))]
    pub acceleration_rad_s2: f64,
    /// Where it comes from.
    pub acceleration_origin: Origin,
}

/// The task with every joint's speed and acceleration held to what the fit says: of an identified
/// limit the lower end of its interval, of speed in each direction, of acceleration in the weaker one; of one that
/// never showed, what was reached or what the last plan asked for, whichever is more.
pub(super) fn held(task: &Task, setup: &Setup, fit: &Fit, last: Option<&Motion>) -> (Task, Vec<HeldTo>) {
    let mut held = task.clone();
    let mut joints = Vec::new();
    for (j, name) in setup.joint_names().into_iter().enumerate() {
        let Some(limits) =
            task.joints.iter().position(|own| *own == name).and_then(|own| held.limits.get_mut(own))
        else {
            continue;
        };
        let known = fit.joint(&name);
        let asked = |quantity| last.map(|motion| motion.extrema(j, quantity).peak().value.abs());
        let speeds = known.map(|joint| [joint.speed_limit_growing_rad_s, joint.speed_limit_shrinking_rad_s]);
        let [low, high] = limits.velocity_rad_s;
        let [up, down] = by_way([high, -low], speeds, asked(Quantity::Velocity));
        let (speed_rad_s, speed_origin) = if up.0 <= down.0 { up } else { down };
        let (acceleration_rad_s2, acceleration_origin) = tightest(
            limits.acceleration_rad_s2,
            known.map(|joint| {
                [joint.acceleration_limit_growing_rad_s2, joint.acceleration_limit_shrinking_rad_s2]
            }),
            asked(Quantity::Acceleration),
        );
        (limits.velocity_rad_s, limits.acceleration_rad_s2) = ([-down.0, up.0], acceleration_rad_s2);
        joints.push(HeldTo {
            joint: name,
            kind: setup.arm().chain.joints()[j].kind,
            speed_rad_s,
            speed_origin,
            speeds_rad_s: (up.0.max(down.0) > speed_rad_s).then_some([-down.0, up.0]),
            acceleration_rad_s2,
            acceleration_origin,
        });
    }
    (held, joints)
}

/// The speeds to hold to, growing and shrinking. In a direction whose limit never showed, a joint may be as fast as in the other
/// one, or as it was.
fn by_way(own: [f64; 2], fitted: Option<[Estimated; 2]>, asked: Option<f64>) -> [(f64, Origin); 2] {
    let identified = |found: &Estimated| found.interval.filter(|_| found.identified).map(|ends| ends[0]);
    let of = |way: usize| {
        let fitted = fitted.as_ref()?;
        let weaker = fitted.iter().filter_map(identified).reduce(f64::min)?;
        let shown = fitted[way].lower_bound.filter(|shown| *shown > weaker);
        let found = identified(&fitted[way]).map(|most| (most, Origin::Fitted));
        Some(found.or(shown.map(|most| (most, Origin::Shown))).unwrap_or((weaker, Origin::Fitted)))
    };
    [0, 1].map(|way| match of(way) {
        Some(found) if found.0 < own[way] => found,
        Some(_) => (own[way], Origin::Task),
        None => tightest(own[way], fitted, asked),
    })
}

/// The limit to hold to, of both directions.
fn tightest(own: f64, fitted: Option<[Estimated; 2]>, asked: Option<f64>) -> (f64, Origin) {
    let Some(fitted) = fitted else { return (own, Origin::Task) };
    let low = |found: &Estimated| found.interval.filter(|_| found.identified).map(|interval| interval[0]);
    let identified = fitted.iter().filter_map(low).reduce(f64::min);
    let reached = fitted.iter().filter_map(|found| found.lower_bound).reduce(f64::max);
    // A fitted limit below what was reached is wrong by that much.
    let (found, origin) = match (identified, reached, asked) {
        (Some(limit), ..) => (limit, Origin::Fitted),
        (None, reached, Some(asked)) if reached.is_none_or(|reached| asked > reached) => {
            (asked, Origin::Asked)
        }
        (None, Some(reached), _) => (reached, Origin::Shown),
        (None, None, _) => return (own, Origin::Task),
    };
    if found < own { (found, origin) } else { (own, Origin::Task) }
}

/// A new plan is beyond what was shown from this share of it on.
const BEYOND: f64 = 1.25;

/// Joints that a new plan moves one way faster than runs have shown them to go that way, where no limit is known; that of the other way
/// tells nothing of it.
pub(super) fn beyond_shown(fit: &Fit, [last, plan]: [&Series; 2]) -> Vec<String> {
    let of = |track: &Track| {
        let (joint, before) = (fit.joint(track.name())?, last.track(track.name())?);
        beyond([joint.speed_limit_growing_rad_s, joint.speed_limit_shrinking_rad_s], [before, track])
    };
    plan.tracks.iter().filter_map(of).collect()
}

fn beyond([growing, shrinking]: [Estimated; 2], [last, plan]: [&Track; 2]) -> Option<String> {
    let fastest = |track: &Track, way: f64| {
        let steps = track.t_s().windows(2).zip(track.position().windows(2));
        steps.map(|(t, q)| way * (q[1] - q[0]) / (t[1] - t[0])).fold(0.0, f64::max)
    };
    let (name, kind) = (plan.name(), plan.kind());
    [(1.0, growing), (-1.0, shrinking)].into_iter().find_map(|(way, limit)| {
        let shown = limit.lower_bound.filter(|_| !limit.identified)?.max(fastest(last, way));
        let asked = fastest(plan, way);
        (asked > BEYOND * shown).then(|| {
            format!(
                "the new plan moves {name} one way at up to {}/s, and the runs show {}/s that way: whether it makes more is not known, and what is \
                 promised does not hold where it does not",
                kind.says(asked),
                kind.says(shown)
            )
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bound(reached: f64) -> Estimated {
        Estimated { lower_bound: Some(reached), ..Estimated::default() }
    }

    fn found(low: f64, high: f64) -> Estimated {
        let value = Some((low * high).sqrt());
        Estimated { value, interval: Some([low, high]), identified: true, ..bound(0.5 * low) }
    }

    #[test]
    fn a_fitted_limit_holds_at_its_lower_end_in_the_weaker_direction_and_of_speed_in_its_own() {
        let both = Some([found(0.4, 0.6), found(0.3, 0.5)]);
        assert_eq!(tightest(1.0, both, Some(0.2)), (0.3, Origin::Fitted));
        assert_eq!(by_way([1.0; 2], both, Some(0.2)), [(0.4, Origin::Fitted), (0.3, Origin::Fitted)]);
        assert_eq!(by_way([0.35, 1.0], both, None), [(0.35, Origin::Task), (0.3, Origin::Fitted)]);
    }

    #[test]
    fn the_direction_without_a_limit_goes_as_fast_as_the_other_or_as_it_was_seen_to() {
        let one = |reached| Some([found(0.3, 0.5), bound(reached)]);
        assert_eq!(by_way([1.0; 2], one(0.2), Some(0.9)), [(0.3, Origin::Fitted); 2]);
        assert_eq!(by_way([1.0; 2], one(0.6), None), [(0.3, Origin::Fitted), (0.6, Origin::Shown)]);
        assert_eq!(
            by_way([f64::INFINITY; 2], Some([bound(0.2), bound(0.3)]), Some(0.35)),
            [(0.35, Origin::Asked); 2]
        );
        assert_eq!(by_way([f64::INFINITY; 2], None, None), [(f64::INFINITY, Origin::Task); 2]);
    }

    #[test]
    fn a_bound_holds_at_what_was_reached_or_asked_for_and_never_loosens_the_task() {
        assert_eq!(tightest(1.0, Some([bound(0.2), bound(0.3)]), Some(0.35)), (0.35, Origin::Asked));
        assert_eq!(tightest(1.0, Some([bound(0.2), bound(0.3)]), Some(0.25)), (0.3, Origin::Shown));
        assert_eq!(tightest(0.1, Some([bound(0.2), bound(0.3)]), None), (0.1, Origin::Task));
        assert_eq!(tightest(0.1, None, Some(0.05)), (0.1, Origin::Task));
    }

    #[test]
    fn a_plan_that_is_faster_one_way_than_was_shown_is_told_though_the_other_way_was_as_fast() {
        let moves = |up: f64, down: f64| {
            Track::sampled("a", 1000, |t: f64| up * t.min(5.0) - down * (t - 5.0).max(0.0))
        };
        let last = moves(0.1, 0.4);
        let told = |plan: Track| beyond([bound(0.1), bound(0.4)], [&last, &plan]);
        assert_eq!(told(moves(0.11, 0.4)), None);
        let one = told(moves(0.3, 0.4)).unwrap();
        assert!(
            one.contains("moves a one way at up to 17.19 deg/s") && one.contains("show 5.73 deg/s"),
            "{one}"
        );
    }
}
