//! Whether the machine changed between two runs: then what the older ones taught is no guide.

use super::history::{History, PastRun};
use crate::{
    fit::{Fit, JointFit, predict},
    series::{Series, Track},
    units::{DEGREE_RAD, Degrees},
};

/// Errors that differ by this factor, and by so much, rad, are those of two machines.
const CHANGED: f64 = 2.0;
const CHANGED_RAD: f64 = 0.1 * DEGREE_RAD;

/// So do those that differ by this factor where the same was sent once more and gave the same to a share.
const CHANGED_TWICE: f64 = 1.3;
const AGAIN: f64 = 0.1;

/// A mean peak above the best so far by this factor is looked at, and one above what nine runs of ten should stay below by
/// that factor.
const GROWN: f64 = 1.1;
const BROKEN: f64 = 2.0;

/// Fits the logs from one place to before another; `None` if they cannot be fitted.
pub(super) type Fits<'a> = &'a mut dyn FnMut(usize, usize) -> Option<Fit>;

/// What tells of a change.
enum Sign {
    /// The same was sent in an earlier run (by index); the runs from another one on are of the machine as it is now.
    Pair(usize, usize),
    /// A joint moved otherwise than the earlier runs have it: what they miss of it, root mean square, rad, what the new run
    /// misses of itself, and what they miss of the newest of them.
    Model { joint: String, missed_rad: f64, own_rad: f64, before_rad: f64 },
}

impl History {
    /// Leaves out the runs before the machine changed, if it did: the first log that is left, and what is to be said.
    pub(super) fn without_another_machine(&mut self, fits: Fits) -> (usize, Option<String>) {
        let mut first = 0;
        let mut said = None;
        for run in 1..self.runs.len() {
            if let Some(sign) = self.sign(first, run, fits) {
                said = Some(self.said(run, &sign));
                self.changes += 1;
                self.unsteady_rad = self.unsteady_rad.max(self.differed_rad(first, run, &sign));
                first = match sign {
                    Sign::Pair(_, from) => first.max(from),
                    Sign::Model { .. } => run,
                };
            }
        }
        if said.is_none() {
            return (0, None);
        }
        self.runs.drain(..first);
        self.series.drain(..first);
        self.places.drain(..first);
        self.corrections_rad.drain(..first.min(self.corrections_rad.len()));
        (self.places.first().copied().unwrap_or_default(), said)
    }

    /// By how much the mean peak of a run differs from what the run before the change had, rad.
    fn differed_rad(&self, first: usize, run: usize, sign: &Sign) -> f64 {
        let peak = |k: usize| self.runs.get(k).and_then(|run| run.mean_peak_rad);
        let before = match sign {
            Sign::Pair(before, _) => peak(*before),
            Sign::Model { .. } => (first..run).filter_map(peak).reduce(f64::min),
        };
        peak(run).zip(before).map_or(0.0, |(now, before)| (now - before).abs())
    }

    /// What tells that the machine changed before a run, since the first of these.
    fn sign(&self, first: usize, run: usize, fits: Fits) -> Option<Sign> {
        let peak = |k: usize| self.runs.get(k)?.mean_peak_rad;
        let now_rad = peak(run)?;
        let same = |k: &usize| self.same(*k, run);
        let differs = |k: &usize| {
            peak(*k).is_some_and(|before_rad| exceeds(before_rad, now_rad) || exceeds(now_rad, before_rad))
        };
        if let Some(before) = (first..run).rev().find(|k| differs(k) && same(k)) {
            // Of what came between the two nobody knows.
            return Some(Sign::Pair(before, before + 1));
        }
        // Less of a difference is told by two runs that agree against one.
        let apart =
            |k: &usize| peak(*k).map_or(0.0, |before_rad| (now_rad / before_rad).max(before_rad / now_rad));
        let agrees = |k: &usize| apart(k) < 1.0 + AGAIN && same(k);
        if let Some(again) = (first..run).rev().find(agrees)
            && let Some(before) = (first..again).rev().find(|k| apart(k) > CHANGED_TWICE && same(k))
        {
            return Some(Sign::Pair(before, again));
        }
        let best_rad = (first..run).filter_map(peak).reduce(f64::min)?;
        let promised_rad = self.runs[run].promised.map(|promised| promised.mean_peak_margin_rad);
        let grown = now_rad > GROWN * best_rad.max(promised_rad.unwrap_or(best_rad));
        let broken = promised_rad.is_some_and(|promised_rad| now_rad > BROKEN * promised_rad);
        if !grown && !broken {
            return None;
        }
        let place = |k: usize| self.places.get(k).copied();
        let older = fits(place(first)?, place(run)?)?;
        let own = fits(place(run)?, place(run)? + 1)?;
        let joint = |track: &Track| {
            let name = track.name();
            let own = own.joint(name).filter(|joint| joint.trusted())?;
            let older = older.joint(name)?;
            let missed = |fit: &JointFit, k: usize| missed_rad(fit, self.series.get(k)?);
            let (missed_rad, own_rad, before_rad) =
                (missed(older, run)?, missed(own, run)?, missed(older, run - 1)?);
            let sign = Sign::Model { joint: name.to_owned(), missed_rad, own_rad, before_rad };
            exceeds(missed_rad, own_rad.max(before_rad)).then_some((missed_rad, sign))
        };
        let all = self.series.get(run)?.1.tracks.iter().filter_map(joint);
        Some(all.max_by(|a, b| a.0.total_cmp(&b.0))?.1)
    }

    fn said(&self, run: usize, sign: &Sign) -> String {
        let of = |run: &PastRun| format!("{} in {}", Degrees(run.mean_peak_rad.unwrap_or_default()), run.log);
        let log = |k: usize| &self.runs[k].log;
        match sign {
            Sign::Pair(before, from) => format!(
                "the same was sent twice and gave a mean peak error of {}, then of {}: the machine has changed in between, and \
                 logs up to {} are left out",
                of(&self.runs[*before]),
                of(&self.runs[run]),
                log(from - 1)
            ),
            Sign::Model { joint, missed_rad, own_rad, before_rad } => format!(
                "{joint} moved otherwise in {} than runs before it have it: the model of those misses it by {} (root mean square), \
                 where it missed {} by {} and one of this run alone misses it by {}; the machine has changed, and logs up to {} \
                 are left out",
                log(run),
                Degrees(*missed_rad),
                log(run - 1),
                Degrees(*before_rad),
                Degrees(*own_rad),
                log(run - 1)
            ),
        }
    }
}

/// Whether an error is of another machine than a smaller one.
fn exceeds(error_rad: f64, other_rad: f64) -> bool {
    error_rad - other_rad > CHANGED_RAD && error_rad > CHANGED * other_rad
}

/// Root mean square of what a model misses of a run, rad.
fn missed_rad(fit: &JointFit, (sent, measured): &(Series, Series)) -> Option<f64> {
    let (sent, measured) = (sent.track(&fit.name)?, measured.track(&fit.name)?);
    let response = predict(&fit.model, sent).ok()?;
    let squares = measured.t_s().iter().zip(measured.position());
    let sum: f64 = squares.map(|(t_s, position)| (position - response.held_at(*t_s).position).powi(2)).sum();
    Some((sum / measured.len().max(1) as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::{super::history::tests::history, *};

    #[test]
    fn a_machine_that_answers_the_same_otherwise_is_another_from_then_on() {
        let sent = |by: f64| {
            let t_s: Vec<f64> = (0..100).map(|k| f64::from(k) * 0.01).collect();
            let q = t_s.iter().map(|t| by * t).collect();
            Series { tracks: vec![Track::new("J", t_s, q, &[]).unwrap()] }
        };
        let of = |sent_by: &[f64], peaks: &[f64]| {
            let mut history = history(peaks);
            history.series = sent_by.iter().map(|by| (sent(*by), sent(0.0))).collect();
            history.places = (0..peaks.len()).map(|k| 2 * k).collect();
            let (first, said) = history.without_another_machine(&mut |_, _| None);
            (first, said.is_some(), history.runs.len())
        };
        assert_eq!(of(&[1.0, 1.2, 1.0], &[0.01, 0.04, 0.045]), (2, true, 2));
        assert_eq!(of(&[1.0, 1.2, 1.3, 1.3], &[0.01, 0.002, 0.001, 0.02]), (6, true, 1));
        assert_eq!(of(&[1.0, 1.2, 1.0], &[0.04, 0.01, 0.01]), (2, true, 2), "it was mended");
        assert_eq!(of(&[1.0, 1.2, 1.0], &[0.01, 0.04, 0.018]), (0, false, 3));
        assert_eq!(of(&[1.0, 1.2, 1.0, 1.0], &[0.01, 0.04, 0.018, 0.0175]), (4, true, 2), "and again");
        assert_eq!(of(&[1.0, 1.2, 1.3], &[0.01, 0.04, 0.09]), (0, false, 3), "other commands");
    }
}
