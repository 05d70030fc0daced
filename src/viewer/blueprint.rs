//! What is seen first: arm and starts on the left, errors, joints and words on the right.

use rerun::{
    blueprint::components::{LoopMode, PanelState, PlayState},
    blueprint::{
        Blueprint, BlueprintPanel, ContainerLike, Horizontal, SelectionPanel, Spatial2DView, Spatial3DView,
        StateTimelineView, Tabs, TextLogView, TimePanel, TimeSeriesView, Vertical,
    },
};

use super::{
    scene::{joint, lane, root},
    stream::TIMELINE,
};
use crate::workflow::view::Scene;

/// The layout for some runs; `live` follows what arrives.
pub(super) fn of(scenes: &[Scene], live: bool) -> Blueprint {
    let mut left: Vec<ContainerLike> = Vec::new();
    let mut left_shares = Vec::new();
    if scenes.iter().any(|scene| scene.arm.is_some()) {
        let seen = scenes
            .iter()
            .flat_map(|scene| ["measured", "planned"].map(|what| format!("+ {}/{what}/**", root(scene))));
        let arm = Spatial3DView::new("Arm: measured solid, planned pale").with_origin("/");
        left.push(arm.with_contents(seen).into());
        left_shares.push(3.0);
    }
    let lanes: Vec<String> = each_joint(scenes, |scene, name| {
        scene.transitions.iter().any(|t| t.joint == name).then(|| format!("+ {}", lane(scene, name)))
    });
    // A lane keeps to the time it first showed, which of a run that has just begun is nothing.
    if !lanes.is_empty() && !live {
        left.push(StateTimelineView::new("Starts from rest").with_origin("/").with_contents(lanes).into());
        left_shares.push(1.3);
    }
    let mut right: Vec<ContainerLike> = Vec::new();
    let mut right_shares = Vec::new();
    let errors: Vec<String> = each_joint(scenes, |scene, name| {
        scene.pairs.iter().any(|pair| pair.name == name).then(|| format!("+ {}/error", joint(scene, name)))
    });
    if !errors.is_empty() {
        let view = TimeSeriesView::new("Error, deg (planned minus measured)");
        right.push(view.with_origin("/").with_contents(errors).into());
        right_shares.push(1.2);
    }
    let tabs: Vec<ContainerLike> = joint_names(scenes)
        .into_iter()
        .map(|name| {
            let seen = scenes.iter().flat_map(|scene| {
                ["planned", "measured"].map(|what| format!("+ {}/{what}", joint(scene, name)))
            });
            TimeSeriesView::new(format!("{name}, deg")).with_origin("/").with_contents(seen).into()
        })
        .collect();
    right.push(Tabs::new(tabs).into());
    right_shares.push(1.2);
    let mut below: Vec<ContainerLike> = Vec::new();
    let words = scenes.iter().map(|scene| format!("+ {}/log", root(scene)));
    below.push(TextLogView::new("Starts and remarks").with_origin("/").with_contents(words).into());
    if scenes.iter().any(|scene| scene.front.as_ref().is_some_and(|front| front.objectives.len() > 1)) {
        let fronts = scenes.iter().map(|scene| format!("+ {}/front/**", root(scene)));
        let view = Spatial2DView::new("Plans: duration right, jerk up, power by size");
        below.insert(0, view.with_origin("/").with_contents(fronts).into());
    }
    right.push(Tabs::new(below).into());
    right_shares.push(0.9);
    let right: ContainerLike = Vertical::new(right).with_row_shares(right_shares).into();
    let root = if left.is_empty() {
        right
    } else {
        let left: ContainerLike = Vertical::new(left).with_row_shares(left_shares).into();
        Horizontal::new([left, right]).with_column_shares(vec![1.15, 1.0]).into()
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
}

/// Names of all joints, in the order of the first run that has them.
fn joint_names(scenes: &[Scene]) -> Vec<&str> {
    let mut names = Vec::new();
    for track in scenes.iter().flat_map(|scene| &scene.planned.tracks) {
        if !names.contains(&track.name()) {
            names.push(track.name());
        }
    }
    names
}

fn each_joint(scenes: &[Scene], of: impl Fn(&Scene, &str) -> Option<String>) -> Vec<String> {
    let names = joint_names(scenes);
    scenes
        .iter()
        .flat_map(|scene| names.iter().filter_map(|name| of(scene, name)).collect::<Vec<_>>())
        .collect()
}
