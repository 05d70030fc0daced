//! Whole trajectories, one or several a message.

use super::{slot, table::stamp_ns};
use crate::log::decode::{Numbers, Sink, Slot, Texts};

/// One trajectory as a message gives it.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::log) struct RawTrajectory {
    /// When it starts; 0 for "on receipt".
    pub(in crate::log) header_ns: i64,
    pub(in crate::log) publish_ns: i64,
    pub(in crate::log) log_ns: i64,
    /// Place among the trajectories of its message.
    pub(in crate::log) place: usize,
    pub(in crate::log) joints: Vec<String>,
    pub(in crate::log) points: Vec<RawPoint>,
}

/// One point; arrays are as long as the joints, or empty.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::log) struct RawPoint {
    pub(in crate::log) since_start_ns: i64,
    pub(in crate::log) positions: Vec<f64>,
    pub(in crate::log) velocities: Vec<f64>,
    pub(in crate::log) accelerations: Vec<f64>,
}

impl RawTrajectory {
    /// Why its points are none of its joints at times that increase; one without points is sound, and means "stop".
    pub(in crate::log) fn fault(&self) -> Option<&'static str> {
        let joints = self.joints.len();
        let points = || self.points.iter();
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        let fits = |values: &[f64]| values.is_empty() || values.len() == joints;
        let lists = |point: &RawPoint| [&point.velocities, &point.accelerations].map(|list| fits(list));
        let since_ns: Vec<i64> = points().map(|point| point.since_start_ns).collect();
        if joints > 0 && !self.points.is_empty() && points().all(|point| point.positions.is_empty()) {
            Some("points without positions, at most speeds")
        } else if points().any(|point| point.positions.len() != joints || lists(point) != [true; 2]) {
            Some("points that are not as long as their list of joints")
        } else if !points().all(|p| [&p.positions, &p.velocities, &p.accelerations].iter().all(|l| finite(l)))
        {
            Some("points that are not finite")
        } else if since_ns.len() > 1 && since_ns.iter().all(|ns| *ns == 0) {
            Some("points whose times from the start are all 0 s")
        } else if since_ns.first().is_some_and(|ns| *ns < 0) || since_ns.windows(2).any(|w| w[0] >= w[1]) {
            Some("points whose times from the start do not increase from 0 s on")
        } else {
            None
        }
    }
}

/// All trajectories of a topic.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::log) struct Plans {
    pub(in crate::log) trajectories: Vec<RawTrajectory>,
    message: Vec<RawTrajectory>,
    stamp: (f64, f64),
    since: (f64, f64),
}

impl Plans {
    pub(in crate::log) fn commit(&mut self, publish_ns: u64, log_ns: u64) {
        self.close_point();
        for (place, mut one) in std::mem::take(&mut self.message).into_iter().enumerate() {
            one.place = place;
            one.publish_ns = i64::try_from(publish_ns).unwrap_or(i64::MAX);
            one.log_ns = i64::try_from(log_ns).unwrap_or(i64::MAX);
            self.trajectories.push(one);
        }
    }

    pub(in crate::log) fn append(&mut self, other: &mut Self) {
        self.trajectories.append(&mut other.trajectories);
    }

    /// What the first trajectory with points has, where none of them can be used.
    pub(in crate::log) fn fault(&self) -> Option<&'static str> {
        let mut faults =
            self.trajectories.iter().filter(|one| !one.points.is_empty()).map(RawTrajectory::fault);
        let first = faults.next()??;
        faults.all(|fault| fault.is_some()).then_some(first)
    }

    fn current(&mut self) -> &mut RawTrajectory {
        if self.message.is_empty() {
            self.message.push(RawTrajectory::default());
        }
        let last = self.message.len() - 1;
        &mut self.message[last]
    }

    /// Gives the last point and trajectory the times that were read for them.
    fn close_point(&mut self) {
        let (stamp, since) = (self.stamp, self.since);
        if let Some(current) = self.message.last_mut() {
            current.header_ns = stamp_ns(stamp.0, stamp.1);
            if let Some(point) = current.points.last_mut() {
                point.since_start_ns = stamp_ns(since.0, since.1);
            }
        }
    }
}

impl Sink for Plans {
    fn number(&mut self, slot: Slot, value: f64) {
        match slot {
            slot::SECOND => {
                self.stamp.0 = value;
                self.current();
            }
            slot::NANOSECOND => self.stamp.1 = value,
            slot::POINT_SECOND => self.since.0 = value,
            slot::POINT_NANOSECOND => self.since.1 = value,
            _ => {}
        }
    }

    fn numbers(&mut self, slot: Slot, values: Numbers<'_>) {
        let Some(point) = self.current().points.last_mut() else { return };
        match slot {
            slot::POSITIONS => point.positions = values.to_vec(),
            slot::VELOCITIES => point.velocities = values.to_vec(),
            slot::ACCELERATIONS => point.accelerations = values.to_vec(),
            _ => {}
        }
    }

    fn texts(&mut self, slot: Slot, values: Texts<'_>) {
        if slot == slot::NAMES {
            self.current().joints = values.to_vec();
        }
    }

    fn element(&mut self, slot: Slot) {
        match slot {
            Slot::MAX => {
                self.message.clear();
                self.stamp = (0.0, 0.0);
                self.since = (0.0, 0.0);
            }
            slot::GROUP => {
                self.close_point();
                self.stamp = (0.0, 0.0);
                self.message.push(RawTrajectory::default());
            }
            slot::POINT => {
                self.close_point();
                self.since = (0.0, 0.0);
                self.current().points.push(RawPoint::default());
            }
            _ => {}
        }
    }
}
