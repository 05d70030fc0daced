//! Finds what makes a run no answer to its plan: the machine was stopped, or moved at another time.

use super::{other_time, stopped};
use crate::{
    remark::{Code, Remarks},
    series::Series,
};

/// Remarks the first that holds: a stop of a run that was in time, another time, a stop of one that was not.
pub(super) fn of_sides(planned: &Series, measured: &Series, remarks: &mut Remarks) {
    let stops = stopped::stops(planned, measured);
    let stop = |stop: &stopped::Stop| (Code::Stopped, stop.message.clone());
    let in_time = stops.iter().find(|stop| stop.in_time).map(stop);
    let found = in_time
        .or_else(|| other_time::message(planned, measured).map(|message| (Code::OtherTime, message)))
        .or_else(|| stops.first().map(stop));
    if let Some((code, message)) = found {
        remarks.add(code, 1, message);
    }
}
