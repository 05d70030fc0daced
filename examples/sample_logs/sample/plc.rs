//! A run as the trace of a PLC: one row every other cycle, to the millisecond.

use std::fmt::Write as _;

use hydrotrace::units::degrees_from_radians;

use super::{recorder::START_NS, run::Run};

const LONG_S: f64 = 20.0;

/// The first part of a run. Its first stamp is the same as that of a log, as a date.
pub(crate) fn trace(run: &Run) -> String {
    let names = run.joint_names();
    let mut text = String::from("# PLC trace, one row every second cycle\n\"Zeitstempel\"");
    for name in &names {
        let _ = write!(text, ";\"{name} soll\";\"{name} ist\"");
    }
    text.push('\n');
    text.push_str(&";°;°".repeat(names.len()));
    text.push('\n');
    for cycle in run.cycles.iter().step_by(2).take_while(|cycle| cycle.t_s < LONG_S) {
        // The run starts at 15:06:40 and does not last until the full hour.
        let ms = 40_000 + (cycle.stamp_ns - START_NS + 500_000) / 1_000_000;
        let (minute, second, ms) = (6 + ms / 60_000, ms / 1000 % 60, ms % 1000);
        let _ = write!(text, "15.06.2025 15:{minute:02}:{second:02},{ms:03}");
        for (planned_rad, measured_rad) in cycle.planned_rad.iter().zip(&cycle.measured_rad) {
            for rad in [planned_rad, measured_rad] {
                let number = format!("{:.4}", degrees_from_radians(*rad)).replace('.', ",");
                let _ = write!(text, ";{number}");
            }
        }
        text.push('\n');
    }
    text
}
