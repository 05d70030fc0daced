//! Rates of crossover and mutation after eq. 8 and 9.

use crate::{Pair, Ranking};

/// Least rates of eq. 8 and 9 as a share of the largest.
const LEAST_CROSSOVER: f64 = 0.6;
const LEAST_MUTATION: f64 = 0.1;

/// Rates of eq. 8 and 9 with the signed distance to the reference plane for a fitness, the
/// better of the pair against the mean.
///
/// DIFFERENCE(eq. 8, 9): as printed, with the largest fitness of the population against the
/// mean, the first case never holds and rates stay at their maximum.
pub(super) fn adapt(ranking: &Ranking, pairs: &mut [Pair]) {
    let finite = || ranking.plane.iter().copied().filter(|s| s.is_finite());
    let mean = finite().sum::<f64>() / finite().count().max(1) as f64;
    let least = finite().fold(f64::INFINITY, f64::min);
    for pair in pairs {
        let better = ranking.plane[pair.first].min(ranking.plane[pair.second]);
        if better > mean || mean <= least {
            continue;
        }
        let share = ((mean - better) / (mean - least) * std::f64::consts::PI).cos().exp();
        pair.crossover = 1.0 - (1.0 - LEAST_CROSSOVER) / (1.0 + share);
        pair.mutation = 1.0 - (1.0 - LEAST_MUTATION) / (1.0 + share);
    }
}
