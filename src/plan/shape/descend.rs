//! The best curve near a curve: sequential quadratic programming in its control points and the logarithms of its
//! intervals.

use super::{
    aim::Aim,
    curve::{Curve, Frame},
    model::{Model, Peak, peaks},
    point::Point,
    step::{Multipliers, Step, Taken},
};

/// First, longest and shortest steps, in logarithms of intervals.
const FIRST: f64 = 0.2;
const LONGEST: f64 = 0.5;
const SHORT: f64 = 1e-5;
/// Parts of a step that are tried.
const PARTS: [f64; 5] = [1.0, 0.5, 0.25, 0.125, 0.0625];
/// Shares of the gain expected: below the first a step is refused, above the second the next may be longer.
const POOR: f64 = 0.1;
const GOOD: f64 = 0.6;
/// A step that gains less than this share of what was expected is corrected.
const CORRECT: f64 = 0.1;
/// So many gains in a row that are not worth going on for end a descent.
const SMALL: usize = 3;

/// Where a descent ended.
pub(super) struct Descended {
    pub(super) curve: Curve,
    pub(super) steps: usize,
}

/// Descends by at most so many steps, until they gain less than `enough`; `None` if the start is no motion.
pub(super) fn descend(
    frame: &Frame<'_>,
    start: Curve,
    aim: &Aim,
    (most, enough): (usize, f64),
) -> Option<Descended> {
    let mut here = Point::look(frame, start, aim)?;
    let (mut trust, mut multipliers, mut tried) = (FIRST, Multipliers::default(), Vec::new());
    let (mut steps, mut small) = (0, 0);
    while steps < most && small < SMALL && trust > SHORT {
        steps += 1;
        let mut near = peaks(frame, &here.motion);
        near.append(&mut tried);
        let model = Model::of(frame, &here, aim, &near);
        let step = Step::of(frame, (&here, aim, trust), &model, &multipliers);
        let taken = step.solve();
        let expected = here.broken() - taken.worth;
        if expected.is_nan() || expected < enough {
            break;
        }
        let mut found = best_part(frame, (&here, aim, expected), (&step, &taken), &mut tried);
        if found.as_ref().is_none_or(|found| found.gain < CORRECT * expected)
            && let Some(there) = step.moved(frame, &here, &taken, 1.0)
            && let Some(there) = Point::as_it_is(frame, there, aim)
        {
            let again = step.corrected(&taken, &Model::of(frame, &there, aim, &near));
            let corrected = best_part(frame, (&here, aim, expected), (&step, &again), &mut tried);
            let gain = |found: &Option<Found>| found.as_ref().map_or(f64::NEG_INFINITY, |found| found.gain);
            if gain(&corrected) > gain(&found) {
                found = corrected;
            }
        }
        if found.as_ref().is_none_or(|found| found.part < 0.3) {
            trust = taken.length.min(0.5 * trust);
        } else if found.as_ref().is_some_and(|found| found.gain > GOOD * expected) {
            trust = trust.max(2.0 * taken.length).min(LONGEST);
        }
        if let Some(found) = found {
            small = if found.gain < enough { small + 1 } else { 0 };
            tried.clear();
            multipliers = taken.multipliers;
            here = found.there;
        }
    }
    Some(Descended { curve: here.curve, steps })
}

struct Found {
    part: f64,
    gain: f64,
    there: Point,
}

/// The better of a step and its half, or the first smaller part that gains enough. Peaks of the curves tried are
/// noted: where all are refused, the next step has them as limits.
fn best_part(
    frame: &Frame<'_>,
    (here, aim, expected): (&Point, &Aim, f64),
    (step, taken): (&Step<'_>, &Taken),
    tried: &mut Vec<Peak>,
) -> Option<Found> {
    let mut best: Option<Found> = None;
    for (i, part) in PARTS.into_iter().enumerate() {
        if i > 1 && best.is_some() {
            break;
        }
        let moved = step.moved(frame, here, taken, part);
        let Some(there) = moved.and_then(|curve| Point::look(frame, curve, aim)) else { continue };
        tried.extend(peaks(frame, &there.motion));
        let gain = here.worth() - there.worth();
        let enough = gain > POOR * part * expected;
        if enough && best.as_ref().is_none_or(|best| gain > best.gain) {
            best = Some(Found { part, gain, there });
        }
    }
    best
}
