//! Peak errors of the starts of a run, and their mean without one that came by chance.

use std::collections::BTreeMap;

use crate::{
    log::Recording,
    replay::{Replay, Rules, replay},
    units::DEGREE_RAD,
};

/// A start belongs to a plan that begins or ends at most by this before or after it, s.
const NEAR_S: f64 = 0.2;

/// A replay with the transitions alone of what a log has of a plan between two instants, s: what else it holds, before or after, says
/// nothing of it.
pub(super) fn of_plan(recording: &Recording, [from_s, to_s]: [f64; 2], rules: &Rules) -> Replay {
    let mut found = replay(&recording.pairs(), rules);
    found.transitions.retain(|start| (from_s - NEAR_S..=to_s + NEAR_S).contains(&start.planned_onset_s));
    found
}

/// A peak stands alone that is above the next largest of its joint by this factor, and by this, rad, in a joint of so many starts, and that
/// no other run has by this share.
const BEYOND: f64 = 2.5;
const BEYOND_RAD: f64 = 0.5 * DEGREE_RAD;
const LEAST: usize = 3;
const AGAIN: f64 = 0.5;

/// By joint, in the order of its starts, rad.
pub(super) struct Peaks(BTreeMap<String, Vec<f64>>);

impl Peaks {
    pub(super) fn of(replay: &Replay) -> Self {
        let mut peaks: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        for start in &replay.transitions {
            peaks.entry(start.joint.clone()).or_default().push(start.peak_error);
        }
        Self(peaks)
    }

    /// Their mean, rad, one that stands alone as the next largest; `None` of none. `others` are of other runs of the plan.
    pub(super) fn usual_mean(&self, others: &[&Self]) -> Option<f64> {
        let (mut sum_rad, mut count) = (0.0, 0);
        for (joint, peaks) in &self.0 {
            sum_rad += peaks.iter().sum::<f64>();
            count += peaks.len();
            let Some((place, most_rad)) =
                peaks.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1))
            else {
                continue;
            };
            let next_rad = (0..peaks.len()).filter(|k| *k != place).map(|k| peaks[k]).fold(0.0, f64::max);
            let again = |other: &Self| {
                let own = other.0.get(joint).filter(|own| own.len() == peaks.len());
                own.is_none_or(|own| own[place] > AGAIN * most_rad)
            };
            let alone =
                peaks.len() >= LEAST && most_rad > BEYOND * next_rad && most_rad - next_rad > BEYOND_RAD;
            if alone && !others.is_empty() && !others.iter().any(|other| again(other)) {
                sum_rad -= most_rad - next_rad;
            }
        }
        (count > 0).then(|| sum_rad / count as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_start_that_stands_alone_counts_as_the_next_and_one_that_comes_again_as_it_is() {
        let run =
            |of_deg: [f64; 4]| Peaks([("a".to_owned(), of_deg.map(|deg| deg * DEGREE_RAD).to_vec())].into());
        let mean_deg = |own: [f64; 4], others: &[[f64; 4]]| {
            let others: Vec<Peaks> = others.iter().map(|other| run(*other)).collect();
            run(own).usual_mean(&others.iter().collect::<Vec<_>>()).unwrap() / DEGREE_RAD
        };
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
        assert!(near(mean_deg([0.1, 0.2, 8.0, 0.1], &[[1.0, 1.0, 1.0, 1.0]]), 0.15));
        assert!(near(mean_deg([0.1, 0.2, 8.0, 0.1], &[[1.0, 1.0, 5.0, 1.0]]), 2.1), "again");
        assert!(near(mean_deg([0.1, 0.2, 8.0, 0.1], &[]), 2.1), "no other run");
        assert!(near(mean_deg([0.1, 4.0, 8.0, 0.1], &[[1.0, 1.0, 1.0, 1.0]]), 3.05), "two of them");
    }
}
