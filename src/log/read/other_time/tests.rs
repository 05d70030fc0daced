//! Measurements of one plan whose clock, pace and lag are known.

use super::*;
use crate::{
    math::{smooth_step as step, whole},
    series::Track,
};

fn series(at_s: impl Fn(f64) -> f64) -> Series {
    let plan = |joint: f64, t: f64| joint * (step((t - 4.0) / 8.0) - 0.6 * step((t - 20.0) / 6.0));
    let track = |name: &str, size: f64| Track::sampled(name, 4000, |t| plan(size, at_s(t)));
    Series { tracks: vec![track("swing", 1.0), track("boom", -0.5), track("stick", 0.8)] }
}

fn said(at_s: impl Fn(f64) -> f64) -> Option<String> {
    message(&series(|t| t), &series(at_s), false)
}

#[test]
fn clocks_that_differ_and_another_speed_are_told() {
    for (by_s, told) in
        [(-2.0, "2.00 s before"), (-0.8, "0.80 s before"), (3.0, "3.00 s after"), (9.3, "9.30 s")]
    {
        let found = said(|t| t - by_s);
        assert!(found.as_ref().is_some_and(|one| one.contains(told)), "{by_s}: {found:?}");
    }
    for (pace, told) in [(1.25, "1.25 times as long"), (0.7, "0.70 times as long"), (1.4, "1.40 times")] {
        let found = said(|t| 4.0 + (t - 4.0) / pace);
        assert!(found.as_ref().is_some_and(|one| one.contains(told)), "{pace}: {found:?}");
    }
}

#[test]
fn a_run_that_is_slowed_on_the_way_falls_behind() {
    let slowed = |from: f64, to: f64, pace: f64| {
        move |t: f64| t.min(from) + pace * (t.clamp(from, to) - from) + (t - to).max(0.0) - 0.3
    };
    for (from, to, pace, told) in [
        (7.0, 11.0, 0.3, "by 2.8 s from about"),
        (0.0, 12.0, 0.7, "fall behind their plan by"),
        (8.0, 40.0, 0.5, "until the end"),
    ] {
        let found = said(slowed(from, to, pace));
        assert!(found.as_ref().is_some_and(|one| one.contains(told)), "{pace}: {found:?}");
    }
    // By a clock, steadily; held on the way, and by a lag alone.
    let long = |scale: f64| {
        let of = |joint: f64, t: f64| joint * (0.05 * t).sin() * (1.0 + 0.3 * (0.013 * t).cos());
        let track = |name: &str, size: f64| Track::sampled(name, 40_000, |t| of(size, scale * t));
        Series { tracks: vec![track("swing", 1.0), track("boom", -0.5)] }
    };
    let told = message(&long(1.0), &long(0.995), false);
    assert!(told.as_ref().is_none_or(|one| !one.contains("fall behind")), "{told:?}");
    assert!(said(|t| t.min(7.0).max(t - 3.0)).is_some_and(|one| one.contains("fall behind")));
    assert_eq!(said(|t| t - 0.6), None);
}

#[test]
fn one_joint_that_makes_no_more_than_its_limit_was_not_slowed() {
    let plan = |t: f64| 0.5 * step((t - 3.0) / 6.0) - 0.9 * step((t - 14.0) / 4.0);
    let mut came = 0.0_f64;
    let mut made = vec![];
    for k in 0..4000 {
        came += (plan(f64::from(k) / 100.0) - came).clamp(-0.0015, 0.0015);
        made.push(came);
    }
    let at = |t: f64| made[whole(100.0 * t).min(made.len() - 1)];
    let one = |of: &dyn Fn(f64) -> f64| Series { tracks: vec![Track::sampled("boom", 4000, of)] };
    assert_eq!(message(&one(&plan), &one(&at), false), None);
}

#[test]
fn joints_that_leave_in_time_and_lead_later_are_on_no_other_clock() {
    // Speed feed-forward of one and a half behind a lag.
    let plan = series(|t| t);
    let leads = |track: &Track| {
        let q = track.position();
        let mut now = q[0];
        let follow = |k: usize| {
            let speed = (q[k] - q[k.saturating_sub(1)]) / 0.01;
            let wanted = 1.5 * speed + 2.0 * (q[k] - now);
            let late = if k < 30 { 0.0 } else { wanted };
            now += 0.01 * late;
            now
        };
        Track::new(track.name(), track.t_s(), (0..q.len()).map(follow).collect(), &[]).unwrap()
    };
    let measured = Series { tracks: plan.tracks.iter().map(leads).collect() };
    let after = |track: &Track| {
        let t_s: Vec<f64> = track.t_s().iter().map(|t| t + 0.12).collect();
        Track::new(track.name(), t_s, track.position().to_vec(), &[]).unwrap()
    };
    let measured = Series { tracks: measured.tracks.iter().map(after).collect() };
    assert_eq!(message(&plan, &measured, false), None);
}

#[test]
fn what_machines_do_is_not() {
    assert_eq!(said(|t| t), None);
    assert_eq!(said(|t| t - 0.6), None);
    assert_eq!(said(|_| 0.0), None, "none moves");
    let plan = series(|t| t);
    for share in [0.9, 0.7, 0.5, 0.35] {
        let limited = |track: &Track| {
            let fastest = track.position().windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
            let mut now = track.position()[0];
            let follow = |q: &f64| {
                now += (q - now).clamp(-share * fastest, share * fastest);
                now
            };
            let q = track.position().iter().map(follow).collect();
            Track::new(track.name(), track.t_s(), q, &[]).unwrap()
        };
        let measured = Series { tracks: plan.tracks.iter().map(limited).collect() };
        assert_eq!(message(&plan, &measured, false), None, "all at {share} of the speed that is asked");
    }
    assert_eq!(said(|t| t.min(10.0)), None, "they stop for good");
    // A short motion behind a delay and a lag takes longer, and no other speed.
    let short = |at_s: f64| 0.5 * step((at_s - 4.0) / 1.2);
    let mut now = 0.0;
    let follow = |t: f64| {
        now += (short(t - 0.1) - now) * (1.0 - (-0.01_f64 / 0.25).exp());
        now
    };
    let measured = Series::sampled("boom", 1200, follow);
    let planned = Series::sampled("boom", 1200, short);
    assert_eq!(message(&planned, &measured, false), None, "a short motion");
}

#[test]
fn a_slow_filter_of_set_values_is_no_clock_and_hides_none() {
    let plan = series(|t| t);
    let said = |filters: u32, lag_s: f64, late_s: f64| {
        let behind = |track: &Track| {
            let time_s = lag_s / f64::from(filters);
            let mut q = track.position().to_vec();
            for _ in 0..filters {
                let mut now = q[0];
                for at in &mut q {
                    now += (*at - now) * (1.0 - (-0.01 / time_s).exp());
                    *at = now;
                }
            }
            Track::new(track.name(), track.t_s(), q, &[]).unwrap()
        };
        let measured = Series { tracks: series(|t| t - late_s).tracks.iter().map(behind).collect() };
        message(&plan, &measured, false)
    };
    for (filters, lag_s) in [(1, 1.4), (2, 1.1), (2, 1.6), (3, 1.8)] {
        assert_eq!(said(filters, lag_s, 0.0), None, "{filters} filters, {lag_s} s together");
    }
    // One filter as slow as the clock is late looks like three without a clock: that is not told.
    for (filters, lag_s) in [(1, 0.3), (1, 0.44), (2, 0.8), (2, 1.1), (2, 1.6), (3, 1.8)] {
        let late = said(filters, lag_s, 1.5);
        assert!(late.is_some(), "{filters} filters, {lag_s} s together, on another clock");
    }
}

#[test]
fn clocks_that_run_apart_are_told_and_joints_that_lag_each_by_itself_are_not() {
    let t_s: Vec<f64> = (0..6000).map(|k| f64::from(k) * 0.01).collect();
    let plan = |joint: f64, t: f64| 0.4 * ((0.5 + 0.1 * joint) * t).sin() + 0.1 * (1.3 * t).cos();
    let series = |at_s: &dyn Fn(f64, f64) -> f64| {
        let track = |joint: u8| {
            let q = t_s.iter().map(|&t| plan(joint.into(), at_s(joint.into(), t))).collect();
            Track::new(format!("J{joint}"), t_s.clone(), q, &[]).unwrap()
        };
        Series { tracks: (0..4).map(track).collect() }
    };
    let said = |at_s: &dyn Fn(f64, f64) -> f64| message(&series(&|_, t| t), &series(at_s), false);
    let apart = said(&|_, t| (t - 0.1) / 1.006).unwrap();
    assert!(apart.contains("run 0.6 % apart"), "{apart}");
    for late in
        [|_: f64, t: f64| t - 0.25, |joint: f64, t: f64| t - 0.1 - 0.1 * joint, |_: f64, t: f64| t / 1.001]
    {
        assert_eq!(said(&late), None);
    }
}

#[test]
fn a_motion_that_repeats_itself_is_late_by_no_period() {
    let swings = |hz: f64, late_s: f64| {
        let of = |name: &str, size: f64| {
            Track::sampled(name, 2000, |t| size * (std::f64::consts::TAU * hz * (t - late_s)).sin())
        };
        Series { tracks: vec![of("hip", 0.3), of("knee", -0.4)] }
    };
    for hz in [0.3, 0.8, 1.0, 1.3, 1.8, 2.5] {
        assert_eq!(message(&swings(hz, 0.0), &swings(hz, 0.06), false), None, "{hz} Hz");
    }
    assert_eq!(
        message(&swings(2.0, 0.0), &swings(2.0, 0.3), false),
        None,
        "a lead of 0.2 s is a lag of 0.3 s"
    );
}
