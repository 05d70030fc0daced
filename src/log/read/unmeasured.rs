//! Leaves out what a sensor shows that it did not measure: values that it repeats while its joint moves, and few where no joint goes.

use super::jumps;
use crate::{
    remark::{Code, Remarks},
    series::{Series, seen},
};

/// Leaves it out of each joint that has a plan.
pub(super) fn of_sides(sides: &mut [(&str, &mut Series); 2], remarks: &mut Remarks) {
    let [(_, planned), (_, measured)] = sides;
    for track in &mut measured.tracks {
        let Some(plan) = planned.track(track.name()) else { continue };
        if let Some(own) = jumps::without_excursions(plan, track) {
            let message = format!(
                "values of {} that come back at once from where no joint goes (lost readings): left out",
                track.name()
            );
            remarks.add(Code::Implausible, (track.len() - own.len()) as u64, message);
            *track = own;
        }
        if let Some(own) = seen(plan, track) {
            let message = format!(
                "what the sensor of {} repeats while its joint moves was not measured: left out",
                track.name()
            );
            remarks.add(Code::FrozenSensor, (track.len() - own.len()) as u64, message);
            *track = own;
        }
    }
}
