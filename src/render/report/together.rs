//! All joints together, or those of each kind where an arm has both: where the error arises, and what of it is lag.

use crate::{
    math::range,
    render::{
        kit::{capital, counted, ms, probability, share as percents},
        metric::position,
    },
    replay::{Concentration, JointReplay, Replay, Verdict, WholeRun},
    series::JointKind,
};

/// What is shown as 0 ms is no lead, s.
const LEAST_LEAD_S: f64 = 0.0005;

/// Joints that have a unit in common.
pub(super) struct Together<'a> {
    replay: &'a Replay,
    pub(super) kind: JointKind,
    pub(super) run: &'a WholeRun,
}

impl<'a> Together<'a> {
    /// One, or one a kind.
    pub(super) fn all(replay: &'a Replay) -> Vec<Self> {
        replay.together().into_iter().map(|(kind, run)| Self { replay, kind, run }).collect()
    }

    /// What they are called beside others; nothing where they are all.
    pub(super) fn name(&self) -> &'static str {
        match (self.replay.of_kinds.is_empty(), self.kind) {
            (true, _) => "",
            (false, JointKind::Turns) => "joints that turn",
            (false, JointKind::Slides) => "joints that slide",
        }
    }

    fn joints(&self) -> impl Iterator<Item = &'a JointReplay> {
        let kind = self.kind;
        let alone = self.replay.of_kinds.is_empty();
        self.replay.joints.iter().filter(move |joint| alone || joint.kind == kind)
    }

    /// What a lag explains of a run whose error is mostly that.
    pub(super) fn mostly_lag(&self) -> Option<String> {
        self.run.lag_share.filter(|lag| lag.mostly)?;
        self.lag_words()
    }

    /// The least and the largest lag of joints whose plan moves, s.
    fn lags(&self) -> [f64; 2] {
        range(self.joints().filter(|joint| joint.plan_moves).filter_map(|joint| joint.lag_s))
    }

    /// What the lags are: a lead where every joint moves before its plan.
    pub(super) fn shift(&self) -> &'static str {
        if self.lags()[1] < -LEAST_LEAD_S { "lead" } else { "lag" }
    }

    /// How much of the squared error lags at the planned speeds explain; `None` where no joint has one.
    pub(super) fn lag_words(&self) -> Option<String> {
        let share = self.run.lag_share?;
        let [mut least, mut most] = self.lags();
        if most < -LEAST_LEAD_S {
            (least, most) = (-most, -least);
        }
        let (least, most) = (ms(least), ms(most));
        let lag =
            if least == most { format!("{least} ms") } else { format!("{least} to {most} ms, by joint,") };
        let shift = self.shift();
        Some(format!(
            "a {shift} of {lag} causes {} of the squared error ({}{}; an error is called mostly {shift} from {:.0} % on)",
            percents(share.share),
            share.interval.map_or(String::new(), |[a, b]| {
                format!("95 % interval {:.0}..{}, ", 100.0 * a, percents(b))
            }),
            counted(share.events, "event"),
            100.0 * self.replay.rules.mostly_lag_share,
        ))
    }

    /// Why nothing is told although the test shows a difference: its p is then no answer.
    pub(super) fn why_undecided(&self, found: &Concentration) -> Option<&'static str> {
        let test = found.test.filter(|test| test.p_value < self.replay.rules.significance)?;
        let inside = test.effect > 0.5 && found.rms_inside > found.rms_outside;
        (found.verdict == Verdict::Undecided).then_some(if inside {
            "while the plan moves the error is no smaller elsewhere: of a motion whose start lies in a gap, or within another start's window, the rest \
             counts there"
        } else {
            "a few large errors and most of the events say the opposite of each other"
        })
    }

    /// Where the error arises, what a lag explains of it, and how far from the planned path they are.
    pub(super) fn findings(&self) -> Vec<String> {
        let (kind, mostly) = (self.kind, self.mostly_lag());
        let mut lines = Vec::new();
        lines.extend(mostly.as_ref().map(|lag| format!("The error is mostly {}: {lag}.", self.shift())));
        if let Some(c) = &self.run.concentration {
            let place = match (&mostly, c.verdict) {
                (Some(_), Verdict::Transitions) => "Transitions hold it because the joints move there",
                (None, Verdict::Transitions) if c.squared_error_share_inside < 0.5 => {
                    "The error is larger in the transitions than elsewhere"
                }
                (None, Verdict::Transitions) => "Most of the error arises in the transitions",
                (_, Verdict::Elsewhere) if c.squared_error_share_inside > 0.5 => {
                    "The error is larger outside the transitions than in them"
                }
                (_, Verdict::Elsewhere) => "Most of the error arises outside the transitions",
                (_, Verdict::Undecided) => {
                    "Whether most of the error arises in the transitions cannot be told"
                }
            };
            let test = match (self.why_undecided(c), c.test) {
                (_, None) => "too few stretches to test".to_owned(),
                (Some(why), _) => why.to_owned(),
                (None, Some(t)) => format!(
                    "p = {}, {} transition events against {} other stretches",
                    probability(t.p_value),
                    t.inside_count,
                    t.outside_count
                ),
            };
            let moving = c
                .rms_outside_moving
                .map_or("at rest".to_owned(), |rms| format!("{} while the plan moves", position(kind, rms)));
            let some = self.joints().any(|joint| !joint.plan_moves && joint.moves);
            let of = if some { ", of joints that are to move" } else { "" };
            lines.push(format!(
                "{place}{of}: rms {} inside, {} elsewhere ({moving}); {:.0} % of the squared error in {:.0} % of the time ({test}).",
                position(kind, c.rms_inside),
                position(kind, c.rms_outside),
                100.0 * c.squared_error_share_inside,
                100.0 * c.time_share_inside,
            ));
            if mostly.is_none() {
                lines.push(match self.lag_words() {
                    Some(lag) => format!("Share of {}: {lag}.", self.shift()),
                    None if self.joints().all(|joint| joint.starts + joint.edge_starts == 0) => {
                        "Share of lag: cannot be told, because the plan of no joint is fast enough to start a motion.".to_owned()
                    }
                    None => format!(
                        "Share of lag: cannot be told, because no joint shows a lag of {:.0} ms or less.",
                        1e3 * self.replay.rules.lag_max_s
                    ),
                });
            }
        }
        if let Some(path) = &self.run.path_error {
            lines.push(format!(
                "Distance to the planned path, at any time within {:.0} s, as the norm over all joints: rms {}, peak {}; rms \
                 {} with time ({} instants).",
                self.replay.rules.path_window_s,
                position(kind, path.rms),
                position(kind, path.peak),
                position(kind, path.timed_rms),
                path.samples
            ));
        }
        match self.name() {
            "" => lines,
            name => lines
                .iter()
                .map(|line| format!("{}: {}{}", capital(name), line[..1].to_lowercase(), &line[1..]))
                .collect(),
        }
    }
}
