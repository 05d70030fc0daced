//! Stamps that repeat in many rows, as whole seconds at 10 Hz do: the rows are spread evenly from each to the next.

use super::{
    clock::{Found, Look},
    spread::{UNEVEN, complete, runs},
    time::TimeSource,
};
use crate::{math::median, units::NS_PER_S};

/// Fewer stamps than this, beside the first and the last, tell nothing.
const LEAST: usize = 3;

impl Look<'_> {
    /// A time that repeats itself in most rows, with as many rows to each stamp, as one that tells the rows apart.
    pub(super) fn spread(&self, text: &[u8], found: Found) -> Found {
        if found.resolves {
            return found;
        }
        let [ns, _] = self.both(text, [&found.source; 2]);
        let Some((rows, step_ns)) = rows_each(&ns) else { return found };
        let lacking = match complete(&ns, rows).iter().filter(|complete| !**complete).count() {
            0 => String::new(),
            left => format!(
                "; {left} rows of steps that lack some are left out, for which are missing is not known"
            ),
        };
        let unit = found.doubt.as_ref().map_or(String::new(), |doubt| format!("{doubt}; it "));
        let doubt = format!(
            "{unit}repeats each stamp in {rows} rows: they are spread evenly over the {} s to the next{lacking}",
            step_ns as f64 / NS_PER_S
        );
        Found {
            source: TimeSource::Spread { whole: Box::new(found.source), rows, step_ns },
            resolves: true,
            doubt: Some(doubt),
            ..found
        }
    }
}

/// Rows of each stamp, and the step from one to the next, ns; `None` where they are uneven.
fn rows_each(stamp_ns: &[i64]) -> Option<(usize, i64)> {
    let runs = runs(stamp_ns);
    let inner = runs.get(1..runs.len().saturating_sub(1)).filter(|inner| inner.len() >= LEAST)?;
    let usual = median(inner.iter().map(|(_, rows)| *rows as f64).collect());
    let even =
        inner.iter().filter(|(_, rows)| (*rows as f64 - usual).abs() <= (UNEVEN * usual).max(1.0)).count();
    let step_ns =
        inner.windows(2).map(|two| two[1].0.saturating_sub(two[0].0)).min().filter(|step| *step > 0)?;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of rows")]
    let rows = usual.round() as usize;
    (rows >= 2 && 10 * even >= 9 * inner.len()).then_some((rows, step_ns))
}

#[cfg(test)]
mod tests {
    use super::{super::spread::spread, *};

    #[test]
    fn rows_of_whole_seconds_lie_evenly_in_them() {
        // Ten a second, from 0.7 s on; one second lacks a row.
        let mut ns: Vec<i64> = (7..63).filter(|row| *row != 34).map(|row| row / 10 * 1_000_000_000).collect();
        let lacking = |ns: &[i64]| complete(ns, 10).iter().filter(|complete| !**complete).count();
        assert_eq!((rows_each(&ns), lacking(&ns)), (Some((10, 1_000_000_000)), 0));
        spread(&mut ns, 10, 1_000_000_000);
        assert_eq!(ns[..4], [700_000_000, 800_000_000, 900_000_000, 1_000_000_000]);
        assert!(ns.windows(2).all(|two| two[1] > two[0]), "{ns:?}");
        assert_eq!(ns[28], 3_500_000_000);
        let cut: Vec<i64> =
            (0..200).filter(|row| !(24..29).contains(row)).map(|row| row / 10 * 1_000_000_000).collect();
        assert_eq!((rows_each(&cut), lacking(&cut)), (Some((10, 1_000_000_000)), 5));
        // A clock that stands, and one that is written when something happens.
        assert_eq!(rows_each(&[0, 0, 0, 0, 0]), None);
        assert_eq!(rows_each(&[0, 1, 1, 1, 1, 2, 3, 3, 3, 3, 3, 3, 4, 4, 5]), None);
    }
}
