//! A limit that joints share, such as a pump whose flow they divide: each is slow where others move, and fast alone.
//!
//! At such a limit the speeds of all joints, each by what it makes alone, add up to one. Where joints move together and are held back,
//! that is looked for: shares of the sum that vary while the sum does not are no limits of single joints, and no plan.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::run::Observation;
use crate::{
    math::{jackknife, quantile},
    series::{JointKind, Series, Track},
};

/// Instants that are looked at, fewer of long logs, and over how much to either side a speed is taken, s.
const STEP_S: f64 = 0.05;
const MOST: f64 = 20_000.0;
const HALF_S: f64 = 0.1;
/// A joint moves at this share of its largest speed.
const MOVES: f64 = 0.08;
/// Instants with two joints in motion, at least.
const FEWEST: usize = 60;
/// Sums so near one are at the limit; so near they are fitted.
const AT: f64 = 0.05;
const FITTED: f64 = 0.08;
/// Share of the time in which two or more move that is at the limit, at least, and beyond it, at most.
const OFTEN: f64 = 0.38;
const BEYOND: f64 = 0.02;
/// How much the share of a joint varies at the limit, as a standard deviation, for two joints at least; of many joints each has less.
const VARIES: f64 = 0.08;
const VARIES_OF_ALL: f64 = 0.24;
/// What is asked for at nine tenths of the instants is less than this many times the limit, unless joints are held back.
const ASKED: f64 = 1.05;
/// Stretches at the limit, at least; those a second apart are two.
const FEWEST_STRETCHES: usize = 2;
const APART_S: f64 = 1.0;
const ROUNDS: usize = 60;

/// What joints share.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SharedLimit {
    /// The joints.
    pub joints: Vec<SharedJoint>,
    /// Share of the time in which two or more of them move that they are at it.
    pub share: f64,
    /// How long they are at it, s.
    pub duration_s: f64,
    /// In how many stretches.
    pub stretches: usize,
}

/// A joint that shares a limit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SharedJoint {
    /// The joint.
    pub name: String,
    /// Whether it turns or slides; of one that slides a radian stands for a metre.
    #[serde(default, skip_serializing_if = "JointKind::turns")]
    pub kind: JointKind,
    /// The speed that it makes with all of it, rad/s.
    pub alone_rad_s: f64,
    /// The 95 % interval of that, from stretch to stretch; absent of fewer than four.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interval_rad_s: Option<[f64; 2]>,
}

impl SharedLimit {
    /// How many times the limit a plan asks for at most, and when, s; `None` if none of its joints is known.
    pub fn asked(&self, plan: &Series) -> Option<(f64, f64)> {
        let tracks: Vec<(&Track, f64)> = self
            .joints
            .iter()
            .filter_map(|joint| Some((plan.track(&joint.name)?, joint.alone_rad_s)))
            .collect();
        let [from_s, to_s] = plan.span_s()?;
        let at = |t_s: f64| tracks.iter().map(|(track, alone)| speed(track, t_s) / alone).sum::<f64>();
        instants([from_s, to_s], STEP_S)
            .map(|t_s| (at(t_s), t_s))
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .filter(|_| !tracks.is_empty())
    }
}

/// Speed of a joint about an instant, rad/s; at rest beyond the ends.
fn speed(track: &Track, t_s: f64) -> f64 {
    track.mean_speed(t_s, HALF_S).abs()
}

fn instants([from_s, to_s]: [f64; 2], step_s: f64) -> impl Iterator<Item = f64> {
    std::iter::successors(Some(from_s), move |t_s| Some(t_s + step_s)).take_while(move |t_s| *t_s <= to_s)
}

/// Instants of all logs, and how fast each joint is.
#[derive(Default)]
struct Seen {
    /// By log, s.
    at_s: Vec<(usize, f64)>,
    speed_rad_s: Vec<Vec<f64>>,
}

impl Seen {
    fn of(names: &[String], logs: &[Observation<'_>], step_s: f64) -> Self {
        let mut seen = Self::default();
        for (log, run) in logs.iter().enumerate() {
            let both = |name: &String| Some((run.sent.track(name)?, run.measured.track(name)?));
            let Some(tracks) = names.iter().map(both).collect::<Option<Vec<_>>>() else { continue };
            let Some([from_s, to_s]) = run.measured.span_s() else { continue };
            for t_s in instants([from_s, to_s], step_s) {
                let measured = tracks
                    .iter()
                    .map(|(_, measured)| Some((measured.at(t_s - HALF_S)?, measured.at(t_s + HALF_S)?)));
                let Some(measured) = measured.collect::<Option<Vec<_>>>() else { continue };
                seen.at_s.push((log, t_s));
                let speeds = measured.iter().map(|(a, b)| (b.position - a.position).abs() / (2.0 * HALF_S));
                seen.speed_rad_s.push(speeds.collect());
            }
        }
        seen
    }

    fn only(&self, keep: impl Fn(&[f64]) -> bool) -> Self {
        let kept: Vec<usize> = (0..self.at_s.len()).filter(|k| keep(&self.speed_rad_s[*k])).collect();
        Self {
            at_s: kept.iter().map(|k| self.at_s[*k]).collect(),
            speed_rad_s: kept.iter().map(|k| self.speed_rad_s[*k].clone()).collect(),
        }
    }
}

fn sum(weights: &[f64], values: &[f64]) -> f64 {
    weights.iter().zip(values).map(|(weight, value)| weight * value).sum()
}

/// The limit that these joints share in their logs, if they do.
pub(super) fn shared(joints: &[(String, JointKind)], logs: &[Observation<'_>]) -> Option<SharedLimit> {
    let names: Vec<String> = joints.iter().map(|joint| joint.0.clone()).collect();
    let spans = logs.iter().filter_map(|log| log.measured.span_s()).map(|[from_s, to_s]| to_s - from_s);
    let step_s = STEP_S.max(spans.sum::<f64>() / MOST);
    let all = Seen::of(&names, logs, step_s);
    let top: Vec<f64> = (0..names.len())
        .map(|joint| quantile(all.speed_rad_s.iter().map(|speeds| speeds[joint]).collect(), 0.995))
        .collect();
    let moves = |speeds: &[f64]| {
        speeds.iter().zip(&top).filter(|(speed, top)| **top > 0.0 && **speed > MOVES * **top).count()
    };
    let some = all.only(|speeds| moves(speeds) >= 2);
    if some.at_s.len() < FEWEST || names.len() < 2 {
        return None;
    }
    let starts = std::iter::once(vec![1.0; names.len()]).chain((0..names.len()).flat_map(|joint| {
        [0.5, 0.25]
            .map(|less| (0..names.len()).map(|other| if other == joint { less } else { 1.0 }).collect())
    }));
    let best = starts.filter_map(|start: Vec<f64>| {
        let weights: Vec<f64> =
            start.iter().zip(&top).map(|(start, top)| start / top.max(f64::MIN_POSITIVE)).collect();
        let sums = some.speed_rad_s.iter().map(|speeds| sum(&weights, speeds)).collect();
        let scale = quantile(sums, 0.95);
        settled(&some, weights.iter().map(|weight| weight / scale).collect())
    });
    let at = |weights: &[f64]| {
        let near = |speeds: &&Vec<f64>| (sum(weights, speeds) - 1.0).abs() < AT;
        some.speed_rad_s.iter().filter(near).count() as f64 / some.at_s.len() as f64
    };
    let weights = best.max_by(|a, b| at(a).total_cmp(&at(b)))?;
    let share = at(&weights);
    let near = some.only(|speeds| (sum(&weights, speeds) - 1.0).abs() < AT);
    let beyond =
        all.speed_rad_s.iter().filter(|speeds| moves(speeds) > 0 && sum(&weights, speeds) > 1.0 + FITTED);
    let moving = all.speed_rad_s.iter().filter(|speeds| moves(speeds) > 0).count();
    let varies = |joint: &usize| {
        let shares: Vec<f64> =
            near.speed_rad_s.iter().map(|speeds| weights[*joint] * speeds[*joint]).collect();
        crate::math::deviation(&shares) > VARIES.min(VARIES_OF_ALL / names.len() as f64)
    };
    // A plan that is made for the limit is at it and held back by nothing.
    let asked = logs.iter().flat_map(|log| {
        let tracks: Vec<&Track> = names.iter().filter_map(|name| log.sent.track(name)).collect();
        let span_s = log.sent.span_s().filter(|_| tracks.len() == names.len()).unwrap_or_default();
        let sums = instants(span_s, step_s)
            .map(move |t_s| tracks.iter().map(|track| speed(track, t_s)).collect::<Vec<f64>>());
        sums.collect::<Vec<_>>()
    });
    let asked = asked.filter(|speeds| moves(speeds) >= 2).map(|speeds| sum(&weights, &speeds)).collect();
    let held = quantile(asked, 0.9) > ASKED;
    let stretches = stretches(&near);
    let is_one = share >= OFTEN
        && (beyond.count() as f64) <= BEYOND * moving as f64
        && (0..names.len()).filter(varies).count() >= 2
        && held
        && stretches.len() >= FEWEST_STRETCHES;
    is_one.then(|| SharedLimit {
        joints: told(joints, &near, &weights, &stretches),
        share,
        duration_s: step_s * near.at_s.len() as f64,
        stretches: stretches.len(),
    })
}

/// Where each stretch at the limit begins among its instants.
fn stretches(near: &Seen) -> Vec<usize> {
    let begins = |k: &usize| {
        let before = k.checked_sub(1).map(|before| near.at_s[before]);
        before.is_none_or(|(log, t_s)| log != near.at_s[*k].0 || near.at_s[*k].1 - t_s > APART_S)
    };
    (0..near.at_s.len()).filter(begins).collect()
}

/// What each joint makes alone, with what that differs by from stretch to stretch; joints that hardly move there are none of it.
fn told(
    joints: &[(String, JointKind)],
    near: &Seen,
    weights: &[f64],
    stretches: &[usize],
) -> Vec<SharedJoint> {
    let ends = stretches.iter().skip(1).copied().chain([near.at_s.len()]);
    // Each stretch left out in turn (jackknife).
    let without: Vec<Vec<f64>> = stretches
        .iter()
        .zip(ends)
        .filter_map(|(from, to)| {
            let left: Vec<&Vec<f64>> = near
                .speed_rad_s
                .iter()
                .enumerate()
                .filter(|(k, _)| !(*from..to).contains(k))
                .map(|(_, speeds)| speeds)
                .collect();
            ones(&left, weights.len())
        })
        .collect();
    let interval = |joint: usize| {
        let alone: Vec<f64> = without.iter().map(|weights| 1.0 / weights[joint]).collect();
        let half = jackknife(&alone).filter(|half| alone.len() >= 4 && half.is_finite())?;
        let value = 1.0 / weights[joint];
        Some([(value - half).max(0.0), value + half])
    };
    let takes = |joint: &usize| near.speed_rad_s.iter().any(|speeds| weights[*joint] * speeds[*joint] > AT);
    (0..joints.len())
        .filter(takes)
        .map(|joint| SharedJoint {
            name: joints[joint].0.clone(),
            kind: joints[joint].1,
            alone_rad_s: 1.0 / weights[joint],
            interval_rad_s: interval(joint),
        })
        .collect()
}

/// Weights for which sums near one are one, from others on; `None` if there are none.
fn settled(some: &Seen, mut weights: Vec<f64>) -> Option<Vec<f64>> {
    for _ in 0..ROUNDS {
        let near: Vec<&Vec<f64>> =
            some.speed_rad_s.iter().filter(|speeds| (sum(&weights, speeds) - 1.0).abs() < FITTED).collect();
        let next = ones(&near, weights.len())?;
        let moved =
            next.iter().zip(&weights).map(|(next, weight)| (next / weight - 1.0).abs()).fold(0.0, f64::max);
        weights = next;
        if moved < 1e-6 {
            break;
        }
    }
    Some(weights)
}

/// The weights by which rows of speeds add up to one, by least squares; `None` unless all are positive.
fn ones(rows: &[&Vec<f64>], joints: usize) -> Option<Vec<f64>> {
    if rows.len() < 4 * joints {
        return None;
    }
    let speeds = DMatrix::from_fn(rows.len(), joints, |k, joint| rows[k][joint]);
    let scale: Vec<f64> = speeds.column_iter().map(|column| column.norm()).collect();
    // A joint that stands there is told nothing of.
    let scaled =
        DMatrix::from_fn(rows.len(), joints, |k, joint| rows[k][joint] / scale[joint].max(f64::MIN_POSITIVE));
    let normal = scaled.transpose() * &scaled + DMatrix::identity(joints, joints) * 1e-9;
    let found = normal.cholesky()?.solve(&(scaled.transpose() * DVector::from_element(rows.len(), 1.0)));
    let weights: Vec<f64> =
        found.iter().zip(&scale).map(|(found, scale)| found / scale.max(f64::MIN_POSITIVE)).collect();
    weights.iter().all(|weight| weight.is_finite() && *weight > 0.0).then_some(weights)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::DEGREE_RAD;

    /// Three joints that follow their plans by their errors, with a dead time, where the sum of what they want is cut to `pump`, and
    /// each to `own`, deg/s; of the second all counts `worth` times.
    fn run(pump: f64, own: f64, worth: f64) -> (Series, Series) {
        let moves: [&[(f64, f64, f64)]; 3] = [
            &[(2.0, 5.0, 40.0), (12.0, 4.0, -25.0), (22.0, 5.0, -15.0)],
            &[(3.0, 4.0, 20.0), (12.5, 4.0, 15.0), (22.0, 4.0, -35.0)],
            &[(2.5, 3.0, -15.0), (13.0, 5.0, 30.0), (23.0, 4.0, -15.0)],
        ];
        let plan = |joint: usize, t_s: f64| -> f64 {
            let step = |(from, lasts, by): &(f64, f64, f64)| {
                let x = ((t_s - from) / lasts).clamp(0.0, 1.0);
                by * x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
            };
            moves[joint].iter().map(step).sum()
        };
        let t_s: Vec<f64> = (0..4000).map(|k| 0.01 * f64::from(k)).collect();
        let (mut at, mut speed) = ([0.0; 3], [0.0; 3]);
        let mut came = [const { Vec::new() }; 3];
        for (k, t) in t_s.iter().enumerate() {
            let weight = [1.0, worth, 1.0];
            let mut want: [f64; 3] =
                std::array::from_fn(|j| ((plan(j, t - 0.06) - at[j]) / 0.22).clamp(-own, own));
            let all: f64 = want.iter().zip(weight).map(|(want, weight)| weight * want.abs()).sum();
            if all > pump {
                want = want.map(|want| want * pump / all);
            }
            for j in 0..3 {
                speed[j] += (want[j] - speed[j]) * 0.2;
                at[j] += 0.01 * speed[j];
                let noise = 0.01 * ((k * 7919 + j * 104_729) % 101) as f64 / 101.0;
                came[j].push((at[j] + noise) * DEGREE_RAD);
            }
        }
        let series = |of: &dyn Fn(usize) -> Vec<f64>| Series {
            tracks: ["slew", "boom", "stick"]
                .iter()
                .enumerate()
                .map(|(j, name)| Track::new(*name, t_s.clone(), of(j), &[]).unwrap())
                .collect(),
        };
        let sent = series(&|j| t_s.iter().map(|t| plan(j, *t) * DEGREE_RAD).collect());
        (sent, series(&|j| came[j].clone()))
    }

    fn found(pump: f64, own: f64, worth: f64) -> Option<SharedLimit> {
        let (sent, measured) = run(pump, own, worth);
        let names = ["slew", "boom", "stick"].map(|name| (name.to_owned(), JointKind::Turns));
        shared(&names, &[Observation { sent: &sent, measured: &measured, valve: &[] }])
    }

    #[test]
    fn joints_that_divide_a_pump_are_told_with_what_each_makes_alone() {
        for (pump, worth) in [(14.0, 1.0), (20.0, 1.0), (17.0, 1.6)] {
            let limit = found(pump, 60.0, worth).unwrap();
            assert!(limit.joints.len() == 3 && limit.stretches >= 2 && limit.share > 0.4, "{limit:?}");
            for (joint, worth) in limit.joints.iter().zip([1.0, worth, 1.0]) {
                let off = joint.alone_rad_s / DEGREE_RAD * worth / pump - 1.0;
                assert!(off.abs() < 0.06, "{pump} {worth}: {joint:?}");
            }
            let (asked, _) = limit.asked(&run(pump, 60.0, worth).0).unwrap();
            assert!(asked > 1.2, "{asked}");
        }
    }

    #[test]
    fn joints_with_limits_of_their_own_and_without_any_share_none() {
        for own in [60.0, 12.0, 10.0, 8.0] {
            assert_eq!(found(1e9, own, 1.0), None, "{own}");
        }
    }
}
