//! `detector`: precision and recall of starts, and errors of onsets, on synthetic joints with known motions.

mod synthetic;

use hydrotrace::{
    document::{PROGRAM, pretty},
    math::{SIGMA_PER_MAD, mad, median},
    render::kit::{Document, Id, NONE, Section, Sentence, Table, ms},
    replay::{Rules, measured_starts, measured_stops, replay},
    units::{DEGREE_RAD, degrees_from_radians},
};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::study::finite;
pub use synthetic::{Sensing, SyntheticRun, TrueMotion, synthetic_run};

/// A start counts as found if one of the same direction is detected this near, s.
const NEAR_S: f64 = 0.5;

/// Errors of one kind of onset or delay.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Spread {
    /// Median of found minus true, s; NaN of none.
    #[serde(deserialize_with = "finite")]
    #[cfg_attr(test, schemars(with = "Option<f64>"))]
    pub median_s: f64,
    /// Median absolute deviation, scaled to a standard deviation, s; NaN of none.
    #[serde(deserialize_with = "finite")]
    #[cfg_attr(test, schemars(with = "Option<f64>"))]
    pub mad_sd_s: f64,
    /// Number of cases.
    pub count: usize,
}

/// The detector under one condition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Score {
    /// The condition.
    pub sensing: Sensing,
    /// Number of runs of a minute.
    pub runs: u64,
    /// True starts, reversals included.
    pub starts: usize,
    /// Share of detected starts that are true.
    #[serde(deserialize_with = "finite")]
    #[cfg_attr(test, schemars(with = "Option<f64>"))]
    pub precision: f64,
    /// Share of true starts that are detected.
    #[serde(deserialize_with = "finite")]
    #[cfg_attr(test, schemars(with = "Option<f64>"))]
    pub recall: f64,
    /// Measured onsets of sharp starts from rest.
    pub onset_sharp: Spread,
    /// Measured onsets of smooth starts from rest.
    pub onset_smooth: Spread,
    /// Measured onsets of reversals.
    pub onset_reversal: Spread,
    /// Onset delays of sharp starts.
    pub delay_sharp: Spread,
    /// Onset delays of smooth starts.
    pub delay_smooth: Spread,
    /// Onset delays of reversals.
    pub delay_reversal: Spread,
    /// Share of delays whose interval holds the true one.
    #[serde(deserialize_with = "finite")]
    #[cfg_attr(test, schemars(with = "Option<f64>"))]
    pub delay_coverage: f64,
    /// Share of detected stops that are true.
    #[serde(deserialize_with = "finite")]
    #[cfg_attr(test, schemars(with = "Option<f64>"))]
    pub stop_precision: f64,
    /// Share of true stops that are detected.
    #[serde(deserialize_with = "finite")]
    #[cfg_attr(test, schemars(with = "Option<f64>"))]
    pub stop_recall: f64,
}

/// What was found, and the document of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Detector {
    /// Always [`FORMAT`].
    pub format: String,
    /// Name and version of the program that wrote it.
    pub program: String,
    /// Seed of the first run.
    pub seed: u64,
    /// By condition.
    pub rows: Vec<Score>,
}

/// Format of the document.
pub const FORMAT: &str = "hydrotrace.detector.v1";

/// Scores the detector under every condition on `runs` minutes each; calls `done` after each.
pub fn run(seed: u64, runs: u64, done: impl Fn() + Sync) -> Detector {
    let score = |sensing: &Sensing| {
        let score = detector_score(seed, runs, sensing, &Rules::default());
        done();
        score
    };
    let rows = conditions().par_iter().map(score).collect();
    Detector { format: FORMAT.to_owned(), program: PROGRAM.to_owned(), seed, rows }
}

impl Detector {
    /// As JSON.
    pub fn json(&self) -> String {
        pretty(self)
    }

    /// As a table.
    pub fn document(&self) -> Document {
        let spread = |s: &Spread| format!("{} +-{}", ms(s.median_s), ms(s.mad_sd_s));
        let rows = self.rows.iter().map(|s| {
            vec![
                format!("{:.3}", degrees_from_radians(s.sensing.sigma_rad)),
                s.sensing.lsb_rad.map_or(NONE.to_owned(), |lsb| format!("{:.2}", degrees_from_radians(lsb))),
                format!("{:.0}", s.sensing.rate_hz),
                s.runs.to_string(),
                s.starts.to_string(),
                format!("{:.3}", s.precision),
                format!("{:.3}", s.recall),
                spread(&s.onset_sharp),
                spread(&s.onset_smooth),
                spread(&s.delay_sharp),
                spread(&s.delay_smooth),
                format!("{:.2}", s.delay_coverage),
                format!("{:.2}", s.stop_precision),
                format!("{:.2}", s.stop_recall),
            ]
        });
        let numbers = [
            "noise deg", "LSB deg", "Hz", "runs", "starts", "precision", "recall", "sharp ms", "smooth ms",
            "delay sharp ms", "delay smooth ms", "coverage", "stop P", "stop R",
        ];
        let found = format!(
            "Starts found on synthetic joints with known motions, seed {}. Errors of the onset and of the delay: \
             median +- robust standard deviation; coverage is the share of delays inside their 95 % interval.",
            self.seed
        );
        let section = Section::plain(Id::SUMMARY, [Sentence::note(found)]);
        Document::default().with(section.with(Table::new(&[], &numbers, rows)))
    }
}

/// The conditions of the table in the documentation.
pub fn conditions() -> Vec<Sensing> {
    let base = Sensing::default();
    let noise = [0.002, 0.005, 0.01, 0.02, 0.05, 0.1];
    let mut conditions: Vec<Sensing> =
        noise.iter().map(|sigma| Sensing { sigma_rad: sigma * DEGREE_RAD, ..base }).collect();
    conditions.extend([20.0, 50.0, 200.0, 1000.0].map(|rate_hz| Sensing { rate_hz, ..base }));
    conditions.extend([0.05, 0.1].map(|lsb| Sensing { lsb_rad: Some(lsb * DEGREE_RAD), ..base }));
    conditions
}

/// Runs the detector on `runs` synthetic minutes with seeds `seed`, `seed + 1`, ...
pub fn detector_score(seed: u64, runs: u64, sensing: &Sensing, rules: &Rules) -> Score {
    let found: Vec<Tally> =
        (0..runs).into_par_iter().map(|k| Tally::of(seed.wrapping_add(k), sensing, rules)).collect();
    let mut all = Tally::default();
    for one in found {
        all.add(one);
    }
    let share = |a: usize, b: usize| if b > 0 { a as f64 / b as f64 } else { f64::NAN };
    let [onset_sharp, onset_smooth, onset_reversal] = all.onset_s.map(|errors| spread(&errors));
    let [delay_sharp, delay_smooth, delay_reversal] = all.delay_s.map(|errors| spread(&errors));
    Score {
        sensing: *sensing,
        runs,
        starts: all.starts.truth,
        precision: share(all.starts.hits, all.starts.found),
        recall: share(all.starts.hits, all.starts.truth),
        onset_sharp,
        onset_smooth,
        onset_reversal,
        delay_sharp,
        delay_smooth,
        delay_reversal,
        delay_coverage: share(all.covered, all.intervals),
        stop_precision: share(all.stops.hits, all.stops.found),
        stop_recall: share(all.stops.hits, all.stops.truth),
    }
}

fn spread(errors: &[f64]) -> Spread {
    Spread { median_s: median(errors.to_vec()), mad_sd_s: SIGMA_PER_MAD * mad(errors), count: errors.len() }
}

#[derive(Default)]
struct Count {
    truth: usize,
    found: usize,
    hits: usize,
}

impl Count {
    fn add(&mut self, other: &Count) {
        self.truth += other.truth;
        self.found += other.found;
        self.hits += other.hits;
    }
}

/// Sharp, smooth and reversal errors in this order.
#[derive(Default)]
struct Tally {
    starts: Count,
    stops: Count,
    onset_s: [Vec<f64>; 3],
    delay_s: [Vec<f64>; 3],
    intervals: usize,
    covered: usize,
}

impl Tally {
    fn of(seed: u64, sensing: &Sensing, rules: &Rules) -> Self {
        let mut tally = Self::default();
        let run = synthetic_run(seed, sensing);
        let starts = measured_starts(&run.pair, rules);
        let truth: Vec<(i8, f64)> =
            run.motions.iter().map(|m| (m.direction, m.start_s + sensing.delay_s)).collect();
        let pairs = assign(&truth, &starts);
        tally.starts = Count { truth: truth.len(), found: starts.len(), hits: pairs.len() };
        for (true_k, found_k) in pairs {
            tally.onset_s[kind(&run.motions[true_k])].push(starts[found_k].1 - truth[true_k].1);
        }

        let stops = measured_stops(&run.pair, rules);
        let truth: Vec<(i8, f64)> = run
            .motions
            .iter()
            .filter(|m| !m.reversed)
            .map(|m| (m.direction, m.end_s + sensing.delay_s))
            .collect();
        tally.stops = Count { truth: truth.len(), found: stops.len(), hits: assign(&truth, &stops).len() };

        let found = replay(std::slice::from_ref(&run.pair), rules).transitions;
        let planned: Vec<(i8, f64)> = found.iter().map(|t| (t.direction, t.planned_onset_s)).collect();
        let truth: Vec<(i8, f64)> = run.motions.iter().map(|m| (m.direction, m.start_s)).collect();
        for (true_k, found_k) in assign(&truth, &planned) {
            let transition = &found[found_k];
            if let (Some(delay_s), Some([low_s, high_s])) =
                (transition.onset_delay_s, transition.onset_delay_interval_s)
            {
                tally.delay_s[kind(&run.motions[true_k])].push(delay_s - sensing.delay_s);
                tally.intervals += 1;
                tally.covered += usize::from((low_s..=high_s).contains(&sensing.delay_s));
            }
        }
        tally
    }

    fn add(&mut self, mut other: Self) {
        self.starts.add(&other.starts);
        self.stops.add(&other.stops);
        for k in 0..3 {
            self.onset_s[k].append(&mut other.onset_s[k]);
            self.delay_s[k].append(&mut other.delay_s[k]);
        }
        self.intervals += other.intervals;
        self.covered += other.covered;
    }
}

fn kind(motion: &TrueMotion) -> usize {
    if motion.reversal { 2 } else { usize::from(!motion.sharp) }
}

/// Pairs each true event with the nearest unused found one of its direction.
fn assign(truth: &[(i8, f64)], found: &[(i8, f64)]) -> Vec<(usize, usize)> {
    let mut used = vec![false; found.len()];
    let mut pairs = Vec::new();
    for (k, &(direction, at_s)) in truth.iter().enumerate() {
        let off_s = |i: &usize| (found[*i].1 - at_s).abs();
        let nearest = (0..found.len())
            .filter(|&i| !used[i] && found[i].0 == direction && off_s(&i) <= NEAR_S)
            .min_by(|a, b| off_s(a).total_cmp(&off_s(b)));
        if let Some(i) = nearest {
            used[i] = true;
            pairs.push((k, i));
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_committed_schema_is_that_of_the_document() {
        crate::schema::is_committed::<super::Detector>("detector.v1.schema.json", "Detector");
    }
}
