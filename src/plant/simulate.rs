//! A command goes in, a log comes out.

use std::borrow::Cow;

use rand_distr::{Bernoulli, Distribution, StandardNormal};

use super::{
    PayloadChange, Plant, PlantError, Record, STEP_S, controller::Integral, encoder::Sensor, link::Bend,
    machine::Machine, payload::Payload, set_value,
};
use crate::{
    math::whole,
    rng::{Stream, stream},
    series::{Series, Track},
};

const LONGEST_S: f64 = 3600.0;

/// A sample is taken at most this part of a period early or late.
const LATEST: f64 = 0.4;

struct Loop {
    /// Angle and speed that the loop is to follow, by period.
    command: Vec<(f64, f64)>,
    integral: Integral,
    sensor: Sensor,
    bend: Bend,
    /// Signals sent so far, by period.
    sent: Vec<f64>,
    /// The step at which the next signal arrives, and which one it is.
    arrival: (usize, usize),
}

/// Runs a command on a machine that stands at its first angles, from time 0 to the end of the
/// joint's track that ends last.
///
/// `command` has a track with positions and speeds for every joint, in any order; before its first
/// sample, after its last and across cuts a track holds its angle. Equal arguments give equal
/// records; the seed moves noise, jitter and losses, and what the machine draws anew each run.
///
/// # Errors
///
/// [`PlantError`]: a joint without command, a run longer than an hour, an impossible payload, a
/// pose that the supply cannot hold, an arm too light for the step.
pub fn simulate(
    plant: &Plant,
    command: &Series,
    payload: &[PayloadChange],
    seed: u64,
) -> Result<Record, PlantError> {
    let today;
    let plant = match plant.parameters.of_run(seed) {
        Cow::Borrowed(_) => plant,
        Cow::Owned(parameters) => {
            today = Plant { parameters, ..plant.clone() };
            &today
        }
    };
    let cycle = &plant.parameters.cycle;
    let payload = Payload::new(payload, cycle.payload_ramp_s)?;
    let steps_a_period = steps(cycle.period_s);
    let (mut loops, periods) = loops(plant, command, seed)?;
    let start_rad: Vec<f64> = loops.iter().map(|l| l.sensor.seen_rad).collect();
    let mut machine = Machine::at_rest(plant, &start_rad, payload.mass_kg(0.0))?;
    let mut record = Record::with_room(plant.joints(), periods + 1);
    let (mut noise, mut sampling) = (stream(seed, Stream::SensorNoise), stream(seed, Stream::Sampling));
    // The share of losses is checked to be one.
    let lost = Bernoulli::new(cycle.loss).ok();
    let mut step = 0;
    for period in 0..=periods {
        let now_s = period as f64 * cycle.period_s;
        let inner = period > 0 && period < periods;
        let jitter: f64 = StandardNormal.sample(&mut sampling);
        let lost = lost.is_some_and(|lost| lost.sample(&mut sampling)) && inner;
        let latest_s = LATEST * cycle.period_s;
        let ahead_s = if inner { (cycle.jitter_s * jitter).max(-latest_s).min(latest_s) } else { 0.0 };
        if !machine.is_finite() {
            return Err(PlantError::Diverged { at_s: now_s });
        }
        if !lost {
            record.t_s.push(now_s + ahead_s);
            record.supply_pa.push(machine.supply_pa);
            record.payload_kg.push(payload.mass_kg(now_s));
        }
        for (j, (own, joint)) in loops.iter_mut().zip(&plant.parameters.joints).enumerate() {
            let noise: f64 = StandardNormal.sample(&mut noise);
            let read_rad = own.sensor.reading_rad(&joint.encoder, 0.0, noise);
            own.sensor.take(read_rad, cycle.period_s, cycle.speed_filter_s);
            let seen = (read_rad, own.sensor.driver_rad_s);
            let signal = own.integral.turn(&joint.control, own.command[period], seen, cycle.period_s);
            own.sent.push(signal);
            if lost {
                continue;
            }
            let (state, row) = (&machine.states[j], &mut record.joints[j]);
            row.measured_rad.push(own.sensor.reading_rad(&joint.encoder, ahead_s, noise));
            row.measured_rad_s.push(own.sensor.driver_rad_s);
            row.true_rad.push(own.sensor.ahead_rad(ahead_s));
            row.true_rad_s.push(own.sensor.seen_rad_s);
            row.cap_pressure_pa.push(state.pressures.cap_pa);
            row.rod_pressure_pa.push(state.pressures.rod_pa);
            row.valve_command.push(signal);
            row.spool.push(plant.axes[j].sense * state.spool.travel);
        }
        for _ in 0..if period < periods { steps_a_period } else { 0 } {
            for (own, state) in loops.iter_mut().zip(&mut machine.states) {
                if step == own.arrival.0 {
                    state.signal = own.sent.get(own.arrival.1).copied().unwrap_or(state.signal);
                    own.arrival = (step + steps_a_period, own.arrival.1 + 1);
                }
            }
            machine.step(|| payload.mass_kg(step as f64 * STEP_S));
            step += 1;
            for ((own, state), joint) in loops.iter_mut().zip(&machine.states).zip(&plant.parameters.joints) {
                own.bend.step(&joint.link, state.speed_rad_s);
                own.sensor.step(&joint.encoder, state.position_rad + own.bend.angle_rad);
            }
        }
    }
    Ok(record)
}

/// Loops at the start of the command, and the number of periods that it lasts.
fn loops(plant: &Plant, command: &Series, seed: u64) -> Result<(Vec<Loop>, usize), PlantError> {
    let cycle = &plant.parameters.cycle;
    let mut tracks = Vec::with_capacity(plant.axes.len());
    for name in plant.joints() {
        let missing = |what| PlantError::NoCommand { joint: name.to_owned(), what };
        let track = command.track(name).ok_or_else(|| missing("track"))?;
        tracks.push((track, track.velocity().ok_or_else(|| missing("speeds"))?));
    }
    let ends_s = tracks.iter().filter_map(|(track, _)| track.t_s().last());
    let duration_s = ends_s.copied().fold(0.0, f64::max);
    if duration_s > LONGEST_S {
        return Err(PlantError::Duration { duration_s, most_s: LONGEST_S });
    }
    // Within rounding, a command that ends with a period ends with it.
    let periods = whole(duration_s / cycle.period_s + 1e-6);
    let instants_s = set_value::instants_s(cycle, periods, seed);
    let own = |((track, _), joint): (&(&Track, &[f64]), &super::JointParameters)| {
        let states = instants_s.iter().map(|&t_s| track.held_at(t_s));
        let mut command: Vec<(f64, f64)> = states.map(|state| (state.position, state.velocity)).collect();
        set_value::smooth(&joint.control, cycle.period_s, &mut command);
        Loop {
            sensor: Sensor::new(command.first().map_or(0.0, |first| first.0)),
            command,
            integral: Integral::default(),
            bend: Bend::default(),
            sent: Vec::with_capacity(periods + 1),
            arrival: (steps(joint.valve.dead_time_s), 0),
        }
    };
    Ok((tracks.iter().zip(&plant.parameters.joints).map(own).collect(), periods))
}

/// Whole steps in a time that is not negative.
fn steps(time_s: f64) -> usize {
    whole((time_s / STEP_S).round())
}
