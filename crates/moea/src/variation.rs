//! Simulated binary crossover and polynomial mutation, of integers on the numbers about them.
//!
//! # References
//!
//! Deb and Agrawal 1995 (SBX, with the bounded spread of the authors' program); Deb and
//! Goyal 1996 (mutation).

use super::{random::Random, variables::Space};

/// Rates and distribution indices of crossover and mutation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Operators {
    /// Probability that a pair is crossed at all, 0 to 1.
    pub crossover_rate: f64,
    /// Distribution index of the crossover; children lie nearer to their parents when it is larger.
    pub crossover_eta: f64,
    /// Probability that a variable mutates, 0 to 1; one over the number of variables if absent. A child that repeats somebody is
    /// mutated at this rate up to eight times more, unless its pair is not to be mutated at all.
    pub mutation_rate: Option<f64>,
    /// Distribution index of the mutation.
    pub mutation_eta: f64,
}

impl Default for Operators {
    /// Deb and Jain 2014, table II.
    fn default() -> Self {
        Self { crossover_rate: 1.0, crossover_eta: 30.0, mutation_rate: None, mutation_eta: 20.0 }
    }
}

impl Operators {
    /// Defaults of PlatEMO 4 (Tian, Cheng, Zhang and Jin 2017, doi 10.1109/MCI.2017.2742868).
    pub const PLATEMO: Self =
        Self { crossover_rate: 1.0, crossover_eta: 20.0, mutation_rate: None, mutation_eta: 20.0 };
}

/// Crosses two parents into two children.
///
/// Each variable is blended with probability one half, and the blended values go to either
/// child with equal probability. Integers are rounded.
pub(super) fn cross(
    operators: &Operators,
    rate: f64,
    space: &Space,
    parents: (&[f64], &[f64]),
    children: (&mut [f64], &mut [f64]),
    rng: &mut Random,
) {
    let (first, second) = children;
    first.copy_from_slice(parents.0);
    second.copy_from_slice(parents.1);
    if rate < 1.0 && rng.unit() >= rate {
        return;
    }
    let exponent = Exponent::new(operators.crossover_eta);
    let mut coins = 0u64;
    for (k, (&(lower, upper), (a, b))) in space.reach.iter().zip(first.iter_mut().zip(second)).enumerate() {
        if k % 32 == 0 {
            coins = rng.bits();
        }
        let (blended, swapped) = (coins & 1 == 1, coins & 2 == 2);
        coins >>= 2;
        let (low, high) = if *a < *b { (*a, *b) } else { (*b, *a) };
        let gap = high - low;
        if !blended || gap <= 1e-14 * (upper - lower) {
            continue;
        }
        let u = rng.unit();
        let low_child = 0.5 * (low + high - exponent.spread(u, (low - lower) / gap) * gap);
        let high_child = 0.5 * (low + high + exponent.spread(u, (upper - high) / gap) * gap);
        let pair = (space.settled(k, low_child), space.settled(k, high_child));
        (*a, *b) = if swapped { (pair.1, pair.0) } else { pair };
    }
}

/// The power `eta + 1`, fast when it is a whole number.
#[derive(Clone, Copy)]
struct Exponent {
    power: f64,
    whole: Option<i32>,
}

impl Exponent {
    #[expect(clippy::cast_possible_truncation, reason = "checked to be whole and small")]
    fn new(eta: f64) -> Self {
        let power = eta + 1.0;
        let whole = (power.fract().abs() < f64::EPSILON && power.abs() < 1000.0).then_some(power as i32);
        Self { power, whole }
    }

    fn raise(self, base: f64) -> f64 {
        self.whole.map_or_else(|| base.powf(self.power), |n| base.powi(n))
    }

    fn root(self, base: f64) -> f64 {
        base.powf(1.0 / self.power)
    }

    /// The spread factor at quantile `u`, its distribution cut at the bound `room` gaps away.
    fn spread(self, u: f64, room: f64) -> f64 {
        let alpha = 2.0 - 1.0 / self.raise(1.0 + 2.0 * room);
        let base = u * alpha;
        if base <= 1.0 { self.root(base) } else { self.root(1.0 / (2.0 - base)) }
    }
}

/// Mutates each variable with probability `rate`. An integer that rounds to itself becomes any other: few
/// values are drawn alike, many by the polynomial, and none is out of reach.
pub(super) fn mutate(eta: f64, rate: f64, space: &Space, x: &mut [f64], rng: &mut Random) {
    let exponent = Exponent::new(eta);
    for (k, value) in x.iter_mut().enumerate() {
        let ((least, most), (lower, upper)) = (space.bounds[k], space.reach[k]);
        if rng.unit() >= rate || most <= least {
            continue;
        }
        let u = rng.unit();
        let span = upper - lower;
        let step = if u < 0.5 {
            let rest = exponent.raise(1.0 - (*value - lower) / span);
            exponent.root(2.0 * u + (1.0 - 2.0 * u) * rest) - 1.0
        } else {
            let rest = exponent.raise(1.0 - (upper - *value) / span);
            1.0 - exponent.root(2.0 * (1.0 - u) + (2.0 * u - 1.0) * rest)
        };
        let before = std::mem::replace(value, space.settled(k, *value + step * span));
        if space.whole[k] && *value >= before && *value <= before {
            let other = least + (rng.unit() * (most - least)).floor().min(most - least - 1.0);
            *value = if other < before { other } else { other + 1.0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Kind, Variables, random::Stream};

    #[test]
    fn a_mutated_integer_changes_and_any_may_become_any_other() {
        for most in [1_u32, 2, 9, 60] {
            let bounds = vec![(0.0, f64::from(most))];
            let space = Space::new(Variables::new(bounds, vec![Kind::Integer])).unwrap();
            let mut rng = Random::new(1, Stream::Variation);
            for before in 0..=most {
                let before = f64::from(before);
                let mut seen = vec![0; most as usize + 1];
                for _ in 0..12_000 {
                    let mut x = [before];
                    mutate(20.0, 1.0, &space, &mut x, &mut rng);
                    let at = (0..=most).position(|value| f64::from(value).to_bits() == x[0].to_bits());
                    seen[at.unwrap()] += 1;
                }
                for (value, times) in seen.into_iter().enumerate() {
                    assert_eq!(
                        times == 0,
                        (value as f64 - before).abs() < 0.5,
                        "{before} to {value} of {most}: {times}"
                    );
                }
            }
        }
    }
}
