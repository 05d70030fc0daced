//! stub
/// stub
#[derive(Debug)]
pub struct Clock;
/// stub
#[derive(Debug)]
pub struct Row;
/// stub
pub fn continuous_clock() {}
