//! From the columns of a table to the samples of joints.

use std::{f64::consts::TAU, sync::Arc};

use super::{
    lost::{drop_lost, may_be_lost},
    quality::Gaps,
};
use crate::{
    log::source::Table,
    math::range,
    remark::{Code, Remarks},
    series::{Clock, Instants, JointKind, Quantity, Signal, Track, all_finite, split_at_gaps},
    units::seconds_since,
};

/// The time axis that all joints of a table share.
pub(super) struct Axis {
    t_s: Arc<[f64]>,
    /// The times with their cuts, if the rows are all there, as they lie in the table, and times increase.
    as_read: Option<Instants>,
    /// Rows of the table at these times; empty if they are all there, as they lie in the table.
    rows: Vec<usize>,
    /// Backward jumps of the clock.
    jumps: Vec<usize>,
    /// Jumps and gaps.
    cuts: Vec<usize>,
    /// Least time between neighbours.
    shortest_s: f64,
}

impl Axis {
    pub(super) fn new(clock: Clock, epoch_ns: i64) -> Self {
        let Clock { t_ns, mut rows, cuts: jumps, .. } = clock;
        let whole = rows.iter().enumerate().all(|(i, &row)| i == row);
        if whole {
            rows = Vec::new();
        }
        let t_s: Arc<[f64]> = t_ns.iter().map(|&ns| seconds_since(epoch_ns, ns)).collect();
        drop(t_ns);
        let shortest_s = t_s.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min);
        let cuts = cuts(&t_s, &jumps);
        let as_read = if whole { Instants::new(t_s.clone(), &cuts).ok() } else { None };
        Self { t_s, as_read, rows, jumps, cuts, shortest_s }
    }

    /// Number of samples.
    pub(super) fn len(&self) -> usize {
        self.t_s.len()
    }

    /// The row of the table at time `i`.
    fn row(&self, i: usize) -> usize {
        self.rows.get(i).copied().unwrap_or(i)
    }

    /// Whether the values of a column are finite, and none of them a spike or lost if they are positions in such a unit.
    fn is_sound(&self, values: &[f64], positions: Option<f64>) -> bool {
        let Some(unit) = positions else { return all_finite(values) };
        let (n, t_s, at) = (values.len(), |i: usize| self.t_s[i], |i: usize| unit * values[i]);
        let spiked = || (0..n).any(|k| is_spike(k, n, t_s, at) || may_be_spike(k, n, t_s, at));
        let calm = || is_calm(values, self.shortest_s, unit) || all_finite(values) && !spiked();
        !may_be_lost(values) && calm()
    }

    /// The axis without the samples that are missing in a column: times, cuts and jumps.
    fn kept(&self, kept: &[usize]) -> (Arc<[f64]>, Vec<usize>, Vec<usize>) {
        let jumps: Vec<usize> = self.jumps.iter().map(|cut| kept.partition_point(|i| i < cut)).collect();
        if kept.len() == self.t_s.len() {
            return (self.t_s.clone(), self.cuts.clone(), jumps);
        }
        let t_s: Arc<[f64]> = kept.iter().map(|&i| self.t_s[i]).collect();
        let cuts = cuts(&t_s, &jumps);
        (t_s, cuts, jumps)
    }
}

/// Samples of one field of one joint: finite, in order of time, in the unit of the log.
pub(super) struct Samples {
    pub(super) name: String,
    instants: Instants,
    values: Vec<f64>,
    /// As many as values where the log gives velocities.
    velocity: Vec<f64>,
}

impl Samples {
    /// As the track of a joint, of values in units of so much; velocities that do not agree with the positions are left out.
    pub(super) fn into_track(mut self, kind: JointKind, scale: f64) -> Option<Track> {
        if (scale - 1.0).abs() > 0.0 {
            self.values.iter_mut().chain(&mut self.velocity).for_each(|value| *value *= scale);
        }
        let track = Track::on(&self.instants, kind, self.name, self.values).ok()?;
        Some(track.with_velocity_that_agrees(self.velocity))
    }

    pub(super) fn into_signal(self, quantity: Quantity) -> Option<Signal> {
        Signal::on(&self.instants, self.name, quantity, self.values).ok()
    }
}

/// The field to read of a table, and how.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reading<F> {
    pub(super) field: usize,
    /// The unit, m, of a joint whose positions these are if the caller gave one, else 1; `None` where values are no positions.
    /// Impossible positions are dropped.
    pub(super) unit: Option<F>,
    /// Whether this is the last use of the field, so that its samples may be moved out of the table.
    pub(super) last: bool,
}

/// The samples of a table's field, by joint.
pub(super) fn samples(
    table: &mut Table,
    Reading { field, unit, last }: Reading<impl Fn(&str) -> f64>,
    axis: &Axis,
    topic: &str,
    remarks: &mut Remarks,
) -> Vec<Samples> {
    let mut found = Vec::new();
    let mut gap = Gaps::default();
    let (mut spikes, mut lost) = (Dropped::default(), Dropped::default());
    let velocity_field = table.fields[field].velocity.filter(|_| unit.is_some());
    for (joint, name) in table.joints.clone().into_iter().enumerate() {
        let mut column =
            |field| if last { table.take_column(field, joint) } else { table.column(field, joint).to_vec() };
        let (values, speed) = (column(field), velocity_field.map(column).unwrap_or_default());
        let positions = unit.as_ref().map(|unit| unit(&name));
        let sound = |_: &&Instants| values.len() == axis.t_s.len() && axis.is_sound(&values, positions);
        let (instants, values, velocity) = if let Some(as_read) = axis.as_read.as_ref().filter(sound) {
            gap.note(&axis.t_s, &axis.cuts, &axis.jumps);
            (as_read.clone(), values, speed)
        } else {
            let at = |i: usize| values.get(axis.row(i)).copied().unwrap_or(f64::NAN);
            let mut kept: Vec<usize> = (0..axis.t_s.len()).filter(|&i| at(i).is_finite()).collect();
            // Far from the epoch neighbouring nanoseconds are the same second.
            kept.dedup_by(|later, earlier| axis.t_s[*later] <= axis.t_s[*earlier]);
            if let Some(unit) = positions {
                // A zero is a reading that was lost before it is a jump.
                lost.note((&name, &axis.t_s), &mut kept, |kept| drop_lost(kept, &axis.t_s, |i| unit * at(i)));
                spikes.note((&name, &axis.t_s), &mut kept, |kept| {
                    drop_spikes(kept, &axis.t_s, |i| unit * at(i))
                });
            }
            let (t_s, cuts, jumps) = axis.kept(&kept);
            gap.note(&t_s, &cuts, &jumps);
            let Ok(instants) = Instants::new(t_s, &cuts) else { continue };
            let speed = kept.iter().map_while(|&i| speed.get(axis.row(i)).copied()).collect();
            (instants, kept.iter().map(|&i| at(i)).collect(), speed)
        };
        found.push(Samples { name, instants, values, velocity });
    }
    gap.remark(topic, remarks);
    let Dropped { count, first } = spikes;
    let message =
        format!("values of {topic} that no joint can have (a jump there and back at once){first}; dropped");
    remarks.add(Code::Implausible, count, message);
    let Dropped { count, first } = lost;
    let message = format!(
        "values of {topic} that are exactly 0 once, between values that agree and are not near it: readings that were \
         lost{first}; dropped"
    );
    remarks.add(Code::Implausible, count, message);
    found
}

/// How many values were dropped, and in words which was the first.
#[derive(Default)]
struct Dropped {
    count: u64,
    first: String,
}

impl Dropped {
    fn note(&mut self, at: (&str, &[f64]), kept: &mut Vec<usize>, drop: impl Fn(&mut Vec<usize>) -> u64) {
        let (before, (joint, t_s)) = (kept.clone(), at);
        self.count += drop(kept);
        let first = before.iter().find(|i| kept.binary_search(i).is_err());
        if let Some(&i) = first.filter(|_| self.first.is_empty()) {
            self.first = format!(", first of {joint} at {:.2} s", t_s[i]);
        }
    }
}

/// Faster than any joint, rad/s or m/s (deg/s where the log is in degrees).
const FASTEST: f64 = 200.0;
/// Faster than any joint there and back within two samples, in the same units, and how far off at least; with
/// neighbours that are calm by comparison.
const FAST: f64 = 20.0;
const FAR: f64 = 0.5;
/// Less so, where more neighbours are as calm, on either side: noise is not. An encoder of few steps may flicker by some
/// of them.
const LESS_FAST: f64 = 5.0;
const LESS_FAR: f64 = 0.05;
const NEIGHBOURS: usize = 8;
const STEPS: f64 = 10.0;
/// Steps of the neighbours by the sample's own.
const CALM: f64 = 0.1;
/// Larger than any position, in radians, degrees or metres.
const LARGEST: f64 = 1e6;

/// How far a sample is from both its neighbours on one side, and how fast; `None` at the ends, on the way, or by a full
/// turn, which is a joint without end stops.
fn off(k: usize, n: usize, t_s: impl Fn(usize) -> f64, at: impl Fn(usize) -> f64) -> Option<[f64; 2]> {
    if k == 0 || k + 1 >= n {
        return None;
    }
    let (there, back) = (at(k) - at(k - 1), at(k + 1) - at(k));
    let turn = || [TAU, 360.0].iter().any(|turn| (there.abs() - turn).abs() < 0.1 * turn);
    if there * back >= 0.0 || turn() {
        return None;
    }
    let speed = (there.abs() / (t_s(k) - t_s(k - 1))).min(back.abs() / (t_s(k + 1) - t_s(k)));
    Some([there.abs().min(back.abs()), speed])
}

/// Whether so many neighbours on either side of a sample are calm by how far it is off.
fn is_alone(k: usize, n: usize, neighbours: usize, far: f64, at: impl Fn(usize) -> f64) -> bool {
    let calm = |a: usize, b: usize| (at(b) - at(a)).abs() < CALM * far;
    calm(k - 1, k + 1)
        && (k.saturating_sub(neighbours + 1)..k - 1).all(|i| calm(i, i + 1))
        && (k + 1..(k + 1 + neighbours).min(n - 1)).all(|i| calm(i, i + 1))
}

/// Whether sample `k` of `n` is no position of a joint: too large, or off both its neighbours faster than any
/// joint moves.
fn is_spike(k: usize, n: usize, t_s: impl Fn(usize) -> f64, at: impl Fn(usize) -> f64) -> bool {
    at(k).abs() > LARGEST
        || off(k, n, t_s, &at).is_some_and(|[far, speed]| {
            speed > FASTEST || far > FAR && speed > FAST && is_alone(k, n, 1, far, at)
        })
}

/// Whether it may be one: less far off, between more neighbours that are calm.
fn may_be_spike(k: usize, n: usize, t_s: impl Fn(usize) -> f64, at: impl Fn(usize) -> f64) -> bool {
    n > 2 * NEIGHBOURS
        && off(k, n, t_s, &at).is_some_and(|[far, speed]| {
            far > LESS_FAR && speed > LESS_FAST && is_alone(k, n, NEIGHBOURS, far, at)
        })
}

/// Whether no value is a spike or no number because none is large and no step is: a quick look that spares the closer
/// one. It has no branch on any value, so that the compiler takes several at once.
fn is_calm(values: &[f64], shortest_s: f64, unit: f64) -> bool {
    let (step, largest) = (LESS_FAR.min(FASTEST * shortest_s) / unit, LARGEST / unit);
    let near = |value: f64| value.abs() <= largest;
    let pairs = values.iter().zip(values.get(1..).unwrap_or_default());
    pairs.fold(values.last().is_none_or(|last| near(*last)), |calm, (here, next)| {
        calm & near(*here) & ((next - here).abs() <= step)
    })
}

/// Drops samples that no joint can have; returns how many.
fn drop_spikes(kept: &mut Vec<usize>, t_s: &[f64], at: impl Fn(usize) -> f64) -> u64 {
    let (n, t_s, value) = (kept.len(), |k: usize| t_s[kept[k]], |k: usize| at(kept[k]));
    let mut spikes: Vec<usize> = (0..n).filter(|&k| is_spike(k, n, t_s, value)).collect();
    let maybe: Vec<usize> = (0..n).filter(|&k| may_be_spike(k, n, t_s, value)).collect();
    if !maybe.is_empty() {
        let beside = |k: usize| maybe.binary_search(&k).is_ok() || maybe.binary_search(&(k + 1)).is_ok();
        let steps = (0..n - 1).filter(|&k| !beside(k)).map(|k| (value(k + 1) - value(k)).abs());
        let smallest = steps.filter(|step| *step > 0.0).fold(f64::INFINITY, f64::min);
        let far = |k: &usize| (value(*k) - value(k - 1)).abs() > STEPS * smallest;
        spikes.extend(maybe.iter().copied().filter(far));
        spikes.sort_unstable();
        spikes.dedup();
    }
    if let Some(code) = code_of(&spikes, n, value) {
        spikes.extend(runs_of(code, n, value));
        spikes.sort_unstable();
        spikes.dedup();
    }
    let mut k = 0;
    kept.retain(|_| {
        k += 1;
        spikes.binary_search(&(k - 1)).is_err()
    });
    spikes.len() as u64
}

/// So many equal values that no joint can have are the code of a reading that failed, which may come several times in a row.
const CODE: usize = 3;
const LONGEST_RUN: usize = 3;

/// The value that most of these samples share, if they are a code: beyond what the joint goes to, by more than its range.
fn code_of(spikes: &[usize], n: usize, value: impl Fn(usize) -> f64) -> Option<f64> {
    let mut values: Vec<f64> = spikes.iter().map(|k| value(*k)).collect();
    values.sort_unstable_by(f64::total_cmp);
    let code = *values.get(values.len() / 2)?;
    let equal = values.iter().filter(|one| one.total_cmp(&code).is_eq()).count();
    let joint = (0..n).filter(|k| spikes.binary_search(k).is_err()).map(&value);
    let [lowest, highest] = range(joint.filter(|at| at.total_cmp(&code).is_ne()));
    let beyond = (lowest - code).max(code - highest) > (highest - lowest).max(FAR);
    (equal >= CODE && 2 * equal > spikes.len() && beyond).then_some(code)
}

/// Samples of a code in runs that begin and end with a jump, or where the log does.
fn runs_of(code: f64, n: usize, value: impl Fn(usize) -> f64) -> Vec<usize> {
    let is = |k: usize| value(k).total_cmp(&code).is_eq();
    let far = |k: usize| (value(k) - code).abs() > FAR;
    let (mut found, mut from) = (Vec::new(), 0);
    while from < n {
        let end = (from..n).find(|k| !is(*k)).unwrap_or(n);
        let apart = (from == 0 || far(from - 1)) && (end == n || far(end));
        if apart && (1..=LONGEST_RUN).contains(&(end - from)) {
            found.extend(from..end);
        }
        from = end + 1;
    }
    found
}

/// Clock jumps and gaps together, ascending, inside the samples.
fn cuts(t_s: &[f64], jumps: &[usize]) -> Vec<usize> {
    let mut cuts: Vec<usize> = split_at_gaps(t_s)
        .into_iter()
        .chain(jumps.iter().copied())
        .filter(|&cut| cut > 0 && cut < t_s.len())
        .collect();
    cuts.sort_unstable();
    cuts.dedup();
    cuts
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many of the values of a joint at 100 Hz are dropped.
    fn dropped(value: impl Fn(usize) -> f64) -> u64 {
        let t_s: Vec<f64> = (0..200).map(|k| f64::from(k) * 0.01).collect();
        drop_spikes(&mut (0..200).collect(), &t_s, value)
    }

    #[test]
    fn single_values_far_from_calm_neighbours_are_dropped_and_noise_is_not() {
        // Five degrees at 10 deg/s, with noise of an encoder.
        let moving = |k: usize| 0.2 + 0.0018 * k as f64 + 1e-4 * (k * 7919 % 13) as f64;
        let spike = |k: usize| if k % 60 == 30 { 0.09 } else { 0.0 };
        assert_eq!((dropped(moving), dropped(|k| moving(k) + spike(k))), (0, 3));
        let failed = [0, 30, 31, 32, 60, 90, 150, 199];
        let code = |k: usize| if failed.contains(&k) { -174.5 } else { moving(k) };
        assert_eq!(dropped(code), 8, "a code, at the ends and several times in a row, too");
        let noise = |k: usize| 0.1 * ((k * 7919 + k * k * 31) % 101) as f64 / 101.0;
        assert_eq!(dropped(noise), 0);
        let flickers = |k: usize| 0.1 * (k / 90) as f64 + if k == 30 { 0.1 } else { 0.0 };
        assert_eq!(dropped(flickers), 0, "an encoder of few steps");
        assert_eq!(dropped(|k| if k >= 100 { 0.5 } else { 0.2 }), 0, "a step");
        assert_eq!(
            dropped(|k| 0.2 + 0.09 * f64::from(u8::from((100..102).contains(&k)))),
            0,
            "of two samples"
        );
    }
}
