//! stub
/// stub
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// stub
    pub sigma_rad: f64,
}
/// stub
pub fn noise() {}
