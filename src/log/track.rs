//! From the samples of a table to tracks.

use std::{f64::consts::TAU, sync::Arc};

use super::{quality::Gaps, source::Table};
use crate::{
    remark::{Code, Remarks},
    series::{Clock, Track, split_at_gaps, velocity_agrees},
    units::{radians_from_degrees, seconds_since},
};

/// The time axis that all joints of a table share.
pub(super) struct Axis {
    t_s: Arc<[f64]>,
    /// Rows of the table at these times.
    rows: Vec<usize>,
    /// Backward jumps of the clock.
    jumps: Vec<usize>,
    /// Jumps and gaps.
    cuts: Vec<usize>,
    /// Whether the rows are all there, as they lie in the table, and times increase.
    as_read: bool,
}

impl Axis {
    pub(super) fn new(clock: Clock, epoch_ns: i64) -> Self {
        let t_s: Arc<[f64]> = clock.t_ns.iter().map(|&ns| seconds_since(epoch_ns, ns)).collect();
        let as_read =
            clock.rows.iter().enumerate().all(|(i, &row)| i == row) && t_s.windows(2).all(|w| w[0] < w[1]);
        Self { cuts: cuts(&t_s, &clock.cuts), t_s, rows: clock.rows, jumps: clock.cuts, as_read }
    }

    /// The axis without the samples that are missing in a column: times, cuts and jumps.
    fn kept(&self, kept: &[usize]) -> (Arc<[f64]>, Vec<usize>, Vec<usize>) {
        let jumps: Vec<usize> = self.jumps.iter().map(|cut| kept.partition_point(|i| i < cut)).collect();
        if kept.len() == self.rows.len() {
            return (self.t_s.clone(), self.cuts.clone(), jumps);
        }
        let t_s: Arc<[f64]> = kept.iter().map(|&i| self.t_s[i]).collect();
        let cuts = cuts(&t_s, &jumps);
        (t_s, cuts, jumps)
    }
}

/// What numbers of a field are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unit {
    Radians,
    Degrees,
    /// No angles: nothing is known of what they may be.
    Other,
}

/// One track a joint of a table's field; `last` if nobody asks the table for this field again,
/// so that samples may be moved out of it.
pub(super) fn tracks(
    table: &mut Table,
    field: usize,
    axis: &Axis,
    unit: Unit,
    last: bool,
    topic: &str,
    remarks: &mut Remarks,
) -> Vec<Track> {
    let mut tracks = Vec::new();
    let mut gap = Gaps::default();
    let mut spikes = 0;
    let velocity_field = table.fields[field].velocity;
    for (joint, name) in table.joints.clone().iter().enumerate() {
        let mut column =
            |field| if last { table.take_column(field, joint) } else { table.column(field, joint).to_vec() };
        let (position, speed) = (column(field), velocity_field.map(column).unwrap_or_default());
        let whole =
            axis.as_read && position.len() == axis.rows.len() && position.iter().all(|q| q.is_finite());
        let whole = whole
            && !(0..position.len()).any(|k| {
                unit != Unit::Other && is_spike(k, position.len(), |i| axis.t_s[i], |i| position[i])
            });
        let ((t_s, cuts, jumps), mut position, mut speed) = if whole {
            ((axis.t_s.clone(), axis.cuts.clone(), axis.jumps.clone()), position, speed)
        } else {
            let at = |i: usize| position.get(axis.rows[i]).copied().unwrap_or(f64::NAN);
            let mut kept: Vec<usize> = (0..axis.rows.len()).filter(|&i| at(i).is_finite()).collect();
            // Far from the epoch neighbouring nanoseconds are the same second.
            kept.dedup_by(|later, earlier| axis.t_s[*later] <= axis.t_s[*earlier]);
            if unit != Unit::Other {
                spikes += drop_spikes(&mut kept, &axis.t_s, at);
            }
            if kept.is_empty() {
                continue;
            }
            let speed = kept.iter().map_while(|&i| speed.get(axis.rows[i]).copied()).collect();
            (axis.kept(&kept), kept.iter().map(|&i| at(i)).collect(), speed)
        };
        if unit == Unit::Degrees {
            position.iter_mut().chain(&mut speed).for_each(|value| *value = radians_from_degrees(*value));
        }
        gap.note(&t_s, &cuts, &jumps);
        let usable = speed.len() == position.len()
            && speed.iter().all(|v| v.is_finite())
            && velocity_agrees(&t_s, &position, &speed, &cuts);
        let track = Track::new(name, t_s, position, &cuts);
        let track = if usable { track.and_then(|track| track.with_velocity(speed)) } else { track };
        tracks.extend(track.ok());
    }
    gap.remark(topic, remarks);
    let message =
        format!("values of {topic} that no joint can have (a jump there and back at once), dropped");
    remarks.add(Code::Implausible, spikes, message);
    tracks
}

/// Faster than any joint, rad/s (deg/s where the log is in degrees).
const FASTEST: f64 = 200.0;
/// Larger than any angle, in radians or degrees.
const LARGEST: f64 = 1e6;

/// Whether sample `k` of `n` is no angle: too large, or off both its neighbours faster than any
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
    there.abs() > FASTEST * before_s && back.abs() > FASTEST * after_s && !turn()
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
