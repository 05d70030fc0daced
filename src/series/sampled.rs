//! Tracks for tests.

use super::{Series, Track};

impl Track {
    /// A joint that turns, sampled at 100 Hz from 0 s on.
    pub(crate) fn sampled(name: &str, rows: u32, of: impl FnMut(f64) -> f64) -> Self {
        let t_s: Vec<f64> = (0..rows).map(|k| 0.01 * f64::from(k)).collect();
        let angles = t_s.iter().copied().map(of).collect();
        Self::new(name, t_s, angles, &[]).unwrap()
    }
}

impl Series {
    /// The same of one joint.
    pub(crate) fn sampled(name: &str, rows: u32, of: impl FnMut(f64) -> f64) -> Self {
        Self { tracks: vec![Track::sampled(name, rows, of)] }
    }
}
