//! stub
/// stub
#[derive(Debug)]
pub struct PlannedPoint;
/// stub
#[derive(Debug)]
pub struct PlannedTrajectory;
/// stub
pub fn plan_tracks() {}
