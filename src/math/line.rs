//! The line nearest to all points.

/// The line of least squares, and what it leaves.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Of value over time; no number where all times are one.
    pub slope: f64,
    /// Sum of the squared distances of the times from their mean.
    pub square: f64,
    /// Values off the line.
    pub left: Vec<f64>,
}

/// The line of values at times.
pub fn line(t: &[f64], values: &[f64]) -> Line {
    let n = t.len() as f64;
    let (middle, mean) = (t.iter().sum::<f64>() / n, values.iter().sum::<f64>() / n);
    let both = || t.iter().zip(values).map(|(t, x)| (t - middle, x - mean));
    let square = both().map(|(t, _)| t * t).sum::<f64>();
    let slope = both().map(|(t, x)| t * x).sum::<f64>() / square;
    Line { slope, square, left: both().map(|(t, x)| x - slope * t).collect() }
}
