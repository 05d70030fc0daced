//! The state of the whole machine and its step.

use super::{
    Plant, PlantError, STEP_S,
    cylinder::{Pressures, stop_n},
    friction::Bristles,
    mechanics::{FASTEST_1_S, Mechanics, STEPS_A_POSE},
    valve::Spool,
};

/// Where the rod's side of a resting cylinder lies between return and supply pressure.
const REST_SHARE: f64 = 0.35;

#[derive(Debug, Clone, Copy, Default)]
pub(super) struct State {
    /// Signal that reaches the valve, within ±1, positive for growing angles.
    pub(super) signal: f64,
    pub(super) spool: Spool,
    pub(super) pressures: Pressures,
    bristles: Bristles,
    pub(super) position_rad: f64,
    pub(super) speed_rad_s: f64,
}

pub(super) struct Machine<'a> {
    plant: &'a Plant,
    pub(super) states: Vec<State>,
    pub(super) supply_pa: f64,
    mechanics: Mechanics,
    torque_nm: Vec<f64>,
    steps: usize,
}

impl<'a> Machine<'a> {
    /// At rest with closed valves in a pose, rad, with pressures that hold the arm and the payload.
    pub(super) fn at_rest(
        plant: &'a Plant,
        position_rad: &[f64],
        payload_kg: f64,
    ) -> Result<Self, PlantError> {
        let mut mechanics = Mechanics::new(plant);
        mechanics.look(plant, position_rad.iter().map(|&q| (q, 0.0)), payload_kg);
        let supply = &plant.parameters.supply;
        let (low_pa, high_pa) = (supply.return_pressure_pa, supply.pressure_pa);
        let mut states = Vec::with_capacity(position_rad.len());
        for (j, ((axis, joint), &q)) in
            plant.axes.iter().zip(&plant.parameters.joints).zip(position_rad).enumerate()
        {
            let (cap, rod) = (axis.size.cap_area_m2, axis.size.rod_area_m2);
            let lever_m = mechanics.lever_m[j];
            let force_n = mechanics.bias_nm[j] / lever_m;
            let rod_pa = low_pa + REST_SHARE * (high_pa - low_pa);
            let cap_pa = ((force_n + rod_pa * rod) / cap).max(low_pa).min(high_pa);
            let rod_pa = (cap_pa * cap - force_n) / rod;
            let (least_n, most_n) = (low_pa * cap - high_pa * rod, high_pa * cap - low_pa * rod);
            if !(rod_pa >= 0.0 && rod_pa <= high_pa) {
                return Err(PlantError::TooHeavy { joint: joint.name.clone(), force_n, least_n, most_n });
            }
            let out_m = mechanics.out_m[j].max(0.0).min(axis.size.stroke_m);
            let dead_m3 = joint.chambers.dead_volume_m3;
            let oil_n_m = supply.bulk_modulus_pa
                * (cap * cap / (dead_m3 + cap * out_m)
                    + rod * rod / (dead_m3 + rod * (axis.size.stroke_m - out_m)));
            let mobility = lever_m * lever_m * mechanics.mobility[j * plant.axes.len() + j];
            let swing_1_s = ((oil_n_m + joint.friction.bristle_stiffness_n_m) * mobility).sqrt();
            let damping = joint.friction.bristle_damping_n_s_m + joint.friction.viscous_n_s_m;
            let rate_1_s = swing_1_s.max(damping * mobility);
            if rate_1_s.is_nan() || rate_1_s > FASTEST_1_S {
                let joint = joint.name.clone();
                return Err(PlantError::TooStiff { joint, rate_1_s, most_1_s: FASTEST_1_S });
            }
            let pressures = Pressures { cap_pa, rod_pa };
            states.push(State { pressures, position_rad: q, ..State::default() });
        }
        let torque_nm = vec![0.0; states.len()];
        Ok(Self { plant, states, supply_pa: high_pa, mechanics, torque_nm, steps: 0 })
    }

    /// Goes on by [`STEP_S`]. Allocates nothing.
    pub(super) fn step(&mut self, payload_kg: impl FnOnce() -> f64) {
        let Self { plant, states, mechanics, torque_nm, .. } = self;
        if self.steps.is_multiple_of(STEPS_A_POSE) {
            let state = states.iter().map(|state| (state.position_rad, state.speed_rad_s));
            mechanics.look(plant, state, payload_kg());
        }
        self.steps += 1;
        let joints = || plant.axes.iter().zip(&plant.parameters.joints);
        for (j, ((axis, joint), state)) in joints().zip(states.iter_mut()).enumerate() {
            let lever_m = mechanics.lever_m[j];
            let rod_m_s = lever_m * state.speed_rad_s;
            let against_n = state.bristles.step(&joint.friction, rod_m_s, STEP_S);
            let force_n = state.pressures.force_n(&axis.size) - against_n
                + stop_n(&axis.size, mechanics.out_m[j], rod_m_s);
            torque_nm[j] = lever_m * force_n - mechanics.bias_nm[j];
        }
        let supply = &plant.parameters.supply;
        let mut drawn_m3_s = 0.0;
        let rows = mechanics.mobility.chunks_exact(states.len());
        for (j, (((axis, joint), state), row)) in joints().zip(states.iter_mut()).zip(rows).enumerate() {
            let acceleration: f64 = row.iter().zip(torque_nm.iter()).map(|(m, torque)| m * torque).sum();
            state.speed_rad_s += STEP_S * acceleration;
            state.position_rad += STEP_S * state.speed_rad_s;
            let rod_m_s = mechanics.lever_m[j] * state.speed_rad_s;
            mechanics.out_m[j] += STEP_S * rod_m_s;
            state.spool.step(&joint.valve, axis.sense * state.signal, STEP_S);
            drawn_m3_s += state.pressures.step(
                (&axis.size, &joint.chambers, &joint.valve),
                (supply, self.supply_pa),
                state.spool.opening(&joint.valve),
                (mechanics.out_m[j], rod_m_s),
                STEP_S,
            );
        }
        let asked = (supply.pressure_pa - self.supply_pa) / supply.droop_pa;
        let slope = if (0.0..1.0).contains(&asked) { supply.flow_m3_s / supply.droop_pa } else { 0.0 };
        let rate = STEP_S * supply.bulk_modulus_pa / supply.volume_m3;
        let pumped_m3_s = supply.flow_m3_s * asked.clamp(0.0, 1.0);
        let change_pa = rate * (pumped_m3_s - drawn_m3_s) / (1.0 + rate * slope);
        self.supply_pa = (self.supply_pa + change_pa).max(0.0);
    }

    /// Whether all angles, speeds and pressures are still numbers.
    pub(super) fn is_finite(&self) -> bool {
        let sum = |state: &State| {
            state.position_rad + state.speed_rad_s + state.pressures.cap_pa + state.pressures.rod_pa
        };
        self.states.iter().all(|state| sum(state).is_finite()) && self.supply_pa.is_finite()
    }
}
