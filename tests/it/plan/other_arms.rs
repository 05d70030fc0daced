//! Plans of arms that the samples are not: without masses, with key points at the ends of ranges.

use std::{ops::ControlFlow, path::Path};

use hydrotrace::{
    moea::Budget,
    plan::Rule,
    remark::Code,
    task::Objective,
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
        assert_eq!(none.bought.len(), 1, "power is nothing in any plan");
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
