//! Parts of a model that only some machines have: found where they are and nowhere else.

use hydrotrace::{
    fit::{JointFit, Model},
    series::{Series, Track},
    units::DEGREE_RAD,
};

use super::matched::{MODEL, QUICK, measured_of, trial};
use crate::support::machine::fitted;

fn joint_of(model: &Model, plan: &Series, seed: u64) -> JointFit {
    fitted(&[(plan, &measured_of(model, plan, seed, |_| false))]).joints[0].clone()
}

#[test]
fn a_joint_that_swings_on_its_oil_is_told_from_set_values_that_come_late() {
    let plan = trial(&["J"]);
    // The last acts as a lag of its length: which of the two it is shows no more.
    for (seed, frequency_rad_s, damping_ratio, shows) in
        [(1, 9.0, 0.4, true), (3, 12.0, 0.2, true), (4, 10.0, 0.3, true), (2, 14.0, 0.5, false)]
    {
        let swings = Model { natural_frequency_rad_s: frequency_rad_s, damping_ratio, ..QUICK };
        let plain = joint_of(&QUICK, &plan, seed);
        assert!(!plain.model.swings(), "{seed}: {plain:?}");
        let found = joint_of(&swings, &plan, seed);
        assert_eq!(found.model.swings(), shows, "{seed}: {found:?}");
        let ratio = found.model.natural_frequency_rad_s / frequency_rad_s;
        assert!(!shows || ratio.ln().abs() < 0.15, "{seed}: {found:?}");
        let ratio = found.model.damping_ratio / damping_ratio;
        assert!(!shows || ratio.ln().abs() < 0.3, "{seed}: {found:?}");
        assert!(found.model_holds && found.set_values_late_s.value.unwrap() <= 0.0, "{seed}: {found:?}");
        assert!((found.lag_s.value.unwrap() / swings.lag_s()).ln().abs() < 0.1, "{seed}: {found:?}");
        let gain = found.position_gain_1_s.value.unwrap() / QUICK.position_gain_1_s;
        assert!(gain.ln().abs() < 0.1, "{seed}: {found:?}");
    }
}

#[test]
fn an_integral_that_is_held_within_limits_is_no_feed_forward() {
    let plan = trial(&["J"]);
    for seed in 1..=3 {
        let wound = Model { feed_forward: 0.0, integral_gain_1_s2: 2.5, ..QUICK };
        let held = Model { integral_limit_rad_s: Some(3.0 * DEGREE_RAD), ..wound };
        let plain = joint_of(&wound, &plan, seed);
        assert_eq!(plain.model.integral_limit_rad_s, None, "{seed}: {plain:?}");
        let found = joint_of(&held, &plan, seed);
        let limit_rad_s = found.model.integral_limit_rad_s.unwrap();
        assert!((limit_rad_s / (3.0 * DEGREE_RAD)).ln().abs() < 0.1, "{seed}: {found:?}");
        assert!(found.feed_forward.value.unwrap() <= 0.0, "{seed}: {found:?}");
        for (found, truth) in [
            (found.integral_gain_1_s2, held.integral_gain_1_s2),
            (found.position_gain_1_s, held.position_gain_1_s),
            (found.lag_s, held.lag_s()),
        ] {
            let [low, high] = found.interval.unwrap();
            assert!(found.identified && (low..=high).contains(&truth), "{seed}: {truth} {found:?}");
        }
    }
}

#[test]
fn edges_that_open_gradually_are_found_where_they_are_and_nowhere_else() {
    let plan = trial(&["J"]);
    let edged = Model { edge_rad_s: 2.5 * DEGREE_RAD, ..MODEL };
    for seed in 1..=3 {
        let [plain, found] = [&MODEL, &edged].map(|model| {
            let fit = fitted(&[(&plan, &measured_of(model, &plan, seed, |_| false))]);
            assert!(fit.joints[0].held_out_r2 > 0.99 && fit.joints[0].feed_forward.identified);
            fit.joints[0].model
        });
        assert!(plain.edge_rad_s <= 0.0, "{seed}: {plain:?}");
        assert!((found.edge_rad_s / edged.edge_rad_s).ln().abs() < 0.3, "{seed}: {found:?}");
        assert!((found.feed_forward / edged.feed_forward).ln().abs() < 0.1, "{seed}: {found:?}");
    }
}

#[test]
fn a_valve_that_opens_beyond_the_largest_speed_is_found_where_it_is_and_nowhere_else() {
    let plan = trial(&["J"]);
    let opens = Model { opens_beyond: 1.5, ..QUICK };
    for seed in 1..=3 {
        let [plain, found] = [&QUICK, &opens].map(|model| {
            let fit = fitted(&[(&plan, &measured_of(model, &plan, seed, |_| false))]);
            fit.joints[0].clone()
        });
        assert!(plain.model.opens_beyond <= 0.0, "{seed}: {plain:?}");
        assert!((found.model.opens_beyond / opens.opens_beyond).ln().abs() < 0.5, "{seed}: {found:?}");
        assert!((found.lag_s.value.unwrap() / QUICK.lag_s()).ln().abs() < 0.1, "{seed}: {found:?}");
        let gain = found.position_gain_1_s.value.unwrap() / QUICK.position_gain_1_s;
        assert!(found.model_holds && gain.ln().abs() < 0.1, "{seed}: {found:?}");
    }
}

#[test]
fn a_filter_of_set_values_is_found_where_it_is_and_nowhere_else() {
    let plan = trial(&["J"]);
    for (seed, filter_s) in [(1, 0.12), (2, 0.25), (3, 0.4)] {
        let filtered = Model { set_value_filter_s: filter_s, ..MODEL };
        let [plain, found] = [&MODEL, &filtered].map(|model| {
            let fit = fitted(&[(&plan, &measured_of(model, &plan, seed, |_| false))]);
            fit.joints[0].clone()
        });
        assert!(plain.set_values_late_s.value.unwrap() <= 0.0, "{seed}: {plain:?}");
        let [low_s, high_s] = found.set_values_late_s.interval.unwrap();
        assert!((low_s..high_s).contains(&filter_s) && high_s < 5.0 * low_s, "{seed}: {found:?}");
        assert!((found.model.feed_forward / MODEL.feed_forward).ln().abs() < 0.1, "{seed}: {found:?}");
        assert!((found.lag_s.value.unwrap() / MODEL.lag_s()).ln().abs() < 0.1, "{seed}: {found:?}");
    }
}

#[test]
fn set_values_that_come_late_are_told_from_a_lag_within_the_loop() {
    let plan = trial(&["J"]);
    for (seed, delay_s) in [(1, 0.1), (2, 0.2), (3, 0.3)] {
        let late = Model { set_value_delay_s: delay_s, ..QUICK };
        let joint = &fitted(&[(&plan, &measured_of(&late, &plan, seed, |_| false))]).joints[0];
        let [low_s, high_s] = joint.set_values_late_s.interval.unwrap();
        assert!((low_s..high_s).contains(&delay_s) && high_s < 5.0 * low_s, "{seed}: {joint:?}");
        let found_s = joint.lag_s.value.unwrap();
        assert!(joint.lag_s.identified && (found_s / QUICK.lag_s()).ln().abs() < 0.15, "{seed}: {joint:?}");
        assert!((joint.model.feed_forward / QUICK.feed_forward).ln().abs() < 0.1, "{seed}: {joint:?}");
    }
}

/// A plan as a moving mean over 0.3 s makes it.
fn averaged(plan: &Series) -> Series {
    let mean = |values: &[f64]| -> Vec<f64> {
        let before = |k: usize| (0..30).map(move |back| values[k.saturating_sub(back)]);
        (0..values.len()).map(|k| before(k).sum::<f64>() / 30.0).collect()
    };
    let track = |sent: &Track| {
        let track = Track::new(sent.name(), sent.t_s().to_vec(), mean(sent.position()), &[]).unwrap();
        track.with_velocity(mean(sent.velocity().unwrap())).unwrap()
    };
    Series { tracks: plan.tracks.iter().map(track).collect() }
}

#[test]
fn intervals_behind_a_filter_of_another_form_hold_the_truth_or_nothing_is_claimed() {
    let plan = trial(&["J"]);
    for seed in 1..=3 {
        let measured = measured_of(&QUICK, &averaged(&plan), seed, |_| false);
        let joint = &fitted(&[(&plan, &measured)]).joints[0];
        assert!(joint.model.set_value_filter_s > 0.0, "{seed}: {joint:?}");
        for (found, truth) in [
            (joint.lag_s, QUICK.lag_s()),
            (joint.position_gain_1_s, QUICK.position_gain_1_s),
            (joint.feed_forward, QUICK.feed_forward),
            (joint.dead_band_rad_s, QUICK.dead_band_rad_s + QUICK.hysteresis_rad_s + QUICK.stiction_rad_s),
        ] {
            let holds = found.interval.is_some_and(|[low, high]| (low..=high).contains(&truth));
            assert!(holds || !found.identified, "{seed}: {truth} {found:?}");
        }
        assert!(joint.lag_s.identified, "{seed}: {joint:?}");
    }
}

#[test]
fn a_play_that_is_not_the_usual_one_is_no_dead_band() {
    let plan = trial(&["J"]);
    for (seed, width_deg) in [(1, 0.0), (2, 0.0), (1, 0.4), (3, 0.4)] {
        let truth =
            Model { backlash_rad: width_deg * DEGREE_RAD, dead_band_rad_s: 0.2 * DEGREE_RAD, ..QUICK };
        let found = joint_of(&truth, &plan, seed);
        let off_deg = (found.model.backlash_rad / DEGREE_RAD - width_deg).abs();
        assert!(off_deg < 0.02, "{seed}: {found:?}");
        let [low, high] = found.dead_band_rad_s.interval.unwrap();
        let leaves_rest_rad_s = truth.dead_band_rad_s + truth.hysteresis_rad_s + truth.stiction_rad_s;
        assert!((low..=high).contains(&leaves_rest_rad_s), "{seed}: {found:?}");
    }
    let usual = joint_of(&QUICK, &plan, 1);
    assert!((usual.model.backlash_rad - QUICK.backlash_rad).abs() < 1e-9, "{usual:?}");
}
