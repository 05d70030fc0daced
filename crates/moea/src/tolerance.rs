//! Ends a run whose front no longer gets better.

use std::ops::ControlFlow;

use super::{Population, Progress, indicator::igd_plus};

/// Ends a run when its front gains next to nothing; an observer of [`optimise`](super::optimise()).
///
/// The gain from an old front to a new one is the IGD+ of the old one to the new one less that of the
/// new one to the old one, in shares of the new front's range: fronts that differ in spacing alone gain
/// nothing. In an objective in which the new front has no range, as with a single objective, the gain is a share of the
/// range of all feasible members watched so far: neither origin nor unit of an objective matters. Nothing ends before a feasible member is found. With [`Budget::Observer`] a run ends by it
/// alone; the focus of NSGA-III-FO fades with a budget only.
///
/// It looks back at the generations that it has watched: a run that is taken up from its record shows them again by
/// [`Run::replay_watched`](super::Run::replay_watched), and ends where it would have in one go.
///
/// [`Budget::Observer`]: super::Budget::Observer
///
/// ```
/// use moea::{Settings, Tolerance, benchmark::Benchmark, optimise};
///
/// let problem = Benchmark::named("DTLZ2", 3).unwrap();
/// let mut tolerance = Tolerance::new(1e-3, 20);
/// let run = optimise(&problem, &Settings::default(), |progress| tolerance.watch(progress))?;
/// assert!(run.evaluations < 20_000);
/// # Ok::<(), moea::MoeaError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Tolerance {
    least: f64,
    period: u64,
    /// Generation watched last.
    generation: u64,
    /// Front of the comparison before, `[n][objectives]`.
    before: Vec<f64>,
    /// Least and largest value of each objective of the feasible members so far, `[objectives]`.
    seen: Vec<(f64, f64)>,
}

impl Tolerance {
    /// Ends a run that gains no more than `least` (a share of the front's range) within `period`
    /// generations. A `least` below 0, or that is no number, counts as 0: a front that gains nothing ends the run.
    pub fn new(least: f64, period: u64) -> Self {
        // The larger of 0 and NaN is 0.
        let least = least.max(0.0);
        Self { least, period: period.max(1), generation: 0, before: Vec::new(), seen: Vec::new() }
    }

    /// Breaks if the run has gained too little. A generation that is watched again tells nothing new, and an earlier one,
    /// or another number of objectives, is of another run, watched from its start.
    pub fn watch(&mut self, progress: &Progress<'_>) -> ControlFlow<()> {
        let population = progress.population;
        if progress.generation < self.generation || population.objectives() != self.seen.len() {
            (self.before, self.seen) = (Vec::new(), Vec::new());
        } else if progress.generation == self.generation {
            return ControlFlow::Continue(());
        }
        self.generation = progress.generation;
        self.see(population);
        if !progress.generation.is_multiple_of(self.period) {
            return ControlFlow::Continue(());
        }
        let now = front(population);
        let before = std::mem::replace(&mut self.before, now);
        if before.is_empty() || self.before.is_empty() {
            return ControlFlow::Continue(());
        }
        if gain(&before, &self.before, &self.seen) <= self.least {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    fn see(&mut self, population: &Population) {
        self.seen.resize(population.objectives(), (f64::INFINITY, f64::NEG_INFINITY));
        for i in (0..population.len()).filter(|&i| population.is_feasible(i)) {
            for ((least, most), &f) in self.seen.iter_mut().zip(population.f(i)) {
                (*least, *most) = (least.min(f), most.max(f));
            }
        }
    }
}

/// Objectives of the feasible members that none dominates.
fn front(population: &Population) -> Vec<f64> {
    population.front().into_iter().flat_map(|i| population.f(i).iter().copied()).collect()
}

/// Mean distance by which a front is better than one before, in shares of its range; of the range of all that was
/// `seen` where it has none, `[m]`.
fn gain(before: &[f64], now: &[f64], seen: &[(f64, f64)]) -> f64 {
    let m = seen.len();
    let range = seen.iter().enumerate().map(|(k, (least, most))| {
        let values = || now.iter().skip(k).step_by(m).copied();
        let own = values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min);
        [own, most - least].into_iter().find(|range| *range > 0.0).unwrap_or(1.0)
    });
    let range: Vec<f64> = range.collect();
    let scaled = |f: &[f64]| f.iter().enumerate().map(|(i, f)| f / range[i % m]).collect::<Vec<f64>>();
    let (before, now) = (scaled(before), scaled(now));
    igd_plus(&before, &now, m) - igd_plus(&now, &before, m)
}

#[cfg(test)]
mod tests {
    use super::gain;

    #[test]
    fn a_gain_is_a_share_of_the_range_and_spacing_gains_nothing() {
        let line = |n: u32, above: f64| -> Vec<f64> {
            let at = move |i: u32| f64::from(i) / f64::from(n);
            (0..=n).flat_map(|i| [at(i) + above, 500.0 * (1.0 - at(i) + above)]).collect()
        };
        let seen = [(0.0, 1.0); 2];
        assert!(gain(&line(50, 0.0), &line(50, 0.0), &seen).abs() < 1e-15);
        // A front that comes nearer by a tenth of its range in both objectives; neighbours shorten the way.
        let (near, far) = (line(200, 0.0), line(200, 0.1));
        assert!((gain(&far, &near, &seen) - 0.1 * 2_f64.sqrt()).abs() < 0.01, "{}", gain(&far, &near, &seen));
        assert!(gain(&near, &far, &seen) < -0.1);
        assert!(gain(&line(10, 0.0), &line(11, 0.0), &seen).abs() < 0.01);
    }
}
