//! A machine that goes on changing one way, as while its oil warms or a seal wears: each command is learnt from the run before, and the
//! next run leaves what the machine changed by since. What was sent before is worse each time.

use super::{
    changed::Fits,
    history::{History, WORTH},
};
use crate::{
    fit::{Fit, STEP_S, predict},
    math::lowpass,
};

/// What runs are off by agrees so far, and a model of those before explains so little of it, root mean square.
const AGREES: f64 = 0.7;
const MISSED: f64 = 0.5;

/// A run whose mean peak is more than this times that of the one before is of a machine that changed at once, or was spoilt.
const AT_ONCE: f64 = 2.0;

/// Share of the largest error by which a command differs that was learnt from it.
const TAUGHT: f64 = 0.3;

/// Errors are compared below this, Hz.
const COMPARED_HZ: f64 = 1.0;

/// Whether a joint is told of.
type Told<'a> = &'a dyn Fn(&str) -> bool;

impl History {
    /// Finds whether the machine goes on changing one way; what is to be said, if so.
    pub(super) fn follow(&mut self, fits: Fits) -> Option<String> {
        let newest = self.runs.len().checked_sub(1)?;
        let before = self.goes_on(&(0..newest).collect::<Vec<_>>(), newest, fits)?;
        self.follows = true;
        Some(format!(
            "what {} is off by is what {} was off by again, though it was corrected since, and the model of the runs before has none of \
             it: the machine goes on changing one way, and each command is a run late. The next one goes on from the newest run; what \
             was sent before would be worse again",
            self.runs[newest].log, self.runs[before].log
        ))
    }

    /// Whether a run, which was corrected by what the one before it taught, is off by the same again, though the model of the runs
    /// before says otherwise: that before. A limit that holds both is no change.
    pub(super) fn goes_on(&self, runs: &[usize], run: usize, fits: Fits) -> Option<usize> {
        let (before, others) = runs.split_last()?;
        let peak_rad = |k: usize| self.runs[k].mean_peak_rad;
        let (now_rad, before_rad) = (peak_rad(run)?, peak_rad(*before)?);
        let least_rad = runs.iter().filter_map(|k| peak_rad(*k)).reduce(f64::min)?;
        if !self.runs[run].corrected
            || !self.taught(*before, run)
            || now_rad < WORTH * least_rad
            || now_rad > AT_ONCE * before_rad
        {
            return None;
        }
        // As far back as corrections were made.
        let earlier = others.last().filter(|k| self.taught(**k, *before));
        // What it was promised to leave is no sign of another machine.
        if earlier.is_none() && self.kept_promise(*before) {
            return None;
        }
        let (now, then) = (self.off_rad(run, &|_| true), self.off_rad(*before, &|_| true));
        if correlation(&now, &then) < AGREES
            || earlier.is_some_and(|k| correlation(&then, &self.off_rad(*k, &|_| true)) < AGREES)
        {
            return None;
        }
        let older = fits(&runs.iter().map(|k| self.places[*k]).collect::<Vec<_>>())?;
        // Of a joint without a model that holds, or with a limit that joints share, it says nothing that a run could gainsay.
        let shares = |name: &str| {
            older.shared.iter().flat_map(|shared| &shared.joints).any(|joint| joint.name == name)
        };
        let holds = |name: &str| older.joint(name).is_some_and(|joint| joint.trusted() && joint.model_holds);
        let told = |name: &str| holds(name) && !shares(name);
        let (now, missed) = (self.off_rad(run, &told), self.missed(&older, run, &told));
        let share = square(&missed).sqrt() / square(&now).sqrt();
        (correlation(&missed, &now) >= AGREES && share >= MISSED).then_some(*before)
    }

    fn kept_promise(&self, run: usize) -> bool {
        let run = &self.runs[run];
        run.promised
            .zip(run.mean_peak_rad)
            .is_some_and(|(promised, rad)| rad <= promised.mean_peak_margin_rad)
    }

    /// Whether the next run was sent what a corrected one had taught.
    fn taught(&self, run: usize, next: usize) -> bool {
        let most_rad = self.off_rad(run, &|_| true).iter().fold(0.0_f64, |most, off| most.max(off.abs()));
        self.runs[run].corrected && !self.differ_by(run, next, TAUGHT * most_rad)
    }

    /// Planned less measured angles of joints, one after the other, without what is fast, rad.
    fn off_rad(&self, run: usize, told: Told<'_>) -> Vec<f64> {
        self.each(run, |planned_rad, measured_rad, _| planned_rad - measured_rad, (None, told))
    }

    /// What a model of other runs has beyond what was measured.
    fn missed(&self, fit: &Fit, run: usize, told: Told<'_>) -> Vec<f64> {
        self.each(run, |_, measured_rad, modelled_rad| modelled_rad - measured_rad, (Some(fit), told))
    }

    /// Of the joints that are told of.
    fn each(
        &self,
        run: usize,
        of: fn(f64, f64, f64) -> f64,
        (fit, told): (Option<&Fit>, Told<'_>),
    ) -> Vec<f64> {
        let (sent, measured) = &self.series[run];
        let mut all = Vec::new();
        for planned in self.plan.tracks.iter().filter(|track| told(track.name())) {
            let (Some(sent), Some(measured)) = (sent.track(planned.name()), measured.track(planned.name()))
            else {
                continue;
            };
            let modelled = match fit {
                None => None,
                Some(fit) => match fit.joint(planned.name()).map(|joint| predict(&joint.model, sent)) {
                    Some(Ok(modelled)) => Some(modelled),
                    _ => continue,
                },
            };
            let one = |(t_s, planned_rad): (&f64, &f64)| {
                let modelled_rad = modelled.as_ref().map_or(0.0, |track| track.held_at(*t_s).position);
                of(*planned_rad, measured.held_at(*t_s).position, modelled_rad)
            };
            let mut own: Vec<f64> = planned.t_s().iter().zip(planned.position()).map(one).collect();
            lowpass(&mut own, COMPARED_HZ, STEP_S);
            all.extend(own);
        }
        all
    }
}

fn square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

/// How far two errors are the same but for their size, -1 to 1.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let along: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    let size = (square(a) * square(b)).sqrt();
    if size > 0.0 && a.len() == b.len() { along / size } else { 0.0 }
}
