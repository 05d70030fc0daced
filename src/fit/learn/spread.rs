//! What comes differently each time, though the same was sent.

use super::{
    super::{Model, model::STEP_S},
    answer::Answer,
    correct::{NONE_RAD, Workspace, largest, unexplained_rad},
};
use crate::math::{lowpass, rms};

/// Errors are compared below this, Hz.
const COMPARED_HZ: f64 = 1.5;

/// Runs are alike where what was sent in them differs by less than this share of the correction: the model has little part in what
/// they differ by.
const NEARLY: f64 = 0.3;

/// So many of them tell it by themselves.
const MANY: usize = 3;

/// What runs differ by though the model says that they should not, rad: those in which nearly the same was sent, three at least;
/// or the last run and one before it, one in which the same was sent if there is one, for then the model matters little.
pub(super) fn spread_rad(
    answers: &[Answer],
    sent: &[Vec<f64>],
    model: &Model,
    workspace: &mut Workspace,
) -> Option<f64> {
    let (last, others) = answers.split_last()?;
    let newest = sent.last()?;
    let near = |k: &usize| largest(&less(&sent[*k], newest)) <= NEARLY * largest(newest);
    let alike: Vec<usize> = (0..sent.len()).filter(near).collect();
    if alike.len() >= MANY {
        let left: Vec<Vec<f64>> =
            alike.iter().map(|k| unexplained_rad(&answers[*k], model, workspace)).collect();
        let count = left.len() as f64;
        let mean: Vec<f64> =
            (0..newest.len()).map(|k| left.iter().map(|run| run[k]).sum::<f64>() / count).collect();
        let squares: f64 = left.iter().map(|run| compared(&less(run, &mean)).powi(2)).sum();
        return Some((squares / (count - 1.0)).sqrt());
    }
    let before = others.iter().rfind(|run| same(run, last)).or(others.last())?;
    let before_rad = unexplained_rad(before, model, workspace);
    let last_rad = unexplained_rad(last, model, workspace);
    Some(compared(&less(&last_rad, &before_rad)) / std::f64::consts::SQRT_2)
}

/// Size of an error below [`COMPARED_HZ`], rad.
pub(super) fn compared(error_rad: &[f64]) -> f64 {
    let mut slow = error_rad.to_vec();
    lowpass(&mut slow, COMPARED_HZ, STEP_S);
    rms(&slow)
}

fn less(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Whether the same was sent.
fn same(a: &Answer, b: &Answer) -> bool {
    a.sent.iter().zip(&b.sent).all(|(a, b)| (a.0 - b.0).abs() < NONE_RAD)
}
