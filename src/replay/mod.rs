//! What the joints did with the plan: tracking error, and the transitions where it arises.
//!
//! A static-to-dynamic transition is the plan leaving rest. [`replay`] finds the transitions
//! of every joint in plan and measurement, measures the answer to each, and says whether the
//! error lives there. [`tool_replay`] says what that makes at the
//! tool. It knows angles over time and nothing of files, controllers or pressure.

mod answer;
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
mod profile;
mod rules;
mod signals;
mod spectrum;
mod stairs;
mod told;
mod tool;
mod tracking;
mod transition;
pub(crate) mod unit;

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
    Answer, Concentration, ConcentrationTest, JointReplay, Kind, LagShare, OnsetMethod, PathError, Replay,
    Stop, Thresholds, TrackingError, Transition, Verdict, WholeRun,
};
pub use peak_motion::peak_motion;
pub use profile::{Profiles, STRETCHES};
pub use rules::{Rules, Sizes};
pub use signals::{planned_starts, planned_step, speeds};
pub use spectrum::{COHERENT, Response, Spectrum, Swing, spectrum, swings};
pub use tool::{
    ToolCause, ToolDeviation, ToolPath, ToolReplay, ToolRest, ToolSplit, ToolWorst, pose_replay, tool_replay,
};

use crate::{series::Pair, threads};
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
    let alike = pairs.windows(2).all(|pair| pair[0].kind == pair[1].kind);
    // Of a long run one joint is at work at a time: each needs a fourth of what all of them hold.
    let long = pairs.iter().any(|pair| pair.t_s.len() > LONG);
    let at_once = if long { 1 } else { pairs.len().max(1) };
    let (mut joints, path): (Vec<Joint>, _) = threads::both(
        || pairs.chunks(at_once).flat_map(|some| joints(some, rules)).collect(),
        || if alike { path::path_error(pairs, rules) } else { None },
    );
    let windows_s: Vec<Vec<[f64; 2]>> =
        joints.iter().map(|joint| joint.transitions.iter().map(|t| t.window_s).collect()).collect();
    let errors = joints.iter().zip(&windows_s).filter(|(joint, _)| joint.replay.plan_moves).map(
        |(joint, windows_s)| JointError { samples: samples(joint.pair), moving: &joint.moving, windows_s },
    );
    let concentration = concentration(errors, rules).filter(|_| alike);
    let tracking_error =
        tracking_error(joints.iter().flat_map(|joint| samples(joint.pair))).filter(|_| alike);
    let lagging = alike && joints.iter().any(|joint| joint.replay.lag_s.is_some());
    let lag_share = lagging.then(|| {
        let blocks = joints.iter().flat_map(|joint| joint.blocks.iter().copied()).collect();
        lag_share::lag_share(&lag_share::events(blocks, rules), rules)
    });
    let norm = path.map(|(of_joints, norm)| {
        for (joint, path_error) in joints.iter_mut().zip(of_joints) {
            joint.replay.path_error = Some(path_error);
        }
        norm
    });
    let mut found = Replay {
        rules: rules.clone(),
        joints: Vec::with_capacity(joints.len()),
        transitions: Vec::new(),
        stops: Vec::new(),
        whole_run: WholeRun {
            tracking_error,
            path_error: norm,
            lag_share: lag_share.flatten(),
            concentration,
        },
    };
    for mut joint in joints {
        found.joints.push(joint.replay);
        found.transitions.append(&mut joint.transitions);
        found.stops.append(&mut joint.stops);
    }
    found
}
