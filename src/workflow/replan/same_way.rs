//! Plans that go the same way at other times: what a controller that was slowed or paused logs as its plan.

use crate::{
    log::Recording,
    series::{Series, SignalError, bridged, moving_s},
    units::DEGREE_RAD,
    workflow::{carried::rest::PLAN_LEAD_S, same_plan::cut},
};

/// Instants of a plan that are looked for on the way of the other.
const INSTANTS: usize = 400;

/// Plans whose joints all come so near, rad or m, go the same way.
const NEAR: f64 = 0.3 * DEGREE_RAD;

/// Motions whose lengths differ by less are of one time, s.
const ALIKE_S: f64 = 0.3;

/// What is to be said of runs of other plans where the newest one goes their way at other times.
pub(super) fn said(
    names: &[String],
    observed: &[Recording],
    others: &[String],
) -> Result<Option<String>, SignalError> {
    let Some((newest, run)) = names.last().zip(observed.last()) else { return Ok(None) };
    let mut found = Vec::new();
    for (name, other) in names.iter().zip(observed).filter(|(name, _)| others.contains(name)) {
        if let Some([lasts_s, other_s]) = at_other_times(&run.planned, &other.planned)? {
            found.push(format!("{name} ({other_s:.1} s)"));
            if found.len() == 1 {
                found.insert(0, format!("{lasts_s:.1} s"));
            }
        }
    }
    let Some((lasts, others)) = found.split_first() else { return Ok(None) };
    Ok(Some(format!(
        "the plan in {newest} goes the way of that in {} at other times, in {lasts}, as where an override or a pause held it back: what is \
         made is for the times of {newest}; leave that log out for those of the others",
        others.join(", ")
    )))
}

/// How long the motions of two plans last, s, if they go the same way, from rest to rest, in another time.
fn at_other_times(plan: &Series, other: &Series) -> Result<Option<[f64; 2]>, SignalError> {
    let [plan, other] = [&*bridged(plan)?, &*bridged(other)?];
    let (Some(moves_s), Some(other_s)) = (moving_s(plan), moving_s(other)) else { return Ok(None) };
    let lasts_s = [moves_s, other_s].map(|[from_s, to_s]| to_s - from_s);
    if (lasts_s[0] - lasts_s[1]).abs() < ALIKE_S || plan.tracks.len() != other.tracks.len() {
        return Ok(None);
    }
    let of =
        |series: &Series, [from_s, to_s]: [f64; 2]| cut(series, from_s - PLAN_LEAD_S, to_s + PLAN_LEAD_S);
    let sides = [of(plan, moves_s)?, of(other, other_s)?];
    Ok((goes_along(&sides[0], &sides[1]) && goes_along(&sides[1], &sides[0])).then_some(lasts_s))
}

/// Whether a plan passes every point of another one, in their order.
fn goes_along(plan: &Series, other: &Series) -> bool {
    let Some(sides) =
        other.tracks.iter().map(|track| Some([track, plan.track(track.name())?])).collect::<Option<Vec<_>>>()
    else {
        return false;
    };
    let [count, own] = [0, 1].map(|side| sides.first().map_or(0, |pair| pair[side].len()));
    let apart = |at: usize, own_at: usize| {
        let each = sides.iter().map(|[track, own]| (track.position()[at] - own.position()[own_at]).abs());
        each.fold(0.0, f64::max)
    };
    let mut now = 0;
    (0..count).step_by(count.div_ceil(INSTANTS).max(1)).all(|at| {
        let from = (now..own).find(|k| apart(at, *k) < NEAR);
        now = from.unwrap_or(own);
        from.is_some()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{math::smooth_step as step, series::Track};

    #[test]
    fn a_plan_that_was_slowed_or_paused_goes_the_same_way_and_another_does_not() {
        let plan = |at_s: &dyn Fn(f64) -> f64, boom: f64| {
            let track = |name: &str, of: &dyn Fn(f64) -> f64| Track::sampled(name, 5000, |t| of(at_s(t)));
            let swing = track("swing", &|t| step((t - 4.0) / 8.0) - 0.6 * step((t - 20.0) / 6.0));
            Series { tracks: vec![swing, track("boom", &|t| boom * step((t - 6.0) / 9.0))] }
        };
        let first = plan(&|t| t, 0.5);
        let lasts_s = |other: &Series| at_other_times(&first, other).unwrap();
        assert_eq!(lasts_s(&first), None);
        let slowed = lasts_s(&plan(&|t| 4.0 + (t - 4.0) * 0.8, 0.5)).unwrap();
        assert!((slowed[1] / slowed[0] - 1.25).abs() < 0.03, "{slowed:?}");
        let paused = lasts_s(&plan(&|t| if t < 9.0 { t } else { 9.0 + (t - 14.0).max(0.0) }, 0.5)).unwrap();
        assert!((paused[1] - paused[0] - 5.0).abs() < 0.2, "{paused:?}");
        assert_eq!(lasts_s(&plan(&|t| 4.0 + (t - 4.0) * 0.8, 0.6)), None, "another way");
    }
}
