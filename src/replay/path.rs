//! Path error: how far the arm was from where it was to pass, whenever it passed.

use multiversion::multiversion;

use super::{PathError, Rules, cursor::Cursor, tracking::LONE_S};
use crate::series::Pair;

/// Joint vectors at common instants, `[joints][n]`; those that no window needs any more are forgotten.
struct Path {
    t_s: Vec<f64>,
    planned_rad: Vec<Vec<f64>>,
    measured_rad: Vec<Vec<f64>>,
    /// Whether the plan runs on from the instant before.
    connected: Vec<bool>,
}

/// Instants that are forgotten at once.
const FORGOTTEN: usize = 4096;

/// The joint with most samples, the first of those: a sparse one would hide what the others do between its stamps.
pub(super) fn densest<'a>(pairs: &[&'a Pair]) -> Option<&'a Pair> {
    pairs.iter().rev().max_by_key(|pair| pair.t_s.len()).copied()
}

/// Sums over the instants, each by the time it stands for: of every joint, and of their norm last.
struct Sums {
    time_s: f64,
    squares: Vec<f64>,
    peaks: Vec<f64>,
    timed: Vec<f64>,
}

/// Path error of each joint and their norm.
///
/// For every measured joint vector the nearest point on the planned polyline in joint space is
/// sought within [`Rules::path_window_s`]; the components of that distance are each joint's.
/// Taken at the stamps of the joint with most of them, thinned to about [`Rules::path_rate_hz`], where every joint has
/// data, and not where what is followed lies before or after what the log has of the plan; `None` where there is none.
/// O(n window).
pub(super) fn path_error(pairs: &[&Pair], rules: &Rules) -> Option<(Vec<PathError>, PathError)> {
    let lead = densest(pairs)?;
    let none = || vec![Vec::new(); pairs.len()];
    let mut path = Path { t_s: Vec::new(), planned_rad: none(), measured_rad: none(), connected: Vec::new() };
    let zeros = || vec![0.0; pairs.len() + 1];
    let mut sums = Sums { time_s: 0.0, squares: zeros(), peaks: zeros(), timed: zeros() };
    // Less than the step, so that jitter around it loses no stamps.
    let window_s = rules.path_window_s.max(0.0);
    let step_s = 0.75 / rules.path_rate_hz;
    let mut cursors = vec![Cursor::default(); pairs.len()];
    let (mut last_s, mut last_places) = (f64::NEG_INFINITY, Vec::new());
    // Of all instants, and of those that are judged.
    let (mut all, mut n, mut begins_s) = (0_usize, 0_usize, f64::INFINITY);
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
            (last_s, all, begins_s) = (t_s, all + 1, begins_s.min(t_s));
            path.t_s.push(t_s);
            path.connected.push(places == last_places);
            last_places = places;
            for (j, (planned, measured)) in found.into_iter().enumerate() {
                path.planned_rad[j].push(planned);
                path.measured_rad[j].push(measured);
            }
        }
        while judged < path.t_s.len() && t_s - path.t_s[judged] > window_s {
            while path.t_s[judged] - path.t_s[first] > window_s {
                first += 1;
            }
            while end < path.t_s.len() && path.t_s[end] - path.t_s[judged] <= window_s {
                end += 1;
            }
            let place = nearest(&path, judged, first, end);
            let beyond = path.may_lie_beyond(judged, place, |j| rules.sizes(pairs[j].kind).start_speed);
            if !beyond {
                sums.add(&path, judged, place);
                n += 1;
            }
            judged += 1;
        }
        if first >= FORGOTTEN {
            path.forget(first);
            (first, judged, end) = (0, judged - first, end - first);
        }
    }
    let sample_interval_s = if all > 1 { (last_s - begins_s) / (all - 1) as f64 } else { 0.0 };
    let of = |((square, timed), peak): ((&f64, &f64), &f64)| PathError {
        rms: (square / sums.time_s).sqrt(),
        peak: *peak,
        timed_rms: (timed / sums.time_s).sqrt(),
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
        let (norm, weight_s, mut square) = (path.planned_rad.len(), path.weight_s(i), 0.0);
        self.time_s += weight_s;
        for j in 0..norm {
            let off = path.offset(i, j, at, share);
            square += off * off;
            self.squares[j] += weight_s * off * off;
            self.peaks[j] = self.peaks[j].max(off.abs());
            let now = path.offset(i, j, i, 0.0);
            self.timed[j] += weight_s * now * now;
            self.timed[norm] += weight_s * now * now;
        }
        self.squares[norm] += weight_s * square;
        self.peaks[norm] = self.peaks[norm].max(square.sqrt());
    }
}

impl Path {
    /// Half the way to the neighbours in the same stretch.
    fn weight_s(&self, i: usize) -> f64 {
        let goes_on = |to: usize| self.connected.get(to).is_some_and(|connected| *connected);
        let (first, last) = (i - usize::from(i > 0 && self.connected[i]), i + usize::from(goes_on(i + 1)));
        (0.5 * (self.t_s[last] - self.t_s[first])).max(LONE_S)
    }

    fn forget(&mut self, instants: usize) {
        self.t_s.drain(..instants);
        self.connected.drain(..instants);
        self.planned_rad.iter_mut().chain(&mut self.measured_rad).for_each(|joint| {
            joint.drain(..instants);
        });
    }

    /// Whether the nearest point of the plan is an end of a stretch at which the plan moves, so that what the joints follow lies
    /// before the stretch, or after it, and is not known.
    fn may_lie_beyond(&self, i: usize, (at, share): (usize, f64), starts: impl Fn(usize) -> f64) -> bool {
        let (at, share) = if share >= 1.0 { (at + 1, 0.0) } else { (at, share) };
        let moves = |from: usize| {
            let time_s = self.t_s[from + 1] - self.t_s[from];
            let fast = |(j, planned): (usize, &Vec<f64>)| {
                (planned[from + 1] - planned[from]).abs() > starts(j) * time_s
            };
            self.planned_rad.iter().enumerate().any(fast)
        };
        let goes_on = |to: usize| self.connected.get(to).is_some_and(|connected| *connected);
        let before = i >= at && !self.connected[at] && goes_on(at + 1) && moves(at);
        let after = i <= at && self.connected[at] && !goes_on(at + 1) && moves(at - 1);
        share <= 0.0 && (before || after)
    }

    fn offset(&self, i: usize, j: usize, at: usize, share: f64) -> f64 {
        let planned = &self.planned_rad[j];
        let piece = if share > 0.0 { planned[at + 1] - planned[at] } else { 0.0 };
        planned[at] + share * piece - self.measured_rad[j][i]
    }
}

/// The piece of plan from sample `at` on that passes nearest to measured vector `i`, and
/// the share of the piece up to the nearest point. Pieces are judged side by side.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn nearest(path: &Path, i: usize, first: usize, end: usize) -> (usize, f64) {
    const LANES: usize = 8;
    let (mut best, mut place) = (f64::INFINITY, (i, 0.0));
    for from in (first..end).step_by(LANES) {
        let count = LANES.min(end - from);
        let [mut from_start, mut along, mut length] = [[0.0; LANES]; 3];
        for (planned, measured) in path.planned_rad.iter().zip(&path.measured_rad) {
            let measured = measured[i];
            let mut add = |l: usize, r: f64, next: f64| {
                let (off, piece) = (measured - r, next - r);
                from_start[l] += off * off;
                along[l] += off * piece;
                length[l] += piece * piece;
            };
            if let Some(planned) = planned.get(from..=from + LANES) {
                for l in 0..LANES {
                    add(l, planned[l], planned[l + 1]);
                }
            } else {
                for l in 0..count {
                    add(l, planned[from + l], planned[(from + l + 1).min(planned.len() - 1)]);
                }
            }
        }
        let ends =
            std::array::from_fn::<bool, LANES, _>(|l| from + l + 1 >= end || !path.connected[from + l + 1]);
        let [mut share, mut square] = [[0.0; LANES]; 2];
        for l in 0..LANES {
            let on = (along[l] / length[l]).clamp(0.0, 1.0);
            share[l] = if ends[l] || length[l] <= 0.0 { 0.0 } else { on };
            square[l] = from_start[l] + share[l] * (share[l] * length[l] - 2.0 * along[l]);
        }
        for l in 0..count {
            if square[l] < best {
                (best, place) = (square[l], (from + l, share[l]));
            }
        }
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::series::{Track, align};

    fn pair(n: u32, late_s: f64, off_rad: f64) -> Pair {
        let angle = |t: f64| 0.5 * (t - 3.0).clamp(0.0, 4.0);
        let measured = Track::sampled("a", 2 * n, |t| angle(t - late_s) + off_rad);
        align(&Track::sampled("a", 2 * n, angle), &measured).unwrap()
    }

    #[test]
    fn being_late_on_the_path_is_no_path_error() {
        let (joints, norm) =
            path_error(&[&pair(500, 0.213, 0.0), &pair(500, 0.213, 0.0)], &Rules::default()).unwrap();
        assert!(norm.timed_rms > 0.05);
        assert!(norm.peak < 1e-12 && joints.iter().all(|j| j.peak < 1e-12), "{norm:?}");
    }

    #[test]
    fn a_measurement_that_begins_in_motion_is_not_off_the_path_by_its_lag() {
        let moving = |late_s: f64| Track::sampled("a", 500, |t| 0.5 * (t + 1.0 - late_s));
        let pair = align(&moving(0.0), &moving(0.213)).unwrap();
        let (_, norm) = path_error(&[&pair, &pair], &Rules::default()).unwrap();
        assert!(norm.timed_rms > 0.05 && norm.peak < 1e-12, "{norm:?}");
    }

    #[test]
    fn standing_off_the_path_is_a_path_error_of_that_joint() {
        let still = |off_rad: f64| {
            let mut pair = pair(500, 0.0, off_rad);
            pair.planned.fill(0.0);
            pair.measured.fill(off_rad);
            pair
        };
        let (joints, norm) = path_error(&[&pair(500, 0.1, 0.0), &still(0.03)], &Rules::default()).unwrap();
        assert!(joints[0].peak < 1e-12);
        assert!((joints[1].rms - 0.03).abs() < 1e-12 && (norm.rms - 0.03).abs() < 1e-12);
    }

    #[test]
    fn joints_without_a_common_instant_have_no_path_error() {
        let mut later = pair(10, 0.0, 0.0);
        later.t_s = later.t_s.iter().map(|t| t + 100.0).collect();
        assert_eq!(path_error(&[&pair(10, 0.0, 0.0), &later], &Rules::default()), None);
        assert_eq!(path_error(&[], &Rules::default()), None);
    }

    /// Every `every`-th sample of a pair.
    fn thinned(pair: &Pair, keeps: impl Fn(usize) -> bool) -> Pair {
        let kept: Vec<usize> = (0..pair.t_s.len()).filter(|&i| keeps(i)).collect();
        let of = |values: &[f64]| kept.iter().map(|&i| values[i]).collect::<Vec<f64>>();
        Pair {
            t_s: of(&pair.t_s).into(),
            planned: of(&pair.planned),
            measured: of(&pair.measured),
            segments: std::iter::once(0..kept.len()).collect(),
            planned_velocity: None,
            ..pair.clone()
        }
    }

    #[test]
    fn a_joint_that_is_logged_seldom_hides_nothing_of_the_others() {
        let mut kicked = pair(500, 0.0, 0.0);
        kicked.measured[420..440].iter_mut().for_each(|at| *at += 0.2);
        let seldom = thinned(&pair(500, 0.0, 0.0), |i| i % 100 == 0);
        let peak = |pairs: &[&Pair]| path_error(pairs, &Rules::default()).unwrap().1.peak;
        let [one, other] = [peak(&[&seldom, &kicked]), peak(&[&kicked, &seldom])];
        assert!(one > 0.1 && (one - other).abs() < 1e-12, "{one} {other}");
    }

    #[test]
    fn a_logger_that_slows_down_at_rest_changes_no_mean() {
        let dense = pair(500, 0.213, 0.0);
        let slow_at_rest = thinned(&dense, |i| i < 800 || i % 20 == 0);
        let rms = |pair: &Pair| path_error(&[pair], &Rules::default()).unwrap().1.timed_rms;
        assert!(
            (rms(&dense) / rms(&slow_at_rest) - 1.0).abs() < 0.01,
            "{} {}",
            rms(&dense),
            rms(&slow_at_rest)
        );
    }
}
