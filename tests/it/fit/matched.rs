//! Fits to responses of the model itself: what is lost is lost by the estimator.

use hydrotrace::{
    fit::{Excitation, Fit, FitError, JointRoom, Learning, Model, Step, Trial, excite, learn, predict},
    rng::{Stream, stream},
    series::{Series, Track, split_at_gaps},
    units::DEGREE_RAD,
};
use rand_distr::{Distribution, StandardNormal};

use crate::support::machine::fitted;

pub(super) const MODEL: Model = Model {
    dead_time_s: 0.22,
    time_constant_s: 0.06,
    position_gain_1_s: 1.8,
    integral_gain_1_s2: 0.5,
    feed_forward: 0.85,
    asymmetry: 0.2,
    dead_band_rad_s: 0.015,
    dead_band_centre_rad_s: 0.0,
    stiction_rad_s: 0.1 * DEGREE_RAD,
    offset_rad: 0.0,
    pose_rad: [0.8, 1.2],
    pose_slope_1_rad: 0.2,
    pose_asymmetry_1_rad: 0.0,
    pose_curve_1_rad2: 0.0,
    speed_limit_rad_s: [Some(0.35), Some(0.28)],
    acceleration_limit_rad_s2: [None, None],
    hysteresis_rad_s: 0.1 * DEGREE_RAD,
    edge_rad_s: 0.0,
    set_value_filter_s: 0.0,
    set_value_delay_s: 0.0,
    opens_beyond: 0.0,
    integral_limit_rad_s: None,
    natural_frequency_rad_s: 0.0,
    damping_ratio: 0.0,
    backlash_rad: 0.05 * DEGREE_RAD,
};

/// The same with a valve that is quick.
pub(super) const QUICK: Model = Model { dead_time_s: 0.06, time_constant_s: 0.05, ..MODEL };

pub(super) fn trial(joints: &[&str]) -> Series {
    let joint = |name: &&str| JointRoom::turning(*name, 1.0, [0.5, 1.5]);
    excite(&joints.iter().map(joint).collect::<Vec<_>>(), &Excitation::minimal()).unwrap()
}

/// The model's answer with an encoder's noise, without the samples for which `lost` holds.
fn measured(plan: &Series, seed: u64, lost: impl Fn(f64) -> bool) -> Series {
    measured_of(&MODEL, plan, seed, lost)
}

pub(super) fn measured_of(model: &Model, plan: &Series, seed: u64, lost: impl Fn(f64) -> bool) -> Series {
    let mut rng = stream(seed, Stream::SensorNoise);
    let track = |sent: &Track| {
        let exact = predict(model, sent).unwrap();
        let noisy: Vec<(f64, f64)> = exact
            .t_s()
            .iter()
            .zip(exact.position())
            .filter(|(t_s, _)| !lost(**t_s))
            .map(|(t_s, angle_rad)| {
                let noise: f64 = StandardNormal.sample(&mut rng);
                (*t_s, angle_rad + 0.01 * DEGREE_RAD * noise)
            })
            .collect();
        let (t_s, position_rad): (Vec<f64>, Vec<f64>) = noisy.into_iter().unzip();
        let cuts = split_at_gaps(&t_s);
        Track::new(sent.name(), t_s, position_rad, &cuts).unwrap()
    };
    Series { tracks: plan.tracks.iter().map(track).collect() }
}

/// Largest relative error of what a trial should show.
fn worst(fit: &Fit) -> f64 {
    let joint = &fit.joints[0];
    let pairs = [
        (joint.lag_s.value.unwrap(), MODEL.lag_s()),
        (joint.model.position_gain_1_s, MODEL.position_gain_1_s),
        (joint.model.feed_forward, MODEL.feed_forward),
        (joint.gain_ratio.value.unwrap(), MODEL.asymmetry.exp()),
        (
            joint.dead_band_rad_s.value.unwrap(),
            MODEL.dead_band_rad_s + MODEL.hysteresis_rad_s + MODEL.stiction_rad_s,
        ),
        (joint.speed_limit_growing_rad_s.value.unwrap(), 0.35),
        (joint.speed_limit_shrinking_rad_s.value.unwrap(), 0.28),
    ];
    pairs.iter().map(|(found, truth)| (found / truth).ln().abs()).fold(0.0, f64::max)
}

#[test]
fn a_model_is_found_again_from_its_own_noisy_response() {
    let plan = trial(&["J"]);
    for seed in 1..=3 {
        let fit = fitted(&[(&plan, &measured(&plan, seed, |_| false))]);
        assert!(worst(&fit) < 0.08, "{seed}: {} {:?}", worst(&fit), fit.joints[0]);
        assert!(fit.joints[0].held_out_r2 > 0.99);
    }
}

/// Four strokes of 6 s with long rests between them.
fn strokes() -> Series {
    let stroke = |t_s: f64| {
        let (over_s, ramp) = (6.0, 0.15);
        let u = (t_s / over_s).clamp(0.0, 1.0);
        let rising = |u: f64| if u < ramp { u * u / (2.0 * ramp) } else { u - 0.5 * ramp };
        if u > 1.0 - ramp { 1.0 - rising(1.0 - u) / (1.0 - ramp) } else { rising(u) / (1.0 - ramp) }
    };
    let t_s: Vec<f64> = (0..=8400).map(|k| f64::from(k) * 0.01).collect();
    let of = |t_s: f64| {
        (0..4).map(move |k| (stroke(t_s - 2.0 - 20.0 * f64::from(k)), if k % 2 == 0 { 0.43 } else { -0.43 }))
    };
    let position = t_s.iter().map(|t_s| of(*t_s).map(|(share, by)| share * by).sum()).collect();
    Series { tracks: vec![Track::new("J", t_s, position, &[]).unwrap()] }
}

#[test]
fn a_slow_loop_is_corrected_and_a_joint_that_is_stuck_is_not() {
    let plan = strokes();
    let slow = Model { feed_forward: 0.0, position_gain_1_s: 0.25, integral_gain_1_s2: 0.0, ..MODEL };
    let still = plan.tracks[0].t_s().iter().map(|t_s| 1e-4 * (7919.0 * t_s).sin()).collect();
    let still = Track::new("J", plan.tracks[0].t_s(), still, &[]).unwrap();
    let stuck = Series { tracks: vec![still] };
    for (measured, astray) in [(measured_of(&slow, &plan, 1, |_| false), false), (stuck, true)] {
        let fit = fitted(&[(&plan, &measured)]);
        let runs = [Trial { sent: &plan, measured: &measured }];
        let made = learn(&fit, &plan, &runs, Learning::default(), |_| None).unwrap();
        assert_eq!(made.joints[0].step == Step::Astray, astray, "{:?}", made.joints[0].rms_error_rad);
        assert!(made.joints[0].rms_error_rad[0] > 0.09, "{:?}", made.joints[0].rms_error_rad);
    }
}

#[test]
fn a_loop_without_an_integral_shows_its_dead_band_over_long_rests_too() {
    let plan = strokes();
    let model = Model {
        dead_time_s: 0.05,
        time_constant_s: 0.12,
        position_gain_1_s: 2.5,
        integral_gain_1_s2: 0.0,
        feed_forward: 1.0,
        asymmetry: 0.0,
        dead_band_rad_s: 0.5 * DEGREE_RAD,
        stiction_rad_s: 0.0,
        hysteresis_rad_s: 0.0,
        backlash_rad: 0.0,
        speed_limit_rad_s: [None; 2],
        ..MODEL
    };
    let fit = fitted(&[(&plan, &measured_of(&model, &plan, 1, |_| false))]);
    let joint = &fit.joints[0];
    let dead_band_deg_s = joint.dead_band_rad_s.value.unwrap() / DEGREE_RAD;
    assert!((0.4..0.7).contains(&dead_band_deg_s), "{dead_band_deg_s}");
    assert_eq!((joint.model.integral_gain_1_s2, joint.integral_gain_1_s2.identified), (0.0, false));
    // One that integrates is not taken for one that does not.
    let integrates = Model { integral_gain_1_s2: 0.4, ..model };
    let fit = fitted(&[(&plan, &measured_of(&integrates, &plan, 1, |_| false))]);
    assert!(fit.joints[0].model.integral_gain_1_s2 > 0.1, "{:?}", fit.joints[0].model);
}

#[test]
fn gaps_and_a_plan_without_speeds_do_not_mislead() {
    let plan = trial(&["J"]);
    let log = measured(&plan, 1, |t_s| (6.0..7.5).contains(&t_s) || (t_s * 100.0).round() % 7.0 == 0.0);
    assert_eq!(log.tracks[0].segments().len(), 2);
    let bare = &plan.tracks[0];
    let bare = Track::new("J", bare.t_s(), bare.position().to_vec(), &[]).unwrap();
    let fit = fitted(&[(&Series { tracks: vec![bare] }, &log)]);
    assert_eq!(fit.joints[0].runs, 2);
    assert!(worst(&fit) < 0.08, "{} {:?}", worst(&fit), fit.joints[0]);
}

#[test]
fn long_logs_are_searched_in_parts_and_fitted_as_a_whole() {
    let plan = trial(&["J"]);
    let logs: Vec<Series> = (1..=12).map(|seed| measured(&plan, seed, |_| false)).collect();
    let one = fitted(&[(&plan, &logs[0])]);
    let all = fitted(&logs.iter().map(|log| (&plan, log)).collect::<Vec<_>>());
    assert_eq!((all.joints[0].runs, all.joints[0].samples), (12, 12 * one.joints[0].samples));
    // Dead band, hysteresis and feed-forward stand in for each other: the dead band is up to a tenth off.
    assert!(worst(&all) < 0.12, "{} {:?}", worst(&all), all.joints[0]);
}

#[test]
fn no_limit_is_below_what_was_reached() {
    let plan = trial(&["J"]);
    let fast = measured(&plan, 1, |_| false);
    let slow = Model { speed_limit_rad_s: [Some(0.31), Some(0.25)], ..MODEL };
    let slow = Series { tracks: vec![predict(&slow, &plan.tracks[0]).unwrap()] };
    let fit = fitted(&[(&plan, &fast), (&plan, &slow), (&plan, &slow), (&plan, &slow)]);
    for (limit, reached) in
        [(fit.joints[0].speed_limit_growing_rad_s, 0.35), (fit.joints[0].speed_limit_shrinking_rad_s, 0.28)]
    {
        let bound = limit.lower_bound.unwrap();
        assert!((bound - reached).abs() < 0.01, "{limit:?}");
        assert!(limit.value.is_none_or(|value| value >= bound * (1.0 - 1e-12)), "{limit:?}");
    }
}

#[test]
fn smooth_starts_bound_the_lag() {
    let t_s: Vec<f64> = (0..=3000).map(|k| f64::from(k) * 0.01).collect();
    let position = t_s.iter().map(|t| 0.9 + 0.1 * (1.0 - (0.4 * (t - 1.5).clamp(0.0, 25.0)).cos())).collect();
    let plan = Series { tracks: vec![Track::new("J", t_s, position, &[]).unwrap()] };
    let lag_s = fitted(&[(&plan, &measured(&plan, 1, |_| false))]).joints[0].lag_s;
    assert!(!lag_s.identified && lag_s.upper_bound.unwrap() > MODEL.lag_s(), "{lag_s:?}");
}

#[test]
fn a_fit_does_not_depend_on_the_number_of_threads_and_survives_a_file() {
    let plan = trial(&["A", "B"]);
    let log = measured(&plan, 1, |_| false);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        serde_json::to_string(&pool.install(|| fitted(&[(&plan, &log)]))).unwrap()
    };
    let text = on(1);
    assert_eq!(text, on(2));
    let back: Fit = serde_json::from_str(&text).unwrap();
    back.check().unwrap();
    assert_eq!(serde_json::to_string(&back).unwrap(), text);
}

#[test]
fn a_command_by_the_model_alone_leaves_a_fifth_of_the_error_and_ends_where_the_plan_does() {
    let plan = {
        let t_s: Vec<f64> = (0..=1500).map(|k| f64::from(k) * 0.01).collect();
        let rate = std::f64::consts::PI / 6.0;
        let phase = |t: &f64| rate * (t - 1.5).clamp(0.0, 12.0);
        let position = t_s.iter().map(|t| 0.9 + 0.1 * (1.0 - phase(t).cos())).collect();
        let speed = t_s
            .iter()
            .map(|t| if (1.5..13.5).contains(t) { 0.1 * rate * phase(t).sin() } else { 0.0 })
            .collect();
        let track = Track::new("J", t_s, position, &[]).unwrap().with_velocity(speed).unwrap();
        Series { tracks: vec![track] }
    };
    let trial = trial(&["J"]);
    let mut fit = fitted(&[(&trial, &measured(&trial, 1, |_| false))]);
    let made = |fit: &Fit, gain| learn(fit, &plan, &[], Learning { gain, ..Learning::default() }, |_| None);
    let found = made(&fit, 1.0).unwrap();
    assert_eq!(found.joints[0].step, Step::Model);
    let command = found.command(&plan, |_| 1.0).unwrap();
    let rms_rad = |sent: &Series| {
        let response = predict(&fit.joints[0].model, &sent.tracks[0]).unwrap();
        let squares = plan.tracks[0].position().iter().zip(response.position()).map(|(p, m)| (p - m).powi(2));
        (squares.sum::<f64>() / response.len() as f64).sqrt()
    };
    assert!(rms_rad(&command) < 0.2 * rms_rad(&plan), "{} {}", rms_rad(&command), rms_rad(&plan));
    let (q, v) = (command.tracks[0].position(), command.tracks[0].velocity().unwrap());
    let planned = plan.tracks[0].position();
    assert!(q.iter().zip(planned).all(|(sent, planned)| (sent - planned).abs() <= 1.5 * DEGREE_RAD));
    assert_eq!((q[0], q[q.len() - 1]), (planned[0], planned[planned.len() - 1]));
    for k in 1..q.len() - 1 {
        let slope = (q[k + 1] - q[k - 1]) / 0.02;
        assert!((slope - v[k]).abs() < 2e-3, "{k}: {slope} {}", v[k]);
    }
    let none = made(&fit, 0.0).unwrap();
    assert_eq!(none.command(&plan, |_| 1.0).unwrap(), plan);
    fit.joints[0].held_out_r2 = 0.2;
    assert_eq!(made(&fit, 1.0).unwrap().joints[0].step, Step::None);
    fit.joints[0].model.dead_time_s = -1.0;
    let error = made(&fit, 1.0).unwrap_err();
    assert!(matches!(error, FitError::Value { key: "dead_time_s", .. }), "{error}");
}

#[test]
fn a_trial_stays_in_range_and_one_without_room_is_refused() {
    let joints = [("up", 0.5, [0.5, 1.5]), ("both", 1.0, [0.0, 2.0])];
    let rooms = joints.map(|(name, home_rad, range_rad)| JointRoom::turning(name, home_rad, range_rad));
    for excitation in [Excitation::minimal(), Excitation::full()] {
        let run = excite(&rooms, &excitation).unwrap();
        for (track, room) in run.tracks.iter().zip(&rooms) {
            let inside = |q: &f64| (room.range_rad[0]..=room.range_rad[1]).contains(q);
            assert!(track.position().iter().all(inside));
            assert_eq!(track.position().last(), Some(&room.home_rad));
        }
        let moving = |k: usize| run.tracks.iter().filter(|t| t.velocity().unwrap()[k] != 0.0).count();
        assert!((0..run.tracks[0].len()).all(|k| moving(k) <= 1));
    }
    let within = |home_rad: f64, range_rad| {
        let room = [JointRoom { home_rad, range_rad, ..rooms[1].clone() }];
        let run = excite(&room, &Excitation::minimal())?;
        let sent = run.tracks[0].position();
        Ok(sent.iter().fold([f64::MAX, f64::MIN], |[a, b], q| [a.min(*q), b.max(*q)]))
    };
    let none: Result<[f64; 2], FitError> = within(1.0, [0.99, 1.01]);
    assert!(matches!(none, Err(FitError::NoRoom { .. })));
    // To one side the fastest strokes are as long as across both, where there is room.
    let far = |ends: [f64; 2]| ends.map(|end: f64| (end - 1.0).to_degrees().round());
    assert_eq!(far(within(1.0, [0.0, 1.0]).unwrap()), [-20.0, 0.0]);
    assert_eq!(far(within(1.0, [0.98, 1.3]).unwrap()), [0.0, 17.0]);
    // Faster than usual, where that is asked for, and as much longer.
    let room = [JointRoom { most_rad_s: 2.0, ..rooms[1].clone() }];
    let run = excite(&room, &Excitation::minimal()).unwrap();
    let fastest =
        run.tracks[0].velocity().unwrap().iter().fold(0.0, |most: f64, speed| most.max(speed.abs()));
    assert!(fastest > 1.8 && fastest <= 2.0 + 1e-9, "{fastest}");
    // A narrow joint goes as far as it may; a stroke that fits exactly is not cut by rounding.
    assert_eq!(within(1.0, [0.95, 1.05]).unwrap(), [0.95, 1.05]);
    let [low, home, high] = [23.3_f64, 33.3, 43.3].map(f64::to_radians);
    let [from, to] = within(home, [low, high]).unwrap();
    assert!((from - low).abs() < 1e-9 && (to - high).abs() < 1e-9, "{from} {to}");
}
