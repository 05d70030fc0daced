//! From the columns of a table to the samples of joints.

use std::{f64::consts::TAU, sync::Arc};

use super::quality::Gaps;
use crate::{
    log::source::Table,
    remark::{Code, Remarks},
    series::{Clock, JointKind, Quantity, Signal, Track, split_at_gaps, velocity_agrees},
    units::{radians_from_degrees, seconds_since},
};

/// The time axis that all joints of a table share.
pub(super) struct Axis {
    t_s: Arc<[f64]>,
    /// Rows of the table at these times; empty if they are all there, as they lie in the table.
    rows: Vec<usize>,
    /// Backward jumps of the clock.
    jumps: Vec<usize>,
    /// Jumps and gaps.
    cuts: Vec<usize>,
    /// Whether the rows are all there, as they lie in the table, and times increase.
    as_read: bool,
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
        let as_read = whole && shortest_s > 0.0;
        Self { cuts: cuts(&t_s, &jumps), t_s, rows, jumps, as_read, shortest_s }
    }

    /// Number of samples.
    pub(super) fn len(&self) -> usize {
        self.t_s.len()
    }

    /// The row of the table at time `i`.
    fn row(&self, i: usize) -> usize {
        self.rows.get(i).copied().unwrap_or(i)
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
    t_s: Arc<[f64]>,
    cuts: Vec<usize>,
    values: Vec<f64>,
    /// As many as values where the log gives velocities.
    velocity: Vec<f64>,
}

impl Samples {
    /// As the track of a joint; velocities that do not agree with the positions are left out.
    pub(super) fn into_track(mut self, kind: JointKind, degrees: bool) -> Option<Track> {
        if degrees && kind == JointKind::Turns {
            let all = self.values.iter_mut().chain(&mut self.velocity);
            all.for_each(|value| *value = radians_from_degrees(*value));
        }
        let usable = self.velocity.len() == self.values.len()
            && self.velocity.iter().all(|v| v.is_finite())
            && velocity_agrees(&self.t_s, &self.values, &self.velocity, &self.cuts);
        let track = Track::of(kind, self.name, self.t_s, self.values, &self.cuts).ok()?;
        if usable { track.with_velocity(self.velocity).ok() } else { Some(track) }
    }

    pub(super) fn into_signal(self, quantity: Quantity) -> Option<Signal> {
        Signal::new(self.name, quantity, self.t_s, self.values, &self.cuts).ok()
    }
}

/// The field to read of a table, and how.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reading {
    pub(super) field: usize,
    /// Whether values are positions of joints, so that impossible ones are dropped.
    pub(super) positions: bool,
    /// Whether this is the last use of the field, so that its samples may be moved out of the table.
    pub(super) last: bool,
}

/// The samples of a table's field, by joint.
pub(super) fn samples(
    table: &mut Table,
    Reading { field, positions, last }: Reading,
    axis: &Axis,
    topic: &str,
    remarks: &mut Remarks,
) -> Vec<Samples> {
    let mut found = Vec::new();
    let mut gap = Gaps::default();
    let mut spikes = 0;
    let velocity_field = table.fields[field].velocity.filter(|_| positions);
    for (joint, name) in table.joints.clone().into_iter().enumerate() {
        let mut column =
            |field| if last { table.take_column(field, joint) } else { table.column(field, joint).to_vec() };
        let (values, speed) = (column(field), velocity_field.map(column).unwrap_or_default());
        let spiked = || (0..values.len()).any(|k| is_spike(k, values.len(), |i| axis.t_s[i], |i| values[i]));
        let whole = axis.as_read
            && values.len() == axis.t_s.len()
            && values.iter().all(|q| q.is_finite())
            && !(positions && !calm(&values, axis.shortest_s) && spiked());
        let ((t_s, cuts, jumps), values, velocity) = if whole {
            ((axis.t_s.clone(), axis.cuts.clone(), axis.jumps.clone()), values, speed)
        } else {
            let at = |i: usize| values.get(axis.row(i)).copied().unwrap_or(f64::NAN);
            let mut kept: Vec<usize> = (0..axis.t_s.len()).filter(|&i| at(i).is_finite()).collect();
            // Far from the epoch neighbouring nanoseconds are the same second.
            kept.dedup_by(|later, earlier| axis.t_s[*later] <= axis.t_s[*earlier]);
            if positions {
                spikes += drop_spikes(&mut kept, &axis.t_s, at);
            }
            if kept.is_empty() {
                continue;
            }
            let speed = kept.iter().map_while(|&i| speed.get(axis.row(i)).copied()).collect();
            (axis.kept(&kept), kept.iter().map(|&i| at(i)).collect(), speed)
        };
        gap.note(&t_s, &cuts, &jumps);
        found.push(Samples { name, t_s, cuts, values, velocity });
    }
    gap.remark(topic, remarks);
    let message =
        format!("values of {topic} that no joint can have (a jump there and back at once), dropped");
    remarks.add(Code::Implausible, spikes, message);
    found
}

/// Faster than any joint, rad/s or m/s (deg/s where the log is in degrees).
const FASTEST: f64 = 200.0;
/// Faster than any joint there and back within two samples, in the same units, and how far off at least; with
/// neighbours that are calm by comparison.
const FAST: f64 = 20.0;
const FAR: f64 = 0.5;
/// Steps of the neighbours by the sample's own.
const CALM: f64 = 0.1;
/// Larger than any position, in radians, degrees or metres.
const LARGEST: f64 = 1e6;

/// Whether sample `k` of `n` is no position of a joint: too large, or off both its neighbours faster than any
/// joint moves. A full turn there and back is a joint without end stops.
fn is_spike(k: usize, n: usize, t_s: impl Fn(usize) -> f64, at: impl Fn(usize) -> f64) -> bool {
    if at(k).abs() > LARGEST {
        return true;
    }
    if k == 0 || k + 1 >= n {
        return false;
    }
    let (there, back) = (at(k) - at(k - 1), at(k + 1) - at(k));
    if there * back >= 0.0 {
        return false;
    }
    let (before_s, after_s) = (t_s(k) - t_s(k - 1), t_s(k + 1) - t_s(k));
    let turn = || [TAU, 360.0].iter().any(|turn| (there.abs() - turn).abs() < 0.1 * turn);
    let faster = |speed: f64| there.abs() > speed * before_s && back.abs() > speed * after_s;
    let least = there.abs().min(back.abs());
    let step = |i: usize| (at(i + 1) - at(i)).abs();
    let alone = || {
        let calm = |step: f64| step < CALM * least;
        calm((at(k + 1) - at(k - 1)).abs())
            && (k < 2 || calm(step(k - 2)))
            && (k + 2 >= n || calm(step(k + 1)))
    };
    (faster(FASTEST) || least > FAR && faster(FAST) && alone()) && !turn()
}

/// Whether no value is a spike because none is large and no step is: a quick look that spares the closer one.
fn calm(values: &[f64], shortest_s: f64) -> bool {
    // Lanes, so that the compiler takes several values at once.
    let mut largest = [0.0_f64; 8];
    let mut step = [0.0_f64; 8];
    let later = values.get(1..).unwrap_or_default();
    for (here, next) in values.chunks(8).zip(later.chunks(8)) {
        for (k, (&a, &b)) in here.iter().zip(next).enumerate() {
            largest[k] = largest[k].max(a.abs());
            step[k] = step[k].max((b - a).abs());
        }
    }
    let most = |lanes: [f64; 8]| lanes.into_iter().fold(0.0, f64::max);
    let last = values.last().map_or(0.0, |last| last.abs());
    most(largest).max(last) <= LARGEST && most(step) <= FAR.min(FASTEST * shortest_s)
}

/// Drops samples that no joint can have; returns how many.
fn drop_spikes(kept: &mut Vec<usize>, t_s: &[f64], at: impl Fn(usize) -> f64) -> u64 {
    let spike = |k: usize| is_spike(k, kept.len(), |k| t_s[kept[k]], |k| at(kept[k]));
    let spikes: Vec<usize> = (0..kept.len()).filter(|&k| spike(k)).collect();
    let mut k = 0;
    kept.retain(|_| {
        k += 1;
        spikes.binary_search(&(k - 1)).is_err()
    });
    spikes.len() as u64
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
