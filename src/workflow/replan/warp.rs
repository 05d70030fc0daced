//! What a run of one timing tells of another timing of the same key points.

use crate::{
    fit::{Fit, predict},
    series::{Series, Track},
};

/// Arrivals at the key points in the old run and in the new plan, s, each on its own clock.
pub(super) struct Warp {
    pub(super) old_s: Vec<f64>,
    pub(super) new_s: Vec<f64>,
}

impl Warp {
    /// The instant of the old run that belongs to one of the new plan: linear between key points.
    fn old_s(&self, t_s: f64) -> f64 {
        let after = self.new_s.partition_point(|new_s| *new_s <= t_s);
        let at = |k: usize| Some((*self.new_s.get(k)?, *self.old_s.get(k)?));
        match (after.checked_sub(1).and_then(at), at(after)) {
            (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (t_s - a.0) / (b.0 - a.0),
            (Some(end), None) | (None, Some(end)) => end.1 + t_s - end.0,
            (None, None) => t_s,
        }
    }

    /// The run that the model makes of the new plan, with what it did not explain in the old run at the same part of the
    /// way; `None` if the fit knows no joint.
    pub(super) fn run(
        &self,
        fit: &Fit,
        plan: &Series,
        (sent, measured): (&Series, &Series),
    ) -> Option<Series> {
        let one = |track: &Track| {
            let (name, model) = (track.name(), &fit.joint(track.name())?.model);
            let (sent, measured) = (sent.track(name)?, measured.track(name)?);
            let modelled = predict(model, sent).ok()?;
            let response = predict(model, track).ok()?;
            let answer = response
                .t_s()
                .iter()
                .zip(response.position())
                .map(|(t_s, response)| response + unexplained(measured, &modelled, self.old_s(*t_s)));
            Track::of(track.kind(), name, response.t_s(), answer.collect(), &[]).ok()
        };
        let tracks: Vec<Track> = plan.tracks.iter().filter_map(one).collect();
        (!tracks.is_empty()).then_some(Series { tracks })
    }
}

/// What the model did not explain at an instant of the old run, in the joint's unit. Where nothing was measured, what it was
/// before and after, from the one to the other.
pub(super) fn unexplained(measured: &Track, modelled: &Track, at_s: f64) -> f64 {
    let left = |t_s: f64, position: f64| position - modelled.held_at(t_s).position;
    if let Some(state) = measured.at(at_s) {
        return left(at_s, state.position);
    }
    let (t_s, position) = (measured.t_s(), measured.position());
    let after = t_s.partition_point(|own_s| *own_s <= at_s);
    let of = |k: usize| Some((*t_s.get(k)?, left(*t_s.get(k)?, *position.get(k)?)));
    match (after.checked_sub(1).and_then(of), of(after)) {
        (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (at_s - a.0) / (b.0 - a.0),
        (Some(end), None) | (None, Some(end)) => end.1,
        (None, None) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn key_points_meet_and_rests_keep_their_length() {
        let warp = Warp { old_s: vec![2.0, 10.0, 12.0], new_s: vec![1.5, 7.5, 9.5] };
        for (new_s, old_s) in [(0.0, 0.5), (1.5, 2.0), (4.5, 6.0), (7.5, 10.0), (8.5, 11.0), (11.0, 13.5)] {
            assert!((warp.old_s(new_s) - old_s).abs() < 1e-12, "{new_s}");
        }
    }
}
