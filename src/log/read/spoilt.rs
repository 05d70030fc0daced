//! Finds what makes a run no answer to its plan: the machine was stopped, or moved at another time.

use super::{other_time, recording::Command, stopped};
use crate::{
    log::options::ReadOptions,
    remark::{Code, Remarks},
    series::Series,
};

/// Remarks the first that holds: a stop of a run that was in time, another time, a stop of one that was not. What was
/// sent may run ahead of the plan, and the joints with it: they are at another time if they are so by the command, too. Gives the
/// time of a stop that is remarked, s.
pub(super) fn of_sides(
    [planned, measured]: [&Series; 2],
    command: Option<&Command>,
    options: &ReadOptions,
    remarks: &mut Remarks,
) -> Option<[f64; 2]> {
    let one_clock = options.measured_delay_ns == Some(0);
    let mut stops = stopped::stops(planned, measured);
    // What was sent must go on, too, or stand itself while the plan goes on.
    if let Some(Command { series: sent, .. }) = command
        && stopped::stops(sent, measured).is_empty()
        && stopped::stops(planned, sent).is_empty()
    {
        stops.clear();
    }
    // Joints that are late rest late.
    if !stops.is_empty()
        && command.is_none()
        && let Some(behind) = other_time::Behind::of(planned, measured)
    {
        stops.retain(|stop| !behind.grows_outside(stop.stood_s));
    }
    let in_time = stops.iter().find(|stop| stop.in_time);
    if in_time.is_none()
        && let Some(message) = other_time([planned, measured], command, one_clock)
    {
        remarks.add(Code::OtherTime, 1, message);
        return None;
    }
    let stop = in_time.or(stops.first())?;
    remarks.add(Code::Stopped, 1, stop.message.clone());
    Some(stop.stood_s)
}

fn other_time(
    [planned, measured]: [&Series; 2],
    command: Option<&Command>,
    one_clock: bool,
) -> Option<String> {
    let message = other_time::message(planned, measured, one_clock)?;
    let by_command = |command: &Command| other_time::message(&command.series, measured, one_clock).is_some();
    command.is_none_or(by_command).then_some(message)
}
