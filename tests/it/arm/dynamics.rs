//! Laws of mechanics, on chains of skew axes, about which joints turn or along which they slide.

use nalgebra::{Matrix3, UnitQuaternion, Vector3, Vector6};
use proptest::prelude::*;

use super::*;

/// Energy by the torques alone: kinetic from the mass matrix, potential by integrating gravity's
/// torques from a fixed posture.
fn kinetic_j(chain: &Chain, q: &[f64], qd: &[f64]) -> f64 {
    let zero = vec![0.0; q.len()];
    let (moved, still) = (torque(chain, None, q, &zero, qd), torque(chain, None, q, &zero, &zero));
    0.5 * (0..q.len()).map(|i| qd[i] * (moved[i] - still[i])).sum::<f64>()
}

fn gravity_w(chain: &Chain, q: &[f64], qd: &[f64]) -> f64 {
    let zero = vec![0.0; q.len()];
    torque(chain, None, q, &zero, &zero).iter().zip(qd).map(|(t, w)| t * w).sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn power_of_the_torques_is_the_growth_of_energy(seed in 0_u64..1 << 40) {
        let chain = skew(seed);
        let n = chain.joint_count();
        let (q, qd, qdd) = (random(seed, n, 3.0), random(seed + 1, n, 2.0), random(seed + 2, n, 4.0));
        let power_w: f64 = torque(&chain, None, &q, &qd, &qdd).iter().zip(&qd).map(|(t, w)| t * w).sum();
        let h = 1e-5;
        let at = |t: f64| {
            let q: Vec<f64> = (0..n).map(|i| q[i] + t * qd[i] + 0.5 * t * t * qdd[i]).collect();
            let qd: Vec<f64> = (0..n).map(|i| qd[i] + t * qdd[i]).collect();
            kinetic_j(&chain, &q, &qd)
        };
        let growth_w = (at(h) - at(-h)) / (2.0 * h) + gravity_w(&chain, &q, &qd);
        prop_assert!((power_w - growth_w).abs() < 1e-6 * (1.0 + power_w.abs()), "{power_w} {growth_w}");
    }

    #[test]
    fn holding_takes_the_slope_of_height_times_weight(seed in 0_u64..1 << 40) {
        // A payload of known height: the only energy that is known without the dynamics.
        let chain = skew(seed);
        let n = chain.joint_count();
        let (q, zero) = (random(seed, n, 3.0), vec![0.0; n]);
        let place_m = Vector3::new(0.2, -0.3, 0.1);
        let payload = Inertia::point(5.0, place_m).unwrap();
        let height = |q: &[f64]| (chain.tool_pose(q) * nalgebra::Point3::from(place_m)).z;
        let (with, without) =
            (torque(&chain, Some(&payload), &q, &zero, &zero), torque(&chain, None, &q, &zero, &zero));
        for joint in 0..n {
            let h = 1e-6;
            let moved = |by: f64| { let mut q = q.clone(); q[joint] += by; height(&q) };
            let slope = 5.0 * 9.81 * (moved(h) - moved(-h)) / (2.0 * h);
            prop_assert!((with[joint] - without[joint] - slope).abs() < 1e-6);
        }
    }

    #[test]
    fn torque_is_linear_in_the_payload(seed in 0_u64..1 << 40, mass_kg in 0.1_f64..50.0) {
        let chain = skew(seed);
        let n = chain.joint_count();
        let (q, qd, qdd) = (random(seed, n, 3.0), random(seed + 1, n, 2.0), random(seed + 2, n, 4.0));
        let body = |scale: f64| {
            let tensor = Matrix3::new(1.0, 0.1, 0.0, 0.1, 0.9, 0.2, 0.0, 0.2, 0.8) * scale;
            torque(&chain, Inertia::new(scale, Vector3::new(0.1, 0.0, 0.3), tensor).as_ref(), &q, &qd, &qdd)
        };
        let (none, once, twice) = (body(0.0), body(mass_kg), body(2.0 * mass_kg));
        for i in 0..n {
            let off = twice[i] - none[i] - 2.0 * (once[i] - none[i]);
            prop_assert!(off.abs() < 1e-10 * norm(&twice));
        }
    }

    #[test]
    fn the_jacobian_is_the_slope_of_the_pose(seed in 0_u64..1 << 40) {
        let chain = skew(seed);
        let n = chain.joint_count();
        let (q, qd) = (random(seed, n, 3.0), random(seed + 1, n, 2.0));
        let h = 1e-6;
        let at = |t: f64| chain.tool_pose(&(0..n).map(|i| q[i] + t * qd[i]).collect::<Vec<_>>());
        let (before, after) = (at(-h), at(h));
        let linear = (after.translation.vector - before.translation.vector) / (2.0 * h);
        let angular = UnitQuaternion::from_rotation_matrix(&(after.rotation * before.rotation.inverse())).scaled_axis() / (2.0 * h);
        let slope = Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z);
        let twist = chain.tool_jacobian(&q) * nalgebra::DVector::from_column_slice(&qd);
        prop_assert!((twist - slope).norm() < 1e-7 * (1.0 + slope.norm()));
        let speed_m_s = chain.tool_speed_m_s(&q, &qd);
        prop_assert!((twist.fixed_rows::<3>(0).norm() - speed_m_s).abs() < 1e-11);
    }
}

#[test]
fn slices_that_are_too_short_leave_the_joints_beyond_alone() {
    let chain = spatial();
    let mut found = [[f64::NAN]; 9];
    let motion =
        Motion { position_rad: &[[0.1]; 3], speed_rad_s: &[[0.2]; 9], acceleration_rad_s2: &[[0.3]; 9] };
    chain.inverse_dynamics(&chain.load(None), motion, &mut Workspace::new(&chain), &mut found);
    assert!(found[..3].iter().all(|[t]| t.is_finite()) && found[3..].iter().all(|[t]| t.is_nan()));
}
