//! Inverse dynamics of the sample arm: nanoseconds a call at eight instants, four and one at a time.
//!
//! `cargo bench --bench inverse_dynamics`; items are calls of one instant.
#![allow(missing_docs, clippy::unwrap_used)]

use divan::{Bencher, counter::ItemsCount};
use hydrotrace::arm::{Arm, Motion, Workspace};

fn main() {
    divan::main();
}

#[divan::bench(consts = [1, 4, 8, 16])]
fn lanes<const L: usize>(bencher: Bencher<'_, '_>) {
    let chain = Arm::sample().unwrap().chain;
    let load = chain.load(None);
    let mut work = Workspace::<L>::new(&chain);
    let (q, qd, qdd) = ([[0.7; L]; 6], [[0.1; L]; 6], [[0.2; L]; 6]);
    let mut torque = [[0.0; L]; 6];
    bencher.counter(ItemsCount::new(L * 56)).bench_local(|| {
        for _ in 0..56 {
            let (q, qd, qdd) = divan::black_box((&q, &qd, &qdd));
            let motion = Motion { position_rad: q, speed_rad_s: qd, acceleration_rad_s2: qdd };
            chain.inverse_dynamics(&load, motion, &mut work, &mut torque);
            divan::black_box(&torque);
        }
    });
}

#[divan::bench]
fn reach(bencher: Bencher<'_, '_>) {
    let chain = Arm::sample().unwrap().chain;
    let pose = chain.tool_pose(&[1.0, 1.7, -0.6, 0.1, 0.0, 0.1]);
    bencher.bench_local(|| chain.reach(&pose, &[0.9, 1.5, -0.4, 0.0, 0.0, 0.0]).unwrap());
}
