//! How mass is distributed over a body.

use nalgebra::{Matrix3, Vector3};

use super::Pose;

/// Mass, its first and its second moment about the origin of a frame.
///
/// The second moment is the integral of r rᵀ dm, which moves between frames as simply as the first;
/// the inertia tensor is its trace times the identity, less itself.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inertia {
    mass_kg: f64,
    first_kg_m: Vector3<f64>,
    second_kg_m2: Matrix3<f64>,
}

impl Inertia {
    /// A body by its mass, kg, centre of mass, m, and inertia tensor about that centre, kg m².
    ///
    /// `None` unless everything is finite and neither the mass nor a moment about an axis is negative.
    pub fn new(mass_kg: f64, centre_m: Vector3<f64>, tensor_kg_m2: Matrix3<f64>) -> Option<Self> {
        let about_centre = Matrix3::identity() * (0.5 * tensor_kg_m2.trace()) - tensor_kg_m2;
        let second_kg_m2 = about_centre + centre_m * centre_m.transpose() * mass_kg;
        let body = Self { mass_kg, first_kg_m: centre_m * mass_kg, second_kg_m2 };
        let numbers = std::iter::once(&body.mass_kg).chain(&body.first_kg_m).chain(&body.second_kg_m2);
        let turns = (0..3).all(|axis| tensor_kg_m2[(axis, axis)] >= 0.0);
        (mass_kg >= 0.0 && turns && numbers.into_iter().all(|x| x.is_finite())).then_some(body)
    }

    /// A mass without extent, kg, at a place, m; conditions as in [`Inertia::new`].
    pub fn point(mass_kg: f64, place_m: Vector3<f64>) -> Option<Self> {
        Self::new(mass_kg, place_m, Matrix3::zeros())
    }

    /// Mass, kg.
    pub fn mass_kg(&self) -> f64 {
        self.mass_kg
    }

    /// Mass times centre of mass, kg m.
    pub fn first_kg_m(&self) -> &Vector3<f64> {
        &self.first_kg_m
    }

    /// Integral of r rᵀ dm, kg m²; symmetric.
    pub fn second_kg_m2(&self) -> &Matrix3<f64> {
        &self.second_kg_m2
    }

    /// The same body in the frame in which its own frame lies at `place`.
    pub fn seen_from(&self, place: &Pose) -> Self {
        let (rotation, shift) = (place.rotation.matrix(), place.translation.vector);
        let first = rotation * self.first_kg_m;
        let mixed = first * shift.transpose();
        Self {
            mass_kg: self.mass_kg,
            first_kg_m: first + shift * self.mass_kg,
            second_kg_m2: rotation * self.second_kg_m2 * rotation.transpose()
                + mixed
                + mixed.transpose()
                + shift * shift.transpose() * self.mass_kg,
        }
    }

    /// Both bodies as one; they are given in the same frame.
    pub fn with(&self, other: &Self) -> Self {
        Self {
            mass_kg: self.mass_kg + other.mass_kg,
            first_kg_m: self.first_kg_m + other.first_kg_m,
            second_kg_m2: self.second_kg_m2 + other.second_kg_m2,
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Rotation3, Translation3};

    use super::*;

    #[test]
    fn a_body_moved_is_the_body_described_there() {
        let tensor = Matrix3::new(3.0, 0.1, -0.2, 0.1, 2.0, 0.3, -0.2, 0.3, 4.0);
        let centre = Vector3::new(0.3, -0.4, 0.5);
        let rotation = Rotation3::from_euler_angles(0.3, -1.0, 2.0);
        let place = Pose::from_parts(Translation3::new(1.0, 2.0, -3.0), rotation);
        let moved = Inertia::new(7.0, centre, tensor).unwrap().seen_from(&place);
        let turned = rotation.matrix() * tensor * rotation.matrix().transpose();
        let there = rotation * centre + place.translation.vector;
        let direct = Inertia::new(7.0, there, turned).unwrap();
        assert!((moved.first_kg_m - direct.first_kg_m).norm() < 1e-13);
        assert!((moved.second_kg_m2 - direct.second_kg_m2).norm() < 1e-12);
    }

    #[test]
    fn negative_mass_and_nan_are_no_bodies() {
        assert_eq!(Inertia::point(-1.0, Vector3::zeros()), None);
        assert_eq!(Inertia::point(1.0, Vector3::new(f64::NAN, 0.0, 0.0)), None);
    }
}
