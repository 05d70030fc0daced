//! State, torque and load of the arm at many instants of a motion, in lanes.

use multiversion::multiversion;

use super::Setup;
use crate::{
    arm::{Chain, Cylinder, LANES, Load, Motion as ArmMotion, Workspace, inverse_dynamics},
    spline::{Degree, Gauss, Motion, Quantity, Samples, Spline},
};

/// Rows of one joint that come from the mechanics: shares of torque, rod speed and rod force.
pub(super) const LOADED: usize = 3;
/// The place of rod speed among them.
const ROD_SPEED: usize = 1;

/// Instants and what the arm does there; reused, it allocates only to grow.
#[derive(Debug, Clone)]
pub(super) struct Mesh {
    /// Instants, s, ascending; every segment has a multiple of `LANES`.
    pub(super) t_s: Vec<f64>,
    /// Instants of each segment.
    pub(super) segment: Vec<std::ops::Range<usize>>,
    pub(super) samples: Samples,
    /// Shares of limits, `[joint * LOADED + row][instant]`, then pump flow, then tool speed.
    pub(super) shares: Vec<f64>,
    /// Power, `[joint][instant]`, W.
    pub(super) power_w: Vec<f64>,
    /// Integral of squared power over time by joint, W² s.
    pub(super) squared_power: Vec<f64>,
    /// Integral of the magnitude of power over time, all joints together, J.
    pub(super) energy_j: f64,
    /// Weights of the instants in integrals, s; zero where they are void.
    pub(super) weights_s: Vec<f64>,
    lanes: Lanes,
    /// One over the limits of each joint: torque, and rod speed out and in.
    reciprocals: Vec<[f64; 3]>,
}

/// One group of instants.
#[derive(Debug, Clone)]
struct Lanes {
    dynamics: Workspace<LANES>,
    /// Position, speed, acceleration, each by joint.
    state: [Vec<[f64; LANES]>; 3],
    torque_n_m: Vec<[f64; LANES]>,
    squared_power: Vec<[f64; LANES]>,
    power: [f64; LANES],
}

impl Mesh {
    pub(super) fn new(setup: &Setup) -> Self {
        let joints = setup.joint_count();
        let zeros = || vec![[0.0; LANES]; joints];
        Self {
            t_s: Vec::new(),
            segment: Vec::new(),
            samples: Samples::default(),
            shares: Vec::new(),
            power_w: Vec::new(),
            squared_power: vec![0.0; joints],
            energy_j: 0.0,
            weights_s: Vec::new(),
            reciprocals: Vec::new(),
            lanes: Lanes {
                dynamics: Workspace::new(&setup.arm.chain),
                state: [zeros(), zeros(), zeros()],
                torque_n_m: zeros(),
                squared_power: zeros(),
                power: [0.0; LANES],
            },
        }
    }

    /// Looks at the nodes of eight-point quadrature on every piece, or on parts of it where a joint turns far.
    pub(super) fn integrate(&mut self, setup: &Setup, motion: &Motion) {
        self.integrate_finely(setup, motion, 1);
    }

    /// The same on so many times as many parts: the magnitude of power has a kink wherever its sign changes.
    pub(super) fn integrate_finely(&mut self, setup: &Setup, motion: &Motion, times: usize) {
        self.t_s.clear();
        self.weights_s.clear();
        self.segment.clear();
        for segment in motion.segments() {
            let first = self.t_s.len();
            let parts = times * parts(&segment.spline);
            segment.spline.quadrature(Gauss::Eight, parts, &mut self.t_s, &mut self.weights_s);
            for t in &mut self.t_s[first..] {
                *t += segment.start_s;
            }
            self.segment.push(first..self.t_s.len());
        }
        self.fill(setup, motion);
    }

    /// Looks at `least * LANES` even steps of every segment, or `each * LANES` a piece of its spline if those are more, ends
    /// included; integrals are void.
    pub(super) fn scan(&mut self, setup: &Setup, motion: &Motion, least: usize, each: usize) {
        self.t_s.clear();
        self.segment.clear();
        for segment in motion.segments() {
            let groups = least.max(each * segment.spline.pieces());
            let (first, count) = (self.t_s.len(), groups * LANES);
            let step_s = segment.spline.duration_s() / (count - 1) as f64;
            self.t_s.extend((0..count).map(|i| segment.start_s + step_s * i as f64));
            self.segment.push(first..self.t_s.len());
        }
        self.weights_s.clear();
        self.weights_s.resize(self.t_s.len(), 0.0);
        self.fill(setup, motion);
    }

    /// Looks at one group of instants within a segment; integrals are void.
    pub(super) fn look(&mut self, setup: &Setup, motion: &Motion, segment: usize, t_s: [f64; LANES]) {
        self.t_s.clear();
        self.t_s.extend(t_s);
        self.segment.clear();
        self.segment.resize(segment, 0..0);
        self.segment.push(0..LANES);
        self.weights_s.clear();
        self.weights_s.resize(LANES, 0.0);
        self.fill(setup, motion);
    }

    /// One row of shares, `[instant]`.
    pub(super) fn row(&self, row: usize) -> &[f64] {
        let count = self.t_s.len();
        &self.shares[row * count..][..count]
    }

    /// Largest shares of limits in a segment: of torques and forces, and of what falls as time grows (rods, flow, tool).
    pub(super) fn largest(&self, segment: usize) -> [f64; 2] {
        let rows = self.shares.len() / self.t_s.len().max(1);
        let mut most = [0.0_f64; 2];
        for row in 0..rows {
            let of_rate = row + 2 >= rows || row % LOADED == ROD_SPEED;
            let kind = &mut most[usize::from(of_rate)];
            *kind = self.row(row)[self.segment[segment].clone()]
                .iter()
                .fold(*kind, |most, share| most.max(*share));
        }
        most
    }

    /// The segment that an instant belongs to.
    pub(super) fn segment_of(&self, instant: usize) -> usize {
        self.segment.iter().position(|range| range.contains(&instant)).unwrap_or(0)
    }

    /// Torque of a joint at the first of the instants looked at last, N m.
    pub(super) fn torque_n_m(&self, joint: usize) -> f64 {
        self.lanes.torque_n_m[joint][0]
    }

    fn fill(&mut self, setup: &Setup, motion: &Motion) {
        motion.sample_segments(&self.t_s, &self.segment, &mut self.samples);
        self.load(setup);
    }

    /// What the state in the samples asks of the arm.
    pub(super) fn load(&mut self, setup: &Setup) {
        let (joints, count) = (setup.joint_count(), self.t_s.len());
        self.shares.resize((joints * LOADED + 2) * count, 0.0);
        self.power_w.resize(joints * count, 0.0);
        self.lanes.squared_power.fill([0.0; LANES]);
        self.lanes.power.fill(0.0);
        self.reciprocals.clear();
        self.reciprocals.extend(setup.limits.iter().map(|limit| {
            let [extend_m_s, retract_m_s] = limit.rod_speed_m_s;
            [limit.torque_n_m, extend_m_s, retract_m_s].map(f64::recip)
        }));
        for (range, load) in self.segment.iter().zip(&setup.loads) {
            let task = Task {
                chain: &setup.arm.chain,
                load,
                cylinders: setup.arm.hydraulics.cylinders(),
                reciprocals: &self.reciprocals,
                pump_flow_m3_s: setup.arm.hydraulics.pump_flow_m3_s(),
                range: range.clone(),
            };
            let to = Loads { shares: &mut self.shares, power_w: &mut self.power_w };
            dispatched(&task, &self.samples, &self.weights_s, &mut self.lanes, to);
        }
        for (sum, lanes) in self.squared_power.iter_mut().zip(&self.lanes.squared_power) {
            *sum = lanes.iter().sum();
        }
        self.energy_j = self.lanes.power.iter().sum();
        if setup.tool_speed_m_s.is_finite() {
            self.tool_speed(setup);
        }
    }

    fn tool_speed(&mut self, setup: &Setup) {
        let (joints, count) = (setup.joint_count(), self.t_s.len());
        let mut state = [vec![0.0; joints], vec![0.0; joints]];
        for i in 0..count {
            for (quantity, values) in [Quantity::Position, Quantity::Velocity].iter().zip(&mut state) {
                for (joint, value) in values.iter_mut().enumerate() {
                    *value = self.samples.of(*quantity, joint)[i];
                }
            }
            let speed_m_s = setup.arm.chain.tool_speed_m_s(&state[0], &state[1]);
            self.shares[(joints * LOADED + 1) * count + i] = speed_m_s / setup.tool_speed_m_s;
        }
    }
}

/// Weight turns about a joint with its angle: over more of it, rad, eight nodes do not follow the square of its power.
const PART_RAD: f64 = 1.5;
/// Parts of a piece at most.
const MOST_PARTS: usize = 1000;

/// Parts in which a joint turns no farther than [`PART_RAD`] from one point to the next.
fn parts(spline: &Spline) -> usize {
    let points = spline.points();
    let steps = (1..points.len()).flat_map(|k| points.of(k - 1).iter().zip(points.of(k)));
    let farthest_rad = steps.fold(0.0, |most: f64, (a, b)| most.max((b - a).abs()));
    // Eight nodes are exact for a degree of 15, and the square of the power of a curve of degree seven is far beyond.
    let each = if spline.degree() == Degree::Septic { 2 } else { 1 };
    each * (1..MOST_PARTS).find(|parts| farthest_rad <= *parts as f64 * PART_RAD).unwrap_or(MOST_PARTS)
}

/// What one segment is judged by.
struct Task<'a> {
    chain: &'a Chain,
    load: &'a Load,
    cylinders: &'a [Option<Cylinder>],
    /// One over the limits of each joint.
    reciprocals: &'a [[f64; 3]],
    pump_flow_m3_s: f64,
    range: std::ops::Range<usize>,
}

/// What is written of all instants.
struct Loads<'a> {
    shares: &'a mut [f64],
    power_w: &'a mut [f64],
}

#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn dispatched(task: &Task<'_>, samples: &Samples, weights_s: &[f64], lanes: &mut Lanes, to: Loads<'_>) {
    let Loads { shares, power_w } = to;
    let (joints, count) = (task.reciprocals.len(), weights_s.len());
    let motion = [Quantity::Position, Quantity::Velocity, Quantity::Acceleration];
    let mut first = task.range.start;
    while first + LANES <= task.range.end {
        for (quantity, to) in motion.iter().zip(&mut lanes.state) {
            for (to, from) in to.iter_mut().zip(samples.all(*quantity).chunks_exact(count)) {
                // Of a known length, which needs no call.
                if let Some(from) = from[first..].first_chunk() {
                    *to = *from;
                }
            }
        }
        let [position_rad, speed_rad_s, acceleration_rad_s2] = &lanes.state;
        let state = ArmMotion { position_rad, speed_rad_s, acceleration_rad_s2 };
        inverse_dynamics(task.chain, task.load, state, &mut lanes.dynamics, &mut lanes.torque_n_m);
        let weights = weights_s[first..].first_chunk().copied().unwrap_or([0.0; LANES]);
        let mut flow_m3_s = [0.0; LANES];
        for (j, (sin, cos)) in lanes.dynamics.sin_cos().enumerate().take(joints) {
            let (torque, speed) = (lanes.torque_n_m[j], speed_rad_s[j]);
            let [per_torque, per_extend, per_retract] = task.reciprocals[j];
            let mut rows = [[0.0; LANES]; LOADED];
            // Arrays of their own, which share no memory: the loop over lanes is one of vectors.
            let (mut power, mut squared, mut total) = ([0.0; LANES], lanes.squared_power[j], lanes.power);
            for l in 0..LANES {
                power[l] = speed[l] * torque[l];
                squared[l] += weights[l] * power[l] * power[l];
                total[l] += weights[l] * power[l].abs();
                rows[0][l] = torque[l].abs() * per_torque;
            }
            (lanes.squared_power[j], lanes.power) = (squared, total);
            if let Some(cylinder) = &task.cylinders[j] {
                for l in 0..LANES {
                    let found = cylinder.actuation((sin[l], cos[l]), speed[l], torque[l]);
                    let per_most = if found.rod_speed_m_s > 0.0 { per_extend } else { per_retract };
                    flow_m3_s[l] += found.flow_m3_s;
                    rows[ROD_SPEED][l] = found.rod_speed_m_s.abs() * per_most;
                    rows[2][l] = found.force_share;
                }
            }
            put(power_w, j * count + first, &power);
            for (row, values) in rows.iter().enumerate() {
                put(shares, (j * LOADED + row) * count + first, values);
            }
        }
        put(shares, joints * LOADED * count + first, &flow_m3_s.map(|flow| flow / task.pump_flow_m3_s));
        first += LANES;
    }
}

/// One group of values from a place on.
#[inline(always)]
fn put(to: &mut [f64], first: usize, values: &[f64; LANES]) {
    if let Some(to) = to[first..].first_chunk_mut() {
        *to = *values;
    }
}
