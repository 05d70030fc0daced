//! Replays a run in real time.

use std::{
    thread::sleep,
    time::{Duration, Instant},
};

use rerun::RecordingStream;

use super::{ViewError, stream::Stream};

/// Time between two pieces, s; shorter than the eye notices.
const PERIOD: Duration = Duration::from_millis(25);

/// Sends the rows up to the current instant, `speed` times as fast as they were logged, until the end of the run.
pub(super) fn play(rec: &RecordingStream, streams: &[Stream], speed: f64) -> Result<(), ViewError> {
    let first_s = streams.iter().filter_map(|s| s.t_s.first()).fold(f64::INFINITY, |a, b| a.min(*b));
    let start = Instant::now();
    let mut sent = vec![0; streams.len()];
    while streams.iter().zip(&sent).any(|(stream, sent)| *sent < stream.len()) {
        let now_s = first_s + speed * start.elapsed().as_secs_f64();
        for (stream, sent) in streams.iter().zip(&mut sent) {
            let due = stream.t_s.partition_point(|t_s| *t_s <= now_s);
            stream.send(rec, *sent..due)?;
            *sent = due.max(*sent);
        }
        sleep(PERIOD);
    }
    Ok(())
}
