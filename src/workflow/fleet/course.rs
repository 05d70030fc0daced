//! How a level went over the days: each jump and each stretch in which it changed, in order.

use serde::{Deserialize, Serialize};

use super::{run::date, when::within_95};
use crate::math::{Piece, pieces};

/// Pieces that a line makes by chance more often are one line.
const NO_LINE: f64 = 0.01;

/// One change of a level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Change {
    /// The last run before it, or the one with which it begins, UTC.
    pub after: Option<String>,
    /// The first run after it, or the last one of it, UTC.
    pub by: Option<String>,
    /// Where it jumped, the run before which and the one after which it surely did (95 %), UTC.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub within_95: Option<[String; 2]>,
    /// By how much the level changed.
    pub change: f64,
    /// Its 95 % interval, by Student's t.
    pub interval_95: [f64; 2],
    /// Change a day with its 95 % interval, where the level changed evenly; absent where it jumped between two runs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub per_day: Option<(f64, [f64; 2])>,
    /// From the one run to the other, days since 1970.
    #[serde(skip)]
    pub(super) at_days: [f64; 2],
    /// Runs before it.
    #[serde(skip)]
    pub(super) runs_before: usize,
}

/// All changes of a level.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Course {
    /// Probability of such a course by chance.
    pub(super) p_value: f64,
    pub(super) changes: Vec<Change>,
    /// The slope with which it ends, 0 of a level, and its 95 % interval.
    pub(super) ends: (f64, [f64; 2]),
    /// Days since 1970 and level, joined by straight lines.
    pub(super) line: Vec<[f64; 2]>,
}

impl Course {
    /// The same of levels that lie above these.
    pub(super) fn above(mut self, by: f64) -> Self {
        for point in &mut self.line {
            point[1] += by;
        }
        self
    }
}

/// The course of the levels of runs `(days, level)`; `None` where it is one level or one line.
pub(super) fn course(levels: &[(f64, f64)]) -> Option<Course> {
    let found = pieces(levels).filter(|found| found.pieces.len() > 1 && found.p_of_line < NO_LINE)?;
    let at = |run: usize| levels[run].0;
    let (mut changes, mut line): (Vec<Change>, Vec<[f64; 2]>) = (Vec::new(), Vec::new());
    let mut before: Option<&Piece> = None;
    for piece in &found.pieces {
        let (from, to) = (piece.points.start, piece.points.end - 1);
        line.extend([[at(from), piece.ends[0]], [at(to), piece.ends[1]]]);
        let change = |[from, to]: [usize; 2], change, interval_95, per_day| {
            let at_days = [at(from), at(to)];
            let [after, by] = at_days.map(date);
            Change { after, by, within_95: None, change, interval_95, per_day, at_days, runs_before: to }
        };
        if let Some((jump, interval)) = piece.jump {
            let mut jumped = change([from - 1, from], jump, interval, None);
            jumped.within_95 = before.and_then(|before| {
                let [before_at, own_at] = [before, piece].map(|piece| {
                    move |days: f64| piece.ends[0] + piece.slope * (days - at(piece.points.start))
                });
                within_95(levels, before.points.start..piece.points.end, before_at, own_at)
            });
            changes.push(jumped);
        }
        before = Some(piece);
        if piece.slope.abs() > 0.0 {
            // What meets the piece before begins to change there.
            let begins = if piece.jump.is_some() || from == 0 { from } else { from - 1 };
            let days = at(to) - at(begins);
            let interval = piece.interval.map(|slope| slope * days);
            changes.push(change(
                [begins, to],
                piece.slope * days,
                interval,
                Some((piece.slope, piece.interval)),
            ));
        }
    }
    let last = found.pieces.last()?;
    let ends = (last.slope, last.interval);
    (!changes.is_empty()).then_some(Course { p_value: found.p, changes, ends, line })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_that_wears_and_is_mended_grows_and_then_jumps_back() {
        let noise = |k: u32| 0.05 * (f64::from(k * 7919 % 23) / 11.0 - 1.0);
        let level = |k: u32| if (20..40).contains(&k) { 0.06 * f64::from(k - 20) } else { 0.0 };
        let levels: Vec<(f64, f64)> = (0..60).map(|k| (f64::from(k), level(k) + noise(k))).collect();
        let found = course(&levels).unwrap();
        let [ramp, jump] = found.changes.as_slice() else { panic!("{found:?}") };
        let (slope, [low, high]) = ramp.per_day.unwrap();
        assert!(low < 0.06 && high > 0.06 && (slope - 0.06).abs() < 0.01, "{ramp:?}");
        assert!((17.0..=22.0).contains(&ramp.at_days[0]) && (ramp.at_days[1] - 39.0).abs() < 1.1, "{ramp:?}");
        assert!(
            jump.per_day.is_none() && (jump.change + 1.14).abs() < 0.2 && jump.runs_before == 40,
            "{jump:?}"
        );
        assert!(found.ends.0.abs() < 1e-12 && found.ends.1[0] < 0.0 && found.p_value < 1e-6, "{found:?}");
        assert!(course(&levels[..18]).is_none_or(|noise| noise.p_value > 0.05));
    }
}
