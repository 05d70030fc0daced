//! What fits find against what is there.

use hydrotrace::{
    arm::Arm,
    fit::{Estimated, JointFit},
    plant::{JointTruth, Parameters, Plant},
    series::{Series, Track},
};

use super::machine::{Job, fitted, run};

/// One quantity over many joints. Errors are logarithms of found by true.
#[derive(Default)]
pub(crate) struct Column {
    pub(crate) joints: usize,
    /// Of identified numbers.
    pub(crate) errors: Vec<f64>,
    /// Identified numbers whose interval holds the truth.
    pub(crate) covered: usize,
    /// Of numbers that the data do not decide.
    pub(crate) guesses: Vec<f64>,
    /// Joints whose truth lies outside a bound.
    pub(crate) refuted: usize,
}

impl Column {
    pub(crate) fn add(&mut self, found: &Estimated, truth: f64) {
        self.joints += 1;
        let refuted = found.lower_bound.is_some_and(|bound| bound > truth)
            || found.upper_bound.is_some_and(|bound| bound < truth);
        self.refuted += usize::from(refuted);
        let error = found.value.map(|value| (value / truth).ln());
        if found.identified {
            let [low, high] = found.interval.unwrap();
            self.errors.push(error.unwrap());
            self.covered += usize::from((low..=high).contains(&truth));
        } else {
            self.guesses.extend(error);
        }
    }

    pub(crate) fn median_error(&self) -> f64 {
        median_size(&self.errors)
    }

    /// Share of the identified numbers whose interval holds the truth.
    pub(crate) fn coverage(&self) -> f64 {
        self.covered as f64 / self.errors.len() as f64
    }
}

pub(crate) fn median_size(errors: &[f64]) -> f64 {
    let mut sorted: Vec<f64> = errors.iter().map(|e| e.abs()).collect();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}

pub(crate) type Pick = fn(&JointFit) -> &Estimated;

pub(crate) type Truth = fn(&JointTruth) -> f64;

/// Quantities with their truth. Gains and dead band of the model have the plant's gain in them.
pub(crate) const QUANTITIES: [(&str, Pick, Truth); 11] = [
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

pub(crate) fn gain(truth: &JointTruth) -> f64 {
    (truth.gain[0] * truth.gain[1]).sqrt()
}

/// Amid the angles of each joint, where a fit's gains hold.
pub(crate) fn middle_rad(plan: &Series) -> Vec<f64> {
    let middle = |track: &Track| {
        let angles = track.position().iter().copied();
        0.5 * (angles.clone().fold(f64::INFINITY, f64::min) + angles.fold(f64::NEG_INFINITY, f64::max))
    };
    plan.tracks.iter().map(middle).collect()
}

/// Fits to one run of each of many machines, by quantity; with the skills. Every other joint of a
/// machine is fitted, the rest of the next one: joints are fitted one by one.
pub(crate) fn recover(seeds: std::ops::Range<u64>, job: &Job) -> (Vec<Column>, Vec<f64>) {
    let base = Parameters::preset("default").unwrap();
    let mut columns: Vec<Column> = QUANTITIES.iter().map(|_| Column::default()).collect();
    let (mut skills, mut late) = (Vec::new(), 0);
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
            late += usize::from(joint.set_values_late_s.identified);
            let truth = truth.joints.iter().find(|truth| truth.name == joint.name).unwrap();
            skills.push(joint.held_out_r2);
            for (column, (_, found, truth_of)) in columns.iter_mut().zip(QUANTITIES) {
                column.add(found(joint), truth_of(truth));
            }
        }
    }
    // Their set values are prompt.
    assert!(
        100 * late <= skills.len(),
        "set values of {late} of {} joints are said to be late",
        skills.len()
    );
    (columns, skills)
}

pub(crate) fn is_limit(name: &str) -> bool {
    name.starts_with("speed") || name.starts_with("acceleration")
}
