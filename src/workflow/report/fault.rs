//! What happened to a machine that makes the figures of its starts no matter, and why nothing can be learnt from a run.

use super::outcome::{Fault, Report};
use crate::{
    remark::Code,
    replay::{JointReplay, Transition},
    series::whole_until_s,
};

/// Errors that are nowhere larger than so many standard deviations of the noise, and than so many root mean square, are noise.
const HIDES: f64 = 6.0;
const HARDLY_MORE: f64 = 1.15;

/// A machine that is stopped takes so long at most to come to rest, s.
const COMES_TO_REST_S: f64 = 0.5;

/// What is left of a run, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Leaves {
    /// From an instant on, s.
    From(f64),
    /// To an instant, s.
    To(f64),
}

impl Fault {
    /// `stood_s`: from when to when the machine stood.
    pub(super) fn of(report: &Report, stood_s: Option<[f64; 2]>) -> Option<Self> {
        if let Some([from_s, to_s]) = stood_s {
            let [from_s, to_s] = [from_s, to_s].map(|s| Some(s).filter(|s| s.is_finite()));
            return Some(Self::Stopped { from_s, to_s });
        }
        let joints = report.replay.joints.iter();
        let dead: Vec<&JointReplay> = joints.filter(|joint| report.stands(joint)).collect();
        (!dead.is_empty()).then(|| Self::Dead {
            joints: dead.iter().map(|joint| joint.name.clone()).collect(),
            starts: dead.iter().map(|joint| joint.starts).sum(),
        })
    }

    /// Whether it explains what a start looks like.
    fn explains(&self, start: &Transition) -> bool {
        match self {
            Self::Stopped { from_s, to_s } => {
                from_s.is_none_or(|from_s| start.window_s[1] > from_s)
                    && to_s.is_none_or(|to_s| start.window_s[0] < to_s)
            }
            Self::Dead { joints, .. } => joints.contains(&start.joint),
        }
    }
}

impl Report {
    /// Whether the run went on with its plan: one that was slowed or stood is in other motions than its plan, and slower in all it does.
    pub(super) fn is_in_time(&self) -> bool {
        let others = [Code::OtherTime, Code::Stopped, Code::Paused];
        !self.remarks.as_slice().iter().any(|remark| others.contains(&remark.code))
    }

    /// The part of the run that a fault leaves as it was, from or to an instant, s, which is all that there is of some: where the
    /// plan rests, if it does before.
    pub fn leaves_s(&self, fault: &Fault) -> Option<Leaves> {
        match fault {
            Fault::Stopped { from_s: Some(from_s), .. } => {
                let plans = self.pairs.iter().map(|pair| (&*pair.t_s, pair.planned.as_slice()));
                Some(Leaves::To(whole_until_s(plans, *from_s).unwrap_or(from_s - COMES_TO_REST_S)))
            }
            Fault::Stopped { to_s, .. } => to_s.map(Leaves::From),
            Fault::Dead { .. } => None,
        }
    }

    /// Whether a joint does not move although its plan does.
    pub fn stands(&self, joint: &JointReplay) -> bool {
        joint.plan_moves && !joint.moves && joint.starts > 0 && self.travel(joint).rests
    }

    /// The worst start that is not what [`Self::fault`] makes it.
    pub fn worst(&self) -> Option<&Transition> {
        let explained = |start: &&Transition| self.fault.as_ref().is_some_and(|fault| fault.explains(start));
        self.replay.worst_first().into_iter().find(|start| !explained(start))
    }

    /// The joint with the largest error, where that of all is hardly more than the noise of their sensors.
    pub fn only_noise(&self) -> Option<&JointReplay> {
        let joints = &self.replay.joints;
        let noisy = joints.iter().all(|joint| {
            let (error, sigma) = (&joint.tracking_error, joint.noise.sigma);
            error.peak <= HIDES * sigma && error.rms <= HARDLY_MORE * sigma
        });
        let by_band =
            |joint: &JointReplay| joint.tracking_error.rms / self.replay.rules.sizes(joint.kind).settle_band;
        let largest = joints.iter().max_by(|a, b| by_band(a).total_cmp(&by_band(b)));
        largest.filter(|_| noisy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workflow::report::{
        Inputs,
        advice::{Advice, advice},
        run,
    };

    fn report() -> Report {
        let log = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("sample-logs/panel-install.mcap");
        run(&Inputs { logs: vec![log], ..Inputs::default() }).unwrap()
    }

    #[test]
    fn the_worst_start_is_none_of_a_dead_joint_or_of_a_machine_that_stands() {
        let mut found = report();
        let worst = found.worst().unwrap().clone();
        assert_eq!(Fault::of(&found, None), None);
        found.fault = Fault::of(&found, Some([worst.window_s[0] + 0.1, f64::INFINITY]));
        assert!(found.worst().is_none_or(|start| start.window_s[1] <= worst.window_s[0] + 0.1));
        let first = advice(&found).remove(0);
        assert!(matches!(&first, Advice::SeeTo(Fault::Stopped { to_s: None, .. })), "{first:?}");
        let joint = found.replay.joints.iter_mut().find(|joint| joint.name == worst.joint).unwrap();
        joint.moves = false;
        let pair = found.pairs.iter_mut().find(|pair| pair.name == worst.joint).unwrap();
        pair.measured.fill(0.0);
        found.fault = Fault::of(&found, None);
        assert!(matches!(&found.fault, Some(Fault::Dead { joints, .. }) if *joints == [worst.joint.clone()]));
        assert!(found.worst().is_some_and(|start| start.joint != worst.joint));
        let steps = advice(&found);
        let offered = |step: &Advice| {
            matches!(step, Advice::EaseStarts { joint, .. } | Advice::ShiftCommand { joint, .. } | Advice::FreeJoint { joint, .. }
                if *joint == worst.joint)
        };
        assert!(!steps.iter().any(offered), "{steps:?}");
    }

    #[test]
    fn a_run_whose_error_is_noise_has_nothing_to_correct_and_one_that_cannot_be_fitted_says_why() {
        let mut found = report();
        found.unfit = Some("its motions are too short".to_owned());
        let steps = advice(&found);
        assert!(steps.contains(&Advice::NoCommand("its motions are too short".to_owned())), "{steps:?}");
        assert!(steps.iter().any(|step| matches!(step, Advice::EaseStarts { fits: false, .. })), "{steps:?}");
        assert_eq!(found.only_noise(), None);
        for joint in &mut found.replay.joints {
            joint.noise.sigma = joint.tracking_error.rms;
        }
        let steps = advice(&found);
        assert!(matches!(&steps[..], [.., Advice::LeaveIt { .. }, Advice::SetLimits, _]), "{steps:?}");
    }
}
