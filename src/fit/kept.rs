//! Speeds that a joint kept for a time.

use super::run::{Run, Sample};

/// Largest speed that a joint kept in each of so many parts of a time on average, growing for `way` 1 and shrinking for -1, rad/s. What
/// jumps there and back keeps none in two.
pub(super) fn kept_rad_s(runs: &[Run], way: f64, over_s: f64, parts: usize) -> f64 {
    let part_s = over_s / parts.max(1) as f64;
    let kept = |run: &Run, from: &Sample| {
        let (mut from, mut least) = (*from, f64::INFINITY);
        for _ in 0..parts.max(1) {
            let until_s = from.at_s() + part_s;
            let later = run.samples.partition_point(|later| later.at_s() < until_s);
            let end = *run.samples.get(later)?;
            let lasts_s = end.at_s() - from.at_s();
            if lasts_s >= 1.5 * part_s {
                return None;
            }
            least = least.min(way * (end.measured_rad - from.measured_rad) / lasts_s);
            from = end;
        }
        Some(least)
    };
    let all = runs.iter().flat_map(|run| run.samples.iter().filter_map(move |from| kept(run, from)));
    all.fold(0.0, f64::max)
}
