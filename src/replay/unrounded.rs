//! A rounded plan as it was before: between two of its values it passes the middle, and where it stands for long it rests.

use std::ops::Range;

/// A change below this share of a step is none.
pub(super) const NONE: f64 = 0.01;
/// A value that stays so many times as long as those beside it is a rest.
const RESTS: f64 = 3.0;

/// Where a plan goes from one value to the next.
struct Passes {
    t_s: f64,
    /// The value before it and after it.
    from: f64,
    to: f64,
}

/// Samples of a plan in steps, and so without: lines through the middles of its steps. All `[n]`; each segment by itself.
pub(super) fn unrounded(t_s: &[f64], position: &[f64], segments: &[Range<usize>], step: f64) -> Vec<f64> {
    let mut smooth = position.to_vec();
    for segment in segments {
        let passes = passes(t_s, position, segment, step);
        let knots = knots(&passes);
        let mut after = 0;
        for k in segment.clone() {
            while knots.get(after).is_some_and(|knot| knot.0 <= t_s[k]) {
                after += 1;
            }
            smooth[k] = match (after.checked_sub(1).and_then(|before| knots.get(before)), knots.get(after)) {
                (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (t_s[k] - a.0) / (b.0 - a.0),
                (Some(end), None) | (None, Some(end)) => end.1,
                (None, None) => position[k],
            };
        }
    }
    smooth
}

/// All changes of a segment, each of a step or more.
fn passes(t_s: &[f64], x: &[f64], segment: &Range<usize>, step: f64) -> Vec<Passes> {
    let mut found = Vec::new();
    let mut at = segment.start + 1;
    while at < segment.end {
        let change = |k: usize| x[k] - x[k - 1];
        if change(at).abs() <= NONE * step {
            at += 1;
            continue;
        }
        let from = at - 1;
        at = climbs_to(x, at, segment.end, step);
        found.push(Passes { t_s: 0.5 * (t_s[from] + t_s[at]), from: x[from], to: x[at] });
        at += 1;
    }
    found
}

/// The sample with which a step ends that begins with one: a plan of fewer samples than the measurement climbs it in several.
pub(super) fn climbs_to(x: &[f64], begins: usize, end: usize, step: f64) -> usize {
    let change = |k: usize| x[k] - x[k - 1];
    let goes_on = |k: usize| k < end && change(k) * change(begins) > 0.0 && change(k).abs() > NONE * step;
    let mut at = begins;
    while (x[at] - x[begins - 1]).abs() < (1.0 - NONE) * step && goes_on(at + 1) {
        at += 1;
    }
    at
}

/// The corners of the lines: a rest is left, and come to, as fast as the steps beside it go.
fn knots(passes: &[Passes]) -> Vec<(f64, f64)> {
    let alike = |a: &Passes, b: &Passes| (a.to - a.from) * (b.to - b.from) > 0.0;
    // The time that a step beside one takes, on its other side.
    let beside_s = |k: usize, other: Option<usize>| {
        let other = other.and_then(|other| Some((other, passes.get(other)?)));
        let other = other.filter(|(_, other)| alike(other, &passes[k]));
        other.map(|(_, other)| (other.t_s - passes[k].t_s).abs())
    };
    let mut knots: Vec<(f64, f64)> = Vec::new();
    for (k, own) in passes.iter().enumerate() {
        let (before, after) = (k.checked_sub(1), Some(k + 1));
        let gap_s = before.map(|before| own.t_s - passes[before].t_s);
        let next_s = beside_s(k, after);
        let last_s = before.and_then(|before| beside_s(before, before.checked_sub(1)));
        let turned = before.is_some_and(|before| !alike(&passes[before], own));
        let rests = |gap_s: f64| gap_s > RESTS * next_s.unwrap_or(0.0).max(last_s.unwrap_or(0.0));
        match gap_s {
            Some(gap_s) if !turned && !rests(gap_s) => {}
            Some(gap_s) => {
                let [left_s, come_s] = [last_s, next_s].map(|s| (0.5 * s.unwrap_or(0.0)).min(0.45 * gap_s));
                knots.extend([(own.t_s - gap_s + left_s, own.from), (own.t_s - come_s, own.from)]);
            }
            None => knots.push((own.t_s - 0.5 * next_s.unwrap_or(0.0), own.from)),
        }
        knots.push((own.t_s, 0.5 * (own.from + own.to)));
    }
    if let Some((k, last)) = passes.iter().enumerate().next_back() {
        let last_s = beside_s(k, k.checked_sub(1)).unwrap_or(0.0);
        knots.push((last.t_s + 0.5 * last_s, last.to));
    }
    knots.dedup_by(|b, a| b.0 <= a.0);
    knots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rounded_plan_is_what_it_was_to_a_fraction_of_a_step() {
        let plan = |t: f64| {
            let ease = |from: f64, lasts: f64| {
                let x = ((t - from) / lasts).clamp(0.0, 1.0);
                x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
            };
            2.0 * ease(1.0, 3.0) + 1.5 * ease(6.0, 2.0) - 3.0 * ease(9.0, 5.0)
        };
        for (step, dense) in [(0.0057, 1), (0.01, 1), (0.05, 1), (0.01, 5)] {
            let t_s: Vec<f64> = (0..1600).map(|k| 0.01 * f64::from(k)).collect();
            let of = |k: usize| (plan(t_s[k]) / step).round() * step;
            let rounded: Vec<f64> = (0..t_s.len())
                .map(|k| {
                    let (from, share) = (k / dense * dense, (k % dense) as f64 / dense as f64);
                    of(from) + share * (of((from + dense).min(t_s.len() - 1)) - of(from))
                })
                .collect();
            let smooth = unrounded(&t_s, &rounded, &[0..800, 800..1600], step);
            let slope = |x: &[f64], k: usize| (x[k + 4] - x[k - 4]) / 0.08;
            let exact: Vec<f64> = t_s.iter().map(|t| plan(*t)).collect();
            // About starts and stops: fast motion steps in every sample.
            let slow: Vec<usize> = (4..1590).filter(|k| slope(&exact, *k).abs() < 0.3).collect();
            let wrong = |x: &[f64]| {
                let squares = slow.iter().map(|k| (slope(x, *k) - slope(&exact, *k)).powi(2)).sum::<f64>();
                (squares / slow.len() as f64).sqrt()
            };
            let off = (0..1600).map(|k| (smooth[k] - exact[k]).abs()).fold(0.0, f64::max);
            assert!(off < 0.6 * step + 0.002, "{step} {dense}: {off}");
            assert!(
                wrong(&smooth) < if dense > 1 { 0.8 } else { 0.5 } * wrong(&rounded),
                "{step} {dense}: {} {}",
                wrong(&smooth),
                wrong(&rounded)
            );
        }
        assert_eq!(unrounded(&[0.0, 1.0, 2.0], &[1.0; 3], std::slice::from_ref(&(0..3)), 0.1), [1.0; 3]);
    }
}
