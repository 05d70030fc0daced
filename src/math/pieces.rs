//! The course of values over time as pieces, each a level or a straight line: where it jumps, and where it begins or ends to change.

use std::ops::Range;

use statrs::distribution::{ContinuousCDF, FisherSnedecor, StudentsT};

use super::{SIGMA_PER_MAD, mad, statistic::quantum};

/// Points of a level and of a line, at least: fewer are anything.
const FEWEST: [usize; 2] = [2, 4];
/// What a level and a line cost, each with its place, in natural logarithms of the number of points: twice that of Schwarz
/// (1978, doi:10.1214/aos/1176344136) and more, since places are chosen, and a slope is told as a change.
const COSTS: [f64; 2] = [4.0, 7.0];
/// What a jump costs in the same.
const COST_OF_JUMP: f64 = 2.0;
/// A jump below so many of its standard errors joins two pieces.
const JUMPS: f64 = 3.0;

/// A stretch of the points.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// The points.
    pub points: Range<usize>,
    /// The value at its first and at its last point.
    pub ends: [f64; 2],
    /// Its slope, per unit of time; 0 of a level.
    pub slope: f64,
    /// The 95 % interval of that, by Student's t, where the piece is known to be there.
    pub interval: [f64; 2],
    /// Its value less that of the piece before, where they are nearest between their points, and the 95 % interval, where the course
    /// jumps there.
    pub jump: Option<(f64, [f64; 2])>,
}

/// The pieces of a series.
#[derive(Debug, Clone, PartialEq)]
pub struct Pieces {
    /// In the order of time.
    pub pieces: Vec<Piece>,
    /// Probability of such pieces by chance where all is one level: that of Fisher's F, times the ways to place them.
    pub p: f64,
    /// The same where all is one line.
    pub p_of_line: f64,
}

/// Sums over points from the first on.
#[derive(Clone, Copy, Default)]
struct Sums {
    n: f64,
    t: f64,
    y: f64,
    tt: f64,
    ty: f64,
    yy: f64,
}

/// One way to draw a stretch.
#[derive(Clone, Copy)]
struct Drawn {
    slope: f64,
    squares: f64,
    /// The sum of the squares of time about its mean.
    spread: f64,
    mean: [f64; 2],
}

impl Sums {
    fn less(self, other: Self) -> Self {
        Self {
            n: self.n - other.n,
            t: self.t - other.t,
            y: self.y - other.y,
            tt: self.tt - other.tt,
            ty: self.ty - other.ty,
            yy: self.yy - other.yy,
        }
    }

    fn drawn(self, is_line: bool) -> Drawn {
        let mean = [self.t / self.n, self.y / self.n];
        let (spread, along) = (self.tt - self.t * mean[0], self.ty - self.t * mean[1]);
        let slope = if is_line && spread > 0.0 { along / spread } else { 0.0 };
        let squares = self.yy - self.y * mean[1] - slope * along;
        Drawn { slope, squares: squares.max(0.0), spread, mean }
    }
}

/// The pieces of points `(time, value)` in order of time that explain them best for what they cost; `None` of fewer than six points,
/// or where none differs. O(n²).
pub fn pieces(points: &[(f64, f64)]) -> Option<Pieces> {
    let n = points.len();
    let values: Vec<f64> = points.iter().map(|point| point.1).collect();
    let variance = variance(&values).filter(|variance| n >= 6 && *variance > 0.0)?;
    let middle = [points[n / 2].0, points[n / 2].1];
    let mut sums = vec![Sums::default()];
    for (t, y) in points {
        let (t, y, last) = (t - middle[0], y - middle[1], sums[sums.len() - 1]);
        sums.push(Sums {
            n: last.n + 1.0,
            t: last.t + t,
            y: last.y + y,
            tt: last.tt + t * t,
            ty: last.ty + t * y,
            yy: last.yy + y * y,
        });
    }
    let cost = (n as f64).ln();
    let of = |from: usize, to: usize, is_line: bool| {
        let drawn = sums[to].less(sums[from]).drawn(is_line);
        (to - from >= FEWEST[usize::from(is_line)])
            .then(|| drawn.squares / variance + cost * COSTS[usize::from(is_line)])
    };
    // The least cost of all points before each, and the piece that ends there.
    let mut best: Vec<(f64, usize, bool)> = vec![(0.0, 0, false)];
    for to in 1..=n {
        let mut least = (f64::INFINITY, 0, false);
        for (from, before) in best.iter().enumerate() {
            for is_line in [false, true] {
                if let Some(own) =
                    of(from, to, is_line).map(|own| before.0 + own).filter(|own| *own < least.0)
                {
                    least = (own, from, is_line);
                }
            }
        }
        best.push(least);
    }
    let mut drawn = Vec::new();
    let mut to = n;
    while to > 0 {
        let (_, from, is_line) = best[to];
        drawn.push((from..to, is_line, sums[to].less(sums[from]).drawn(is_line)));
        to = from;
    }
    drawn.reverse();
    let squares: f64 = drawn.iter().map(|(.., drawn)| drawn.squares).sum();
    let numbers: f64 = drawn.iter().map(|(_, is_line, _)| if *is_line { 2.0 } else { 1.0 }).sum();
    let breaks = drawn.len() - 1;
    let freedom = (n as f64 - numbers - breaks as f64).max(1.0);
    let left = (squares / freedom).max(variance.min(quantum(&values).powi(2) / 12.0));
    let t = StudentsT::new(0.0, 1.0, freedom).ok()?.inverse_cdf(0.975);
    for k in 1..drawn.len() {
        let joined = join(points, &drawn[k - 1], &drawn[k], middle);
        // One number less than if it jumped there.
        let apart = drawn[k - 1].2.squares + drawn[k].2.squares;
        if let Some(joined) =
            joined.filter(|joined| (joined[0].2.squares - apart) / variance < COST_OF_JUMP * cost)
        {
            let [before, after] = joined;
            (drawn[k - 1], drawn[k]) = (before, after);
        }
    }
    let mut pieces: Vec<Piece> = Vec::new();
    // The variance of a line at a point of it.
    let known = |drawn: &Drawn, is_line: bool, at: f64, points: usize| {
        let aside =
            if is_line && drawn.spread > 0.0 { (at - drawn.mean[0]).powi(2) / drawn.spread } else { 0.0 };
        left * (1.0 / points as f64 + aside)
    };
    // Its last value and slope, when that was, and the variance of the value.
    let mut before: Option<[f64; 4]> = None;
    for (range, is_line, drawn) in drawn {
        let at = [points[range.start].0 - middle[0], points[range.end - 1].0 - middle[0]];
        let ends = at.map(|at| middle[1] + drawn.mean[1] + drawn.slope * (at - drawn.mean[0]));
        let error = at.map(|at| known(&drawn, is_line, at, range.len()));
        let half = if drawn.spread > 0.0 { t * (left / drawn.spread).sqrt() } else { 0.0 };
        let own = [ends[0], drawn.slope, at[0], error[0]];
        let jump = before.map(|before| apart(before, own));
        let jump = jump.filter(|(jump, error)| jump.abs() > JUMPS * error);
        pieces.push(Piece {
            points: range,
            ends,
            slope: drawn.slope,
            interval: [drawn.slope - half, drawn.slope + half],
            jump: jump.map(|(jump, error)| (jump, [jump - t * error, jump + t * error])),
        });
        before = Some([ends[1], drawn.slope, at[1], error[1]]);
    }
    let places = (1..=breaks).map(|k| (n - k) as f64 / k as f64).product::<f64>();
    // By chance where all is one level, or one line.
    let by_chance = |is_line: bool| {
        let more = numbers + breaks as f64 - if is_line { 2.0 } else { 1.0 };
        if more <= 0.0 {
            return 1.0;
        }
        let ratio = ((sums[n].drawn(is_line).squares - left * freedom) / more).max(0.0) / left;
        let one = FisherSnedecor::new(more, freedom).map_or(1.0, |f| f.sf(ratio));
        (one * places * 2.0_f64.powf(breaks as f64 + 1.0)).min(1.0)
    };
    let [p, p_of_line] = [false, true].map(by_chance);
    Some(Pieces { pieces, p, p_of_line })
}

/// By how much a line leaves another one where they are nearest between their ends, and the standard error; each by its value there, its
/// slope, when that is, and the variance of the value.
fn apart(before: [f64; 4], own: [f64; 4]) -> (f64, f64) {
    let gap = own[2] - before[2];
    let apart = [own[0] - own[1] * gap - before[0], own[0] - before[0] - before[1] * gap];
    let least = if apart[0].abs() < apart[1].abs() { apart[0] } else { apart[1] };
    // Lines that meet between the two points do not jump there.
    let jump = if apart[0] * apart[1] < 0.0 { 0.0 } else { least };
    (jump, (before[3] + own[3]).sqrt())
}

/// A stretch of the points, whether a line is drawn through it, and that.
type Stretch = (Range<usize>, bool, Drawn);

/// Two stretches of which one at least is a line, drawn so that they meet at the point where that leaves least; the squares of both are
/// told with the first.
fn join(points: &[(f64, f64)], before: &Stretch, after: &Stretch, middle: [f64; 2]) -> Option<[Stretch; 2]> {
    let (from, to) = (before.0.start, after.0.end);
    let own = &points[from..to];
    let least = |is_line: bool| FEWEST[usize::from(is_line)];
    let at =
        (from + least(before.1)..(to + 1).saturating_sub(least(after.1))).filter(|_| before.1 || after.1);
    let meeting = at.filter_map(|at| {
        let knot = points[at].0;
        // The value there, and the slopes before and after it.
        let rows = own.iter().map(|(t, y)| {
            let (off, is_after) = (t - knot, *t > knot);
            let before = if before.1 && !is_after { off } else { 0.0 };
            ([1.0, before, if after.1 && is_after { off } else { 0.0 }], y - middle[1])
        });
        let [value, falls, rises] = least_squares(rows.clone())?;
        let left = rows.map(|(x, y)| (y - value - falls * x[1] - rises * x[2]).powi(2)).sum::<f64>();
        Some((at, value, [falls, rises], left))
    });
    let (at, value, slopes, left) = meeting.min_by(|a, b| a.3.total_cmp(&b.3))?;
    let stretch = |range: Range<usize>, is_line: bool, slope: f64, squares: f64| {
        let own: Vec<f64> = points[range.clone()].iter().map(|point| point.0 - middle[0]).collect();
        let mean = own.iter().sum::<f64>() / own.len() as f64;
        let spread = own.iter().map(|t| (t - mean).powi(2)).sum();
        let level = value + slope * (mean - (points[at].0 - middle[0]));
        (range, is_line, Drawn { slope, squares, spread, mean: [mean, level] })
    };
    Some([stretch(from..at, before.1, slopes[0], left), stretch(at..to, after.1, slopes[1], 0.0)])
}

/// The numbers by which rows of three make their values best; those of a column without anything are 0.
fn least_squares(rows: impl Iterator<Item = ([f64; 3], f64)>) -> Option<[f64; 3]> {
    let (mut a, mut b) = ([[0.0; 3]; 3], [0.0; 3]);
    for (x, y) in rows {
        for i in 0..3 {
            b[i] += x[i] * y;
            for j in 0..3 {
                a[i][j] += x[i] * x[j];
            }
        }
    }
    let mut a = nalgebra::Matrix3::from(a);
    for k in (0..3).filter(|k| a[(*k, *k)] <= 0.0).collect::<Vec<usize>>() {
        a[(k, k)] = 1.0;
    }
    let found = a.cholesky()?.solve(&nalgebra::Vector3::from(b));
    Some([found[0], found[1], found[2]])
}

/// The variance of values about their course, from what lies between neighbours, to which neither jumps nor slopes add much.
fn variance(values: &[f64]) -> Option<f64> {
    let steps: Vec<f64> = values.windows(2).map(|two| two[1] - two[0]).collect();
    let variance = (SIGMA_PER_MAD * mad(&steps)).powi(2) / 2.0;
    let least = quantum(values).powi(2) / 12.0;
    variance.is_finite().then_some(variance.max(least))
}

#[cfg(test)]
mod tests {
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal, StudentT};

    use super::*;

    fn course(seed: u64, count: u32, of: impl Fn(f64) -> f64) -> Pieces {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let points: Vec<(f64, f64)> = (0..count)
            .map(|k| {
                let noise: f64 = StandardNormal.sample(&mut rng);
                (2.0 * f64::from(k), of(2.0 * f64::from(k)) + 0.1 * noise)
            })
            .collect();
        pieces(&points).unwrap()
    }

    #[test]
    fn a_level_that_grows_and_drops_again_is_told_as_it_was() {
        let (mut slopes, mut jumps) = (0, 0);
        for seed in 0..40 {
            let found = course(seed, 60, |t| if (50.0..90.0).contains(&t) { 0.03 * (t - 50.0) } else { 0.0 });
            assert!(found.p < 1e-6, "{found:?}");
            let ramp = found.pieces.iter().find(|piece| piece.slope > 0.0).unwrap();
            assert!((22..=29).contains(&ramp.points.start) && ramp.jump.is_none(), "{found:?}");
            assert!((43..=46).contains(&ramp.points.end), "{found:?}");
            slopes += usize::from(ramp.interval[0] < 0.03 && ramp.interval[1] > 0.03);
            let drop = found.pieces.iter().filter_map(|piece| piece.jump).find(|jump| jump.0 < -0.8);
            let (jump, [low, high]) = drop.unwrap();
            assert!((jump + 1.17).abs() < 0.3, "{found:?}");
            jumps += usize::from(low < -1.14 && high > -1.2);
        }
        assert!(slopes >= 34 && jumps >= 34, "{slopes} and {jumps} of 40 intervals hold the truth");
    }

    #[test]
    fn a_fault_that_is_mended_is_two_jumps_and_the_newest_two_points_may_be_one() {
        for seed in 0..20 {
            let found = course(seed, 50, |t| if (30.0..64.0).contains(&t) { 0.6 } else { 0.0 });
            let jumps: Vec<(usize, f64)> =
                found.pieces.iter().filter_map(|piece| Some((piece.points.start, piece.jump?.0))).collect();
            assert!(
                matches!(jumps.as_slice(), [(15, up), (32, down)] if *up > 0.4 && *down < -0.4),
                "{found:?}"
            );
            let late = course(seed, 30, |t| if t > 55.0 { 2.0 } else { 0.0 });
            assert!(late.p < 1e-3 && late.pieces.last().unwrap().points == (28..30), "{late:?}");
        }
    }

    #[test]
    fn a_line_is_one_piece() {
        let found = course(3, 40, |t| 0.05 * t);
        assert!(
            found.pieces.len() == 1 && (found.pieces[0].slope - 0.05).abs() < 0.005 && found.p < 1e-9,
            "{found:?}"
        );
    }

    #[test]
    fn equal_values_and_few_have_none() {
        assert_eq!(pieces(&[(0.0, 1.0); 12]), None);
        assert_eq!(pieces(&[]), None);
        assert_eq!(pieces(&(0..5).map(|k| (f64::from(k), f64::from(k))).collect::<Vec<_>>()), None);
    }

    #[test]
    fn noise_has_pieces_no_more_often_than_p_says() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        let heavy = StudentT::new(3.0).unwrap();
        for count in [6_u32, 12, 30] {
            for is_heavy in [false, true] {
                let mut draw =
                    || if is_heavy { heavy.sample(&mut rng) } else { StandardNormal.sample(&mut rng) };
                let mut found = || {
                    let points: Vec<(f64, f64)> = (0..count).map(|k| (f64::from(k), draw())).collect();
                    pieces(&points).is_some_and(|found| found.p < 0.05)
                };
                let share = (0..2000).filter(|_| found()).count() as f64 / 2000.0;
                assert!(share < 0.065, "{count} values, heavy tails {is_heavy}: {share}");
            }
        }
    }
}
