//! Which of two plans a joint followed: the values of one, or what goes on between them.

use crate::series::Track;

/// Delays of a joint that are tried, s.
const LATEST_S: f64 = 2.0;
const LATER_S: f64 = 0.05;
/// Instants at which it is compared.
const INSTANTS: usize = 500;

/// Which share of the way from each value to the next a joint has gone when that comes.
pub(super) fn gone_before(plan: &Track, came: &Track) -> f64 {
    let (mut gone, mut asked) = (0.0, 0.0);
    for (next_s, two) in plan.t_s().iter().skip(1).zip(plan.position().windows(2)) {
        let change = two[1] - two[0];
        gone += change * (came.held_at(*next_s).position - two[0]);
        asked += change * change;
    }
    if asked > 0.0 { gone / asked } else { 0.0 }
}

/// What a measurement is off a plan that it follows at the best delay, root mean square.
pub(super) fn off(plan: &Track, came: &Track) -> f64 {
    let step = came.len().div_ceil(INSTANTS).max(1);
    let instants = || came.t_s().iter().zip(came.position()).step_by(step);
    let at = |late_s: f64| {
        let mut cursor = 0;
        let squares =
            instants().map(|(t_s, q)| (q - plan.held_after(&mut cursor, t_s - late_s).position).powi(2));
        squares.sum::<f64>()
    };
    let delays_s = std::iter::successors(Some(0.0), |late_s| Some(late_s + LATER_S))
        .take_while(|late_s| *late_s <= LATEST_S);
    (delays_s.map(at).fold(f64::INFINITY, f64::min) / instants().count().max(1) as f64).sqrt()
}
