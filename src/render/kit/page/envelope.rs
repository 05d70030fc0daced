//! Fewer samples that look the same: every bucket keeps the extremes of every series.

use std::ops::Range;

/// Places to draw, in order; `None` lifts the pen between segments.
///
/// Of series that share their instants, cut into continuous segments of `0..n`, about `most` places remain: all,
/// if there are no more, else those where a series is least or most within its bucket of equal length, and the ends of
/// the bucket: what happens in one makes no slope in the next. A spike of one sample stays.
pub(in crate::render) fn envelope(
    segments: &[Range<usize>],
    series: &[&[f64]],
    most: usize,
) -> Vec<Option<usize>> {
    let n: usize = segments.iter().map(ExactSizeIterator::len).sum();
    let buckets = (most / (2 * series.len() + 2)).max(1);
    let size = if n <= most { 1 } else { n.div_ceil(buckets) };
    let mut places = Vec::new();
    for segment in segments {
        if !places.is_empty() {
            places.push(None);
        }
        let mut start = segment.start;
        while start < segment.end {
            let end = (start + size).min(segment.end);
            let mut kept = extremes(start..end, series);
            kept.extend([start, end - 1]);
            kept.sort_unstable();
            kept.dedup();
            places.extend(kept.into_iter().map(Some));
            start = end;
        }
    }
    places
}

/// The same, and of each of some parts so many places more: a look at these alone shows their course.
pub(in crate::render) fn with_parts(
    segments: &[Range<usize>],
    series: &[&[f64]],
    most: usize,
    (parts, each): (&[Range<usize>], usize),
) -> Vec<Option<usize>> {
    let mut kept: Vec<usize> = envelope(segments, series, most).into_iter().flatten().collect();
    for part in parts {
        kept.extend(envelope(std::slice::from_ref(part), series, each).into_iter().flatten());
    }
    kept.sort_unstable();
    kept.dedup();
    let mut places = Vec::with_capacity(kept.len() + segments.len());
    for segment in segments {
        if !places.is_empty() {
            places.push(None);
        }
        let [from, to] = [segment.start, segment.end].map(|end| kept.partition_point(|place| *place < end));
        places.extend(kept[from..to].iter().copied().map(Some));
    }
    places
}

fn extremes(bucket: Range<usize>, series: &[&[f64]]) -> Vec<usize> {
    let mut kept = Vec::with_capacity(2 * series.len());
    for values in series {
        let known = || bucket.clone().filter_map(|i| Some((i, *values.get(i)?)));
        kept.extend(known().min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i));
        kept.extend(known().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i));
    }
    kept
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn one(n: usize) -> Vec<Range<usize>> {
        std::iter::once(0..n).collect()
    }

    #[test]
    fn a_spike_of_one_sample_stays_in_an_hour_at_a_kilohertz() {
        let n = 3_600_000;
        let mut values = vec![0.0; n];
        values[1_234_567] = 1.0;
        values[2_345_678] = -1.0;
        let flat = vec![0.0; n];
        let places = envelope(&one(n), &[&flat, &values], 4000);
        assert!(places.len() <= 4004, "{}", places.len());
        for spike in [1_234_567, 2_345_678, 0, n - 1] {
            assert!(places.contains(&Some(spike)), "{spike}");
        }
    }

    #[test]
    fn parts_keep_their_course() {
        let wave: Vec<f64> = (0..9000_i32).map(|k| f64::from(k % 10)).collect();
        let segments = [0..5000, 5000..9000];
        let places = with_parts(&segments, &[&wave], 200, (&[4000..4100, 4990..5010], 100));
        assert!((4000..4100).chain(4990..5010).all(|k| places.contains(&Some(k))), "{places:?}");
        assert_eq!(places.iter().filter(|place| place.is_none()).count(), 1);
        assert!(places.len() < 400, "{}", places.len());
    }

    #[test]
    fn a_motion_makes_no_slope_where_nothing_moves() {
        let values: Vec<f64> =
            (0..100_000).map(|k| if (50_500..50_600).contains(&k) { 1.0 } else { 0.0 }).collect();
        let places: Vec<usize> =
            envelope(&one(values.len()), &[&values], 400).into_iter().flatten().collect();
        let slopes = places.windows(2).filter(|two| (values[two[0]] - values[two[1]]).abs() > 0.5);
        assert!(
            slopes.clone().count() == 2 && slopes.flatten().all(|k| (50_000..51_100).contains(k)),
            "{places:?}"
        );
    }

    #[test]
    fn a_short_series_keeps_every_sample_and_lifts_the_pen_in_gaps() {
        let values = [1.0, 2.0, f64::NAN, 4.0];
        let places = envelope(&[0..2, 2..4], &[&values], 4);
        assert_eq!(places, [Some(0), Some(1), None, Some(2), Some(3)]);
    }

    proptest! {
        #[test]
        fn the_range_of_values_stays_and_places_ascend(
            values in prop::collection::vec(-1e3..1e3_f64, 1..3000), most in 4_usize..500
        ) {
            let kept: Vec<usize> = envelope(&one(values.len()), &[&values], most).into_iter().flatten().collect();
            prop_assert!(kept.windows(2).all(|pair| pair[0] < pair[1]));
            prop_assert!(kept.len() <= most.max(values.len().min(most)) + 2);
            let all = crate::math::range(values.iter().copied());
            let left = crate::math::range(kept.iter().map(|&i| values[i]));
            prop_assert_eq!(all.map(f64::to_bits), left.map(f64::to_bits));
        }
    }
}
