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

/// A change with its interval: the largest of several, or by a step, or from the first run to the last.
fn change(trend: &JointTrend, jumps: bool) -> Option<(f64, [f64; 2])> {
    let largest = trend.changes.iter().max_by(|a, b| a.change.abs().total_cmp(&b.change.abs()));
    if let Some(largest) = largest {
        return Some((largest.change, largest.interval_95));
    }
    if jumps {
        return trend.step.as_ref().map(|step| (step.change, step.interval_95));
    }
    let days = trend.changing_days;
    Some((trend.slope_per_day * days, trend.interval_95.map(|slope| slope * days)))
}

/// Whether another change is less than half as large, and surely less.
fn changes_alone((own, [low, high]): (f64, [f64; 2]), (other, of_other): (f64, [f64; 2])) -> bool {
    other.abs() < OTHER * own.abs() && if own > 0.0 { of_other[1] < low } else { of_other[0] > high }
}

/// Keeps one trend a joint and metric: that of one direction where it is found and the other changes by less, else that of all
/// starts.
pub(super) fn clearest(trends: Vec<JointTrend>) -> Vec<JointTrend> {
    let mut groups: BTreeMap<(String, String, By), Vec<JointTrend>> = BTreeMap::new();
    for trend in trends {
        groups.entry((trend.machine.clone(), trend.joint.clone(), trend.metric)).or_default().push(trend);
    }
    let one = |mut group: Vec<JointTrend>| {
        let of = |direction: i8| group.iter().find(|trend| trend.direction == Some(direction));
        let alone = |trend: &JointTrend| {
            let jumps = trend.is_step || !trend.changes.is_empty();
            let other = trend.direction.and_then(|direction| change(of(-direction)?, jumps));
            let own = change(trend, jumps);
            trend.found && own.zip(other).is_some_and(|(own, other)| changes_alone(own, other))
        };
        let told =
            group.iter().position(alone).or_else(|| group.iter().position(|trend| trend.direction.is_none()));
        told.map(|at| group.swap_remove(at))
    };
    groups.into_values().filter_map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_of_both_directions_is_of_none() {
        let by = |change: f64| (change, [change - 4.0, change + 4.0]);
        assert!(!changes_alone(by(43.0), by(39.0)) && !changes_alone(by(43.0), by(25.0)));
        assert!(
            changes_alone(by(43.0), by(3.0))
                && changes_alone(by(-43.0), by(-3.0))
                && changes_alone(by(43.0), by(-3.0))
        );
        // The other one may have changed by as much.
        assert!(!changes_alone((10.0, [2.0, 18.0]), (4.0, [-8.0, 16.0])));
    }
}
