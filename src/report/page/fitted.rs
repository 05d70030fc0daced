//! What a fit says of the machine: its numbers with their intervals.

use maud::{Markup, html};

use super::parts::table;
use crate::{
    fit::{Estimated, Fit, JointFit},
    report::{NONE, Sheet, deg, ms},
};

pub(super) fn fitted(fit: &Fit) -> Markup {
    let rows = fit.joints.iter().map(row).collect();
    let head = vec![
        "joint",
        "lag ms",
        "dead band deg/s",
        "gain 1/s",
        "speed + deg/s",
        "speed - deg/s",
        "accel + deg/s2",
        "accel - deg/s2",
        "held-out R2",
    ];
    html! {
        p {
            "Numbers of each joint's closed loop with their 95 % intervals. A limit that the joint never reached is given as \
             at least what it did reach; a number in brackets is held by what was known beforehand."
        }
        (table(&Sheet { head, left: 1, rows }))
        p { (format!("Nine of ten held-out peaks lay below {:.2} times the predicted ones.", fit.peak_margin)) }
        @if !fit.left_out.is_empty() { p { "Not fitted, hardly moved: " (fit.left_out.join(", ")) } }
    }
}

fn row(joint: &JointFit) -> Vec<String> {
    let plain = |value: f64| format!("{value:.2}");
    vec![
        joint.name.clone(),
        cell(&joint.lag_s, ms),
        cell(&joint.dead_band_rad_s, deg),
        cell(&joint.position_gain_1_s, plain),
        cell(&joint.speed_limit_growing_rad_s, deg),
        cell(&joint.speed_limit_shrinking_rad_s, deg),
        cell(&joint.acceleration_limit_growing_rad_s2, deg),
        cell(&joint.acceleration_limit_shrinking_rad_s2, deg),
        plain(joint.held_out_r2),
    ]
}

fn cell(number: &Estimated, show: fn(f64) -> String) -> String {
    let interval =
        number.interval.map_or(String::new(), |[low, high]| format!(" ({}..{})", show(low), show(high)));
    match (number.value, number.lower_bound) {
        (Some(value), _) if number.identified => format!("{}{interval}", show(value)),
        (Some(value), _) => format!("[{}{interval}]", show(value)),
        (None, Some(least)) => format!("at least {}", show(least)),
        (None, None) => NONE.to_owned(),
    }
}
