//! The study as a table.

use std::fmt::Write;

use super::{Cell, Score};

/// Change of the mean transition peak, in %, of the worst, of the root mean square error, and the largest ratio of
/// accelerations, all to the plain plan; a line a cell, a column a run.
pub fn table(cells: &[Cell]) -> String {
    let mut text = String::from(
        "machine, plan, seed: mean peak of the plain plan, deg; then by run: mean peak, worst peak, rms in % of change; \
         ratio of accelerations (plain plan again)\n",
    );
    for cell in cells {
        let change = |now: f64, then: f64| 100.0 * (now / then - 1.0);
        let one = |run: &Score| {
            format!(
                "  {:+.0} {:+.0} {:+.0} {:.2}",
                change(run.mean_peak_deg, cell.plain.mean_peak_deg),
                change(run.worst_peak_deg, cell.plain.worst_peak_deg),
                change(run.rms_deg, cell.plain.rms_deg),
                run.acceleration_ratio(&cell.plain)
            )
        };
        let runs: String = cell.runs.iter().map(one).collect();
        let again = cell.again.acceleration_ratio(&cell.plain);
        let _ = writeln!(
            text,
            "{}, {}, {}: {:.3}{runs} ({again:.2})",
            cell.machine, cell.job, cell.seed, cell.plain.mean_peak_deg
        );
    }
    let runs = cells.iter().map(|cell| cell.runs.len()).min().unwrap_or_default();
    for run in 0..runs {
        let mut changes: Vec<f64> = cells
            .iter()
            .map(|cell| 100.0 * (cell.runs[run].mean_peak_deg / cell.plain.mean_peak_deg - 1.0))
            .collect();
        changes.sort_by(f64::total_cmp);
        let worst = changes.last().copied().unwrap_or_default();
        let median = changes[changes.len() / 2];
        let _ = writeln!(text, "run {}: median {median:+.0} %, worst {worst:+.0} %", run + 1);
    }
    text
}
