//! A curve's limits, key points and jerk, linearised in its control points and the logarithms of its intervals.

use super::{aim::Aim, curve::Frame, factor::Unknowns, point::Point, row::Row};
use crate::spline::{Degree, Motion, Place, Quantity, Segment, WINDOW, Weights};

/// Places on every piece at which limits are kept.
pub(super) const PLACES: usize = 7;

/// Peaks below this share of a limit are left to the places.
const NEAR: f64 = 0.7;

/// Nodes and weights on (0, 1) of Gauss's rule, exact for the square of cubic jerk.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// All that a step is made from.
pub(super) struct Model {
    pub(super) unknowns: Unknowns,
    /// Shares of limits, signed, each with the number of its limit and piece.
    pub(super) shares: Vec<(usize, Row)>,
    /// Angles at key points less what they must be, or less what brings the tool there, rad.
    pub(super) passes: Vec<Row>,
    /// Angles at key points where the tool is given, rad.
    pub(super) postures: Vec<Row>,
    /// Joints and their jerk at Gauss nodes, so weighted that the squares sum to the integral, rad/s^2.5.
    pub(super) jerk: Vec<(usize, Row)>,
    /// The same of power, W s^0.5; where it counts.
    pub(super) power: Vec<(usize, Row)>,
}

impl Model {
    /// With rows at peaks beside those at the places of every piece.
    pub(super) fn of(frame: &Frame<'_>, here: &Point, aim: &Aim, peaks: &[Peak]) -> Self {
        let (joints, curve, motion) = (frame.joints(), &here.curve, &here.motion);
        let mut model = Self {
            unknowns: Unknowns {
                joints,
                free: motion.segments().iter().map(|segment| segment.spline.t_s().len() - 2).collect(),
                window: frame.degree().order() + 1,
                border: curve.interval_s.len() + 1,
                joined: false,
            },
            shares: Vec::new(),
            passes: Vec::new(),
            postures: Vec::new(),
            jerk: Vec::new(),
            power: Vec::new(),
        };
        for (index, segment) in motion.segments().iter().enumerate() {
            let part = Part { segment, index, interval_s: &curve.interval_s };
            for piece in 0..segment.spline.pieces() {
                for k in 0..PLACES {
                    let share = k as f64 / (PLACES - 1) as f64;
                    if k + 1 == PLACES && piece + 1 < segment.spline.pieces() {
                        continue;
                    }
                    model.limits(frame, &part, Place::Piece(piece, share));
                }
                model.squared_jerk(joints, &part, piece);
            }
            for peak in peaks.iter().filter(|peak| peak.segment == index) {
                let weights = segment.spline.weights(Place::Piece(peak.piece, peak.share));
                model.limit(frame, &part, &weights, (peak.joint, peak.order));
            }
            let (first, last) = segment.ends();
            for &key in frame.key.iter().filter(|key| (first + 1..last).contains(*key)) {
                let weights = segment.spline.weights(Place::Point(key - first));
                let rows: Vec<Row> = (0..joints).map(|joint| part.row(&weights, 0, joint)).collect();
                let angles = &curve.point_rad[key * joints..][..joints];
                if let Some(pose) = frame.pose(key) {
                    model.unknowns.joined = true;
                    model.postures.extend(rows.iter().cloned());
                    for (direction, left_rad) in frame.setup.arm.chain.held(pose, angles) {
                        model.passes.push(Row::joined(&rows, 1, |joint| direction[joint], -left_rad));
                    }
                    continue;
                }
                for (mut row, angle) in rows.into_iter().zip(angles) {
                    row.value -= angle;
                    model.passes.push(row);
                }
            }
        }
        model.loads(frame, here, aim);
        model
    }

    fn limits(&mut self, frame: &Frame<'_>, part: &Part<'_>, place: Place) {
        let weights = part.segment.spline.weights(place);
        for joint in 0..frame.joints() {
            for order in 0..4 {
                self.limit(frame, part, &weights, (joint, order));
            }
        }
    }

    /// The share of a limit, if there is one.
    fn limit(
        &mut self,
        frame: &Frame<'_>,
        part: &Part<'_>,
        weights: &Weights,
        (joint, order): (usize, usize),
    ) {
        let Some((middle, half)) = frame.bounds[joint].of(order) else { return };
        let mut row = part.row(weights, order, joint);
        row.value -= middle;
        let piece = part.segment.first_point + weights.first_control;
        let number = ((piece * 2 + 1) * frame.joints() + joint) * 4 + order;
        self.shares.push((number, row.scaled(1.0 / half)));
    }

    fn squared_jerk(&mut self, joints: usize, part: &Part<'_>, piece: usize) {
        let spline = &part.segment.spline;
        let degree = spline.degree().order();
        let knots_s = &spline.knots_s()[degree..];
        let length_s = knots_s[piece + 1] - knots_s[piece];
        for (share, weight) in GAUSS {
            let weights = spline.weights(Place::Piece(piece, share));
            for joint in 0..joints {
                let row = part.with_length(part.row(&weights, 3, joint), piece, length_s);
                self.jerk.push((joint, row.scaled((weight * length_s).sqrt())));
            }
        }
    }
}

/// Where a curve comes nearest to a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Peak {
    segment: usize,
    piece: usize,
    joint: usize,
    order: usize,
    /// Share of the piece.
    share: f64,
}

/// Peaks between the places, where they come near a limit.
pub(super) fn peaks(frame: &Frame<'_>, motion: &Motion) -> Vec<Peak> {
    let mut peaks = Vec::new();
    for (segment, part) in motion.segments().iter().enumerate() {
        let spline = &part.spline;
        for (joint, bounds) in frame.bounds.iter().enumerate() {
            for (order, quantity) in Quantity::ALL.into_iter().enumerate() {
                let Some((middle, half)) = bounds.of(order) else { continue };
                for piece in 0..spline.pieces() {
                    spline.stationary(joint, quantity, piece, |share, value| {
                        if (value - middle).abs() > NEAR * half {
                            peaks.push(Peak { segment, piece, joint, order, share });
                        }
                    });
                }
            }
        }
    }
    peaks
}

/// One segment and where it stands in the whole.
pub(super) struct Part<'a> {
    pub(super) segment: &'a Segment,
    pub(super) index: usize,
    pub(super) interval_s: &'a [f64],
}

impl Part<'_> {
    /// Intervals that a piece takes part of, and how much.
    fn lengths(&self, piece: usize) -> impl Iterator<Item = (usize, f64)> {
        let (first, count) = (self.segment.first_point, self.segment.spline.t_s().len() - 1);
        let parts = match self.segment.spline.degree() {
            Degree::Sextic => [(piece.wrapping_sub(1), 0.5), (piece, 0.5)],
            Degree::Quintic | Degree::Septic => [(piece, 1.0), (usize::MAX, 0.0)],
        };
        parts.into_iter().filter(move |(interval, _)| *interval < count).map(move |(i, by)| (first + i, by))
    }

    /// A value whose weight in a sum of squares grows with the length of its piece, s.
    pub(super) fn with_length(&self, mut row: Row, piece: usize, length_s: f64) -> Row {
        for (interval, by) in self.lengths(piece) {
            let slope = 0.5 * by * self.interval_s[interval] / length_s * row.value;
            row.interval[interval - row.first_interval] += slope;
        }
        row
    }

    pub(super) fn row(&self, weights: &Weights, order: usize, joint: usize) -> Row {
        let spline = &self.segment.spline;
        let controls = spline.control(joint, Quantity::Position);
        let (fixed, count) = (spline.fixed_controls(), spline.degree().order() + 1);
        let free = controls.len() - 2 * fixed;
        let first = weights.first_control.saturating_sub(fixed).min(free);
        let mut row = Row {
            segment: self.index,
            first,
            joint,
            control: [0.0; 8],
            others: Vec::new(),
            first_interval: self.segment.first_point + weights.first_interval,
            interval: [0.0; WINDOW],
            value: 0.0,
        };
        for (k, control) in controls[weights.first_control..][..count].iter().enumerate() {
            let weight = weights.value[order][k];
            row.value += control * weight;
            for (sum, slope) in row.interval.iter_mut().zip(weights.slope[order][k]) {
                *sum += control * slope;
            }
            let own = weights.first_control + k;
            if (fixed..fixed + free).contains(&own) {
                row.control[own - fixed - first] = weight;
            }
        }
        let last = self.segment.first_point + spline.t_s().len() - 1;
        for (k, slope) in row.interval.iter_mut().enumerate() {
            let interval = row.first_interval + k;
            *slope *= if interval < last { self.interval_s[interval] } else { 0.0 };
        }
        row
    }
}
