//! Paths in space that the script turns, coloured by a value; the first view is a picture, which is also printed.

use maud::{Markup, html};
use serde::Serialize;

use super::chart::span;
use crate::render::kit::{axis::steps, clean};

/// Two paths in space, one of them coloured and widened by a value; all arrays are as long, and not-a-number lifts the pen.
#[derive(Debug, Clone, Serialize)]
pub(in crate::render) struct Scene {
    /// For people, and for programs that read pages to them.
    pub(in crate::render) title: String,
    /// What the two paths are; that of the value goes before its numbers.
    pub(in crate::render) names: [&'static str; 2],
    pub(in crate::render) unit: &'static str,
    pub(in crate::render) value_unit: &'static str,
    /// The broad pale path under the other.
    pub(in crate::render) planned: Vec<[f64; 3]>,
    pub(in crate::render) measured: Vec<[f64; 3]>,
    pub(in crate::render) value: Vec<f64>,
    /// Horizontal angle of the eye, rad.
    pub(in crate::render) yaw: f64,
}

const STEPS: usize = 5;
/// The picture: its edge lengths, and its margin.
const SIZE: [f64; 2] = [900.0, 480.0];
const MARGIN: f64 = 34.0;
/// Height of the eye, rad.
const PITCH: f64 = 0.45;
/// Lines of the picture, by step; the sheet of styles has those of screens.
const COLOURS: [&str; STEPS] = ["#0062a6", "#5a55a8", "#96478f", "#b8495a", "#c44e00"];

impl Scene {
    /// What the script needs: the paths, the steps of each stretch, where to look from.
    fn data(&self) -> String {
        #[derive(Serialize)]
        struct Data<'a> {
            #[serde(flatten)]
            scene: &'a Scene,
            steps: Vec<usize>,
            most: f64,
            pitch: f64,
        }
        let steps = (0..self.value.len()).map(|i| self.step(i)).collect();
        let data = Data { scene: self, steps, most: self.most(), pitch: PITCH };
        serde_json::to_string(&data).unwrap_or_default()
    }

    fn values(&self) -> String {
        format!("{} 0 to {:.1} {}", self.names[1], self.most(), self.value_unit)
    }

    fn most(&self) -> f64 {
        self.value.iter().copied().filter(|value| value.is_finite()).fold(0.0, f64::max)
    }

    fn step(&self, i: usize) -> usize {
        let share = if self.most() > 0.0 { self.value[i] / self.most() } else { 0.0 };
        (1..STEPS).filter(|k| share * STEPS as f64 >= *k as f64).count()
    }

    /// Right and down of a place seen from the first view.
    fn seen(&self, [x, y, z]: [f64; 3]) -> [f64; 2] {
        let (yaw, pitch) = (self.yaw.sin_cos(), PITCH.sin_cos());
        let depth = x * yaw.1 + y * yaw.0;
        [y * yaw.1 - x * yaw.0, -(z * pitch.1 - depth * pitch.0)]
    }

    fn picture(&self) -> Markup {
        let all = || self.planned.iter().chain(&self.measured).map(|place| self.seen(*place));
        let ([left, right], [top, bottom]) = (span(all().map(|p| p[0])), span(all().map(|p| p[1])));
        let scale =
            ((SIZE[0] - 2.0 * MARGIN) / (right - left)).min((SIZE[1] - 2.0 * MARGIN) / (bottom - top));
        let middle = [0.5 * (left + right), 0.5 * (top + bottom)];
        let place = |at: [f64; 3]| {
            let seen = self.seen(at);
            [0, 1].map(|k| 0.5 * SIZE[k] + scale * (seen[k] - middle[k]))
        };
        let line = |points: &[[f64; 3]]| {
            let shown = points.iter().map(|at| place(*at)).map(|[x, y]| format!("{x:.1},{y:.1}"));
            shown.collect::<Vec<_>>().join(" ")
        };
        let whole = |points: &[[f64; 3]]| points.iter().flatten().all(|v| v.is_finite());
        let bar = steps(0.0, 0.3 * SIZE[0] / scale, 2).last().copied().unwrap_or(0.0);
        let base = SIZE[1] - 10.0;
        html! {
            svg viewBox=(format!("0 0 {} {}", SIZE[0], SIZE[1])) fill="none" stroke-linecap="round" stroke-linejoin="round"
                font-family="sans-serif" font-size="13" {
                @for piece in self.planned.split(|at| !whole(&[*at])) {
                    polyline points=(line(piece)) stroke="#b9bec5" stroke-width="7" {}
                }
                @for (step, points) in self.stretches() {
                    polyline points=(line(points)) stroke=(COLOURS[step]) stroke-width=(1.5 + 0.6 * step as f64) {}
                }
                line x1="12" y1=(base) x2=(12.0 + scale * bar) y2=(base) stroke="#333" stroke-width="2" {}
                text x="12" y=(base - 6.0) fill="#333" { (format!("{bar} {}", self.unit)) }
                @for (step, colour) in COLOURS.iter().enumerate() {
                    @let from = SIZE[0] - 200.0 + 24.0 * step as f64;
                    line x1=(from) y1=(base) x2=(from + 24.0) y2=(base) stroke=(colour) stroke-width=(1.5 + 0.6 * step as f64) {}
                }
                text x=(SIZE[0] - 200.0) y=(base - 8.0) fill="#333" { (self.values()) }
            }
        }
    }

    /// Pieces of the measured path of one step each; they share their ends.
    fn stretches(&self) -> Vec<(usize, &[[f64; 3]])> {
        let mut found = Vec::new();
        let mut start = 0;
        for i in 1..=self.measured.len() {
            let whole = |i: usize| self.measured[i].iter().all(|v| v.is_finite());
            let ends =
                i == self.measured.len() || !whole(i) || !whole(start) || self.step(i) != self.step(start);
            if ends {
                let shared = i < self.measured.len() && whole(i);
                if whole(start) {
                    found.push((self.step(start), &self.measured[start..i + usize::from(shared)]));
                }
                start = i;
            }
        }
        found
    }
}

/// The place of a scene: the script draws and turns it on the screen, the picture is for paper and without a script.
pub(in crate::render) fn scene(scene: &Scene) -> Markup {
    let label = format!(
        "{}. Drag, or use the arrow keys, to turn it; a double click or Home shows the first view. The table below holds it.",
        scene.title
    );
    html! {
        figure class="chart" {
            figcaption {
                span class="title" { (clean(&scene.title)) }
                span class="legend" {
                    span { i class="planned" {} (scene.names[0]) }
                    span { (scene.names[1]) " 0 " @for k in 0..STEPS { i class={ "step step" (k) } {} } (format!("{:.1} {}", scene.most(), scene.value_unit)) }
                }
            }
            div class="scene" tabindex="0" role="group" aria-label=(clean(&label)) data-scene=(scene.data()) {}
            div class="paper" aria-hidden="true" { (scene.picture()) }
        }
    }
}

/// From where a path is seen broadest, rad: from outside, across the way that it mostly goes.
pub(in crate::render) fn broadest_rad(path_m: &[[f64; 3]]) -> f64 {
    let count = path_m.len().max(1) as f64;
    let mean = [0, 1].map(|k| path_m.iter().map(|place| place[k]).sum::<f64>() / count);
    let product =
        |a: usize, b: usize| path_m.iter().map(|p| (p[a] - mean[a]) * (p[b] - mean[b])).sum::<f64>();
    let way_rad = 0.5 * (2.0 * product(0, 1)).atan2(product(0, 0) - product(1, 1));
    let across = way_rad + std::f64::consts::FRAC_PI_2;
    let outside = mean[0] * across.cos() + mean[1] * across.sin() >= 0.0;
    let yaw_rad = (if outside { across } else { across + std::f64::consts::PI }) + 0.3;
    (yaw_rad * 1e3).round() / 1e3
}
