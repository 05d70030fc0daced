//! The study as a table.

use std::fmt::Write;

use super::{Cell, Score};

/// A mean peak that came within these shares of the promised one was promised well.
const WELL: std::ops::RangeInclusive<f64> = 0.8..=1.25;

/// Change of the mean transition peak, in %, of the worst, of the root mean square error, and the largest ratio of
/// accelerations, all to the plain plan; a line a cell, a column a run; then what that comes to.
pub fn table(cells: &[Cell]) -> String {
    let mut text = String::from(
        "machine, plan, seed: mean peak of the plain plan, deg; then by run: mean peak, worst peak, rms in % of change; \
         ratio of accelerations, promised and measured mean peak, deg; (plain plan again)\n",
    );
    for cell in cells {
        let one = |(k, run): (usize, &Score)| {
            let promised = cell.promised_deg.get(k).copied().flatten();
            let promised = promised.map_or(String::new(), |[mean, _]| format!(" {mean:.3}"));
            format!(
                "  {:+.0} {:+.0} {:+.0} {:.2}{promised} {:.3}",
                change(run.mean_peak_deg, cell.plain.mean_peak_deg),
                change(run.worst_peak_deg, cell.plain.worst_peak_deg),
                change(run.rms_deg, cell.plain.rms_deg),
                run.acceleration_ratio(&cell.plain),
                run.measured_mean_peak_deg,
            )
        };
        let runs: String = cell.runs.iter().enumerate().map(one).collect();
        let again = cell.again.acceleration_ratio(&cell.plain);
        let _ = writeln!(
            text,
            "{}, {}, {}: {:.3}{runs} ({again:.2})",
            cell.machine, cell.job, cell.seed, cell.plain.mean_peak_deg
        );
    }
    let runs = cells.iter().map(|cell| cell.runs.len()).min().unwrap_or_default();
    machines(cells, runs, &mut text);
    for run in 0..runs {
        summary(cells, run, &mut text);
    }
    let again = sorted(cells.iter().map(|cell| cell.again.acceleration_ratio(&cell.plain)));
    let _ = writeln!(
        text,
        "plain plan again: acceleration {:.2} in the median, {:.2} at 90 %",
        at(&again, 0.5),
        at(&again, 0.9)
    );
    text
}

/// In % of the one before.
fn change(now: f64, then: f64) -> f64 {
    100.0 * (now / then - 1.0)
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

/// A quantile of sorted values; NaN of none.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index")]
fn at(sorted: &[f64], share: f64) -> f64 {
    let last = sorted.len().saturating_sub(1);
    sorted.get((share * last as f64).round() as usize).copied().unwrap_or(f64::NAN)
}

/// Of each machine the mean change of the mean peak, by run.
fn machines(cells: &[Cell], runs: usize, text: &mut String) {
    let mut names: Vec<&str> = cells.iter().map(|cell| cell.machine.as_str()).collect();
    names.dedup();
    for name in names {
        let own: Vec<&Cell> = cells.iter().filter(|cell| cell.machine == name).collect();
        let mean = |run: usize| {
            own.iter().map(|cell| change(cell.runs[run].mean_peak_deg, cell.plain.mean_peak_deg)).sum::<f64>()
                / own.len() as f64
        };
        let by_run = (0..runs).map(|run| format!("{:+.0}", mean(run))).collect::<Vec<_>>().join(" ");
        let _ = writeln!(text, "{name}: mean peak {by_run} %");
    }
}

/// Mean peak that came, and what was promised of it, deg.
type Came = (f64, [f64; 2]);

fn summary(cells: &[Cell], run: usize, text: &mut String) {
    let peaks = sorted(cells.iter().map(|c| change(c.runs[run].mean_peak_deg, c.plain.mean_peak_deg)));
    let rms = sorted(cells.iter().map(|c| change(c.runs[run].rms_deg, c.plain.rms_deg)));
    let acceleration = sorted(cells.iter().map(|c| c.runs[run].acceleration_ratio(&c.plain)));
    let end = sorted(cells.iter().map(|c| c.runs[run].end_error_deg - c.plain.end_error_deg));
    let _ = writeln!(
        text,
        "run {}: mean peak {:+.0} % in the median, {:+.0} at worst; rms {:+.0} and {:+.0} %; acceleration {:.2} in the \
         median, {:.2} at 90 %; end error {:+.2} to {:+.2} deg",
        run + 1,
        at(&peaks, 0.5),
        at(&peaks, 1.0),
        at(&rms, 0.5),
        at(&rms, 1.0),
        at(&acceleration, 0.5),
        at(&acceleration, 0.9),
        at(&end, 0.0),
        at(&end, 1.0),
    );
    let came = |cell: &Cell| {
        Some((cell.runs[run].measured_mean_peak_deg, cell.promised_deg.get(run).copied().flatten()?))
    };
    let came: Vec<Came> = cells.iter().filter_map(came).collect();
    if came.is_empty() {
        return;
    }
    let share = |of: &dyn Fn(&Came) -> bool| {
        100.0 * came.iter().filter(|one| of(one)).count() as f64 / came.len() as f64
    };
    let ratios = sorted(came.iter().map(|(came, [mean, _])| came / mean));
    let _ = writeln!(
        text,
        "  measured / promised {:.2} in the median, within 0.8 to 1.25 in {:.0} % of {} runs; below the 90 % bound in {:.0} %",
        at(&ratios, 0.5),
        share(&|(came, [mean, _])| WELL.contains(&(came / mean))),
        came.len(),
        share(&|(came, [_, bound])| came <= bound),
    );
}
