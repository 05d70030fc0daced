//! The simulated arm of six joints on one core.
//!
//! `cargo bench --bench plant`; items are simulated seconds: items a second are times real time.
#![allow(missing_docs, clippy::unwrap_used)]

use divan::{Bencher, counter::ItemsCount};
use hydrotrace::{
    plant::{Plant, simulate},
    series::{Series, Track},
};

const DURATION_S: u32 = 40;

fn main() {
    divan::main();
}

/// All joints swing all the time, by a tenth of a radian.
fn command(plant: &Plant) -> Series {
    let t_s: Vec<f64> = (0..=100 * DURATION_S).map(|k| f64::from(k) * 0.01).collect();
    let home = [1.0, 1.9, -0.4, 0.1, 0.1, 0.1];
    let track = |(name, home): (&str, f64)| {
        let position = t_s.iter().map(|t| home + 0.1 * t.sin().powi(2)).collect();
        let speed = t_s.iter().map(|t| 0.1 * (2.0 * t).sin()).collect();
        Track::new(name, t_s.clone(), position, &[]).unwrap().with_velocity(speed).unwrap()
    };
    Series { tracks: plant.joints().zip(home).map(track).collect() }
}

#[divan::bench]
fn six_joints(bencher: Bencher<'_, '_>) {
    let plant = Plant::preset("default").unwrap();
    let command = command(&plant);
    let run = || simulate(&plant, &command, &[], 1).unwrap();
    bencher.counter(ItemsCount::new(DURATION_S)).bench_local(run);
}
