//! Logs that may be parts of one run: each goes on where the one before it ends.

use std::path::PathBuf;

use crate::{
    log::Recording,
    remark::{Code, Remarks},
    series::Track,
    text::shell_argument,
    units::NS_PER_S,
    workflow::same_plan::SAME_RAD,
};

/// A part follows on the one before it within this, s.
const NEXT_S: f64 = 0.25;

/// What is to be said of logs of other plans than the last one's of which the next goes on at once, from rest: parts of one run, or runs
/// without a pause. Those that are cut in motion are told as such.
pub(super) fn remark(
    (paths, names): (&[PathBuf], &[String]),
    observed: &[Recording],
    others: &[String],
    remarks: &mut Remarks,
) {
    for (k, two) in observed.windows(2).enumerate().filter(|(k, _)| others.contains(&names[*k])) {
        if goes_on(&two[0], &two[1]) == Some(true) {
            let message = format!(
                "{} goes on where {} ends, at once: if they are parts of one run, the command is of a part of its task; `hydrotrace join {} -o \
                 whole.mcap` makes one log of them",
                names[k + 1],
                names[k],
                paths.iter().map(shell_argument).collect::<Vec<_>>().join(" ")
            );
            remarks.add(Code::OtherFile, 1, message);
        }
    }
}

/// Whether a run goes on in the next log where it ends, at once.
fn goes_on(run: &Recording, next: &Recording) -> Option<bool> {
    let ([_, ends_s], [begins_s, _]) = (run.measured.span_s()?, next.measured.span_s()?);
    let apart_s = (next.source.epoch_ns - run.source.epoch_ns) as f64 / NS_PER_S + begins_s - ends_s;
    let stays = |track: &Track| {
        let other = next.planned.track(track.name())?;
        let moved = track.held_at(ends_s).position - other.held_at(begins_s).position;
        Some(moved.abs() < 10.0 * SAME_RAD)
    };
    let stays: Vec<bool> = run.planned.tracks.iter().filter_map(stays).collect();
    Some(!stays.is_empty() && (0.0..NEXT_S).contains(&apart_s) && stays.into_iter().all(|stays| stays))
}
