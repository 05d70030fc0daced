//! Between which runs a level jumped, as surely as they tell.

use std::ops::Range;

use super::run::date;

/// How much likelier than another place the likeliest one is by chance in one of twenty series, as twice the difference of the
/// logarithms (Hansen 2000, doi:10.1111/1468-0262.00124).
const CRITICAL: f64 = 7.35;

/// The last run that surely lies before the jump and the first one that surely lies after it (95 %), UTC; `levels` are days since 1970
/// and level, those of `runs` jump from one course to another.
pub(super) fn within_95(
    levels: &[(f64, f64)],
    runs: Range<usize>,
    before: impl Fn(f64) -> f64,
    after: impl Fn(f64) -> f64,
) -> Option<[String; 2]> {
    let own = levels.get(runs)?;
    let off = |course: &dyn Fn(f64) -> f64| -> Vec<f64> {
        own.iter().map(|(at, level)| (level - course(*at)).powi(2)).collect()
    };
    let (before, after) = (off(&before), off(&after));
    // Squares that a jump before each run leaves.
    let mut left: f64 = after.iter().sum();
    let squares: Vec<f64> = before
        .iter()
        .zip(&after)
        .map(|(before, after)| {
            left += before - after;
            left
        })
        .collect();
    let places = squares.split_last()?.1;
    let least = places.iter().copied().reduce(f64::min)?;
    let variance = least / (own.len() as f64 - 2.0).max(1.0);
    let likely = |left: &f64| left - least <= CRITICAL * variance;
    let (first, last) = (places.iter().position(likely)?, places.iter().rposition(likely)?);
    Some([date(own[first].0)?, date(own[last + 1].0)?])
}

#[cfg(test)]
mod tests {
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    #[test]
    fn a_jump_is_dated_as_surely_as_the_scatter_allows() {
        let (mut held, mut wide) = (0, 0);
        for seed in 0..200 {
            let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
            let mut noise = || -> f64 { StandardNormal.sample(&mut rng) };
            let levels: Vec<(f64, f64)> =
                (0..40).map(|k| (f64::from(k), if k < 23 { 0.0 } else { 1.5 } + noise())).collect();
            let [from, to] = within_95(&levels, 0..40, |_| 0.0, |_| 1.5).unwrap();
            let day =
                |date: &str| date[8..10].parse::<usize>().unwrap() + if date[5..7] == *"02" { 31 } else { 0 };
            // The 23rd run is of the 24th of January.
            held += usize::from(day(&from) <= 23 && day(&to) >= 24);
            wide += day(&to) - day(&from);
        }
        assert!(held >= 185 && wide < 200 * 8, "{held} of 200 hold the day, {wide} days in all");
    }

    #[test]
    fn what_hardly_scatters_jumps_between_two_runs() {
        let levels: Vec<(f64, f64)> =
            (0..9).map(|k| (f64::from(k), if k < 4 { 0.0 } else { 1.0 } + 0.01 * f64::from(k % 2))).collect();
        let found = within_95(&levels, 0..9, |_| 0.0, |_| 1.0).unwrap();
        assert_eq!(found, ["1970-01-04T00:00:00Z", "1970-01-05T00:00:00Z"]);
    }
}
