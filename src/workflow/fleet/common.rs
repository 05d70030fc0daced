//! What the machines of a fleet do alike over the days, with the season, the oil and the work, which is no change of one of them.

use std::collections::{BTreeMap, BTreeSet};

use statrs::distribution::{ContinuousCDF as _, FisherSnedecor};

use super::{history::By, leveled::Leveled};
use crate::math::{column_levels, mean, median, whole};

/// Machines that tell it, at least, at any time.
const FEWEST_MACHINES: usize = 4;
/// With so many machines one of them hardly bends what all do.
const MANY: usize = 10;
/// Largest share of what is common that one machine tells, however quiet it is.
const MOST_SHARE: f64 = 0.3;
/// A machine nearer to the others than by this share of the usual mean square says no more than one just so near.
const LEAST_OFF: f64 = 0.04;
/// What machines that share nothing would do alike more often is nothing.
const CHANCE: f64 = 0.01;
/// Days are told apart by so many at most.
const MOST_BINS: usize = 200;
/// Share of the instants of a joint at which it must be known.
const KNOWN: f64 = 0.9;

/// The common course of one metric, of all machines but one or of all, about its middle: of peak errors as a share of their level.
pub(super) struct Common {
    from_days: f64,
    step_days: f64,
    levels: Vec<f64>,
}

/// A level in the unit in which joints are alike.
fn shared(metric: By, level: f64, usual: f64) -> f64 {
    if metric == By::Peak { level / usual } else { level }
}

impl Common {
    /// Of what these joints did: nothing where they agree no more than by chance. `None` where too few machines tell.
    pub(super) fn of(metric: By, joints: &[&Leveled]) -> Option<Self> {
        let joints: Vec<&&Leveled> = joints.iter().filter(|joint| joint.usual > 0.0).collect();
        let days = || joints.iter().flat_map(|joint| &joint.levels).map(|level| level.0);
        let (from_days, to_days) = (days().reduce(f64::min)?, days().reduce(f64::max)?);
        let bins = (1..MOST_BINS).find(|bins| *bins as f64 > to_days - from_days).unwrap_or(MOST_BINS);
        let step_days = (to_days - from_days) / bins as f64;
        let at = |bin: usize| from_days + (bin as f64 + 0.5) * step_days;
        let mut machines: BTreeMap<&str, Vec<Vec<f64>>> = BTreeMap::new();
        for joint in &joints {
            let value =
                |bin| interpolated(&joint.levels, at(bin)).map(|level| shared(metric, level, joint.usual));
            let row = (0..bins).map(|bin| value(bin).unwrap_or(f64::NAN)).collect();
            machines.entry(&joint.machine).or_default().push(row);
        }
        // One machine is one witness, however many joints it has and however quiet they are.
        let course = |own: &Vec<Vec<f64>>| column_levels(own, &vec![1.0; own.len()], bins);
        let courses: Vec<Vec<f64>> = machines.values().map(course).collect();
        let runs = median(joints.iter().map(|joint| joint.levels.len() as f64).collect());
        let mut levels = agreed(&courses, runs, bins);
        for (bin, level) in levels.iter_mut().enumerate() {
            if courses.iter().filter(|own| own[bin].is_finite()).count() < FEWEST_MACHINES {
                *level = f64::NAN;
            }
        }
        levels.iter().any(|level| level.is_finite()).then_some(Self { from_days, step_days, levels })
    }

    /// Where it is known, days since 1970 and level.
    pub(super) fn points(&self) -> Vec<(f64, f64)> {
        let at = |bin: usize| self.from_days + (bin as f64 + 0.5) * self.step_days;
        let all = self.levels.iter().enumerate().map(|(bin, level)| (at(bin), *level));
        all.filter(|(_, level)| level.is_finite()).collect()
    }

    /// At the instants of a joint, in its unit; the nearest that is known where it is not. `None` where that is so too often.
    pub(super) fn at(&self, metric: By, joint: &Leveled) -> Option<Vec<f64>> {
        let last = self.levels.len() - 1;
        let bin =
            |days: f64| whole((days - self.from_days) / self.step_days.max(f64::MIN_POSITIVE)).min(last);
        let known = |bin: &usize| self.levels[*bin].is_finite();
        let bins: Vec<usize> = joint.levels.iter().map(|level| bin(level.0)).collect();
        let enough = bins.iter().filter(|bin| known(bin)).count() as f64 >= KNOWN * bins.len() as f64;
        let nearest = |at: usize| (0..=last).filter(known).min_by_key(|bin| bin.abs_diff(at));
        let scale = if metric == By::Peak { joint.usual } else { 1.0 };
        enough.then(|| bins.into_iter().filter_map(|at| Some(scale * self.levels[nearest(at)?])).collect())
    }
}

/// Common courses by what they leave out: one machine, where that could bend them.
pub(super) struct Commons(Vec<One>);

/// The metric and the direction of starts, the machine that is left out, and the course.
type One = (By, Option<i8>, Option<String>, Option<Common>);

impl Commons {
    /// Of all joints, each with its metric and direction.
    pub(super) fn of(joints: &[Leveled]) -> Self {
        let keys: BTreeSet<(By, Option<i8>)> =
            joints.iter().map(|joint| (joint.metric, joint.direction)).collect();
        let mut all = Vec::new();
        for (metric, direction) in keys {
            let alike: Vec<&Leveled> = joints
                .iter()
                .filter(|joint| (joint.metric, joint.direction) == (metric, direction))
                .collect();
            let machines: BTreeSet<&str> = alike.iter().map(|joint| joint.machine.as_str()).collect();
            if machines.len() > MANY {
                all.push((metric, direction, None, Common::of(metric, &alike)));
                continue;
            }
            for machine in machines {
                let others: Vec<&Leveled> =
                    alike.iter().copied().filter(|joint| joint.machine != machine).collect();
                all.push((metric, direction, Some(machine.to_owned()), Common::of(metric, &others)));
            }
        }
        Self(all)
    }

    /// What the other machines did at the instants of a joint, in its unit.
    pub(super) fn at(&self, joint: &Leveled) -> Option<Vec<f64>> {
        let own = |(metric, direction, machine, _): &&One| {
            (*metric, *direction) == (joint.metric, joint.direction)
                && machine.as_ref().is_none_or(|machine| *machine == joint.machine)
        };
        let (.., common) = self.0.iter().find(own)?;
        common.as_ref()?.at(joint.metric, joint)
    }
}

/// What some machines do alike: at any time the middle, in which a machine that goes its own way counts for little. Nothing where those
/// that agree best agree no more than by chance.
fn agreed(courses: &[Vec<f64>], runs: f64, bins: usize) -> Vec<f64> {
    const SWEEPS: usize = 5;
    let mut weights = vec![1.0; courses.len()];
    let (mut levels, mut off) = (Vec::new(), Vec::new());
    for _ in 0..SWEEPS {
        bound(&mut weights);
        levels = column_levels(courses, &weights, bins);
        let square = |own: &Vec<f64>| {
            let off = own.iter().zip(&levels).map(|(own, level)| own - level).filter(|off| off.is_finite());
            let off: Vec<f64> = off.collect();
            let middle = mean(&off);
            mean(&off.iter().map(|off| (off - middle).powi(2)).collect::<Vec<f64>>())
        };
        off = courses.iter().map(square).map(|off| if off.is_finite() { off } else { f64::MAX }).collect();
        let least = (LEAST_OFF * median(off.clone())).max(f64::MIN_POSITIVE.sqrt());
        weights = off.iter().map(|off| 1.0 / off.max(least)).collect();
    }
    // One machine that went its own way makes no agreement.
    let alone = (0..off.len()).max_by(|a, b| off[*a].total_cmp(&off[*b]));
    let others = courses.iter().enumerate().filter(|(k, _)| Some(*k) != alone).map(|(_, own)| own);
    if p_of_chance(&others.collect::<Vec<_>>(), runs, bins) > CHANCE { vec![0.0; bins] } else { levels }
}

/// Probability that machines which share nothing agree as well as these: that of Fisher's F, of the instants against what is left of
/// machines and instants. Between its runs a machine tells nothing new.
fn p_of_chance(courses: &[&Vec<f64>], runs: f64, bins: usize) -> f64 {
    let centred = |own: &&Vec<f64>| -> Vec<f64> {
        let middle = mean(&own.iter().copied().filter(|level| level.is_finite()).collect::<Vec<f64>>());
        own.iter().map(|level| level - middle).collect()
    };
    let courses: Vec<Vec<f64>> = courses.iter().map(centred).collect();
    let (mut between, mut left, mut told) = (0.0, 0.0, 0.0_f64);
    for bin in 0..bins {
        let known: Vec<f64> = courses.iter().map(|own| own[bin]).filter(|level| level.is_finite()).collect();
        if known.len() + 1 >= FEWEST_MACHINES {
            let middle = mean(&known);
            between += known.len() as f64 * middle * middle;
            left += known.iter().map(|level| (level - middle).powi(2)).sum::<f64>();
            told += 1.0;
        }
    }
    let freedom = told.min(runs) - 1.0;
    let machines = courses.len() as f64 - 1.0;
    let ratio = between * machines / left.max(f64::MIN_POSITIVE);
    FisherSnedecor::new(freedom, freedom * machines).map_or(1.0, |f| f.sf(ratio))
}

/// Lessens weights that are more than [`MOST_SHARE`] of all.
fn bound(weights: &mut [f64]) {
    const SWEEPS: usize = 30;
    for at in (0..weights.len()).cycle().take(SWEEPS * weights.len()) {
        let others = weights.iter().sum::<f64>() - weights[at];
        weights[at] = weights[at].min(MOST_SHARE / (1.0 - MOST_SHARE) * others);
    }
}

/// Between the points around an instant; `None` outside them.
fn interpolated(points: &[(f64, f64)], at: f64) -> Option<f64> {
    let after = points.partition_point(|point| point.0 < at);
    let (a, b) = (points.get(after.checked_sub(1)?)?, points.get(after)?);
    Some(a.1 + (b.1 - a.1) * (at - a.0) / (b.0 - a.0).max(f64::MIN_POSITIVE))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joint(machine: u32, of: impl Fn(f64) -> f64) -> Leveled {
        let levels =
            (0..30).map(|k| f64::from(3 * k) + 0.1 * f64::from(machine)).map(|t| (t, of(t))).collect();
        Leveled {
            machine: machine.to_string(),
            metric: By::Peak,
            levels,
            usual: f64::from(machine + 1),
            ..Leveled::default()
        }
    }

    #[test]
    fn what_all_do_in_proportion_is_common_and_what_one_does_is_not() {
        let season = |t: f64| 0.2 * (t / 20.0).sin();
        let mut joints: Vec<Leveled> =
            (0..6).map(|machine| joint(machine, |t| f64::from(machine + 1) * season(t))).collect();
        for level in &mut joints[2].levels[15..] {
            level.1 += 3.0;
        }
        let commons = Commons::of(&joints);
        for own in &joints {
            let common = commons.at(own).unwrap();
            let middle = |k: usize| own.usual * (season(own.levels[k].0) - season(own.levels[3].0));
            for k in 3..27 {
                let off = common[k] - common[3] - middle(k);
                assert!(off.abs() < 0.02 * own.usual, "{} {k}: {off}", own.machine);
            }
        }
        assert!(Commons::of(&joints[..4]).at(&joints[0]).is_none(), "three others tell nothing");
    }

    #[test]
    fn one_quiet_machine_is_not_what_all_do() {
        let noise = |machine: u32, t: f64| 0.1 * (f64::from(machine) * 7.0 + t * t).sin();
        let mut joints: Vec<Leveled> =
            (0..6).map(|machine| joint(machine, |t| f64::from(machine + 1) * noise(machine, t))).collect();
        let rises = |t: f64| 0.01 * noise(5, t) + if t > 45.0 { 3.0 } else { 0.0 };
        joints[5] = joint(5, rises);
        let common = Commons::of(&joints).at(&joints[0]).unwrap();
        assert!(common.iter().all(|level| level.abs() < 0.15), "{common:?}");
    }

    #[test]
    fn one_machine_that_drifts_is_nothing_that_all_do_and_a_season_beside_it_is() {
        let noise = |machine: u32, t: f64| 0.1 * (f64::from(machine) * 7.0 + t * t).sin();
        let drift = |machine: u32, t: f64| if machine == 3 { 0.02 * t } else { 0.0 };
        let season = |t: f64| 0.5 * (t / 20.0).sin();
        let of = |with: f64| -> Vec<Leveled> {
            let own = |machine: u32, t: f64| noise(machine, t) + drift(machine, t) + with * season(t);
            (0..5).map(|machine| joint(machine, |t| f64::from(machine + 1) * own(machine, t))).collect()
        };
        let joints = of(0.0);
        let common = Commons::of(&joints).at(&joints[0]).unwrap();
        assert!(common.iter().all(|level| level.abs() < 1e-12), "{common:?}");
        let joints = of(1.0);
        let common = Commons::of(&joints).at(&joints[0]).unwrap();
        let off = |k: usize| common[k] - season(joints[0].levels[k].0);
        assert!((2..28).all(|k| (off(k) - off(15)).abs() < 0.2), "{common:?}");
    }
}
