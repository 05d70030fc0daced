//! One evaluation: the objectives of a plan and how near it comes to every limit.

use super::{
    Setup,
    limit::Limit,
    mesh::{LOADED, Mesh},
};
use crate::{
    arm::LANES,
    spline::{Motion, Quantity},
    task::{Objective, Objectives},
};

/// A timing with its objectives.
#[derive(Debug, Clone, PartialEq)]
pub struct Timing {
    /// Time of movement from each key point to the next, s.
    pub interval_s: Vec<f64>,
    /// What it costs.
    pub objectives: Objectives,
    /// Sum of the excess over its limits, as [`Evaluator::violation`]; 0 if all hold.
    pub violation: f64,
}

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

/// Evaluates plans of one setup, one after the other; allocates nothing after the first.
#[derive(Debug, Clone)]
pub struct Evaluator {
    pub(super) motion: Motion,
    pub(super) mesh: Mesh,
    t_s: Vec<f64>,
    rms_jerk: Vec<f64>,
    /// Share of each limit, by row.
    pub(super) shares: Vec<f64>,
    /// The same on each piece and of each sign, `[row][piece][sign]`: smooth in the times where the
    /// largest of all has a kink.
    pub(super) peaks: Vec<f64>,
}

impl Evaluator {
    /// Memory for a setup.
    pub fn new(setup: &Setup) -> Self {
        Self {
            motion: setup.template.clone(),
            mesh: Mesh::new(setup),
            t_s: Vec::new(),
            rms_jerk: vec![0.0; setup.joint_count()],
            shares: vec![0.0; Limit::rows(setup.joint_count())],
            peaks: Vec::new(),
        }
    }

    /// Objectives of the plan with these times of movement between key points, s, under the setup
    /// that this evaluator was made for; `None` if they make no motion.
    ///
    /// f2 is exact; f3 is by eight Gauss nodes a piece, to 1e-7. Power is joint speed times torque
    /// (paper, eq. 5). `DIFFERENCE(eq. 4, 5)`: means over time in place of sums over sampling
    /// points, which grow with their number.
    pub fn evaluate(&mut self, setup: &Setup, interval_s: &[f64]) -> Option<Objectives> {
        self.t_s.clear();
        self.t_s.push(0.0);
        let mut now_s = 0.0;
        for (interval_s, dwell_s) in interval_s.iter().zip(&setup.dwell_before_s) {
            now_s += dwell_s + interval_s;
            self.t_s.push(now_s);
        }
        self.motion.retime(&self.t_s).ok()?;
        self.motion.rms_jerk(&mut self.rms_jerk);
        self.mesh.integrate(setup, &self.motion);
        self.limit_shares(setup);
        Some(Objectives::NONE.map_plan(|objective| self.objective(objective)))
    }

    /// One objective of the plan evaluated last; not known of those that need a machine.
    fn objective(&self, objective: Objective) -> f64 {
        match objective {
            Objective::Duration => self.motion.duration_s(),
            Objective::RmsJerk => self.rms_jerk.iter().sum(),
            Objective::RmsPower => self.joint_power_w().sum(),
            Objective::StartError => f64::INFINITY,
        }
    }

    fn joint_power_w(&self) -> impl Iterator<Item = f64> {
        let duration_s = self.motion.duration_s();
        self.mesh.squared_power.iter().map(move |sum| (sum / duration_s).sqrt())
    }

    /// Sum over limits of the excess of the plan evaluated last, each as a share of its limit, 10 at most.
    pub fn violation(&self) -> f64 {
        self.shares.iter().map(|share| excess(*share)).sum()
    }

    /// Root mean square jerk by joint of the plan evaluated last, rad/s³.
    pub fn rms_jerk_rad_s3(&self) -> &[f64] {
        &self.rms_jerk
    }

    /// Root mean square power by joint of the plan evaluated last, W.
    pub fn rms_power_w(&self) -> Vec<f64> {
        self.joint_power_w().collect()
    }

    /// Work that the joints do and take up together in the plan evaluated last, J.
    pub fn energy_j(&self) -> f64 {
        self.mesh.energy_j
    }

    /// Shares of all limits.
    fn limit_shares(&mut self, setup: &Setup) {
        let (width, joints) = (Limit::OF_JOINT.len(), setup.limits.len());
        let pieces = self.mesh.t_s.len() / LANES;
        self.peaks.resize(self.shares.len() * pieces * 2, 0.0);
        let mut peaks = std::mem::take(&mut self.peaks);
        for (row, peaks) in peaks.chunks_exact_mut(2 * pieces.max(1)).enumerate() {
            let (joint, k) = (row / width, row % width);
            match SPLINES.get(k).filter(|_| joint < joints) {
                Some(&quantity) => self.of_spline(setup, joint, quantity, peaks),
                None if joint < joints => {
                    self.sampled(joint * LOADED + k - SPLINES.len(), setup.slack[row], peaks);
                }
                None => self.sampled(joints * LOADED + row - joints * width, setup.slack[row], peaks),
            }
            self.shares[row] = peaks.iter().fold(0.0, |most, peak| most.max(*peak));
        }
        self.peaks = peaks;
    }

    /// Shares of a limit on a spline or its derivative, by piece.
    fn of_spline(&self, setup: &Setup, joint: usize, quantity: Quantity, peaks: &mut [f64]) {
        let limit = &setup.limits[joint];
        let [low, high] = limit.range_rad;
        let (middle, allowed) = match quantity {
            Quantity::Position if low.is_finite() && high.is_finite() => {
                (0.5 * (low + high), 0.5 * (high - low))
            }
            Quantity::Position => (0.0, f64::INFINITY),
            Quantity::Velocity => (0.0, limit.speed_rad_s),
            Quantity::Acceleration => (0.0, limit.acceleration_rad_s2),
            Quantity::Jerk => (0.0, limit.jerk_rad_s3),
        };
        let values = self.mesh.samples.of(quantity, joint);
        for ((piece, nodes), shares) in values.chunks_exact(LANES).enumerate().zip(peaks.chunks_exact_mut(2))
        {
            for (sign, share) in [1.0, -1.0].into_iter().zip(shares) {
                let (node, coarse) = peak(nodes.iter().map(|value| sign * (value - middle)));
                *share = blend(coarse / allowed, || {
                    let exact = self.near(joint, quantity, piece * LANES + node, sign > 0.0);
                    sign * (exact - middle) / allowed
                });
            }
        }
        // At the ends of a segment, which no node reaches, the value is that of the outer control point.
        for (range, segment) in self.mesh.segment.iter().zip(self.motion.segments()) {
            let control = segment.spline.control(joint, quantity);
            for (instant, value) in
                [(range.start, control.first()), (range.end.saturating_sub(1), control.last())]
            {
                let Some(value) = value else { continue };
                let (share, piece) = ((value - middle) / allowed, instant / LANES);
                peaks[2 * piece] = peaks[2 * piece].max(share);
                peaks[2 * piece + 1] = peaks[2 * piece + 1].max(-share);
            }
        }
    }

    /// The greatest (or least) value between the neighbours of a node.
    fn near(&self, joint: usize, quantity: Quantity, node: usize, greatest: bool) -> f64 {
        let mesh = &self.mesh;
        let index = mesh.segment_of(node);
        let (range, segment) = (&mesh.segment[index], &self.motion.segments()[index]);
        let (start_s, end_s) = (segment.start_s, segment.start_s + segment.spline.duration_s());
        let from_s = if node > range.start { mesh.t_s[node - 1] } else { start_s };
        let to_s = if node + 1 < range.end { mesh.t_s[node + 1] } else { end_s };
        let found = segment.spline.extrema_within(joint, quantity, (from_s - start_s, to_s - start_s));
        if greatest { found.greatest.value } else { found.least.value }
    }

    /// Shares of a sampled row by piece: by the parabola through the largest and its neighbours, with some slack.
    fn sampled(&self, row: usize, slack: f64, peaks: &mut [f64]) {
        let (mesh, values) = (&self.mesh, self.mesh.row(row));
        for ((piece, nodes), shares) in values.chunks_exact(LANES).enumerate().zip(peaks.chunks_exact_mut(2))
        {
            let (node, coarse) = peak(nodes.iter().copied());
            shares[0] = blend(coarse, || {
                let node = piece * LANES + node;
                let range = &mesh.segment[mesh.segment_of(node)];
                if node == range.start || node + 1 >= range.end {
                    return coarse;
                }
                vertex([-1, 0, 1].map(|k: isize| {
                    let i = node.saturating_add_signed(k);
                    (mesh.t_s[i], values[i])
                }))
                .1
            }) * slack;
        }
    }
}

/// How far a share exceeds its limit: 0 to 10. At a dead centre the share has no bound.
pub fn excess(share: f64) -> f64 {
    (share - 1.0).clamp(0.0, 10.0)
}

/// Index and value of the largest; zeros for none.
fn peak(values: impl Iterator<Item = f64>) -> (usize, f64) {
    values.enumerate().fold((0, 0.0), |best, next| if next.1 > best.1 { next } else { best })
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
}
