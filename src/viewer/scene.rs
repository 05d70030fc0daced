//! One run: its arms, curves, lanes of starts, words and front.

use rerun::{Color, RecordingStream, SeriesLines, StateConfiguration};

use super::{
    ViewError, arm,
    arm::Look,
    color,
    stream::{Stream, Values, part},
};
use crate::{
    replay::{Answer, Kind, Transition},
    series::{Pair, Track},
    units::degrees_from_radians,
    workflow::view::Scene,
};

/// States of a joint, with their labels and colours.
const STATES: [(&str, [u8; 3]); 3] =
    [("follows", [70, 75, 85]), ("waits", [239, 83, 80]), ("settles", [237, 175, 60])];

/// Sends the parts that do not change with time and returns the streams that do. `run` is the index of the
/// run and the number of runs.
pub(super) fn send_static(
    rec: &RecordingStream,
    scene: &Scene,
    run: (usize, usize),
) -> Result<Vec<Stream>, ViewError> {
    let root = root(scene);
    let several = run.1 > 1;
    let mut streams = Vec::new();
    if let Some(moving) = &scene.arm {
        let measured = !moving.measured.poses.is_empty();
        if measured {
            let look = Look::Measured(run.0);
            streams.extend(arm::send(rec, &format!("{root}/measured"), moving, &moving.measured, look)?);
        }
        // Of several runs one ghost is enough. Solid, if there is nothing else to see.
        if !moving.planned.poses.is_empty() && (run.0 == 0 || !measured) {
            let look = if measured { Look::Planned } else { Look::Measured(run.0) };
            streams.extend(arm::send(rec, &format!("{root}/planned"), moving, &moving.planned, look)?);
        }
    }
    for (index, track) in scene.planned.tracks.iter().enumerate() {
        let joint = joint(scene, track.name());
        let named = |what: &str| if several { format!("{} {what}", scene.name) } else { what.to_owned() };
        curve(rec, &format!("{joint}/planned"), &named("planned"), color::planned(run.0), 1.2)?;
        streams.push(angles(format!("{joint}/planned"), track));
        if let Some(measured) = scene.measured.track(track.name()) {
            curve(rec, &format!("{joint}/measured"), &named("measured"), color::run(run.0), 2.5)?;
            streams.push(angles(format!("{joint}/measured"), measured));
        }
        if let Some(pair) = scene.pairs.iter().find(|pair| pair.name == track.name()) {
            let (name, colour) = if several {
                (scene.name.as_str(), color::run(run.0))
            } else {
                (track.name(), color::joint(index))
            };
            curve(rec, &format!("{joint}/error"), name, colour, 1.6)?;
            streams.push(errors(format!("{joint}/error"), pair));
        }
        if scene.transitions.iter().any(|t| t.joint == track.name()) {
            let lane = lane(scene, track.name(), several);
            let configuration = StateConfiguration::new()
                .with_values(STATES.map(|(state, _)| state))
                .with_labels(STATES.map(|(state, _)| state))
                .with_colors(STATES.map(|(_, [r, g, b])| Color::from_rgb(r, g, b)));
            rec.log_static(lane.as_str(), &configuration)?;
            streams.push(states(lane, scene, track.name()));
        }
    }
    streams.push(words(format!("{root}/log"), scene, several));
    Ok(streams)
}

pub(super) fn root(scene: &Scene) -> String {
    format!("/{}", part(&scene.name))
}

pub(super) fn joint(scene: &Scene, name: &str) -> String {
    format!("{}/joints/{}", root(scene), part(name))
}

/// The entity of a joint's starts: of several runs those of one joint beside each other.
pub(super) fn lane(scene: &Scene, name: &str, several: bool) -> String {
    let joint = format!("/starts/{}", part(name));
    if several { format!("{joint}/{}", part(&scene.name)) } else { joint }
}

fn curve(rec: &RecordingStream, path: &str, name: &str, colour: Color, width: f32) -> Result<(), ViewError> {
    let lines = SeriesLines::new().with_names([name]).with_colors([colour]).with_widths([width]);
    Ok(rec.log_static(path, &lines)?)
}

fn angles(path: String, track: &Track) -> Stream {
    let values = track.position().iter().map(|q| degrees_from_radians(*q)).collect();
    Stream { path, t_s: track.t_s().to_vec(), values: Values::Scalars(values) }
}

fn errors(path: String, pair: &Pair) -> Stream {
    let values = pair.planned.iter().zip(&pair.measured);
    let values = values.map(|(planned, measured)| degrees_from_radians(planned - measured)).collect();
    Stream { path, t_s: pair.t_s.to_vec(), values: Values::Scalars(values) }
}

/// A joint waits from the planned onset to the measured one, and settles until its error stays in the band.
fn states(path: String, scene: &Scene, joint: &str) -> Stream {
    let first_s = scene.planned.track(joint).and_then(|t| t.t_s().first().copied()).unwrap_or(0.0);
    let mut changes = vec![(first_s, "follows")];
    for found in scene.transitions.iter().filter(|t| t.joint == joint) {
        let end_s = found.window_s[1];
        changes.push((found.planned_onset_s, "waits"));
        if let Some(at_s) = found.measured_onset_s.filter(|at_s| *at_s < end_s) {
            changes.push((at_s, "settles"));
        }
        let settled_s = found.settling_time_s.map_or(end_s, |after_s| found.planned_onset_s + after_s);
        changes.push((settled_s.min(end_s), "follows"));
    }
    changes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (t_s, states) = changes.into_iter().unzip();
    Stream { path, t_s, values: Values::States(states) }
}

fn words(path: String, scene: &Scene, several: bool) -> Stream {
    let whose = if several { format!("{}: ", scene.name) } else { String::new() };
    let mut said: Vec<(f64, (String, bool))> = scene
        .transitions
        .iter()
        .map(|found| (found.planned_onset_s, (format!("{whose}{}", sentence(found)), late(found))))
        .collect();
    let doubts = scene.remarks.as_slice().iter();
    said.extend(doubts.map(|remark| {
        (0.0, (format!("{whose}{} x{}: {}", remark.code.name(), remark.count, remark.message), true))
    }));
    said.sort_by(|a, b| a.0.total_cmp(&b.0));
    let timed =
        |(t_s, (text, warning)): (f64, (String, bool))| (t_s, (format!("{t_s:.2} s  {text}"), warning));
    let (t_s, texts) = said.into_iter().map(timed).unzip();
    Stream { path, t_s, values: Values::Texts(texts) }
}

/// Whether a start was never answered.
fn late(found: &Transition) -> bool {
    found.answer == Answer::Never
}

fn sentence(found: &Transition) -> String {
    let kind = match found.kind {
        Kind::Start => "start",
        Kind::Reversal => "reversal",
    };
    let peak_deg = degrees_from_radians(found.peak_error);
    if let Some(delay_s) = found.onset_delay_s {
        return format!(
            "{} {kind}: follows after {:.0} ms, peak error {peak_deg:.2}°",
            found.joint,
            1e3 * delay_s
        );
    }
    let follows = match found.answer {
        Answer::Creeps => "creeps or is under way",
        Answer::Unclear => "moves too little to tell whether it follows",
        Answer::Timed | Answer::Never => "never follows",
    };
    format!("{} {kind}: {follows}, peak error {peak_deg:.2}°", found.joint)
}
