//! Each preset with a structure of its own shows it, and the default machine does not.

use hydrotrace::{
    plant::{JointRecord, Plant, Record, simulate},
    series::Series,
    units::DEGREE_RAD,
};

use crate::support::machine::{POSE_DEG, command, ideal, plant};

/// Rest, a ramp of `way_s` at a speed from 1 s on, and rest to the end, for every joint; the ramp starts and ends
/// within 0.2 s.
fn ramp(speed_deg_s: f64, way_s: f64, duration_s: f64) -> Series {
    let rise_s = 0.2;
    command(duration_s, |j, t| {
        let part = |since: f64| {
            let since = since.clamp(0.0, rise_s);
            0.5 * since * since / rise_s
        };
        let after = |start: f64| part(t - start) + (t - start - rise_s).max(0.0);
        let speed = ((t - 1.0) / rise_s).clamp(0.0, 1.0) - ((t - 1.0 - way_s) / rise_s).clamp(0.0, 1.0);
        (POSE_DEG[j] + speed_deg_s * (after(1.0) - after(1.0 + way_s)), speed_deg_s * speed)
    })
}

fn quiet(preset: &str) -> Plant {
    plant(preset, ideal)
}

fn run(plant: &Plant, command: &Series) -> Record {
    simulate(plant, command, &[], 1).unwrap()
}

/// Command less true angle, degrees.
fn errors_deg(command: &Series, record: &Record, joint: usize) -> Vec<f64> {
    let planned = command.tracks[joint].position();
    planned.iter().zip(&record.joints[joint].true_rad).map(|(p, q)| (p - q) / DEGREE_RAD).collect()
}

fn spread(values: &[f64]) -> f64 {
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    most - values.iter().copied().fold(f64::INFINITY, f64::min)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Frequency of the swing, Hz, in samples at 100 Hz: the mean taken off, crossings counted.
fn swing_hz(values: &[f64]) -> f64 {
    let mean = mean(values);
    let crossings = values.windows(2).filter(|pair| (pair[0] > mean) != (pair[1] > mean)).count();
    0.5 * crossings as f64 / (values.len() as f64 * 0.01)
}

/// Errors from `from_s` on after the ramp to 4 degrees a second, which ends at 3.2 s, by joint.
fn errors_from(preset: &str, from_s: f64, duration_s: f64) -> Vec<Vec<f64>> {
    let command = ramp(4.0, 2.0, duration_s);
    let record = run(&quiet(preset), &command);
    let from = (from_s * 100.0).round() as usize;
    (0..6).map(|j| errors_deg(&command, &record, j).split_off(from)).collect()
}

fn most(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| value.abs().max(most))
}

#[test]
fn a_cascade_and_an_integral_behind_stiction_hunt_at_rest() {
    for (preset, from_s, least_deg) in [("cascade", 15.0, 0.09), ("stick-slip", 15.0, 0.08)] {
        let hunting = errors_from(preset, from_s, 60.0);
        let quiet = errors_from("default", from_s, 60.0);
        for j in [0, 1, 3] {
            let spreads = [spread(&hunting[j]), spread(&quiet[j])];
            println!("{preset} J{}: {spreads:.3?} deg", j + 1);
            assert!(spreads[0] > least_deg && spreads[1] < 0.02, "{preset} J{}: {spreads:?} deg", j + 1);
        }
    }
}

/// Swings of the seen speeds within 3 s of the end of the ramp, Hz, by joint, and their largest, deg/s.
fn swings(preset: &str) -> Vec<(f64, f64)> {
    let record = run(&quiet(preset), &ramp(4.0, 2.0, 8.0));
    let of = |joint: &JointRecord| {
        let speeds = &joint.true_rad_s[340..640];
        (swing_hz(speeds), spread(speeds) / DEGREE_RAD)
    };
    record.joints.iter().map(of).collect()
}

#[test]
fn long_hoses_swing_near_1_hz_after_a_stop() {
    let (soft, stiff) = (swings("soft"), swings("default"));
    println!("{soft:.2?} {stiff:.2?}");
    for j in [1, 3, 4, 5] {
        assert!((0.6..1.4).contains(&soft[j].0), "J{}: {soft:?}", j + 1);
        assert!(soft[j].1 > 2.0 * stiff[j].1, "J{}: {soft:?} {stiff:?}", j + 1);
    }
}

#[test]
fn links_that_bend_swing_at_their_own_frequencies() {
    let found = swings("flexible-link");
    let plant = quiet("flexible-link");
    println!("{found:.2?}");
    for j in [0, 1, 2] {
        let own_hz = plant.parameters().joints[j].link.frequency_hz;
        assert!((found[j].0 / own_hz - 1.0).abs() < 0.2, "J{}: {found:?} {own_hz} Hz", j + 1);
    }
}

/// Error at the end of four seconds at a speed, by speed, s, for each joint.
fn lag_s(preset: &str, speed_deg_s: f64) -> Vec<f64> {
    let command = ramp(speed_deg_s, 4.0, 6.0);
    let record = run(&quiet(preset), &command);
    (0..6).map(|j| errors_deg(&command, &record, j)[490] / speed_deg_s).collect()
}

#[test]
fn a_position_loop_alone_lags_in_proportion_to_the_speed() {
    let alone = [2.0, 4.0].map(|speed| lag_s("position-only", speed));
    let forward = lag_s("default", 4.0);
    println!("{alone:.2?} {forward:.2?}");
    for j in 0..6 {
        assert!((alone[1][j] / alone[0][j] - 1.0).abs() < 0.25, "{alone:?}");
        assert!(alone[1][j] > 0.4 && forward[j] < 0.2, "{alone:?} {forward:?}");
    }
}

#[test]
fn a_positioning_window_gives_no_signal_and_beyond_it_the_jump() {
    let plant = quiet("positioning-window");
    let record = run(&plant, &ramp(4.0, 2.0, 20.0));
    for (joint, own) in record.joints.iter().zip(&plant.parameters().joints) {
        let jump = own.control.compensation;
        assert!(joint.valve_command.iter().all(|&u| u.abs() <= 0.0 || u.abs() > jump), "{}", joint.name);
        assert!(joint.valve_command.iter().any(|&u| u.abs() > jump), "{}", joint.name);
        assert!(most(&joint.valve_command[1900..]) <= 0.0, "{}", joint.name);
    }
}

/// Time from the start of the ramp until a joint has moved by 0.1 degrees, s, by joint.
fn onsets_s(preset: &str, speed_deg_s: f64) -> Vec<f64> {
    let record = run(&quiet(preset), &ramp(speed_deg_s, 4.0, 5.0));
    let of = |joint: &JointRecord| {
        let left = |q: &f64| (q - joint.true_rad[100]).abs() > 0.1 * DEGREE_RAD;
        joint.true_rad[100..].iter().position(left).unwrap() as f64 * 0.01
    };
    record.joints.iter().map(of).collect()
}

#[test]
fn progressive_edges_are_the_later_the_slower_the_start() {
    let later_s = |speed: f64| -> Vec<f64> {
        let pairs = onsets_s("progressive-edges", speed).into_iter().zip(onsets_s("default", speed));
        pairs.map(|(edges, default)| edges - default).collect()
    };
    let (slow, fast) = (later_s(0.6), later_s(8.0));
    println!("{slow:.2?} {fast:.2?}");
    assert!(slow.iter().zip(&fast).all(|(slow, fast)| *slow > fast + 0.05), "{slow:?} {fast:?}");
}

#[test]
fn held_set_values_reach_the_valve_in_stairs() {
    let changes = |preset: &str| {
        let plant = plant(preset, |p| {
            ideal(p);
            for joint in &mut p.joints {
                (joint.control.position_gain_1_s, joint.control.integral_gain_1_s2) = (0.0, 0.0);
            }
        });
        let swing = command(6.0, |j, t| (POSE_DEG[j] + 3.0 * t.sin().powi(2), 3.0 * (2.0 * t).sin()));
        let record = run(&plant, &swing);
        record.joints[0].valve_command.windows(2).filter(|pair| pair[0] != pair[1]).count()
    };
    let (held, each) = (changes("held-set-values"), changes("default"));
    assert!(each > 590 && (200..=300).contains(&held), "{held} and {each} of 600");
}

#[test]
fn a_changing_machine_is_another_each_run_and_the_same_for_a_seed() {
    let (machine, command) = (quiet("changing"), ramp(4.0, 2.0, 8.0));
    let [one, again, two] = [1, 1, 2].map(|seed| simulate(&machine, &command, &[], seed).unwrap());
    assert_eq!(one, again);
    let apart = |a: &JointRecord, b: &JointRecord| {
        let off: Vec<f64> = a.true_rad.iter().zip(&b.true_rad).map(|(a, b)| (a - b) / DEGREE_RAD).collect();
        most(&off)
    };
    let found: Vec<f64> = one.joints.iter().zip(&two.joints).map(|(a, b)| apart(a, b)).collect();
    assert!(mean(&found) > 0.15, "{found:?} deg");
}

#[test]
fn backlash_adds_half_of_itself_to_the_error_of_a_start() {
    let peak = |preset: &str| -> Vec<f64> { errors_from(preset, 1.0, 4.0).iter().map(|e| most(e)).collect() };
    for (j, (worn, new)) in peak("backlash").iter().zip(peak("default")).enumerate() {
        assert!((0.15..0.35).contains(&(worn - new)), "J{}: {worn} and {new} deg", j + 1);
    }
}
