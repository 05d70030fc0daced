//! What the README says of the hydraulic arm and its logs.

use std::error::Error;

use hydrotrace::{
    plant::JointRecord,
    replay::{Rules, replay},
    series::{Pair, Track, align},
    units::degrees_from_radians,
};

use super::super::readme::line;
use super::{PRESET, PlantLog};

const MACHINE: &str = "
## The hydraulic arm

The simulated machine `{PRESET}` of `hydrotrace simulate` around the sample arm: valves with dead time, overlap,
hysteresis and slew, cylinders with oil, friction and play, one pump, a loop at 100 Hz, encoders with noise 0.010 deg
(1 sigma) and 16 bit, 0.5 ms jitter and 0.2 % lost samples ([every number](plant/default.toml)). It is no real machine.
It rests 2 s before and 3 s after its plan. Plan, command and measurement are separate topics; numbers are stored as
`f32`, measured speeds in steps of 2^-16 rad/s. The metadata `hydrotrace.plant` of each log (JSON, SI units) holds the
truth to judge fits by, for the middle of the range of that log's plan and without payload. For `task-1-run.mcap`,
growing / shrinking angles:

| joint | lag, s | dead band, deg/s | speed limit, deg/s | gain | position gain, 1/s | feed-forward |
|---|---|---|---|---|---|---|
";

const COLUMNS: &str = "
Lag: dead time, spool and half a period of the loop. Dead band: speed that the controller must ask for before oil flows.
Gain: speed divided by the speed asked for beyond the dead band; a fit has it in its gains and dead band. There is no
acceleration limit: the response of the oil to a fast spool is no parameter of a fit.

Measured from angles without noise: number of starts and reversals of the plan, peak error after each (mean and
largest), largest distance between command and plan, and lowest pressure of the supply.

| log | starts | mean peak, deg | largest peak, deg | command off plan, deg | supply, MPa |
|---|---|---|---|---|---|
";

/// Rows of the table of logs.
pub(crate) fn rows(logs: &[PlantLog]) -> Vec<String> {
    let row =
        |log: &PlantLog| format!("| `{}` | {} | {} | {} |", log.name, log.bytes.len(), log.seed, log.story);
    logs.iter().map(row).collect()
}

/// The machine and what it did.
pub(crate) fn sections(logs: &[PlantLog]) -> Result<String, Box<dyn Error>> {
    let mut text = MACHINE.replace("{PRESET}", PRESET);
    for joint in logs.iter().take(1).flat_map(|log| &log.outputs.truth.joints) {
        let pair = |of: [f64; 2]| of.map(|x| format!("{:.2}", degrees_from_radians(x))).join(" / ");
        let cells = [
            joint.name.clone(),
            format!("{:.3}", joint.lag_s),
            pair(joint.dead_band_rad_s),
            pair(joint.speed_limit_rad_s),
            joint.gain.map(|gain| format!("{gain:.2}")).join(" / "),
            format!("{:.2}", joint.position_gain_1_s),
            format!("{:.2}", joint.feed_forward),
        ];
        line(&mut text, &format!("| {} |", cells.join(" | ")));
    }
    text.push_str(COLUMNS);
    for log in logs {
        line(&mut text, &did(log)?);
    }
    Ok(text)
}

/// One row on what the joints of a log did.
fn did(log: &PlantLog) -> Result<String, Box<dyn Error>> {
    let record = &log.outputs.record;
    let pair = |(joint, planned): (&JointRecord, &Vec<(f64, f64)>)| -> Result<Pair, Box<dyn Error>> {
        let (angle_rad, speed_rad_s) = planned.iter().copied().unzip();
        let planned =
            Track::new(&joint.name, record.t_s.clone(), angle_rad, &[])?.with_velocity(speed_rad_s)?;
        let exact = Track::new(&joint.name, record.t_s.clone(), joint.true_rad.clone(), &[])?;
        Ok(align(&planned, &exact).ok_or("the truth has no plan")?)
    };
    let pairs = record.joints.iter().zip(&log.outputs.planned).map(pair).collect::<Result<Vec<_>, _>>()?;
    let found = replay(&pairs, &Rules::default());
    let peaks = || found.transitions.iter().map(|t| degrees_from_radians(t.peak_error));
    let both = log.outputs.planned.iter().flatten().zip(log.outputs.command.iter().flatten());
    let off = both.map(|(planned, sent)| degrees_from_radians((planned.0 - sent.0).abs()));
    let supply_pa = record.supply_pa.iter().copied().fold(f64::INFINITY, f64::min);
    Ok(format!(
        "| `{}` | {} | {:.2} | {:.2} | {:.2} | {:.1} |",
        log.name,
        found.transitions.len(),
        peaks().sum::<f64>() / found.transitions.len().max(1) as f64,
        peaks().fold(0.0, f64::max),
        off.fold(0.0, f64::max),
        supply_pa / 1e6,
    ))
}
