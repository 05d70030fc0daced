//! Joints that move while their plans rest.

use hydrotrace::series::JointKind;

use crate::replay::{of, ramp, recorded};

#[test]
fn a_load_that_sinks_while_the_plan_rests_has_a_drift_and_a_joint_that_settles_has_none_that_counts() {
    let t_s: Vec<f64> = (0..4000).map(|k| 0.01 * f64::from(k)).collect();
    let noise = |k: usize| 2e-5 * (((k * 7919) % 101) as f64 / 50.0 - 1.0);
    let found = |off: &dyn Fn(f64) -> f64| {
        let planned: Vec<f64> = t_s.iter().map(|&t| ramp(t, 2.0) - ramp(t, 15.0)).collect();
        let measured =
            (0..).zip(&t_s).map(|(k, &t)| ramp(t, 2.2) - ramp(t, 15.2) + off(t) + noise(k)).collect();
        let run = of(&recorded(t_s.clone(), planned, measured, std::iter::once(0..4000).collect()));
        let drift = run.joints[0].rest_drift.unwrap();
        (drift, drift.counts(run.rules.sizes(JointKind::Turns)))
    };
    for (sinks_rad_s, told) in [(-5e-4, true), (5e-4, true), (0.0, false), (3e-7, false)] {
        let (drift, counts) = found(&|t| sinks_rad_s * t);
        let [low, high] = drift.interval.unwrap();
        assert!(low <= sinks_rad_s && sinks_rad_s <= high, "{sinks_rad_s}: {drift:?}");
        assert_eq!(counts, told, "{sinks_rad_s}: {drift:?}");
    }
    // It settles slowly after each move, the other way after the other.
    let tail = |since_s: f64| if since_s > 0.0 { 3e-3 * (-since_s / 1.5).exp() } else { 0.0 };
    let (drift, counts) = found(&|t| tail(t - 18.2) - tail(t - 5.2));
    assert!(!counts, "{drift:?}");
}
