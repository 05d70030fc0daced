//! What a fit says of the machine: its numbers with their intervals, and how well it foretells what it was not fitted to.

use maud::{Markup, html};

use super::tables::{document, left_out_line, machine, margin};
use crate::{
    fit::{Fit, HeldOut, JointFit, LEAST_SHARP_SKILL, LEAST_SMOOTH_SKILL},
    render::{
        kit::{
            self, Id, Section, clean,
            page::{
                Chapter, Plots, blocks, card,
                chart::{Chart, Panel, Role, Series, Size, at, rounded, span, times},
                envelope::envelope,
                headed,
            },
        },
        metric::{on_paper, unit},
    },
    replay::Dimension,
    series::JointKind::{self, Slides, Turns},
    workflow::fit::Fitted,
};

/// Places of a series at most, nearly.
const MOST: usize = 3000;

pub(in crate::render) fn fitted(fit: &Fit) -> Markup {
    html! {
        p class="hint" { "The closed loop of each joint as identified from logs, with 95 % intervals." }
        @for section in machine(fit) { (headed(&section)) }
        p { (margin(fit)) }
        @if let Some(line) = left_out_line(fit) { p { (clean(&line)) } }
    }
}

/// One page for the person who has to trust the fit; `next` holds the commands that come next.
pub(crate) fn page(fitted: &Fitted, next: Option<&Section>) -> String {
    let document = document(fitted);
    let mut plots = Plots::default();
    let numbers = document.sections.iter().filter(|section| section.id == Id::OTHER);
    let mut chapters = vec![
        Chapter { id: "summary", heading: "Is the model good enough?", body: summary(fitted, next) },
        Chapter { id: "joints", heading: "Measured beside predicted", body: drawn(fitted, &mut plots) },
        Chapter::new(Id::OTHER.0, "The machine", html! { @for section in numbers { (headed(section)) } }),
    ];
    chapters.extend(Chapter::of(document.section(Id::REMARKS), "Remarks on the data"));
    kit::page::page("fit", &document, &chapters, &plots)
}

fn summary(fitted: &Fitted, next: Option<&Section>) -> Markup {
    let joints = &fitted.fit.joints;
    let good = joints.iter().filter(|joint| joint.trusted()).count();
    let doubtful = joints.iter().filter(|joint| joint.trusted() && !joint.model_holds).count();
    let (class, headline) = match (good, joints.len()) {
        (good, all) if good == all && doubtful > 0 => {
            ("care", format!("For every joint, {doubtful} of {all} with care"))
        }
        (good, all) if good == all => ("good", "For every joint".to_owned()),
        (0, _) => ("bad", "For no joint".to_owned()),
        (good, all) => ("care", format!("For {good} of {all} joints")),
    };
    let rest = joints.iter().filter(|joint| !joint.trusted() || !joint.model_holds);
    let why = html! {
        p { "Enough to make a command from: a held-out R2 of " (crate::fit::LEAST_SKILL) " or more." }
        @for joint in rest { p { (clean(&doubt(joint))) } }
    };
    let [known, all] = fitted.known();
    let told = html! {
        p { "Of lag, dead band, gain and feed-forward of each joint. What the logs do not tell stands in brackets: enough to predict such \
             runs, not to plan others." }
        @if known < all { p { "Sharp starts, stops and several speeds tell more: " code { "hydrotrace excite" } " makes such a run." } }
    };
    let worst = joints.iter().min_by(|a, b| a.held_out_r2.total_cmp(&b.held_out_r2));
    let starts = html! {
        p { (margin(&fitted.fit)) }
    };
    html! {
        div class="cards" {
            (card(class, "Good enough", &headline, &why))
            (card(if known < all { "care" } else { "good" }, "Numbers that the logs tell", &format!("{known} of {all}"), &told))
            @if let Some(worst) = worst {
                (card("", "Joint that is predicted least", &clean(&format!("{}: {:.1} %", worst.name, 100.0 * worst.held_out_r2.max(0.0))),
                    &html! { p { "Share of the squared error that is predicted where the model was not fitted to it, R2." } }))
            }
            (card("", "Peaks after a start", &format!("{:.2} x predicted", fitted.fit.peak_margin), &starts))
        }
        @if let Some(next) = next { (blocks(&next.blocks)) }
    }
}

fn doubt(joint: &JointFit) -> String {
    let JointFit { name, held_out_r2, .. } = joint;
    if joint.trusted() {
        format!(
            "The model does not hold for {name} (R2 {held_out_r2:.2}): what it leaves unexplained rings or is large, or the R2 \
             is below {LEAST_SMOOTH_SKILL}, or below {LEAST_SHARP_SKILL} where starts are sharp. Its numbers have no intervals."
        )
    } else {
        format!(
            "{name} is predicted with an R2 of {held_out_r2:.2} only: no command is made of its model alone."
        )
    }
}

/// The peaks of starts against each other, and each joint's error over time.
fn drawn(fitted: &Fitted, plots: &mut Plots) -> Markup {
    let courses = fitted.fit.joints.iter().filter_map(|joint| course(fitted, joint));
    html! {
        p class="hint" {
            "Each part of the data is predicted by a fit to the rest. Error: sent minus measured, and sent minus predicted. Drag to zoom, \
             double-click for all."
        }
        div class="side" {
            @for kind in [Turns, Slides] { @if let Some(chart) = peaks(fitted, kind) { (plots.place(chart)) } }
            @for chart in courses { (plots.place(chart)) }
        }
    }
}

/// Measured over predicted peaks of starts of joints of a kind.
fn peaks(fitted: &Fitted, kind: JointKind) -> Option<Chart> {
    let shown = |rad: f64| rounded(on_paper(kind, rad));
    let own = |stretch: &&HeldOut| fitted.fit.joint(&stretch.joint).is_some_and(|joint| joint.kind == kind);
    let starts: Vec<(String, [f64; 2])> = fitted
        .held_out
        .iter()
        .filter(own)
        .flat_map(|stretch| {
            stretch.peaks_rad.iter().map(|peaks| (stretch.joint.clone(), [peaks[1], peaks[0]].map(shown)))
        })
        .collect();
    let [_, most] = span(starts.iter().flat_map(|(_, both)| *both).chain([0.0]));
    let ends = [0.0, rounded(1.05 * most)];
    let labels =
        ["Predicted", "Measured"].map(|side| format!("{side} ({})", unit(Dimension::Position, kind)));
    (!starts.is_empty()).then(|| Chart {
        title: "Peak error after each start".to_owned(),
        note: "on the line: as predicted".to_owned(),
        height: 260,
        ..Chart::against(labels, ["as predicted", "start"], ends, starts)
    })
}

/// The error of a joint in the log of which most was held out.
fn course(fitted: &Fitted, joint: &JointFit) -> Option<Chart> {
    let own = |log: usize| {
        fitted.held_out.iter().filter(move |stretch| stretch.joint == joint.name && stretch.log == log)
    };
    let samples = |log: usize| own(log).map(|stretch| stretch.t_s.len()).sum::<usize>();
    let log = (0..fitted.runs.len()).rev().max_by_key(|log| samples(*log)).filter(|log| samples(*log) > 0)?;
    let (mut t_s, mut measured, mut predicted, mut segments) = (vec![], vec![], vec![], vec![]);
    for stretch in own(log) {
        segments.push(t_s.len()..t_s.len() + stretch.t_s.len());
        t_s.extend_from_slice(&stretch.t_s);
        measured.extend_from_slice(&stretch.measured_rad);
        predicted.extend_from_slice(&stretch.predicted_rad);
    }
    let places = envelope(&segments, &[&measured, &predicted], MOST);
    let series = |name: &str, role, values: &[f64]| {
        Series::of(name, role, 0, at(values, &places).map(|rad| rounded(on_paper(joint.kind, rad))).collect())
    };
    let both =
        vec![series("predicted", Role::Planned, &predicted), series("measured", Role::Measured, &measured)];
    let label = format!("Error ({})", unit(Dimension::Position, joint.kind));
    Some(Chart {
        title: format!("{} in {}", joint.name, fitted.runs[log].log),
        note: format!("R2 {:.2}", joint.held_out_r2),
        x_label: "Time (s)".into(),
        xs: vec![times(&t_s, &places)],
        panels: vec![Panel::of(label, 1.0, both)],
        group: Some("run"),
        height: 260,
        size: Size::Half,
        ..Chart::default()
    })
}
