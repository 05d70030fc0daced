//! Inverse kinematics.

use hydrotrace::{
    arm::{ArmError, Chain, Joint, Pose},
    units::DEGREE_RAD,
};
use nalgebra::{DVector, Rotation3, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;

use super::*;

/// How far apart, m and rad together.
fn apart(a: &Pose, b: &Pose) -> f64 {
    (a.translation.vector - b.translation.vector).norm() + turn(a, b).norm()
}

/// Rotation vector from `b` to `a`, rad.
fn turn(a: &Pose, b: &Pose) -> Vector3<f64> {
    UnitQuaternion::from_rotation_matrix(&(a.rotation * b.rotation.inverse())).scaled_axis()
}

/// A posture within the limits.
fn posture(chain: &Chain, seed: u64) -> Vec<f64> {
    let limits = chain.joints().iter().map(|joint| joint.limit);
    let shares = random(seed, chain.joint_count(), 0.5);
    limits
        .zip(shares)
        .map(|(limit, share)| {
            let (low, high) = (limit.lower_rad.max(-2.5), limit.upper_rad.min(2.5));
            low + (high - low) * (share + 0.5)
        })
        .collect()
}

fn far(a: &[f64], b: &[f64]) -> f64 {
    norm(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn the_posture_found_has_the_tool_there_within_the_limits_and_is_no_farther_than_known(
        seed in 0_u64..1 << 40,
    ) {
        let chain = sample().chain;
        let (known, near) = (posture(&chain, seed), posture(&chain, seed + 1));
        let pose = chain.tool_pose(&known);
        let found = chain.reach(&pose, &near).unwrap();
        prop_assert!(apart(&chain.tool_pose(&found), &pose) < 1e-9);
        prop_assert!(allows(&chain, &found, 1e-12));
        prop_assert!(far(&found, &near) < far(&known, &near) + 1e-9);
    }
}

#[test]
fn skew_axes_are_brought_there_too() {
    for seed in 0..8 {
        let chain = skew(seed);
        // Five joints reach only poses that they have.
        let pose = chain.tool_pose(&posture(&chain, 2 * seed));
        let found = chain.reach(&pose, &posture(&chain, 2 * seed + 1)).unwrap();
        assert!(apart(&chain.tool_pose(&found), &pose) < 1e-9 && allows(&chain, &found, 1e-12));
    }
}

/// Four joints one behind the other in a plane, each with a narrow range.
fn planar() -> Chain {
    let mut text = String::from("<robot name='r'><link name='l0'/>");
    for (k, (from, to)) in [(-0.4, 1.4), (-2.2, -0.3), (-1.9, 0.6), (-1.2, 1.2)].iter().enumerate() {
        text += &format!(
            "<link name='l{next}'/><joint name='j{next}' type='revolute'><parent link='l{k}'/><child link='l{next}'/>\
             <origin xyz='{step} 0 0'/><axis xyz='0 1 0'/><limit lower='{from}' upper='{to}' velocity='1' effort='1'/></joint>",
            next = k + 1,
            step = [0.0, 2.4, 1.8, 0.9][k],
        );
    }
    text += "<link name='tool'/><joint name='tip' type='fixed'><origin xyz='0.6 0 0'/><parent link='l4'/><child link='tool'/>\
             </joint></robot>";
    Chain::from_urdf(&text, "r.urdf", None).unwrap()
}

#[test]
fn no_pose_between_narrow_ranges_is_called_out_of_reach() {
    let chain = planar();
    let refused = |seed: &u64| {
        let pose = chain.tool_pose(&posture(&chain, 2 * seed));
        chain.reach(&pose, &posture(&chain, 2 * seed + 1)).is_err()
    };
    assert_eq!((0..400).filter(refused).count(), 0);
}

#[test]
fn no_motion_that_keeps_the_tool_leads_nearer_to_the_posture_asked_for() {
    let chain = sample().chain;
    let mut inside = 0;
    for seed in 0..12 {
        let near = posture(&chain, 100 + seed);
        let shift: Vec<f64> = near.iter().zip(random(seed, 6, 0.15)).map(|(q, d)| q + d).collect();
        let Ok(found) = chain.reach(&chain.tool_pose(&shift), &near) else { continue };
        if !allows(&chain, &found, -1e-6) {
            continue;
        }
        inside += 1;
        let jacobian = chain.tool_jacobian(&found);
        let way = DVector::from_fn(6, |i, _| near[i] - found[i]);
        let seen = jacobian.clone().pseudo_inverse(1e-9).unwrap() * (&jacobian * &way);
        assert!((way - seen).norm() < 1e-8);
    }
    assert!(inside >= 3, "{inside}");
}

/// Key points of the paper's simulation and tasks, deg, with the pitch of the panel there.
const KEY_POINTS: [([f64; 6], f64); 17] = [
    ([43.35, 78.54, -90.05, 0.0, 0.0, 0.0], 148.16),
    ([46.35, 86.43, -56.68, 1.68, 1.31, 0.68], 100.23),
    ([55.04, 99.62, -39.25, 4.71, 3.65, 2.71], 53.52),
    ([62.67, 104.06, -21.94, 6.51, 5.53, 4.64], 18.53),
    ([68.04, 112.4, -9.04, 8.14, 6.99, 6.53], -13.06),
    ([74.4, 124.5, 1.68, 12.8, 8.18, 7.31], -48.87),
    ([84.13, 133.6, 12.81, 16.14, 10.15, 9.21], -86.04),
    ([30.0, 130.0, -60.0, 0.0, 0.0, 0.0], 80.0),
    ([37.2, 126.4, -16.8, 6.8, 8.8, 10.4], 7.2),
    ([73.2, 119.2, 19.2, 14.7, 15.8, 16.0], -78.1),
    ([80.0, 104.0, 19.0, 16.0, 18.0, 18.0], -75.0),
    ([61.2, 108.4, -1.6, 12.8, 11.8, 10.8], -23.4),
    ([57.2, 103.6, -12.8, 10.0, 10.0, 10.0], 2.0),
    ([44.4, 122.8, -20.4, 15.0, 14.4, 10.8], -7.0),
    ([51.6, 108.4, -24.0, 14.0, 13.4, 10.4], 6.2),
    ([65.6, 86.8, -45.6, 11.4, 7.2, 6.8], 47.8),
    ([73.0, 57.8, -47.2, 0.0, 0.0, 0.0], 96.4),
];

#[test]
fn the_key_points_of_the_paper_can_be_given_as_tool_poses() {
    let chain = sample().chain;
    let mut near = vec![0.5; 6];
    for (deg, pitch_deg) in KEY_POINTS {
        let known = deg.map(|angle| angle * DEGREE_RAD);
        let pose = chain.tool_pose(&known);
        let pitch = Rotation3::from_axis_angle(&Vector3::y_axis(), -pitch_deg * DEGREE_RAD);
        assert!((pose.rotation.matrix() - pitch.matrix()).norm() < 1e-9, "{deg:?}");
        near = chain.reach(&pose, &near).unwrap();
        assert!(apart(&chain.tool_pose(&near), &pose) < 1e-9);
        assert!(far(&chain.reach(&pose, &known).unwrap(), &known) < 1e-9);
    }
}

#[test]
fn a_pose_out_of_reach_or_out_of_the_plane_says_by_how_much() {
    let chain = sample().chain;
    let near = posture(&chain, 1);
    let there = chain.tool_pose(&near);
    let beside = Pose::from_parts(Translation3::new(0.0, 0.25, 0.0), Rotation3::identity()) * there;
    let Err(ArmError::Unreachable { distance_m, angle_rad }) = chain.reach(&beside, &near) else { panic!() };
    assert!((distance_m - 0.25).abs() < 1e-3 && angle_rad < 1e-3, "{distance_m} {angle_rad}");
    // An angle that the description rounds is no miss.
    let rounded = Pose::from_parts(Translation3::new(0.0, 4e-7, 0.0), Rotation3::identity()) * there;
    let posture = chain.reach(&rounded, &near).unwrap();
    assert!(chain.is_at(&rounded, &posture, 1e-6), "{posture:?}");
    let far = Pose::from_parts(Translation3::new(9.0, 0.0, 0.0), there.rotation);
    let message = chain.reach(&far, &near).unwrap_err().to_string();
    assert!(message.starts_with("the tool pose is out of reach by "), "{message}");
}

#[test]
fn nonsense_asked_for_is_unreachable_and_nothing_worse() {
    let chain = spatial();
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        let pose = Pose::from_parts(Translation3::new(bad, 0.0, 0.0), Rotation3::identity());
        assert!(chain.reach(&pose, &[bad; 3]).is_err());
    }
}

/// Whether a posture is within all limits, up to `slack_rad`.
fn allows(chain: &Chain, position_rad: &[f64], slack_rad: f64) -> bool {
    let within = |(joint, q): (&Joint, &f64)| {
        (joint.limit.lower_rad - slack_rad..=joint.limit.upper_rad + slack_rad).contains(q)
    };
    position_rad.len() == chain.joint_count() && chain.joints().iter().zip(position_rad).all(within)
}
