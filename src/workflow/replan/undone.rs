//! Whether all that a command gained was undone in its newest run: a disturbance does that, and one run is no machine.

use super::history::History;

/// A mean peak above that of the same command before by this factor, and one without a run of the plan as it is.
const MORE: f64 = 3.0;
const FAR_MORE: f64 = 5.0;

/// Share of the error without a correction from which on a correction did nothing.
const AS_NONE: f64 = 0.7;

impl History {
    /// Mean peak, rad, that the same command gave before the newest run, where that is alone on its side of a change and came to
    /// about as much as without a correction.
    pub(super) fn undone(&self, now: &[usize]) -> Option<f64> {
        let newest = self.runs.len().checked_sub(1)?;
        if now != [newest] || !self.runs[newest].corrected {
            return None;
        }
        let peak_rad = |k: usize| self.runs[k].mean_peak_rad;
        let (before, came_rad) = ((0..newest).rev().find(|k| self.same(*k, newest))?, peak_rad(newest)?);
        let before_rad = peak_rad(before)?;
        let plain = (0..newest).filter(|k| !self.runs[*k].corrected).filter_map(peak_rad).reduce(f64::min);
        let undone = match plain {
            Some(plain_rad) => came_rad > (MORE * before_rad).max(AS_NONE * plain_rad),
            None => came_rad > FAR_MORE * before_rad,
        };
        undone.then_some(before_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::super::history::tests::{history, sent};

    #[test]
    fn what_comes_to_as_much_as_without_a_correction_once_is_no_machine() {
        let undone = |peaks: &[f64], now: &[usize]| {
            let mut history = history(peaks);
            history.series =
                (0..peaks.len()).map(|k| (sent(if k > 0 { 1.1 } else { 1.0 }), sent(0.0))).collect();
            history.corrections_rad = (0..peaks.len()).map(|k| if k > 0 { 0.1 } else { 0.0 }).collect();
            history.undone(now)
        };
        assert_eq!(undone(&[3.0, 0.1, 2.9], &[2]), Some(0.1));
        assert_eq!(undone(&[3.0, 0.1, 1.5], &[2]), None, "it still helps");
        assert_eq!(undone(&[3.0, 1.2, 2.9], &[2]), None, "it never gained much");
        assert_eq!(undone(&[3.0, 0.1, 2.9, 2.9], &[2, 3]), None, "twice is a machine");
        assert_eq!(undone(&[3.0, 0.1, 2.9], &[0, 1, 2]), None, "no change was found");
    }
}
