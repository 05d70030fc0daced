//! Whether the machine changed between two runs: then what the older ones taught is no guide.

use std::collections::BTreeSet;

use super::history::History;
use crate::{
    fit::{Fit, JointFit, predict},
    series::{Series, Track},
    units::DEGREE_RAD,
};

/// Errors that differ by this factor, and by so much, rad, are those of two machines.
const CHANGED: f64 = 2.0;
const CHANGED_RAD: f64 = 0.1 * DEGREE_RAD;

/// So do those that differ by this factor where the same was sent once more and gave the same to a share.
const CHANGED_TWICE: f64 = 1.3;
const AGAIN: f64 = 0.1;

/// Commands that differ by less are the same whatever came of them, rad.
const SENT_AGAIN_RAD: f64 = 2e-4;

/// A mean peak above the best so far, and above what was expected, by this factor is looked at, and one above what nine runs of
/// ten should stay below by that factor.
const GROWN: f64 = 1.1;
const BROKEN: f64 = 2.0;

/// Fits the logs at these places; `None` if they cannot be fitted.
pub(super) type Fits<'a> = &'a mut dyn FnMut(&[usize]) -> Option<Fit>;

/// What tells of a change.
pub(super) enum Sign {
    /// The same was sent in an earlier run (by index); the runs from another one on are of the machine as it is now.
    Pair(usize, usize),
    /// The same was sent in an earlier run (by index), and more came than was promised: what is sent stays a guide, older runs do not.
    Drift(usize),
    /// A joint moved otherwise than the earlier runs have it: what they miss of it, root mean square, rad, what the new run
    /// misses of itself, and what they miss of the newest of them.
    Model { joint: String, missed_rad: f64, own_rad: f64, before_rad: f64 },
}

/// Runs of the machine as it was for a time, and the places of the logs that are of another one.
#[derive(Clone, Default)]
struct Era {
    runs: Vec<usize>,
    others: BTreeSet<usize>,
    /// How often the machine had changed, and by how much of mean peak error, rad.
    changes: usize,
    unsteady_rad: f64,
    /// How often it moved as before again, and by how much it had changed at most, rad.
    returns: usize,
    swings_rad: f64,
}

impl History {
    /// Leaves out the runs of another machine, if it changed: the places of all logs of that, and what is to be said.
    pub(super) fn without_another_machine(&mut self, fits: Fits) -> (BTreeSet<usize>, Option<String>) {
        let mut now = Era { runs: (0..self.runs.len().min(1)).collect(), ..Era::default() };
        let mut before: Vec<Era> = Vec::new();
        let (mut said, mut foreign) = (None, Vec::new());
        for run in 1..self.runs.len() {
            if let Some(k) = self.returned(&before, &now, run, fits) {
                let (returns, swings_rad) = (now.returns + 1, now.swings_rad.max(now.unsteady_rad));
                let mut eras = before.drain(k..).chain([now]).collect::<Vec<Era>>().into_iter();
                now = eras.next().unwrap_or_default();
                (now.returns, now.swings_rad) = (returns, swings_rad);
                // Once is an exception; more often it comes in two kinds, and will again.
                if returns > 1 {
                    (now.changes, now.unsteady_rad) = (2 * returns, swings_rad);
                }
                let passed: BTreeSet<usize> = eras.flat_map(|era| era.runs).collect();
                said = Some(self.said_of_return(run, &passed));
                now.runs.retain(|k| !passed.contains(k));
                now.others.extend(passed.iter().map(|k| self.places[*k]));
                now.runs.push(run);
                foreign.push(run);
                continue;
            }
            let Some(sign) = self.sign(&now.runs, run, fits) else {
                now.runs.push(run);
                continue;
            };
            if let Sign::Pair(before, _) = sign
                && self.was_exception(before, run)
            {
                let passed = BTreeSet::from([before]);
                said = Some(self.said_of_return(run, &passed));
                now.runs.retain(|k| *k != before);
                now.others.insert(self.places[before]);
                now.runs.push(run);
                continue;
            }
            said = Some(self.said(run, &sign));
            self.drifts = matches!(sign, Sign::Drift(_));
            let from = match sign {
                Sign::Pair(_, from) => from,
                Sign::Drift(_) | Sign::Model { .. } => run,
            };
            let mut next = Era {
                runs: now.runs.iter().copied().filter(|k| *k >= from).chain([run]).collect(),
                others: (0..self.places[from]).collect(),
                changes: (now.changes + usize::from(!self.drifts)).max(2 * now.returns),
                unsteady_rad: now
                    .unsteady_rad
                    .max(now.swings_rad)
                    .max(self.differed_rad(&now.runs, run, &sign)),
                returns: now.returns,
                swings_rad: now.swings_rad,
            };
            let passed = |place: &&usize| **place >= self.places[from];
            next.others.extend(now.others.iter().filter(passed));
            before.push(std::mem::replace(&mut now, next));
        }
        let stays = |k: usize| now.runs.contains(&k);
        (self.changes, self.unsteady_rad) = (now.changes, now.unsteady_rad);
        self.undone_rad = self.undone(&now.runs);
        self.foreign =
            (now.runs.iter().enumerate()).filter(|(_, run)| foreign.contains(*run)).map(|(k, _)| k).collect();
        retain(&mut self.runs, stays);
        retain(&mut self.series, stays);
        retain(&mut self.places, stays);
        retain(&mut self.corrections_rad, stays);
        (now.others, said)
    }

    /// The time before a change that a run is of again: what was sent then comes to the same, or, of the last one, its model has
    /// the run as well as its own and that of the runs since has not.
    fn returned(&self, before: &[Era], now: &Era, run: usize, fits: Fits) -> Option<usize> {
        let now_rad = self.peak_rad(run)?;
        let differed_rad = (now_rad - self.peak_rad(*now.runs.last()?)?).abs();
        // What makes up for a change is no sign of its end.
        let sent_again = |k: usize| self.sent_again(k, run, differed_rad);
        let agrees =
            |k: &usize| sent_again(*k) && self.apart(*k, run).is_some_and(|apart| apart < CHANGED_TWICE);
        let contradicts =
            |k: &usize| sent_again(*k) && self.apart(*k, run).is_some_and(|apart| apart >= CHANGED_TWICE);
        if now.runs.iter().any(agrees) {
            return None;
        }
        if let Some(k) = before.iter().rposition(|era| era.runs.iter().any(agrees)) {
            return Some(k);
        }
        let (last, era) = before.iter().enumerate().next_back()?;
        if era.runs.iter().any(contradicts) {
            return None;
        }
        let mut fitted = |runs: &[usize]| fits(&runs.iter().map(|k| self.places[*k]).collect::<Vec<_>>());
        let (older, newer, own) = (fitted(&era.runs)?, fitted(&now.runs)?, fitted(&[run])?);
        let newest = *era.runs.last()?;
        let of_joint = |track: &Track| {
            let name = track.name();
            let missed = |fit: &Fit, k: usize| missed_rad(fit.joint(name)?, self.series.get(k)?);
            let (older_rad, newer_rad) = (missed(&older, run)?, missed(&newer, run)?);
            let least_rad = missed(&own, run)?.max(missed(&older, newest)?);
            Some((exceeds(newer_rad, older_rad), exceeds(older_rad, least_rad)))
        };
        let found: Vec<(bool, bool)> = self.series[run].1.tracks.iter().filter_map(of_joint).collect();
        let back = found.iter().any(|(back, _)| *back) && found.iter().all(|(_, other)| !other);
        back.then_some(last)
    }

    /// Whether of two runs in which the same was sent the second came as was promised of the first, which broke that: what came in the
    /// first is no machine.
    fn was_exception(&self, before: usize, run: usize) -> bool {
        let most_rad = self.runs[before].promised.map(|promised| promised.mean_peak_margin_rad);
        let [first_rad, second_rad] = [before, run].map(|k| self.peak_rad(k));
        let kept = |rad: Option<f64>| rad.zip(most_rad).is_some_and(|(rad, most_rad)| rad <= most_rad);
        before + 1 == run && most_rad.is_some() && !kept(first_rad) && kept(second_rad)
    }

    fn peak_rad(&self, run: usize) -> Option<f64> {
        self.runs.get(run)?.mean_peak_rad
    }

    /// The mean peak of one of two runs by that of the other, at least 1; `None` where one has none.
    fn apart(&self, one: usize, other: usize) -> Option<f64> {
        self.peak_rad(one).zip(self.peak_rad(other)).map(|(a, b)| (a / b).max(b / a))
    }

    /// Whether the same was sent in two runs, and not something else by half of what their errors differ by: that may be why.
    fn sent_again(&self, one: usize, other: usize, differed_rad: f64) -> bool {
        self.same(one, other) && self.differ_by(one, other, f64::max(SENT_AGAIN_RAD, 0.5 * differed_rad))
    }

    /// By how much the mean peak of a run differs from what the run before the change had, rad.
    fn differed_rad(&self, runs: &[usize], run: usize, sign: &Sign) -> f64 {
        let before = match sign {
            Sign::Pair(before, _) | Sign::Drift(before) => self.peak_rad(*before),
            Sign::Model { .. } => runs.iter().filter_map(|k| self.peak_rad(*k)).reduce(f64::min),
        };
        self.peak_rad(run).zip(before).map_or(0.0, |(now, before)| (now - before).abs())
    }

    /// What tells that the machine changed before a run, since these.
    fn sign(&self, runs: &[usize], run: usize, fits: Fits) -> Option<Sign> {
        let now_rad = self.peak_rad(run)?;
        let same = |k: &usize| {
            let differs_rad = self.peak_rad(*k).map_or(0.0, |before_rad| (now_rad - before_rad).abs());
            self.sent_again(*k, run, differs_rad)
        };
        let differs = |k: &usize| {
            self.peak_rad(*k)
                .is_some_and(|before_rad| exceeds(before_rad, now_rad) || exceeds(now_rad, before_rad))
        };
        // What is kept and comes to more each time drifts, whatever a bound that grew with it says.
        let kept: Vec<(usize, f64)> =
            runs.iter().filter(|k| same(k)).filter_map(|k| Some((*k, self.peak_rad(*k)?))).collect();
        let least = (0..kept.len()).min_by(|a, b| kept[*a].1.total_cmp(&kept[*b].1));
        let since = least.map_or(&[][..], |least| &kept[least..]);
        if let [(before, least_rad), .., (_, last_rad)] = since {
            let grew = |rad: f64| rad > CHANGED_TWICE * least_rad && rad - least_rad > 0.5 * CHANGED_RAD;
            let rises = since.windows(2).all(|two| two[0].1 <= two[1].1)
                && now_rad > (1.0 + AGAIN) * last_rad
                && !exceeds(now_rad, *last_rad);
            if grew(now_rad) && grew(*last_rad) && rises {
                return Some(Sign::Drift(*before));
            }
        }
        if let Some(before) = runs.iter().rev().copied().find(|k| differs(k) && same(k)) {
            // Of what came between the two nobody knows.
            let from = runs.iter().copied().find(|k| *k > before).unwrap_or(run);
            return Some(Sign::Pair(before, from));
        }
        // Less of a difference is told by two runs that agree against one.
        let agrees = |k: &usize| self.apart(*k, run).is_none_or(|apart| apart < 1.0 + AGAIN) && same(k);
        let apart = |k: &usize| self.apart(*k, run).is_some_and(|apart| apart > CHANGED_TWICE) && same(k);
        if let Some(again) = runs.iter().rev().copied().find(agrees)
            && let Some(before) = runs.iter().rev().copied().find(|k| *k < again && apart(k))
        {
            return Some(Sign::Pair(before, again));
        }
        let promised = self.runs[run].promised;
        let promised_rad = promised.map(|promised| promised.mean_peak_margin_rad);
        let drifted =
            |k: &usize| self.peak_rad(*k).is_some_and(|rad| now_rad > CHANGED_TWICE * rad) && same(k);
        if promised_rad.is_some_and(|most_rad| now_rad > most_rad)
            && let Some(before) = runs.iter().rev().copied().find(drifted)
        {
            return Some(Sign::Drift(before));
        }
        let best_rad = runs.iter().filter_map(|k| self.peak_rad(*k)).reduce(f64::min)?;
        // A bound that was made wide by a promise that was not kept hides a change; its middle does not.
        let grown =
            now_rad > GROWN * best_rad.max(promised.map_or(best_rad, |promised| promised.mean_peak_rad));
        let broken = promised_rad.is_some_and(|promised_rad| now_rad > BROKEN * promised_rad);
        if !grown && !broken {
            return None;
        }
        if self.goes_on(runs, run, &mut *fits).is_some() {
            return None;
        }
        let (newest, place) = (*runs.last()?, |k: &usize| self.places[*k]);
        let older = fits(&runs.iter().map(place).collect::<Vec<_>>())?;
        let own = fits(&[place(&run)])?;
        let joint = |track: &Track| {
            let name = track.name();
            let own = own.joint(name).filter(|joint| joint.trusted())?;
            let older = older.joint(name)?;
            let missed = |fit: &JointFit, k: usize| missed_rad(fit, self.series.get(k)?);
            let (missed_rad, own_rad, before_rad) =
                (missed(older, run)?, missed(own, run)?, missed(older, newest)?);
            let sign = Sign::Model { joint: name.to_owned(), missed_rad, own_rad, before_rad };
            exceeds(missed_rad, own_rad.max(before_rad)).then_some((missed_rad, sign))
        };
        let all = self.series.get(run)?.1.tracks.iter().filter_map(joint);
        Some(all.max_by(|a, b| a.0.total_cmp(&b.0))?.1)
    }
}

/// Leaves those at places that stay.
fn retain<T>(all: &mut Vec<T>, stays: impl Fn(usize) -> bool) {
    let mut k = 0;
    all.retain(|_| {
        k += 1;
        stays(k - 1)
    });
}

/// Whether an error is of another machine than a smaller one.
fn exceeds(error_rad: f64, other_rad: f64) -> bool {
    error_rad - other_rad > CHANGED_RAD && error_rad > CHANGED * other_rad
}

/// Root mean square of what a model misses of a run, rad, without the fifth of it in which it misses most: what comes in one motion alone
/// is chance, and another machine is another throughout.
fn missed_rad(fit: &JointFit, (sent, measured): &(Series, Series)) -> Option<f64> {
    const PARTS: usize = 10;
    let (sent, measured) = (sent.track(&fit.name)?, measured.track(&fit.name)?);
    let response = predict(&fit.model, sent).ok()?;
    let square = |(t_s, position): (&f64, &f64)| (position - response.held_at(*t_s).position).powi(2);
    let squares: Vec<f64> = measured.t_s().iter().zip(measured.position()).map(square).collect();
    let part = squares.len().div_ceil(PARTS).max(1);
    let parts: Vec<f64> = squares.chunks(part).map(|part| part.iter().sum::<f64>()).collect();
    let worst = parts.windows(2).map(|two| two[0] + two[1]).fold(0.0, f64::max);
    let others = squares.len().saturating_sub(2 * part).max(1) as f64;
    Some(((parts.iter().sum::<f64>() - worst).max(0.0) / others).sqrt())
}

#[cfg(test)]
mod tests {
    use super::super::{
        decision::Decision,
        history::tests::{history, sent},
    };
    use crate::workflow::carried::Promise;

    #[test]
    fn a_machine_that_answers_the_same_otherwise_is_another_from_then_on() {
        let of = |sent_by: &[f64], peaks: &[f64]| {
            let mut history = history(peaks);
            history.series = sent_by.iter().map(|by| (sent(*by), sent(0.0))).collect();
            history.places = (0..peaks.len()).map(|k| 2 * k).collect();
            let (others, said) = history.without_another_machine(&mut |_| None);
            (others.len(), said.is_some(), history.runs.len())
        };
        assert_eq!(of(&[1.0, 1.2, 1.0], &[0.01, 0.04, 0.045]), (2, true, 2));
        assert_eq!(of(&[1.0, 1.2, 1.3, 1.3], &[0.01, 0.002, 0.001, 0.02]), (6, true, 1));
        assert_eq!(of(&[1.0, 1.2, 1.0], &[0.04, 0.01, 0.01]), (2, true, 2), "it was mended");
        assert_eq!(of(&[1.0, 1.2, 1.0], &[0.01, 0.04, 0.018]), (0, false, 3));
        assert_eq!(of(&[1.0, 1.2, 1.0, 1.0], &[0.01, 0.04, 0.018, 0.0175]), (4, true, 2), "and again");
        assert_eq!(of(&[1.0, 1.2, 1.3], &[0.01, 0.04, 0.09]), (0, false, 3), "other commands");
        assert_eq!(of(&[1.0, 1.2, 1.2, 1.2], &[0.04, 0.01, 0.05, 0.0102]), (1, true, 3), "for one run");
        assert_eq!(
            of(&[1.0, 1.0, 1.0, 1.0, 1.0], &[0.0114, 0.0113, 0.03, 0.03, 0.0054]),
            (8, true, 1),
            "another one yet"
        );
        assert_eq!(
            of(&[1.0; 7], &[0.01, 0.01, 0.03, 0.03, 0.09, 0.09, 0.0101]),
            (4, true, 3),
            "the first again"
        );
        assert_eq!(of(&[1.0, 1.2, 1.201], &[0.04, 0.002, 0.0014]), (0, false, 3), "what was gained was sent");
        // A valve that stuck once: the same command then keeps what was promised of it.
        let stuck = |again: f64| {
            let mut history = history(&[0.04, 0.02, 0.03, again]);
            history.series = [1.0, 1.1, 1.2, 1.2].iter().map(|by| (sent(*by), sent(0.0))).collect();
            history.places = (0..4).collect();
            history.runs[2].promised = Some(Promise::new([0.0012, 0.0015], None));
            let (others, _) = history.without_another_machine(&mut |_| None);
            (others.into_iter().collect::<Vec<_>>(), history.runs.len())
        };
        assert_eq!((stuck(0.0014), stuck(0.003)), ((vec![2], 3), (vec![0, 1, 2], 1)));
        // The oil warms: what is kept comes to more each time, and no older command is better for having been sent before.
        let kept = |promised_rad: f64, newest: f64| {
            let mut history = history(&[0.04, 0.0101, 0.01, 0.01, newest]);
            let by = [1.0, 1.2, 1.3, 1.4, 1.3];
            history.series = by.iter().map(|by| (sent(*by), sent(0.0))).collect();
            history.places = (0..5).collect();
            history.runs[4].promised = Some(Promise::new([0.01, promised_rad], None));
            let (others, _) = history.without_another_machine(&mut |_| None);
            (others.len(), history.drifts, history.anew(), history.trust(), history.decision())
        };
        assert_eq!(kept(0.012, 0.015), (4, true, false, 1.0, Decision::Send));
        let rises = |newest: f64| {
            let mut history = history(&[0.04, 0.01, 0.014, newest]);
            history.series = [1.0, 1.2, 1.2, 1.2].iter().map(|by| (sent(*by), sent(0.0))).collect();
            history.places = (0..4).collect();
            let (others, _) = history.without_another_machine(&mut |_| None);
            (others.len(), history.drifts)
        };
        assert_eq!(rises(0.021), (3, true), "to twice as much, run by run");
        assert_eq!(rises(0.0141), (2, false), "at once");
        let (first, drifts, _, _, decision) = kept(0.02, 0.015);
        assert!(first == 0 && !drifts && matches!(decision, Decision::Keep { run: 4, .. }), "{decision:?}");
    }
}
