//! Plan and measurement of joints, side by side, and by how much the one is later than the other.

use crate::{
    math::{deviation, quantile, range, whole},
    series::{Series, Track},
};

/// Instants at which plan and measurement are compared.
const INSTANTS: usize = 400;

/// Planned motion, root mean square distance from its mean, of a joint that can tell: rad or m.
const TELLS: f64 = 0.01;

/// Measured motion by planned motion of a joint that can tell.
const MOVED: f64 = 0.5;

/// Runs whose joints lie this far from their plan, root mean square by planned motion, are looked at.
pub(super) const FAR: f64 = 0.05;

/// What is left of that if the time is the reason: of what no machine does, and of what one at its limits does in part.
pub(super) const LEFT: [f64; 2] = [0.4, 0.2];

/// Shifts that are tried, s, by coarse and by fine steps.
const WIDEST_S: f64 = 15.0;
const STEPS_S: [f64; 2] = [0.25, 0.01];

/// A search for a shift looks at a plan in steps, s, up to so many; one that is longer is looked up each time.
const PLAN_STEP_S: f64 = 0.02;
const MOST_STEPS: f64 = 1e6;

/// A motion that repeats itself fits as well a period later: a shift that leaves so much more of the motion, and with shifts between that
/// leave more than this share of it, is as good as the best, and the smallest of these is told, a lead counting so many times as a lag.
const ALIKE: f64 = 0.1;
const BETWEEN: f64 = 0.5;
const LEAD_COUNTS: f64 = 2.0;

/// Shifts between these are what machines do, s.
pub(super) const USUAL_S: [f64; 2] = [-0.1, 1.0];

/// What is late may be a delay, as of a clock, and the lag of so many equal filters, as of set values, which takes up to so many tenths
/// of it: more is lag than is late where a plan ends early.
const FILTERS: [u32; 3] = [1, 2, 3];
const MOST_TENTHS: u32 = 12;

/// A part tells where the plan moves in it by this share of its motion.
const PART_TELLS: f64 = 0.3;

/// Another speed leaves less than this share of what a lag leaves.
pub(super) const LESS_THAN_LAG: f64 = 0.5;

/// Share of its range after which a joint has begun to move, and before which it has not ended.
pub(super) const BEGUN: f64 = 0.05;

/// A joint's plan, and some of its measurement.
pub(super) struct Both<'a> {
    pub(super) planned: &'a Track,
    pub(super) measured: &'a Track,
    /// Instant, s, and position, while there is a plan.
    pub(super) came: Vec<[f64; 2]>,
    /// Root mean square distance of the plan from its mean.
    pub(super) motion: f64,
}

impl<'a> Both<'a> {
    /// Those of all joints that tell.
    pub(super) fn all(planned: &'a Series, measured: &'a Series) -> Vec<Self> {
        let both = |track| Self::of(track, measured.track(Track::name(track))?);
        planned.tracks.iter().filter_map(both).collect()
    }

    /// `None` for a joint that is not planned to move, or did not.
    fn of(planned: &'a Track, measured: &'a Track) -> Option<Self> {
        let [first_s, last_s] = [planned.t_s().first()?, planned.t_s().last()?];
        let within = measured.t_s().partition_point(|t_s| t_s < first_s)
            ..measured.t_s().partition_point(|t_s| t_s <= last_s);
        let (t_s, q) = (measured.t_s().get(within.clone())?, measured.position().get(within)?);
        let step = t_s.len().div_ceil(INSTANTS).max(1);
        let came: Vec<[f64; 2]> = t_s.iter().zip(q).step_by(step).map(|(t_s, q)| [*t_s, *q]).collect();
        let motion =
            deviation(&came.iter().map(|[t_s, _]| planned.held_at(*t_s).position).collect::<Vec<f64>>());
        let moved = deviation(&came.iter().map(|[_, q]| *q).collect::<Vec<f64>>());
        (motion > TELLS && moved > MOVED * motion).then_some(Self { planned, measured, came, motion })
    }

    /// From when its plan leaves rest until it has gone a twentieth of its range, s.
    pub(super) fn start_s(&self) -> Option<[f64; 2]> {
        const LEFT: f64 = 0.002;
        let (t_s, q) = (self.planned.t_s(), self.planned.position());
        let [lowest, highest] = range(q.iter().copied());
        let gone = |share: f64| q.iter().position(|x| (x - q[0]).abs() > share * (highest - lowest));
        Some([t_s[gone(LEFT)?], t_s[gone(BEGUN)?]])
    }

    pub(super) fn lasts_s(&self) -> Option<f64> {
        Some(self.came.last()?[0] - self.came.first()?[0])
    }

    /// Root mean square speed of the plan, a second.
    pub(super) fn planned_speed(&self) -> f64 {
        let at: Vec<f64> = self.came.iter().map(|[t_s, _]| self.planned.held_at(*t_s).position).collect();
        let squares: f64 = at.windows(2).map(|two| (two[1] - two[0]).powi(2)).sum();
        squares.sqrt() / self.lasts_s().unwrap_or(f64::INFINITY)
    }

    /// The three parts of a run; none of one in which the joint hardly moves.
    pub(super) fn parts(&self) -> [Option<Both<'a>>; 3] {
        let each = self.came.len() / 3;
        [0, 1, 2].map(|part| {
            let came = self.came[part * each..(part + 1) * each].to_vec();
            let planned: Vec<f64> = came.iter().map(|[t_s, _]| self.planned.held_at(*t_s).position).collect();
            let (motion, moved) =
                (deviation(&planned), deviation(&came.iter().map(|[_, q]| *q).collect::<Vec<f64>>()));
            let tells = motion > PART_TELLS * self.motion && moved > MOVED * motion;
            tells.then_some(Both { planned: self.planned, measured: self.measured, came, motion })
        })
    }

    /// Root mean square error by planned motion, where the plan is so.
    pub(super) fn apart(&self, plan: impl Fn(f64) -> f64) -> f64 {
        let square = |[t_s, q]: &[f64; 2]| (q - plan(*t_s)).powi(2);
        (self.came.iter().map(square).sum::<f64>() / self.came.len() as f64).sqrt() / self.motion
    }
}

/// A plan in even steps, with lines between them.
pub(super) struct Steps {
    first_s: f64,
    position: Vec<f64>,
}

impl Steps {
    /// `None` if the plan is so long that steps would take more memory than they are worth.
    pub(super) fn of(planned: &Track) -> Option<Self> {
        let [first_s, last_s] = [*planned.t_s().first()?, *planned.t_s().last()?];
        let steps = ((last_s - first_s) / PLAN_STEP_S).ceil();
        if steps > MOST_STEPS {
            return None;
        }
        let mut cursor = 0;
        let at = |k: f64| planned.held_after(&mut cursor, first_s + k * PLAN_STEP_S).position;
        let position =
            std::iter::successors(Some(0.0), |k| (*k < steps).then_some(k + 1.0)).map(at).collect();
        Some(Self { first_s, position })
    }

    /// Behind so many filters of a time constant, s.
    fn lagged(&self, filters: u32, time_s: f64) -> Self {
        let follow = 1.0 - (-PLAN_STEP_S / time_s).exp();
        let mut position = self.position.clone();
        for _ in 0..filters {
            let mut now = position[0];
            for at in &mut position {
                now += follow * (*at - now);
                *at = now;
            }
        }
        Self { first_s: self.first_s, position }
    }

    /// Before the first step and after the last, the plan holds.
    pub(super) fn at(&self, t_s: f64) -> f64 {
        let steps = ((t_s - self.first_s) / PLAN_STEP_S).clamp(0.0, (self.position.len() - 1) as f64);
        let before = whole(steps);
        let (from, to) = (self.position[before], self.position[(before + 1).min(self.position.len() - 1)]);
        from + (steps - steps.floor()) * (to - from)
    }
}

/// That of the joint in the middle, by the position that the plan of each has at an instant; NaN without a joint.
pub(super) fn apart(joints: &[Both], plan: impl Fn(usize, f64) -> f64) -> f64 {
    let each = joints.iter().enumerate();
    quantile(each.map(|(joint, both)| both.apart(|t_s| plan(joint, t_s))).collect(), 0.5)
}

/// By how much the measurement is later than a plan that it follows best, s.
pub(super) fn shift_s(joints: &[Both]) -> f64 {
    let steps: Vec<Option<Steps>> = joints.iter().map(|joint| Steps::of(joint.planned)).collect();
    let plan = |joint: usize, t_s: f64| match &steps[joint] {
        Some(steps) => steps.at(t_s),
        None => joints[joint].planned.held_at(t_s).position,
    };
    let at = |shift_s: f64| (apart(joints, |joint, t_s| plan(joint, t_s - shift_s)), shift_s);
    let mut best = (f64::INFINITY, 0.0);
    let mut reach_s = WIDEST_S;
    for step_s in STEPS_S {
        let tried = tried_s(best.1 - reach_s, best.1 + reach_s, step_s).map(at);
        best = tried.fold(best, |best, one| if one.0 < best.0 { one } else { best });
        reach_s = step_s;
    }
    let (left, best_s) = best;
    if (USUAL_S[0]..=STEPS_S[0]).contains(&best_s) {
        return best_s;
    }
    let tried: Vec<(f64, f64)> =
        tried_s(-best_s.abs(), LEAD_COUNTS * best_s.abs(), STEPS_S[1]).map(at).collect();
    let ridge = |shift_s: f64| {
        let between = tried.iter().filter(|(_, s)| (s - shift_s) * (s - best_s) < 0.0);
        between.map(|(left, _)| *left).fold(0.0, f64::max) > left + BETWEEN
    };
    let valleys = tried.windows(3).filter(|w| w[1].0 <= w[0].0 && w[1].0 <= w[2].0).map(|w| w[1]);
    let alike = valleys.filter(|(also, shift_s)| *also <= left + ALIKE && ridge(*shift_s));
    let counts = |shift_s: f64| shift_s.max(-LEAD_COUNTS * shift_s);
    let found = alike.map(|(_, shift_s)| shift_s).chain([best_s]);
    found.min_by(|a, b| counts(*a).total_cmp(&counts(*b))).unwrap_or(best_s)
}

/// Shifts from one to another in steps, s.
fn tried_s(from_s: f64, to_s: f64, step_s: f64) -> impl Iterator<Item = f64> {
    std::iter::successors(Some(from_s), move |shift_s| Some(shift_s + step_s))
        .take_while(move |shift_s| *shift_s <= to_s)
}

/// Of a delay and a lag that are so late together the pair that leaves least: what that is, and the delay, s. No lag is told from a plan
/// too long for steps.
pub(super) fn lagged(joints: &[Both], shift_s: f64) -> (f64, f64) {
    let Some(steps) = joints.iter().map(|joint| Steps::of(joint.planned)).collect::<Option<Vec<Steps>>>()
    else {
        let left = apart(joints, |joint, t_s| joints[joint].planned.held_at(t_s - shift_s).position);
        return (left, shift_s);
    };
    let pair = |(filters, tenths): (u32, u32)| {
        // No zero below zero: a lag of that is no number.
        let lag_s = if shift_s > 0.0 { 0.1 * f64::from(tenths) * shift_s } else { 0.0 };
        let delay_s = shift_s - lag_s;
        let plans: Vec<Steps> =
            steps.iter().map(|steps| steps.lagged(filters, lag_s / f64::from(filters))).collect();
        (apart(joints, |joint, t_s| plans[joint].at(t_s - delay_s)), delay_s)
    };
    let tried =
        FILTERS.into_iter().flat_map(|filters| (0..=MOST_TENTHS).map(move |tenths| (filters, tenths)));
    tried.map(pair).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, shift_s))
}
