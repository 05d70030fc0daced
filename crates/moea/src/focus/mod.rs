//! Mating of NSGA-III-FO: members that are ahead mate more often.

mod rates;

use super::{
    direction::neighbours,
    mating::{Mating, MatingContext, Pair, Permutation, fitter, winner},
    population::Population,
    random::Random,
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
    Local,
    /// DIFFERENCE(step 2): as [`Focus::Local`]; where the front meets few of the reference directions,
    /// also tournaments, mates from the ends of the front, and survival by crowding.
    #[default]
    Spread,
}

impl Focus {
    /// Whether survival fills surplus places by crowding.
    pub(super) fn fills_by_crowding(self) -> bool {
        self == Self::Spread
    }
}

/// Share of the population that is in focus.
const SHARE: f64 = 0.20;
/// Exponent with which the focus fades over the budget.
const FADE: i32 = 2;
/// Exponent of the share of reference directions without a member: how often [`Focus::Spread`] leaves
/// the local focus.
const IDLE: i32 = 2;
/// Share of that in which the second parent is an end of the front.
const ENDS: f64 = 0.5;
/// Share of feasible members from which on the focus acts in full.
const ENOUGH: f64 = 0.1;

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
    ends: Vec<usize>,
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
            ends: Vec::new(),
        }
    }

    /// How far each member is behind whom it is compared with; orders members by it.
    fn rate(&mut self, context: &MatingContext<'_>, rng: &mut Random) {
        let (population, ranking) = (context.population, context.ranking);
        self.lag.clear();
        match self.focus {
            Focus::Literal => self.lag.extend(ranking.plane.iter().map(|s| s.abs())),
            Focus::Signed => self.lag.extend(&ranking.plane),
            Focus::Local | Focus::Spread => {
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
            rates::adapt(context.ranking, pairs);
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
        let fading = context.progress.map_or(0.5, |progress| 1.0 - progress.clamp(0.0, 1.0).powi(FADE));
        let acts = if self.focus == Focus::Signed { 1.0 } else { share_that_acts(population) };
        let (pull, idle) = (fading * acts, self.find_ends(context) * acts);
        self.permutation.draw(population, children.div_ceil(2), rng, &mut self.first);
        for &drawn in &self.first {
            let first = if happens(idle, rng) { winner(context, drawn, rng.below(n)) } else { drawn };
            let second = if !self.ends.is_empty() && happens(ENDS * idle, rng) {
                self.ends[rng.below(self.ends.len())]
            } else if rng.unit() < pull {
                self.order[rng.below(in_focus)]
            } else if happens(idle, rng) {
                winner(context, rng.below(n), rng.below(n))
            } else {
                fitter(population, rng.below(n), rng)
            };
            pairs.push(Pair::of(first, second));
        }
    }

    /// Finds the feasible members with the least of each objective. Returns the probability of leaving
    /// the local focus: 0 if every direction has a member, and for every other form of the focus.
    fn find_ends(&mut self, context: &MatingContext<'_>) -> f64 {
        self.ends.clear();
        if self.focus != Focus::Spread {
            return 0.0;
        }
        let taken = self.least.iter().filter(|least| least.is_finite()).count();
        let idle = 1.0 - taken as f64 / self.least.len().max(1) as f64;
        let population = context.population;
        for k in 0..population.objectives() {
            let feasible = (0..population.len()).filter(|&i| population.is_feasible(i));
            let end = feasible.min_by(|&a, &b| population.f(a)[k].total_cmp(&population.f(b)[k]));
            if let Some(end) = end.filter(|end| !self.ends.contains(end)) {
                self.ends.push(end);
            }
        }
        idle.powi(IDLE)
    }
}

/// How much of the focus acts: all of it once a tenth of the members is feasible.
///
/// Infeasible members are ordered by violation alone. Mated by that order, all come from the few that first
/// met one part of the feasible region, and other parts are never found.
fn share_that_acts(population: &Population) -> f64 {
    let n = population.len();
    let feasible = (0..n).filter(|&i| population.is_feasible(i)).count();
    (feasible as f64 / (ENOUGH * n as f64).max(f64::MIN_POSITIVE)).min(1.0)
}

/// Draws nothing for an event that cannot happen.
fn happens(probability: f64, rng: &mut Random) -> bool {
    probability > 0.0 && rng.unit() < probability
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Niching, Ranking, Survival, das_dennis, random::Stream};

    /// Pairs of a focus, and the next random number, for members on three objectives' directions.
    fn pairs(focus: Focus, population: &Population) -> (Vec<Pair>, f64) {
        let directions = das_dennis(3, 12).unwrap();
        let (mut chosen, mut ranking) = (Vec::new(), Ranking::default());
        let mut rng = Random::new(1, Stream::Survival);
        let n = population.len();
        Niching::filled_by_crowding(&directions, 3)
            .unwrap()
            .select(population, n, &mut rng, &mut chosen, &mut ranking);
        let mut kept = Population::with_capacity(0, 3, n);
        for &i in &chosen {
            kept.push_from(population, i);
        }
        let context = MatingContext { population: &kept, ranking: &ranking, progress: Some(0.5) };
        let mut rng = Random::new(2, Stream::Variation);
        let mut pairs = Vec::new();
        Focused::new(focus, false, &directions, 3).pair(&context, 1000, &mut rng, &mut pairs);
        (pairs, rng.unit())
    }

    #[test]
    fn on_a_front_that_meets_every_direction_the_focus_is_the_local_one() {
        let mut front = das_dennis(3, 12).unwrap();
        let full = Population::from_objectives(&front, 3);
        assert_eq!(pairs(Focus::Spread, &full), pairs(Focus::Local, &full));
        front.truncate(3 * 60);
        let part = Population::from_objectives(&front, 3);
        assert_ne!(pairs(Focus::Spread, &part), pairs(Focus::Local, &part));
    }

    #[test]
    fn on_a_front_that_meets_few_directions_half_of_the_second_parents_are_ends() {
        // A line from (0, 0, 1) to (1, 1, 0): its ends are the first and the last.
        let line: Vec<f64> = (0..92).flat_map(|i| [f64::from(i), f64::from(i), f64::from(91 - i)]).collect();
        let (pairs, _) = pairs(Focus::Spread, &Population::from_objectives(&line, 3));
        let second = |end: usize| pairs.iter().filter(|pair| pair.second == end).count();
        let most = (0..92).map(second).max().unwrap();
        let ends: usize = (0..92).map(second).filter(|&count| count > 60).sum();
        assert_eq!(pairs.len(), 500);
        assert!(most > 60 && (160..=260).contains(&ends), "{most} {ends}");
    }
}
