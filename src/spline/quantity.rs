//! Position and its derivatives.

/// Position or one of its derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Quantity {
    /// Angle, rad.
    Position,
    /// rad/s.
    Velocity,
    /// rad/s².
    Acceleration,
    /// rad/s³.
    Jerk,
}

impl Quantity {
    /// All four, by order of derivative.
    pub const ALL: [Self; 4] = [Self::Position, Self::Velocity, Self::Acceleration, Self::Jerk];

    /// How many times position is derived.
    pub const fn order(self) -> usize {
        self as usize
    }
}
