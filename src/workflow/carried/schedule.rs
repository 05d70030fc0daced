//! When a run passes the key points of its task, as far as its log tells.

use super::Carried;
use crate::{math::whole, task::Task};

/// A task and when its key points are reached and left.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    /// Text of the task.
    task: String,
    /// Ascending, s since the start of the log: arrival, and departure where the task dwells.
    knots_s: Vec<f64>,
}

impl Schedule {
    /// Of a log that carries a task, a plan of it, and when it starts.
    pub fn of(carried: &Carried) -> Option<Self> {
        let (task, times_s, starts_s) = (carried.task()?, carried.times_s()?, carried.starts_s()?);
        let points = Task::parse(&task).ok()?.points;
        if points.len() != times_s.len() {
            return None;
        }
        let mut knots_s = Vec::new();
        for (point, time_s) in points.iter().zip(times_s) {
            knots_s.push(starts_s + time_s);
            knots_s.extend(point.dwell_s.map(|dwell_s| starts_s + time_s + dwell_s));
        }
        let ascending = knots_s.windows(2).all(|pair| pair[0] < pair[1]);
        (ascending && knots_s.len() > 1).then_some(Self { task, knots_s })
    }

    /// Whether two runs are of one task.
    pub fn same_task(&self, other: &Self) -> bool {
        self.task == other.task && self.knots_s.len() == other.knots_s.len()
    }

    /// Time as a number of knots passed, the way to the next one as a part; before the first and after the
    /// last knot in seconds.
    pub fn phase(&self, t_s: f64) -> f64 {
        let (first, last) = self.ends();
        if t_s <= first {
            return t_s - first;
        }
        let count = (self.knots_s.len() - 1) as f64;
        if t_s >= last {
            return count + t_s - last;
        }
        let i = self.knots_s.partition_point(|knot| *knot <= t_s).clamp(1, self.knots_s.len() - 1);
        let (from, to) = (self.knots_s[i - 1], self.knots_s[i]);
        (i - 1) as f64 + (t_s - from) / (to - from)
    }

    /// The time of a [`phase`](Self::phase), s.
    pub fn at(&self, phase: f64) -> f64 {
        let (first, last) = self.ends();
        let count = (self.knots_s.len() - 1) as f64;
        if phase <= 0.0 {
            return first + phase;
        }
        if phase >= count {
            return last + phase - count;
        }
        let i = whole(phase).min(self.knots_s.len() - 2);
        self.knots_s[i] + (phase - i as f64) * (self.knots_s[i + 1] - self.knots_s[i])
    }

    fn ends(&self) -> (f64, f64) {
        (self.knots_s.first().copied().unwrap_or(0.0), self.knots_s.last().copied().unwrap_or(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phase_and_time_are_inverse_and_keep_order_beyond_the_ends_too() {
        let schedule = Schedule { task: String::new(), knots_s: vec![1.5, 4.0, 6.0, 13.0] };
        let phases: Vec<f64> = (0..200).map(|k| schedule.phase(-2.0 + 0.1 * f64::from(k))).collect();
        for (k, phase) in (0..).zip(&phases) {
            assert!((schedule.at(*phase) - (-2.0 + 0.1 * f64::from(k))).abs() < 1e-12);
        }
        assert!(phases.windows(2).all(|pair| pair[0] < pair[1]));
        assert!((schedule.phase(5.0) - 1.5).abs() < 1e-12);
    }
}
