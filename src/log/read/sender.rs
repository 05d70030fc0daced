//! The samples of a sender that is slower than its log, or has a clock of its own: in the log each is held until the next one comes.

use crate::{
    math::{line, median},
    series::{Track, split_at_gaps},
};

/// Values that tell, at least, by themselves.
pub(super) const CHANGES: usize = 30;
/// Rows that a value is held for in the median, at least: fewer are a log in which a row was lost.
const HELD_ROWS: f64 = 1.5;
/// Rows that are looked at first.
const HEAD: usize = 4000;
/// One of so many values may turn back.
const TURNS: usize = 5;
/// Share of the values that come near their tick, and how near, in rows and in periods; and share that come with the next tick while
/// the plan moves: values that are rounded come as it pays.
const MOST: f64 = 0.8;
const NEAR_ROWS: f64 = 0.6;
const NEAR_PERIODS: f64 = 0.4;
const NEXT: f64 = 0.75;
/// Ticks without another value that are a rest, and values between rests that tell the period there.
const REST_TICKS: f64 = 5.0;
const TELL: usize = 12;
/// Values that come within these of the median step come with the next tick.
const USUAL: std::ops::Range<f64> = 0.4..1.6;
/// A value that comes so many ticks after the one before may be late by chance; of so many around it, not all are.
const LATE_TICKS: f64 = 1.5;
const AROUND: usize = 5;
/// A value that comes a tick late in motion was lost before: the step to it is larger than the one before by so much.
const LOST_TICKS: f64 = 3.0;
const LOST_STEP: f64 = 1.5;

/// The values of a track that is held, each at its tick where the sender's clock is even, and where it came elsewhere; `None` of one
/// that is not held, or has fewer than `least` values.
pub(super) fn sampled(track: &Track, least: usize) -> Option<Track> {
    let (t_s, q) = (track.t_s(), track.position());
    let changed = |rows: usize| (1..rows).filter(|&i| (q[i] - q[i - 1]).abs() > 0.0);
    // Most plans tell by their first rows that each is another.
    let head = HEAD.min(q.len());
    let first = changed(head).count();
    if first >= least && HELD_ROWS * first as f64 > head as f64 {
        return None;
    }
    let changes: Vec<usize> = changed(q.len()).collect();
    if changes.len() < least || HELD_ROWS * changes.len() as f64 > q.len() as f64 {
        return None;
    }
    let came_s: Vec<f64> = changes.iter().map(|&i| t_s[i]).collect();
    let value: Vec<f64> = changes.iter().map(|&i| q[i]).collect();
    let (usual_s, row_s) = (median(steps_s(&came_s)), track.sample_interval_s());
    // Values that come and go are no plan of a motion.
    if usual_s < HELD_ROWS * row_s || TURNS * turns(&came_s, &value, REST_TICKS * usual_s) > value.len() {
        return None;
    }
    let (t_s, q) = match Clock::of(&came_s, row_s) {
        Some(clock) => {
            // A sender that computes a value when it sends it is late with both.
            let sent_s = [clock.sent_s(&came_s), came_s];
            let sent_s = sent_s.into_iter().min_by(|a, b| bend(a, &value).total_cmp(&bend(b, &value)))?;
            let is_lost = |k: usize| clock.is_lost(k, &value);
            samples(track, (&sent_s, &value), (clock.period_s, 0.5 * clock.period_s), is_lost)?
        }
        // Sent where the plan moved, or whenever there was time: after a silence it moved before the value came.
        None => samples(track, (&came_s, &value), (usual_s, REST_TICKS * usual_s), |_| false)?,
    };
    smooth(track, t_s, q)
}

fn steps_s(came_s: &[f64]) -> Vec<f64> {
    came_s.windows(2).map(|two| two[1] - two[0]).collect()
}

/// How often values turn back without a rest of so long.
fn turns(came_s: &[f64], value: &[f64], rests_s: f64) -> usize {
    let back = |k: &usize| (value[k + 2] - value[k + 1]) * (value[k + 1] - value[*k]) < 0.0;
    let moving = |k: &usize| came_s[k + 2] - came_s[k + 1] < rests_s && came_s[k + 1] - came_s[*k] < rests_s;
    (0..value.len().saturating_sub(2)).filter(moving).filter(back).count()
}

/// Values at instants, with those of rests between: each holds until so long before the next, but where one was lost.
fn samples(
    track: &Track,
    (sent_s, value): (&[f64], &[f64]),
    (period_s, before_s): (f64, f64),
    is_lost: impl Fn(usize) -> bool,
) -> Option<(Vec<f64>, Vec<f64>)> {
    let (mut t_s, mut q) = (vec![*track.t_s().first()?], vec![*track.position().first()?]);
    for (k, (at_s, now)) in sent_s.iter().zip(value).enumerate() {
        if !is_lost(k) {
            hold(&mut t_s, &mut q, at_s - before_s, period_s);
        }
        if *at_s > *t_s.last()? {
            t_s.push(*at_s);
            q.push(*now);
        }
    }
    let end_s = *track.t_s().last()?;
    hold(&mut t_s, &mut q, end_s - 0.5 * period_s, period_s);
    if end_s > *t_s.last()? {
        t_s.push(end_s);
        q.push(*q.last()?);
    }
    Some((t_s, q))
}

/// Repeats the last value every period up to an instant.
fn hold(t_s: &mut Vec<f64>, q: &mut Vec<f64>, until_s: f64, period_s: f64) {
    let (Some(from_s), Some(held)) = (t_s.last().copied(), q.last().copied()) else { return };
    let more = (1..).map(|k| from_s + period_s * f64::from(k)).take_while(|at_s| *at_s < until_s);
    t_s.extend(more);
    q.resize(t_s.len(), held);
}

/// Samples as a track with the slopes of a curve through them that is nowhere beyond its neighbours (Fritsch and Carlson 1980).
fn smooth(track: &Track, t_s: Vec<f64>, q: Vec<f64>) -> Option<Track> {
    let slope = |k: usize| (q[k + 1] - q[k]) / (t_s[k + 1] - t_s[k]);
    let through = |k: usize| {
        let (before, after) = (slope(k - 1), slope(k));
        let (short_s, long_s) = (t_s[k] - t_s[k - 1], t_s[k + 1] - t_s[k]);
        if before * after <= 0.0 {
            return 0.0;
        }
        let (one, other) = (2.0 * long_s + short_s, long_s + 2.0 * short_s);
        (one + other) / (one / before + other / after)
    };
    let last = q.len().checked_sub(1)?;
    let speed = (0..q.len()).map(|k| if k == 0 || k == last { 0.0 } else { through(k) }).collect();
    let cuts = split_at_gaps(&t_s);
    Track::of(track.kind(), track.name(), t_s, q, &cuts).ok()?.with_velocity(speed).ok()
}

/// How much a curve through samples bends, in the median: stamps that are early and late bend it.
fn bend(t_s: &[f64], q: &[f64]) -> f64 {
    let slope = |k: usize| (q[k + 1] - q[k]) / (t_s[k + 1] - t_s[k]).max(f64::MIN_POSITIVE);
    let bends = (1..q.len().saturating_sub(1)).map(|k| (slope(k) - slope(k - 1)).abs());
    median(bends.filter(|bend| bend.is_finite()).collect())
}

/// When a sender sends.
struct Clock {
    period_s: f64,
    /// Of each value, counted.
    ticks: Vec<f64>,
}

impl Clock {
    fn of(came_s: &[f64], row_s: f64) -> Option<Self> {
        let steps_s = steps_s(came_s);
        let middle_s = median(steps_s.clone());
        let usual = || steps_s.iter().filter(|step_s| USUAL.contains(&(*step_s / middle_s)));
        let mut period_s = usual().sum::<f64>() / usual().count().max(1) as f64;
        let mut ticks = counted(came_s, period_s);
        for _ in 0..2 {
            let moving = || (0..steps_s.len()).filter(|k| ticks[k + 1] - ticks[*k] <= REST_TICKS);
            let passed: f64 = moving().map(|k| ticks[k + 1] - ticks[k]).sum();
            period_s = moving().map(|k| steps_s[k]).sum::<f64>() / passed.max(1.0);
            ticks = counted(came_s, period_s);
        }
        let clock = Self { period_s, ticks };
        let steps = || clock.ticks.windows(2).map(|two| two[1] - two[0]).filter(|step| *step <= REST_TICKS);
        let next = steps().filter(|step| *step < 1.5).count();
        let near_s = (NEAR_ROWS * row_s).max(NEAR_PERIODS * period_s);
        let near = clock.sent_s(came_s).iter().zip(came_s).filter(|(a, b)| (*a - *b).abs() <= near_s).count();
        let even = near as f64 >= MOST * came_s.len() as f64;
        (even && next as f64 >= NEXT * steps().count() as f64).then_some(clock)
    }

    /// Whether the value before one, in motion, did not come: the step to it is as large as two.
    fn is_lost(&self, k: usize, value: &[f64]) -> bool {
        let Some(before) = k.checked_sub(2) else { return false };
        let [from, to] = [value[k - 1] - value[before], value[k] - value[k - 1]].map(f64::abs);
        self.ticks[k] - self.ticks[k - 1] <= LOST_TICKS && from > 0.0 && to > LOST_STEP * from
    }

    /// When each value was sent, by all between two rests.
    fn sent_s(&self, came_s: &[f64]) -> Vec<f64> {
        let mut sent_s = Vec::with_capacity(came_s.len());
        while sent_s.len() < came_s.len() {
            let from = sent_s.len();
            let rests = |two: &[f64]| two[1] - two[0] > REST_TICKS;
            let ends = self.ticks[from..].windows(2).position(rests).map_or(came_s.len(), |k| from + k + 1);
            let (ticks, came_s) = (&self.ticks[from..ends], &came_s[from..ends]);
            if ticks.len() < TELL {
                let phase_s = came_s.iter().zip(ticks).map(|(at_s, tick)| at_s - self.period_s * tick);
                let phase_s = phase_s.sum::<f64>() / ticks.len() as f64;
                sent_s.extend(ticks.iter().map(|tick| phase_s + self.period_s * tick));
            } else {
                let left = line(ticks, came_s).left;
                sent_s.extend(came_s.iter().zip(left).map(|(at_s, left)| at_s - left));
            }
        }
        sent_s
    }
}

/// Ticks of values that came at instants: each is of the next one, but where those from it on are later than those before by whole
/// periods.
fn counted(came_s: &[f64], period_s: f64) -> Vec<f64> {
    let (mut ticks, mut from) = (Vec::with_capacity(came_s.len()), 0);
    let mut tick = 0.0;
    for k in 0..came_s.len() {
        let passed = if k == 0 { 0.0 } else { (came_s[k] - came_s[k - 1]) / period_s };
        tick += if k == 0 {
            0.0
        } else if passed > REST_TICKS + 0.5 {
            from = k;
            passed.round()
        } else if passed > LATE_TICKS {
            let late_s = |range: std::ops::Range<usize>| {
                median(range.map(|k| came_s[k] - period_s * (k - from) as f64).collect())
            };
            let [before_s, after_s] =
                [from.max(k.saturating_sub(AROUND))..k, k..came_s.len().min(k + AROUND)].map(late_s);
            1.0 + ((after_s - before_s) / period_s - 0.1).round().max(0.0)
        } else {
            1.0
        };
        ticks.push(tick);
    }
    ticks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        math::smooth_step,
        rng::{Stream, stream},
    };
    use rand_distr::{Distribution, Uniform};

    /// A move of 40 deg, a rest, and the way back.
    fn plan(t_s: f64) -> f64 {
        0.7 * (smooth_step((t_s - 2.0) / 4.0) - smooth_step((t_s - 9.0) / 4.0))
    }

    /// A log at 100 Hz of what was sent at instants, and how far what is read bends more than the plan, rad/s².
    fn read(sent: impl Fn(f64, f64) -> (f64, f64), period_s: f64) -> Option<(f64, f64)> {
        let mut rng = stream(7, Stream::Sampling);
        let share = Uniform::new(0.0, 1.0).unwrap();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small number")]
        let count = (16.0 / period_s) as u32;
        let sent: Vec<(f64, f64)> =
            (0..count).map(|k| sent(f64::from(k) * period_s, share.sample(&mut rng))).collect();
        let t_s: Vec<f64> = (0..1600).map(|k| f64::from(k) * 0.01 + 0.003).collect();
        let at = |t: &f64| sent.iter().take_while(|(at_s, _)| at_s <= t).last().map_or(0.0, |(_, q)| *q);
        let track = Track::new("J", t_s.clone(), t_s.iter().map(at).collect(), &[]).unwrap();
        let found = sampled(&track, CHANGES)?;
        let x: Vec<f64> = (0..800).map(|k| found.held_at(f64::from(k) * 0.02).position).collect();
        let most = |x: &dyn Fn(usize) -> f64| {
            (1..799).map(|k| (x(k + 1) - 2.0 * x(k) + x(k - 1)).abs() / 4e-4).fold(0.0, f64::max)
        };
        let late = |t: &f64| (found.held_at(*t).position - plan(*t)).abs();
        let off = t_s.iter().map(late).fold(0.0, f64::max);
        Some((most(&|k| x[k]) / most(&|k| plan(k as f64 * 0.02)), off))
    }

    #[test]
    fn a_plan_of_another_clock_is_as_smooth_as_it_was_sent() {
        for period_s in [1.0 / 30.0, 1.0 / 47.0, 0.095, 0.0637] {
            let (more, off) = read(|t_s, _| (t_s, plan(t_s)), period_s).unwrap();
            assert!(more < 1.5 && off < 0.007, "{period_s}: {more} times the acceleration, {off} rad");
        }
        // What comes late by chance was made in time; or it was made as late as it comes.
        for (period_s, most_s) in [(0.02, 0.012), (0.05, 0.03), (0.2, 0.05)] {
            let (more, off) = read(|t_s, share| (t_s + share * most_s, plan(t_s)), period_s).unwrap();
            assert!(more < 3.0 && off < 0.02, "{period_s} and {most_s}: {more} times, {off} rad");
        }
        let made_late = |t_s: f64, share: f64| (t_s + 0.05 * share, plan(t_s + 0.05 * share));
        let (more, off) = read(made_late, 0.2).unwrap();
        assert!(more < 4.0 && off < 0.02, "{more} times, {off} rad");
    }

    /// Sent where the plan has moved, or whenever there was time.
    #[test]
    fn what_comes_without_a_clock_is_as_smooth_too() {
        let rows: Vec<f64> = (0..1600).map(|k| f64::from(k) * 0.01).collect();
        let mut next_s = 0.0;
        let mut often = |t_s: f64, held: f64| {
            if t_s < next_s {
                return held;
            }
            // Steps of 10 to 130 ms in an order without a period.
            next_s = t_s + 0.01 + 0.12 * (t_s * 1234.5).sin().abs();
            plan(t_s)
        };
        let by_change = |t_s: f64, held: f64| if (plan(t_s) - held).abs() > 0.02 { plan(t_s) } else { held };
        let smooth = |of: &mut dyn FnMut(f64, f64) -> f64| {
            let mut held = 0.0;
            let sent = rows.iter().map(|t_s| {
                held = of(*t_s, held);
                held
            });
            let track = Track::new("J", rows.clone(), sent.collect(), &[]).unwrap();
            let found = sampled(&track, CHANGES).unwrap();
            let steps =
                rows.windows(2).map(|two| found.held_at(two[1]).position - found.held_at(two[0]).position);
            let steps: Vec<f64> = steps.collect();
            steps.windows(2).map(|two| (two[1] - two[0]).abs() / 1e-4).fold(0.0, f64::max)
        };
        let found = [smooth(&mut { by_change }), smooth(&mut often)];
        assert!(found.iter().all(|sharpest| *sharpest < 2.0), "{found:?} rad/s2 of 0.25");
    }

    #[test]
    fn a_plan_of_its_log_and_values_without_a_clock_are_left() {
        assert!(read(|t_s, _| (t_s, plan(t_s)), 0.01).is_none());
        let seldom = |t_s: f64, share: f64| (t_s, if share < 0.3 { plan(t_s) } else { 0.0 });
        assert!(read(seldom, 0.013).is_none());
    }
}
