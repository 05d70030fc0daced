//! What an identification run does.

use std::path::Path;

use super::{
    kit::{Column, Document, Id, NONE, Section, Sentence, Table, counted},
    metric::{Units, on_paper, unit},
};
use crate::{
    fit::{JointRoom, RAMP_S, Ramp},
    math::range,
    replay::Dimension,
    series::JointKind::{self, Slides, Turns},
    units::DEGREE_RAD,
    workflow::excite::Excited,
};

/// Speed above which most hydraulic joints do not follow, rad/s and m/s.
const FAST: [(JointKind, f64, &str); 2] =
    [(Turns, 30.0 * DEGREE_RAD, "--max-speed-deg-s"), (Slides, 0.3, "--max-speed-mm-s")];

/// Room that a joint needs beyond what is sent.
const BEYOND: [(JointKind, f64); 2] = [(Turns, 5.0 * DEGREE_RAD), (Slides, 0.05)];

pub(crate) fn document(excited: &Excited, of_sample: bool, file: &Path) -> Document {
    let has = |kind: JointKind| excited.joints.iter().any(|joint| joint.kind == kind);
    let number = |kind: JointKind, si: f64| format!("{:.1}", on_paper(kind, si));
    let with = |dimension: Dimension, kind: JointKind, si: f64| {
        format!("{} {}", number(kind, si), unit(dimension, kind))
    };
    let strokes = |kind: JointKind| {
        let most = excited.joints.iter().find(|joint| joint.kind == kind)?.most_rad_s;
        let one = |ramp: &Ramp| {
            let speed = ramp.sent_rad_s().min(excited.fastest(kind));
            let [way, speed] = [(Dimension::Position, ramp.travel_rad), (Dimension::Speed, speed)]
                .map(|(dimension, si)| with(dimension, kind, si));
            format!("+-{way} at {speed}")
        };
        Some(excited.excitation.ramps(kind, most).iter().map(one).collect::<Vec<_>>().join("; "))
    };
    let strokes: Vec<String> = [Turns, Slides].into_iter().filter_map(strokes).collect();
    let units = Units::of(excited.joints.iter().map(|joint| joint.kind));
    let rows = excited.joints.iter().map(|joint| {
        let sent = excited.command.track(&joint.name).map_or(&[][..], |track| track.position());
        let [least, most] = range(sent.iter().copied());
        let home = if units.mixed() {
            with(Dimension::Position, joint.kind, joint.home_rad)
        } else {
            number(joint.kind, joint.home_rad)
        };
        let mut row = vec![joint.name.clone(), home, number(joint.kind, least), number(joint.kind, most)];
        let end = |end: f64| if end.is_finite() { number(joint.kind, end) } else { NONE.into() };
        row.extend(joint.range_rad.map(end));
        row
    });
    let title = format!(
        "Identification run of {}{}, {:.0} s, in {}",
        counted(excited.joints.len(), "joint"),
        if of_sample { " of the sample arm (--task or --joint name yours)" } else { "" },
        excited.duration_s(),
        file.display()
    );
    let what = format!(
        "The joints move one after the other, where their ranges have room: {}.",
        strokes.join("; those that slide ")
    );
    let home = units.heading("home", Dimension::Position);
    let numbers = ["sent from", "to", "allowed from", "to"].map(Column::numbers);
    let columns = [Column::words("joint"), Column::numbers(home)].into_iter().chain(numbers);
    let longest_rad = |joint: &JointRoom| {
        let ramps = excited.excitation.ramps(joint.kind, joint.most_rad_s);
        ramps.iter().map(|ramp| ramp.travel_rad).fold(0.0, f64::max)
    };
    let short: Vec<&str> = excited
        .joints
        .iter()
        .filter(|joint| {
            joint.range_rad.iter().any(|end| (end - joint.home_rad).abs() < longest_rad(joint) - 1e-9)
        })
        .map(|joint| joint.name.as_str())
        .collect();
    let short = (!short.is_empty()).then(|| {
        Sentence::finding(format!(
            "The range of {} is too short for some: these go to one side only, the fastest twice as far, or no farther than it allows; the table has what is sent.",
            short.join(", ")
        ))
    });
    let fast = FAST.into_iter().filter(|(kind, most, _)| excited.fastest(*kind) > *most);
    let fast: Vec<&str> = fast.map(|(_, _, option)| option).collect();
    let fast = (!fast.is_empty()).then(|| {
        Sentence::advice(format!(
            "The fast strokes exceed the speed of most machines, to show the limits; {} slows them.",
            fast.join(" or ")
        ))
    });
    let beyond_ends = BEYOND.into_iter().filter(|(kind, _)| has(*kind));
    let beyond_ends: Vec<String> = beyond_ends
        .map(|(kind, room)| format!("{:.0} {}", on_paper(kind, room), unit(Dimension::Position, kind)))
        .collect();
    let section = Section::plain(Id::SUMMARY, [Sentence::finding(what)])
        .with_all(short)
        .with(Table::of(columns, rows))
        .with(Sentence::advice(format!(
            "The arm must stand at home when the run starts. A joint that answers late, or whose loop integrates, runs past \
             the ends that are sent, by {} and more: leave room between them and the stops. Obstacles are not known: \
             keep the area clear.",
            beyond_ends.join(" or ")
        )))
        .with_all(fast)
        .with_all(beyond(excited));
    Document::titled(title).with(section)
}

/// Limits of the task or of the arm that the strokes exceed.
fn beyond(excited: &Excited) -> Vec<Sentence> {
    let of = |limits: &[(String, JointKind, [f64; 2])], dimension: Dimension| {
        let one = |(joint, kind, [sent, allowed]): &(String, JointKind, [f64; 2])| {
            let [sent, allowed] = [sent, allowed].map(|si| format!("{:.1}", on_paper(*kind, *si)));
            format!("{joint} {sent} of {allowed} {}", unit(dimension, *kind))
        };
        (!limits.is_empty()).then(|| limits.iter().map(one).collect::<Vec<_>>().join(", "))
    };
    let slower = [(Turns, "--max-speed-deg-s"), (Slides, "--max-speed-mm-s")].into_iter();
    let slower = slower.filter(|(kind, _)| excited.beyond.iter().any(|(_, own, _)| own == kind));
    let slower: Vec<&str> = slower.map(|(_, option)| option).collect();
    let speeds = of(&excited.beyond, Dimension::Speed).map(|speeds| {
        format!(
            "Limits of the task or of the arm that they exceed: {speeds}. If the machine must keep them, send no joint faster: {}.",
            slower.join(", ")
        )
    });
    let accelerations = of(&excited.sharper, Dimension::Acceleration).map(|accelerations| {
        format!(
            "Strokes take {RAMP_S} s to their speed, to show how joints leave rest. Accelerations of the task or of the arm that this exceeds: \
             {accelerations}; limits of jerk are not kept at all. Send it only where the set values of the machine may step so."
        )
    });
    speeds.into_iter().chain(accelerations).map(Sentence::Advice).collect()
}
