//! Shares of limits: at the nodes for most rows, between them where a limit is near.

use multiversion::multiversion;

use super::{Evaluator, Setup, limit::Limit, mesh::LOADED};
use crate::{arm::LANES, spline::Quantity};

/// Quantities that are splines, in the order of a joint's rows.
const SPLINES: [Quantity; 4] = Quantity::ALL;

/// Below this share of a limit the value at the nearest node serves, above `EXACT` the peak
/// between the nodes; between them a blend, so that an evaluation is continuous in the times.
/// Nodes miss peaks by about 1 %, of jerk by up to 6 %.
const COARSE: f64 = 0.75;
const EXACT: f64 = 0.85;
/// A plan this far beyond a limit is no candidate: from here to `COARSE_AGAIN` a blend back to the node.
const FAR_BROKEN: f64 = 1.5;
const COARSE_AGAIN: f64 = 2.0;

/// Positions that differ by less than this share of a range are one.
const TOUCHES: f64 = 1e-9;

/// What a row of limits is judged by.
enum Row {
    /// A spline, which has exact peaks.
    Spline { joint: usize, quantity: Quantity },
    /// A row of the mesh.
    Sampled { row: usize },
}

/// Which peaks of a row are wanted exactly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Wanted {
    /// That of each piece.
    Each,
    /// The largest: others are left at their nodes where they cannot be it.
    Largest,
}

impl Evaluator {
    /// What a row of limits is judged by.
    fn row(setup: &Setup, row: usize) -> Row {
        let (width, joints) = (Limit::OF_JOINT.len(), setup.limits.len());
        let (joint, k) = (row / width, row % width);
        match SPLINES.get(k).filter(|_| joint < joints) {
            Some(&quantity) => Row::Spline { joint, quantity },
            None if joint < joints => Row::Sampled { row: joint * LOADED + k - SPLINES.len() },
            None => Row::Sampled { row: joints * LOADED + row - joints * width },
        }
    }

    /// Shares of all limits. Most are so far from theirs that the nodes decide: those are done with at once.
    pub(super) fn limit_shares(&mut self, setup: &Setup) {
        let (count, joints) = (self.mesh.t_s.len(), setup.limits.len());
        self.peaks.resize(2 * (count / LANES), 0.0);
        self.extents.resize(self.shares.len(), [0.0; 2]);
        let (splines, sampled) = self.extents.split_at_mut(joints * SPLINES.len());
        for (quantity, to) in SPLINES.iter().zip(splines.chunks_exact_mut(joints.max(1))) {
            extents(self.mesh.samples.all(*quantity), count, to);
        }
        extents(&self.mesh.shares, count, sampled);
        let mut peaks = std::mem::take(&mut self.peaks);
        for row in 0..self.shares.len() {
            let (share, slack) = match Self::row(setup, row) {
                Row::Spline { joint, quantity } => {
                    let extent = self.extents[quantity.order() * joints + joint];
                    (self.farthest(setup, (joint, quantity), extent), 1.0)
                }
                Row::Sampled { row: at } => (self.extents[joints * SPLINES.len() + at][1], setup.slack[row]),
            };
            self.shares[row] = if share > COARSE {
                self.row_peaks(setup, row, &mut peaks, Wanted::Largest);
                largest(&peaks)
            } else {
                larger(share, 0.0) * slack
            };
        }
        self.peaks = peaks;
    }

    /// Shares of all limits, and their peaks by piece.
    pub(super) fn limit_peaks(&mut self, setup: &Setup) {
        let pieces = self.mesh.t_s.len() / LANES;
        self.peaks.resize(self.shares.len() * pieces * 2, 0.0);
        let mut peaks = std::mem::take(&mut self.peaks);
        for (row, peaks) in peaks.chunks_exact_mut(2 * pieces.max(1)).enumerate() {
            self.row_peaks(setup, row, peaks, Wanted::Each);
            self.shares[row] = largest(peaks);
        }
        self.peaks = peaks;
    }

    fn row_peaks(&self, setup: &Setup, row: usize, peaks: &mut [f64], wanted: Wanted) {
        match Self::row(setup, row) {
            Row::Spline { joint, quantity } => self.of_spline(setup, (joint, quantity), peaks, wanted),
            Row::Sampled { row: at } => self.sampled(at, setup.slack[row], peaks),
        }
    }

    /// The share of a limit at the nodes, between these values, and at the ends of segments.
    fn farthest(&self, setup: &Setup, (joint, quantity): (usize, Quantity), extent: [f64; 2]) -> f64 {
        let allowed = Allowed::of(setup, joint, quantity);
        let [mut least, mut most] = extent;
        for segment in self.motion.segments() {
            let control = segment.spline.control(joint, quantity);
            for value in [control.first(), control.last()].into_iter().flatten() {
                (least, most) = (smaller(*value, least), larger(*value, most));
            }
        }
        larger(allowed.share(1.0, most), allowed.share(-1.0, least))
    }

    /// Shares of a limit on a spline or its derivative, by piece.
    fn of_spline(
        &self,
        setup: &Setup,
        (joint, quantity): (usize, Quantity),
        peaks: &mut [f64],
        wanted: Wanted,
    ) {
        let allowed = Allowed::of(setup, joint, quantity);
        let middle = allowed.middle;
        let values = self.mesh.samples.of(quantity, joint);
        let (nodes, shares) = (values.as_chunks::<LANES>().0, peaks.as_chunks_mut::<2>().0);
        let mut most = at_nodes(nodes, &allowed, shares);
        // Most rows are far from their limit.
        let near = if most > COARSE { nodes.len() } else { 0 };
        // The highest piece comes first: then the others are seen to be lower.
        let highest = shares.iter().position(|shares| shares.contains(&most)).unwrap_or(0);
        let pieces = std::iter::once(highest).chain((0..near).filter(|piece| *piece != highest));
        for piece in pieces.take(near) {
            for (sign, share) in [1.0, -1.0].into_iter().zip(&mut shares[piece]) {
                let floor = if wanted == Wanted::Largest { most } else { 0.0 };
                *share = blend(*share, || {
                    let node =
                        piece * LANES + largest_node(nodes[piece].map(|value| sign * (value - middle)));
                    let floor = sign * middle + floor * allowed.toward(sign);
                    let found = self.near(joint, quantity, node, sign > 0.0, floor);
                    found.map_or(0.0, |value| allowed.share(sign, sign * value))
                });
                most = larger(*share, most);
            }
        }
        // At the ends of a segment, which no node reaches, the value is that of the outer control point.
        for (range, segment) in self.mesh.segment.iter().zip(self.motion.segments()) {
            let control = segment.spline.control(joint, quantity);
            let fixed = segment.spline.fixed_controls();
            for (instant, ascending) in [(range.start, true), (range.end.saturating_sub(1), false)] {
                let at =
                    |k: usize| control.get(if ascending { k } else { control.len().checked_sub(k + 1)? });
                let Some(mut value) = at(0) else { continue };
                // A rest at the end of a range touches it, and what leaves it by a high power of time does so without a slope: the first
                // control point that is free tells with one.
                let toward = allowed.toward(value - middle);
                let same = |k: usize| at(k).is_some_and(|other| (other - value).abs() <= TOUCHES * toward);
                let touches = (value - middle).abs() >= (1.0 - TOUCHES) * toward;
                if wanted == Wanted::Each && quantity == Quantity::Position && touches && (0..fixed).all(same)
                {
                    value = at(fixed).unwrap_or(value);
                }
                let piece = instant / LANES;
                for (sign, peak) in [1.0, -1.0].into_iter().zip(&mut peaks[2 * piece..2 * piece + 2]) {
                    *peak = peak.max(allowed.share(sign, *value));
                }
            }
        }
    }

    /// The greatest value (or negative value) between the neighbours of a node, if it exceeds `floor`.
    fn near(&self, joint: usize, quantity: Quantity, node: usize, greatest: bool, floor: f64) -> Option<f64> {
        let mesh = &self.mesh;
        let index = mesh.segment_of(node);
        let (range, segment) = (&mesh.segment[index], &self.motion.segments()[index]);
        let (start_s, end_s) = (segment.start_s, segment.start_s + segment.spline.duration_s());
        let from_s = if node > range.start { mesh.t_s[node - 1] } else { start_s };
        let to_s = if node + 1 < range.end { mesh.t_s[node + 1] } else { end_s };
        let within = (from_s - start_s, to_s - start_s);
        segment.spline.greatest_beyond((joint, quantity), greatest, within, floor)
    }

    /// Shares of a sampled row by piece: by the parabola through the largest and its neighbours, with some slack.
    fn sampled(&self, row: usize, slack: f64, peaks: &mut [f64]) {
        let (mesh, values) = (&self.mesh, self.mesh.row(row));
        let (nodes, shares) = (values.as_chunks::<LANES>().0, peaks.as_chunks_mut::<2>().0);
        let most = at_nodes(nodes, &Allowed { middle: 0.0, from_middle: [1.0; 2] }, shares);
        let near = if most > COARSE { nodes.len() } else { 0 };
        for ((piece, nodes), shares) in nodes.iter().enumerate().zip(&mut *shares).take(near) {
            let coarse = shares[0];
            shares[0] = blend(coarse, || {
                let node = piece * LANES + largest_node(*nodes);
                let range = &mesh.segment[mesh.segment_of(node)];
                if node == range.start || node + 1 >= range.end {
                    return coarse;
                }
                vertex([-1, 0, 1].map(|k: isize| {
                    let i = node.saturating_add_signed(k);
                    (mesh.t_s[i], values[i])
                }))
                .1
            });
        }
        for shares in shares {
            shares[0] *= slack;
        }
    }
}

/// The larger; the second if the first is no number, which so never counts.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller; the second if the first is no number.
#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The largest, at least 0, by halves: no value waits for the one before it.
#[inline(always)]
fn top(values: &[f64; LANES]) -> f64 {
    halved(values.map(|value| larger(value, 0.0)), larger)
}

#[inline(always)]
fn halved(mut values: [f64; LANES], of: impl Fn(f64, f64) -> f64) -> f64 {
    for half in [4, 2, 1] {
        for l in 0..half {
            values[l] = of(values[l + half], values[l]);
        }
    }
    values[0]
}

/// The largest of any number, at least 0.
fn largest(values: &[f64]) -> f64 {
    let (groups, rest) = values.as_chunks::<LANES>();
    let mut most = [0.0; LANES];
    for group in groups {
        for (most, value) in most.iter_mut().zip(group) {
            *most = larger(*value, *most);
        }
    }
    rest.iter().fold(top(&most), |most, value| larger(*value, most))
}

/// What a limit allows: so far above and below its middle.
struct Allowed {
    middle: f64,
    from_middle: [f64; 2],
}

impl Allowed {
    fn of(setup: &Setup, joint: usize, quantity: Quantity) -> Self {
        let limit = &setup.limits[joint];
        let (middle, from_middle) = match quantity {
            Quantity::Position => {
                limit.range().map_or((0.0, [f64::INFINITY; 2]), |(middle, half)| (middle, [half; 2]))
            }
            Quantity::Velocity => (0.0, [1.0, -1.0].map(|toward| limit.speed(toward))),
            Quantity::Acceleration => (0.0, [limit.acceleration_rad_s2; 2]),
            Quantity::Jerk => (0.0, [limit.jerk_rad_s3; 2]),
        };
        Self { middle, from_middle }
    }

    /// How far from the middle the way that a sign says.
    fn toward(&self, sign: f64) -> f64 {
        self.from_middle[usize::from(sign < 0.0)]
    }

    /// Share of it that a value takes that way.
    fn share(&self, sign: f64, value: f64) -> f64 {
        sign * (value - self.middle) / self.toward(sign)
    }
}

/// Least and largest value of each row.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn extents(values: &[f64], count: usize, found: &mut [[f64; 2]]) {
    for (row, found) in values.chunks_exact(count.max(1)).zip(found) {
        let groups = row.as_chunks::<LANES>().0;
        // One after the other: together they would not become vector code.
        let mut most = [f64::NEG_INFINITY; LANES];
        for group in groups {
            for l in 0..LANES {
                most[l] = larger(group[l], most[l]);
            }
        }
        let mut least = [f64::INFINITY; LANES];
        for group in groups {
            for l in 0..LANES {
                least[l] = smaller(group[l], least[l]);
            }
        }
        *found = [halved(least, smaller), halved(most, larger)];
    }
}

/// Shares of a limit at the nodes of each piece, of each sign; returns the largest.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn at_nodes(nodes: &[[f64; LANES]], allowed: &Allowed, shares: &mut [[f64; 2]]) -> f64 {
    let Allowed { middle, from_middle: [over, under] } = *allowed;
    let mut most = [0.0; 2];
    for (nodes, shares) in nodes.iter().zip(shares) {
        let (mut above, mut below) = ([0.0; LANES], [0.0; LANES]);
        for l in 0..LANES {
            (above[l], below[l]) = (nodes[l] - middle, -(nodes[l] - middle));
        }
        *shares = [top(&above) / over, top(&below) / under];
        most = [larger(shares[0], most[0]), larger(shares[1], most[1])];
    }
    larger(most[0], most[1])
}

/// Where the largest stands first.
fn largest_node(values: [f64; LANES]) -> usize {
    let peak = |best: (usize, f64), next: (usize, f64)| if next.1 > best.1 { next } else { best };
    values.into_iter().enumerate().fold((0, 0.0), peak).0
}

/// The share between nodes, as far as it matters.
fn blend(coarse: f64, exact: impl FnOnce() -> f64) -> f64 {
    let weight =
        ((coarse - COARSE) / (EXACT - COARSE)).min((COARSE_AGAIN - coarse) / (COARSE_AGAIN - FAR_BROKEN));
    if weight > 0.0 { coarse + weight.min(1.0) * (exact() - coarse).max(0.0) } else { coarse }
}

/// Vertex of the parabola through three points whose middle one is highest.
pub(super) fn vertex([(t0, a), (t1, b), (t2, c)]: [(f64, f64); 3]) -> (f64, f64) {
    let (left, right) = ((b - a) / (t1 - t0), (c - b) / (t2 - t1));
    let bend = (right - left) / (t2 - t0);
    if bend >= 0.0 || left < 0.0 || right > 0.0 {
        return (t1, b);
    }
    // Slope at the middle point, from Newton's form.
    let slope = left + bend * (t1 - t0);
    let step = (-0.5 * slope / bend).clamp(t0 - t1, t2 - t1);
    (t1 + step, b + step * (slope + step * bend))
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "exact by construction")]
mod tests {
    use super::*;
    use crate::{arm::Arm, task::Task};

    #[test]
    fn the_vertex_of_a_parabola_is_found_and_never_left_of_or_right_of_its_points() {
        let parabola = |t: f64| 3.0 - 2.0 * (t - 0.4) * (t - 0.4);
        let at = |t: f64| (t, parabola(t));
        let (t, peak) = vertex([at(0.1), at(0.5), at(0.8)]);
        assert!((t - 0.4).abs() < 1e-12 && (peak - 3.0).abs() < 1e-12);
        assert_eq!(vertex([(0.0, 1.0), (1.0, 2.0), (2.0, 4.0)]), (1.0, 2.0));
    }

    #[test]
    fn a_blend_is_the_node_below_and_the_peak_above_and_continuous_between() {
        let peak = |coarse: f64| blend(coarse, || coarse * 1.01);
        assert_eq!(peak(0.7), 0.7);
        assert_eq!(peak(1.0), 1.01);
        assert_eq!(peak(2.5), 2.5);
        let steps = (0..3000).map(|i| peak(0.6 + f64::from(i) * 1e-3)).collect::<Vec<_>>();
        assert!(steps.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 1.3e-3));
    }

    #[test]
    fn the_largest_of_a_row_is_that_of_its_peaks_however_near_a_limit_it_is() {
        let task = Task::parse(include_str!("../../sample-logs/tasks/simulation.toml")).unwrap();
        let setup = Setup::new(&task, Arm::sample().unwrap()).unwrap();
        let [mut quick, mut whole] = [(); 2].map(|()| Evaluator::new(&setup));
        let mut near = 0;
        for k in 0..300 {
            let interval_s: Vec<f64> = (0..6)
                .map(|i| 0.6 + 2.5 * (0.5 + 0.5 * f64::from(7 * k + 5 * i + k * i % 11).sin()))
                .collect();
            assert_eq!(quick.evaluate(&setup, &interval_s), whole.evaluate_peaks(&setup, &interval_s));
            assert_eq!(quick.shares, whole.shares, "{interval_s:?}");
            near += quick.shares.iter().filter(|share| **share > COARSE).count();
        }
        assert!(near > 1000, "{near} rows are near a limit");
    }
}
