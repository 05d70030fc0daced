//! Path error: how far the arm was from where it was to pass, whenever it passed.

use super::{PathError, Rules, cursor::Cursor};
use crate::series::Pair;

/// Joint vectors at common instants, `[n, joints]` row-major; those that no window needs any more are forgotten.
#[derive(Default)]
struct Path {
    joints: usize,
    t_s: Vec<f64>,
    planned_rad: Vec<f64>,
    measured_rad: Vec<f64>,
    /// Whether the plan runs on from the instant before.
    connected: Vec<bool>,
}

/// Instants that are forgotten at once.
const FORGOTTEN: usize = 4096;

/// Sums over the instants: of every joint, and of their norm last.
struct Sums {
    squares: Vec<f64>,
    peaks: Vec<f64>,
    timed: Vec<f64>,
}

/// Path error of each joint and their norm.
///
/// For every measured joint vector the nearest point on the planned polyline in joint space is
/// sought within [`Rules::path_window_s`]; the components of that distance are each joint's.
/// Taken at the first joint's stamps, thinned to about [`Rules::path_rate_hz`], where every joint has
/// data; `None` where there is none. O(n window).
pub(super) fn path_error(pairs: &[Pair], rules: &Rules) -> Option<(Vec<PathError>, PathError)> {
    let lead = pairs.first()?;
    let mut path = Path { joints: pairs.len(), ..Path::default() };
    let zeros = || vec![0.0; pairs.len() + 1];
    let mut sums = Sums { squares: zeros(), peaks: zeros(), timed: zeros() };
    // Less than the step, so that jitter around it loses no stamps.
    let step_s = 0.75 / rules.path_rate_hz;
    let mut cursors = vec![Cursor::default(); pairs.len()];
    let (mut last_s, mut last_places) = (f64::NEG_INFINITY, Vec::new());
    let (mut n, mut begins_s) = (0_usize, f64::INFINITY);
    // The instants within the window of the one that is judged.
    let (mut first, mut judged, mut end) = (0, 0, 0);
    for t_s in lead.t_s.iter().copied().chain([f64::INFINITY]) {
        if t_s - last_s < step_s {
            continue;
        }
        if t_s.is_finite() {
            let found: Option<Vec<_>> =
                pairs.iter().zip(&mut cursors).map(|(pair, cursor)| cursor.at(pair, t_s)).collect();
            let Some(found) = found else {
                continue;
            };
            let places: Vec<usize> = cursors.iter().map(|c| c.segment).collect();
            (last_s, n, begins_s) = (t_s, n + 1, begins_s.min(t_s));
            path.t_s.push(t_s);
            path.connected.push(places == last_places);
            last_places = places;
            for (planned, measured) in found {
                path.planned_rad.push(planned);
                path.measured_rad.push(measured);
            }
        }
        while judged < path.t_s.len() && t_s - path.t_s[judged] > rules.path_window_s {
            while path.t_s[judged] - path.t_s[first] > rules.path_window_s {
                first += 1;
            }
            while end < path.t_s.len() && path.t_s[end] - path.t_s[judged] <= rules.path_window_s {
                end += 1;
            }
            sums.add(&path, judged, path.nearest(judged, first, end));
            judged += 1;
        }
        if first >= FORGOTTEN {
            path.forget(first);
            (first, judged, end) = (0, judged - first, end - first);
        }
    }
    let sample_interval_s = if n > 1 { (last_s - begins_s) / (n - 1) as f64 } else { 0.0 };
    let of = |((square, timed), peak): ((&f64, &f64), &f64)| PathError {
        rms: (square / n as f64).sqrt(),
        peak: *peak,
        timed_rms: (timed / n as f64).sqrt(),
        samples: n,
        sample_interval_s,
    };
    let mut errors: Vec<PathError> = sums.squares.iter().zip(&sums.timed).zip(&sums.peaks).map(of).collect();
    let norm = errors.pop().filter(|_| n > 0)?;
    Some((errors, norm))
}

impl Sums {
    /// Takes in instant `i`, whose nearest point of the plan is a share of the piece from `at` on.
    fn add(&mut self, path: &Path, i: usize, (at, share): (usize, f64)) {
        let (norm, mut square) = (path.joints, 0.0);
        for j in 0..path.joints {
            let off = path.offset(i, j, at, share);
            square += off * off;
            self.squares[j] += off * off;
            self.peaks[j] = self.peaks[j].max(off.abs());
            let now = path.offset(i, j, i, 0.0);
            self.timed[j] += now * now;
            self.timed[norm] += now * now;
        }
        self.squares[norm] += square;
        self.peaks[norm] = self.peaks[norm].max(square.sqrt());
    }
}

impl Path {
    fn forget(&mut self, instants: usize) {
        self.t_s.drain(..instants);
        self.connected.drain(..instants);
        self.planned_rad.drain(..instants * self.joints);
        self.measured_rad.drain(..instants * self.joints);
    }

    /// The piece of plan from sample `at` on that passes nearest to measured vector `i`, and
    /// the share of the piece up to the nearest point.
    fn nearest(&self, i: usize, first: usize, end: usize) -> (usize, f64) {
        let (mut best, mut place) = (f64::INFINITY, (i, 0.0));
        for at in first..end {
            let whole = at + 1 < end && self.connected[at + 1];
            let (mut along, mut length) = (0.0, 0.0);
            let mut from_start = 0.0;
            for j in 0..self.joints {
                let r = self.planned_rad[at * self.joints + j];
                let off = self.measured_rad[i * self.joints + j] - r;
                from_start += off * off;
                if whole {
                    let piece = self.planned_rad[(at + 1) * self.joints + j] - r;
                    along += off * piece;
                    length += piece * piece;
                }
            }
            let share = if length > 0.0 { (along / length).clamp(0.0, 1.0) } else { 0.0 };
            let square = from_start + share * (share * length - 2.0 * along);
            if square < best {
                (best, place) = (square, (at, share));
            }
        }
        place
    }

    fn offset(&self, i: usize, j: usize, at: usize, share: f64) -> f64 {
        let r = self.planned_rad[at * self.joints + j];
        let piece = if share > 0.0 { self.planned_rad[(at + 1) * self.joints + j] - r } else { 0.0 };
        r + share * piece - self.measured_rad[i * self.joints + j]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::series::JointKind;

    fn pair(n: u32, late_s: f64, off_rad: f64) -> Pair {
        let t_s: Vec<f64> = (0..n).map(|k| 0.02 * f64::from(k)).collect();
        let angle = |t: f64| 0.5 * (t - 3.0).clamp(0.0, 4.0);
        Pair {
            name: "a".into(),
            kind: JointKind::Turns,
            planned: t_s.iter().map(|&t| angle(t)).collect(),
            planned_velocity: None,
            measured: t_s.iter().map(|&t| angle(t - late_s) + off_rad).collect(),
            segments: std::iter::once(0..t_s.len()).collect(),
            planned_interval_s: 0.01,
            matched: t_s.len(),
            unmatched: 0,
            t_s: t_s.into(),
        }
    }

    #[test]
    fn being_late_on_the_path_is_no_path_error() {
        let (joints, norm) =
            path_error(&[pair(500, 0.213, 0.0), pair(500, 0.213, 0.0)], &Rules::default()).unwrap();
        assert!(norm.timed_rms > 0.05);
        assert!(norm.peak < 1e-12 && joints.iter().all(|j| j.peak < 1e-12), "{norm:?}");
    }

    #[test]
    fn standing_off_the_path_is_a_path_error_of_that_joint() {
        let still = |off_rad: f64| {
            let mut pair = pair(500, 0.0, off_rad);
            pair.planned.fill(0.0);
            pair.measured.fill(off_rad);
            pair
        };
        let (joints, norm) = path_error(&[pair(500, 0.1, 0.0), still(0.03)], &Rules::default()).unwrap();
        assert!(joints[0].peak < 1e-12);
        assert!((joints[1].rms - 0.03).abs() < 1e-12 && (norm.rms - 0.03).abs() < 1e-12);
    }

    #[test]
    fn joints_without_a_common_instant_have_no_path_error() {
        let mut later = pair(10, 0.0, 0.0);
        later.t_s = later.t_s.iter().map(|t| t + 100.0).collect();
        assert_eq!(path_error(&[pair(10, 0.0, 0.0), later], &Rules::default()), None);
        assert_eq!(path_error(&[], &Rules::default()), None);
    }
}
