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
    units::degrees_from_radians,
    workflow::plan::front::Front,
};

/// Labels of f1, f2 and f3.
const LABELS: [&str; 3] = ["Time (s)", "RMS jerk (deg/s\u{b3})", "RMS power (W)"];
/// Objectives over each other.
const VIEWS: [(&str, usize, usize); 3] =
    [("Jerk over time", 0, 1), ("Power over time", 0, 2), ("Power over jerk", 1, 2)];

pub(in crate::render) fn front(front: &Front, plots: &mut Plots) -> Markup {
    html! {
        p class="hint" {
            (counted(front.plans.len(), "plan")) " of which none is better than another in everything. A is the fastest, B \
            the smoothest, C takes the least power. Less is better on every axis."
            @if front.convergence.len() > 1 {
                " On the way plans are judged less exactly than those of the last hypervolume."
            }
        }
        div class="side" { @for (_, chart) in front_charts(front) { (plots.place(chart)) } }
    }
}

/// Plots with names for their files.
pub(super) fn front_charts(front: &Front) -> Vec<(&'static str, Chart)> {
    let mut charts: Vec<(&'static str, Chart)> = Vec::new();
    if !front.plans.is_empty() {
        let names = ["front-time-jerk", "front-time-power", "front-jerk-power"];
        charts.extend(names.into_iter().zip(VIEWS.map(|view| projection(front, view))));
    }
    if front.convergence.len() > 1 {
        charts.push(("convergence", convergence(front)));
    }
    charts
}

fn projection(front: &Front, (title, across, up): (&str, usize, usize)) -> Chart {
    let named: Vec<(&str, [f64; 3])> = front
        .best
        .iter()
        .flat_map(|best| ["A", "B", "C"].into_iter().zip(*best))
        .chain([("chosen", front.chosen)])
        .collect();
    let series = |name: &str, role, x, y, names| Series { name: name.to_owned(), role, x, y, names };
    let of = |plans: &mut dyn Iterator<Item = [f64; 3]>, k: usize| {
        plans.map(|f| shown(f, k)).collect::<Vec<f64>>()
    };
    let all = || front.plans.iter().copied();
    let few = || named.iter().map(|(_, f)| *f);
    let xs = vec![of(&mut all(), across), of(&mut few(), across)];
    let [low, high] = span(xs.iter().flatten().copied());
    let room = 0.05 * (high - low);
    Chart {
        title: title.to_owned(),
        x_label: LABELS[across].into(),
        xs,
        x_range: Some([low - room, high + 2.0 * room]),
        panels: vec![Panel {
            label: LABELS[up].to_owned(),
            series: vec![
                series("plan", Role::Point, 0, of(&mut all(), up), Vec::new()),
                series(
                    "A, B, C and chosen",
                    Role::Named,
                    1,
                    of(&mut few(), up),
                    named.iter().map(|(name, _)| (*name).to_owned()).collect(),
                ),
            ],
            share: 1.0,
            range: None,
        }],
        height: 300,
        size: Size::Half,
        ..Chart::default()
    }
}

/// An objective as its label says.
fn shown(f: [f64; 3], k: usize) -> f64 {
    let value = if k == 1 { degrees_from_radians(f[k]) } else { f[k] };
    (value * 1e5).round() / 1e5
}

fn convergence(front: &Front) -> Chart {
    let steps = &front.convergence;
    Chart {
        title: "How the front grew".to_owned(),
        x_label: "Evaluations".into(),
        xs: vec![steps.iter().map(|step| step.evaluations as f64).collect()],
        panels: vec![Panel {
            label: "Hypervolume".to_owned(),
            series: vec![Series {
                name: "share of the final front's box".to_owned(),
                role: Role::Measured,
                x: 0,
                y: steps.iter().map(|step| (step.hypervolume * 1e5).round() / 1e5).collect(),
                names: Vec::new(),
            }],
            share: 1.0,
            range: None,
        }],
        height: 300,
        size: Size::Half,
        ..Chart::default()
    }
}
