//! Whole runs before and after.

use serde::{Deserialize, Serialize};

use super::{
    change::{Change, Changes},
    summary::Scope,
};
use crate::{
    replay::{JointReplay, Metric, Rules, Together, ToolReplay, TrackingError, peak_motion},
    series::JointKind,
    units::DEGREE_RAD,
    workflow::report::Report,
};

/// A joint whose error grew by this factor, and by this share of the largest of its kind before, while that of another fell by that
/// factor, goes against the mean.
const GREW: (f64, f64) = (1.25, 0.1);
const FELL: f64 = 0.9;

/// Whole-run figures of one joint, or of several together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Figures {
    /// Which joints: all, of an arm that has both those that turn and those that slide, or one.
    pub scope: Scope,
    /// The joint; `None` for several together.
    pub joint: Option<String>,
    /// The unit of positions: "rad" or "m".
    #[serde(rename = "unit", with = "crate::replay::unit")]
    #[cfg_attr(test, schemars(with = "String"))]
    pub kind: JointKind,
    /// The figures that are compared, each by its key. Speeds and accelerations are smoothed equally before and after.
    #[serde(flatten)]
    pub changes: Changes<Metric<JointReplay>>,
}

/// All joints together, of an arm with both kinds those that turn and those that slide, then each joint.
pub(super) fn figures(before: &[Report], after: &[Report], joints: &[String], rules: &Rules) -> Vec<Figures> {
    let all = || before.iter().chain(after);
    let windows_s: Vec<f64> = joints
        .iter()
        .map(|name| {
            all().filter_map(|r| joint_of(r, name)).map(|j| j.thresholds.window_s).fold(0.0, f64::max)
        })
        .collect();
    let of = |reports: &[Report]| -> Vec<Vec<JointReplay>> {
        let smoothed = |report: &Report| {
            let each = joints.iter().zip(&windows_s);
            each.filter_map(|(name, window_s)| smoothed(report, name, *window_s, rules)).collect()
        };
        reports.iter().map(smoothed).collect()
    };
    let sides = [(before, of(before)), (after, of(after))];
    // A row over both sides: in each run, what a function of the run and its joints says.
    let change = |of: &dyn Fn(&Report, &[JointReplay]) -> Option<f64>| {
        let [before, after] = sides.each_ref().map(|(reports, joints)| {
            reports.iter().zip(joints).map(|(report, joints)| of(report, joints)).collect::<Vec<_>>()
        });
        Change::of_runs(&before, &after)
    };
    let kind = |name: &str| all().find_map(|r| joint_of(r, name)).map_or(JointKind::Turns, |j| j.kind);
    let each = joints.iter().map(|name| Figures {
        scope: Scope::Joint(name.clone()),
        joint: Some(name.clone()),
        kind: kind(name),
        changes: Changes::of(|metric: &Metric<JointReplay>| {
            change(&|_, joints| joints.iter().find(|j| j.name == *name).and_then(|j| metric.number(j)))
        }),
    });
    let kinds: Vec<JointKind> = joints.iter().map(|name| kind(name)).collect();
    let first = kinds.first().copied().unwrap_or(JointKind::Turns);
    let of_kind = |only: Option<JointKind>| Figures {
        scope: match only {
            None => Scope::All,
            Some(JointKind::Turns) => Scope::Turning,
            Some(JointKind::Slides) => Scope::Sliding,
        },
        joint: None,
        kind: only.unwrap_or(first),
        changes: Changes::of(|metric| {
            change(&|report, joints| {
                let own: Vec<JointReplay> = joints
                    .iter()
                    .filter(|joint| only.is_none_or(|only| joint.kind == only))
                    .cloned()
                    .collect();
                together(metric, report, &own)
            })
        }),
    };
    let both = kinds.iter().any(|kind| *kind != first);
    let of_kinds = [JointKind::Turns, JointKind::Slides].into_iter().filter(|_| both).map(Some);
    std::iter::once(None).chain(of_kinds).map(of_kind).chain(each).collect()
}

/// Joints whose error grew while that of others fell, the largest growth first, with their error over the run: a mean hides them.
pub(super) fn against(whole_run: &[Figures]) -> Vec<(&Figures, Change)> {
    let rms = |figures: &Figures| figures.changes.get("rms");
    let single = || whole_run.iter().filter(|figures| figures.joint.is_some());
    if !single().any(|other| rms(other).ratio.is_some_and(|ratio| ratio < FELL)) {
        return Vec::new();
    }
    let grew = |own: &Figures, change: &Change| {
        let alike = single().filter(|other| other.kind == own.kind).filter_map(|other| rms(other).before);
        let most = alike.fold(0.0, f64::max);
        change.ratio.is_some_and(|ratio| ratio > GREW.0)
            && change.difference.is_some_and(|difference| difference > GREW.1 * most)
    };
    let mut found: Vec<(&Figures, Change)> =
        single().map(|own| (own, rms(own))).filter(|(own, change)| grew(own, change)).collect();
    found.sort_by(|(_, a), (_, b)| b.difference.unwrap_or(0.0).total_cmp(&a.difference.unwrap_or(0.0)));
    found
}

/// A joint rests farther from its plan whose error at standstill, root mean square, has grown by this factor, and by this, rad or m.
const RESTS_FARTHER: f64 = 3.0;
const RESTS_BY: [f64; 2] = [0.1 * DEGREE_RAD, 1e-3];

/// Joints that rest farther from their plan than before, with their error at standstill: a mean of starts this way and that hides them.
pub(super) fn rest_farther(whole_run: &[Figures]) -> Vec<(&Figures, Change)> {
    let rests = |figures: &Figures| figures.changes.get("standstill_rms");
    let farther = |(own, change): &(&Figures, Change)| {
        change.ratio.is_some_and(|ratio| ratio > RESTS_FARTHER)
            && change.difference.is_some_and(|by| by > RESTS_BY[usize::from(own.kind == JointKind::Slides)])
    };
    let single = whole_run.iter().filter(|figures| figures.joint.is_some());
    single.map(|own| (own, rests(own))).filter(farther).collect()
}

/// The figures at the tool, where every run has the same one.
pub(super) fn tool(before: &[Report], after: &[Report]) -> Option<Changes<Metric<ToolReplay>>> {
    let found = |reports: &[Report]| -> Option<Vec<ToolReplay>> {
        reports.iter().map(|report| report.tool.found().cloned()).collect()
    };
    let (before, after) = (found(before)?, found(after)?);
    let first = before.first()?;
    let alike = before.iter().chain(&after).all(|other| other.tool == first.tool);
    let values = |side: &[ToolReplay], metric: &Metric<ToolReplay>| -> Vec<Option<f64>> {
        side.iter().map(|tool| metric.number(tool)).collect()
    };
    alike.then(|| Changes::of(|metric| Change::of_runs(&values(&before, metric), &values(&after, metric))))
}

fn joint_of<'a>(report: &'a Report, name: &str) -> Option<&'a JointReplay> {
    report.replay.joints.iter().find(|joint| joint.name == name)
}

/// A joint whose speed and acceleration are smoothed over a given half window.
fn smoothed(report: &Report, name: &str, window_s: f64, rules: &Rules) -> Option<JointReplay> {
    let pair = report.pairs.iter().find(|pair| pair.name == name)?;
    let [peak_speed, peak_acceleration] = peak_motion(pair, window_s, rules);
    Some(JointReplay { peak_speed, peak_acceleration, ..joint_of(report, name)?.clone() })
}

/// One value of the joints that every run has; what only the whole run has exists only if it has no other joints.
fn together(metric: &Metric<JointReplay>, report: &Report, joints: &[JointReplay]) -> Option<f64> {
    let alike = joints.windows(2).all(|pair| pair[0].kind == pair[1].kind);
    if metric.dimension.is_of_joint() && !alike {
        return None;
    }
    let values: Vec<f64> = joints.iter().filter_map(|joint| metric.number(joint)).collect();
    match metric.together {
        Together::Nothing => None,
        Together::Rms(of) => pooled(joints.iter().filter_map(of)),
        Together::Whole(of) => {
            let kind = joints.first()?.kind;
            let all = report.replay.joints.iter().filter(|joint| joint.kind == kind).count();
            (joints.len() == all).then(|| of(report.replay.together_with(kind)))?
        }
        Together::Most => values.into_iter().reduce(f64::max),
        Together::Mean => (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64),
    }
}

/// Root mean square over several, weighted by time.
fn pooled(errors: impl Iterator<Item = TrackingError>) -> Option<f64> {
    let (square, time_s) = errors.fold((0.0, 0.0), |(square, time_s), error| {
        (square + error.rms * error.rms * error.duration_s, time_s + error.duration_s)
    });
    (time_s > 0.0).then(|| (square / time_s).sqrt())
}
