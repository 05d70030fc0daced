//! Stamps of the logs that are made from plans.

/// Stamp of the first sample, ns since 1970: no wall clock, so that equal plans give equal logs.
pub use crate::log::UNDATED_NS as START_NS;

/// Even instants from 0 to the end, both included, s; the last interval may be a hundredth longer, but not as short as that.
pub(in crate::workflow) fn instants(end_s: f64, rate_hz: f64) -> impl Iterator<Item = f64> {
    let inner =
        (0_u64..).map(move |k| k as f64 / rate_hz).take_while(move |t_s| *t_s < end_s - 0.01 / rate_hz);
    inner.chain(std::iter::once(end_s))
}

#[cfg(test)]
mod tests {
    use super::instants;

    #[test]
    fn no_interval_is_far_shorter_than_the_others() {
        for end_s in [5.88, 5.880_003_191, 5.899, 5.92 - 1e-7] {
            let all: Vec<f64> = instants(end_s, 25.0).collect();
            assert!(all.windows(2).all(|two| (4e-4..0.0405).contains(&(two[1] - two[0]))), "{end_s}");
            assert_eq!((all[0], all.last()), (0.0, Some(&end_s)));
        }
    }
}
