//! Plans of arms that the samples are not: without masses, with key points at the ends of ranges.

use std::{ops::ControlFlow, path::Path};

use hydrotrace::{
    moea::Budget,
    plan::{Limit, PlanEvaluation, Rule},
    remark::Code,
    spline::Quantity,
    task::Objective,
    units::DEGREE_RAD,
    workflow::plan::{Options, PlanFailure, PlanRequest, Planned, Shaping, TaskFiles, run},
};

/// Two joints; `inertial`: of each link.
fn arm(inertial: &str) -> String {
    let link = |name: &str| format!(r#"<link name="{name}">{inertial}</link>"#);
    let joint = |name: &str, from: &str, to: &str| {
        format!(
            r#"<joint name="{name}" type="continuous"><parent link="{from}"/><child link="{to}"/><origin xyz="0.5 0 0"/><axis xyz="0 1 0"/></joint>"#
        )
    };
    format!(
        r#"<robot name="r">{}{}{}{}{}</robot>"#,
        link("base"),
        link("l1"),
        link("l2"),
        joint("j1", "base", "l1"),
        joint("j2", "l1", "l2")
    )
}

/// A task of both joints through some angles of each, deg.
fn task(points: &[[f64; 2]], range_deg: [f64; 2]) -> String {
    let point = |[a, b]: &[f64; 2]| format!("[[point]]\nangles_deg = {{ j1 = {a:?}, j2 = {b:?} }}\n");
    let all = |value: &str| format!("{{ j1 = {value}, j2 = {value} }}");
    format!(
        "title = \"t\"\narm = \"r.urdf\"\njoints = [\"j1\", \"j2\"]\n{}[limits]\nrange_deg = {}\nspeed_deg_s = {}\n\
         acceleration_deg_s2 = {}\njerk_deg_s3 = {}\n",
        points.iter().map(point).collect::<String>(),
        all(&format!("{range_deg:?}")),
        all("30.0"),
        all("40.0"),
        all("80.0"),
    )
}

fn planned(urdf: String, task: String, shape: Shaping) -> Result<Planned, PlanFailure> {
    let request =
        PlanRequest::of(Path::new("t.toml"), TaskFiles { task, urdf: Some(urdf), hydraulics: None })?;
    let mut options = Options { rule: Some(Rule::Best(Objective::Duration)), shape, ..Options::default() };
    options.search.budget = Budget::Evaluations(2000);
    run(&request, &options, |_| ControlFlow::Continue(()))
}

fn duration_s(planned: &Planned) -> f64 {
    planned.chosen.objectives[Objective::Duration]
}

const POINTS: [[f64; 2]; 4] = [[0.0, 10.0], [40.0, -20.0], [15.0, 5.0], [50.0, 30.0]];

#[test]
fn an_arm_without_masses_is_planned_as_one_with_hardly_any() {
    let light = r#"<inertial><mass value="1e-6"/><inertia ixx="1e-9" iyy="1e-9" izz="1e-9" ixy="0" ixz="0" iyz="0"/></inertial>"#;
    for shape in [Shaping::Timing, Shaping::Free(None)] {
        let of = |inertial| planned(arm(inertial), task(&POINTS, [-90.0, 90.0]), shape).unwrap();
        let (none, some) = (of(""), of(light));
        assert!((duration_s(&none) / duration_s(&some) - 1.0).abs() < 2e-3, "{shape:?}");
        assert!(none.remarks.as_slice().iter().any(|remark| remark.code == Code::NoMass));
        // Slowing down alone lessens jerk by 1 - 1.01^-3.
        assert!(none.bought.iter().all(|(_, share)| *share > 0.029), "{:?}", none.bought);
        // Power is nothing in any plan; of a free shape it is not told.
        assert_eq!(none.bought.len(), usize::from(shape == Shaping::Timing));
    }
}

#[test]
fn at_a_key_point_at_the_end_of_a_range_the_arm_stops() {
    let points = [[0.0, 0.0], [45.0, 20.0], [10.0, -10.0]];
    let free = Shaping::Free(None);
    let found = planned(arm(""), task(&points, [-20.0, 45.0]), free).unwrap();
    assert!(found.remarks.as_slice().iter().any(|remark| remark.code == Code::RangeEnd));
    // Two moves from rest to rest: 2.75 and 2.44 s.
    assert!((5.19..5.6).contains(&duration_s(&found)), "{}", duration_s(&found));
    let wide = planned(arm(""), task(&points, [-20.0, 46.0]), free).unwrap();
    assert!(wide.remarks.as_slice().iter().all(|remark| remark.code != Code::RangeEnd));
}

/// Round a square that its range hardly leaves: a smooth curve swings beyond it.
#[test]
fn where_only_stops_keep_all_limits_that_is_said_and_where_they_are_slower_nothing_is() {
    let square = [[0.0, 0.0], [60.0, 0.0], [60.0, 60.0], [0.0, 60.0], [0.0, 0.0]];
    let PlanFailure::Infeasible { stopping_s, .. } =
        planned(arm(""), task(&square, [-0.3, 60.3]), Shaping::Timing).unwrap_err()
    else {
        panic!()
    };
    // Four moves from rest to rest.
    assert!(stopping_s.is_some_and(|s| (17.0..19.0).contains(&s)), "{stopping_s:?}");
    let found = planned(arm(""), task(&POINTS, [-170.0, 170.0]), Shaping::Timing).unwrap();
    assert!(found.remarks.as_slice().iter().all(|remark| remark.code != Code::StopsAreFaster));
}

/// As a URDF rounds half of a turn, and a task does not.
#[test]
fn a_key_point_beyond_the_end_of_a_range_by_rounding_is_at_it() {
    let points = [[0.0, 0.0], [45.000_03, 20.0], [10.0, -10.0]];
    let found = planned(arm(""), task(&points, [-20.0, 45.0]), Shaping::Timing).unwrap();
    assert!(found.remarks.as_slice().iter().any(|remark| remark.code == Code::RangeEnd));
    assert!(found.chosen.broken().is_empty());
    let points = [[0.0, 0.0], [45.002, 20.0]];
    let PlanFailure::Setup { source: error, .. } =
        planned(arm(""), task(&points, [-20.0, 45.0]), Shaping::Timing).unwrap_err()
    else {
        panic!()
    };
    let error = error.to_string();
    assert!(error.contains("45.00 deg: 3.491e-5 rad beyond it"), "{error}");
}

#[test]
fn a_free_shape_is_faster_whatever_the_ceiling_on_jerk() {
    let fastest = planned(arm(""), task(&POINTS, [-90.0, 90.0]), Shaping::Timing).unwrap();
    let jerk_deg_s3 = fastest.chosen.objectives[Objective::RmsJerk] / DEGREE_RAD;
    for share in [0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9] {
        let ceiling = format!("[objectives]\nmax_rms_jerk_deg_s3 = {:.1}\n", share * jerk_deg_s3);
        let task = task(&POINTS, [-90.0, 90.0]) + &ceiling;
        let found = planned(arm(""), task, Shaping::Free(None)).unwrap();
        assert!(found.shaped.is_some(), "{share}: {:?}", found.no_shape);
    }
}

/// The weight that a joint carries swings with its angle, and power with it.
#[test]
fn power_and_work_of_a_joint_that_turns_far_are_those_of_a_dense_look() {
    let inertial = r#"<inertial><origin xyz="0.7 0 0"/><mass value="5"/><inertia ixx="0" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>"#;
    for far_deg in [100.0, 500.0, 4000.0] {
        let points = [[0.0, 0.0], [0.0, far_deg], [0.0, 0.5 * far_deg]];
        let files =
            TaskFiles { task: task(&points, [-9000.0, 9000.0]), urdf: Some(arm(inertial)), hydraulics: None };
        let setup = PlanRequest::of(Path::new("t.toml"), files).unwrap().setup;
        let times_s = [0.0, 8.0, 14.0];
        let (found, motion) =
            (PlanEvaluation::of(&setup, &times_s).unwrap(), setup.motion(&times_s).unwrap());
        let count = 100_000_u32;
        let (mut square, mut work_j) = (0.0, 0.0);
        for k in 0..count {
            let at = motion.at(14.0 * (f64::from(k) + 0.5) / f64::from(count));
            let of = |quantity| at.of(quantity, 1)[0];
            let weight_n_m = 5.0 * 9.81 * 0.7 * of(Quantity::Position).cos();
            let torque_n_m = (0.1 + 5.0 * 0.49) * of(Quantity::Acceleration) - weight_n_m;
            let power_w = torque_n_m * of(Quantity::Velocity);
            square += power_w * power_w / f64::from(count);
            work_j += power_w.abs() * 14.0 / f64::from(count);
        }
        let off = found.rms_power_w[1] / square.sqrt() - 1.0;
        assert!(off.abs() < 1e-4, "{far_deg}: {off}");
        let off = found.energy_j / work_j - 1.0;
        assert!(off.abs() < 1e-3, "{far_deg}: {off}");
    }
}

#[test]
fn a_range_with_one_end_is_kept_as_one_with_two() {
    let points = [[0.0, 0.0], [45.0, 20.0], [44.0, -10.0], [0.0, 0.0]];
    for shape in [Shaping::Timing, Shaping::Free(None)] {
        let of = |range_deg| planned(arm(""), task(&points, range_deg), shape).unwrap();
        let (one, two) = (of([f64::NEG_INFINITY, 45.5]), of([-180.0, 45.5]));
        let highest = |planned: &Planned| {
            let of_j1 = |margin: &&hydrotrace::plan::Margin| {
                margin.limit == Limit::Position && margin.joint == Some(0)
            };
            *planned.chosen.margins.iter().find(of_j1).unwrap()
        };
        let margin = highest(&one);
        assert!(margin.value <= 45.5 * DEGREE_RAD * (1.0 + 1e-9) && margin.allowed > 0.7, "{margin:?}");
        let slower = duration_s(&one) / duration_s(&two);
        assert!((0.97..1.03).contains(&slower), "{shape:?}: {slower}");
    }
}

/// The fastest plan is stretched as little as keeps its limits, and what a descent mends at last is a plan.
#[test]
fn between_two_walls_there_is_a_plan_and_none_of_the_same_course_is_faster() {
    let points = [
        [0.0, 0.0],
        [39.95, 0.0],
        [39.0, 20.0],
        [39.95, 40.0],
        [39.5, 0.0],
        [-39.9, 0.0],
        [-39.5, 10.0],
        [0.0, 0.0],
    ];
    let text = task(&points, [-40.0, 40.0]).replace("j2 = [-40.0, 40.0]", "j2 = [-900.0, 900.0]");
    let text = text.replace("30.0", "60.0").replace("80.0", "500.0");
    let text = text.replace("j1 = 40.0, j2 = 40.0", "j1 = 100.0, j2 = 100.0");
    let found = planned(arm(""), text.clone(), Shaping::Timing).unwrap();
    let files = TaskFiles { task: text, urdf: Some(arm("")), hydraulics: None };
    let setup = PlanRequest::of(Path::new("t.toml"), files).unwrap().setup;
    let broken = |by: f64| {
        let times_s: Vec<f64> = found.chosen.times_s.iter().map(|t| by * t).collect();
        !PlanEvaluation::of(&setup, &times_s).unwrap().broken().is_empty()
    };
    assert!(!broken(1.0) && broken(0.999));
    let fastest =
        found.front.iter().map(|plan| plan.objectives[Objective::Duration]).fold(f64::MAX, f64::min);
    assert!(fastest < 1.02 * duration_s(&found), "{fastest} s and {} s", duration_s(&found));
}

#[test]
fn a_motion_that_starts_at_the_end_of_a_range_is_as_fast_as_one_that_starts_within() {
    let points = [[0.0, 0.0], [44.8, 44.8], [44.9, 44.9], [0.0, 0.0]];
    let of = |low| {
        let found = planned(arm(""), task(&points, [low, 45.0]), Shaping::Free(None)).unwrap();
        duration_s(&found)
    };
    let (at, within) = (of(0.0), of(-0.01));
    assert!(at < 1.02 * within, "{at} s and {within} s");
}

/// Where it stays, rounding brings it beyond the end or not.
#[test]
fn a_joint_that_rests_at_the_end_of_its_range_holds_nothing_up() {
    let of = |end: f64| {
        let points = [[0.0, end], [100.0, end], [50.0, end]];
        planned(arm(""), task(&points, [-170.0, 170.0]), Shaping::Timing).unwrap()
    };
    let (at, within) = (of(-170.0), of(-169.0));
    assert!((duration_s(&at) / duration_s(&within) - 1.0).abs() < 1e-3, "{} s", duration_s(&at));
    let slowest_s = |found: &Planned| found.front.last().unwrap().objectives[Objective::Duration];
    assert!((slowest_s(&at) - slowest_s(&within)).abs() < 1e-3, "{} s", slowest_s(&at));
}

#[test]
fn intervals_are_as_long_as_the_task_has_them() {
    let points = [[0.0, 0.0], [100.0, 170.0], [50.0, 170.0]];
    let found = planned(arm(""), task(&points, [-170.0, 170.0]), Shaping::Timing).unwrap();
    let all = found.front.iter().flat_map(|timing| &timing.interval_s);
    let [least_s, most_s] = all.fold([f64::MAX, 0.0], |[a, b], s| [s.min(a), s.max(b)]);
    assert!(least_s >= 0.3 && most_s <= 20.0, "{least_s} to {most_s} s");
}

#[test]
fn a_free_shape_keeps_limits_that_no_times_alone_keep() {
    let square = [[0.0, 0.0], [60.0, 0.0], [60.0, 60.0], [0.0, 60.0], [0.0, 0.0]];
    let found = planned(arm(""), task(&square, [-0.3, 60.3]), Shaping::Free(None)).unwrap();
    assert!(found.front.is_empty() && found.chosen.broken().is_empty());
    assert!(found.shaped.is_some_and(|shaped| shaped.timing.is_none()));
    // As it is, stopping at every key point.
    assert!(found.chosen.objectives[Objective::Duration] < 17.0, "{:?}", found.chosen.objectives);
}

/// A load that is nearly one at rest: some more time makes it one that may be.
#[test]
fn where_longer_intervals_keep_a_load_that_is_said() {
    let heavy = r#"<inertial><mass value="1"/><inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial>"#;
    let within = |longest_s: f64| {
        let task = task(&[[-10.0, 0.0], [10.0, 0.0]], [-90.0, 90.0]);
        let task = task.replace("joints", &format!("interval_s = [0.3, {longest_s:?}]\njoints"));
        planned(arm(heavy), task + "torque_n_m = { j1 = 4.906 }\n", Shaping::Timing)
    };
    let PlanFailure::Infeasible { longest_s: Some(longest_s), .. } = within(5.0).unwrap_err() else {
        panic!()
    };
    assert!((5.0..50.0).contains(&longest_s), "{longest_s} s");
    assert!(within(longest_s.ceil()).is_ok());
}

#[test]
fn a_rod_speed_of_a_joint_without_a_cylinder_is_an_error() {
    let task = task(&POINTS, [-90.0, 90.0]) + "rod_speed_m_s = { j2 = 0.1 }\n";
    let PlanFailure::Setup { source: error, .. } = planned(arm(""), task, Shaping::Timing).unwrap_err()
    else {
        panic!()
    };
    assert!(error.to_string().contains("rod speed of j2 to 0.1 m/s, and no cylinder of j2"), "{error}");
}
