//! The README of the sample logs, with the truth as tables.

use std::{error::Error, fmt::Write as _};

use hydrotrace::units::degrees_from_radians;

use super::{
    SampleLog, hydraulic,
    hydraulic::PlantLog,
    machine::{INTEGRAL_GAIN_1_S2, JOINTS, JUMP_1_S},
    plan::DWELL_S,
    recorder::{COUNT_RAD, JITTER_S, LOSS, NOISE_RAD, START_NS},
};

const HEAD: &str = "\
# Sample logs

Small logs of two simulated machines whose parameters (the truth) are known. This command writes the logs and this file:

    cargo run --release --example sample_logs -- sample-logs

The same source gives the same bytes; `tests/it/sample_logs.rs` compares them. Each MCAP log carries its truth as metadata,
named `truth`, or `hydrotrace.plant` for the hydraulic arm. `crane` holds no log: a loader crane whose last joint slides, its
cylinders and a task, to plan.
";

const COLUMNS: &str = "
## Columns

Asked: the instant at which the plan's speed exceeds 0.05 deg/s. Late (dead time): from there until the joint leaves
standstill. Peak: largest plan minus angle, without noise, until the next start, 4 s at most. Offset: angle minus plan
before the first start. Every start is listed, also if a gap or a cut hides it in the log.
";

const MACHINE: &str = "
## The machine of the other logs

A six-joint arm picks up a curtain-wall panel and installs it: moves of 3 to 4 s from rest to rest
(minimum-jerk quintics), with reversals. It is **not the hydraulic arm**: it has no oil and no load, and its joints do
not influence each other. A joint moves by these rules:

* it leaves standstill when its dead time has passed since the plan's speed exceeded 0.05 deg/s and its command
  has left the dead band of the valve; then it jumps: it starts with the speed that the valve lets through,
  plus {JUMP} 1/s times the distance that the plan moved while the joint stuck;
* command = planned speed + gain x error + integral; the integral works only while the plan moves;
* the speed follows the opening of the valve with a first-order lag;
* it stops where the command enters the dead band and stays there, up to 0.2 deg off.

";

/// The whole text.
pub(crate) fn text(logs: &[SampleLog], plant: &[PlantLog]) -> Result<String, Box<dyn Error>> {
    let mut text = HEAD.to_owned();
    summary(&mut text, logs, plant);
    text.push_str(&hydraulic::sections(plant)?);
    text.push_str(&MACHINE.replace("{JUMP}", &JUMP_1_S.to_string()));
    machine(&mut text);
    text.push_str(COLUMNS);
    for log in logs {
        starts(&mut text, log);
    }
    Ok(text)
}

fn summary(text: &mut String, logs: &[SampleLog], plant: &[PlantLog]) {
    text.push_str("\n| log | bytes | seed | what it holds |\n|---|---|---|---|\n");
    for log in logs {
        line(text, &format!("| `{}` | {} | {} | {} |", log.name, log.bytes.len(), log.run.seed, log.story));
    }
    for row in hydraulic::rows(plant) {
        line(text, &row);
    }
}

fn machine(text: &mut String) {
    text.push_str(
        "| joint | dead time up, s | down, s | lag, s | dead band, deg/s | gain, 1/s |\n|---|---|---|---|---|---|\n",
    );
    for (index, joint) in JOINTS.iter().enumerate() {
        let [up_s, down_s] = joint.dead_time_s;
        let dead_band_deg_s = degrees_from_radians(joint.dead_band_rad_s);
        line(
            text,
            &format!(
                "| joint_{} | {up_s:.2} | {down_s:.2} | {:.3} | {dead_band_deg_s:.2} | {:.1} |",
                index + 1,
                joint.lag_s,
                joint.gain_1_s
            ),
        );
    }
    let [from_s, to_s] = DWELL_S;
    line(
        text,
        &format!(
            "
Integral gain {INTEGRAL_GAIN_1_S2} 1/s². The plan rests from {from_s} to {to_s} s, while the panel is gripped.
The control loop runs at 100 Hz with {:.1} ms jitter (1 sigma); {:.1} % of the messages of each joint topic are
lost. Encoders: noise {:.3} deg (1 sigma), then rounded to counts of {:.5} deg (16 bit). Angles and speeds are
held as `f32`. Times below count from the first stamp, {START_NS} ns.",
            JITTER_S * 1e3,
            LOSS * 1e2,
            degrees_from_radians(NOISE_RAD),
            degrees_from_radians(COUNT_RAD),
        ),
    );
}

fn starts(text: &mut String, log: &SampleLog) {
    line(text, &format!("\n## {}\n", log.name));
    for (key, value) in &log.defects {
        line(text, &format!("* {}: {value}", key.replace('_', " ")));
    }
    if !log.defects.is_empty() {
        text.push('\n');
    }
    text.push_str(
        "| joint | offset, deg | starts: asked s, late s, peak deg |
|---|---|---|
",
    );
    for (place, name) in log.run.joint_names().iter().enumerate() {
        let starts: Vec<String> = log.run.motions[place]
            .starts
            .iter()
            .map(|start| {
                let late_s = start.leaves_s - start.asked_s;
                let peak_deg = degrees_from_radians(start.peak_rad);
                format!("{:.3}, {late_s:.3}, {peak_deg:+.2}", start.asked_s)
            })
            .collect();
        let starts = if starts.is_empty() { "never asked".to_owned() } else { starts.join("; ") };
        let offset_deg = degrees_from_radians(log.run.offsets_rad[place]);
        line(text, &format!("| {name} | {offset_deg:+.3} | {starts} |"));
    }
}

/// Appends a line.
pub(crate) fn line(text: &mut String, line: &str) {
    let _ = writeln!(text, "{line}");
}
