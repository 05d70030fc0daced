//! Mating of NSGA-III-FO: who is ahead mates more often.

use rand_chacha::ChaCha8Rng;

use super::{
    mating::{Courtship, Mating, Permutation, fitter},
    variation::{below, shuffle, unit},
};

/// How the focus operator reads "distance to the reference plane".
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Focus {
    /// The printed text: smallest and largest absolute distance; the better half mates.
    Literal,
    /// Signed distance, the whole population against itself.
    Signed,
    /// Signed distance, each member against those of neighbouring directions.
    #[default]
    Local,
}

/// Share of the population that is in focus.
const SHARE: f64 = 0.20;
/// Exponent with which the focus fades over the budget.
const FADE: i32 = 2;

/// Mating with a focus.
#[derive(Debug, Clone)]
pub(super) struct Focused {
    focus: Focus,
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
    pub(super) fn new(focus: Focus, directions: &[f64], m: usize) -> Self {
        let count = directions.len() / m.max(1);
        let near = (m * m.saturating_sub(1) + 1).min(21).min(count);
        Self {
            focus,
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
    fn rate(&mut self, courtship: &Courtship<'_>, rng: &mut ChaCha8Rng) {
        let (population, standing) = (courtship.population, courtship.standing);
        self.lag.clear();
        match self.focus {
            Focus::Literal => self.lag.extend(standing.plane.iter().map(|s| s.abs())),
            Focus::Signed => self.lag.extend(&standing.plane),
            Focus::Local => {
                self.least.fill(f64::INFINITY);
                for (&j, &s) in standing.direction.iter().zip(&standing.plane) {
                    if let Some(least) = self.least.get_mut(j) {
                        *least = least.min(s);
                    }
                }
                for (&j, &s) in standing.direction.iter().zip(&standing.plane) {
                    let near = self.neighbours.chunks_exact(self.near).nth(j);
                    let ahead = near.map_or(s, |near| near.iter().fold(s, |least, &b| least.min(self.least[b])));
                    self.lag.push(if s.is_finite() { s - ahead } else { 0.0 });
                }
            }
        }
        self.order.clear();
        self.order.extend(0..population.len());
        shuffle(&mut self.order, rng);
        let lag = &self.lag;
        self.order.sort_by(|&a, &b| {
            population.violation(a).total_cmp(&population.violation(b)).then(lag[a].total_cmp(&lag[b]))
        });
    }
}

impl Mating for Focused {
    fn pair(
        &mut self,
        courtship: &Courtship<'_>,
        children: usize,
        rng: &mut ChaCha8Rng,
        pairs: &mut Vec<(usize, usize)>,
    ) {
        let population = courtship.population;
        self.rate(courtship, rng);
        let n = population.len();
        pairs.clear();
        if self.focus == Focus::Literal {
            // All but the worst and the worse half of the rest mate among themselves.
            let better = (n.saturating_sub(2) / 2).max(2).min(n);
            for _ in 0..children.div_ceil(2) {
                pairs.push((self.order[below(better, rng)], self.order[below(better, rng)]));
            }
            return;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of n")]
        let in_focus = ((SHARE * n as f64).ceil() as usize).clamp(1, n.max(1));
        let pull = courtship.progress.map_or(0.5, |progress| 1.0 - progress.clamp(0.0, 1.0).powi(FADE));
        self.permutation.draw(population, children.div_ceil(2), rng, &mut self.first);
        for &first in &self.first {
            let second = if unit(rng) < pull {
                self.order[below(in_focus, rng)]
            } else {
                fitter(population, below(n, rng), rng)
            };
            pairs.push((first, second));
        }
    }

    fn reserved(&self) -> usize {
        1
    }
}

/// The `near` directions closest to each direction, itself first.
fn neighbours(directions: &[f64], m: usize, near: usize) -> Vec<usize> {
    let all: Vec<&[f64]> = directions.chunks_exact(m.max(1)).collect();
    let mut flat = Vec::with_capacity(all.len() * near);
    for own in &all {
        let apart = |j: usize| all[j].iter().zip(*own).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        let mut order: Vec<usize> = (0..all.len()).collect();
        order.sort_by(|&a, &b| apart(a).total_cmp(&apart(b)));
        flat.extend_from_slice(&order[..near.min(order.len())]);
    }
    flat
}
