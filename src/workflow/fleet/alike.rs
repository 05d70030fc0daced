//! What most machines of a fleet did alike, which is taken off the trends of each: told, for it may be the season, or something that was
//! done to all of them.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{common::Common, course::course, history::By, leveled::Leveled, run::date};
use crate::math::{median, range, theil_sen};

/// A change of less, as a share of the level, is not told.
const LEAST: f64 = 0.05;
/// Changes that are told of a metric, at most.
const MOST: usize = 2;

/// A change that most machines share.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Alike {
    /// The metric.
    pub metric: By,
    /// By how much it changed, as a share of what is usual.
    pub change: f64,
    /// When it began, UTC.
    pub after: Option<String>,
    /// When it had come, UTC.
    pub by: Option<String>,
    /// Machines whose own levels went that way by a quarter of it or more.
    pub shared_by: usize,
    /// Machines that ran before and after it.
    pub of: usize,
    /// Those of them that do not share it.
    pub others: Vec<String>,
}

/// The largest changes that most machines share, of each metric, in the order of time.
pub(super) fn alike(joints: &[Leveled]) -> Vec<Alike> {
    let mut metrics: BTreeMap<By, Vec<&Leveled>> = BTreeMap::new();
    for joint in joints.iter().filter(|joint| joint.direction.is_none()) {
        metrics.entry(joint.metric).or_default().push(joint);
    }
    metrics.into_iter().flat_map(|(metric, joints)| of_metric(metric, &joints)).collect()
}

fn of_metric(metric: By, joints: &[&Leveled]) -> Vec<Alike> {
    let Some(points) = Common::of(metric, joints).map(|common| common.points()) else { return Vec::new() };
    let usual = median(joints.iter().map(|joint| joint.usual).collect());
    let share = |change: f64| if metric == By::Peak { change } else { change / usual };
    let days = range(points.iter().map(|point| point.0));
    let evenly = || vec![(days, theil_sen(&points) * (days[1] - days[0]))];
    let mut changes: Vec<([f64; 2], f64)> = course(&points).map_or_else(evenly, |course| {
        course.changes.into_iter().map(|one| (one.at_days, one.change)).collect()
    });
    // What goes on the same way without a rest is one change.
    changes.dedup_by(|next, before| {
        let goes_on = next.0[0] <= before.0[1] && next.1 * before.1 > 0.0;
        if goes_on {
            (before.0[1], before.1) = (next.0[1], before.1 + next.1);
        }
        goes_on
    });
    changes.retain(|(_, change)| share(*change).abs() >= LEAST);
    changes.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    changes.truncate(MOST);
    changes.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
    let told = changes.into_iter().map(|(days, change)| {
        let mut machines: BTreeMap<&str, Vec<bool>> = BTreeMap::new();
        for joint in joints {
            let scale = if metric == By::Peak { joint.usual } else { 1.0 };
            let own = joint.own_levels();
            let ran = [own.0.first(), own.0.last()];
            if let [Some(first), Some(last)] = ran
                && first.0 <= days[0]
                && last.0 >= days[1]
            {
                machines.entry(&joint.machine).or_default().push(own.step(scale * change, days));
            }
        }
        let of = machines.len();
        machines.retain(|_, own| 2 * own.iter().filter(|shows| **shows).count() <= own.len());
        let others: Vec<String> = machines.into_keys().map(str::to_owned).collect();
        let [after, by] = days.map(date);
        Alike { metric, change: share(change), after, by, shared_by: of - others.len(), of, others }
    });
    told.filter(|one| 2 * one.shared_by > one.of).collect()
}
