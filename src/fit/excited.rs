//! What an identification run looks like, whoever recorded it.

use crate::{
    series::{Series, Track},
    units::DEGREE_RAD,
};

/// Strokes of a joint that an identification run makes at its lowest speed, and at its highest, at least.
const ALIKE: usize = 3;
/// How many times faster the last strokes are than the first ones, by how much the speeds of each differ, and what share of its
/// largest speed a stroke has in the mean: those of smooth plans have 0.53.
const FASTER: f64 = 2.0;
const EQUALLY: f64 = 0.25;
const EVEN: f64 = 0.55;
/// Rest between strokes, s.
const RESTS_S: f64 = 0.3;
/// A joint that is slower rests, rad/s.
const RESTS_RAD_S: f64 = 0.4 * DEGREE_RAD;

/// One motion of a joint: start and end, s, how far it goes, rad, and its largest speed, rad/s; NaN if it turns back.
struct Stroke {
    from_s: f64,
    to_s: f64,
    way_rad: f64,
    most_rad_s: f64,
}

/// Whether a plan is an identification run, whoever recorded it: joint after joint goes to and fro from where it starts, at
/// even speeds, first some strokes slowly, at last some fast.
pub fn is_excitation(plan: &Series) -> bool {
    let moving: Vec<Vec<Stroke>> = plan.tracks.iter().map(strokes).filter(|own| !own.is_empty()).collect();
    let span = |own: &Vec<Stroke>| Some([own.first()?.from_s, own.last()?.to_s]);
    let mut spans: Vec<[f64; 2]> = moving.iter().filter_map(span).collect();
    spans.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let in_turn = spans.windows(2).all(|two| two[0][1] <= two[1][0]);
    in_turn && moving.iter().any(|own| grows_faster(own)) && moving.iter().all(|own| returns(own))
}

/// The motions of a joint between rests.
fn strokes(track: &Track) -> Vec<Stroke> {
    let mut found: Vec<Stroke> = Vec::new();
    for (t, at) in track.t_s().windows(2).zip(track.position().windows(2)) {
        let (way_rad, speed_rad_s) = (at[1] - at[0], (at[1] - at[0]) / (t[1] - t[0]));
        if speed_rad_s.abs() < RESTS_RAD_S {
            continue;
        }
        match found.last_mut().filter(|last| t[0] - last.to_s < RESTS_S) {
            Some(last) => {
                let back = last.way_rad * way_rad < 0.0;
                last.most_rad_s = if back { f64::NAN } else { last.most_rad_s.max(speed_rad_s.abs()) };
                (last.to_s, last.way_rad) = (t[1], last.way_rad + way_rad);
            }
            None => found.push(Stroke { from_s: t[0], to_s: t[1], way_rad, most_rad_s: speed_rad_s.abs() }),
        }
    }
    found
}

/// Whether all motions are even, the first ones equally slow, the last ones equally fast, and none slower than one before it.
fn grows_faster(strokes: &[Stroke]) -> bool {
    let speed = |stroke: &Stroke| stroke.way_rad.abs() / (stroke.to_s - stroke.from_s);
    let even = |stroke: &Stroke| speed(stroke) > EVEN * stroke.most_rad_s;
    let alike = |own: &[Stroke]| {
        let most = own.iter().map(|stroke| stroke.most_rad_s).fold(0.0, f64::max);
        own.iter().all(|stroke| stroke.most_rad_s > (1.0 - EQUALLY) * most).then_some(most)
    };
    let ends = (
        strokes.get(..ALIKE).and_then(alike),
        strokes.len().checked_sub(ALIKE).and_then(|from| alike(&strokes[from..])),
    );
    let grows = |two: &[Stroke]| two[1].most_rad_s > (1.0 - EQUALLY) * two[0].most_rad_s;
    strokes.len() >= 2 * ALIKE
        && strokes.iter().all(even)
        && strokes.windows(2).all(grows)
        && matches!(ends, (Some(slow), Some(fast)) if fast > FASTER * slow)
}

/// Whether a joint ends where it began.
fn returns(strokes: &[Stroke]) -> bool {
    strokes.iter().map(|stroke| stroke.way_rad).sum::<f64>().abs() < 0.3 * DEGREE_RAD
}

#[cfg(test)]
mod tests {
    use super::{super::excite::tests::run, *};
    use crate::fit::Excitation;

    #[test]
    fn an_identification_run_is_known_by_what_it_does() {
        assert!(is_excitation(&run(&Excitation::minimal())) && is_excitation(&run(&Excitation::full())));
        let t_s: Vec<f64> = (0..4000).map(|k| 0.01 * f64::from(k)).collect();
        let wave = |speed: f64| t_s.iter().map(|t| 0.2 * (speed * t).sin()).collect::<Vec<f64>>();
        let both = ["a", "b"].map(|name| Track::new(name, t_s.clone(), wave(0.5), &[]).unwrap());
        assert!(!is_excitation(&Series { tracks: both.to_vec() }));
        assert!(!is_excitation(&Series { tracks: Vec::new() }));
        let slow = |most_deg_s: f64| {
            let mut excitation = Excitation::minimal();
            for ramp in &mut excitation.ramps {
                ramp.speed_rad_s = ramp.speed_rad_s.min(most_deg_s * DEGREE_RAD);
            }
            run(&excitation)
        };
        assert!(is_excitation(&slow(10.0)));
        // A staircase and back, a press that approaches fast, presses slowly and returns fast: at even speeds, too.
        for ways in [
            &[(2.0, 2.0), (2.0, 2.0), (2.0, 2.0), (2.0, 2.0), (2.0, 2.0), (-10.0, 20.0)][..],
            &[(30.0, 20.0), (5.0, 2.0), (-35.0, 20.0), (30.0, 20.0), (5.0, 2.0), (-35.0, 20.0), (30.0, 20.0)],
        ] {
            let (mut t_s, mut position) = (vec![0.0], vec![0.0]);
            for (way_deg, speed_deg_s) in ways {
                let (steps, from) =
                    ((100.0_f64 * way_deg / speed_deg_s).abs().round(), position[position.len() - 1]);
                for k in (1..2000_u32).take_while(|k| f64::from(*k) <= steps + 150.0) {
                    t_s.push(t_s[t_s.len() - 1] + 0.01);
                    position.push(from + way_deg * DEGREE_RAD * (f64::from(k) / steps).min(1.0));
                }
            }
            let track = Track::new("boom", t_s, position, &[]).unwrap();
            assert!(!is_excitation(&Series { tracks: vec![track] }), "{ways:?}");
        }
    }
}
