//! Plans by samples, with rests before and after.

use crate::{
    plan::Setup,
    series::{Series, SignalError, Track},
    spline::{Motion, Quantity, Samples},
    workflow::carried::rest::{COMMAND_TAIL_S, PLAN_LEAD_S},
};

/// A stretch of a series every [`STEP_S`](crate::fit::STEP_S), its times counted from its start; beyond its ends joints rest.
pub(super) fn cut(series: &Series, from_s: f64, to_s: f64) -> Result<Series, SignalError> {
    let t_s = grid(to_s - from_s);
    let one = |track: &Track| {
        let states: Vec<_> = t_s.iter().map(|t| track.held_at(t + from_s)).collect();
        let position = states.iter().map(|state| state.position).collect();
        let made = Track::new(track.name(), t_s.clone(), position, &[])?;
        match track.velocity() {
            Some(_) => made.with_velocity(states.iter().map(|state| state.velocity).collect()),
            None => Ok(made),
        }
    };
    Ok(Series { tracks: series.tracks.iter().map(one).collect::<Result<_, _>>()? })
}

fn grid(duration_s: f64) -> Vec<f64> {
    let mut t_s = vec![0.0];
    while let Some(last) = t_s.last().filter(|last| **last < duration_s) {
        let next = (last / crate::fit::STEP_S).round() + 1.0;
        t_s.push(next * crate::fit::STEP_S);
    }
    t_s
}

/// A motion by samples, with rests before and after.
pub(super) fn sampled(setup: &Setup, motion: &Motion) -> Result<Series, SignalError> {
    let duration_s = motion.duration_s();
    let t_s = grid(duration_s + PLAN_LEAD_S + COMMAND_TAIL_S);
    let local_s: Vec<f64> = t_s.iter().map(|t| t - PLAN_LEAD_S).collect();
    let mut samples = Samples::default();
    motion.sample(&local_s, Quantity::Velocity, &mut samples);
    let inside = |(v, t): (&f64, &f64)| if (0.0..=duration_s).contains(t) { *v } else { 0.0 };
    let one = |(j, name): (usize, String)| {
        let speed = samples.of(Quantity::Velocity, j).iter().zip(&local_s).map(inside).collect();
        Track::new(name, t_s.clone(), samples.of(Quantity::Position, j).to_vec(), &[])?.with_velocity(speed)
    };
    Ok(Series { tracks: setup.joint_names().into_iter().enumerate().map(one).collect::<Result<_, _>>()? })
}
