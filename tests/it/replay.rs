//! Laws of the replay that hold for every run, and the gates of its detector.

use std::{ops::Range, slice::from_ref};

use hydrotrace::{
    replay::{Answer, Replay, Rules, Sizes, Transition, replay},
    series::{JointKind, Pair},
    units::DEGREE_RAD,
};
use hydrotrace_bench::detector::{Sensing, synthetic_run};
use proptest::prelude::*;

pub(crate) fn of(pair: &Pair) -> Replay {
    replay(from_ref(pair), &Rules::default())
}

fn noiseless(seed: u64, delay_s: f64) -> Pair {
    synthetic_run(seed, &Sensing { sigma_rad: 0.0, delay_s, ..Sensing::default() }).pair
}

pub(crate) fn recorded(
    t_s: Vec<f64>,
    planned: Vec<f64>,
    measured: Vec<f64>,
    segments: Vec<Range<usize>>,
) -> Pair {
    Pair {
        name: "a".into(),
        kind: JointKind::Turns,
        planned,
        planned_velocity: None,
        measured,
        segments,
        planned_interval_s: 0.01,
        planned_step: None,
        matched: t_s.len(),
        unmatched: 0,
        t_s: t_s.into(),
    }
}

/// A hundred samples a second of a plan and a measurement, without a cut.
pub(crate) fn sampled(n: usize, planned: impl Fn(f64) -> f64, measured: impl Fn(f64) -> f64) -> Pair {
    let t_s: Vec<f64> = (0..n).map(|k| 0.01 * k as f64).collect();
    let of = |at: &dyn Fn(f64) -> f64| t_s.iter().map(|t_s| at(*t_s)).collect();
    let (planned, measured) = (of(&planned), of(&measured));
    recorded(t_s, planned, measured, std::iter::once(0..n).collect())
}

/// A ramp from rest at `start_s`, of 4 degrees per second for 3 s.
pub(crate) fn ramp(t_s: f64, start_s: f64) -> f64 {
    4.0 * DEGREE_RAD * (t_s - start_s).clamp(0.0, 3.0)
}

#[test]
fn joints_that_turn_and_that_slide_are_found_by_thresholds_of_their_own() {
    let turns = sampled(600, |t| ramp(t, 1.0), |t| ramp(t, 1.2));
    let slides = Pair { kind: JointKind::Slides, ..turns.clone() };
    let found = |rules: &Rules| [&turns, &slides].map(|pair| replay(from_ref(pair), rules).transitions.len());
    let (default, never) = (Rules::default(), 1.0);
    let sizes = |of: Sizes| Sizes { start_speed: never, ..of };
    assert_eq!(found(&default), [1, 1]);
    assert_eq!(found(&Rules { turning: sizes(default.turning), ..default.clone() }), [0, 1]);
    assert_eq!(found(&Rules { sliding: sizes(default.sliding), ..default }), [1, 0]);
}

#[test]
fn a_degree_is_worse_than_eighteen_millimetres_though_its_number_is_smaller() {
    let t_s: Vec<f64> = (0..600).map(|k| f64::from(k) * 0.01).collect();
    let along = |at_s: f64, size: f64| t_s.iter().map(|t| size * ramp(*t, at_s)).collect();
    let whole = || vec![Range { start: 0, end: 600 }];
    let of = |size| recorded(t_s.clone(), along(1.0, size), along(1.25, size), whole());
    let slides = Pair { kind: JointKind::Slides, name: "b".into(), ..of(1.03) };
    let found = replay(&[slides, of(1.0)], &Rules::default());
    let worst: Vec<_> = found.worst_first().iter().map(|t| (t.joint.as_str(), t.peak_error)).collect();
    assert!(matches!(worst[..], [("a", a), ("b", b)] if a < b), "{worst:?}");
}

fn onsets(replay: &Replay) -> Vec<(i8, f64, Option<f64>)> {
    replay.transitions.iter().map(|t| (t.direction, t.planned_onset_s, t.measured_onset_s)).collect()
}

/// Any pair at all: uneven stamps, wild angles, cuts anywhere, speeds that mean nothing.
fn any_pair() -> impl Strategy<Value = Pair> {
    let sample = (1e-4..0.3_f64, -4.0..4.0_f64, -4.0..4.0_f64, -2.0..2.0_f64, prop::bool::weighted(0.1));
    let scale = prop_oneof![Just(1.0), Just(1e-9), Just(0.0), Just(1e12), Just(1e200)];
    (prop::collection::vec(sample, 1..120), scale, any::<bool>()).prop_map(|(rows, scale, with_speed)| {
        let t_s: Vec<f64> = rows
            .iter()
            .scan(0.0, |now, row| {
                *now += row.0;
                Some(*now)
            })
            .collect();
        let mut segments = Vec::new();
        let mut start = 0;
        for (i, row) in rows.iter().enumerate().skip(1) {
            if row.4 {
                segments.push(start..i);
                start = i;
            }
        }
        segments.push(start..rows.len());
        let column = |value: fn(&(f64, f64, f64, f64, bool)) -> f64| rows.iter().map(value).collect();
        let mut pair = recorded(t_s, column(|r| r.1), column(|r| r.2), segments);
        pair.planned.iter_mut().chain(&mut pair.measured).for_each(|x| *x *= scale);
        pair.planned_velocity = with_speed.then(|| column(|r| r.3));
        pair
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn any_run_is_analysed_and_serialises(pairs in prop::collection::vec(any_pair(), 0..4)) {
        let found = replay(&pairs, &Rules::default());
        prop_assert_eq!(found.joints.len(), pairs.len());
        prop_assert!(serde_json::to_string(&found).is_ok());
        for joint in &found.joints {
            let e = joint.tracking_error;
            prop_assert!(e.peak >= e.p95 && e.peak >= e.mean_abs * (1.0 - 1e-9));
        }
        // A joint's starts are its transitions, and there are no others.
        let starts: usize = found.joints.iter().map(|joint| joint.starts).sum();
        prop_assert_eq!(starts, found.transitions.len());
    }

    #[test]
    fn a_joint_on_its_plan_has_no_error(mut pair in any_pair()) {
        pair.measured.clone_from(&pair.planned);
        let found = of(&pair);
        prop_assert_eq!(found.joints[0].tracking_error.peak, 0.0);
        prop_assert!(found.transitions.iter().all(|t| t.peak_error == 0.0 && t.error_area == 0.0));
    }

    #[test]
    fn windows_and_motions_stay_within_their_segment(pair in any_pair()) {
        for t in &of(&pair).transitions {
            let inside = |at_s: f64| {
                pair.segments.iter().position(|s| pair.t_s[s.start] <= at_s && at_s <= pair.t_s[s.end - 1])
            };
            if let Some(measured_s) = t.measured_onset_s {
                prop_assert_eq!(inside(t.planned_onset_s), inside(measured_s), "{:?}", t);
            }
            prop_assert_eq!(inside(t.planned_onset_s), inside(t.window_s[1]));
        }
    }

    #[test]
    fn an_answer_has_an_instant_if_and_only_if_it_is_timed_and_every_start_is_counted_once(pair in any_pair()) {
        let found = of(&pair);
        for t in &found.transitions {
            prop_assert_eq!(t.answer == Answer::Timed, t.measured_onset_s.is_some());
        }
        let count = |wanted: &[Answer]| found.transitions.iter().filter(|t| wanted.contains(&t.answer)).count();
        let joint = &found.joints[0];
        prop_assert_eq!(joint.unanswered_starts, count(&[Answer::Never]));
        prop_assert_eq!(joint.undated_starts, count(&[Answer::Creeps, Answer::Unclear]));
        prop_assert_eq!(joint.starts, found.transitions.len());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn a_constant_offset_shifts_the_bias_and_nothing_in_time(seed in 0..1000_u64, offset in -0.02..0.02_f64) {
        let pair = noiseless(seed, 0.1);
        let mut off = pair.clone();
        off.measured.iter_mut().for_each(|y| *y -= offset);
        let (a, b) = (of(&pair), of(&off));
        let shift = b.joints[0].tracking_error.bias - a.joints[0].tracking_error.bias;
        prop_assert!((shift - offset).abs() < 1e-9);
        prop_assert!((a.joints[0].lag_s.unwrap() - b.joints[0].lag_s.unwrap()).abs() < 1e-6);
        prop_assert_eq!(a.transitions.len(), b.transitions.len());
        for (a, b) in a.transitions.iter().zip(&b.transitions) {
            let (Some(a), Some(b)) = (a.onset_delay_s, b.onset_delay_s) else {
                prop_assert_eq!(a.onset_delay_s, b.onset_delay_s);
                continue;
            };
            prop_assert!((a - b).abs() < 1e-3, "{} {}", a, b);
        }
    }

    #[test]
    fn a_pure_shift_is_the_lag_and_the_delay_of_every_start(seed in 0..1000_u64, delay_s in 0.0..0.3_f64) {
        let found = of(&noiseless(seed, delay_s));
        prop_assert!((found.joints[0].lag_s.unwrap() - delay_s).abs() < 0.003, "{:?}", found.joints[0].lag_s);
        prop_assert!(!found.transitions.is_empty());
        for t in &found.transitions {
            let off_s = (t.onset_delay_s.unwrap() - delay_s).abs();
            // A plan that creeps away from a turn is dated less sharply, and its interval says so.
            let holds = t.onset_delay_interval_s.is_some_and(|[low, high]| low <= delay_s && delay_s <= high);
            prop_assert!(off_s < 0.03 || holds && off_s < 0.06, "{t:?}");
        }
        let mut off: Vec<f64> = found.transitions.iter().map(|t| (t.onset_delay_s.unwrap() - delay_s).abs()).collect();
        off.sort_by(f64::total_cmp);
        // Departures are tried every 5 ms.
        prop_assert!(off[off.len() / 2] < 0.008, "{off:?}");
    }

    #[test]
    fn a_pure_shift_is_lag_wherever_the_log_is_cut_and_off_the_path_no_more_than_off_the_plan(
        seed in 0..1000_u64,
        delay_s in 0.02..0.3_f64,
        cut in 1..100_usize,
    ) {
        let mut pair = noiseless(seed, delay_s);
        let n = pair.t_s.len();
        pair.segments = vec![0..cut * n / 100, cut * n / 100..n];
        let whole = of(&pair).whole_run;
        let share = whole.lag_share.unwrap();
        // Where the log is cut, the time of the lag has nothing to be compared with.
        prop_assert!(share.share > 0.97 && share.mostly, "{share:?}");
        if let Some([low, high]) = share.interval {
            prop_assert!(low <= share.share && share.share <= high);
        }
        let path = whole.path_error.unwrap();
        prop_assert!(path.rms <= path.timed_rms, "{path:?}");
    }

    #[test]
    fn a_mirrored_run_gives_mirrored_results(seed in 0..1000_u64) {
        let pair = synthetic_run(seed, &Sensing::default()).pair;
        let mut mirrored = pair.clone();
        let speeds = mirrored.planned_velocity.as_mut().unwrap();
        mirrored.planned.iter_mut().chain(&mut mirrored.measured).chain(speeds).for_each(|x| *x = -*x);
        let (a, b) = (of(&pair), of(&mirrored));
        let back: Vec<Transition> = b
            .transitions
            .iter()
            .map(|t| Transition {
                direction: -t.direction,
                peak_error_signed: -t.peak_error_signed,
                ..t.clone()
            })
            .collect();
        prop_assert_eq!(&a.transitions, &back);
        prop_assert_eq!(a.joints[0].lag_s, b.joints[0].lag_s);
        prop_assert_eq!(a.joints[0].tracking_error.bias, -b.joints[0].tracking_error.bias);
    }

    #[test]
    fn given_speeds_and_slopes_of_the_plan_find_the_same_starts(seed in 0..1000_u64) {
        let pair = noiseless(seed, 0.1);
        let bare = Pair { planned_velocity: None, ..pair.clone() };
        let (a, b) = (onsets(&of(&pair)), onsets(&of(&bare)));
        prop_assert_eq!(a.len(), b.len());
        for (a, b) in a.iter().zip(&b) {
            // Slopes of a plan that starts gently are smoothed over some hundredths of a second.
            prop_assert!(a.0 == b.0 && (a.1 - b.1).abs() < 0.08, "{:?} {:?}", a, b);
        }
    }
}

#[test]
fn a_log_that_opens_in_motion_has_no_transition_there() {
    let angle = |t: f64| ramp(t, -1.0) + ramp(t, 6.0);
    let found = of(&sampled(1000, angle, angle));
    assert_eq!(found.transitions.len(), 1);
    assert!((found.transitions[0].planned_onset_s - 6.0).abs() < 0.02);
    assert_eq!((found.joints[0].unplanned_starts, found.joints[0].unanswered_starts), (0, 0));
}

#[test]
fn a_step_across_a_cut_is_no_motion() {
    let angle = |t: f64| if t < 3.995 { 0.0 } else { 1.0 };
    let whole = sampled(800, angle, angle);
    let found = of(&Pair { segments: vec![0..400, 400..800], ..whole.clone() });
    assert!(found.transitions.is_empty() && found.stops.is_empty());
    assert!(!found.joints[0].moves && !found.joints[0].plan_moves);
    // Without the cut it is one.
    assert!(of(&whole).joints[0].moves);
}

#[test]
fn a_joint_at_rest_gets_no_invented_numbers() {
    let found = of(&sampled(800, |_| 0.5, |_| 0.49));
    let joint = &found.joints[0];
    assert!(!joint.moves && !joint.plan_moves);
    assert_eq!((joint.lag_s, joint.lag_correlation, joint.lag_interval_s), (None, None, None));
    assert!((joint.standstill_error.unwrap().bias - 0.01).abs() < 1e-12);
    assert_eq!(found.whole_run.concentration, None);
}

#[test]
fn a_joint_that_ignores_its_plan_has_an_unmatched_start_without_onset() {
    let found = of(&sampled(800, |t| ramp(t, 2.0), |_| 0.0));
    assert_eq!((found.joints[0].starts, found.joints[0].unanswered_starts), (1, 1));
    let transition = &found.transitions[0];
    assert_eq!((transition.measured_onset_s, transition.onset_delay_s), (None, None));
    assert_eq!((transition.displacement_delay_s, transition.jump), (None, None));
    assert!((transition.peak_error - 12.0 * DEGREE_RAD).abs() < 1e-9);
}

#[test]
fn a_joint_that_creeps_into_its_motion_answers_without_an_instant() {
    // It has crept at 0.3 degrees per second for 1.4 s when its plan starts.
    let creep = |t: f64| 0.3 * DEGREE_RAD * (t - 0.6).clamp(0.0, 1.4);
    let found = of(&sampled(1000, |t| ramp(t, 2.0), |t| creep(t) + ramp(t, 2.0)));
    assert_eq!(found.transitions[0].answer, Answer::Creeps);
    assert_eq!((found.transitions[0].measured_onset_s, found.transitions[0].onset_delay_s), (None, None));
    let joint = &found.joints[0];
    assert_eq!((joint.starts, joint.unanswered_starts, joint.undated_starts), (1, 0, 1));
}

#[test]
fn a_joint_that_hunts_when_its_plan_starts_answers_without_an_instant_and_one_that_settled_with_one() {
    let found = |until_s: f64, hz: f64| {
        let swing = |t: f64| {
            if t < until_s { 0.1 * DEGREE_RAD * (std::f64::consts::TAU * hz * t).sin() } else { 0.0 }
        };
        let found = of(&sampled(1200, |t| ramp(t, 6.0), |t| swing(t) + ramp(t, 6.3)));
        (found.transitions[0].answer, found.transitions[0].onset_delay_s)
    };
    for hz in [0.8, 1.5, 2.0] {
        assert_eq!(found(6.2, hz), (Answer::Creeps, None), "{hz}");
    }
    // It swung until 5 s, and rested for 1.3 s.
    let (answer, delay_s) = found(5.0, 1.0);
    assert_eq!(answer, Answer::Timed);
    assert!((delay_s.unwrap() - 0.3).abs() < 0.03, "{delay_s:?}");
}

#[test]
fn a_drift_of_the_plan_just_before_a_large_move_says_nothing_of_the_joint() {
    // 0.35 degrees one way in half a second, then 12 the other way, which the joint follows.
    let drift = |t: f64| 0.7 * DEGREE_RAD * (t - 2.0).clamp(0.0, 0.5);
    let pair = sampled(1000, |t| drift(t) - ramp(t, 2.55), |t| -ramp(t, 2.65));
    let found = of(&pair);
    let answers = |found: &Replay| found.transitions.iter().map(|t| t.answer).collect::<Vec<Answer>>();
    assert_eq!(answers(&found), [Answer::Unclear, Answer::Timed]);
    // It is the short time that decides, not the small travel.
    let hasty = Rules { match_after_s: 0.3, ..Rules::default() };
    assert_eq!(answers(&replay(&[pair], &hasty)), [Answer::Never, Answer::Timed]);
    assert_eq!((found.joints[0].unanswered_starts, found.joints[0].undated_starts), (0, 1));
    // The same drift, had it gone on: a joint that stands still then is one that does not answer.
    let drift = |t: f64| 0.4 * DEGREE_RAD * (t - 2.0).clamp(0.0, 2.0);
    let found = of(&sampled(1000, |t| drift(t) - ramp(t, 4.5), |t| -ramp(t, 4.6)));
    assert_eq!(answers(&found), [Answer::Never, Answer::Timed]);
}

/// How much of the error the lag of a joint explains that follows a ramp of 4 degrees per second, 3 s long, so.
fn lag_share(follow: impl Fn(f64) -> f64) -> f64 {
    let found = of(&sampled(1000, |t| ramp(t, 2.0), follow));
    assert_eq!(found.joints[0].lag_share, found.whole_run.lag_share);
    found.whole_run.lag_share.unwrap().share
}

#[test]
fn a_lag_explains_the_error_of_a_delayed_joint_and_not_that_of_a_late_start_or_an_offset() {
    let delayed = lag_share(|t| ramp(t, 2.12));
    assert!(delayed > 0.99, "{delayed}");
    // It waits 0.6 s, is back on its plan 0.4 s later, and stays on it.
    let late = lag_share(|t| if t < 2.6 { 0.0 } else { ramp(t, 2.0).min(10.0 * DEGREE_RAD * (t - 2.6)) });
    assert!(late < 0.3, "{late}");
    let offset = lag_share(|t| ramp(t, 2.0) - 0.5 * DEGREE_RAD);
    assert!(offset < 0.05, "{offset}");
}

#[test]
fn a_stop_across_a_cut_answers_nothing() {
    let whole = sampled(800, |t| ramp(t, 2.0), |t| ramp(t, 2.6));
    let found = of(&Pair { segments: vec![0..520, 520..800], ..whole });
    let stops: Vec<_> = found.stops.iter().map(|s| (s.planned_s.is_some(), s.measured_s.is_some())).collect();
    assert_eq!(stops, [(true, false), (false, true)]);
}

#[test]
fn a_joint_that_moves_the_other_way_answers_nothing() {
    let found = of(&sampled(800, |t| ramp(t, 2.0), |t| -ramp(t, 2.1)));
    assert_eq!((found.joints[0].unanswered_starts, found.joints[0].unplanned_starts), (1, 1));
    assert_eq!(found.transitions[0].measured_onset_s, None);
}
