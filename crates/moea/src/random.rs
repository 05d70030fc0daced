//! Random numbers that are the same on every machine and every run.

use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};

/// What a stream of random numbers is for. A new purpose gets a new number; none is reused.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Stream {
    /// First population.
    Start = 20,
    /// Mating, crossover and mutation.
    Variation = 21,
    /// Ties in selection.
    Survival = 22,
}

/// A stream of random numbers of a run, the same on every platform.
#[derive(Debug, Clone)]
pub struct Random(ChaCha8Rng);

impl Random {
    /// The stream for one purpose; drawing from one stream never moves another.
    pub(crate) fn new(seed: u64, purpose: Stream) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(purpose as u64);
        Self(rng)
    }

    /// The numbers that survival draws in a run with this seed: to call a [`Survival`](super::Survival) by hand.
    pub fn of_survival(seed: u64) -> Self {
        Self::new(seed, Stream::Survival)
    }

    #[inline]
    pub(crate) fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// A number in `[0, 1)`.
    #[inline]
    pub fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }

    /// An index below `n`; 0 for an empty range.
    #[inline]
    #[expect(clippy::cast_possible_truncation, reason = "the high half of the product is below n")]
    pub fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.0.next_u64()) * n as u128) >> 64) as usize
    }

    /// Puts items into a uniformly random order.
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.below(i + 1));
        }
    }
}
