//! stub
/// stub
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalFit {
    /// stub
    pub velocity: f64,
}
/// stub
pub fn local_quadratic() {}
