//! Laws of the error at the tool: geometry by hand, and simulated runs.

use hydrotrace::{
    arm::{Arm, ArmError, Kinematics},
    plant::Plant,
    replay::{Rules, ToolReplay, tool_replay},
    series::{JointKind, Pair, align},
};
use proptest::prelude::*;

use crate::support::machine::{run, task};

const TURNS: JointKind = JointKind::Turns;
const SLIDES: JointKind = JointKind::Slides;

/// A URDF of joints one behind the other: name, type, axis, and the step of the base to it; the tool lies `reach_m` along x.
fn urdf(joints: &[(&str, &str, &str)], reach_m: f64) -> String {
    let mut text = String::from("<robot name='r'><link name='l0'/>");
    for (k, (name, kind, axis)) in joints.iter().enumerate() {
        text += &format!(
            "<link name='l{}'/><joint name='{name}' type='{kind}'><parent link='l{k}'/><child link='l{}'/><axis xyz='{axis}'/></joint>",
            k + 1,
            k + 1
        );
    }
    let last = joints.len();
    text + &format!(
        "<link name='tool'/><joint name='tip' type='fixed'><origin xyz='{reach_m} 0 0'/><parent link='l{last}'/><child link='tool'/></joint></robot>"
    )
}

fn arm(joints: &[(&str, &str, &str)], reach_m: f64) -> Kinematics {
    let kind = |kind: &str| if kind == "prismatic" { SLIDES } else { TURNS };
    let known: Vec<(&str, JointKind)> = joints.iter().map(|(name, of, _)| (*name, kind(of))).collect();
    Kinematics::from_urdf(&urdf(joints, reach_m), "r.urdf", None, &known).unwrap()
}

/// Ten seconds at 100 Hz of a plan and a measurement.
fn pair(name: &str, kind: JointKind, planned: impl Fn(f64) -> f64, measured: impl Fn(f64) -> f64) -> Pair {
    let t_s: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).collect();
    Pair {
        name: name.into(),
        kind,
        planned: t_s.iter().map(|t| planned(*t)).collect(),
        planned_velocity: None,
        measured: t_s.iter().map(|t| measured(*t)).collect(),
        segments: std::iter::once(0..t_s.len()).collect(),
        planned_interval_s: 0.01,
        planned_step: None,
        matched: t_s.len(),
        unmatched: 0,
        t_s: t_s.into(),
    }
}

fn found(arm: &Kinematics, pairs: &[Pair]) -> ToolReplay {
    tool_replay(arm, pairs, &Rules::default()).unwrap().0
}

/// From 2 s to 4 s at 0.1 a second, then rest until 6 s, then on until 7 s.
fn moves(t_s: f64) -> f64 {
    0.1 * ((t_s - 2.0).clamp(0.0, 2.0) + (t_s - 6.0).clamp(0.0, 1.0))
}

#[test]
fn a_joint_off_by_a_small_angle_moves_the_tool_by_its_radius_times_that() {
    let arm = arm(&[("a", "continuous", "0 0 1"), ("b", "revolute", "0 1 0")], 2.0);
    let off_rad = 1e-3;
    let tool =
        found(&arm, &[pair("a", TURNS, moves, |t| moves(t) - off_rad), pair("b", TURNS, |_| 0.0, |_| 0.0)]);
    let worst = &tool.worst.deviation;
    assert!((worst.error_m - 2.0 * off_rad).abs() < 1e-8, "{worst:?}");
    assert!(
        [worst.orientation_rad, tool.rms_orientation_rad, tool.mean_orientation_rad]
            .iter()
            .all(|found| (found.unwrap() - off_rad).abs() < 1e-9)
    );
    assert!((worst.causes[0].share - 1.0).abs() < 1e-6 && worst.causes[1].share == 0.0, "{worst:?}");
    assert_eq!(worst.main_cause().unwrap().joint, "a");
    // The tool is behind on the way that it goes.
    let split = tool.split.unwrap();
    assert!((split.rms_along_m - 2.0 * off_rad).abs() < 1e-6 && split.worst_across_m < 1e-5, "{split:?}");
}

#[test]
fn a_measurement_that_is_the_plan_has_no_error_and_no_cause() {
    let arm = arm(&[("a", "revolute", "0 0 1"), ("b", "prismatic", "1 0 0")], 1.0);
    let tool = found(&arm, &[pair("a", TURNS, moves, moves), pair("b", SLIDES, moves, moves)]);
    assert_eq!((tool.rms_m, tool.mean_m, tool.worst.deviation.error_m), (0.0, 0.0, 0.0));
    assert_eq!(tool.worst_orientation_rad, Some(0.0));
    assert!(tool.worst.deviation.causes.is_empty() && tool.worst.deviation.main_cause().is_none());
}

#[test]
fn a_tool_that_is_late_on_its_path_is_not_off_it() {
    let arm = arm(&[("a", "revolute", "0 0 1"), ("b", "prismatic", "1 0 0")], 1.0);
    let late = |t: f64| moves(t - 0.3);
    // 2 mm farther out than planned all the time, whatever the angle; behind by 30 mrad while it moves.
    let tool = found(&arm, &[pair("a", TURNS, moves, late), pair("b", SLIDES, |_| 0.0, |_| 0.002)]);
    let path = tool.path_error.unwrap();
    assert!((path.rms - 0.002).abs() < 1e-6 && (path.peak - 0.002).abs() < 1e-5, "{path:?}");
    assert!(tool.worst.deviation.error_m > 0.029, "{:?}", tool.worst);
    assert!(path.rms < tool.mean_m && tool.mean_m < tool.rms_m, "{} {}", tool.mean_m, tool.rms_m);
}

#[test]
fn a_joint_that_slides_moves_the_tool_by_its_own_error_and_turns_it_not() {
    let arm = arm(&[("a", "prismatic", "0 0 2"), ("b", "prismatic", "0 1 0")], 1.0);
    // Behind by 3 mm along the way, and off it by 4 mm.
    let tool =
        found(&arm, &[pair("a", SLIDES, moves, |t| moves(t) - 0.003), pair("b", SLIDES, |_| 0.5, |_| 0.504)]);
    let worst = &tool.worst.deviation;
    assert!((worst.error_m - 0.005).abs() < 1e-12 && worst.orientation_rad == Some(0.0), "{worst:?}");
    let shares: Vec<f64> = worst.causes.iter().map(|cause| cause.share).collect();
    assert!((shares[0] - 0.36).abs() < 1e-9 && (shares[1] - 0.64).abs() < 1e-9, "{shares:?}");
    assert!(worst.nonlinear_share.abs() < 1e-9);
    let split = tool.split.unwrap();
    assert!(
        (split.rms_along_m - 0.003).abs() < 1e-9 && (split.rms_across_m - 0.004).abs() < 1e-9,
        "{split:?}"
    );
    // 2 s and 1 s of motion at 100 Hz, and what a plan without speeds is smoothed over.
    assert!((300..=312).contains(&split.samples), "{split:?}");
}

#[test]
fn rests_of_the_plan_tell_the_error_on_arrival_and_at_last() {
    let arm = arm(&[("a", "prismatic", "1 0 0")], 1.0);
    // 20 mm behind while moving; half of it is gone after 0.2 s of rest, 1 mm stays.
    let behind = |t: f64, stop_s: f64| 0.001 + 0.019 * 0.5_f64.powf((t - stop_s).max(0.0) / 0.2);
    let measured = move |t: f64| moves(t) - if t < 6.0 { behind(t, 4.0) } else { behind(t, 7.0) };
    let tool = found(&arm, &[pair("a", SLIDES, moves, measured)]);
    let [dwell, end] = &tool.rests[..] else { panic!("{:?}", tool.rests) };
    assert!((dwell.at_end, end.at_end) == (false, true));
    assert!((dwell.from_s - 4.0).abs() < 0.11 && (dwell.to_s - 6.0).abs() < 0.11, "{dwell:?}");
    assert!((0.014..=0.02).contains(&dwell.arrival_m), "{dwell:?}");
    for rest in [dwell, end] {
        assert!((rest.deviation.error_m - 0.001).abs() < 0.0002, "{rest:?}");
        assert!((45..=52).contains(&rest.samples), "the last half second: {rest:?}");
    }
    assert_eq!((tool.end(), tool.worst_dwell()), (Some(end), Some(dwell)));
}

#[test]
fn the_shares_of_the_joints_add_up_to_the_error_on_simulated_machines() {
    let job = task(1);
    let arm = Arm::sample().unwrap().chain;
    let known: Vec<(&str, JointKind)> = arm.joints().iter().map(|joint| (&*joint.name, TURNS)).collect();
    let arm = Kinematics::of(arm.clone(), "sample", &known).unwrap();
    for preset in ["default", "lag-limited", "soft"] {
        let measured = run(&Plant::preset(preset).unwrap(), &job.plan, &job, 1);
        let pairs: Vec<Pair> = job
            .plan
            .tracks
            .iter()
            .filter_map(|planned| align(planned, measured.track(planned.name())?))
            .collect();
        let tool = found(&arm, &pairs);
        let all = std::iter::once(&tool.worst.deviation).chain(tool.rests.iter().map(|rest| &rest.deviation));
        for deviation in all {
            let sum: f64 = deviation.causes.iter().map(|cause| cause.error_m).sum();
            assert!((sum - deviation.error_m).abs() <= 0.02 * deviation.error_m, "{preset}: {deviation:?}");
            let left = deviation.error_m * deviation.nonlinear_share;
            assert!((sum + left - deviation.error_m).abs() < 1e-12);
        }
        assert!(tool.worst.deviation.error_m > 0.01 && tool.end().is_some(), "{preset}");
    }
}

#[test]
fn joints_on_the_way_whose_position_is_not_known_are_named_from_base_to_tool() {
    let joints = [("a", "revolute", "0 0 1"), ("b", "prismatic", "1 0 0"), ("c", "revolute", "0 1 0")];
    let text = urdf(&joints, 1.0);
    let missing =
        |known: &[(&str, JointKind)], tool| match Kinematics::from_urdf(&text, "r.urdf", tool, known) {
            Err(ArmError::JointsMissing { joints, tool, .. }) => (joints.join(" "), tool),
            other => panic!("{other:?}"),
        };
    assert_eq!(missing(&[("b", SLIDES)], None), ("a c".to_owned(), "tool".to_owned()));
    // An angle is no position of a joint that slides.
    assert_eq!(missing(&[("a", TURNS), ("b", TURNS), ("c", TURNS)], None).0, "b");
    assert_eq!(missing(&[], Some("l1")), ("a".to_owned(), "l1".to_owned()));
    // Nearer to the base, less must be known.
    let near = Kinematics::from_urdf(&text, "r.urdf", Some("l2"), &[("a", TURNS), ("b", SLIDES)]).unwrap();
    assert_eq!((near.tool_name(), near.joints().count()), ("l2", 2));
}

proptest! {
    #[test]
    fn any_run_has_a_tool_or_none_but_never_a_panic(
        rows in prop::collection::vec((1e-4..0.3_f64, -4.0..4.0_f64, -4.0..4.0_f64, prop::bool::weighted(0.1)), 1..80),
        scale in prop_oneof![Just(1.0), Just(0.0), Just(1e-9), Just(1e5), Just(1e200)],
    ) {
        let mut pair = pair("a", TURNS, |_| 0.0, |_| 0.0);
        let mut now_s = 0.0;
        pair.t_s = rows.iter().map(|row| { now_s += row.0; now_s }).collect();
        pair.planned = rows.iter().map(|row| scale * row.1).collect();
        pair.measured = rows.iter().map(|row| scale * row.2).collect();
        let cuts: Vec<usize> = (1..rows.len()).filter(|i| rows[*i].3).collect();
        let ends = cuts.iter().copied().chain([rows.len()]);
        pair.segments = std::iter::once(0).chain(cuts.iter().copied()).zip(ends).map(|(a, b)| a..b).collect();
        let arm = arm(&[("a", "revolute", "0 0 1")], 1.0);
        if let Some((tool, path)) = tool_replay(&arm, std::slice::from_ref(&pair), &Rules::default()) {
            prop_assert!(tool.worst.deviation.error_m.is_finite() && tool.rms_m <= tool.worst.deviation.error_m * (1.0 + 1e-9));
            prop_assert_eq!(path.segments.iter().map(ExactSizeIterator::len).sum::<usize>(), tool.samples);
            prop_assert!(tool.rests.iter().all(|rest| rest.to_s > rest.from_s && rest.samples > 0));
        } else {
            prop_assert!(scale > 1e100);
        }
    }
}
