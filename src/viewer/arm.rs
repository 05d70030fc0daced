//! The arm: solids that ride on its links, and the way of its tool.

use rerun::{Boxes3D, Color, Cylinders3D, Ellipsoids3D, FillMode, LineStrips3D, RecordingStream};

use super::{
    ViewError, color,
    scene::part,
    stream::{Stream, Values, single},
};
use crate::{
    arm::{Shape, Solid, quaternion_xyzw},
    workflow::view::{MovingArm, Poses},
};

/// How an arm is shown.
#[derive(Clone, Copy)]
pub(super) enum Look {
    /// As it was measured, in the colours of its run.
    Measured(usize),
    /// Where the plan wants it: pale, and a little larger.
    Planned,
}

/// How much larger a ghost's solids are on every side, m: the two never show at the same place.
const MARGIN_M: f64 = 0.012;
const PATH_RADIUS_M: [f32; 2] = [0.004, 0.009];

/// Sends what does not change; returns how the links move.
pub(super) fn send(
    rec: &RecordingStream,
    root: &str,
    arm: &MovingArm,
    poses: &Poses,
    look: Look,
) -> Result<Vec<Stream>, ViewError> {
    let name = |link: usize| format!("{root}/arm/{}", part(arm.links.get(link).map_or("link", |name| name)));
    for (k, shape) in arm.shapes.iter().enumerate() {
        send_shape(rec, &format!("{}/{k}", name(shape.link)), shape, look)?;
    }
    let tool: Vec<[f32; 3]> = poses
        .poses
        .iter()
        .filter_map(|links| Some(single(links.last()?.translation.vector.into())))
        .collect();
    let (colour, radius) = match look {
        Look::Measured(run) => (color::run(run), PATH_RADIUS_M[1]),
        Look::Planned => {
            let [r, g, b] = color::PLANNED;
            (Color::from_rgb(r, g, b), PATH_RADIUS_M[0])
        }
    };
    if tool.len() > 1 {
        let path = LineStrips3D::new([tool]).with_colors([colour]).with_radii([radius]);
        rec.log_static(format!("{root}/tool_path"), &path)?;
    }
    let stream = |link: usize| Stream {
        path: name(link),
        t_s: poses.t_s.clone(),
        values: Values::Poses(poses.poses.iter().filter_map(|links| links.get(link).copied()).collect()),
    };
    Ok((0..arm.links.len()).map(stream).collect())
}

fn send_shape(rec: &RecordingStream, path: &str, shape: &Shape, look: Look) -> Result<(), ViewError> {
    let (colour, fill, margin_m) = match look {
        Look::Measured(run) => (color::solid(shape.rgba, run), FillMode::Solid, 0.0),
        Look::Planned => (color::ghost(), FillMode::TransparentFillMajorWireframe, MARGIN_M),
    };
    let centre = single(shape.place.translation.vector.into());
    let turn = rerun::Quaternion::from_xyzw(single(quaternion_xyzw(&shape.place)));
    match shape.solid {
        Solid::Block(edges_m) => {
            let half = single(edges_m.map(|edge_m| 0.5 * edge_m + margin_m));
            let block = Boxes3D::from_centers_and_half_sizes([centre], [half]);
            rec.log_static(path, &block.with_quaternions([turn]).with_colors([colour]).with_fill_mode(fill))?;
        }
        Solid::Cylinder { radius_m, length_m } => {
            let [radius, length] = single([radius_m + margin_m, length_m + 2.0 * margin_m]);
            let cylinder = Cylinders3D::from_lengths_and_radii([length], [radius]).with_centers([centre]);
            rec.log_static(
                path,
                &cylinder.with_quaternions([turn]).with_colors([colour]).with_fill_mode(fill),
            )?;
        }
        Solid::Ball(radius_m) => {
            let [radius] = single([radius_m + margin_m]);
            let ball = Ellipsoids3D::from_centers_and_radii([centre], [radius]);
            rec.log_static(path, &ball.with_colors([colour]).with_fill_mode(fill))?;
        }
    }
    Ok(())
}
