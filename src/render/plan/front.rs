//! What a search found: the front with A, B, C and the chosen plan, and how it grew.

use maud::{Markup, html};

use crate::{
    render::kit::{
        counted,
        page::{
            Plots,
            chart::{Chart, Panel, Role, Series, Size, span},
        },
    },
    task::{Objective, Objectives},
    workflow::plan::PlanDocument,
};

/// Plans of a document beyond this are not shown.
const MOST: usize = 5000;

pub(in crate::render) fn front(front: &PlanDocument, plots: &mut Plots) -> Markup {
    html! {
        p class="hint" {
            (counted(front.front.len().min(MOST), "plan")) " on the Pareto front. "
            @for objective in Objective::OF_PLAN { (objective.letter()) ": " (objective.row().best) ". " }
            "Less is better on every axis."
            @if front.convergence.len() > 1 {
                " During the search plans are evaluated on fewer points than at the end."
            }
        }
        div class="side" { @for (_, chart) in front_charts(front) { (plots.place(chart)) } }
    }
}

/// Plots with names for their files.
pub(super) fn front_charts(front: &PlanDocument) -> Vec<(String, Chart)> {
    let mut charts = Vec::new();
    if !front.front.is_empty() {
        let all = Objective::OF_PLAN;
        for (k, across) in all.iter().enumerate() {
            for up in &all[k + 1..] {
                let name = format!("front-{}-{}", across.row().short, up.row().short).replace(' ', "-");
                charts.push((name, projection(front, *across, *up)));
            }
        }
    }
    if front.convergence.len() > 1 {
        charts.push(("convergence".to_owned(), convergence(front)));
    }
    charts
}

fn projection(front: &PlanDocument, across: Objective, up: Objective) -> Chart {
    let best = front.best().map(|(letter, objectives)| (letter.to_string(), objectives));
    let named: Vec<(String, &Objectives)> =
        best.chain([("chosen".to_owned(), &front.chosen.entry.objectives)]).collect();
    let (upper, lower) = (up.row().short, across.row().short);
    let mut title = format!("{upper} over {lower}");
    title[..1].make_ascii_uppercase();
    let of = |plans: &mut dyn Iterator<Item = &Objectives>, k: Objective| {
        plans.map(|f| (k.shown(f[k]) * 1e5).round() / 1e5).collect::<Vec<f64>>()
    };
    let all = || front.front.iter().take(MOST).map(|plan| &plan.objectives);
    let few = || named.iter().map(|(_, f)| *f);
    let xs = vec![of(&mut all(), across), of(&mut few(), across)];
    let [low, high] = span(xs.iter().flatten().copied());
    let room = 0.05 * (high - low);
    let best = Series::of("best and chosen", Role::Named, 1, of(&mut few(), up));
    let best = best.named(named.iter().map(|(name, _)| name.clone()).collect());
    let series = vec![Series::of("plan", Role::Point, 0, of(&mut all(), up)), best];
    Chart {
        title,
        x_label: across.row().axis.into(),
        xs,
        x_range: Some([low - room, high + 2.0 * room]),
        panels: vec![Panel::of(up.row().axis, 1.0, series)],
        height: 300,
        size: Size::Half,
        ..Chart::default()
    }
}

fn convergence(front: &PlanDocument) -> Chart {
    let steps = &front.convergence;
    let y = steps.iter().map(|step| (step.hypervolume * 1e5).round() / 1e5).collect();
    let series = vec![Series::of("share of the final front's box", Role::Measured, 0, y)];
    Chart {
        title: "How the front grew".to_owned(),
        x_label: "Evaluations".into(),
        xs: vec![steps.iter().map(|step| step.evaluations as f64).collect()],
        panels: vec![Panel::of("Hypervolume", 1.0, series)],
        height: 300,
        size: Size::Half,
        ..Chart::default()
    }
}
