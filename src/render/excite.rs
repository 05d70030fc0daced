//! What an identification run does.

use std::path::Path;

use super::kit::{Document, Id, NONE, Section, Sentence, Table, counted};
use crate::{units::degrees_from_radians, workflow::excite::Excited};

/// Speed above which most hydraulic joints do not follow, deg/s.
const FAST_DEG_S: f64 = 30.0;

/// An identification run, for people.
pub(crate) fn document(excited: &Excited, file: &Path) -> Document {
    let number = |rad: f64| format!("{:.1}", degrees_from_radians(rad));
    let strokes: Vec<String> = excited
        .excitation
        .ramps
        .iter()
        .map(|ramp| format!("+-{} deg at {} deg/s", number(ramp.travel_rad), number(ramp.speed_rad_s)))
        .collect();
    let rows = excited.joints.iter().map(|joint| {
        let sent = excited.command.track(&joint.name).map_or(&[][..], |track| track.position());
        let least = sent.iter().copied().fold(f64::INFINITY, f64::min);
        let most = sent.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut row = vec![joint.name.clone(), number(joint.home_rad), number(least), number(most)];
        row.extend(joint.range_rad.map(|end| if end.is_finite() { number(end) } else { NONE.into() }));
        row
    });
    let title = format!(
        "Identification run of {}, {:.0} s, in {}",
        counted(excited.joints.len(), "joint"),
        excited.duration_s(),
        file.display()
    );
    let what = format!("The joints move one after the other: {}.", strokes.join("; "));
    let numbers = ["home deg", "sent from", "to", "allowed from", "to"];
    let longest_rad = excited.excitation.ramps.iter().map(|ramp| ramp.travel_rad).fold(0.0, f64::max);
    let short: Vec<&str> = excited
        .joints
        .iter()
        .filter(|joint| joint.range_rad.iter().any(|end| (end - joint.home_rad).abs() < longest_rad - 1e-9))
        .map(|joint| joint.name.as_str())
        .collect();
    let short = (!short.is_empty()).then(|| {
        Sentence::finding(format!(
            "The range of {} is too near for some: these strokes go to one side only, or no farther than it allows.",
            short.join(", ")
        ))
    });
    let fast = (degrees_from_radians(excited.fastest_rad_s()) > FAST_DEG_S).then(|| {
        Sentence::advice(
            "The fast strokes exceed the speed of most machines, to show the limits; --max-speed-deg-s slows them.",
        )
    });
    let beyond: Vec<String> = excited
        .beyond
        .iter()
        .map(|(joint, [sent, allowed])| format!("{joint} {} of {} deg/s", number(*sent), number(*allowed)))
        .collect();
    let beyond = (!beyond.is_empty()).then(|| {
        Sentence::advice(format!(
            "Limits of the task that they exceed: {}. If the machine must keep them, send no joint faster: \
             --max-speed-deg-s.",
            beyond.join(", ")
        ))
    });
    let section = Section::plain(Id::SUMMARY, [Sentence::finding(what)])
        .with_all(short)
        .with(Table::new(&["joint"], &numbers, rows))
        .with(Sentence::advice(
            "The arm must stand at home when the run starts. A joint that answers late, or whose loop integrates, runs past \
             the ends that are sent, by 5 deg and more: leave room between them and the stops. Obstacles are not known: \
             keep the area clear.",
        ))
        .with_all(fast)
        .with_all(beyond);
    Document::titled(title).with(section)
}
