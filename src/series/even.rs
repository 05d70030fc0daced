//! Rows that were made at even steps and stamped when they arrived: a plan that is smooth from row to row, and rough by its stamps,
//! says so. A command made from it as stamped would shake its machine.

use super::{Track, signal::Instants};
use crate::math::{line, mean, median};

/// Fewest rows of a stretch that tell.
const FEWEST: usize = 50;
/// Stamps that are off by less, root mean square, s, do no harm.
const LEAST_OFF_S: f64 = 0.000_5;
/// Mean over so many rows, and by how many steps it may be off: rows that were lost, or a clock that goes otherwise, are no jitter.
const MEAN_OF: usize = 25;
const MOST_STEPS: f64 = 2.0;
/// Second derivatives by rows are at most this share of those by stamps, as squares.
const SMOOTHER: f64 = 0.25;

/// When rows were made, where their stamps are late by chance, and by how much these are off, root mean square, s. `None` where the plans
/// of these rows, which share their instants, do not say so.
pub(crate) fn even_instants(plans: &[&Track]) -> Option<(Instants, f64)> {
    let first = plans.first()?;
    let (mut t_s, mut squares, mut rows) = (first.t_s().to_vec(), 0.0, 0.0);
    for segment in first.segments() {
        let stamped = &first.t_s()[segment.clone()];
        let positions: Vec<&[f64]> = plans.iter().map(|plan| &plan.position()[segment.clone()]).collect();
        if let Some(even) = even(stamped, &positions) {
            squares += even.iter().zip(stamped).map(|(even, t)| (even - t).powi(2)).sum::<f64>();
            rows += stamped.len() as f64;
            t_s[segment.clone()].copy_from_slice(&even);
        }
    }
    let cuts: Vec<usize> = first.segments().iter().skip(1).map(|segment| segment.start).collect();
    let instants = Instants::new(t_s, &cuts).ok().filter(|_| rows > 0.0)?;
    Some((instants, (squares / rows).sqrt()))
}

/// At even steps, of which rows that were lost leave some out.
fn even(stamped: &[f64], plans: &[&[f64]]) -> Option<Vec<f64>> {
    if stamped.len() < FEWEST {
        return None;
    }
    let every = (0..stamped.len()).map(|k| k as f64).collect();
    let tried = [every, steps(stamped)].into_iter().filter_map(|steps| on_line(stamped, &steps));
    let best = tried.map(|t_s| (roughness(&t_s, plans), t_s)).min_by(|a, b| a.0.total_cmp(&b.0))?;
    (best.0 < SMOOTHER * roughness(stamped, plans)).then_some(best.1)
}

/// The step of each row, counted by the time since what the rows before it tell.
fn steps(stamped: &[f64]) -> Vec<f64> {
    const FOLLOWS: f64 = 0.05;
    let between_s: Vec<f64> = stamped.windows(2).map(|two| two[1] - two[0]).collect();
    // Two steps are no usual one.
    let most_s = 1.5 * median(between_s.clone());
    let usual_s: Vec<f64> = between_s.into_iter().filter(|between_s| *between_s < most_s).collect();
    let step_s = mean(&usual_s);
    let (mut step, mut at_s) = (0.0, stamped[0]);
    let one = |t_s: &f64| {
        let by = ((t_s - at_s) / step_s).round().max(1.0);
        step += by;
        at_s += by * step_s;
        at_s += FOLLOWS * (t_s - at_s);
        step
    };
    std::iter::once(0.0).chain(stamped[1..].iter().map(one)).collect()
}

/// The instants of steps; `None` where stamps are off them by next to nothing, or not by chance.
fn on_line(stamped: &[f64], steps: &[f64]) -> Option<Vec<f64>> {
    let found = line(steps, stamped);
    let off_s = (found.left.iter().map(|off| off * off).sum::<f64>() / steps.len() as f64).sqrt();
    let wanders =
        |window: &[f64]| (window.iter().sum::<f64>() / MEAN_OF as f64).abs() > MOST_STEPS * found.slope;
    (off_s >= LEAST_OFF_S && !found.left.windows(MEAN_OF).any(wanders))
        .then(|| stamped.iter().zip(&found.left).map(|(t, left)| t - left).collect())
}

/// Sum of squares of second derivatives.
fn roughness(t_s: &[f64], plans: &[&[f64]]) -> f64 {
    let bend = |(q, t): (&[f64], &[f64])| {
        let slopes = (q[2] - q[1]) / (t[2] - t[1]) - (q[1] - q[0]) / (t[1] - t[0]);
        (2.0 * slopes / (t[2] - t[0])).powi(2)
    };
    plans.iter().flat_map(|plan| plan.windows(3).zip(t_s.windows(3))).map(bend).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plan in rows of 10 ms, stamped late by `late`.
    fn track(late: impl Fn(u32) -> f64, is_held: bool) -> Track {
        let at = |k: u32| if is_held { k / 10 * 10 } else { k };
        let plan = |k: u32| 0.3 * (0.02 * f64::from(at(k))).sin();
        let t_s: Vec<f64> = (0..800).map(|k| 0.01 * f64::from(k) + late(k)).collect();
        Track::new("boom", t_s, (0..800).map(plan).collect(), &[]).unwrap()
    }

    #[test]
    fn rows_that_arrive_late_by_chance_were_made_evenly() {
        let late = |k: u32| 0.003 * f64::from(k.wrapping_mul(2_654_435_761) >> 16 & 0xff) / 255.0;
        let late_track = track(late, false);
        let (even, off_s) = even_instants(&[&late_track]).unwrap();
        let on_time = late_track.clone().at_instants(&even).unwrap();
        let step = |k: usize| on_time.t_s()[k + 1] - on_time.t_s()[k];
        assert!((0..799).all(|k| (step(k) - 0.01).abs() < 1e-5), "{:?}", &on_time.t_s()[..5]);
        assert!((0.000_5..0.001_2).contains(&off_s), "{off_s}");
    }

    #[test]
    fn rows_that_were_lost_among_them_leave_steps_out() {
        let late = |k: u32| 0.003 * f64::from(k.wrapping_mul(2_654_435_761) >> 16 & 0xff) / 255.0;
        let whole = track(late, false);
        let kept: Vec<usize> = (0..800).filter(|k| k % 41 != 7).collect();
        let of = |values: &[f64]| kept.iter().map(|k| values[*k]).collect::<Vec<f64>>();
        let some = Track::new("boom", of(whole.t_s()), of(whole.position()), &[]).unwrap();
        let (even, _) = even_instants(&[&some]).unwrap();
        let on_time = some.at_instants(&even).unwrap();
        let steps = on_time.t_s().windows(2).map(|two| (two[1] - two[0]) / 0.01);
        assert!(steps.map(|step| (step - step.round()).abs()).fold(0.0, f64::max) < 1e-3);
    }

    #[test]
    fn rows_that_were_sampled_unevenly_lost_or_held_are_as_they_are_stamped() {
        let uneven: Vec<f64> =
            (0..800).map(|k| 0.01 * f64::from(k) + 0.004 * f64::from(k * 7 % 5) / 4.0).collect();
        let sampled = uneven.iter().map(|t| 0.3 * (2.0 * t).sin()).collect();
        assert!(even_instants(&[&Track::new("boom", uneven, sampled, &[]).unwrap()]).is_none());
        let lost = |k: u32| 0.05 * f64::from(k / 100);
        assert!(even_instants(&[&track(lost, false)]).is_none());
        let late = |k: u32| 0.003 * f64::from(k * 7 % 5) / 4.0;
        assert!(even_instants(&[&track(late, true)]).is_none());
        assert!(even_instants(&[&track(|_| 0.0, false)]).is_none());
    }
}
