//! Where plans rest: a run can be cut there.

/// A plan that is slower rests, rad/s or m/s, for this long, s.
const RESTS: f64 = 1e-3;
const LASTS_S: f64 = 0.3;

/// A part of a run ends so long before the motion that follows, s.
const BEFORE_S: f64 = 0.1;

/// Until when a run can be read whole before an instant, s: shortly before the end of the last rest of all plans, each as times, s, and
/// positions, that begins between a motion and that instant. `None` where none does, or no motion follows.
pub fn whole_until_s<'a>(plans: impl Iterator<Item = (&'a [f64], &'a [f64])>, before_s: f64) -> Option<f64> {
    let mut moving: Vec<[f64; 2]> = plans
        .flat_map(|(t_s, q)| t_s.windows(2).zip(q.windows(2)))
        .filter(|(t_s, q)| (q[1] - q[0]).abs() > RESTS * (t_s[1] - t_s[0]))
        .map(|(t_s, _)| [t_s[0], t_s[1]])
        .collect();
    moving.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (mut since_s, mut ends_s) = (f64::NAN, None);
    for [from_s, to_s] in moving.into_iter().chain([[f64::INFINITY; 2]]) {
        if from_s - since_s > LASTS_S && since_s <= before_s {
            ends_s = Some(from_s);
        }
        since_s = to_s.max(since_s);
    }
    ends_s.filter(|ends_s| ends_s.is_finite()).map(|ends_s| ends_s - BEFORE_S)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_rest_begins_before_the_instant_and_behind_a_motion() {
        let t_s: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).collect();
        let step = |t_s: f64, from_s: f64| (t_s - from_s).clamp(0.0, 1.0);
        let first: Vec<f64> = t_s.iter().map(|t| step(*t, 1.0) + step(*t, 6.0)).collect();
        let second: Vec<f64> = t_s.iter().map(|t| step(*t, 1.5) - step(*t, 4.0)).collect();
        let plans = || [first.as_slice(), second.as_slice()].into_iter().map(|q| (t_s.as_slice(), q));
        let found = |before_s: f64| whole_until_s(plans(), before_s);
        assert_eq!(found(2.2), None);
        assert!(found(3.0).is_some_and(|s| (s - 3.9).abs() < 0.02), "{:?}", found(3.0));
        assert!(found(4.5).is_some_and(|s| (s - 3.9).abs() < 0.02));
        assert!(found(5.5).is_some_and(|s| (s - 5.9).abs() < 0.02));
        assert_eq!(found(8.0), None);
    }
}
