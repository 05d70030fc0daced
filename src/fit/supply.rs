//! A supply that gives less than joints ask for together: the pressure before the valves falls while they move.

use serde::{Deserialize, Serialize};

use super::LEAST_TRAVEL_RAD;
use crate::{
    arm::{Arm, Cylinder},
    math::{median, quantile, range},
    series::{Series, Signal, Track},
};

/// Samples that are looked at are as far apart, s; those after a gap stand for no longer than the second. Over how much to either side
/// a speed is taken, s.
const STEP_S: f64 = 0.05;
const LONGEST_S: f64 = 0.5;
const HALF_S: f64 = 0.1;
/// A joint moves at this share of its largest speed.
const MOVES: f64 = 0.08;
/// Rest that tells where the pressure stands, s, at least.
const RESTS_S: f64 = 1.0;
/// It stands at this share of its highest or more: that of a pump which follows the load falls to nothing at rest.
const STANDS: f64 = 0.8;
/// Less than this share of where it stands is low, and long enough to be told, s; less than the other is no pressure of a pump that runs.
const LOW: f64 = 0.7;
const LASTS_S: f64 = 0.5;
const NONE: f64 = 0.05;
/// Lags that a joint has anyway are looked for in such steps, s; more than that, some joint is behind by so much of its fastest speed where a
/// pump gives too little. A valve before the sensor, a setting that is turned down or a sensor that fails hold no joint back.
const LAG_STEP_S: f64 = 0.05;
const LAGS: u32 = 20;
const BEHIND_S: f64 = 0.22;
/// Flows of a pump at its limit are as near to one another; other runs in which it gave this many times as much refute it.
const ALIKE: f64 = 1.6;
const MORE: f64 = 1.1;

/// What a run shows of its supply.
#[derive(Debug, Clone, Copy)]
pub struct Fed<'a> {
    /// What was sent.
    pub sent: &'a Series,
    /// Measured angles.
    pub measured: &'a Series,
    /// Pressure before the valves, Pa.
    pub pressure: &'a Signal,
    /// The arm, where its cylinders are known.
    pub arm: Option<&'a Arm>,
}

/// A supply whose pressure fell while joints moved, in the run in which it did so for longest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Supply {
    /// Pressure while no joint moves, median, Pa.
    pub standing_pa: f64,
    /// The least of it while some do, its quantile of 5 % where it is low, Pa.
    pub least_pa: f64,
    /// How long it was below seven tenths of where it stands while joints moved, s.
    pub low_s: f64,
    /// How long joints moved, s.
    pub moving_s: f64,
    /// What all cylinders took meanwhile in all runs, quartiles, m³/s: with the oil that sinking loads give back; absent where cylinders
    /// are not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flow_m3_s: Option<[f64; 3]>,
}

impl Supply {
    /// What the pump gives at least, m³/s.
    pub fn gives_m3_s(&self) -> Option<f64> {
        self.flow_m3_s.map(|[low, ..]| low)
    }

    /// The most that a plan asks for, m³/s; `None` where some joint that moves has no known cylinder.
    pub fn asked_m3_s(plan: &Series, arm: &Arm) -> Option<f64> {
        let driven = driven(plan, arm)?;
        let flows = instants(plan).into_iter().map(|(t_s, _)| flow_m3_s(&driven, t_s));
        Some(flows.fold(0.0, f64::max))
    }
}

/// The supply of some runs, in their order, where it fell in one of them and no later one shows that it gives more.
pub fn supply(runs: &[Fed<'_>]) -> Option<Supply> {
    let mut found: Vec<(Supply, Vec<f64>)> = Vec::new();
    for run in runs {
        match fell(run) {
            Some(one) => found.push(one),
            None if refutes(run, &found) => found.clear(),
            None => {}
        }
    }
    let worst = found.iter().map(|(supply, _)| *supply).max_by(|a, b| a.low_s.total_cmp(&b.low_s))?;
    let alike = |[low, _, high]: &[f64; 3]| *high <= ALIKE * low;
    Some(Supply { flow_m3_s: quartiles(&found).filter(alike), ..worst })
}

/// Whether a run in which the pressure stood took more than was found, or nothing tells what it took.
fn refutes(run: &Fed<'_>, found: &[(Supply, Vec<f64>)]) -> bool {
    let took = run.arm.and_then(|arm| driven(run.measured, arm)).map(|driven| {
        let flows = instants(run.measured).into_iter().map(|(t_s, _)| flow_m3_s(&driven, t_s));
        quantile(flows.collect(), 0.95)
    });
    let gave = quartiles(found).map(|[low, ..]| low);
    took.zip(gave).is_none_or(|(took, gave)| took > MORE * gave)
}

fn quartiles(found: &[(Supply, Vec<f64>)]) -> Option<[f64; 3]> {
    let flows: Vec<f64> = found.iter().flat_map(|(_, flows)| flows.iter().copied()).collect();
    (!flows.is_empty()).then(|| [0.25, 0.5, 0.75].map(|share| quantile(flows.clone(), share)))
}

/// Of one run, with what cylinders took at each instant at which the pressure was low.
fn fell(run: &Fed<'_>) -> Option<(Supply, Vec<f64>)> {
    let moving: Vec<&Track> = moved(run.measured).collect();
    let seen = |(t_s, lasts_s): (f64, f64)| Some(Seen { t_s, lasts_s, pa: run.pressure.at(t_s)? });
    let seen: Vec<Seen> = instants(run.measured).into_iter().filter_map(seen).collect();
    let speeds: Vec<Vec<f64>> =
        moving.iter().map(|track| seen.iter().map(|one| speed(track, one.t_s)).collect()).collect();
    let top: Vec<f64> = speeds.iter().map(|speeds| quantile(speeds.clone(), 0.995)).collect();
    let moves = |k: usize| speeds.iter().zip(&top).any(|(speeds, top)| speeds[k] > MOVES * top);
    let (moves, rests): (Vec<_>, Vec<_>) = seen.iter().enumerate().partition(|(k, _)| moves(*k));
    let all_s = |some: &[(usize, &Seen)]| some.iter().map(|(_, one)| one.lasts_s).sum::<f64>();
    let highest_pa = quantile(seen.iter().map(|one| one.pa).collect(), 0.95);
    // While the pump runs.
    let rests: Vec<(usize, &Seen)> = rests.into_iter().filter(|(_, one)| one.pa > 0.5 * highest_pa).collect();
    let standing_pa = median(rests.iter().map(|(_, one)| one.pa).collect());
    let stands = all_s(&rests) >= RESTS_S && standing_pa >= STANDS * highest_pa && standing_pa > 0.0;
    let is_low =
        |k: usize| seen.get(k).is_some_and(|one| (NONE * standing_pa..LOW * standing_pa).contains(&one.pa));
    // One sample alone is none.
    let lasts = |k: usize| is_low(k) && is_low(k + 1) && is_low(k.wrapping_sub(1));
    let low: Vec<(usize, &Seen)> = moves.iter().copied().filter(|(k, _)| lasts(*k)).collect();
    let (low_s, moving_s) = (all_s(&low), all_s(&moves));
    let at = |some: &[(usize, &Seen)]| some.iter().map(|(_, one)| one.t_s).collect::<Vec<f64>>();
    let behind = |track: &&Track| {
        run.sent
            .track(track.name())
            .is_some_and(|sent| behind_s(sent, track, [&at(&moves), &at(&low)]) > BEHIND_S)
    };
    if !stands || low_s < LASTS_S || !moving.iter().any(behind) {
        return None;
    }
    let driven = run.arm.and_then(|arm| driven(run.measured, arm)).unwrap_or_default();
    let least_pa = quantile(low.iter().map(|(_, one)| one.pa).collect(), 0.05);
    let low = low.iter().filter(|_| !driven.is_empty());
    let flows = low.map(|(_, one)| flow_m3_s(&driven, one.t_s)).collect();
    Some((Supply { standing_pa, least_pa, low_s, moving_s, flow_m3_s: None }, flows))
}

/// By how much of its fastest speed a joint is behind what is sent in some of the instants at which it moves, s, beyond the lag that it has
/// in the middle.
fn behind_s(sent: &Track, measured: &Track, [moves, some]: [&[f64]; 2]) -> f64 {
    let fastest = quantile(moves.iter().map(|t_s| speed(sent, *t_s)).collect(), 0.995);
    let off = |lag_s: f64, at: &[f64]| -> Vec<f64> {
        let each = at.iter().map(|t_s| sent.held_at(t_s - lag_s).position - measured.held_at(*t_s).position);
        each.map(f64::abs).collect()
    };
    let lags = (0..=LAGS).map(|k| LAG_STEP_S * f64::from(k));
    let usual = lags.map(|lag_s| (median(off(lag_s, moves)), lag_s)).min_by(|a, b| a.0.total_cmp(&b.0));
    usual.map_or(0.0, |(_, lag_s)| quantile(off(lag_s, some), 0.95) / fastest.max(f64::MIN_POSITIVE))
}

/// The pressure at an instant, and how long that stands for.
struct Seen {
    t_s: f64,
    lasts_s: f64,
    pa: f64,
}

/// The joints that go anywhere.
fn moved(series: &Series) -> impl Iterator<Item = &Track> {
    series.tracks.iter().filter(|track| {
        let [lowest, highest] = range(track.position().iter().copied());
        highest - lowest >= LEAST_TRAVEL_RAD
    })
}

/// These with their cylinders; `None` where one has none that is known.
fn driven<'a>(series: &'a Series, arm: &'a Arm) -> Option<Vec<(&'a Track, &'a Cylinder)>> {
    let of = |track: &'a Track| {
        let joint = arm.chain.joints().iter().position(|joint| joint.name == track.name())?;
        Some((track, arm.hydraulics.cylinders().get(joint)?.as_ref()?))
    };
    moved(series).map(of).collect()
}

fn flow_m3_s(driven: &[(&Track, &Cylinder)], t_s: f64) -> f64 {
    let of = |(track, cylinder): &(&Track, &Cylinder)| {
        let at = track.held_at(t_s).position.sin_cos();
        cylinder.actuation(at, track.mean_speed(t_s, HALF_S), 0.0).flow_m3_s
    };
    driven.iter().map(of).sum()
}

fn speed(track: &Track, t_s: f64) -> f64 {
    track.mean_speed(t_s, HALF_S).abs()
}

/// Instants of samples, and how long each stands for, s.
fn instants(series: &Series) -> Vec<(f64, f64)> {
    let mut some: Vec<(f64, f64)> = Vec::new();
    for t_s in series.tracks.first().map_or(&[][..], Track::t_s) {
        let since_s = some.last().map_or(f64::INFINITY, |last| t_s - last.0);
        if since_s >= STEP_S {
            some.iter_mut().next_back().into_iter().for_each(|last| last.1 = since_s.min(LONGEST_S));
            some.push((*t_s, 0.0));
        }
    }
    some
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::series::Quantity;

    /// A joint that comes and goes, `late_s` late in the middle of its way back, and a pressure of so much at rest and while it comes back, bar.
    fn found([rests, moves]: [f64; 2], late_s: f64, arm: Option<&Arm>) -> Option<Supply> {
        let step = |t_s: f64, from_s: f64, lasts_s: f64| crate::math::smooth_step((t_s - from_s) / lasts_s);
        let name = Arm::sample().unwrap().chain.joints()[0].name.clone();
        let of = |late_s: f64| {
            let back = move |t_s: f64| step(t_s, 13.0, 4.0 + 2.0 * late_s);
            Series::sampled(&name, 2500, move |t_s| 0.7 + 0.3 * (step(t_s, 3.0, 4.0) - back(t_s)))
        };
        let (sent, measured) = (of(0.0), of(late_s));
        let t_s: Vec<f64> = (0..2500).map(|k| 0.01 * f64::from(k)).collect();
        let pa = t_s.iter().map(|t_s| 1e5 * if (13.5..16.5).contains(t_s) { moves } else { rests }).collect();
        let pressure = Signal::new("supply", Quantity::Pressure, t_s, pa, &[]).unwrap();
        supply(&[Fed { sent: &sent, measured: &measured, pressure: &pressure, arm }])
    }

    #[test]
    fn a_pressure_that_falls_while_joints_fall_behind_is_told_with_what_cylinders_took() {
        let arm = Arm::sample().unwrap();
        let low = found([160.0, 60.0], 1.0, Some(&arm)).unwrap();
        assert!((low.standing_pa - 160e5).abs() < 1.0 && (low.least_pa - 60e5).abs() < 1.0, "{low:?}");
        assert!((2.0..3.0).contains(&low.low_s) && (5.0..10.0).contains(&low.moving_s), "{low:?}");
        assert_eq!(found([160.0, 60.0], 1.0, None).unwrap().flow_m3_s, None);
        for (pressures, late_s, why) in [
            ([160.0, 130.0], 1.0, "it sags"),
            ([20.0, 140.0], 1.0, "it follows the load"),
            ([160.0, 60.0], 0.1, "nothing is held back"),
            ([160.0, 0.0], 1.0, "the sensor fails"),
        ] {
            assert_eq!(found(pressures, late_s, Some(&arm)), None, "{why}");
        }
    }
}
