//! Torques of cylinders from logged pressures.

use serde::{Deserialize, Serialize};

use crate::{
    arm::{Arm, Drive},
    log::{Recording, SignalRole},
    math::{median, quantile},
    series::{Signal, Track},
    workflow::carried::Carried,
};

/// Torques that a joint's cylinders made and could make. Pairs are for growing and for shrinking angles, both
/// positive, N m.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct JointTorque {
    /// The joint.
    pub name: String,
    /// Samples with pressures.
    pub samples: usize,
    /// Largest torque that the pressures made, 999 of 1000 samples below: the limit is not below.
    pub reached_n_m: [f64; 2],
    /// Torque available in every pose of the run at the median supply pressure; the torque reached if no supply pressure
    /// was logged.
    pub available_n_m: [f64; 2],
}

/// Torques of all joints of a run whose log has pressures of both sides and a task with cylinders.
pub fn torques(recording: &Recording) -> Vec<JointTorque> {
    if !recording.has(SignalRole::CapPressure) || !recording.has(SignalRole::RodPressure) {
        return Vec::new();
    }
    let arm = Carried::of(recording).arm().and_then(Result::ok);
    let Some(arm) = arm else { return Vec::new() };
    let one = |measured: &Track| {
        let name = measured.name();
        let pressure = |role| recording.signal(role, name);
        let (cap, rod) = (pressure(SignalRole::CapPressure)?, pressure(SignalRole::RodPressure)?);
        torque(&arm, measured, cap, rod, pressure(SignalRole::SupplyPressure))
    };
    recording.measured.tracks.iter().filter_map(one).collect()
}

fn torque(
    arm: &Arm,
    measured: &Track,
    cap: &Signal,
    rod: &Signal,
    supply: Option<&Signal>,
) -> Option<JointTorque> {
    let joint = arm.chain.joints().iter().position(|joint| joint.name == measured.name())?;
    let cylinder = (*arm.hydraulics.cylinders().get(joint)?)?;
    // What is told is a torque.
    matches!(cylinder.drive(), Drive::Turns(_)).then_some(())?;
    let (push_m2, pull_m2) = (cylinder.push_area_m2(), cylinder.pull_area_m2());
    let supply_pa = supply.map(|signal| median(signal.values().to_vec()));
    let mut made = [Vec::new(), Vec::new()];
    let mut available_n_m = [f64::INFINITY; 2];
    for (&t_s, &angle_rad) in measured.t_s().iter().zip(measured.position()) {
        let (Some(cap_pa), Some(rod_pa)) = (cap.at(t_s), rod.at(t_s)) else { continue };
        let (sin, cos) = angle_rad.sin_cos();
        let (_, lever_m) = cylinder.length_and_lever(sin, cos);
        let torque_n_m = (cap_pa * push_m2 - rod_pa * pull_m2) * lever_m;
        for (made, way) in made.iter_mut().zip([1.0, -1.0]) {
            made.push((way * torque_n_m).max(0.0));
        }
        if let Some(supply_pa) = supply_pa {
            let most = |area_m2: f64| supply_pa * area_m2 * lever_m.abs();
            let grows = if lever_m > 0.0 { [push_m2, pull_m2] } else { [pull_m2, push_m2] };
            for (least, area_m2) in available_n_m.iter_mut().zip(grows) {
                *least = least.min(most(area_m2));
            }
        }
    }
    let samples = made[0].len();
    if samples == 0 {
        return None;
    }
    let reached_n_m = made.map(|made| quantile(made, 0.999));
    if supply_pa.is_none() {
        available_n_m = reached_n_m;
    }
    Some(JointTorque { name: measured.name().to_owned(), samples, reached_n_m, available_n_m })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::series::Quantity;

    #[test]
    fn a_cylinder_that_holds_a_load_made_the_torque_of_its_pressures_and_could_make_that_of_the_supply() {
        let arm = Arm::sample().unwrap();
        let name = arm.chain.joints()[0].name.clone();
        let cylinder = arm.hydraulics.cylinders()[0].unwrap();
        let t_s = vec![0.0, 1.0, 2.0];
        let track = Track::new(name.clone(), t_s.clone(), vec![0.9; 3], &[]).unwrap();
        let pressure =
            |pa: f64| Signal::new(&name, Quantity::Pressure, t_s.clone(), vec![pa; 3], &[]).unwrap();
        let found = torque(&arm, &track, &pressure(5e6), &pressure(1e6), Some(&pressure(14e6))).unwrap();
        let (sin, cos) = 0.9_f64.sin_cos();
        let lever_m = cylinder.length_and_lever(sin, cos).1;
        let made = (5e6 * cylinder.push_area_m2() - 1e6 * cylinder.pull_area_m2()) * lever_m;
        let (way, other) = if made > 0.0 { (0, 1) } else { (1, 0) };
        assert!((found.reached_n_m[way] - made.abs()).abs() < 1e-6 && found.reached_n_m[other] <= 0.0);
        let area_m2 =
            if way == usize::from(lever_m < 0.0) { cylinder.push_area_m2() } else { cylinder.pull_area_m2() };
        assert!((found.available_n_m[way] - 14e6 * area_m2 * lever_m.abs()).abs() < 1e-6, "{found:?}");
    }
}
