//! The arm: solids and meshes on its links, and the path of its tool.

use rerun::{
    AlbedoFactor, Asset3D, Boxes3D, Color, Cylinders3D, Ellipsoids3D, FillMode, LineStrips3D, Radius,
    RecordingStream, Transform3D,
};

use super::{
    ViewError, color,
    stream::{Stream, Values, part, single},
};
use crate::{
    arm::{Pose, Shape, Solid, quaternion_xyzw},
    workflow::view::{MovingArm, Poses},
};

#[derive(Clone, Copy)]
pub(super) enum Look {
    /// As it was measured in a run: the first in its own colours, others in theirs, seen through.
    Measured(usize),
    /// Where the plan wants it: pale, and a little larger.
    Planned,
}

/// By how much a transparent solid is larger than the solid inside it, as a share of the arm's reach: their faces
/// never coincide.
const MARGIN: f64 = 0.002;
/// Of tool paths, in points of the screen, whatever the size of the arm.
const PATH_POINTS: f32 = 1.2;

impl Look {
    fn colour(self) -> Color {
        match self {
            Self::Measured(run) => color::run(run),
            Self::Planned => color::planned(0),
        }
    }

    /// Colour and fill of a solid, and by how many margins it grows.
    fn solid(self, rgba: [f64; 4]) -> (Color, FillMode, f64) {
        let seen_through = FillMode::TransparentFillMajorWireframe;
        match self {
            Self::Measured(0) => (color::own(rgba), FillMode::Solid, 0.0),
            Self::Measured(run) => (color::clear(Some(run), 255), seen_through, 1.0 + run as f64),
            Self::Planned => (color::clear(None, 150), seen_through, 1.0),
        }
    }

    /// Colour of a mesh; `None` leaves it to the file.
    fn mesh(self, rgba: Option<[f64; 4]>) -> Option<Color> {
        match self {
            Self::Measured(0) => rgba.map(color::own),
            Self::Measured(run) => Some(color::clear(Some(run), 110)),
            Self::Planned => Some(color::clear(None, 60)),
        }
    }
}

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
        send_shape(rec, &format!("{}/{k}", name(shape.link)), shape, look, MARGIN * arm.reach_m)?;
    }
    for (k, (mesh, file)) in arm.meshes.iter().enumerate() {
        let path = format!("{}/mesh-{k}", name(mesh.link));
        let asset =
            Asset3D::from_file_path(file).map_err(|source| ViewError::Mesh { path: file.clone(), source })?;
        let asset = match look.mesh(mesh.rgba) {
            Some(Color(rgba)) => asset.with_albedo_factor(AlbedoFactor(rgba)),
            None => asset,
        };
        let (place_m, turn) = placed(&mesh.place);
        let place = Transform3D::from_translation_rotation_scale(place_m, turn, single(mesh.scale));
        rec.log_static(path.as_str(), &place)?;
        rec.log_static(path, &asset)?;
    }
    let tool: Vec<[f32; 3]> = poses
        .poses
        .iter()
        .filter_map(|links| Some(single(links.last()?.translation.vector.into())))
        .collect();
    if tool.len() > 1 {
        let radius = Radius::new_ui_points(PATH_POINTS);
        let path = LineStrips3D::new([tool]).with_colors([look.colour()]).with_radii([radius]);
        rec.log_static(format!("{root}/tool_path"), &path)?;
    }
    let stream = |link: usize| Stream {
        path: name(link),
        t_s: poses.t_s.clone(),
        values: Values::Poses(poses.poses.iter().filter_map(|links| links.get(link).copied()).collect()),
    };
    Ok((0..arm.links.len()).map(stream).collect())
}

fn placed(place: &Pose) -> ([f32; 3], rerun::Quaternion) {
    let turn = rerun::Quaternion::from_xyzw(single(quaternion_xyzw(place)));
    (single(place.translation.vector.into()), turn)
}

fn send_shape(
    rec: &RecordingStream,
    path: &str,
    shape: &Shape,
    look: Look,
    margin_m: f64,
) -> Result<(), ViewError> {
    let (colour, fill, margins) = look.solid(shape.rgba);
    let margin_m = margins * margin_m;
    let (centre, turn) = placed(&shape.place);
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
