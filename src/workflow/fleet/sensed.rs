//! Runs of a machine that were measured otherwise than most of it: what differs in them may be of that alone.

use std::collections::BTreeMap;

use super::run::{Run, date, days};
use crate::{
    math::median,
    remark::{Code, Remarks},
    workflow::sensed::Sensed,
};

/// So many runs are enough to be told of, and one in so many of all.
const FEWEST: usize = 3;
const ONE_IN: usize = 10;

/// How a joint of a machine was measured, by run.
pub(super) type Measured = BTreeMap<(String, String), BTreeMap<usize, Sensed>>;

/// Of a machine: joints, runs, the first of them, and what is other in it.
struct Otherwise {
    joints: Vec<String>,
    runs: usize,
    first: usize,
    what: String,
}

/// Says which machines were measured otherwise in some runs.
pub(super) fn measured_otherwise(runs: &[Run], measured: &Measured, remarks: &mut Remarks) {
    let mut found: BTreeMap<&str, Otherwise> = BTreeMap::new();
    for ((machine, joint), own) in measured {
        let usual_of = |of: fn(&Sensed) -> f64| median(own.values().map(of).collect());
        let usual = Sensed {
            noise: usual_of(|one| one.noise),
            interval_s: usual_of(|one| one.interval_s),
            peak_error: usual_of(|one| one.peak_error),
        };
        let is_other = |one: &Sensed| one.other_rate(usual) || one.other_noise(usual);
        let others: Vec<(usize, Sensed)> =
            own.iter().filter(|(_, one)| is_other(one)).map(|(run, one)| (*run, *one)).collect();
        let Some((first, one)) =
            others.first().copied().filter(|_| others.len() >= FEWEST.max(own.len() / ONE_IN))
        else {
            continue;
        };
        let hz = |sensed: Sensed| 1.0 / sensed.interval_s;
        let what = if one.other_rate(usual) {
            format!("sampled at {:.0} Hz and else at {:.0} Hz", hz(one), hz(usual))
        } else {
            let [more, side] = [one.noise / usual.noise, usual.noise / one.noise];
            let (by, less) = if more > 1.0 { (more, "") } else { (side, "one part in ") };
            let times = if by.is_finite() { format!("{less}{by:.1}") } else { "many".to_owned() };
            format!("with noise or a step of the measurement of {times} times that of the others")
        };
        let told = found.entry(machine).or_insert(Otherwise { joints: vec![], runs: 0, first, what });
        told.joints.push(joint.clone());
        told.runs = told.runs.max(others.len());
        told.first = told.first.min(first);
    }
    for (machine, Otherwise { joints, runs: count, first, what }) in found {
        let message = format!(
            "{machine}, {}: {count} runs, the first of {}, were {what}: peaks of noisier or denser samples are larger by themselves, and \
             delays of noisier or sparser ones later; what changes there may be of the measurement alone",
            joints.join(", "),
            date(days(&runs[first])).unwrap_or_default().get(..10).unwrap_or_default()
        );
        remarks.add(Code::MeasuredOtherwise, count as u64, message);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_at_another_rate_or_with_other_noise_are_told_by_machine_and_first_day() {
        let runs: Vec<Run> = (0..12)
            .map(|k| {
                let started_us = (20_000 + k) * 86_400_000_000;
                Run { id: k.to_string(), machine: "M".into(), log: format!("/{k}.csv"), started_us }
            })
            .collect();
        let said = |interval_s: [f64; 2], noise: [f64; 2]| {
            let of = |k: usize| {
                let side = usize::from(k >= 7);
                Sensed { noise: noise[side], interval_s: interval_s[side], peak_error: 0.02 }
            };
            let own = (0..12).map(|k| (k, of(k))).collect();
            let mut remarks = Remarks::default();
            measured_otherwise(&runs, &BTreeMap::from([(("M".into(), "boom".into()), own)]), &mut remarks);
            remarks.as_slice().iter().map(|one| (one.count, one.message.clone())).next()
        };
        assert_eq!(said([0.02; 2], [1e-4; 2]), None);
        assert_eq!(said([0.02; 2], [1e-5, 2e-5]), None, "of no account");
        let (count, message) = said([0.02, 0.1], [1e-4; 2]).unwrap();
        assert!(
            count == 5 && message.contains("the first of 2024-10-11, were sampled at 10 Hz"),
            "{message}"
        );
        let (_, message) = said([0.02; 2], [1e-4, 5e-4]).unwrap();
        assert!(message.contains("of 5.0 times that of the others"), "{message}");
    }
}
