//! The first layout: arm and starts on the left; errors, joints and remarks on the right.

use rerun::{
    blueprint::components::{Corner2D, LinkAxis, LoopMode, PanelState, PlayState},
    blueprint::{
        Blueprint, BlueprintPanel, ContainerLike, Grid, Horizontal, SelectionPanel, Spatial2DView,
        Spatial3DView, StateTimelineView, Tabs, TextLogView, TimePanel, TimeSeriesView, Vertical,
        datatypes::{TextLogColumn, TextLogColumnKind, TimelineColumn},
    },
    external::re_sdk_types::blueprint::archetypes::{
        EyeControls3D, PlotLegend, TextLogColumns, TimeAxis, VisualBounds2D,
    },
};

use super::{
    board::Board,
    front,
    scene::{joint, lane, root},
    stream::{TIMELINE, single},
};
use crate::{math::range, units::degrees_from_radians, workflow::view::Scene};

/// Joints of several runs that fit beside each other.
const MOST_PLOTS: usize = 8;

/// The layout for some runs; with `live` the time follows the data.
pub(super) fn of(scenes: &[Scene], live: bool) -> Board {
    let mut board = Board::default();
    let (mut left, mut right) = (Column::default(), Column::default());
    let several = scenes.len() > 1;
    let errors = errors(&mut board, scenes);
    if let Some(arm) = arm(&mut board, scenes) {
        left.add(3.0, arm);
        right.extend(if several { 2.2 } else { 1.2 }, errors);
    } else {
        left.extend(1.6, errors);
    }
    let lanes = of_joints(scenes, |scene, name| {
        let starts = scene.transitions.iter().any(|t| t.joint == name);
        starts.then(|| format!("+ {}", lane(scene, name, several)))
    });
    // A lane keeps to the time it first showed, which of a run that has just begun is nothing.
    if !lanes.is_empty() && !live {
        let share = if several { 2.0 } else { 1.3 };
        left.add(share, StateTimelineView::new("Starts from rest").with_origin("/").with_contents(lanes));
    }
    let tabs: Vec<ContainerLike> =
        names(scenes).into_iter().map(|name| angles(&mut board, scenes, name)).collect();
    right.add(1.2, Tabs::new(tabs));
    right.add(0.9, below(&mut board, scenes));
    board.finish(|| {
        let right = right.finish();
        let root = if left.0.is_empty() {
            right
        } else {
            Horizontal::new([left.finish(), right]).with_column_shares(vec![1.15, 1.0]).into()
        };
        let play = if live { PlayState::Following } else { PlayState::Playing };
        let time = TimePanel::new()
            .with_timeline(TIMELINE)
            .with_play_state(play)
            .with_loop_mode(if live { LoopMode::Off } else { LoopMode::All })
            .with_state(PanelState::Collapsed);
        Blueprint::new(root)
            .with_auto_views(false)
            .with_auto_layout(false)
            .with_blueprint_panel(BlueprintPanel::from_state(PanelState::Collapsed))
            .with_selection_panel(SelectionPanel::from_state(PanelState::Collapsed))
            .with_time_panel(time)
    })
}

/// Views above one another, each with its share of the height.
#[derive(Default)]
struct Column(Vec<(f32, ContainerLike)>);

impl Column {
    fn add(&mut self, share: f32, view: impl Into<ContainerLike>) {
        self.0.push((share, view.into()));
    }

    fn extend(&mut self, share: f32, view: Option<ContainerLike>) {
        self.0.extend(view.map(|view| (share, view)));
    }

    fn finish(self) -> ContainerLike {
        let (shares, views): (Vec<f32>, Vec<ContainerLike>) = self.0.into_iter().unzip();
        Vertical::new(views).with_row_shares(shares).into()
    }
}

fn arm(board: &mut Board, scenes: &[Scene]) -> Option<ContainerLike> {
    let drawn: Vec<&Scene> = scenes.iter().filter(|scene| scene.arm.is_some()).collect();
    let ran = |scene: &Scene| scene.arm.as_ref().is_some_and(|arm| !arm.measured.poses.is_empty());
    let name = match drawn[..] {
        [] => return None,
        [only] if !ran(only) => "Arm, as planned".to_owned(),
        [_] => "Arm: measured solid, planned pale".to_owned(),
        [first, ref others @ ..] => {
            let others: Vec<&str> = others.iter().map(|scene| scene.name.as_str()).collect();
            format!("Arm: {} solid, {} outlined", first.name, others.join(", "))
        }
    };
    let seen = drawn
        .iter()
        .flat_map(|scene| ["measured", "planned"].map(|what| format!("+ {}/{what}/**", root(scene))));
    let view = Spatial3DView::new(name).with_origin("/").with_contents(seen);
    let Some(eye) = drawn.iter().find_map(|scene| scene.arm.as_ref()?.sight()) else {
        return Some(view.into());
    };
    let eye = EyeControls3D::new()
        .with_position(single(eye.from_m))
        .with_look_target(single(eye.to_m))
        .with_eye_up([0.0, 0.0, 1.0]);
    Some(board.with(view, &eye))
}

/// One run: all joints in one plot. Several runs: a plot a joint, with a line a run.
fn errors(board: &mut Board, scenes: &[Scene]) -> Option<ContainerLike> {
    let of = |name: &str| -> Vec<String> {
        let has = |scene: &&Scene| scene.pairs.iter().any(|pair| pair.name == name);
        scenes.iter().filter(has).map(|scene| format!("+ {}/error", joint(scene, name))).collect()
    };
    let joints: Vec<(&str, Vec<String>)> =
        names(scenes).into_iter().map(|name| (name, of(name))).filter(|(_, seen)| !seen.is_empty()).collect();
    if joints.is_empty() {
        return None;
    }
    if scenes.len() == 1 {
        let view = TimeSeriesView::new("Error, deg (planned minus measured)").with_origin("/");
        return Some(plot(
            board,
            view.with_contents(joints.into_iter().flat_map(|(_, seen)| seen)),
            Corner2D::LeftTop,
        ));
    }
    let plots: Vec<ContainerLike> = joints
        .into_iter()
        .enumerate()
        .map(|(i, (name, seen))| {
            let view = TimeSeriesView::new(format!("{name}: error ≤ {} deg", largest_deg(scenes, name)))
                .with_origin("/")
                .with_contents(seen);
            if i == 0 {
                return plot(board, view, Corner2D::LeftTop);
            }
            // One legend tells the runs for all.
            let view = board.with(view, &PlotLegend::new().with_visible(false));
            board.with(view, &linked())
        })
        .collect();
    Some(if plots.len() > MOST_PLOTS {
        Tabs::new(plots).into()
    } else {
        Grid::new(plots).with_grid_columns(2).into()
    })
}

/// Largest errors of a joint, run by run: small plots have no room for a scale.
fn largest_deg(scenes: &[Scene], name: &str) -> String {
    let pairs = scenes.iter().filter_map(|scene| scene.pairs.iter().find(|pair| pair.name == name));
    let largest = pairs.map(|pair| {
        let errors_rad =
            pair.planned.iter().zip(&pair.measured).map(|(planned, measured)| (planned - measured).abs());
        format!("{:.2}", degrees_from_radians(errors_rad.fold(0.0, f64::max)))
    });
    largest.collect::<Vec<_>>().join(", ")
}

fn angles(board: &mut Board, scenes: &[Scene], name: &str) -> ContainerLike {
    let seen = scenes
        .iter()
        .flat_map(|scene| ["planned", "measured"].map(|what| format!("+ {}/{what}", joint(scene, name))));
    let view = TimeSeriesView::new(format!("{name}, deg")).with_origin("/").with_contents(seen);
    // The corner that the curve does not begin in.
    let position_rad =
        scenes.iter().find_map(|scene| scene.planned.track(name)).map_or(&[][..], |t| t.position());
    let [least, most] = range(position_rad.iter().copied());
    let high = position_rad.first().is_some_and(|first| first - least > most - first);
    plot(board, view, if high { Corner2D::LeftBottom } else { Corner2D::LeftTop })
}

/// A plot whose time moves with that of the others.
fn plot(board: &mut Board, view: TimeSeriesView, legend: Corner2D) -> ContainerLike {
    let view = board.with(view, &PlotLegend::new().with_corner(legend));
    board.with(view, &linked())
}

fn linked() -> TimeAxis {
    TimeAxis::new().with_link(LinkAxis::LinkToGlobal)
}

/// The Pareto front of a plan, if there is one, and the remarks on the runs.
fn below(board: &mut Board, scenes: &[Scene]) -> Tabs {
    let mut below: Vec<ContainerLike> = Vec::new();
    if scenes.iter().any(|scene| scene.front.as_ref().is_some_and(|front| front.front.len() > 1)) {
        let view = Spatial2DView::new("Plans: duration right, jerk up (logarithmic), power by size");
        let view = view.with_origin(front::ROOT).with_contents(["+ $origin/**"]);
        let [x, y] = front::SIGHT;
        let sight = rerun::datatypes::Range2D { x_range: x.into(), y_range: y.into() };
        below.push(board.with(view, &VisualBounds2D::new(sight)));
    }
    let words = scenes.iter().map(|scene| format!("+ {}/log", root(scene)));
    let view = TextLogView::new("Starts and remarks").with_origin("/").with_contents(words);
    // Too narrow for a time; the words begin with it.
    let time = TimelineColumn { visible: false.into(), timeline: TIMELINE.into() };
    let columns = [TextLogColumnKind::LogLevel, TextLogColumnKind::Body];
    let columns = columns.map(|kind| TextLogColumn { visible: true.into(), kind });
    let columns = TextLogColumns::new().with_timeline_columns([time]).with_text_log_columns(columns);
    below.push(board.with(view, &columns));
    Tabs::new(below)
}

/// Names of all joints, in the order of the first run that has them.
fn names(scenes: &[Scene]) -> Vec<&str> {
    let mut names = Vec::new();
    for track in scenes.iter().flat_map(|scene| &scene.planned.tracks) {
        if !names.contains(&track.name()) {
            names.push(track.name());
        }
    }
    names
}

fn of_joints(scenes: &[Scene], of: impl Fn(&Scene, &str) -> Option<String>) -> Vec<String> {
    names(scenes)
        .into_iter()
        .flat_map(|name| scenes.iter().filter_map(|scene| of(scene, name)).collect::<Vec<_>>())
        .collect()
}
