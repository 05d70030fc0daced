//! The next run of each joint over time: plan, command and expected answer, and the limits between which they stay.

use super::Replanned;
use crate::{
    plan::Setup,
    series::{JointKind, Track, local_quadratic},
};

/// Half of the window in which the speed of an answer is told, s.
const SPEED_WITHIN_S: f64 = 0.1;

/// One line of a drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// Angles, rad.
    pub angle_rad: Vec<f64>,
    /// Speeds, rad/s.
    pub speed_rad_s: Vec<f64>,
}

/// The next run of one joint, all lines at common instants.
#[derive(Debug, Clone, PartialEq)]
pub struct JointCourse {
    /// The joint.
    pub name: String,
    /// Whether it turns or slides; of one that slides a radian stands for a metre.
    pub kind: JointKind,
    /// Instants, s.
    pub t_s: Vec<f64>,
    /// Where it should be.
    pub planned: Drawn,
    /// What is sent.
    pub sent: Drawn,
    /// What is expected, and the distance from it that 90 % of starts stay within, rad; `None` if the fit does not know the joint.
    pub response: Option<(Drawn, f64)>,
    /// Lowest and highest angle, rad; infinite without.
    pub range_rad: [f64; 2],
    /// Lowest and highest speed, rad/s; infinite without.
    pub speed_limit_rad_s: [f64; 2],
}

/// Of every joint of the plan.
pub fn courses(replanned: &Replanned) -> Vec<JointCourse> {
    let setup = replanned.request.as_ref().map(|request| &request.setup);
    let names = setup.map(Setup::joint_names).unwrap_or_default();
    let one = |track: &Track| {
        let name = track.name();
        let command = replanned.command.as_ref().and_then(|command| command.series.track(name));
        let sent = command.unwrap_or(track);
        let response = replanned.responses.iter().find(|response| response.angle.name() == name);
        let own = names.iter().position(|own| own == name);
        let limits = own.and_then(|own| setup?.joint_limits(own));
        let [range_rad, speed_limit_rad_s, ..] = limits.unwrap_or([[f64::NEG_INFINITY, f64::INFINITY]; 4]);
        JointCourse {
            name: name.to_owned(),
            kind: track.kind(),
            t_s: sent.t_s().to_vec(),
            planned: drawn(track, sent.t_s()),
            sent: drawn(sent, sent.t_s()),
            response: response.map(|found| (drawn(&found.angle, sent.t_s()), found.band_rad)),
            range_rad,
            speed_limit_rad_s,
        }
    };
    replanned.plan.tracks.iter().map(one).collect()
}

fn drawn(track: &Track, t_s: &[f64]) -> Drawn {
    let angle_rad: Vec<f64> = t_s.iter().map(|t_s| track.held_at(*t_s).position).collect();
    let speed_rad_s = if track.velocity().is_some() {
        t_s.iter().map(|t_s| track.held_at(*t_s).velocity).collect()
    } else {
        let whole = 0..t_s.len();
        let fits = local_quadratic(t_s, &angle_rad, std::slice::from_ref(&whole), SPEED_WITHIN_S, 3);
        fits.iter().map(|fit| fit.velocity).collect()
    };
    Drawn { angle_rad, speed_rad_s }
}
