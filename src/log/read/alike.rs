//! How a measurement is like a plan.

use crate::series::Track;

/// Instants at which plan and measurement are compared, evenly spread over the measurement; fewer than the least tell
/// nothing.
const INSTANTS: usize = 500;
pub(super) const LEAST_INSTANTS: usize = 50;

/// A speed is taken over so long, s.
const SPEED_OVER_S: f64 = 0.1;

/// Positions of plan and measurement at the same instants.
type Both = Vec<[f64; 2]>;

/// How a measurement is like a plan.
pub(super) struct Alike {
    /// Root mean square of measured less planned.
    pub(super) rms_error: f64,
    /// Its mean.
    pub(super) mean_error: f64,
    /// The same where the plan has no speed, by a line through errors over speeds.
    pub(super) offset: f64,
    /// Root mean square distance of the plan from its mean.
    pub(super) motion: f64,
    /// Of plan and measurement; 0 where one of them stands still.
    pub(super) correlation: f64,
    /// Measured motion by planned motion.
    pub(super) slope: f64,
}

impl Alike {
    /// `None` with too few instants.
    pub(super) fn of(both: &Both) -> Option<Self> {
        if both.len() < LEAST_INSTANTS {
            return None;
        }
        let mean = |of: &dyn Fn(&[f64; 2]) -> f64| both.iter().map(of).sum::<f64>() / both.len() as f64;
        let (plan, came) = (mean(&|p| p[0]), mean(&|p| p[1]));
        let squares = mean(&|p| (p[0] - plan).powi(2));
        let products = mean(&|p| (p[0] - plan) * (p[1] - came));
        let spread = mean(&|p| (p[1] - came).powi(2)).sqrt();
        let motion = squares.sqrt();
        let step = |k: usize| both[(k + 1).min(both.len() - 1)][0] - both[k.saturating_sub(1)][0];
        let steps = || (0..both.len()).map(step);
        let usual = steps().sum::<f64>() / both.len() as f64;
        let (mut with_error, mut with_step) = (0.0, 0.0);
        for (step, [plan_at, came_at]) in steps().zip(both) {
            with_error += (step - usual) * (came_at - plan_at);
            with_step += (step - usual).powi(2);
        }
        let lag = if with_step > 0.0 { with_error / with_step } else { 0.0 };
        let or_none = |value: f64| if value.is_finite() { value } else { 0.0 };
        Some(Self {
            rms_error: mean(&|p| (p[1] - p[0]).powi(2)).sqrt(),
            mean_error: came - plan,
            offset: came - plan - lag * usual,
            motion,
            correlation: or_none(products / (motion * spread)),
            slope: or_none(products / squares),
        })
    }
}

/// The speed of a track as a track, over a tenth of a second.
pub(super) fn speeds(track: &Track) -> Option<Track> {
    let (t_s, x) = (track.t_s(), track.position());
    let wide = (0.5 * SPEED_OVER_S / track.sample_interval_s()).ceil().clamp(1.0, 1e4);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped above")]
    let wide = wide as usize;
    let within = |k: usize| (k.saturating_sub(wide), (k + wide).min(t_s.len() - 1));
    let slope = |(from, to): (usize, usize)| (x[to] - x[from]) / (t_s[to] - t_s[from]);
    let slopes = (0..t_s.len()).map(|k| slope(within(k))).collect();
    Track::of(track.kind(), track.name(), t_s.to_vec(), slopes, &[]).ok()
}

pub(super) fn both(planned: &Track, measured: &Track) -> Both {
    let step = measured.len().div_ceil(INSTANTS).max(1);
    let came = measured.t_s().iter().zip(measured.position()).step_by(step);
    came.filter_map(|(t_s, came)| Some([planned.at(*t_s)?.position, *came])).collect()
}
