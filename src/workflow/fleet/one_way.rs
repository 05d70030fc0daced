//! Trends of the starts in one direction: the valve of a cylinder has an edge for each.

use std::collections::BTreeMap;

use super::{
    history::{Axis, By, Event, History, Values},
    joint_trend::JointTrend,
};

/// Starts in the other direction change by less than this share, if only one direction is told.
const OTHER: f64 = 0.5;

/// The starts of a joint in either direction, where it has both.
pub(super) fn by_direction(history: &History, axis: &Axis, values: &Values) -> Vec<(i8, Values)> {
    let of = |direction: i8| {
        let own = |event: &&Event| {
            let key = (axis.joint.clone(), (*event).clone());
            history.directions.get(&key) == Some(&i64::from(direction))
        };
        let own = values.iter().filter(|(event, _)| own(event));
        (direction, own.map(|(event, runs)| (event.clone(), runs.clone())).collect::<Values>())
    };
    let both = [of(1), of(-1)];
    if both.iter().any(|(_, own)| own.is_empty()) { Vec::new() } else { both.into() }
}

/// Keeps one trend a joint and metric: that of one direction where it is found and the other changes by less, else that of all
/// starts.
pub(super) fn clearest(trends: Vec<JointTrend>) -> Vec<JointTrend> {
    let mut groups: BTreeMap<(String, String, By), Vec<JointTrend>> = BTreeMap::new();
    for trend in trends {
        groups.entry((trend.machine.clone(), trend.joint.clone(), trend.metric)).or_default().push(trend);
    }
    let one = |mut group: Vec<JointTrend>| {
        let growth = |direction: Option<i8>| {
            group.iter().find(|trend| trend.direction == direction).map(JointTrend::growth_per_day)
        };
        let alone = |trend: &JointTrend| {
            let other = trend.direction.and_then(|direction| growth(Some(-direction)));
            trend.found && other.is_some_and(|other| other.abs() < OTHER * trend.growth_per_day().abs())
        };
        let told =
            group.iter().position(alone).or_else(|| group.iter().position(|trend| trend.direction.is_none()));
        told.map(|at| group.swap_remove(at))
    };
    groups.into_values().filter_map(one).collect()
}
