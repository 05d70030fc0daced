//! What the machines of a fleet do alike over the days, with the season, the oil and the work, which is no change of one of them.

use std::collections::BTreeSet;

use super::{history::By, leveled::Leveled};
use crate::math::{column_levels, row_weights, step_scatter, whole};

/// Machines that tell it, at least, at any time.
const FEWEST_MACHINES: usize = 4;
/// With so many machines one of them hardly bends what all do.
const MANY: usize = 10;
/// Largest share of what is common that one machine tells, however quiet it is.
const MOST_SHARE: f64 = 0.3;
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
    /// Of what these joints did; `None` where too few machines tell.
    fn of(metric: By, joints: &[&Leveled]) -> Option<Self> {
        let joints: Vec<&&Leveled> = joints.iter().filter(|joint| joint.usual > 0.0).collect();
        let days = || joints.iter().flat_map(|joint| &joint.levels).map(|level| level.0);
        let (from_days, to_days) = (days().reduce(f64::min)?, days().reduce(f64::max)?);
        let bins = (1..MOST_BINS).find(|bins| *bins as f64 > to_days - from_days).unwrap_or(MOST_BINS);
        let step_days = (to_days - from_days) / bins as f64;
        let at = |bin: usize| from_days + (bin as f64 + 0.5) * step_days;
        let row = |joint: &&&Leveled| -> Vec<f64> {
            let value =
                |bin| interpolated(&joint.levels, at(bin)).map(|level| shared(metric, level, joint.usual));
            (0..bins).map(|bin| value(bin).unwrap_or(f64::NAN)).collect()
        };
        let rows: Vec<Vec<f64>> = joints.iter().map(row).collect();
        let scatter = |joint: &&&Leveled| {
            step_scatter(joint.levels.iter().map(|level| shared(metric, level.1, joint.usual)))
        };
        let mut weights = row_weights(&joints.iter().map(scatter).collect::<Vec<_>>());
        bound(&mut weights, &joints.iter().map(|joint| joint.machine.as_str()).collect::<Vec<_>>());
        let mut levels = column_levels(&rows, &weights, bins);
        for (bin, level) in levels.iter_mut().enumerate() {
            let known = joints.iter().zip(&rows).filter(|(_, row)| row[bin].is_finite());
            let machines: BTreeSet<&str> = known.map(|(joint, _)| joint.machine.as_str()).collect();
            if machines.len() < FEWEST_MACHINES {
                *level = f64::NAN;
            }
        }
        levels.iter().any(|level| level.is_finite()).then_some(Self { from_days, step_days, levels })
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

/// Lessens the weights of joints of machines that tell more than [`MOST_SHARE`] of all.
fn bound(weights: &mut [f64], machines: &[&str]) {
    const SWEEPS: usize = 30;
    let names: BTreeSet<&str> = machines.iter().copied().collect();
    for machine in names.iter().cycle().take(SWEEPS * names.len()) {
        let own = || machines.iter().map(|of| of == machine);
        let sum =
            |is: bool| weights.iter().zip(own()).filter(|(_, own)| *own == is).map(|(w, _)| w).sum::<f64>();
        let by = MOST_SHARE / (1.0 - MOST_SHARE) * sum(false) / sum(true);
        if by < 1.0 {
            weights.iter_mut().zip(own()).filter(|(_, own)| *own).for_each(|(weight, _)| *weight *= by);
        }
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
}
