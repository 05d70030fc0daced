//! Whether a correction is a part of another, and whether what is left of that is to be sent.

use super::answer::motions;

/// A correction of which at most this share was sent has a rest to send; below the least, or where the two are less alike than
/// this correlation, it is another one.
const PART: [f64; 2] = [0.05, 0.7];
const PART_ALIKE: f64 = 0.85;

/// Whether what was sent is a part of a whole correction.
pub(super) fn is_part(sent: &[f64], whole: &[f64]) -> bool {
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (both, own, all) = (product(sent, whole), product(sent, sent), product(whole, whole));
    both > PART_ALIKE * (own * all).sqrt() && (PART[0]..=PART[1]).contains(&(both / all))
}

/// What is left of an error asks for this share of a rest and more where it is to be sent, and for this and less where it is not.
const ASKED: [f64; 2] = [0.1, 0.4];

/// How much of the rest of a correction what is left of the error still asks for, 0 to 1 by step, in each motion of a plan: what a first
/// run showed by chance, the next one does not. `learnt` is what the error alone would add.
pub(super) fn still_asked(planned: &[(f64, f64)], rest: &[f64], learnt: &[f64]) -> Vec<f64> {
    let mut asked = vec![1.0; rest.len()];
    for steps in motions(planned) {
        let (rest, learnt) = (&rest[steps.clone()], &learnt[steps.clone()]);
        let both: f64 = rest.iter().zip(learnt).map(|(a, b)| a * b).sum();
        let own: f64 = rest.iter().map(|x| x * x).sum();
        let share = ((both / own - ASKED[0]) / (ASKED[1] - ASKED[0])).clamp(0.0, 1.0);
        asked[steps].fill(if share.is_nan() { 1.0 } else { share });
    }
    asked
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rest_that_the_error_does_not_ask_for_is_not_sent_in_that_motion() {
        let moved =
            |t_s: f64| [2.0, 7.0].iter().map(|from| ((t_s - from) / 2.0).clamp(0.0, 1.0)).sum::<f64>();
        let planned: Vec<(f64, f64)> = (0..1200).map(|k| (moved(f64::from(k) * 0.01), 0.0)).collect();
        let rest = vec![0.02; 1200];
        // The error asks for as much in the first motion, and for less than was sent in the second.
        let learnt: Vec<f64> = (0..1200).map(|k| if k < 600 { 0.02 } else { -0.01 }).collect();
        let asked = still_asked(&planned, &rest, &learnt);
        assert!(asked[300] > 0.99 && asked[900] < 0.01, "{} {}", asked[300], asked[900]);
        assert!(still_asked(&planned, &vec![0.0; 1200], &learnt).iter().all(|share| *share >= 1.0));
    }

    #[test]
    fn a_part_of_a_correction_is_told_from_the_whole_and_from_another() {
        let whole: Vec<f64> = (0..200).map(|k| (0.1 * f64::from(k)).sin()).collect();
        let sent = |by: f64, other: f64| -> Vec<f64> {
            (0..).zip(&whole).map(|(k, whole)| by * whole + other * (0.37 * f64::from(k)).cos()).collect()
        };
        assert!(is_part(&sent(0.5, 0.1), &whole) && is_part(&sent(0.25, 0.0), &whole));
        for (by, other) in [(0.95, 0.0), (0.01, 0.0), (0.0, 0.0), (0.5, 1.0), (-0.5, 0.0)] {
            assert!(!is_part(&sent(by, other), &whole), "{by} {other}");
        }
    }
}
