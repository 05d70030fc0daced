//! The trends of all joints, before they are shown.

use std::collections::BTreeMap;

use super::{
    alike::{Alike, alike},
    common::Commons,
    found::judge,
    history::{Axis, By, History, Scatters, Values},
    joint_trend::JointTrend,
    leveled::Leveled,
    link::links,
    one_way::by_direction,
    own_change::OwnLevels,
};

/// The trends of all joints by these metrics, those of each direction of starts, too, judged; the joints with too few runs, by metric; and
/// what most machines did alike.
pub(super) struct Judged<'a> {
    pub(super) trends: Vec<JointTrend>,
    pub(super) few: Vec<&'a Axis>,
    pub(super) alike: Vec<Alike>,
}

pub(super) fn judged<'a>(history: &'a History, by: &[By]) -> Judged<'a> {
    let scatters: BTreeMap<By, Scatters> = by.iter().map(|by| (*by, history.scatters(*by))).collect();
    let none = Scatters::new();
    let mut joints = Vec::new();
    let mut few = Vec::new();
    for ((axis, metric), values) in &history.values {
        if !by.contains(metric) {
            continue;
        }
        let scatters = (axis.joint.as_str(), scatters.get(metric).unwrap_or(&none));
        let leveled = |values: &Values, direction| {
            let found = Leveled::of(*metric, &history.runs, values, scatters)?;
            let unit = if *metric == By::Peak { axis.unit.clone() } else { "s".to_owned() };
            Some(Leveled {
                machine: axis.machine.clone(),
                joint: axis.joint.clone(),
                direction,
                unit,
                ..found
            })
        };
        let Some(found) = leveled(values, None) else {
            few.push(axis);
            continue;
        };
        joints.push(found);
        for (direction, own) in by_direction(history, axis, values) {
            joints.extend(leveled(&own, Some(direction)));
        }
    }
    let links = links(&joints);
    let joints: Vec<Leveled> =
        joints.into_iter().zip(links).map(|(joint, link)| joint.linked(link)).collect();
    let (commons, alike) = (Commons::of(&joints), alike(&joints));
    let mut trends: Vec<JointTrend> = joints
        .into_iter()
        .filter_map(|joint| {
            let common = commons.at(&joint);
            let shared_per_day = common.as_ref().and_then(|common| joint.shared_per_day(common));
            let own = joint.own_levels();
            let trend = joint.less(common).trend()?;
            let own = if trend.less_common { own } else { OwnLevels::default() };
            Some(JointTrend { shared_per_day, own, ..trend })
        })
        .collect();
    judge(&mut trends);
    Judged { trends, few, alike }
}
