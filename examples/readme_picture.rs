//! Draws the README's picture: one start of one joint, from a sample log.
//!
//! `cargo run --release --example readme_picture > docs/start-from-rest.svg`

use std::fmt::Write as _;

use hydrotrace::{
    units::degrees_from_radians,
    workflow::report::{Inputs, run},
};

const WIDTH: f64 = 900.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 24.0;
const ANGLE: (f64, f64) = (64.0, 250.0);
const ERROR: (f64, f64) = (290.0, 390.0);
const FROM_S: f64 = 2.9;
const TO_S: f64 = 4.6;

fn x(t_s: f64) -> f64 {
    LEFT + (t_s - FROM_S) / (TO_S - FROM_S) * (WIDTH - LEFT - RIGHT)
}

/// A polyline of samples inside the picture, scaled from `low..high` to a band.
fn line(points: &[(f64, f64)], (low, high): (f64, f64), (top, bottom): (f64, f64), class: &str) -> String {
    let mut path = String::new();
    for (t_s, value) in points {
        let y = bottom - (value - low) / (high - low) * (bottom - top);
        let _ = write!(path, "{:.1},{y:.1} ", x(*t_s));
    }
    format!("<polyline class='{class}' points='{}'/>\n", path.trim_end())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let inputs = Inputs { logs: vec!["sample-logs/panel-install.mcap".into()], ..Inputs::default() };
    let report = run(&inputs)?;
    let pair = report.pairs.iter().find(|pair| pair.name == "joint_3").ok_or("no joint_3")?;
    let start =
        report.replay.transitions.iter().find(|t| t.joint == "joint_3").ok_or("no start of joint_3")?;
    let (planned_s, measured_s) = (start.planned_onset_s, start.measured_onset_s.ok_or("no answer")?);
    let shown = (0..pair.t_s.len()).filter(|&i| (FROM_S..=TO_S).contains(&pair.t_s[i]));
    let series = |value: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
        shown.clone().map(|i| (pair.t_s[i], degrees_from_radians(value(i)))).collect()
    };
    let planned = series(&|i| pair.planned[i]);
    let measured = series(&|i| pair.measured[i]);
    let error = series(&|i| pair.planned[i] - pair.measured[i]);
    let span = |points: &[(f64, f64)]| {
        let low = points.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(|p| p.1).fold(f64::NEG_INFINITY, f64::max);
        (low - 0.05 * (high - low), high + 0.05 * (high - low))
    };
    let peak = degrees_from_radians(start.peak_error);
    let peak_s = planned_s + start.time_to_peak_s;
    let (low, high) = span(&error);
    let peak_y = ERROR.1 - (peak - low) / (high - low) * (ERROR.1 - ERROR.0);
    let zero_y = ERROR.1 + low / (high - low) * (ERROR.1 - ERROR.0);

    let mut svg = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {WIDTH} 430' font-family='sans-serif' font-size='14'>\n\
         <style>polyline{{fill:none;stroke-width:2.2}} .plan{{stroke:#2563a8}} .joint{{stroke:#d1495b}} \
         .error{{stroke:#4a4a4a}} .axis{{stroke:#b5b5b5;stroke-width:1}} text{{fill:#333}}</style>\n\
         <rect width='{WIDTH}' height='430' fill='#ffffff'/>\n\
         <text x='{LEFT}' y='28' font-size='17' font-weight='bold'>joint_3 leaves rest {:.0} ms after its plan; \
         the error grows to {peak:.2} deg</text>\n",
        1e3 * (measured_s - planned_s)
    );
    let late = x(measured_s) - x(planned_s);
    let _ = writeln!(
        svg,
        "<rect x='{:.1}' y='{}' width='{late:.1}' height='{}' fill='#f6c9cf' opacity='0.75'/>",
        x(planned_s),
        ANGLE.0,
        ERROR.1 - ANGLE.0
    );
    for t in [3.0, 3.5, 4.0, 4.5] {
        let at = x(t);
        let _ =
            writeln!(svg, "<line class='axis' x1='{at:.1}' x2='{at:.1}' y1='{}' y2='{}'/>", ANGLE.0, ERROR.1);
        let _ = writeln!(svg, "<text x='{at:.1}' y='412' text-anchor='middle'>{t:.1} s</text>");
    }
    let _ = writeln!(
        svg,
        "<line class='axis' x1='{LEFT}' x2='{}' y1='{zero_y:.1}' y2='{zero_y:.1}'/>",
        WIDTH - RIGHT
    );
    let angles = span(&[&planned[..], &measured[..]].concat());
    svg += &line(&planned, angles, ANGLE, "plan");
    svg += &line(&measured, angles, ANGLE, "joint");
    svg += &line(&error, (low, high), ERROR, "error");
    let (mid, right) = (f64::midpoint(ANGLE.0, ANGLE.1), x(4.06));
    let _ = write!(
        svg,
        "<text x='{right}' y='{:.0}' style='fill:#2563a8'>planned angle</text>\n\
         <text x='{right}' y='{:.0}' style='fill:#d1495b'>measured angle</text>\n\
         <text x='{:.1}' y='{:.0}' text-anchor='end'>late</text>\n\
         <text x='{right}' y='{:.0}'>error, planned minus measured</text>\n\
         <circle cx='{:.1}' cy='{peak_y:.1}' r='4' fill='#4a4a4a'/>\n\
         <text x='{:.1}' y='{:.1}' text-anchor='middle'>{peak:.2} deg</text>\n</svg>\n",
        mid - 40.0,
        mid - 20.0,
        x(planned_s) - 6.0,
        ANGLE.0 + 16.0,
        ERROR.1 - 22.0,
        x(peak_s),
        x(peak_s),
        peak_y - 9.0,
    );
    print!("{svg}");
    Ok(())
}
