//! Whether a correction is a part of another.

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

#[cfg(test)]
mod tests {
    use super::*;

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
