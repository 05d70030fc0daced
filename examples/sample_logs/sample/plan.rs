//! The plan of the sample runs: from home to a panel, a dwell to grip it, to the wall, a correction.
//!
//! Every move is a minimum-jerk quintic from rest to rest, so a trajectory whose points are the
//! ends of all moves says the same as the plan itself. The limits that moves respect are those
//! assumed for the sample arm: 15, 15, 35, 8, 8, 8 deg/s; 20, 20, 40, 10, 10, 10 deg/s²; 40, 40,
//! 80, 20, 20, 20 deg/s³. The poses are made up in the neighbourhood of the paper's.

use hydrotrace::units::DEGREE_RAD;

/// Length of a run, s.
pub(crate) const DURATION_S: f64 = 40.0;

/// The rest of all joints in which the panel is gripped, s.
pub(crate) const DWELL_S: [f64; 2] = [15.0, 20.0];

/// What one joint is asked to do.
#[derive(Debug, Clone)]
pub(crate) struct JointPlan {
    home_rad: f64,
    moves: Vec<Move>,
}

#[derive(Debug, Clone, Copy)]
struct Move {
    start_s: f64,
    duration_s: f64,
    to_rad: f64,
}

/// Where the plan wants a joint at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Planned {
    pub(crate) angle_rad: f64,
    pub(crate) speed_rad_s: f64,
    pub(crate) acceleration_rad_s2: f64,
}

/// Home, then moves: start s, duration s, to. Angles in degrees.
type Row = (f64, &'static [(f64, f64, f64)]);

#[rustfmt::skip]
const ROWS: [Row; 6] = [
    (30.0, &[(2.0, 4.2, 62.0), (10.5, 3.8, 52.0), (21.0, 3.8, 36.0), (30.0, 3.6, 48.0)]),
    (130.0, &[(2.6, 4.0, 106.0), (11.0, 3.4, 116.0), (20.6, 4.0, 94.0), (24.6, 3.4, 104.0)]),
    (-60.0, &[(3.2, 3.8, -2.0), (9.0, 3.2, 18.0), (20.2, 3.8, -34.0), (24.0, 3.2, -10.0), (33.0, 3.0, -26.0)]),
    (0.0, &[(5.0, 3.8, 14.0), (11.8, 3.0, 8.0), (22.0, 4.0, -6.0), (31.0, 3.2, 3.0)]),
    (0.0, &[(6.0, 3.4, -11.0), (23.0, 4.0, 5.0), (31.5, 3.0, -3.0)]),
    (0.0, &[(7.0, 3.2, 9.0), (10.2, 3.2, 0.0), (24.5, 3.2, -9.0), (32.0, 3.2, 1.0)]),
];

/// The plan of `joint_1` to `joint_6`.
pub(crate) fn panel_install() -> Vec<JointPlan> {
    let joint = |(home_deg, moves): Row| JointPlan {
        home_rad: home_deg * DEGREE_RAD,
        moves: moves
            .iter()
            .map(|&(start_s, duration_s, to_deg)| Move { start_s, duration_s, to_rad: to_deg * DEGREE_RAD })
            .collect(),
    };
    ROWS.into_iter().map(joint).collect()
}

impl JointPlan {
    /// Asks the joint for nothing.
    pub(crate) fn at_rest(mut self) -> Self {
        self.moves.clear();
        self
    }

    /// Where the joint should be; home before its first move, at the end of its last one after it.
    pub(crate) fn at(&self, t_s: f64) -> Planned {
        let mut from_rad = self.home_rad;
        for step in &self.moves {
            if t_s < step.start_s {
                break;
            }
            if t_s < step.start_s + step.duration_s {
                return step.at(from_rad, t_s);
            }
            from_rad = step.to_rad;
        }
        Planned { angle_rad: from_rad, speed_rad_s: 0.0, acceleration_rad_s2: 0.0 }
    }

    fn ends_s(&self) -> impl Iterator<Item = f64> + '_ {
        self.moves.iter().flat_map(|step| [step.start_s, step.start_s + step.duration_s])
    }
}

impl Move {
    /// `s³(10 - 15s + 6s²)` of the way, with its derivatives.
    fn at(&self, from_rad: f64, t_s: f64) -> Planned {
        let way_rad = self.to_rad - from_rad;
        let s = (t_s - self.start_s) / self.duration_s;
        let rest = 1.0 - s;
        Planned {
            angle_rad: from_rad + way_rad * s * s * s * (10.0 + s * (6.0 * s - 15.0)),
            speed_rad_s: way_rad / self.duration_s * 30.0 * s * s * rest * rest,
            acceleration_rad_s2: way_rad / (self.duration_s * self.duration_s) * 60.0 * s * rest * (rest - s),
        }
    }
}

/// Instants at which a trajectory needs a point: the ends of all moves of all joints, and of the run.
pub(crate) fn knots_s(plans: &[JointPlan]) -> Vec<f64> {
    let mut knots_s: Vec<f64> = plans.iter().flat_map(JointPlan::ends_s).chain([0.0, DURATION_S]).collect();
    knots_s.sort_by(f64::total_cmp);
    // Ends computed as sums differ from equal starts in the last bit.
    knots_s.dedup_by(|later, earlier| *later - *earlier < 1e-6);
    knots_s
}
