//! Laws of splines and motions that hold for every input.

use hydrotrace::spline::{
    Degree, Dwell, Ends, Gauss, KeyPoints, Motion, Quantity, Samples, Spline, SplineError,
};
use proptest::prelude::*;

const JOINTS: usize = 2;
const DEGREES: [Degree; 3] = [Degree::Quintic, Degree::Sextic, Degree::Septic];

#[derive(Debug, Clone)]
struct Case {
    degree: Degree,
    t_s: Vec<f64>,
    points: KeyPoints,
    ends: Ends,
}

impl Case {
    fn spline(&self) -> Spline {
        Spline::new(self.degree, self.points.clone(), &self.ends, &self.t_s).unwrap()
    }

    fn last(&self) -> usize {
        self.t_s.len() - 1
    }
}

fn times(steps: &[f64]) -> Vec<f64> {
    let step = |now: &mut f64, step: &f64| {
        *now += step;
        Some(*now)
    };
    std::iter::once(0.0).chain(steps.iter().scan(0.0, step)).collect()
}

/// Two to nine key points, intervals of the task's range, moving or resting ends.
fn any_case() -> impl Strategy<Value = Case> {
    let degree = prop::sample::select(&DEGREES);
    let steps = prop::collection::vec(0.3..5.0_f64, 1..9);
    (degree, steps, any::<bool>()).prop_flat_map(|(degree, steps, moving)| {
        let rows = prop::collection::vec(-3.0..3.0_f64, (steps.len() + 1) * JOINTS);
        let size = if moving { 1.0 } else { 0.0 };
        (rows, prop::collection::vec(-1.0..1.0_f64, 6 * JOINTS)).prop_map(move |(rows, ends)| {
            let ends: Vec<Vec<f64>> =
                ends.chunks(JOINTS).map(|two| two.iter().map(|v| v * size).collect()).collect();
            Case {
                degree,
                t_s: times(&steps),
                points: KeyPoints::new(JOINTS, rows).unwrap(),
                ends: Ends {
                    start_velocity_rad_s: ends[0].clone(),
                    start_acceleration_rad_s2: ends[1].clone(),
                    start_jerk_rad_s3: ends[2].clone(),
                    end_velocity_rad_s: ends[3].clone(),
                    end_acceleration_rad_s2: ends[4].clone(),
                    end_jerk_rad_s3: ends[5].clone(),
                },
            }
        })
    })
}

/// Largest magnitude of a quantity's control points: the scale of its rounding.
fn size(spline: &Spline, joint: usize, quantity: Quantity) -> f64 {
    let (least, most) = spline.hull(joint, quantity);
    least.abs().max(most.abs()).max(1e-3)
}

proptest! {
    #[test]
    fn every_key_point_is_met_and_the_ends_hold(case in any_case()) {
        let spline = case.spline();
        let held = if case.degree == Degree::Quintic { 3 } else { 4 };
        for joint in 0..JOINTS {
            for (i, t) in case.t_s.iter().enumerate() {
                let got = spline.at(*t).of(Quantity::Position, joint)[0];
                let want = case.points.of(i)[joint];
                prop_assert!((got - want).abs() < 1e-12 * size(&spline, joint, Quantity::Position).max(1.0));
            }
            let e = &case.ends;
            let start = [case.points.of(0)[joint], e.start_velocity_rad_s[joint],
                e.start_acceleration_rad_s2[joint], e.start_jerk_rad_s3[joint]];
            let end = [case.points.of(case.last())[joint], e.end_velocity_rad_s[joint],
                e.end_acceleration_rad_s2[joint], e.end_jerk_rad_s3[joint]];
            for (t_s, want) in [(spline.span_s().0, start), (spline.span_s().1, end)] {
                for (quantity, want) in Quantity::ALL.into_iter().zip(want).take(held) {
                    let got = spline.at(t_s).of(quantity, joint)[0];
                    prop_assert!((got - want).abs() < 1e-11 * size(&spline, joint, quantity).max(1.0),
                        "{quantity:?} {got} {want}");
                }
            }
        }
    }

    #[test]
    fn each_derivative_is_the_slope_of_the_quantity_below(case in any_case(), share in 0.01..0.99_f64) {
        let spline = case.spline();
        let t_s = share * spline.duration_s();
        let h = 1e-5;
        let (before, here, after) = (spline.at(t_s - h), spline.at(t_s), spline.at(t_s + h));
        for joint in 0..JOINTS {
            for pair in Quantity::ALL.windows(2) {
                let slope = (after.of(pair[0], joint)[0] - before.of(pair[0], joint)[0]) / (2.0 * h);
                let got = here.of(pair[1], joint)[0];
                // The quintic's jerk bends at knots: first order in h there.
                let scale = Quantity::ALL.into_iter().map(|q| size(&spline, joint, q)).fold(1.0, f64::max);
                prop_assert!((slope - got).abs() < 1e-3 * scale, "{pair:?} {slope} {got}");
            }
        }
    }

    #[test]
    fn extrema_bound_every_sample_are_attained_and_lie_in_the_hull(
        case in any_case(), part in (0.0..1.0_f64, 0.0..1.0_f64),
    ) {
        let spline = case.spline();
        let within = (part.0 * spline.duration_s(), part.1 * spline.duration_s());
        let t_s: Vec<f64> =
            (0..=400).map(|k| within.0 + (within.1 - within.0) * f64::from(k) / 400.0).collect();
        let mut samples = Samples::default();
        spline.sample(&t_s, Quantity::Jerk, &mut samples);
        for joint in 0..JOINTS {
            for quantity in Quantity::ALL {
                let tiny = 1e-12 * size(&spline, joint, quantity);
                let extrema = spline.extrema_within(joint, quantity, within);
                let whole = spline.extrema(joint, quantity);
                for value in samples.of(quantity, joint) {
                    prop_assert!(*value <= extrema.greatest.value + tiny, "{quantity:?} {value} {extrema:?}");
                    prop_assert!(*value >= extrema.least.value - tiny, "{quantity:?} {value} {extrema:?}");
                }
                for found in [extrema.least, extrema.greatest, whole.least, whole.greatest] {
                    let there = spline.at(found.t_s).of(quantity, joint)[0];
                    // Jerk of a quintic bends, and of any degree slopes, at the stated instant.
                    prop_assert!((there - found.value).abs() < 1e3 * tiny, "{quantity:?} {there} {found:?}");
                }
                let hull = spline.hull(joint, quantity);
                prop_assert!(hull.0 <= whole.least.value + tiny && whole.greatest.value <= hull.1 + tiny);
                prop_assert!(whole.least.value <= extrema.least.value + tiny);
                prop_assert!(whole.greatest.value >= extrema.greatest.value - tiny);
            }
        }
    }

    #[test]
    fn stretching_time_moves_no_control_point(mut case in any_case(), stretch in 0.1..50.0_f64) {
        case.ends = Ends::at_rest(JOINTS);
        let spline = case.spline();
        let mut slow = spline.clone();
        let t_s: Vec<f64> = case.t_s.iter().map(|t| t * stretch).collect();
        slow.retime(&t_s).unwrap();
        let (mut fast_rms, mut slow_rms) = ([0.0; JOINTS], [0.0; JOINTS]);
        spline.rms_jerk(&mut fast_rms);
        slow.rms_jerk(&mut slow_rms);
        for joint in 0..JOINTS {
            let [a, b] = [&spline, &slow].map(|s| s.control(joint, Quantity::Position));
            let tiny = 1e-11 * size(&spline, joint, Quantity::Position);
            prop_assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < tiny));
            prop_assert!((slow_rms[joint] * stretch.powi(3) - fast_rms[joint]).abs() < 1e-9 * fast_rms[joint]);
        }
    }

    #[test]
    fn the_time_reversed_task_gives_the_time_reversed_curve(case in any_case(), share in 0.0..1.0_f64) {
        let spline = case.spline();
        let total = spline.duration_s();
        let rows = (0..=case.last()).rev().flat_map(|i| case.points.of(i).to_vec()).collect();
        let negated = |v: &[f64]| v.iter().map(|x| -x).collect::<Vec<f64>>();
        let e = &case.ends;
        let ends = Ends {
            start_velocity_rad_s: negated(&e.end_velocity_rad_s),
            start_acceleration_rad_s2: e.end_acceleration_rad_s2.clone(),
            start_jerk_rad_s3: negated(&e.end_jerk_rad_s3),
            end_velocity_rad_s: negated(&e.start_velocity_rad_s),
            end_acceleration_rad_s2: e.start_acceleration_rad_s2.clone(),
            end_jerk_rad_s3: negated(&e.start_jerk_rad_s3),
        };
        let t_s: Vec<f64> = case.t_s.iter().rev().map(|t| total - t).collect();
        let back = Spline::new(case.degree, KeyPoints::new(JOINTS, rows).unwrap(), &ends, &t_s).unwrap();
        let (a, b) = (spline.at(share * total), back.at(total - share * total));
        for joint in 0..JOINTS {
            for (quantity, sign) in Quantity::ALL.into_iter().zip([1.0, -1.0, 1.0, -1.0]) {
                let off = a.of(quantity, joint)[0] - sign * b.of(quantity, joint)[0];
                prop_assert!(off.abs() < 1e-10 * size(&spline, joint, quantity).max(1.0), "{quantity:?} {off:e}");
            }
        }
    }

    #[test]
    fn jerk_squared_by_eight_nodes_is_the_exact_integral(case in any_case()) {
        let spline = case.spline();
        let (mut nodes, mut weights, mut samples) = (Vec::new(), Vec::new(), Samples::default());
        spline.quadrature(Gauss::Eight, 1, &mut nodes, &mut weights);
        spline.sample(&nodes, Quantity::Jerk, &mut samples);
        let mut exact = [0.0; JOINTS];
        spline.add_squared_jerk(&mut exact);
        prop_assert!((weights.iter().sum::<f64>() - spline.duration_s()).abs() < 1e-12 * spline.duration_s());
        for (joint, exact) in exact.into_iter().enumerate() {
            let jerk = samples.of(Quantity::Jerk, joint);
            let sum: f64 = jerk.iter().zip(&weights).map(|(j, w)| w * j * j).sum();
            prop_assert!((sum - exact).abs() <= 1e-12 * exact, "{sum} {exact}");
        }
    }

    #[test]
    fn order_and_company_of_instants_change_no_sample(
        case in any_case(), shares in prop::collection::vec(-0.1..1.1_f64, 1..40),
    ) {
        let spline = case.spline();
        let t_s: Vec<f64> = shares.iter().map(|share| share * spline.duration_s()).collect();
        let mut samples = Samples::default();
        spline.sample(&t_s, Quantity::Jerk, &mut samples);
        for (i, t) in t_s.iter().enumerate() {
            let alone = spline.at(*t);
            for quantity in Quantity::ALL {
                prop_assert_eq!(samples.of(quantity, 1)[i], alone.of(quantity, 1)[0]);
            }
        }
    }

    #[test]
    fn new_times_give_what_a_new_spline_gives_and_bad_ones_change_nothing(
        case in any_case(), stretch in 0.5..2.0_f64,
    ) {
        let mut spline = case.spline();
        let fresh = spline.clone();
        let t_s: Vec<f64> = case.t_s.iter().map(|t| t * t * 0.1 + t * stretch).collect();
        spline.retime(&t_s).unwrap();
        let other = Case { t_s, ..case.clone() }.spline();
        for quantity in Quantity::ALL {
            prop_assert_eq!(spline.control(1, quantity), other.control(1, quantity));
        }
        spline.retime(&case.t_s).unwrap();
        let mut wrong = case.t_s.clone();
        wrong[case.last()] = wrong[case.last() - 1];
        prop_assert!(spline.retime(&wrong).is_err());
        prop_assert_eq!(spline.control(0, Quantity::Jerk), fresh.control(0, Quantity::Jerk));
        prop_assert_eq!(spline.t_s(), fresh.t_s());
    }

    #[test]
    fn wild_input_is_refused_or_gives_finite_numbers(
        steps in prop::collection::vec((-7.0..9.0_f64).prop_map(|e| 10.0_f64.powf(e)), 1..12),
        scale in prop::sample::select(vec![0.0, 1e-300, 1.0, 1e12]),
        degree in prop::sample::select(&DEGREES),
    ) {
        let rows = (0..=steps.len()).map(|i| if i % 2 == 0 { scale } else { -scale }).collect();
        let points = KeyPoints::new(1, rows).unwrap();
        match Spline::new(degree, points, &Ends::at_rest(1), &times(&steps)) {
            Err(SplineError::NotIncreasing { .. } | SplineError::IllConditioned { .. }) => {}
            Err(other) => prop_assert!(false, "{other}"),
            Ok(spline) => {
                let mut rms = [0.0];
                spline.rms_jerk(&mut rms);
                prop_assert!(rms[0].is_finite());
                for (i, t) in spline.t_s().iter().enumerate() {
                    let off = spline.at(*t).of(Quantity::Position, 0)[0] - spline.points().of(i)[0];
                    prop_assert!(off.abs() <= 1e-6 * scale, "missed by {off:e} of {scale:e}");
                }
                for quantity in Quantity::ALL {
                    let extrema = spline.extrema(0, quantity);
                    prop_assert!(extrema.least.value <= extrema.greatest.value);
                    prop_assert!(extrema.least.value.is_finite() && extrema.greatest.value.is_finite());
                }
            }
        }
    }

    #[test]
    fn a_motion_stands_still_in_its_dwells_and_moves_as_its_segments(
        case in any_case(), at in any::<prop::sample::Index>(), length_s in 0.0..3.0_f64, share in 0.0..1.0_f64,
    ) {
        let point = at.index(case.t_s.len());
        let dwell = Dwell { point, length_s };
        let t_s: Vec<f64> =
            case.t_s.iter().enumerate().map(|(i, t)| if i > point { t + length_s } else { *t }).collect();
        let rest = Ends::at_rest(JOINTS);
        let motion = Motion::new(case.degree, case.points.clone(), &rest, &[dwell], &t_s).unwrap();
        let total = case.t_s[case.last()] + length_s;
        let slow: Vec<f64> = t_s.iter().map(|t| 2.0 * t).collect();
        let mut retimed = Motion::new(case.degree, case.points.clone(), &rest, &[dwell], &slow).unwrap();
        retimed.retime(&t_s).unwrap();
        prop_assert!(retimed.retime(&vec![1.0; t_s.len()]).is_err());
        prop_assert_eq!(retimed.at(share * total), motion.at(share * total));
        prop_assert!((motion.duration_s() - total).abs() < 1e-12 * total);
        let resting = motion.at(t_s[point] + share * length_s);
        for joint in 0..JOINTS {
            prop_assert_eq!(resting.of(Quantity::Position, joint)[0], case.points.of(point)[joint]);
            for quantity in &Quantity::ALL[1..] {
                prop_assert_eq!(resting.of(*quantity, joint)[0], 0.0);
            }
        }
        for (i, t) in t_s.iter().enumerate() {
            let off = motion.at(*t).of(Quantity::Position, 0)[0] - case.points.of(i)[0];
            prop_assert!(off.abs() < 1e-9, "{off:e}");
        }
        let all: Vec<f64> = (0..=60).map(|k| total * f64::from(k) / 60.0).collect();
        let mut samples = Samples::default();
        motion.sample(&all, Quantity::Jerk, &mut samples);
        for quantity in Quantity::ALL {
            let extrema = motion.extrema(1, quantity);
            for (i, t) in all.iter().enumerate() {
                let value = samples.of(quantity, 1)[i];
                prop_assert_eq!(value, motion.at(*t).of(quantity, 1)[0]);
                let tiny = 1e-11 * extrema.peak().value.abs().max(1.0);
                prop_assert!(extrema.least.value - tiny <= value && value <= extrema.greatest.value + tiny);
            }
        }
    }
}

fn hop(degree: Degree, points: usize, at: usize) -> Spline {
    let rows = (0..points).map(|i| if i == at { 1.0 } else { 0.0 }).collect();
    let t_s: Vec<f64> = (0..u32::try_from(points).unwrap()).map(f64::from).collect();
    Spline::new(degree, KeyPoints::new(1, rows).unwrap(), &Ends::at_rest(1), &t_s).unwrap()
}

#[test]
fn a_disturbance_dies_out_by_about_half_an_interval() {
    // Equal intervals: spectral radii near 0.431, 0.488 and 0.535.
    for (degree, most) in DEGREES.into_iter().zip([0.44, 0.5, 0.55]) {
        let spline = hop(degree, 31, 15);
        let swing = |i: usize| {
            let within = (spline.t_s()[i], spline.t_s()[i + 1]);
            spline.extrema_within(0, Quantity::Position, within).peak().value.abs()
        };
        for i in 16..28 {
            assert!(swing(i + 1) < most * swing(i), "{degree:?} {i}: {} {}", swing(i), swing(i + 1));
        }
    }
}

#[test]
fn a_rest_between_equal_key_points_would_drift_without_a_dwell() {
    let rows = vec![0.0, 0.5, 0.5, 1.5];
    let points = KeyPoints::new(1, rows).unwrap();
    let spline = Spline::new(Degree::Sextic, points, &Ends::at_rest(1), &[0.0, 5.0, 7.0, 12.0]).unwrap();
    assert!(spline.overshoot(0, 1).beyond_rad.abs() > 1e-3);
}

#[test]
fn overshoot_is_signed_and_zero_where_there_is_none() {
    let spline = hop(Degree::Sextic, 5, 2);
    let down = spline.overshoot(0, 0);
    assert!(down.beyond_rad < -0.05 && (down.at.value - down.beyond_rad).abs() < 1e-15, "{down:?}");
    assert!(hop(Degree::Sextic, 2, 1).overshoot(0, 0).beyond_rad == 0.0);
}

#[test]
fn errors_name_the_place_in_the_whole_motion() {
    let points = || KeyPoints::new(1, vec![0.0, 1.0, 2.0, 3.0]).unwrap();
    let rest = Ends::at_rest(1);
    let make = |dwells: &[Dwell], t_s: &[f64]| {
        Motion::new(Degree::Sextic, points(), &rest, dwells, t_s).unwrap_err().to_string()
    };
    let dwell = Dwell { point: 2, length_s: 2.0 };
    assert_eq!(
        make(&[dwell], &[0.0, 1.0, 2.0, 3.5]),
        "no time to move to key point 4: leaving at 4 s, arriving at 3.5 s"
    );
    assert_eq!(make(&[], &[0.0, 1.0, 2.0]), "3 values of time, 4 expected");
    assert_eq!(make(&[], &[0.0, f64::NAN, 2.0, 3.0]), "time 1 is not a number below 1e12 in magnitude: NaN");
    assert_eq!(
        make(&[dwell, dwell], &[0.0, 1.0, 2.0, 5.0]),
        "dwell 2 is at key point 3: dwells ascend and lie within the 4 key points"
    );
    assert_eq!(KeyPoints::new(1, vec![0.0]).unwrap_err(), SplineError::TooFewPoints { points: 1 });
    assert_eq!(KeyPoints::new(0, vec![]).unwrap_err(), SplineError::NoJoints);
}
