//! What holds of fleets most of whose machines change alike.

use super::{
    drift::tests::{fleet, found, judged_alike},
    joint_trend::JointTrend,
};

/// What is found of twelve machines, over some fleets: each changes by its own part of so much, on its own day of three, s; the
/// last three do not.
fn of_fleets(by_s: f64) -> Vec<JointTrend> {
    let more = |machine: u32, day: u32| {
        let part = if machine < 9 { 0.6 + 0.1 * f64::from(machine) } else { 0.0 };
        if day >= 6 + machine % 3 { part * by_s } else { 0.0 }
    };
    (0..5).flat_map(|seed| found(&fleet(seed, 12, |machine, day, _| (more(machine, day), "p")))).collect()
}

fn is_sound(trend: &JointTrend) -> bool {
    ["M9", "M10", "M11"].contains(&trend.machine.as_str())
}

#[test]
fn where_most_machines_changed_the_others_did_nothing_and_where_they_became_better_none_grows() {
    for by_s in [0.12, -0.12] {
        let found = of_fleets(by_s);
        let sound: Vec<&JointTrend> = found.iter().filter(|trend| is_sound(trend)).collect();
        assert!(sound.is_empty(), "{by_s}: {sound:?}");
        let grown = found.iter().filter(|trend| by_s < 0.0 && trend.growth_per_day() > 0.0).count();
        assert_eq!(grown, 0, "{by_s}: {found:?}");
    }
}

#[test]
fn what_most_machines_did_within_days_is_told_and_what_a_few_did_is_not() {
    // Dead times of some 0.23 s.
    let of = |stepping: u32, by_s: f64| {
        let more = move |machine: u32, day: u32, _: usize| {
            (if machine < stepping && day >= 6 + machine % 3 { by_s } else { 0.0 }, "p")
        };
        judged_alike(&fleet(1, 12, more))
    };
    for by_s in [0.1, -0.1] {
        let found = of(10, by_s);
        let [one] = found.as_slice() else { panic!("{found:?}") };
        assert!((one.change - by_s / 0.23).abs() < 0.15 && one.of == 12, "{one:?}");
        assert_eq!(
            (one.shared_by, &one.others[..]),
            (10, &["M10".to_owned(), "M11".to_owned()][..]),
            "{one:?}"
        );
        assert!(one.after.as_deref().is_some_and(|at| at < "2024-10-11"), "{one:?}");
    }
    assert_eq!(of(3, 0.1), [], "of three");
    assert_eq!(of(0, 0.0), [], "of none");
}
