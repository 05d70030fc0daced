//! Single readings of a sensor that were lost: zeros between values that agree.

/// A reading that was lost is at least so far from its neighbours, in the same units, faster than this, and they are no
/// farther apart, s; those beside it differ by so little of that from each other.
const LEAST_LOST: f64 = 0.05;
const LOST_SPEED: f64 = 2.0;
const LOST_S: f64 = 0.25;
const CALM: f64 = 0.1;
/// It is so many times as far as the smallest step of the others: a sensor with few steps may be at 0.
const LOST_STEPS: f64 = 10.0;

/// Drops single samples that are exactly 0 between others that agree, as a reading that was lost leaves; returns how
/// many.
pub(super) fn drop_lost(kept: &mut Vec<usize>, t_s: &[f64], at: impl Fn(usize) -> f64) -> u64 {
    let value = |k: usize| at(kept[k]);
    let lost = |k: &usize| {
        let least = value(k - 1).abs().min(value(k + 1).abs());
        let calm = |a: usize, b: usize| (value(b) - value(a)).abs() < CALM * least;
        let near = |a: usize, b: usize| t_s[kept[b]] - t_s[kept[a]] < LOST_S.min(least / LOST_SPEED);
        value(*k) == 0.0
            && least > LEAST_LOST
            && calm(k - 1, k + 1)
            && calm(k - 2, k - 1)
            && calm(k + 1, k + 2)
            && near(k - 1, *k)
            && near(*k, k + 1)
    };
    let mut zeros: Vec<usize> = (2..kept.len().saturating_sub(2)).filter(lost).collect();
    if zeros.is_empty() {
        return 0;
    }
    let step = |k: &usize| (value(k + 1) - value(*k)).abs();
    let of_zero = |k: &usize| zeros.binary_search(k).is_ok() || zeros.binary_search(&(k + 1)).is_ok();
    let steps = (0..kept.len() - 1).filter(|k| !of_zero(k)).map(|k| step(&k)).filter(|step| *step > 0.0);
    let smallest = steps.fold(f64::INFINITY, f64::min);
    zeros.retain(|k| !smallest.is_finite() || value(k - 1).abs() > LOST_STEPS * smallest);
    let mut k = 0;
    kept.retain(|_| {
        k += 1;
        zeros.binary_search(&(k - 1)).is_err()
    });
    zeros.len() as u64
}

/// Whether a value is 0 beside one that is not near it: a quick look that spares the closer one.
pub(super) fn may_be_lost(position: &[f64]) -> bool {
    let pairs = position.iter().zip(position.get(1..).unwrap_or_default());
    pairs.fold(false, |found, (here, next)| found | ((*next == 0.0) & (here.abs() > LEAST_LOST)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many of the values of a joint at 50 Hz are dropped.
    fn dropped(value: impl Fn(usize) -> f64) -> u64 {
        let t_s: Vec<f64> = (0..100).map(|k| f64::from(k) * 0.02).collect();
        let mut kept: Vec<usize> = (0..100).collect();
        let lost = drop_lost(&mut kept, &t_s, &value);
        assert_eq!(lost, 100 - kept.len() as u64);
        assert!(lost == 0 || may_be_lost(&(0..100).map(value).collect::<Vec<f64>>()));
        lost
    }

    #[test]
    fn a_zero_between_values_that_agree_is_lost() {
        let moving = |k: usize| 0.2 + 0.001 * k as f64;
        assert_eq!(dropped(|k| if k % 40 == 20 { 0.0 } else { moving(k) }), 2);
        assert_eq!(dropped(|k| if k == 20 { -0.0 } else { -0.2 }), 1);
    }

    #[test]
    fn a_joint_that_is_at_zero_is_there() {
        assert_eq!(dropped(|k| 0.01 * (k as f64 - 50.0)), 0, "on its way");
        assert_eq!(dropped(|k| if (20..22).contains(&k) { 0.0 } else { 0.2 }), 0, "for two samples");
        assert_eq!(dropped(|k| if k == 20 { 0.0 } else { 0.02 }), 0, "near it");
        assert_eq!(
            dropped(|k| if k == 20 { 0.0 } else { 0.1 * ((k / 30 + 1) as f64) }),
            0,
            "by coarse steps"
        );
        assert_eq!(dropped(|k| if k < 20 { 0.2 } else { 0.0 }), 0, "to stay");
        assert_eq!(dropped(|k| if k == 1 || k == 98 { 0.0 } else { 0.2 }), 0, "at the ends");
    }
}
