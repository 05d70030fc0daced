//! Rest and motion of one signal: a state machine with hysteresis.

use std::ops::Range;

use super::{Rules, Sizes};

/// One signal as the state machine sees it; arrays are `[n]`.
pub(super) struct Speed<'a> {
    pub(super) t_s: &'a [f64],
    /// Angle, free of noise as far as possible, rad.
    pub(super) position_rad: &'a [f64],
    pub(super) velocity_rad_s: &'a [f64],
    /// Standard deviation of each velocity, rad/s; `None` for what has no noise.
    pub(super) deviation_rad_s: Option<&'a [f64]>,
    pub(super) segments: &'a [Range<usize>],
    /// Whether it is a plan, which may step.
    pub(super) is_plan: bool,
    /// Net travel of a motion, at least.
    pub(super) min_travel: f64,
    /// Thresholds of a joint of this kind.
    pub(super) sizes: Sizes,
}

/// A stretch of motion in one direction, inside one segment.
#[derive(Debug, Clone, PartialEq)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "both ends, seen or not and turned or not, are independent"
)]
pub(super) struct Motion {
    /// +1 or -1.
    pub(super) direction: i8,
    /// Samples above the stop threshold.
    pub(super) samples: Range<usize>,
    /// The segment it lies in.
    pub(super) segment: Range<usize>,
    /// Crossing of the stop threshold on the way up, s.
    pub(super) start_s: f64,
    /// Crossing of the stop threshold on the way down, s.
    pub(super) end_s: f64,
    /// Rest before it in its segment, s.
    pub(super) rest_before_s: f64,
    /// Under way when its segment begins, so that its start was not seen.
    pub(super) opens: bool,
    /// Under way when its segment ends.
    pub(super) closes: bool,
    /// Follows the opposite motion without a rest.
    pub(super) reversal: bool,
    /// Followed by the opposite motion without a rest.
    pub(super) reversed: bool,
}

/// A plan that covers so much of a motion between two samples steps.
const STEP_SHARE: f64 = 0.9;

impl Motion {
    /// Whether its beginning was seen.
    pub(super) fn starts(&self) -> bool {
        !self.opens
    }

    /// The first sample with the new value of a set value that steps.
    pub(super) fn step(&self, position: &[f64]) -> Option<usize> {
        let (first, last) = (self.samples.start, self.samples.end - 1);
        // The sample beside what was smoothed may hold the old value or the new one.
        let around = first.max(self.segment.start + 1)..(last + 2).min(self.segment.end);
        let travel = |from: usize, to: usize| f64::from(self.direction) * (position[to] - position[from]);
        let whole = travel(first.saturating_sub(1).max(self.segment.start), around.end - 1);
        around.into_iter().find(|&to| whole > 0.0 && travel(to - 1, to) >= STEP_SHARE * whole)
    }

    /// Whether it ends in a rest that was seen.
    pub(super) fn stops(&self) -> bool {
        !self.closes && !self.reversed
    }
}

impl Speed<'_> {
    /// Start and stop thresholds at one sample, rad/s.
    pub(super) fn thresholds(&self, i: usize, rules: &Rules) -> (f64, f64) {
        let deviation = self.deviation_rad_s.map_or(0.0, |d| d[i]);
        (
            self.sizes.start_speed.max(rules.start_sigmas * deviation),
            self.sizes.stop_speed.max(rules.stop_sigmas * deviation),
        )
    }

    /// All motions, in time order.
    pub(super) fn motions(&self, rules: &Rules) -> Vec<Motion> {
        let mut motions = Vec::new();
        for segment in self.segments {
            let mut found = self.stretches(segment, rules);
            absorb_short_rests(&mut found, rules);
            found.retain(|m| self.is_motion(m, rules));
            absorb_short_rests(&mut found, rules);
            self.relate(&mut found, rules);
            motions.append(&mut found);
        }
        motions
    }

    fn stretches(&self, segment: &Range<usize>, rules: &Rules) -> Vec<Motion> {
        let mut found: Vec<Motion> = Vec::new();
        let mut i = segment.start;
        while i < segment.end {
            if self.velocity_rad_s[i].abs() <= self.thresholds(i, rules).0 {
                i += 1;
                continue;
            }
            let sign = self.velocity_rad_s[i].signum();
            let moving = |k: usize| sign * self.velocity_rad_s[k] > self.thresholds(k, rules).1;
            let earliest = found.last().map_or(segment.start, |m| m.samples.end);
            let first = (earliest..i).rev().take_while(|&k| moving(k)).last().unwrap_or(i);
            let last = (i + 1..segment.end).take_while(|&k| moving(k)).last().unwrap_or(i);
            found.push(Motion {
                direction: if sign > 0.0 { 1 } else { -1 },
                samples: first..last + 1,
                segment: segment.clone(),
                start_s: self.crossing_s(first, first.checked_sub(1).filter(|&k| k >= segment.start), rules),
                end_s: self.crossing_s(last, Some(last + 1).filter(|&k| k < segment.end), rules),
                rest_before_s: 0.0,
                opens: false,
                closes: last + 1 == segment.end,
                reversal: false,
                reversed: false,
            });
            i = last + 1;
        }
        found
    }

    /// When the speed crosses the stop threshold between a sample above and one below, s.
    fn crossing_s(&self, above: usize, below: Option<usize>, rules: &Rules) -> f64 {
        let Some(below) = below else {
            return self.t_s[above];
        };
        let sign = self.velocity_rad_s[above].signum();
        let over = sign * self.velocity_rad_s[above] - self.thresholds(above, rules).1;
        let under = self.thresholds(below, rules).1 - sign * self.velocity_rad_s[below];
        let share = if over + under > 0.0 { (under / (over + under)).clamp(0.0, 1.0) } else { 1.0 };
        self.t_s[below] + share * (self.t_s[above] - self.t_s[below])
    }

    fn is_motion(&self, motion: &Motion, rules: &Rules) -> bool {
        let (first, last) = (motion.samples.start, motion.samples.end - 1);
        let travel_rad = f64::from(motion.direction) * (self.position_rad[last] - self.position_rad[first]);
        let steps = self.is_plan && travel_rad >= rules.step_travels * self.min_travel;
        travel_rad >= self.min_travel && (steps || motion.end_s - motion.start_s >= rules.min_motion_s)
    }

    /// Tells openings and reversals, which need the motion before.
    fn relate(&self, motions: &mut [Motion], rules: &Rules) {
        for k in 0..motions.len() {
            let (before, rest) = motions.split_at_mut(k);
            let motion = &mut rest[0];
            if let Some(previous) = before.last_mut() {
                motion.rest_before_s = motion.start_s - previous.end_s;
                // Of one direction they would have been joined.
                motion.reversal = motion.rest_before_s < rules.min_rest_s;
                previous.reversed = motion.reversal;
            } else {
                motion.rest_before_s = motion.start_s - self.t_s[motion.segment.start];
                motion.opens = motion.rest_before_s < rules.opening_rest_s;
            }
        }
    }
}

fn absorb_short_rests(motions: &mut Vec<Motion>, rules: &Rules) {
    motions.dedup_by(|next, kept| {
        let same = next.direction == kept.direction && next.start_s - kept.end_s < rules.min_rest_s;
        if same {
            kept.samples.end = next.samples.end;
            kept.end_s = next.end_s;
            kept.closes = next.closes;
        }
        same
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::DEGREE_RAD;

    /// Motions of a speed given per 10 ms in degrees per second.
    fn motions(speed: &[f64], segments: &[Range<usize>]) -> Vec<Motion> {
        let t_s: Vec<f64> = (0..speed.len()).map(|k| k as f64 * 0.01).collect();
        let velocity_rad_s: Vec<f64> = speed.iter().map(|v| v * DEGREE_RAD).collect();
        let position_rad: Vec<f64> = velocity_rad_s
            .iter()
            .scan(0.0, |x, v| {
                *x += v * 0.01;
                Some(*x)
            })
            .collect();
        let rules = Rules::default();
        let speed = Speed {
            t_s: &t_s,
            position_rad: &position_rad,
            velocity_rad_s: &velocity_rad_s,
            deviation_rad_s: None,
            is_plan: true,
            segments,
            min_travel: rules.turning.min_travel,
            sizes: rules.turning,
        };
        speed.motions(&rules)
    }

    fn speeds(parts: &[(usize, f64)]) -> Vec<f64> {
        parts.iter().flat_map(|&(n, v)| std::iter::repeat_n(v, n)).collect()
    }

    #[test]
    fn a_short_rest_is_absorbed_and_a_long_one_is_not() {
        let of = |rest: usize| {
            let speed = speeds(&[(50, 0.0), (50, 2.0), (rest, 0.0), (50, 2.0), (50, 0.0)]);
            let n = speed.len();
            motions(&speed, std::slice::from_ref(&(0..n))).len()
        };
        assert_eq!((of(10), of(30)), (1, 2));
    }

    #[test]
    fn a_turn_without_rest_is_a_reversal_and_no_stop() {
        let speed = speeds(&[(50, 0.0), (50, 2.0), (50, -2.0), (50, 0.0)]);
        let found = motions(&speed, std::slice::from_ref(&(0..200)));
        assert_eq!(found.len(), 2);
        assert!(!found[0].reversal && found[1].reversal);
        assert!(!found[0].stops() && found[1].stops());
    }

    #[test]
    fn what_moves_when_the_segment_opens_has_no_start() {
        let speed = speeds(&[(50, 2.0), (50, 0.0), (50, 2.0)]);
        let found = motions(&speed, std::slice::from_ref(&(0..150)));
        assert_eq!(found.iter().map(Motion::starts).collect::<Vec<_>>(), [false, true]);
        assert_eq!(found.iter().map(Motion::stops).collect::<Vec<_>>(), [true, false]);
    }

    #[test]
    fn a_plan_that_steps_moves_however_short_it_takes() {
        let of = |travel_deg: f64| {
            let speed = speeds(&[(50, 0.0), (5, 20.0 * travel_deg), (50, 0.0)]);
            motions(&speed, std::slice::from_ref(&(0..105))).len()
        };
        assert_eq!((of(0.15), of(2.0)), (0, 1));
    }

    #[test]
    fn a_twitch_and_a_creep_are_no_motion() {
        let twitch = speeds(&[(50, 0.0), (8, 2.0), (50, 0.0)]);
        let creep = speeds(&[(50, 0.0), (20, 0.2), (50, 0.0)]);
        assert!(motions(&twitch, std::slice::from_ref(&(0..108))).is_empty());
        assert!(motions(&creep, std::slice::from_ref(&(0..120))).is_empty());
    }
}
