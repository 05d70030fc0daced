//! Cylinders: the derived values of the sample arm, virtual work, directions.

use std::f64::consts::PI;

use hydrotrace::{
    arm::{Actuation, ArmError, Cylinder, Drive, Hydraulics, Linkage, Rod, Rods},
    units::DEGREE_RAD,
};
use proptest::prelude::*;

use super::*;

const TOML: &str = include_str!("../../../sample-logs/arm/hydraulics.toml");

/// Of the file that the sample arm's numbers were derived with: the joint's range, deg, length, lever
/// arm, lifting and lowering torque, each least and most.
const DERIVED: [[(f64, f64); 5]; 6] = [
    [(20., 95.), (0.5904, 0.9185), (0.1198, 0.3599), (3241.1, 9739.6), (2112.7, 6348.9)],
    [(50., 145.), (0.5349, 0.8581), (0.1375, 0.22), (3720.3, 5953.5), (2425.1, 3880.9)],
    [(-95., 30.), (0.4802, 0.7271), (0.0533, 0.14), (1443.7, 3788.6), (941.1, 2469.6)],
    [(-25., 25.), (0.2012, 0.2917), (0.082, 0.1189), (1109.7, 1609.0), (723.4, 1048.8)],
    [(-25., 25.), (0.2012, 0.2917), (0.082, 0.1189), (712.3, 1032.9), (428.5, 621.3)],
    [(-25., 25.), (0.2001, 0.2845), (0.0771, 0.1096), (669.6, 952.0), (402.8, 572.7)],
];

fn cylinder(joint: usize) -> Cylinder {
    sample().hydraulics.cylinders()[joint].unwrap()
}

fn actuation(joint: usize, q: f64, qd: f64, tau: f64) -> Actuation {
    cylinder(joint).actuation(q.sin_cos(), qd, tau)
}

/// What pulling and what pushing at supply pressure gives, the smaller first.
fn torque_range_nm(cylinder: &Cylinder, lever_m: f64) -> (f64, f64) {
    let (push, pull) = (cylinder.push_n() * lever_m, -cylinder.pull_n() * lever_m);
    (push.min(pull), push.max(pull))
}

#[test]
fn derived_values_hold_to_their_printed_digits() {
    for (joint, [range, length_m, lever_m, lift_nm, lower_nm]) in DERIVED.into_iter().enumerate() {
        let cylinder = cylinder(joint);
        let mut spans = [(f64::INFINITY, f64::NEG_INFINITY); 4];
        for k in 0..=20_000 {
            let q = (range.0 + (range.1 - range.0) * f64::from(k) / 20_000.0) * DEGREE_RAD;
            let (length, lever) = cylinder.length_and_lever(q.sin(), q.cos());
            let (lift, lower) = torque_range_nm(&cylinder, lever);
            for (span, value) in spans.iter_mut().zip([length, lever.abs(), -lift, lower]) {
                *span = (span.0.min(value), span.1.max(value));
            }
        }
        let digits = [5e-5, 5e-5, 0.05, 0.05];
        for ((found, said), digit) in
            spans.into_iter().zip([length_m, lever_m, lift_nm, lower_nm]).zip(digits)
        {
            let near = |a: f64, b: f64| (a - b).abs() < 1.02 * digit;
            assert!(near(found.0, said.0) && near(found.1, said.1), "J{}: {found:?} {said:?}", joint + 1);
        }
    }
}

#[test]
fn torque_limits_of_the_urdf_are_the_best_that_the_cylinders_lift() {
    let arm = sample();
    for (joint, [.., lift_nm, _]) in arm.chain.joints().iter().zip(DERIVED) {
        assert_eq!(joint.limit.torque_nm, lift_nm.1);
    }
}

proptest! {
    #[test]
    fn the_lever_is_the_slope_of_the_length(joint in 0_usize..6, share in 0.0_f64..1.0) {
        let limit = sample().chain.joints()[joint].limit;
        let q = limit.lower_rad + share * (limit.upper_rad - limit.lower_rad);
        let at = |q: f64| cylinder(joint).length_and_lever(q.sin(), q.cos());
        let slope = (at(q + 1e-6).0 - at(q - 1e-6).0) / 2e-6;
        prop_assert!((slope - at(q).1).abs() < 1e-8);
        let Drive::Turns(linkage) = *cylinder(joint).drive() else { panic!() };
        let angle = linkage.offset_rad + linkage.sense * q;
        let (a, b) = (linkage.inner_m, linkage.outer_m);
        let length = (a * a + b * b - 2.0 * a * b * angle.cos()).sqrt();
        prop_assert!((length - at(q).0).abs() < 1e-14);
    }

    #[test]
    fn force_times_rod_speed_is_torque_times_joint_speed(
        joint in 0_usize..6, q in -1.0_f64..2.0, qd in -2.0_f64..2.0, tau in -5e3_f64..5e3,
    ) {
        let found = actuation(joint, q, qd, tau);
        // At a dead centre no force turns the joint.
        prop_assume!(found.lever_m.abs() > 1e-6);
        prop_assert!((found.force_n * found.rod_speed_m_s - tau * qd).abs() < 1e-9 * (1.0 + (tau * qd).abs()));
        prop_assert!(found.flow_m3_s >= 0.0 && found.force_share >= 0.0);
    }

    #[test]
    fn the_full_torque_either_way_is_the_full_force(joint in 0_usize..6, share in 0.01_f64..0.99) {
        let limit = sample().chain.joints()[joint].limit;
        let q = limit.lower_rad + share * (limit.upper_rad - limit.lower_rad);
        let (least, most) = torque_range_nm(&cylinder(joint), actuation(joint, q, 0.0, 0.0).lever_m);
        prop_assert!(least < 0.0 && most > 0.0);
        for torque in [least, most] {
            prop_assert!((actuation(joint, q, 0.0, torque).force_share - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_mirrored_linkage_does_the_same_the_other_way(q in 0.4_f64..1.6, qd in -1.0_f64..1.0, tau in -5e3_f64..5e3) {
        // J1 turned about: its sign and its range change sign.
        let urdf = include_str!("../../../sample-logs/arm/arm.urdf");
        let urdf = urdf.replacen(r#"lower="0.349066" upper="1.658063""#, r#"lower="-1.658063" upper="-0.349066""#, 1);
        let toml = TOML.replacen("angle_sign = -1", "angle_sign = 1", 1);
        let arm = Arm::new(("a", &urdf), Some("tool"), ("b", &toml)).unwrap();
        let mirrored = arm.hydraulics.cylinders()[0].unwrap().actuation((-q).sin_cos(), -qd, -tau);
        let found = actuation(0, q, qd, tau);
        prop_assert_eq!(Actuation { lever_m: -mirrored.lever_m, ..mirrored }, found);
    }
}

#[test]
fn flow_fills_the_cap_side_out_and_the_rod_side_in_for_every_cylinder() {
    let arm = sample();
    let q = [0.8, 1.2, -0.5, 0.1, -0.1, 0.2];
    let mut out = [None; 6];
    let flow_in = actuate(&arm.hydraulics, &q, &[0.1; 6], &[0.0; 6], &mut out);
    assert!(out.iter().flatten().all(|a| a.rod_speed_m_s < 0.0));
    let pulled: f64 = out.iter().flatten().map(|a| a.flow_m3_s).sum();
    assert_eq!(flow_in, pulled);
    let one = out[3].unwrap();
    let ring_m2 = 2.0 * std::f64::consts::FRAC_PI_4 * (0.025_f64.powi(2) - 0.014_f64.powi(2));
    assert!((one.flow_m3_s - ring_m2 * one.rod_speed_m_s.abs()).abs() < 1e-15);
    actuate(&arm.hydraulics, &q, &[-0.1; 6], &[0.0; 6], &mut out);
    let bore_m2 = 2.0 * std::f64::consts::FRAC_PI_4 * 0.025_f64.powi(2);
    assert!((out[3].unwrap().flow_m3_s - bore_m2 * one.rod_speed_m_s.abs()).abs() < 1e-15);
}

fn fault(from: &str, to: &str) -> String {
    let text = TOML.replacen(from, to, 1);
    assert_ne!(text, TOML);
    Hydraulics::from_toml(&text, "h.toml", &sample().chain).unwrap_err().to_string()
}

#[test]
fn faults_name_joint_key_what_was_found_and_what_is_expected() {
    assert_eq!(
        fault("bore_m = 0.05", "bore_m = -1.0"),
        "h.toml: [joint.J1] bore_m: found -1, expected a length above 0, m"
    );
    assert_eq!(
        fault("[joint.J2]", "[joint.J7]"),
        "h.toml: [joint]: found J7, expected a joint of the chain (J1, J2, J3, J4, J5, J6)"
    );
    assert!(fault("delta_rad = 2.96", "delta_rad = 3.96").contains("no dead centre"));
    assert!(fault("rod_m = 0.028", "rod_m = 0.05").contains("below the bore's"));
    assert!(fault("rod_m = 0.028", "rod_m = 0.0499").contains("pull it in"));
    assert!(fault("angle_sign = -1", "angle_sign = 2").contains("1 or -1"));
    assert!(
        fault("supply_pressure_pa = 16e6", "supply_pressure_pa = nan").contains("a supply above the return")
    );
    assert!(fault("mechanical_efficiency", "efficiency").contains("unknown field"));
    assert!(fault("cylinders = 1", "cylinders = 0").contains("1 to 64"));
}

/// The cylinders of a joint that turns and of one that slides, the second with these keys.
fn of_both(keys: &str) -> Result<Hydraulics, ArmError> {
    let text = format!(
        "supply_pressure_pa = 20e6\nreturn_pressure_pa = 1e6\nmechanical_efficiency = 0.9\npump_flow_m3_s = 1e-3\n\
         [joint.q2]\nbore_m = 0.08\nrod_m = 0.05\n{keys}\n"
    );
    Hydraulics::from_toml(&text, "h.toml", &sliding())
}

#[test]
fn a_cylinder_slides_a_joint_directly_or_by_chains() {
    let found = |travel: f64, speed_m_s: f64, force_n: f64| {
        let hydraulics = of_both(&format!("rod_per_travel = {travel}")).unwrap();
        // Whatever the position, so whatever its sine.
        hydraulics.cylinders()[1].unwrap().actuation((0.6, 0.8), speed_m_s, force_n)
    };
    let area_m2 = PI / 4.0 * 0.08 * 0.08;
    let direct = found(1.0, 0.3, 5e3);
    assert_eq!((direct.lever_m, direct.rod_speed_m_s, direct.force_n), (1.0, 0.3, 5e3));
    assert!((direct.flow_m3_s - 0.3 * area_m2).abs() < 1e-15);
    let chained = found(0.5, 0.3, 5e3);
    assert_eq!((chained.rod_speed_m_s, chained.force_n), (0.15, 1e4));
    let turned = found(-1.0, 0.3, 5e3);
    assert_eq!((turned.rod_speed_m_s, turned.force_n), (-0.3, -5e3));
    assert!(turned.flow_m3_s < direct.flow_m3_s, "the rod side fills with less");
}

#[test]
fn a_cylinder_is_driven_as_its_joint_moves() {
    let error = |keys: &str| of_both(keys).unwrap_err().to_string();
    let triangle = "a_m = 1.0\nb_m = 0.5\ndelta_rad = 1.0\nangle_sign = 1";
    assert_eq!(
        error(triangle),
        "h.toml: [joint.q2]: found a_m, b_m, delta_rad, angle_sign, expected rod_per_travel alone, for the joint slides"
    );
    assert!(error("").contains("found no key of its drive"));
    assert!(error("rod_per_travel = 0.0").contains("[joint.q2] rod_per_travel: found 0"));
    assert!(fault("a_m =", "rod_per_travel = 1.0\na_m =").contains("for the joint turns"));
    assert!(fault("b_m =", "# b_m =").contains("found a_m, delta_rad, angle_sign, expected a_m, b_m"));
    // No angle comes of the rod of a joint that slides.
    let text = TOML.to_owned() + "\n[joint.telescope]\nbore_m = 0.08\nrod_m = 0.05\nrod_per_travel = 1.0\n";
    let rods = Rods::from_toml(&text, "h.toml", None).unwrap();
    assert_eq!((rods.of("telescope"), rods.rod_per_travel("telescope")), (None, Some(1.0)));
    assert!(
        error("rod_per_travel = 1.0\nsensor_zero_m = 0.4")
            .contains("sensor_zero_m: found 0.4, expected none")
    );
}

#[test]
fn a_joint_without_entry_has_no_cylinder_and_takes_no_flow() {
    let chain = sample().chain;
    let text = TOML.split("[joint.J6]").next().unwrap();
    let hydraulics = Hydraulics::from_toml(text, "h", &chain).unwrap();
    assert!(hydraulics.cylinders()[5].is_none());
    let mut out = [None; 6];
    assert_eq!(actuate(&hydraulics, &[0.5; 6], &[0., 0., 0., 0., 0., 1.], &[0.0; 6], &mut out), 0.0);
}

#[test]
fn text_that_is_no_toml_is_refused_with_its_line() {
    let error = Hydraulics::from_toml("a = [", "h.toml", &sample().chain).unwrap_err();
    assert!(matches!(error, ArmError::Syntax { .. }) && error.to_string().contains("line 1"), "{error}");
}

proptest! {
    #[test]
    fn lengths_of_any_triangle_give_back_the_angles_and_the_slopes_are_each_others_inverse(
        sides in [0.05_f64..3.0, 0.05_f64..3.0], offset_rad in -4.0_f64..4.0, sense in prop::sample::select(vec![-1.0, 1.0]),
        between_rad in 2e-3_f64..PI - 2e-3, zero_m in -1.0_f64..1.0,
    ) {
        let linkage = Linkage { inner_m: sides[0], outer_m: sides[1], offset_rad, sense };
        let rod = Rod { linkage, zero_m, range_rad: None };
        let angle_rad = sense * (between_rad - offset_rad);
        let (logged_m, by_angle) = rod.logged_at(angle_rad).unwrap();
        let (again_rad, by_length) = rod.angle_at(logged_m).unwrap();
        prop_assert!((again_rad - angle_rad).abs() < 1e-9, "{angle_rad} {again_rad}");
        prop_assert!((by_angle * by_length - 1.0).abs() < 1e-6, "{by_angle} {by_length}");
        let [least, most] = rod.logged_range_m();
        prop_assert!(logged_m > least && logged_m < most);
        for none in [least - 1e-6, most + 1e-6, f64::NAN, f64::INFINITY, -10.0] {
            prop_assert_eq!(rod.angle_at(none), None, "{}", none);
        }
        for none in [-1e-6, PI + 1e-6, f64::NAN] {
            prop_assert_eq!(rod.logged_at(sense * (none - offset_rad)), None, "{}", none);
        }
    }

    #[test]
    fn lengths_are_those_that_a_plan_has(joint in 0_usize..6, share in 0.0_f64..1.0) {
        let urdf = include_str!("../../../sample-logs/arm/arm.urdf");
        let rods = Rods::from_toml(TOML, "h.toml", Some(urdf)).unwrap();
        let rod = rods.of(&format!("J{}", joint + 1)).unwrap();
        let (lower, upper) = rod.range_rad.unwrap();
        let q = lower + share * (upper - lower);
        let (length_m, lever_m) = cylinder(joint).length_and_lever(q.sin(), q.cos());
        let found = rod.logged_at(q).unwrap();
        prop_assert!((found.0 - length_m).abs() < 1e-14 && (found.1 - lever_m).abs() < 1e-12);
    }
}

#[test]
fn a_cylinder_with_two_angles_of_one_length_within_the_limits_is_refused_by_name() {
    let urdf = include_str!("../../../sample-logs/arm/arm.urdf");
    let text = TOML.replacen("delta_rad = 2.96", "delta_rad = 3.96", 1);
    let error = Rods::from_toml(&text, "h.toml", Some(urdf)).unwrap_err().to_string();
    assert!(
        error.starts_with("h.toml: [joint.J1] delta_rad: found") && error.contains("no dead centre"),
        "{error}"
    );
    // Without limits nobody can tell.
    assert!(Rods::from_toml(&text, "h.toml", None).is_ok());
    let text = TOML.replacen("angle_sign = -1", "angle_sign = -1\nsensor_zero_m = inf", 1);
    let error = Rods::from_toml(&text, "h.toml", None).unwrap_err().to_string();
    assert_eq!(error, "h.toml: [joint.J1] sensor_zero_m: found inf, expected a length, m");
}

/// What a state of the arm means for its cylinders, by joint, from angles, rad, speeds, rad/s, and torques, N m; gives the flow
/// that all take together, m³/s.
fn actuate(
    hydraulics: &Hydraulics,
    position_rad: &[f64],
    speed_rad_s: &[f64],
    torque_nm: &[f64],
    actuation: &mut [Option<Actuation>],
) -> f64 {
    let mut flow_m3_s = 0.0;
    let state = position_rad.iter().zip(speed_rad_s).zip(torque_nm);
    for ((cylinder, ((q, &qd), &tau)), out) in hydraulics.cylinders().iter().zip(state).zip(actuation) {
        *out = cylinder.map(|cylinder| cylinder.actuation(q.sin_cos(), qd, tau));
        flow_m3_s += out.map_or(0.0, |actuation| actuation.flow_m3_s);
    }
    flow_m3_s
}
