//! Splines agree with SciPy: `tests/reference/spline-golden.json`, written by
//! `tests/reference/generate_spline.py`, which solves the whole system densely.

use std::collections::BTreeMap;

use hydrotrace::{
    spline::{Degree, Dwell, Ends, KeyPoints, Motion, Quantity, Spline},
    units::radians_from_degrees,
};
use serde::Deserialize;

/// Degrees and seconds.
#[derive(Deserialize)]
struct Plan {
    segments: Vec<Segment>,
    dwell: f64,
    f1: f64,
    f2_rad_s3: f64,
}

#[derive(Deserialize)]
struct Segment {
    t: Vec<f64>,
    q: Vec<Vec<f64>>,
    knots: Vec<f64>,
    control: Vec<Vec<f64>>,
    rms_jerk_per_joint_deg: Vec<f64>,
    sample_t: Vec<f64>,
    pos: Vec<Vec<f64>>,
    vel: Vec<Vec<f64>>,
    acc: Vec<Vec<f64>>,
    jerk: Vec<Vec<f64>>,
}

fn plans() -> BTreeMap<String, Plan> {
    serde_json::from_str(include_str!("../../reference/spline-golden.json")).unwrap()
}

/// Solving densely in degrees leaves SciPy a few 1e-12; the issue asks for 1e-10.
#[track_caller]
fn agree(what: &str, got: f64, want: f64) {
    assert!((got - want).abs() < 1e-10, "{what}: got {got}, want {want}, off by {:e}", got - want);
}

fn key_points<'a>(rows: impl Iterator<Item = &'a Vec<f64>>) -> KeyPoints {
    KeyPoints::new(6, rows.flatten().map(|deg| radians_from_degrees(*deg)).collect()).unwrap()
}

#[test]
fn knots_controls_states_and_jerk_agree_with_scipy_to_1e_10() {
    for (name, plan) in plans() {
        for segment in &plan.segments {
            let points = key_points(segment.q.iter());
            let spline = Spline::new(Degree::Sextic, points, &Ends::at_rest(6), &segment.t).unwrap();
            assert_eq!(spline.knots_s().len(), segment.knots.len());
            for (got, want) in spline.knots_s().iter().zip(&segment.knots) {
                agree(&name, *got, *want);
            }
            let mut rms = [0.0; 6];
            spline.rms_jerk(&mut rms);
            for joint in 0..6 {
                let control = spline.control(joint, Quantity::Position);
                assert_eq!(control.len(), segment.control.len());
                for (got, want) in control.iter().zip(&segment.control) {
                    agree(&name, *got, radians_from_degrees(want[joint]));
                }
                agree(&name, rms[joint], radians_from_degrees(segment.rms_jerk_per_joint_deg[joint]));
                for (i, t) in segment.sample_t.iter().enumerate() {
                    let state = spline.at(*t);
                    let tables = [&segment.pos, &segment.vel, &segment.acc, &segment.jerk];
                    for (quantity, table) in Quantity::ALL.into_iter().zip(tables) {
                        let want = radians_from_degrees(table[i][joint]);
                        agree(&format!("{name} {quantity:?}"), state.of(quantity, joint)[0], want);
                    }
                }
            }
        }
    }
}

#[test]
fn whole_motions_with_their_dwells_agree_in_duration_and_f2() {
    for (name, plan) in plans() {
        let (mut t_s, mut rows, mut dwells) = (Vec::new(), Vec::new(), Vec::new());
        for (i, segment) in plan.segments.iter().enumerate() {
            // The last point of one segment is the first of the next.
            let skip = usize::from(i > 0);
            let departure = t_s.last().map_or(0.0, |arrival| arrival + plan.dwell);
            if i > 0 {
                dwells.push(Dwell { point: t_s.len() - 1, length_s: plan.dwell });
            }
            t_s.extend(segment.t[skip..].iter().map(|t| t + departure));
            rows.extend(&segment.q[skip..]);
        }
        let points = key_points(rows.into_iter());
        let motion = Motion::new(Degree::Sextic, points, &Ends::at_rest(6), &dwells, &t_s).unwrap();
        let mut rms = [0.0; 6];
        motion.rms_jerk(&mut rms);
        agree(&name, motion.duration_s(), plan.f1);
        agree(&name, rms.iter().sum(), plan.f2_rad_s3);
    }
}

#[test]
fn plan_c_swings_joint_3_to_the_documented_125_6_degrees() {
    let plan = plans().remove("sim_C").unwrap();
    let segment = &plan.segments[0];
    let spline =
        Spline::new(Degree::Sextic, key_points(segment.q.iter()), &Ends::at_rest(6), &segment.t).unwrap();
    let least = spline.extrema(2, Quantity::Position).least;
    let worst = (0..6).map(|i| spline.overshoot(2, i)).min_by(|a, b| a.beyond_rad.total_cmp(&b.beyond_rad));
    assert!((least.value - radians_from_degrees(-125.6)).abs() < radians_from_degrees(0.05), "{least:?}");
    let at = worst.unwrap().at;
    assert!((at.value - least.value).abs() < 1e-14 && (at.t_s - least.t_s).abs() < 1e-9, "{at:?}");
}
