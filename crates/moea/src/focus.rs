//! Mating of NSGA-III-FO: who is ahead mates more often.

use super::{
    direction::neighbours,
    mating::{Mating, MatingContext, Pair, Permutation, fitter},
    random::Random,
    survival::Ranking,
};

/// How the focus operator reads "distance to the reference plane".
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Focus {
    /// The printed text: the smallest absolute distance is kept,
    /// the largest barred from mating, and the better half of the others by front mates.
    Literal,
    /// Signed distance, the whole population against itself.
    Signed,
    /// DIFFERENCE(step 2): signed distance, each member against those of neighbouring directions.
    #[default]
    Local,
}

/// Share of the population that is in focus.
const SHARE: f64 = 0.20;
/// Exponent with which the focus fades over the budget.
const FADE: i32 = 2;

/// Least rates of eq. 8 and 9 as a share of the largest.
const LEAST_CROSSOVER: f64 = 0.6;
const LEAST_MUTATION: f64 = 0.1;

/// Mating with a focus.
#[derive(Debug, Clone)]
pub(super) struct Focused {
    focus: Focus,
    adaptive_rates: bool,
    /// Directions near each direction, itself included, `[count][near]`.
    neighbours: Vec<usize>,
    near: usize,
    permutation: Permutation,
    first: Vec<usize>,
    least: Vec<f64>,
    lag: Vec<f64>,
    order: Vec<usize>,
}

impl Focused {
    pub(super) fn new(focus: Focus, adaptive_rates: bool, directions: &[f64], m: usize) -> Self {
        let count = directions.len() / m.max(1);
        let near = (m * m.saturating_sub(1) + 1).min(21).min(count);
        Self {
            focus,
            adaptive_rates,
            neighbours: neighbours(directions, m, near),
            near,
            permutation: Permutation::default(),
            first: Vec::new(),
            least: vec![f64::INFINITY; count],
            lag: Vec::new(),
            order: Vec::new(),
        }
    }

    /// How far each member is behind whom it is compared with; orders members by it.
    fn rate(&mut self, context: &MatingContext<'_>, rng: &mut Random) {
        let (population, ranking) = (context.population, context.ranking);
        self.lag.clear();
        match self.focus {
            Focus::Literal => self.lag.extend(ranking.plane.iter().map(|s| s.abs())),
            Focus::Signed => self.lag.extend(&ranking.plane),
            Focus::Local => {
                self.least.fill(f64::INFINITY);
                for (&j, &s) in ranking.direction.iter().zip(&ranking.plane) {
                    if let Some(least) = self.least.get_mut(j) {
                        *least = least.min(s);
                    }
                }
                for (&j, &s) in ranking.direction.iter().zip(&ranking.plane) {
                    let near = self.neighbours.chunks_exact(self.near).nth(j);
                    let ahead =
                        near.map_or(s, |near| near.iter().fold(s, |least, &b| least.min(self.least[b])));
                    self.lag.push(if s.is_finite() { s - ahead } else { 0.0 });
                }
            }
        }
        self.order.clear();
        self.order.extend(0..population.len());
        rng.shuffle(&mut self.order);
        let lag = &self.lag;
        self.order.sort_by(|&a, &b| {
            population.violation(a).total_cmp(&population.violation(b)).then(lag[a].total_cmp(&lag[b]))
        });
    }
}

impl Mating for Focused {
    fn pair(
        &mut self,
        context: &MatingContext<'_>,
        children: usize,
        rng: &mut Random,
        pairs: &mut Vec<Pair>,
    ) {
        self.rate(context, rng);
        pairs.clear();
        self.choose(context, children, rng, pairs);
        if self.adaptive_rates {
            adapt(context.ranking, pairs);
        }
    }

    fn reserved(&self) -> usize {
        1
    }
}

impl Focused {
    fn choose(
        &mut self,
        context: &MatingContext<'_>,
        children: usize,
        rng: &mut Random,
        pairs: &mut Vec<Pair>,
    ) {
        let population = context.population;
        let n = population.len();
        if self.focus == Focus::Literal {
            // The worst is barred, and the better half of the others by front mates.
            let (ranking, barred) = (context.ranking, self.order.pop());
            rng.shuffle(&mut self.order);
            self.order.sort_by_key(|&i| ranking.rank[i]);
            let better = n.saturating_sub(2).div_ceil(2).clamp(1, n.max(1));
            for _ in 0..children.div_ceil(2) {
                let mut draw = || self.order.get(rng.below(better)).copied().or(barred).unwrap_or(0);
                pairs.push(Pair::of(draw(), draw()));
            }
            return;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of n")]
        let in_focus = ((SHARE * n as f64).ceil() as usize).clamp(1, n.max(1));
        // DIFFERENCE(step 3): the focus fades over the budget.
        let pull = context.progress.map_or(0.5, |progress| 1.0 - progress.clamp(0.0, 1.0).powi(FADE));
        self.permutation.draw(population, children.div_ceil(2), rng, &mut self.first);
        for &first in &self.first {
            let second = if rng.unit() < pull {
                self.order[rng.below(in_focus)]
            } else {
                fitter(population, rng.below(n), rng)
            };
            pairs.push(Pair::of(first, second));
        }
    }
}

/// Rates of eq. 8 and 9 with the signed distance to the reference plane for a fitness, the
/// better of the pair against the mean.
///
/// DIFFERENCE(eq. 8, 9): as printed, with the largest fitness of the population against the
/// mean, the first case never holds and rates stay at their maximum.
fn adapt(ranking: &Ranking, pairs: &mut [Pair]) {
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
