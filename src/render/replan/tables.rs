//! A plan for the next run as tables.

use super::{checks, learning};
use crate::{
    log::Topics,
    math::mean,
    render::{
        fit::litres,
        kit::{
            Block, Column, Document, Fact, Id, NONE, Section, Sentence, Table, counted, fact, optional,
            some_of,
        },
        metric::{Units, number, position, unit},
    },
    replay::Dimension,
    series::{JointKind, Track},
    task::Objective,
    workflow::replan::{
        Checks, Commanded, HeldTo, MeasuredPeaks, Origin, Predicted, PredictedTransition, Replanned,
    },
};

/// Predicted transitions of joints of a kind.
type PeaksOf<'a> = &'a mut dyn Iterator<Item = &'a PredictedTransition>;

pub(super) const EXPECTED: Id = Id("expected");

pub(crate) fn document(replanned: &Replanned) -> Document {
    let title = replanned.request.as_ref().map_or("the logged plan", |request| request.task.title.as_str());
    let learnt = format!("The machine was fitted to {}.", replanned.fitted_to.join(", "));
    let stays =
        "The log holds no task, so the plan stays and only the command changes; --task FILE names one.";
    let stays = replanned.request.is_none().then(|| Sentence::finding(stays.to_owned()));
    let verdict = learning::kept(replanned).map(Sentence::Advice);
    let margin = format!(
        "Expected peaks include the error that the model left unexplained after held-out starts, and 2 % of what the command \
         changes; with two runs or more, what differed from run to run. 90 % of single starts stay below the predicted peak times {:.2}, \
         or above it by no more than nine of ten of those errors.",
        replanned.fit.peak_margin
    );
    let mut document = Document::titled(format!("Next run of {title}"))
        .with(Section::plain(
            Id::SUMMARY,
            verdict.into_iter().chain([Sentence::finding(learnt)]).chain(stays),
        ))
        .with(checks::section(&Checks::of(replanned), learning::units(replanned)))
        .with(Section::new(EXPECTED, "Expected", [expected(replanned)]).with(Sentence::note(margin)))
        .with(Section::new(Id::OTHER, "What changes", [Block::Facts(levers(replanned))]));
    document.sections.extend(learning::runs(replanned));
    document.sections.extend(learning::command(replanned));
    if let Some(search) = &replanned.search {
        let units = Units::of(search.held.iter().map(|held| held.kind));
        let number = |(name, dimension)| Column::numbers(units.heading(name, dimension));
        let [speed, acceleration] =
            [("speed", Dimension::Speed), ("acceleration", Dimension::Acceleration)].map(number);
        let columns =
            [Column::words("joint"), speed, Column::numbers("from"), acceleration, Column::numbers("from")];
        let held = Table::of(columns, search.held.iter().map(|held| held_row(held, units)));
        let of = if replanned.retimed {
            "Limits of the new plan"
        } else {
            "Limits that a new plan was sought under"
        };
        let pump = search.pump_flow_m3_s.map(|flow| {
            Sentence::note(format!(
                "Pump flow: {}, which it gave in three quarters of the time in which its pressure was low.",
                litres(flow)
            ))
        });
        let section = Section::new(Id::OTHER, of, [held]);
        document.sections.push(pump.into_iter().fold(section, Section::with));
    }
    document.remarked(&replanned.remarks)
}

fn percent(now: f64, then: f64) -> String {
    if now > 0.0 { format!("{:+.0} %", 100.0 * (then / now - 1.0)) } else { NONE.to_owned() }
}

fn expected(replanned: &Replanned) -> Table {
    let (before, after) = (&replanned.before, &replanned.after);
    let now = &before.predicted;
    let kind_of = |joint: &str| replanned.plan.track(joint).map_or(JointKind::Turns, Track::kind);
    let has_any = |of: &&MeasuredPeaks| {
        of.mean_rad.is_some() || after.transitions.iter().any(|t| kind_of(&t.joint) == of.kind)
    };
    // Of each kind on its own: a mean over both has no unit.
    let errors = before.measured_peaks.iter().filter(has_any).flat_map(|of| {
        let shown = |rad: f64| number(Dimension::Position, of.kind, rad);
        let error = |name: &str, measured: Option<f64>, peak: fn(PeaksOf<'_>) -> f64| {
            let [now, after] = [now, after].map(|predicted| {
                peak(&mut predicted.transitions.iter().filter(|t| kind_of(&t.joint) == of.kind))
            });
            let change = percent(measured.unwrap_or(now), after);
            let name = format!("{name} {}", unit(Dimension::Position, of.kind));
            vec![name, optional(measured, shown), shown(now), shown(after), change]
        };
        [
            error("mean transition peak", of.mean_rad, |all| {
                mean(&all.map(|t| t.expected_peak_rad).collect::<Vec<f64>>())
            }),
            error("  mean below in 9 of 10 runs", None, |all| {
                mean(&all.map(|t| t.peak_margin_rad).collect::<Vec<f64>>())
            }),
            error("worst transition peak", of.worst_rad, |all| {
                all.map(|t| t.expected_peak_rad).fold(0.0, f64::max)
            }),
        ]
    });
    let count = |p: &Predicted| p.transitions.len();
    let others = [
        vec![
            "starts + reversals".into(),
            before.measured_transitions.to_string(),
            format!("{} + {}", now.starts, now.reversals),
            format!("{} + {}", after.starts, after.reversals),
            percent(count(now) as f64, count(after) as f64),
        ],
        vec![
            "time of motion s".into(),
            format!("{:.2}", before.duration_s),
            NONE.into(),
            format!("{:.2}", replanned.duration_s),
            percent(before.duration_s, replanned.duration_s),
        ],
    ];
    let mut rows: Vec<Vec<String>> = errors.chain(others).collect();
    if let (Some(was), Some(evaluation)) = (&replanned.objectives_before, &replanned.evaluation) {
        let is = evaluation.objectives;
        rows.extend(Objective::OF_PLAN.iter().filter(|k| **k != Objective::Duration).map(|&k| {
            let change = percent(was[k], is[k]);
            vec![k.row().heading.to_owned(), k.number(was[k]), NONE.into(), k.number(is[k]), change]
        }));
    }
    Table::new(&[""], &["last run", "model of it", "next run", "change"], rows)
}

pub(super) fn levers(replanned: &Replanned) -> Vec<Fact> {
    let plan = match (&replanned.search, replanned.retimed, &replanned.evaluation) {
        (None, ..) => "unchanged".to_owned(),
        (Some(search), false, _) if search.front.is_empty() && search.plans.is_empty() => {
            "unchanged: no timing was found within the allowed time, jerk and power".to_owned()
        }
        (Some(search), false, _) => format!(
            "unchanged: none of {} within the allowed time, jerk and power has a smaller expected error",
            match search.front.len() {
                0 => counted(search.plans.len(), "free shape"),
                timings => counted(timings, "timing"),
            }
        ),
        (Some(search), true, evaluation) => {
            let times = evaluation.as_ref().map_or_else(String::new, |evaluation| {
                evaluation.times_s.iter().map(|t| format!("{t:.2}")).collect::<Vec<_>>().join(" ")
            });
            let free = evaluation.as_ref().is_some_and(|evaluation| !evaluation.via.is_empty());
            let how = match (free, search.front.len()) {
                (true, 0) => "in a free shape".to_owned(),
                (true, count) => format!("re-timed in a free shape, one of {count} timings"),
                (false, count) => format!("re-timed, one of {count} timings"),
            };
            format!("{how} from {} evaluations: {times} s", search.evaluations)
        }
    };
    let command = replanned.command.as_ref().filter(|command| command.applied());
    let command = command.map_or("is the plan".to_owned(), |command| {
        let joints = &command.joints;
        let applied = joints.iter().filter(|joint| joint.applied());
        let most = |kind: JointKind| {
            let own = joints.iter().filter(|joint| joint.kind == kind).map(|joint| joint.peak_correction_rad);
            own.reduce(f64::max).map(|most| position(kind, most))
        };
        let most: Vec<String> = [JointKind::Turns, JointKind::Slides].into_iter().filter_map(most).collect();
        format!(
            "corrected on {}, by {} at most",
            some_of(applied.count(), joints.len(), "joint"),
            most.join(" and ")
        )
    });
    let ours = Topics::default();
    let trajectory = replanned.trajectory.as_deref().unwrap_or(&ours.trajectory);
    let samples = if replanned.command.as_ref().is_some_and(Commanded::applied) {
        &ours.command
    } else {
        &ours.planned
    };
    let send = format!("{samples}, or {trajectory} as a trajectory; compare the run with {}", ours.planned);
    let clock = replanned.moves_after_s().map_or(String::new(), |after_s| {
        format!("; it counts from 0, and its plan first moves at {after_s:.2} s")
    });
    vec![fact("plan", plan), fact("command", command), fact("send", send + &clock)]
}

fn held_row(held: &HeldTo, units: Units) -> Vec<String> {
    let by = |origin: Origin| match origin {
        Origin::Task => "the task",
        Origin::Fitted => "the fit",
        Origin::Shown => "values reached",
        Origin::Asked => "asked for last",
    };
    let number = |dimension: Dimension, value: f64| {
        if value.is_finite() { units.cell(dimension, held.kind, value) } else { NONE.into() }
    };
    let ways = held.speeds_rad_s.map(|ways| ways.map(|speed| number(Dimension::Speed, speed)).join(" to "));
    vec![
        held.joint.clone(),
        ways.unwrap_or_else(|| number(Dimension::Speed, held.speed_rad_s)),
        by(held.speed_origin).into(),
        number(Dimension::Acceleration, held.acceleration_rad_s2),
        by(held.acceleration_origin).into(),
    ]
}
