//! Where a log is silent while its joints move: no command is made across such a hole, for it would jump there.

use std::path::Path;

use super::ReplanFailure;
use crate::series::{Series, SignalError, Track};

/// Cuts with less silence than this, s, which a clock that was set makes, are no holes: between their sides a track goes on.
const BRIDGED_S: f64 = 0.3;

/// A joint that is so far away after a hole has moved within it, rad or m.
const MOVED: f64 = 1e-3;

/// The series with its short holes closed.
pub(super) fn bridged(series: &Series) -> Result<Series, SignalError> {
    let one = |track: &Track| {
        let (t_s, starts) = (track.t_s(), track.segments().iter().map(|part| part.start));
        let cuts: Vec<usize> = starts.filter(|k| *k > 0 && t_s[*k] - t_s[*k - 1] > BRIDGED_S).collect();
        let made = Track::of(track.kind(), track.name(), t_s.to_vec(), track.position().to_vec(), &cuts)?;
        track.velocity().map_or(Ok(made.clone()), |speed| made.with_velocity(speed.to_vec()))
    };
    Ok(Series { tracks: series.tracks.iter().map(one).collect::<Result<_, _>>()? })
}

/// Refuses what was planned or sent with a hole in which a joint moves: the command would jump there.
pub(super) fn check_holes(
    path: &Path,
    what: &'static str,
    series: &Series,
    [from_s, to_s]: [f64; 2],
) -> Result<(), ReplanFailure> {
    for track in &series.tracks {
        for two in track.segments().windows(2) {
            let (a, b) = (two[0].end - 1, two[1].start);
            let hole_s = [track.t_s()[a], track.t_s()[b]];
            let moved = track.position()[b] - track.position()[a];
            if hole_s[1] > from_s && hole_s[0] < to_s && moved.abs() > MOVED {
                let (path, joint, kind) = (path.to_owned(), track.name().to_owned(), track.kind());
                return Err(ReplanFailure::HoleInMotion { path, what, joint, kind, moved, hole_s });
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(missing: std::ops::Range<usize>, with_speed: bool) -> Track {
        let kept: Vec<usize> = (0..300).filter(|k| !missing.contains(k)).collect();
        let t_s: Vec<f64> = kept.iter().map(|k| *k as f64 * 0.02).collect();
        let position = t_s.iter().map(|t| (0.7 * t).sin()).collect();
        let made = Track::new("J", t_s.clone(), position, &[missing.start]).unwrap();
        if !with_speed {
            return made;
        }
        made.with_velocity(t_s.iter().map(|t| 0.7 * (0.7 * t).cos()).collect()).unwrap()
    }

    #[test]
    fn a_short_hole_is_closed_and_a_long_one_in_motion_refused() {
        for with_speed in [true, false] {
            let short = Series { tracks: vec![wave(100..110, with_speed)] };
            let whole = bridged(&short).unwrap();
            assert_eq!((short.tracks[0].segments().len(), whole.tracks[0].segments().len()), (2, 1));
            let there = whole.tracks[0].held_at(2.09);
            assert!((there.position - (0.7_f64 * 2.09).sin()).abs() < 4e-3, "{there:?}");
            assert!(check_holes(Path::new("a"), "plan", &whole, [0.0, 6.0]).is_ok());
        }
        let long = bridged(&Series { tracks: vec![wave(100..130, true)] }).unwrap();
        let refused =
            |within_s| check_holes(Path::new("run.mcap"), "plan", &long, within_s).map_err(|e| e.to_string());
        let said = refused([0.0, 6.0]).unwrap_err();
        assert!(said.contains("from 1.98 s to 2.60 s while J moves"), "{said}");
        assert_eq!(refused([3.0, 6.0]), Ok(()));
    }
}
