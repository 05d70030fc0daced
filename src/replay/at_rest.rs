//! What a joint does while it rests before a start: stands, moves slowly (a load that sinks), or comes to rest after its last
//! motion. What its start adds to that is its start.

use crate::math::{Line, line};

/// A rest that is shorter, s, and a stretch of fewer samples tell nothing.
const SHORTEST_S: f64 = 0.4;
const FEWEST: usize = 8;

/// A slope of less than so many of its standard errors is none.
const SURE: f64 = 5.0;
/// A slope that is less in the second half of a rest by so many standard errors is of a joint that comes to rest, and is none
/// any more there below so many.
const SETTLES: f64 = 2.0;
/// Times in which the speed of what comes to rest falls to 1/e, s.
const TIME_S: [f64; 2] = [0.05, 5.0];

/// The motion of a joint at rest.
#[derive(Debug, Clone, Copy)]
pub(super) enum AtRest {
    Stands,
    /// At a speed, per second.
    Moves(f64),
    /// From where it was off by so much at an instant, s, it comes nearer by 1/e in a time, s.
    Settles {
        off: f64,
        at_s: f64,
        time_s: f64,
    },
}

impl AtRest {
    /// By the samples of a rest, as far as they tell; a speed up to `none` is none.
    pub(super) fn of(t_s: &[f64], position: &[f64], none: f64) -> Self {
        let long = t_s.last().zip(t_s.first()).is_some_and(|(last, first)| last - first >= SHORTEST_S);
        let Some((whole, error)) = slope(t_s, position).filter(|_| long) else { return Self::Stands };
        let middle = t_s.len() / 2;
        let halves =
            slope(&t_s[..middle], &position[..middle]).zip(slope(&t_s[middle..], &position[middle..]));
        let moves = if whole.abs() > none.max(SURE * error) { Self::Moves(whole) } else { Self::Stands };
        let Some(((first, first_error), (last, last_error))) = halves else { return moves };
        let last = last * first.signum();
        if last >= first.abs() - SETTLES * first_error.hypot(last_error) {
            return moves;
        }
        if last < none.max(SETTLES * last_error) {
            return Self::Stands;
        }
        let (at_s, apart_s) = (t_s[t_s.len() - 1], t_s[middle] - t_s[0]);
        let time_s = (apart_s / (first.abs() / last).ln()).clamp(TIME_S[0], TIME_S[1]);
        let course: Vec<f64> = t_s.iter().map(|t_s| ((at_s - t_s) / time_s).exp()).collect();
        Self::Settles { off: line(&course, position).slope, at_s, time_s }
    }

    /// Where it would be at an instant, but for a constant.
    pub(super) fn position(self, t_s: f64) -> f64 {
        match self {
            Self::Stands => 0.0,
            Self::Moves(speed) => speed * t_s,
            Self::Settles { off, at_s, time_s } => off * ((at_s - t_s) / time_s).exp(),
        }
    }

    /// Its speed at an instant, per second.
    pub(super) fn speed(self, t_s: f64) -> f64 {
        match self {
            Self::Stands => 0.0,
            Self::Moves(speed) => speed,
            Self::Settles { time_s, .. } => -self.position(t_s) / time_s,
        }
    }
}

/// The slope of a line, and its standard error; `None` of too few samples.
pub(super) fn slope(t_s: &[f64], position: &[f64]) -> Option<(f64, f64)> {
    if t_s.len() < FEWEST {
        return None;
    }
    let Line { slope, square, left } = line(t_s, position);
    let squares = left.iter().map(|x| x * x).sum::<f64>();
    let neighbours = left.windows(2).map(|w| w[0] * w[1]).sum::<f64>();
    let correlation = if squares > 0.0 { (neighbours / squares).clamp(0.0, 0.99) } else { 0.0 };
    let redundancy = (1.0 + correlation) / (1.0 - correlation);
    Some((slope, (redundancy * squares / (t_s.len() as f64 - 2.0) / square).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_stands_moves_or_comes_to_rest() {
        let t_s: Vec<f64> = (0..250).map(|k| f64::from(k) * 0.01).collect();
        let of = |course: &dyn Fn(f64) -> f64| {
            let noise = |k: usize| 1e-3 * ((k * k * 7 + k) % 17) as f64 / 17.0;
            let position: Vec<f64> = t_s.iter().enumerate().map(|(k, t)| course(*t) + noise(k)).collect();
            AtRest::of(&t_s, &position, 1e-4)
        };
        assert!(matches!(of(&|_| 1.0), AtRest::Stands));
        let AtRest::Moves(speed) = of(&|t| 1.0 - 0.01 * t) else { panic!("it moves") };
        assert!((speed + 0.01).abs() < 3e-4, "{speed}");
        let settles = of(&|t| 1.0 + 0.1 * (-t / 0.7).exp());
        let AtRest::Settles { time_s, .. } = settles else { panic!("{settles:?}") };
        assert!((time_s - 0.7).abs() < 0.05, "{time_s}");
        for t_s in [0.5, 2.0, 3.0] {
            assert!((settles.position(t_s) - 0.1 * (-t_s / 0.7_f64).exp()).abs() < 2e-3, "{settles:?}");
            assert!((settles.speed(t_s) + 0.1 / 0.7 * (-t_s / 0.7_f64).exp()).abs() < 5e-3, "{settles:?}");
        }
        assert!(matches!(of(&|t| 1.0 + 0.1 * (-t / 0.1).exp()), AtRest::Stands), "long since");
    }
}
