//! Fits to fifty machines.

use cpu_time::ProcessTime;
use hydrotrace::fit::Excitation;

use crate::support::{
    machine::{excitation, task},
    recovery::{Column, QUANTITIES, is_limit, median_size, recover},
};

fn print(title: &str, columns: &[Column], skills: &[f64]) {
    let mut skills = skills.to_vec();
    skills.sort_by(f64::total_cmp);
    let at = |p: f64| skills[(p * (skills.len() - 1) as f64) as usize];
    println!("{title}: held-out R2 10 % {:.2} median {:.2}; {} joints", at(0.1), at(0.5), skills.len());
    for (column, (name, ..)) in columns.iter().zip(QUANTITIES) {
        let mean = column.errors.iter().sum::<f64>() / column.errors.len() as f64;
        println!(
            "  {name}: identified {} of {}, median |error| {:.0} %, mean {:.0} %, coverage {:.2}; \
             median |error| of {} guesses {:.0} %",
            column.errors.len(),
            column.joints,
            100.0 * column.median_error(),
            100.0 * mean,
            column.coverage(),
            column.guesses.len(),
            100.0 * median_size(&column.guesses),
        );
    }
}

/// Machines that no default was set on: discrepancies come from 1 to 20.
const MACHINES: std::ops::Range<u64> = 300..350;

#[test]
#[ignore = "minutes; in release by .ci/run"]
fn trials_of_fifty_machines_find_what_is_there_within_their_intervals() {
    let clock = ProcessTime::now();
    let (columns, skills) = recover(MACHINES, &excitation(&Excitation::minimal()));
    print("minimal excitation", &columns, &skills);
    println!("  {:.0} s of processor time", clock.elapsed().as_secs_f64());
    for (column, (name, ..)) in columns.iter().zip(QUANTITIES) {
        if name.starts_with("acceleration") {
            // What the oil makes of the spool's slew rate is no limit of the joint: never a number.
            assert_eq!(column.errors.len(), 0, "{name}");
            continue;
        }
        let most = match name {
            "lag" | "speed +" => 0.07,
            "speed -" | "gain ratio" | "feed forward" | "position gain" | "integral gain" => 0.05,
            _ => 0.15,
        };
        assert!(column.errors.len() * 10 >= column.joints * 8, "{name}: {}", column.errors.len());
        assert!(column.median_error() <= most, "{name}: {}", column.median_error());
        assert!(column.coverage() >= 0.90, "{name}: {}", column.coverage());
    }
}

#[test]
#[ignore = "minutes; in release by .ci/run"]
fn smooth_runs_of_fifty_machines_show_no_limit_no_lag_and_no_position_gain() {
    let clock = ProcessTime::now();
    let (columns, skills) = recover(MACHINES, &task(1));
    print("task 1", &columns, &skills);
    println!("  {:.0} s of processor time", clock.elapsed().as_secs_f64());
    for (column, (name, ..)) in columns.iter().zip(QUANTITIES) {
        if name == "lag" || name == "position gain" || is_limit(name) {
            assert_eq!(column.errors.len(), 0, "{name}");
            assert_eq!(column.refuted, 0, "{name}");
        } else if !column.errors.is_empty() {
            assert!(column.coverage() >= 0.90, "{name}: {}", column.coverage());
        }
    }
}
