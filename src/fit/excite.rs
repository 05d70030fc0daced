//! A run that identifies the parameters that runs of tasks leave open.

use serde::{Deserialize, Serialize};

use super::{
    FitError,
    model::{STEP_S, steps_in},
};
use crate::{
    series::{JointKind, Series, Track},
    units::DEGREE_RAD,
};

/// How to drive each joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Excitation {
    /// Speeds of the ramps with the distance that each goes to either side, rad/s and rad.
    pub ramps: Vec<Ramp>,
    /// Rest after each stroke, s.
    pub dwell_s: f64,
    /// A joint is taken to be no faster than this: strokes that are sent faster wait for it, rad/s.
    pub assumed_speed_rad_s: f64,
    /// Rest before the first joint and after the last one, s.
    pub rest_s: f64,
}

/// Strokes at one speed: to one side, to the other, and back; at the top speed once more across.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Ramp {
    /// Speed that is sent, rad/s.
    pub speed_rad_s: f64,
    /// Distance from home, rad.
    pub travel_rad: f64,
}

/// Strokes shorter than this show nothing, rad.
const LEAST_RAD: f64 = DEGREE_RAD;

/// Strokes grow with their speed up to this, rad.
const FARTHEST_RAD: f64 = 60.0 * DEGREE_RAD;

/// No joint is sent more slowly, rad/s.
const LEAST_RAD_S: f64 = 1e-4;

/// Of a joint that slides a centimetre stands for a degree of the strokes.
fn scale(kind: JointKind) -> f64 {
    match kind {
        JointKind::Turns => 1.0,
        JointKind::Slides => 0.01 / DEGREE_RAD,
    }
}
/// A stroke takes this long to its speed, and from it, s.
pub const RAMP_S: f64 = 0.12;
/// Points a second of the trajectory that strokes are made for: the cubic curve through these is the strokes themselves.
pub const STROKE_POINTS_HZ: f64 = 25.0;
const POINT_S: f64 = 1.0 / STROKE_POINTS_HZ;
/// Angles as close as this are one, rad.
const ROUNDED_RAD: f64 = 1e-9;

/// One joint of the run; of one that slides a radian stands for a metre.
#[derive(Debug, Clone, PartialEq)]
pub struct JointRoom {
    /// The joint.
    pub name: String,
    /// Whether it turns or slides.
    pub kind: JointKind,
    /// Where it starts and ends, rad.
    pub home_rad: f64,
    /// Lowest and highest angle, rad.
    pub range_rad: [f64; 2],
    /// Largest speed that it is sent, rad/s; infinite for none.
    pub most_rad_s: f64,
}

impl JointRoom {
    /// A joint that turns, as fast as strokes are.
    pub fn turning(name: impl Into<String>, home_rad: f64, range_rad: [f64; 2]) -> Self {
        let (name, kind) = (name.into(), JointKind::Turns);
        Self { name, kind, home_rad, range_rad, most_rad_s: f64::INFINITY }
    }
}

impl Ramp {
    /// The speed of its strokes across both sides, rad/s: in times that are those of points, a little less than asked for.
    pub fn sent_rad_s(&self) -> f64 {
        top_rad_s(2.0 * self.travel_rad, self.speed_rad_s).0
    }
}

impl Excitation {
    /// Slow and much too fast strokes: twenty seconds a joint.
    pub fn minimal() -> Self {
        Self::at(&[(3.0, 6.0), (60.0, 10.0)])
    }

    /// Strokes at five speeds: a minute a joint, the fastest far beyond most machines.
    pub fn full() -> Self {
        Self::at(&[(1.0, 4.0), (3.0, 6.0), (8.0, 8.0), (18.0, 10.0), (60.0, 10.0)])
    }

    fn at(ramps_deg: &[(f64, f64)]) -> Self {
        let ramp = |&(speed, travel): &(f64, f64)| Ramp {
            speed_rad_s: speed * DEGREE_RAD,
            travel_rad: travel * DEGREE_RAD,
        };
        Self {
            ramps: ramps_deg.iter().map(ramp).collect(),
            dwell_s: 1.5,
            assumed_speed_rad_s: 15.0 * DEGREE_RAD,
            rest_s: 1.0,
        }
    }

    /// The ramps of a joint of a kind that is sent as fast as so at most, and once so fast where that is told; of those that are
    /// then equally fast the longest stays.
    pub fn ramps(&self, kind: JointKind, most_rad_s: f64) -> Vec<Ramp> {
        let by = scale(kind);
        let fastest_rad_s = by * self.ramps.iter().map(|ramp| ramp.speed_rad_s).fold(0.0, f64::max);
        let ramp = |ramp: &Ramp| {
            // Where more is allowed than the strokes have: the fastest is that fast, and as much longer.
            let grows = most_rad_s.is_finite() && by * ramp.speed_rad_s >= fastest_rad_s;
            let more = if grows { (most_rad_s / fastest_rad_s).max(1.0) } else { 1.0 };
            let farthest_rad = ramp.travel_rad.max(FARTHEST_RAD);
            Ramp {
                speed_rad_s: (by * more * ramp.speed_rad_s).min(most_rad_s),
                travel_rad: by * (more * ramp.travel_rad).min(farthest_rad),
            }
        };
        let mut ramps: Vec<Ramp> = self.ramps.iter().map(ramp).collect();
        ramps.dedup_by(|a, b| {
            let same = a.speed_rad_s <= b.speed_rad_s;
            b.travel_rad = if same { b.travel_rad.max(a.travel_rad) } else { b.travel_rad };
            same
        });
        ramps
    }

    fn check(&self) -> Result<(), FitError> {
        let ramps = self.ramps.iter().flat_map(|ramp| {
            [
                ("speed_rad_s", ramp.speed_rad_s, LEAST_RAD_S, 100.0),
                ("travel_rad", ramp.travel_rad, 1e-4, 3.0),
            ]
        });
        let own = [
            ("dwell_s", self.dwell_s, 0.0, 60.0),
            ("assumed_speed_rad_s", self.assumed_speed_rad_s, 1e-3, 100.0),
            ("rest_s", self.rest_s, 0.0, 60.0),
        ];
        let bad = ramps.chain(own).find(|&(_, found, least, most)| !(found >= least && found <= most));
        bad.map_or(Ok(()), |(key, found, least, most)| Err(FitError::Setting { key, found, least, most }))
    }
}

/// Drives one joint after the other through its ramps, the others at home, every [`STEP_S`] with
/// positions and speeds.
///
/// A stroke that would leave a joint's range is made to the other side only, twice; one that fits on neither side is as long
/// as the range allows.
///
/// # Errors
///
/// [`FitError::Setting`], and [`FitError::NoRoom`] for a joint that has less than a degree, or a centimetre, on either side.
pub fn excite(joints: &[JointRoom], excitation: &Excitation) -> Result<Series, FitError> {
    excitation.check()?;
    let mut strokes = Vec::with_capacity(joints.len());
    for joint in joints {
        if joint.most_rad_s.is_nan() || joint.most_rad_s < LEAST_RAD_S {
            let (found, least) = (joint.most_rad_s, LEAST_RAD_S);
            return Err(FitError::Setting { key: "most_rad_s", found, least, most: f64::INFINITY });
        }
        strokes.push(joint_strokes(joint, excitation)?);
    }
    let own: Vec<usize> = strokes.iter().map(Vec::len).collect();
    let rest = steps_in(excitation.rest_s).next_multiple_of(steps_in(POINT_S));
    let total = 2 * rest + own.iter().sum::<usize>() + 1;
    let t_s: Vec<f64> = (0..total).map(|k| k as f64 * STEP_S).collect();
    let mut before = rest;
    let mut tracks = Vec::with_capacity(joints.len());
    for (joint, strokes) in joints.iter().zip(&strokes) {
        let mut position_rad = vec![joint.home_rad; total];
        let mut velocity_rad_s = vec![0.0; total];
        for (k, (position, velocity)) in strokes.iter().enumerate() {
            position_rad[before + k] = *position;
            velocity_rad_s[before + k] = *velocity;
        }
        before += strokes.len();
        let track = Track::of(joint.kind, &joint.name, t_s.clone(), position_rad, &[])
            .and_then(|track| track.with_velocity(velocity_rad_s));
        tracks.push(track.map_err(|_| no_room(joint, f64::NAN))?);
    }
    Ok(Series { tracks })
}

fn no_room(joint: &JointRoom, travel_rad: f64) -> FitError {
    FitError::NoRoom {
        joint: joint.name.clone(),
        kind: joint.kind,
        home_rad: joint.home_rad,
        lowest_rad: joint.range_rad[0],
        highest_rad: joint.range_rad[1],
        travel_rad,
    }
}

/// Angles and speeds of one joint's part of the run.
fn joint_strokes(joint: &JointRoom, excitation: &Excitation) -> Result<Vec<(f64, f64)>, FitError> {
    let [lowest, highest] = joint.range_rad;
    let (ramps, least_rad) = (excitation.ramps(joint.kind, joint.most_rad_s), scale(joint.kind) * LEAST_RAD);
    let assumed_rad_s = scale(joint.kind) * excitation.assumed_speed_rad_s;
    let inside = |angle_rad: f64| (lowest - ROUNDED_RAD..=highest + ROUNDED_RAD).contains(&angle_rad);
    let home = joint.home_rad;
    let [below, above] = [home - lowest, highest - home];
    if below < -ROUNDED_RAD || above < -ROUNDED_RAD || below.max(above) < least_rad {
        return Err(no_room(joint, least_rad));
    }
    // To both sides, if that leaves enough and goes no less far than to one.
    let both = below.min(above);
    let room = if both >= least_rad && 2.0 * both >= below.max(above) { both } else { below.max(above) };
    let mut states = Vec::new();
    let fastest_rad_s = ramps.iter().map(|ramp| ramp.speed_rad_s).fold(0.0, f64::max);
    for ramp in &ramps {
        let fastest = ramp.speed_rad_s >= fastest_rad_s;
        let sides = [home + ramp.travel_rad, home - ramp.travel_rad].map(inside);
        let travel_rad = match sides {
            // To one side as far as across both.
            [true, false] | [false, true] if fastest => (2.0 * ramp.travel_rad).min(below.max(above)),
            [false, false] => ramp.travel_rad.min(room),
            _ => ramp.travel_rad,
        };
        let (up, down) = ((home + travel_rad).min(highest), (home - travel_rad).max(lowest));
        let goals = match (inside(home + travel_rad), inside(home - travel_rad)) {
            // At the top speed both directions need a long stroke.
            (true, true) if fastest => vec![up, down, up, home],
            (true, true) => vec![up, down, home],
            (true, false) => vec![up, home, up, home],
            (false, true) => vec![down, home, down, home],
            (false, false) => return Err(no_room(joint, ramp.travel_rad)),
        };
        let mut from = home;
        for goal in goals {
            stroke([from, goal], [ramp.speed_rad_s, assumed_rad_s], excitation.dwell_s, &mut states);
            from = goal;
        }
    }
    Ok(states)
}

/// The speed of a stroke, of the sign of its way, and how long it has it, s.
fn top_rad_s(way: f64, speed_rad_s: f64) -> (f64, f64) {
    let cruise_s = (way.abs() / speed_rad_s - RAMP_S).max(0.0);
    let cruise_s = (cruise_s / POINT_S - 1e-6).ceil().max(0.0) * POINT_S;
    (way / (RAMP_S + cruise_s), cruise_s)
}

/// One stroke and the rest after it. Its speed grows and falls evenly, in times that are those of the points of a trajectory:
/// the cubic curve through them, which controllers follow, is the stroke itself.
fn stroke(
    [from, goal]: [f64; 2],
    [speed_rad_s, assumed_rad_s]: [f64; 2],
    dwell_s: f64,
    states: &mut Vec<(f64, f64)>,
) {
    let way = goal - from;
    let (top_rad_s, cruise_s) = top_rad_s(way, speed_rad_s);
    let end_s = 2.0 * RAMP_S + cruise_s;
    let needed_s = way.abs() / speed_rad_s.min(assumed_rad_s);
    let steps = steps_in(needed_s.max(end_s) + dwell_s).next_multiple_of(steps_in(POINT_S));
    for k in 0..steps {
        let t_s = k as f64 * STEP_S;
        let left_s = (end_s - t_s).max(0.0);
        let position = if t_s < RAMP_S {
            from + top_rad_s * t_s * t_s / (2.0 * RAMP_S)
        } else if left_s > RAMP_S {
            from + top_rad_s * (t_s - 0.5 * RAMP_S)
        } else {
            goal - top_rad_s * left_s * left_s / (2.0 * RAMP_S)
        };
        states.push((position, top_rad_s * t_s.min(left_s).min(RAMP_S) / RAMP_S));
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in crate::fit) fn run(excitation: &Excitation) -> Series {
        let joint = |name: &str, home: f64, low: f64, high: f64| {
            JointRoom::turning(name, home * DEGREE_RAD, [low, high].map(|end| end * DEGREE_RAD))
        };
        excite(&[joint("boom", 40.0, 30.0, 50.0), joint("bucket", 12.0, 0.0, 20.0)], excitation).unwrap()
    }

    /// The largest angle, and speed, of the cubic curve through points of a trajectory, 25 a second.
    fn followed(track: &Track) -> ([f64; 2], f64) {
        let (mut angles, mut fastest) = ([f64::INFINITY, f64::NEG_INFINITY], 0.0_f64);
        let points: Vec<f64> = (0..20_000)
            .map(|k| 0.04 * f64::from(k))
            .take_while(|t| *t < track.t_s()[track.len() - 1])
            .collect();
        for two in points.windows(2) {
            let [a, b] = [two[0], two[1]].map(|t| track.held_at(t));
            let h = two[1] - two[0];
            for k in 0..=20 {
                let s = f64::from(k) / 20.0;
                let (s2, s3) = (s * s, s * s * s);
                let at = (2.0 * s3 - 3.0 * s2 + 1.0) * a.position
                    + (s3 - 2.0 * s2 + s) * h * a.velocity
                    + (3.0 * s2 - 2.0 * s3) * b.position
                    + (s3 - s2) * h * b.velocity;
                let speed = (6.0 * s2 - 6.0 * s) / h * (a.position - b.position)
                    + (3.0 * s2 - 4.0 * s + 1.0) * a.velocity
                    + (3.0 * s2 - 2.0 * s) * b.velocity;
                angles = [angles[0].min(at), angles[1].max(at)];
                fastest = fastest.max(speed.abs());
            }
        }
        (angles, fastest)
    }

    #[test]
    fn what_a_controller_makes_of_the_points_keeps_the_range_and_the_speed() {
        for excitation in [Excitation::minimal(), Excitation::full()] {
            let run = run(&excitation);
            for (track, [low, high]) in run.tracks.iter().zip([[30.0, 50.0], [0.0, 20.0]]) {
                let (angles, fastest) = followed(track);
                assert!(
                    angles[0] > low * DEGREE_RAD - 1e-6 && angles[1] < high * DEGREE_RAD + 1e-6,
                    "{angles:?}"
                );
                assert!(fastest < 60.0 * DEGREE_RAD + 1e-6 && fastest > 45.0 * DEGREE_RAD, "{fastest}");
            }
        }
    }
}
