//! What the joints did with the plan: tracking error, and the transitions where it arises.
//!
//! A static-to-dynamic transition is the plan leaving rest. [`replay`] finds the transitions
//! of every joint in plan and measurement, measures the answer to each, and says whether the
//! error lives there. [`tool_replay`] says what that makes at the
//! tool. It knows angles over time and nothing of files, controllers or pressure.

mod answer;
mod at_rest;
mod concentration;
mod cursor;
mod delay;
mod direction;
mod drift;
mod joint;
mod keyed;
mod lag;
mod lag_share;
mod lane;
mod metric;
mod motion;
mod onset;
mod outcome;
mod path;
mod peak_motion;
mod place;
mod profile;
mod rest_swing;
mod rules;
mod signals;
mod spectrum;
mod stairs;
mod swing;
mod told;
mod tool;
mod tracking;
mod transition;
pub(crate) mod unit;
mod unrounded;

pub use delay::{measured_starts, measured_stops};
pub use direction::DirectionDelay;
pub use drift::RestDrift;
pub use keyed::{Keyed, Row};
pub use lane::{Phase, Stretch, lane};
pub use metric::{
    Dimension, JOINT, Judged, Limit, Metric, ONSET_DELAY, ONSET_DELAY_LIMIT, PEAK_ERROR, Read, ReadInterval,
    TOOL, TRANSITION, Together, limits,
};
pub use outcome::{
    Answer, JointReplay, Kind, KindRun, LagShare, OnsetMethod, PathError, Replay, Stop, Thresholds,
    TrackingError, Transition, WholeRun,
};
pub use peak_motion::peak_motion;
pub use place::{Concentration, ConcentrationTest, Verdict};
pub use profile::{Profiles, STRETCHES};
pub use rules::{Rules, Sizes};
pub use signals::{planned_starts, planned_step, speeds};
pub use spectrum::{COHERENT, Response, Spectrum, spectrum};
pub use swing::{Swing, swings};
pub use tool::{
    ToolCause, ToolDeviation, ToolPath, ToolReplay, ToolRest, ToolSplit, ToolWorst, pose_replay, tool_replay,
};

use std::collections::BTreeSet;

use crate::{
    series::{JointKind, Pair},
    threads,
};
use concentration::{JointError, concentration};
use joint::{Joint, joint};
use tracking::{samples, tracking_error};

/// Samples of a joint of a long run.
const LONG: usize = 200_000;

fn joints<'a>(pairs: &'a [Pair], rules: &Rules) -> Vec<Joint<'a>> {
    threads::mapped(pairs, || (), |(), pair| joint(pair, rules)).into_iter().flatten().collect()
}

/// Analyses one run, a pair a joint. O(n log n) in samples.
///
/// Figures of all joints together exist only if all of them turn or all of them slide. Nothing is
/// differentiated, matched or detected across the cuts between segments.
///
/// ```
/// use hydrotrace::{replay::{Rules, replay}, series::{Track, align}};
///
/// // 0.1 rad/s from 1 s on; the joint starts 0.25 s later.
/// let t_s: Vec<f64> = (0..500).map(|k| 0.01 * f64::from(k)).collect();
/// let ramp = |start_s: f64| t_s.iter().map(|t| 0.1 * (t - start_s).clamp(0.0, 2.0)).collect::<Vec<_>>();
/// let planned = Track::new("boom", t_s.clone(), ramp(1.0), &[])?;
/// let measured = Track::new("boom", t_s.clone(), ramp(1.25), &[])?;
///
/// let pairs: Vec<_> = align(&planned, &measured).into_iter().collect();
/// let found = replay(&pairs, &Rules::default());
/// assert!((found.transitions[0].onset_delay_s.unwrap() - 0.25).abs() < 0.02);
/// # Ok::<(), hydrotrace::series::SignalError>(())
/// ```
pub fn replay(pairs: &[Pair], rules: &Rules) -> Replay {
    let kinds: BTreeSet<JointKind> = pairs.iter().map(|pair| pair.kind).collect();
    // Of a long run one joint is at work at a time: each needs a fourth of what all of them hold.
    let long = pairs.iter().any(|pair| pair.t_s.len() > LONG);
    let at_once = if long { 1 } else { pairs.len().max(1) };
    let (mut joints, paths): (Vec<Joint>, Vec<_>) = threads::both(
        || pairs.chunks(at_once).flat_map(|some| joints(some, rules)).collect(),
        || kinds.iter().map(|kind| path::path_error(&of_kind(pairs, *kind), rules)).collect(),
    );
    let mut of_kinds = Vec::new();
    for (kind, path) in kinds.iter().zip(paths) {
        let norm = path.map(|(of_joints, norm)| {
            let own = joints.iter_mut().filter(|joint| joint.replay.kind == *kind);
            for (joint, path_error) in own.zip(of_joints) {
                joint.replay.path_error = Some(path_error);
            }
            norm
        });
        let own: Vec<&Joint> = joints.iter().filter(|joint| joint.replay.kind == *kind).collect();
        of_kinds.push(KindRun { kind: *kind, run: together(&own, norm, rules) });
    }
    let whole_run = match of_kinds.len() {
        1 => of_kinds.remove(0).run,
        _ => WholeRun::default(),
    };
    let mut found = Replay {
        rules: rules.clone(),
        joints: Vec::with_capacity(joints.len()),
        transitions: Vec::new(),
        stops: Vec::new(),
        whole_run,
        of_kinds,
    };
    for mut joint in joints {
        found.joints.push(joint.replay);
        found.transitions.append(&mut joint.transitions);
        found.stops.append(&mut joint.stops);
    }
    found
}

fn of_kind(pairs: &[Pair], kind: JointKind) -> Vec<&Pair> {
    pairs.iter().filter(|pair| pair.kind == kind).collect()
}

/// Joints of one kind together.
fn together(joints: &[&Joint], path_error: Option<PathError>, rules: &Rules) -> WholeRun {
    let windows_s: Vec<Vec<[f64; 2]>> =
        joints.iter().map(|joint| joint.transitions.iter().map(|t| t.window_s).collect()).collect();
    let errors = joints.iter().zip(&windows_s).filter(|(joint, _)| joint.replay.plan_moves).map(
        |(joint, windows_s)| JointError { samples: samples(joint.pair), moving: &joint.moving, windows_s },
    );
    let concentration = concentration(errors, rules);
    let lagging = joints.iter().any(|joint| joint.replay.lag_s.is_some());
    let lag_share = lagging.then(|| {
        let blocks = joints.iter().flat_map(|joint| joint.blocks.iter().copied()).collect();
        lag_share::lag_share(&lag_share::events(blocks, rules), rules)
    });
    WholeRun {
        tracking_error: tracking_error(joints.iter().flat_map(|joint| samples(joint.pair))),
        path_error,
        lag_share: lag_share.flatten(),
        concentration,
    }
}
