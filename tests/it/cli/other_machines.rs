//! `replan` in the loop with machines of another maker: a servo of its own with dead band and lag, seen through tables.

use std::{fmt::Write as _, fs, path::Path};

use serde_json::Value;

use crate::support::{json, run_line, scratch, stderr};

const STEPS: usize = 2600;
const RATE_HZ: f64 = 100.0;
const JOINTS: [&str; 2] = ["boom", "stick"];

fn plan_deg(joint: usize, t_s: f64) -> f64 {
    let move_deg = |from_s: f64, span_s: f64, by_deg: f64| {
        let x = ((t_s - from_s) / span_s).clamp(0.0, 1.0);
        by_deg * x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
    };
    match joint {
        0 => 10.0 + move_deg(3.0, 4.0, 20.0) + move_deg(9.0, 4.0, 15.0) + move_deg(16.0, 5.0, -35.0),
        _ => -40.0 + move_deg(2.5, 3.0, -15.0) + move_deg(9.5, 5.0, 30.0) + move_deg(17.0, 4.0, -15.0),
    }
}

/// What differs from machine to machine.
#[derive(Clone, Copy)]
struct Machine {
    lag_s: f64,
    band_deg: f64,
    /// Where the boom is stopped.
    stop_deg: f64,
    /// How often the sender has a new set value.
    sender_hz: f64,
    /// While the sensor of the stick shows one value, s.
    stands_s: [f64; 2],
    /// How fast what is sent is played from 8 s on.
    pace: f64,
}

const PLAIN: Machine = Machine {
    lag_s: 0.22,
    band_deg: 0.25,
    stop_deg: 90.0,
    sender_hz: RATE_HZ,
    stands_s: [0.0; 2],
    pace: 1.0,
};

type Sent = [Vec<f64>; 2];

impl Machine {
    fn run(&self, sent_deg: &Sent) -> Sent {
        let own = |joint: usize| {
            let (mut at_deg, mut speed) = (plan_deg(joint, 0.0), 0.0_f64);
            let step = |k: usize| {
                let off_deg = sent_deg[joint][k.saturating_sub(6)] - at_deg;
                let open = if off_deg.abs() < self.band_deg {
                    0.0
                } else {
                    off_deg - 0.6 * self.band_deg * off_deg.signum()
                };
                speed += ((open / self.lag_s).clamp(-30.0, 30.0) - speed) * 0.2;
                at_deg += speed / RATE_HZ;
                if joint == 0 && at_deg > self.stop_deg {
                    (at_deg, speed) = (self.stop_deg, speed.min(0.0));
                }
                // An encoder of 14 bits.
                (at_deg / 0.022).round() * 0.022
            };
            (0..STEPS).map(step).collect()
        };
        [own(0), own(1)]
    }

    /// What comes of what is sent where an override holds it back.
    fn played(&self, sent: &Sent) -> Sent {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small number")]
        let at = |k: usize| if k < 800 { k } else { 800 + (self.pace * (k - 800) as f64) as usize };
        sent.each_ref().map(|own| (0..STEPS).map(|k| own[at(k)]).collect())
    }

    /// What a recorder has of where the joints are.
    fn seen(&self, came: &Sent) -> Sent {
        let [from, to] = self.stands_s.map(|t_s| t_s * RATE_HZ);
        let mut seen = came.clone();
        for k in (0..STEPS).filter(|k| (from..to).contains(&(*k as f64))) {
            seen[1][k] = seen[1][k - 1];
        }
        seen
    }

    /// What a table has of what was sent: a value until the next one comes.
    fn held(&self, values: &Sent) -> Sent {
        let every = RATE_HZ / self.sender_hz;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small number")]
        let of = |own: &Vec<f64>| {
            let at = |k: usize| (k as f64 / every).floor() * every;
            let between = |row: f64| {
                let (k, share) = (row as usize, row.fract());
                own[k] + share * (own[(k + 1).min(STEPS - 1)] - own[k])
            };
            (0..STEPS).map(|k| between(at(k))).collect()
        };
        [of(&values[0]), of(&values[1])]
    }
}

fn planned() -> Sent {
    [0, 1].map(|joint| (0..STEPS).map(|k| plan_deg(joint, k as f64 / RATE_HZ)).collect())
}

/// A run of what was sent, as a table; its mean distance from the plan, deg.
fn drive(folder: &Path, number: usize, machine: &Machine, sent: &Sent) -> f64 {
    let (plan, sent) = (machine.held(&planned()), machine.played(&machine.held(sent)));
    let came = machine.run(&sent);
    let seen = machine.seen(&came);
    let mut table = "time_s".to_owned();
    for of in ["set", "cmd", "act"] {
        JOINTS.iter().for_each(|joint| write!(table, ",{joint}_{of}_deg").unwrap());
    }
    for k in 0..STEPS {
        write!(table, "\n{:.2}", (number * 86_400) as f64 + 1_772_000_000.0 + k as f64 / RATE_HZ).unwrap();
        [&plan, &sent, &seen]
            .iter()
            .for_each(|all| all.iter().for_each(|own| write!(table, ",{:.6}", own[k]).unwrap()));
    }
    fs::write(folder.join(format!("run-{number}.csv")), table).unwrap();
    let off = |joint: usize, k: usize| (came[joint][k] - plan_deg(joint, k as f64 / RATE_HZ)).abs();
    (0..2).flat_map(|joint| (0..STEPS).map(move |k| off(joint, k))).sum::<f64>() / (2 * STEPS) as f64
}

/// The next command after runs that are numbered from 1 on, and what was said of it.
fn next(folder: &Path, runs: usize) -> (Sent, Value) {
    let logs: Vec<String> = (1..=runs).map(|run| format!("run-{run}.csv")).collect();
    let said = json(folder, &format!("replan {} --keep-plan -o next.mcap --force", logs.join(" ")));
    let run = run_line(folder, "export next.mcap -o next.csv --force");
    assert!(matches!(run.status.code(), Some(0 | 3)), "{}", stderr(&run));
    let text = fs::read_to_string(folder.join("next.csv")).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()).collect();
    let column = |name: &str| header.iter().position(|own| *own == name).unwrap();
    // The log begins before the first motion; what is sent goes by the clock of the plan.
    let stick = column("stick_planned_rad");
    let begins = |of: &dyn Fn(usize) -> f64, count: usize| {
        (0..count).position(|k| (of(k) + 40.0).abs() > 0.05).unwrap()
    };
    let plan = planned();
    let own = begins(&|k| rows[k][stick].to_degrees(), rows.len());
    let ahead = begins(&|k| plan[1][k], STEPS) - own;
    let sent = JOINTS.map(|joint| {
        let (command, last) = (column(&format!("{joint}_command_rad")), rows.len() - 1);
        (0..STEPS).map(|k| rows[k.saturating_sub(ahead).min(last)][command].to_degrees()).collect()
    });
    (sent, said)
}

/// Largest acceleration of samples, deg/s².
fn sharpest(sent: &Sent) -> f64 {
    let bend = |own: &[f64]| (own[2] - 2.0 * own[1] + own[0]).abs() * RATE_HZ * RATE_HZ;
    sent.iter().flat_map(|own| own.windows(3).map(bend)).fold(0.0, f64::max)
}

/// Runs that learn, one after the other, of a machine each; their errors, deg, the last command and what was said of each.
fn learn(machines: &[Machine]) -> (Vec<f64>, Sent, Vec<Value>) {
    let folder = scratch();
    let (mut sent, mut errors, mut said) = (planned(), Vec::new(), Vec::new());
    for (k, machine) in machines.iter().enumerate() {
        errors.push(drive(folder.path(), k + 1, machine, &sent));
        let (next, document) = next(folder.path(), k + 1);
        sent = next;
        said.push(document);
    }
    (errors, sent, said)
}

fn remarks(said: &Value, words: &str) -> bool {
    said["remarks"].to_string().contains(words)
}

#[test]
fn a_joint_that_is_stopped_before_its_plan_ends_is_named_and_pushed_no_further() {
    let stopped = Machine { stop_deg: 43.0, ..PLAIN };
    let (errors, sent, said) = learn(&[stopped; 4]);
    assert!(
        said[1..].iter().all(|said| remarks(said, "boom comes to 43.01 deg and no farther")),
        "{}",
        said[1]["remarks"]
    );
    assert!(!remarks(&said[0], "no farther") && !said.iter().any(|said| remarks(said, "stick comes to")));
    let ratio = sharpest(&sent) / sharpest(&planned());
    assert!(ratio < 2.0, "{ratio} times the acceleration");
    let most_deg = sent[0].iter().copied().fold(f64::NEG_INFINITY, f64::max);
    assert!(most_deg < 45.1, "a plan to 45 deg is sent to {most_deg} deg");
    assert!(errors[2] < 0.5 * errors[0] && errors[3] < 1.05 * errors[2], "{errors:?}");
    // What is promised counts the stop.
    let expected = said[3]["after"]["mean_peak_rad"].as_f64().unwrap();
    let last = said[3]["before"]["measured_mean_peak_rad"].as_f64().unwrap();
    assert!((0.8..1.25).contains(&(expected / last)), "{expected} of {last}");
}

#[test]
fn a_machine_that_goes_on_changing_one_way_is_followed_and_sent_no_older_command() {
    let by = |share: f64| Machine { lag_s: PLAIN.lag_s * share, band_deg: PLAIN.band_deg * share, ..PLAIN };
    let (errors, _, said) = learn(&[1.0, 1.08, 1.16, 1.24, 1.32].map(by));
    let decisions: Vec<&Value> = said.iter().map(|said| &said["decision"]["what"]).collect();
    assert!(
        decisions[2..].iter().all(|what| **what == "send"),
        "{decisions:?} {errors:?} {}",
        said[2]["remarks"]
    );
    assert!(remarks(&said[3], "goes on changing one way"), "{}", said[3]["remarks"]);
    // Each run is behind by what the machine changed since the one before, not by more.
    assert!(errors[4] < 1.3 * errors[2] && errors[4] < 0.2 * errors[0], "{errors:?}");
    let (_, _, said) = learn(&[PLAIN; 4]);
    assert!(!said.iter().any(|said| remarks(said, "goes on changing")), "it does not");
}

#[test]
fn what_undoes_all_that_a_command_gained_teaches_nothing_once_and_a_command_twice() {
    let slow = Machine { lag_s: 2.8 * PLAIN.lag_s, ..PLAIN };
    let why = |said: &Value| said["decision"]["because"]["why"].as_str().map(str::to_owned);
    let (errors, _, said) = learn(&[PLAIN, PLAIN, slow, PLAIN, PLAIN]);
    assert_eq!(why(&said[2]).as_deref(), Some("undone"), "{} {errors:?}", said[2]["decision"]);
    assert!(
        errors[3..].iter().all(|error| *error < 1.02 * errors[1]),
        "what was good is sent again: {errors:?}"
    );
    // Runs that are equal to the last digit would be one, given twice.
    let slower = |by: f64| Machine { lag_s: by * slow.lag_s, ..slow };
    let (errors, _, said) = learn(&[PLAIN, PLAIN, slow, slower(1.01), slower(0.99)]);
    assert!(
        said[3]["decision"]["what"] == "send" && errors[4] < 0.5 * errors[3],
        "{errors:?} {}",
        said[3]["decision"]
    );
}

#[test]
fn nothing_is_learnt_of_a_run_that_an_override_held_back() {
    let held = Machine { pace: 0.8, ..PLAIN };
    let (errors, _, said) = learn(&[PLAIN, PLAIN, held, PLAIN, PLAIN]);
    assert!(remarks(&said[2], "what was sent came after its plan"), "{}", said[2]["remarks"]);
    assert!(errors[2] > 5.0 * errors[1] && errors[3] < errors[1] && errors[4] < errors[1], "{errors:?}");
}

#[test]
fn nothing_is_learnt_of_a_sensor_that_stood() {
    let stood = Machine { stands_s: [11.0, 13.0], ..PLAIN };
    for machines in [&[PLAIN, PLAIN, stood, PLAIN][..], &[stood, PLAIN]] {
        let (errors, _, said) = learn(machines);
        let of = machines.len() - 2;
        assert!(remarks(&said[of], "what the sensor of stick repeats"), "{}", said[of]["remarks"]);
        assert!(!remarks(&said[of], "has changed"), "{}", said[of]["remarks"]);
        // The command that it led to.
        assert!(errors[of + 1] < 1.2 * errors[of].min(0.25 * errors[0]), "{errors:?}");
    }
}

#[test]
fn a_machine_that_comes_in_two_kinds_is_promised_the_worse_of_both() {
    let loaded = Machine { lag_s: 1.4 * PLAIN.lag_s, band_deg: 1.6 * PLAIN.band_deg, ..PLAIN };
    let (errors, _, said) = learn(&[PLAIN, loaded, PLAIN, loaded, PLAIN, loaded]);
    let kept = said.windows(2).skip(2).filter(|pair| {
        let most = pair[0]["after"]["mean_peak_margin_rad"].as_f64().unwrap();
        pair[1]["before"]["measured_mean_peak_rad"].as_f64().unwrap() < most
    });
    let kept = kept.count();
    assert!(kept >= 2, "{kept} of 3 promises kept: {errors:?}");
}

#[test]
fn what_a_sender_of_another_clock_holds_is_sent_as_smoothly_as_it_was_planned() {
    let plain = sharpest(&planned());
    for sender_hz in [30.0, 47.0] {
        let (errors, sent, _) = learn(&[Machine { sender_hz, ..PLAIN }; 2]);
        let sharpest = sharpest(&sent);
        assert!(sharpest < 1.5 * plain, "{sender_hz} Hz: {sharpest} deg/s2 of {plain}");
        assert!(errors[1] < 0.2 * errors[0], "{errors:?}");
    }
}
