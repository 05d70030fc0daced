//! The detector against the truth of the hydraulic arm: starts of the angle without noise.

use hydrotrace::{
    plant::{JointRecord, PayloadChange, Record, simulate},
    replay::{Rules, Sizes, measured_starts, planned_starts},
    series::{Series, Track},
    units::DEGREE_RAD,
};

use super::machine::{pairs, paper_plan as plan, plant};

// Whether a start is one depends on its thresholds even in the truth, which is the detector's own state
// machine on the speed without noise. Spread: median distance from the median, scaled to a deviation.

/// A start counts as found if one of the same direction is detected this near, s.
pub(crate) const NEAR_S: f64 = 0.5;

/// How far into a motion its direction is looked up, s.
pub(crate) const INTO_S: f64 = 0.05;

/// Of the true starts that must be found the joint travels on for so long, rad: twice what counts as a
/// motion. Stick-slip while a joint creeps home hovers about the thresholds, and whether it counts as a
/// start is chance.
pub(crate) const TRAVEL_RAD: f64 = 0.1 * DEGREE_RAD;

/// Starts of some runs: true ones, those of them with the travel above, detected ones, true ones that
/// were detected, those with travel, and how much later these were detected, s.
#[derive(Default)]
pub(crate) struct Tally {
    pub(crate) real: usize,
    pub(crate) far: usize,
    pub(crate) found: usize,
    pub(crate) far_found: usize,
    pub(crate) late_s: Vec<f64>,
}

impl Tally {
    pub(crate) fn precision(&self) -> f64 {
        self.late_s.len() as f64 / self.found as f64
    }

    pub(crate) fn recall(&self) -> f64 {
        self.late_s.len() as f64 / self.real as f64
    }

    pub(crate) fn far_recall(&self) -> f64 {
        self.far_found as f64 / self.far as f64
    }

    /// Median, and median distance from it scaled to a standard deviation, s.
    pub(crate) fn onset_s(&self) -> (f64, f64) {
        let middle = |mut values: Vec<f64>| {
            values.sort_by(f64::total_cmp);
            values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
        };
        let median_s = middle(self.late_s.clone());
        (median_s, 1.4826 * middle(self.late_s.iter().map(|late| (late - median_s).abs()).collect()))
    }

    pub(crate) fn add(&mut self, other: Tally) {
        self.real += other.real;
        self.far += other.far;
        self.found += other.found;
        self.far_found += other.far_found;
        self.late_s.extend(other.late_s);
    }

    pub(crate) fn run(&mut self, planned: &Series, record: &Record) {
        let rules = Rules::default();
        for (pair, joint) in pairs(planned, record).iter().zip(&record.joints) {
            let found = measured_starts(pair, &rules);
            let late_s = late_s(&real_starts(record, joint, &rules), &found);
            self.real += late_s.len();
            self.found += found.len();
            self.late_s.extend(late_s.into_iter().flatten());
            let far = Rules { turning: Sizes { min_travel: TRAVEL_RAD, ..rules.turning }, ..rules.clone() };
            let late_s = self::late_s(&real_starts(record, joint, &far), &found);
            self.far += late_s.len();
            self.far_found += late_s.iter().flatten().count();
        }
    }
}

/// How much later each true start was detected, s; each detection counts once.
pub(crate) fn late_s(real: &[(i8, f64)], found: &[(i8, f64)]) -> Vec<Option<f64>> {
    let mut left = found.to_vec();
    let late_s = real.iter().map(|&(direction, at_s)| {
        let off_s = |i: usize| (left[i].1 - at_s).abs();
        let near = (0..left.len()).filter(|&i| left[i].0 == direction && off_s(i) <= NEAR_S);
        let nearest = near.min_by(|&a, &b| off_s(a).total_cmp(&off_s(b)))?;
        Some(left.swap_remove(nearest).1 - at_s)
    });
    late_s.collect()
}

/// Directions and onsets, s, by the detector's state machine on the speed of the encoder without noise.
pub(crate) fn real_starts(record: &Record, joint: &JointRecord, rules: &Rules) -> Vec<(i8, f64)> {
    let track = Track::new(&joint.name, record.t_s.clone(), joint.true_rad.clone(), &[]).unwrap();
    let track = track.with_velocity(joint.true_rad_s.clone()).unwrap();
    let angle_rad = |at_s: f64| track.held_at(at_s).position;
    let direction = |at_s: f64| if angle_rad(at_s + INTO_S) > angle_rad(at_s) { 1 } else { -1 };
    planned_starts(&track, rules).into_iter().map(|at_s| (direction(at_s), at_s)).collect()
}

/// Runs of a task on a preset with encoders of that noise.
pub(crate) fn runs(
    preset: &str,
    (planned, payload): &(Series, Vec<PayloadChange>),
    noise_deg: f64,
    seeds: u64,
) -> Tally {
    let plant = plant(preset, |p| {
        p.joints.iter_mut().for_each(|joint| joint.encoder.noise_rad = noise_deg * DEGREE_RAD);
    });
    let mut tally = Tally::default();
    for seed in 1..=seeds {
        tally.run(planned, &simulate(&plant, planned, payload, seed).unwrap());
    }
    tally
}

pub(crate) const PRESETS: [&str; 3] = ["dead-band-limited", "default", "lag-limited"];

/// What is asked of the detector at some noise of the encoder.
pub(crate) struct Bar {
    pub(crate) noise_deg: f64,
    pub(crate) precision: f64,
    pub(crate) recall: f64,
    pub(crate) far_recall: f64,
    pub(crate) median_s: f64,
    pub(crate) spread_s: f64,
}

pub(crate) const BARS: [Bar; 3] = [
    Bar {
        noise_deg: 0.010,
        precision: 0.88,
        recall: 0.82,
        far_recall: 0.945,
        median_s: 0.035,
        spread_s: 0.035,
    },
    Bar {
        noise_deg: 0.020,
        precision: 0.87,
        recall: 0.78,
        far_recall: 0.89,
        median_s: 0.045,
        spread_s: 0.042,
    },
    Bar {
        noise_deg: 0.050,
        precision: 0.87,
        recall: 0.72,
        far_recall: 0.79,
        median_s: 0.065,
        spread_s: 0.065,
    },
];

pub(crate) fn hold(bar: &Bar, tally: &Tally) {
    let (median_s, spread_s) = tally.onset_s();
    let title = bar.noise_deg;
    assert!(tally.precision() >= bar.precision, "{title}: {}", tally.precision());
    assert!(tally.recall() >= bar.recall, "{title}: {}", tally.recall());
    assert!(tally.far_recall() >= bar.far_recall, "{title}: {}", tally.far_recall());
    assert!(median_s.abs() <= bar.median_s, "{title}: {median_s}");
    assert!(spread_s <= bar.spread_s, "{title}: {spread_s}");
}

/// Each preset on each task.
pub(crate) fn all_runs(noise_deg: f64, seeds: u64, show: bool) -> Tally {
    let mut all = Tally::default();
    for preset in PRESETS {
        for task in 0..2 {
            let tally = runs(preset, &plan(task, 1.0), noise_deg, seeds);
            if show {
                print(&format!("{noise_deg:.3} deg, {preset}, task {}", task + 1), &tally);
            }
            all.add(tally);
        }
    }
    print(&format!("{noise_deg:.3} deg, all"), &all);
    all
}

pub(crate) fn print(title: &str, tally: &Tally) {
    let (median_s, spread_s) = tally.onset_s();
    println!(
        "{title}: {} starts, precision {:.3}, recall {:.3}, of {} that go on {:.3}, onset {:+.0} ms, spread {:.0} ms",
        tally.real,
        tally.precision(),
        tally.recall(),
        tally.far,
        tally.far_recall(),
        1e3 * median_s,
        1e3 * spread_s,
    );
}
