//! A supply whose pressure fell, in words.

use crate::fit::Supply;

/// Pressure before the valves, and what the pump gave.
pub(in crate::render) fn supply(found: &Supply) -> String {
    let bar = |pa: f64| format!("{:.0} bar", 1e-5 * pa);
    let gave = found.flow_m3_s.map_or(String::new(), |[low, _, high]| {
        format!("; all cylinders took {:.1} to {} meanwhile, half of that time", 6e4 * low, litres(high))
    });
    format!(
        "The pump gave less than the joints asked for: the pressure before the valves stands at {} and fell to {}, and was low for {:.1} s \
         of the {:.1} s in which joints moved{gave}.",
        bar(found.standing_pa),
        bar(found.least_pa),
        found.low_s,
        found.moving_s
    )
}

/// A flow, l/min.
pub(in crate::render) fn litres(m3_s: f64) -> String {
    format!("{:.1} l/min", 6e4 * m3_s)
}
