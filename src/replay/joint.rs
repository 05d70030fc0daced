//! One joint: signals, motions, matching of planned with measured starts, and figures.

use super::{
    Answer, JointReplay, Kind, Rules, Stop, Transition,
    answer::rise,
    delay::{measured_onset, planned_onset},
    direction::direction_delay,
    drift::rest_drift,
    lag::{Lag, Speeds, lag},
    lag_share::{Block, blocks, lag_share},
    motion::Motion,
    onset::Onset,
    signals::Signals,
    tracking::{at_standstill, samples, tracking_error},
    transition::transition,
};
use crate::{math::range, series::Pair};

/// What is found in one pair, before joints are compared.
pub(super) struct Joint<'a> {
    pub(super) pair: &'a Pair,
    pub(super) replay: JointReplay,
    pub(super) transitions: Vec<Transition>,
    pub(super) stops: Vec<Stop>,
    /// Its planned motions with their error, and what a lag leaves of it.
    pub(super) blocks: Vec<Block>,
    /// For each sample, whether the plan moves.
    pub(super) moving: Vec<bool>,
}

/// Analyses one joint; `None` for a pair without samples, which no constructor makes.
pub(super) fn joint<'a>(pair: &'a Pair, rules: &Rules) -> Option<Joint<'a>> {
    let tracking = tracking_error(samples(pair))?;
    let signals = Signals::new(pair, rules);
    let rest = at_standstill(pair, &signals, rules);
    let standing = samples(pair).zip(&rest).filter(|(_, rest)| **rest).map(|(sample, _)| sample);
    let mut moving = vec![false; pair.t_s.len()];
    signals.planned.iter().for_each(|motion| moving[motion.samples.clone()].fill(true));
    let speeds = Speeds {
        t_s: &pair.t_s,
        planned_rad_s: &signals.planned_rad_s,
        measured_rad_s: &signals.measured_rad_s,
    };
    let lag = lag(&speeds, &signals.planned, signals.sample_interval_s, rules);

    let planned: Vec<&Motion> = signals.planned.iter().filter(|m| m.starts()).collect();
    let asked: Vec<Onset> = planned.iter().map(|m| planned_onset(pair, &signals, m, rules)).collect();
    let starts_s: Vec<f64> = asked.iter().map(|onset| onset.at_s).collect();
    let closes_s = |k: usize| pair.t_s[planned[k].segment.end - 1];
    let until_s = |k: usize| starts_s.get(k + 1).map_or(closes_s(k), |next_s| closes_s(k).min(*next_s));
    let untils_s: Vec<f64> = (0..planned.len()).map(until_s).collect();
    let measured: Vec<(&Motion, Onset)> = signals
        .measured
        .iter()
        .filter(|m| m.starts())
        .map(|m| (m, measured_onset(pair, &signals, m, rules)))
        .collect();
    let answers = answers((pair, &signals), &planned, &untils_s, &measured, rules);
    let mut transitions: Vec<Transition> = (0..planned.len())
        .map(|k| {
            let answer = answers[k].and_then(|answer: usize| measured.get(answer).copied());
            transition(pair, &signals, (planned[k], asked[k], untils_s[k]), answer, rules)
        })
        .collect();
    // Motions that follow at once may be dated within each other.
    transitions.sort_by(|a, b| a.planned_onset_s.total_cmp(&b.planned_onset_s));
    (1..).zip(&mut transitions).for_each(|(index, found)| found.index = index);
    let from_rest = transitions.iter().filter(|t| t.kind == Kind::Start);
    let delays = from_rest.filter_map(|t| Some((t.direction, t.onset_delay_s?)));
    let stops = stops(pair, &signals, rules);
    let matched = answers.iter().flatten().count();
    let moves = matched > 0
        || signals.measured.iter().any(|m| travel_rad(&pair.measured, m) >= signals.sizes.moves_travel);
    // What does not move has no lag, however well its noise fits.
    let lag = if moves { lag } else { Lag::default() };
    let travels = |segment: &std::ops::Range<usize>| {
        let [lowest, highest] = range(pair.planned[segment.clone()].iter().copied());
        highest - lowest >= signals.sizes.moves_travel
    };
    let blocks = blocks(pair, &signals.planned_rad_s, &signals.planned, lag.shift_s);
    let count = |answer: Answer| transitions.iter().filter(|t| t.answer == answer).count();
    let replay = JointReplay {
        name: pair.name.clone(),
        kind: pair.kind,
        moves,
        plan_moves: !signals.planned.is_empty() || pair.segments.iter().any(travels),
        tracking_error: tracking,
        standstill_error: tracking_error(standing),
        rest_drift: rest_drift(pair, &rest),
        direction_delay: direction_delay(delays, signals.sample_interval_s),
        path_error: None,
        lag_s: lag.shift_s,
        lag_correlation: lag.correlation,
        lag_interval_s: lag.interval_s,
        lag_motions: lag.motions,
        lag_share: lag.shift_s.and_then(|_| lag_share(&blocks, rules)),
        peak_speed: signals.peaks[0],
        peak_acceleration: signals.peaks[1],
        noise: signals.noise,
        sample_interval_s: signals.sample_interval_s,
        thresholds: signals.thresholds,
        starts: planned.len(),
        reversals: planned.iter().filter(|m| m.reversal).count(),
        stops: stops.iter().filter(|s| s.planned_s.is_some()).count(),
        unanswered_starts: count(Answer::Never),
        undated_starts: count(Answer::Unclear) + count(Answer::Creeps),
        unplanned_starts: measured.len() - matched - at_edges(&signals.planned, &measured, &answers, rules),
        edge_starts: signals.edge_starts,
    };
    Some(Joint { pair, replay, transitions, stops, blocks, moving })
}

/// How many measured starts, of those that answer none, follow a planned one that was not seen.
fn at_edges(
    planned: &[Motion],
    measured: &[(&Motion, Onset)],
    answers: &[Option<usize>],
    rules: &Rules,
) -> usize {
    let follows = |seen: &Motion| {
        planned.iter().any(|plan| {
            let until_s = (plan.start_s + rules.transition_window_s).min(plan.end_s) + rules.match_after_s;
            let same = plan.opens && plan.segment == seen.segment && plan.direction == seen.direction;
            same && (plan.start_s - rules.match_before_s..=until_s).contains(&seen.start_s)
        })
    };
    let free = |k: &usize| !answers.contains(&Some(*k));
    (0..measured.len()).filter(free).filter(|k| follows(measured[*k].0)).count()
}

/// Travel of a motion, rad.
fn travel_rad(angle_rad: &[f64], motion: &Motion) -> f64 {
    (angle_rad[motion.samples.end - 1] - angle_rad[motion.samples.start]).abs()
}

/// For each planned start the measured one that answers it.
///
/// A measured start answers the latest planned start of its direction that could have caused
/// it; of several, the first answers. A joint that moves before it is asked to is shaken by the
/// others, unless it goes on to cover a good part of the planned travel.
fn answers(
    (pair, signals): (&Pair, &Signals),
    planned: &[&Motion],
    untils_s: &[f64],
    measured: &[(&Motion, Onset)],
    rules: &Rules,
) -> Vec<Option<usize>> {
    let mut answers = vec![None; planned.len()];
    for (k, (motion, onset)) in measured.iter().enumerate() {
        let begun = planned.partition_point(|p| p.start_s - rules.match_before_s <= onset.at_s);
        let cause = (0..begun).rev().take(4).find(|&p| {
            let window_end_s = untils_s[p].min(planned[p].start_s + rules.transition_window_s);
            planned[p].direction == motion.direction
                && planned[p].segment == motion.segment
                && onset.at_s <= window_end_s + rules.match_after_s
                && answers[p].is_none()
                && !followed_before((pair, signals), planned[p], untils_s[p], onset.at_s, rules)
                && (onset.interval_s[1] >= planned[p].start_s
                    || travel_rad(&pair.measured, motion)
                        >= rules.early_travel_share * travel_rad(&pair.planned, planned[p]))
        });
        if let Some(cause) = cause {
            answers[cause] = Some(k);
        }
    }
    answers
}

/// A joint that covered a good part of the planned travel since it was asked to may sag by this share of that before it goes on.
const SAGS: f64 = 0.5;

/// Whether a joint covered a good part of the planned travel before an instant, and stands there: what starts then is no
/// answer to the plan, which it followed without a start that was seen.
fn followed_before(
    (pair, signals): (&Pair, &Signals),
    planned: &Motion,
    until_s: f64,
    at_s: f64,
    rules: &Rules,
) -> bool {
    let times = &pair.t_s[planned.segment.clone()];
    let at = |t_s: f64| planned.segment.start + times.partition_point(|&t| t < t_s);
    let begins = planned.samples.start;
    let ends = at(until_s.min(planned.start_s + rules.transition_window_s)).max(begins + 1);
    let needed =
        rules.follow_share * rise(&pair.planned[begins..ends.min(planned.segment.end)], planned.direction);
    let from = at(planned.start_s - rules.match_before_s);
    let until = at(at_s).clamp(from, planned.segment.end);
    let along = |angle: f64| f64::from(planned.direction) * angle;
    let last = if from < until { signals.measured_rad.get(until - 1) } else { None };
    let reached = last.map_or(0.0, |last| along(*last) - along(pair.planned[begins]));
    let needed = needed.max(signals.min_travel);
    let rises = |from: usize| rise(&signals.measured_rad[from..until], planned.direction) >= needed;
    reached >= needed && rises(from)
        || reached >= (1.0 - SAGS) * needed && rises(at(planned.start_s).min(until))
}

/// Dynamic-to-static events; a measured stop belongs to the latest planned one that it could
/// follow, whatever its direction: a joint that overshoots comes to rest on its way back.
fn stops(pair: &Pair, signals: &Signals, rules: &Rules) -> Vec<Stop> {
    let planned: Vec<&Motion> = signals.planned.iter().filter(|m| m.stops()).collect();
    let mut stops: Vec<Stop> = planned
        .iter()
        .map(|motion| Stop {
            joint: pair.name.clone(),
            direction: motion.direction,
            planned_s: Some(motion.end_s),
            measured_s: None,
            error: motion.samples.clone().last().map(|i| pair.planned[i] - pair.measured[i]),
        })
        .collect();
    let mut unplanned = Vec::new();
    for motion in signals.measured.iter().filter(|m| m.stops()) {
        let ended = planned.partition_point(|p| p.end_s - rules.match_before_s <= motion.end_s);
        let cause = (0..ended).rev().take(2).find(|&p| {
            planned[p].segment == motion.segment
                && motion.end_s <= planned[p].end_s + rules.transition_window_s
                && stops[p].measured_s.is_none()
        });
        match cause {
            Some(cause) => stops[cause].measured_s = Some(motion.end_s),
            None => unplanned.push(Stop {
                joint: pair.name.clone(),
                direction: motion.direction,
                planned_s: None,
                measured_s: Some(motion.end_s),
                error: None,
            }),
        }
    }
    stops.append(&mut unplanned);
    let time_s = |stop: &Stop| stop.planned_s.or(stop.measured_s).unwrap_or(0.0);
    stops.sort_by(|a, b| time_s(a).total_cmp(&time_s(b)));
    stops
}

#[cfg(test)]
mod tests {
    use crate::{
        replay::{Answer, Rules, Transition, replay},
        series::{Track, align},
    };

    fn ease(t: f64) -> f64 {
        let x = t.clamp(0.0, 1.0);
        x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)
    }

    fn transitions(plan: impl Fn(f64) -> f64, course: impl FnMut(f64) -> f64) -> Vec<Transition> {
        let pair = align(&Track::sampled("z", 1500, plan), &Track::sampled("z", 1500, course));
        replay(&[pair.unwrap()], &Rules::default()).transitions
    }

    #[test]
    fn a_joint_that_sags_on_its_way_left_before_it_goes_on() {
        let course =
            |t: f64| 0.38 * ease((t - 4.4) / 2.4) - 0.14 * ease(2.0 * t - 14.0) + 0.76 * ease(0.5 * t - 4.0);
        let found = transitions(|t| ease((t - 5.0) / 3.0), course);
        assert!(matches!(&found[..], [one] if one.answer == Answer::Creeps), "{found:?}");
    }

    #[test]
    fn a_joint_that_swings_back_has_not_left_before_its_plan() {
        for again_s in [3.0, 3.1, 3.2, 3.3, 3.4] {
            let plan = |t: f64| 0.3 * ease(2.0 * (t - 2.0)) - 0.3 * ease(t - again_s);
            let (mut q, mut speed) = (0.0, 0.0);
            let swings = |t: f64| {
                for _ in 0..10 {
                    speed += 1e-3 * (25.0 * (plan(t - 0.13) - q) - 1.5 * speed);
                    q += 1e-3 * speed;
                }
                q
            };
            let found = transitions(plan, swings);
            let early =
                |one: &&Transition| one.onset_delay_interval_s.is_some_and(|[_, latest_s]| latest_s < -0.15);
            assert_eq!(found.iter().find(early), None, "{again_s}");
        }
    }
}
