//! The machine that the runs are of.

use std::path::Path;

use super::{
    super::fit::{self, LimitsFile, observation, supply_of},
    Inputs, ReplanFailure,
};
use crate::{
    arm::Arm,
    fit::{Estimated, Fit, JointFit, Observation},
    log::Recording,
    remark::{Code, Remarks},
    series::JointKind,
    units::DEGREE_RAD,
};

/// What runs that a model was fitted to, among others, leave unexplained is less than what the next one will.
const SEEN: f64 = 1.25;

/// Runs that leave so many times as much as what was held out are none of those that a model was fitted to.
const OTHER: f64 = 3.0;

/// What a model leaves of a peak is much from here on, rad and m.
const fn much(kind: JointKind) -> f64 {
    match kind {
        JointKind::Turns => 0.5 * DEGREE_RAD,
        JointKind::Slides => 0.005,
    }
}

/// The machine: fitted, or from a file; with the names of the logs behind it. Its supply is that of the arm of the task.
pub(super) fn machine(
    inputs: &Inputs,
    logs: &[String],
    observed: &[&Recording],
    arm: Option<&Arm>,
) -> Result<(Fit, Vec<String>, Remarks), ReplanFailure> {
    let (mut fit, names, doubts) = of_runs(inputs, logs, observed)?;
    fit.supply = supply_of(observed, arm).or(fit.supply);
    Ok((fit, names, doubts))
}

fn of_runs(
    inputs: &Inputs,
    logs: &[String],
    observed: &[&Recording],
) -> Result<(Fit, Vec<String>, Remarks), ReplanFailure> {
    if let Some(path) = &inputs.limits {
        let file = LimitsFile::read(path)?;
        let joints =
            observed.iter().flat_map(|run| &run.measured.tracks).map(|track| (track.name(), track.kind()));
        file.check_joints(path, joints)?;
        let own = |log: &String| logs.iter().any(|name| Path::new(name).ends_with(log));
        let mut doubts = fit::doubts(logs, observed);
        // What the models leave unexplained elsewhere, as in strokes of an identification run, is not what they leave here.
        let seen: Vec<Observation<'_>> = observed.iter().map(|run| observation(run)).collect();
        let (all, any) = (file.logs.iter().all(own), file.logs.iter().any(own));
        let left = |known: Option<[f64; 2]>, found: [f64; 2]| match known {
            // What was held out of the fit tells more, unless these are other logs of those names.
            Some(known) if all && found[0] <= OTHER * known[0] => known,
            _ if any && !all => found.map(|peak_rad| SEEN * peak_rad),
            _ => found,
        };
        let known: Vec<JointFit> = file.fit.joints.clone();
        let mut fit = file.fit.held_against(&seen, left);
        for (known, held) in known.iter().zip(&mut fit.joints) {
            let other = of_another(known, held, path);
            held.model_holds &= other.is_none();
            for message in disproved(known, held, path).into_iter().chain(other) {
                doubts.add(Code::PoorFit, 1, message);
            }
        }
        return Ok((fit, file.logs, doubts));
    }
    let fitted = fit::of(logs, observed).map_err(fit::FitFailure::from)?;
    Ok((fitted.fit, fitted.runs.into_iter().map(|run| run.log).collect(), fitted.remarks))
}

/// A joint that runs show to be another than the one, or in another condition, that its model in a file is of.
fn of_another(known: &JointFit, held: &JointFit, file: &Path) -> Option<String> {
    let [was, is] = [known, held].map(|joint| joint.unexplained_peak_rad);
    let (was_rad, is_rad) = (was?[0], is?[0]);
    (known.trusted() && is_rad > much(known.kind) && is_rad > OTHER * was_rad).then(|| {
        format!(
            "the model of {} in {} leaves {} of the peaks in these runs, and {} in those that it was fitted to: it is of another machine, of \
             another condition, or of runs that asked for less; without --limits the runs themselves are fitted",
            known.name,
            file.display(),
            known.kind.says(is_rad),
            known.kind.says(was_rad)
        )
    })
}

/// The speed limits of a joint, from a file, that it was beyond in the runs that it was held against.
fn disproved(known: &JointFit, held: &JointFit, file: &Path) -> Vec<String> {
    let limits = |joint: &JointFit| [joint.speed_limit_growing_rad_s, joint.speed_limit_shrinking_rad_s];
    let of_way = |(known_limit, held_limit): (Estimated, Estimated)| {
        let [_, most] = known_limit.interval.filter(|_| held_limit.interval.is_none())?;
        Some(format!(
            "{} goes {}/s in these runs, and {} says {}/s at most: that limit is not used",
            known.name,
            known.kind.says(held_limit.lower_bound?),
            file.display(),
            known.kind.says(most)
        ))
    };
    limits(known).into_iter().zip(limits(held)).filter_map(of_way).collect()
}
