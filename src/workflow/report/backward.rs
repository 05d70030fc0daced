//! Joints that first go the other way when they are to start: loads sink before their valves hold them.

use super::outcome::Report;
use crate::{
    remark::{Code, Remark},
    replay::{JointReplay, Kind, Transition},
    series::JointKind,
};

/// What counts, by the band in which an error is settled and by standard deviations of the noise.
const BANDS: f64 = 3.0;
const SIGMAS: f64 = 8.0;
/// A joint that moves by this share of it while its plan rests, as a standard deviation, does so all the time: no load sinks then alone.
const AT_REST: f64 = 0.5;

/// How a joint first goes the other way.
#[derive(Debug, Clone, PartialEq)]
pub struct Backward {
    /// The joint.
    pub joint: String,
    /// Whether it turns or slides.
    pub kind: JointKind,
    /// In how many of its starts with a time, and how many these are.
    pub count: [usize; 2],
    /// How far at most, rad or m, and at which planned start, s.
    pub most: f64,
    /// When that start is planned, s.
    pub at_s: f64,
    /// Standard deviation while its plan rests, rad or m, if it moves then, too.
    pub swings: Option<f64>,
}

impl Report {
    /// The joints that do so; none of a run that followed its plan at another time, whose joints are in other motions, or whose
    /// joints may have the plans of others.
    pub fn backward(&self) -> Vec<Backward> {
        let exchanged =
            |remark: &Remark| remark.code == Code::UnlikePlan && remark.message.contains("exchanged");
        if !self.is_in_time() || self.remarks.as_slice().iter().any(exchanged) {
            return Vec::new();
        }
        let of = |joint: &JointReplay| {
            let sizes = self.replay.rules.sizes(joint.kind);
            let least = (BANDS * sizes.settle_band).max(SIGMAS * joint.noise.sigma);
            let starts = self.replay.transitions.iter().filter(|start| {
                start.joint == joint.name && start.kind == Kind::Start && start.measured_onset_s.is_some()
            });
            let each: Vec<(f64, f64)> =
                starts.filter_map(|start| Some((self.sinks(start)?, start.planned_onset_s))).collect();
            let (most, at_s) = each.iter().copied().max_by(|a, b| a.0.total_cmp(&b.0))?;
            let count = each.iter().filter(|(by, _)| *by > least).count();
            let rest = joint
                .standstill_error
                .map(|at_rest| (at_rest.rms.powi(2) - at_rest.bias.powi(2)).max(0.0).sqrt());
            let swings = rest.filter(|deviation| *deviation > AT_REST * most);
            let (name, kind, count) = (joint.name.clone(), joint.kind, [count, each.len()]);
            (count[0] > 0).then_some(Backward { joint: name, kind, count, most, at_s, swings })
        };
        self.replay.joints.iter().filter_map(of).collect()
    }

    /// How far a joint goes against its plan until it starts, rad or m.
    fn sinks(&self, start: &Transition) -> Option<f64> {
        let pair = self.pairs.iter().find(|pair| pair.name == start.joint)?;
        let at = |s: f64| pair.t_s.partition_point(|t_s| *t_s < s);
        let (from, to) = (at(start.planned_onset_s), at(start.measured_onset_s?));
        let q = pair.measured.get(from..to)?;
        let first = q.first()?;
        let against = q.iter().map(|q| f64::from(start.direction) * (first - q));
        Some(against.fold(0.0, f64::max))
    }
}
