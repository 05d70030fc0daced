//! What fits find against what is there.

use cpu_time::ProcessTime;

use hydrotrace::{
    arm::Arm,
    fit::{Estimated, Excitation, JointFit, Observation, fit},
    plant::{JointRecord, JointTruth, Parameters, Plant, simulate},
    series::{Quantity, Series, Signal, Track},
    units::DEGREE_RAD,
};

use super::{HOME_DEG, Job, excitation, fitted, measured, run, task};

/// One quantity over many joints. Errors are logarithms of found by true.
#[derive(Default)]
struct Column {
    joints: usize,
    /// Of identified numbers.
    errors: Vec<f64>,
    /// Identified numbers whose interval holds the truth.
    covered: usize,
    /// Of numbers that the data do not decide.
    guesses: Vec<f64>,
    /// Joints whose truth lies below what is said to have been reached.
    refuted: usize,
}

impl Column {
    fn add(&mut self, found: &Estimated, truth: f64) {
        self.joints += 1;
        self.refuted += usize::from(found.lower_bound.is_some_and(|bound| bound > truth));
        let error = found.value.map(|value| (value / truth).ln());
        if found.identified {
            let [low, high] = found.interval.unwrap();
            self.errors.push(error.unwrap());
            self.covered += usize::from((low..=high).contains(&truth));
        } else {
            self.guesses.extend(error);
        }
    }

    fn median_error(&self) -> f64 {
        median_size(&self.errors)
    }

    /// Share of the identified numbers whose interval holds the truth.
    fn coverage(&self) -> f64 {
        self.covered as f64 / self.errors.len() as f64
    }
}

fn median_size(errors: &[f64]) -> f64 {
    let mut sorted: Vec<f64> = errors.iter().map(|e| e.abs()).collect();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}

type Pick = fn(&JointFit) -> &Estimated;

type Truth = fn(&JointTruth) -> f64;

/// Quantities with their truth. Gains and dead band of the model have the plant's gain in them.
const QUANTITIES: [(&str, Pick, Truth); 11] = [
    ("lag", |j| &j.lag_s, |t| t.lag_s),
    ("dead band", |j| &j.dead_band_rad_s, |t| 0.5 * (t.dead_band_rad_s[0] + t.dead_band_rad_s[1]) * gain(t)),
    (
        "dead band error",
        |j| &j.dead_band_error_rad,
        |t| 0.5 * (t.dead_band_rad_s[0] + t.dead_band_rad_s[1]) / t.position_gain_1_s,
    ),
    ("position gain", |j| &j.position_gain_1_s, |t| t.position_gain_1_s * gain(t)),
    ("integral gain", |j| &j.integral_gain_1_s2, |t| t.integral_gain_1_s2 * gain(t)),
    ("feed forward", |j| &j.feed_forward, |t| t.feed_forward * gain(t)),
    ("gain ratio", |j| &j.gain_ratio, |t| t.gain[0] / t.gain[1]),
    ("speed +", |j| &j.speed_limit_growing_rad_s, |t| t.speed_limit_rad_s[0]),
    ("speed -", |j| &j.speed_limit_shrinking_rad_s, |t| t.speed_limit_rad_s[1]),
    ("acceleration +", |j| &j.acceleration_limit_growing_rad_s2, |t| t.acceleration_limit_rad_s2[0]),
    ("acceleration -", |j| &j.acceleration_limit_shrinking_rad_s2, |t| t.acceleration_limit_rad_s2[1]),
];

fn gain(truth: &JointTruth) -> f64 {
    (truth.gain[0] * truth.gain[1]).sqrt()
}

/// Amid the angles of each joint, where a fit's gains hold.
fn middle_rad(plan: &Series) -> Vec<f64> {
    let middle = |track: &Track| {
        let angles = track.position().iter().copied();
        0.5 * (angles.clone().fold(f64::INFINITY, f64::min) + angles.fold(f64::NEG_INFINITY, f64::max))
    };
    plan.tracks.iter().map(middle).collect()
}

/// Fits to one run of each of many machines, by quantity; with the skills. Every other joint of a
/// machine is fitted, the rest of the next one: joints are fitted one by one.
fn recover(seeds: std::ops::Range<u64>, job: &Job) -> (Vec<Column>, Vec<f64>) {
    let base = Parameters::preset("default").unwrap();
    let mut columns: Vec<Column> = QUANTITIES.iter().map(|_| Column::default()).collect();
    let mut skills = Vec::new();
    for seed in seeds {
        let plant = Plant::new(&Arm::sample().unwrap(), base.random(seed)).unwrap();
        let truth = plant.truth(&middle_rad(&job.plan), 0.0).unwrap();
        let mut measured = run(&plant, &job.plan, job, seed);
        let mut place = seed;
        measured.tracks.retain(|_| {
            place += 1;
            place % 2 == 0
        });
        let fit = fitted(&[(&job.plan, &measured)]);
        for joint in &fit.joints {
            let truth = truth.joints.iter().find(|truth| truth.name == joint.name).unwrap();
            skills.push(joint.held_out_r2);
            for (column, (_, found, truth_of)) in columns.iter_mut().zip(QUANTITIES) {
                column.add(found(joint), truth_of(truth));
            }
        }
    }
    (columns, skills)
}

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

fn is_limit(name: &str) -> bool {
    name.starts_with("speed") || name.starts_with("acceleration")
}

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
fn smooth_runs_of_fifty_machines_show_no_limit_and_no_lag() {
    let clock = ProcessTime::now();
    let (columns, skills) = recover(MACHINES, &task(1));
    print("task 1", &columns, &skills);
    println!("  {:.0} s of processor time", clock.elapsed().as_secs_f64());
    for (column, (name, ..)) in columns.iter().zip(QUANTITIES) {
        if name == "lag" || is_limit(name) {
            assert_eq!(column.errors.len(), 0, "{name}");
            assert_eq!(column.refuted, 0, "{name}");
        } else if !column.errors.is_empty() {
            assert!(column.coverage() >= 0.90, "{name}: {}", column.coverage());
        }
    }
}

#[test]
fn a_trial_of_each_joint_finds_lag_dead_band_gains_and_speed_limits() {
    let (columns, skills) = recover(200..203, &excitation(&Excitation::minimal()));
    assert!(skills.iter().all(|r2| *r2 > 0.9), "{skills:?}");
    for (column, (name, ..)) in columns.iter().zip(QUANTITIES) {
        let most = match name {
            "lag" | "feed forward" | "gain ratio" | "speed +" | "speed -" => 0.10,
            "position gain" | "integral gain" => 0.15,
            "dead band" | "dead band error" => 0.20,
            // What the oil makes of the spool's slew rate is no limit of the joint.
            _ => continue,
        };
        assert!(column.median_error() < most, "{name}: {}", column.median_error());
        assert!(column.coverage() > 0.85, "{name}: {}", column.coverage());
        assert!(column.errors.len() * 10 >= column.joints * 8, "{name}: {}", column.errors.len());
    }
}

#[test]
fn a_smooth_task_shows_no_limit_and_no_lag() {
    let (columns, _) = recover(200..202, &task(1));
    for (column, (name, ..)) in columns.iter().zip(QUANTITIES) {
        if name == "lag" || is_limit(name) {
            assert_eq!(column.errors.len(), 0, "{name}");
        }
    }
}

#[test]
fn signals_to_the_valves_show_the_dead_band_of_each_direction() {
    let plant = Plant::preset("default").unwrap();
    let job = task(1);
    let record = simulate(&plant, &job.plan, &job.payload, 1).unwrap();
    let signals = |joint: &JointRecord| {
        let values = joint.valve_command.clone();
        Signal::new(&joint.name, Quantity::Share, record.t_s.clone(), values, &[]).unwrap()
    };
    let valve: Vec<Signal> = record.joints.iter().map(signals).collect();
    let log = Observation { sent: &job.plan, measured: &measured(&record), valve: &valve };
    let fit = fit(&[log]).unwrap();
    let truth = plant.truth(&HOME_DEG.map(|q| q * DEGREE_RAD), 0.0).unwrap();
    let mut found = 0;
    for ((joint, truth), own) in fit.joints.iter().zip(&truth.joints).zip(&plant.parameters().joints) {
        let Some(bands) = joint.valve_dead_band else { continue };
        found += 1;
        for (band, wanted_rad_s) in bands.iter().zip(truth.dead_band_rad_s) {
            let share = (wanted_rad_s / own.control.compensation_speed_rad_s).min(1.0);
            let signal = wanted_rad_s / own.control.nominal_speed_rad_s + own.control.compensation * share;
            let error = (band.value.unwrap() / signal).ln();
            println!("{}: {:.3} and {signal:.3}", joint.name, band.value.unwrap());
            assert!(error.abs() < 0.25, "{}: {error}", joint.name);
        }
    }
    assert!(found >= 4, "{found}");
}
