//! A live control loop can log: samples cost no allocation once everything is warm.

use std::io;

use allocation_counter::measure;
use hydrotrace::log::{ControllerState, LogWriter, Point, Role, WriteOptions};

/// Allocations of each round of all live messages, in one chunk.
fn allocations_per_round(rounds: i64, chunk_bytes: u32) -> Vec<u64> {
    let names: Vec<String> = (0..7).map(|k| format!("arm_{k}_joint")).collect();
    let mut log =
        LogWriter::new(io::sink(), &names, WriteOptions { chunk_bytes, ..WriteOptions::default() }).unwrap();
    let planned: [f64; 7] = std::array::from_fn(|k| k as f64);
    let measured = planned.map(|rad| rad + 1e-3);
    let state = ControllerState {
        reference: Point { position_rad: &planned, velocity_rad_s: &planned, ..Point::default() },
        feedback: Point { position_rad: &measured, velocity_rad_s: &measured, ..Point::default() },
        output: Point { effort_n_m: &planned, ..Point::default() },
        speed_scaling_factor: 1.0,
    };
    let mut counts = Vec::new();
    for k in 0..rounds {
        let stamp_ns = k * 1_000_000;
        let round = measure(|| {
            log.joint_sample(Role::Planned, stamp_ns, &planned, &planned, &[]).unwrap();
            log.joint_sample(Role::Measured, stamp_ns, &measured, &measured, &planned).unwrap();
            log.joint_sample(Role::Command, stamp_ns, &[], &[], &planned).unwrap();
            log.controller_state(stamp_ns, &state).unwrap();
        });
        counts.push(round.count_total);
    }
    counts
}

#[test]
fn within_a_chunk_allocations_end_but_for_buffers_that_double() {
    let counts = allocations_per_round(1 << 14, 1 << 26);
    println!("first round {}, all {}", counts[0], counts.iter().sum::<u64>());
    let mut end = counts.len();
    while end > 256 {
        // The index of each of the four topics doubles once an octave, beside it checksum buffers.
        let octave = &counts[end / 2..end];
        assert!(octave.iter().sum::<u64>() <= 8, "{octave:?}");
        assert!(octave.iter().filter(|&&count| count > 0).count() <= 4, "{octave:?}");
        end /= 2;
    }
}

#[test]
fn with_chunks_of_the_usual_size_allocations_are_few_and_far_between() {
    let counts = allocations_per_round(20_000, 1 << 20);
    let (rounds, sum) = (counts.iter().filter(|&&n| n > 0).count(), counts.iter().sum::<u64>());
    println!("{sum} allocations in {rounds} of {} rounds", counts.len());
    assert!(rounds < counts.len() / 20);
}
