//! Random numbers that are the same on every machine and every run.

use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

/// What a stream of random numbers is for. A new purpose gets a new number; none is reused.
#[derive(Debug, Clone, Copy)]
pub enum Stream {
    /// Motions of a synthetic arm.
    Motion = 1,
    /// Noise of a synthetic encoder.
    SensorNoise = 2,
    /// Jitter and losses of a synthetic logger.
    Sampling = 3,
    /// Parameters of a random hydraulic machine.
    Machine = 4,
    /// Delays of set values on their way to a machine.
    SetValues = 5,
    /// What differs from run to run of one machine.
    Run = 6,
}

/// The stream for one purpose: equal arguments give equal numbers on every platform, and
/// drawing from one stream never moves another.
pub fn stream(seed: u64, purpose: Stream) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(purpose as u64);
    rng
}
