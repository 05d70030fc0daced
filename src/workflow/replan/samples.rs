//! Plans by samples, with rests before and after.

use crate::{
    plan::Setup,
    series::{JointKind, Series, SignalError, Track},
    spline::{Motion, Quantity, Samples},
    workflow::{
        carried::rest::{COMMAND_TAIL_S, PLAN_LEAD_S},
        same_plan::grid,
    },
};

/// A motion by samples, with rests before and after.
pub(super) fn sampled(setup: &Setup, motion: &Motion) -> Result<Series, SignalError> {
    let duration_s = motion.duration_s();
    let t_s = grid(duration_s + PLAN_LEAD_S + COMMAND_TAIL_S);
    let local_s: Vec<f64> = t_s.iter().map(|t| t - PLAN_LEAD_S).collect();
    let mut samples = Samples::default();
    motion.sample(&local_s, Quantity::Velocity, &mut samples);
    let inside = |(v, t): (&f64, &f64)| if (0.0..=duration_s).contains(t) { *v } else { 0.0 };
    let one = |(j, (name, kind)): (usize, (String, JointKind))| {
        let speed = samples.of(Quantity::Velocity, j).iter().zip(&local_s).map(inside).collect();
        Track::of(kind, &name, t_s.clone(), samples.of(Quantity::Position, j).to_vec(), &[])?
            .with_velocity(speed)
    };
    let joints = setup.joint_names().into_iter().zip(setup.joint_kinds()).enumerate();
    Ok(Series { tracks: joints.map(one).collect::<Result<_, _>>()? })
}
