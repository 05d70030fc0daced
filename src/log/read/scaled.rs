//! Finds joints whose measurement is off by a share of their angle wherever they rest: a gear, an encoder's lines, a lever.

use crate::{
    math::{Line, line, range},
    series::Track,
    units::DEGREE_RAD,
};

/// A plan that stays within this for so long rests, rad or m and s; the last part of a rest counts, s.
const STANDS: f64 = 1e-4;
const RESTS_S: f64 = 0.8;
const LAST_S: f64 = 0.3;
/// So many rests tell, at so many places, over such a range, rad or m.
const LEAST: usize = 5;
const PLACES: usize = 4;
const WIDE: [f64; 2] = [10.0 * DEGREE_RAD, 0.1];
/// The rests that are reached from either side, two at least, say the same within this share, and those of either half of the range:
/// dead bands, loads and stops do not.
const ALIKE: f64 = 0.4;
/// A share of the angle that is told, what it makes over the range, rad or m, and how much of the errors at rest it explains.
const SHARE: f64 = 0.008;
const COUNTS: [f64; 2] = [0.3 * DEGREE_RAD, 3e-3];
const EXPLAINS: f64 = 0.97;

/// A joint that goes less than this share of its plan is not on another scale: it does not move.
const HARDLY: f64 = 0.02;

/// A rest of a plan at another place than the one before.
#[derive(Clone, Copy)]
struct Rest {
    place: f64,
    /// From which side it was reached; 0 of the first.
    way: f64,
    /// What was measured in the mean of its last part, less the place.
    off: f64,
}

/// What is to be said of a joint whose errors at rest grow with its angle.
pub(super) fn scaled(planned: &Track, measured: &Track) -> Option<String> {
    let mut rests = rests(planned, measured);
    rests.sort_by(|a, b| a.place.total_cmp(&b.place));
    let [lowest, highest] = range(rests.iter().map(|rest| rest.place));
    let kind = usize::from(!planned.turns());
    let apart = |two: &&[Rest]| two[1].place - two[0].place > 0.05 * (highest - lowest);
    let places = 1 + rests.windows(2).filter(apart).count();
    if rests.len() < LEAST || places < PLACES || highest - lowest < WIDE[kind] {
        return None;
    }
    let Line { slope: share, square, left } = errors(&rests);
    let left: f64 = left.iter().map(|left| left * left).sum();
    let spread = share * share * square + left;
    let agrees = |some: &[Rest]| (errors(some).slope / share - 1.0).abs() < ALIKE;
    let from = |way: f64| rests.iter().filter(|rest| way * rest.way > 0.0).copied().collect::<Vec<Rest>>();
    let (below, above) = (&rests[..=rests.len() / 2], &rests[rests.len() / 2..]);
    if ![&from(1.0), &from(-1.0), below, above].into_iter().all(agrees) {
        return None;
    }
    let counts = share.abs() >= SHARE && share.abs() * (highest - lowest) >= COUNTS[kind];
    (counts && left <= (1.0 - EXPLAINS) * spread).then(|| {
        if 1.0 + share < HARDLY {
            return format!(
                "{} does not move, or its sensor does not show it: from rest to rest it was measured {:.3} times as far as its plan ({} \
                 rests)",
                planned.name(),
                1.0 + share,
                rests.len()
            );
        }
        format!(
            "{} was measured {:.3} times as far as its plan from rest to rest ({} rests): is a gear, a lever or an encoder's scale off by \
             {:.1} %, or does its load hold it off? A fit takes that for a dead band, and a correction drives a joint off whose scale it is",
            planned.name(),
            1.0 + share,
            rests.len(),
            100.0 * share.abs()
        )
    })
}

/// The line of what is measured off over the place.
fn errors(rests: &[Rest]) -> Line {
    let of = |number: fn(&Rest) -> f64| rests.iter().map(number).collect::<Vec<f64>>();
    line(&of(|rest| rest.place), &of(|rest| rest.off))
}

fn rests(planned: &Track, measured: &Track) -> Vec<Rest> {
    let (t_s, q) = (planned.t_s(), planned.position());
    let (mut found, mut before, mut from) = (Vec::new(), None, 0);
    for k in 1..=q.len() {
        if q.get(k).is_some_and(|next| (next - q[from]).abs() <= STANDS) {
            continue;
        }
        let (place, last_s) = (q[from], t_s[k - 1]);
        let way = before.map_or(0.0, |before: f64| place - before);
        if last_s - t_s[from] >= RESTS_S && (before.is_none() || way.abs() > STANDS) {
            before = Some(place);
            let off = mean_within(measured, [last_s - LAST_S, last_s]).map(|came| came - place);
            found.extend(off.map(|off| Rest { place, way, off }));
        }
        from = k;
    }
    found
}

/// Mean of what was measured between two instants, s.
fn mean_within(measured: &Track, [from_s, to_s]: [f64; 2]) -> Option<f64> {
    let at = |end_s: f64| measured.t_s().partition_point(|t_s| *t_s < end_s);
    let came = measured.position().get(at(from_s)..at(to_s))?;
    (!came.is_empty()).then(|| came.iter().sum::<f64>() / came.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scale_is_told_and_a_dead_band_an_offset_and_few_rests_are_not() {
        let stops = [0.0, 0.5, 0.2, 0.9, 0.4, -0.3, 0.1];
        let plan = |t_s: f64| {
            let (at, part) = (t_s / 4.0, (t_s % 4.0 / 2.0 - 1.0).max(0.0));
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few stops")]
            let k = (at as usize).min(stops.len() - 1);
            stops[k] + (stops[(k + 1).min(stops.len() - 1)] - stops[k]) * part
        };
        let t_s: Vec<f64> = (0..2800).map(|k| f64::from(k) * 0.01).collect();
        let track = |until: usize, of: &dyn Fn(f64) -> f64| {
            let q = t_s[..until].iter().map(|t| of(*t)).collect();
            Track::new("boom", t_s[..until].to_vec(), q, &[]).unwrap()
        };
        let said = |until: usize, of: &dyn Fn(f64) -> f64| scaled(&track(until, &plan), &track(until, of));
        let far = said(2800, &|t| 1.02 * plan(t - 0.1) + 0.01).unwrap();
        assert!(far.contains("1.020 times as far") && far.contains("(7 rests)"), "{far}");
        let dead = said(2800, &|t| 1e-5 * (9.0 * t).sin()).unwrap();
        assert!(dead.starts_with("boom does not move") && !dead.contains("scale"), "{dead}");
        let band = |t: f64| plan(t) + 0.006 * f64::from(if (t / 4.0) % 2.0 < 1.0 { 1 } else { -1 });
        let of: [&dyn Fn(f64) -> f64; 3] = [&|t| plan(t) + 0.02, &band, &|t| 1.002 * plan(t)];
        assert!(of.iter().all(|of| said(2800, of).is_none()));
        assert!(said(1400, &|t| 1.02 * plan(t)).is_none(), "few rests");
    }
}
