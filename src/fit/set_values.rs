//! Whether set values reach the loop late, through a filter or by a delay: the loop itself is then faster than it looks.

use super::{
    estimate::{Estimate, Problem, Workspace},
    model::Model,
    parameters::{DEAD_TIME, FEED_FORWARD, FILTER, LIMITS, SET_VALUE_DELAY, Shown},
};

/// The cost, a logarithm of likelihood, must fall by this.
const GAIN: f64 = 12.0;

/// Late set values that cost no more than this explain the data as well as prompt ones.
const AS_GOOD: f64 = 2.0;

/// Set values that come less late show the valve's lag by another name, s.
const SHORTEST_S: f64 = 0.06;

/// Below this, s, they may still be prompt: fits to six of three hundred joints whose set values are so find 60 to 75 ms.
const SURELY_LATE_S: f64 = 0.08;

/// A loop whose gain is larger than this by its lag rings: one that is calm has another structure, for which late set values
/// would stand in.
pub(super) const RINGS: f64 = 0.8;

/// Dead time where a descent starts, s.
const DEAD_TIME_S: f64 = 0.08;

/// Filter, s, delay, s, and feed-forward where the others start: taken for prompt ones, late set values make a loop look slower than
/// it is, or faster, and one without feed-forward as if it had some.
const STARTS: [[f64; 3]; 2] = [[0.1, 0.15, 0.9], [0.15, 0.05, 0.05]];

/// What late set values make of an estimate with prompt ones.
pub(super) enum SetValues {
    /// The data show them, in a model that has these parts; with the model of prompt ones where those come so little late that these may
    /// hold.
    Late(Estimate, Shown, Vec<Model>),
    /// They hardly tell them from prompt ones.
    MayBeLate(Vec<Model>),
    /// Late ones explain the data worse, or what they explain has another cause.
    Prompt,
}

impl SetValues {
    /// A loop without feed-forward is tried with one, too: behind a filter it is one without.
    pub(super) fn of(problem: &Problem, found: &Estimate, workspace: &mut Workspace) -> Self {
        let before = problem.cost_at(&found.x, found.scale_rad, workspace);
        let mut models = Vec::new();
        for feed_forward in if problem.shown.feed_forward { vec![true] } else { vec![true, false] } {
            let mut other = problem.clone();
            other.shown.late = true;
            other.shown.feed_forward = feed_forward;
            let best = other.search(starts(problem, found), workspace);
            let gained = before - other.cost_at(&best.x, found.scale_rad, workspace);
            let model = other.model(&best.x);
            let stands_in =
                model.set_values_late_s() < SHORTEST_S || model.position_gain_1_s * model.lag_s() > RINGS;
            if !stands_in && gained >= GAIN {
                let unsure = model.set_values_late_s() < SURELY_LATE_S;
                let prompt = unsure.then(|| problem.model(&found.x));
                return Self::Late(best, other.shown, prompt.into_iter().collect());
            }
            models.extend((!stands_in && gained >= -AS_GOOD).then_some(model));
        }
        if models.is_empty() { Self::Prompt } else { Self::MayBeLate(models) }
    }
}

fn starts(problem: &Problem, found: &Estimate) -> Vec<Vec<f64>> {
    let place = |i: usize, value: f64| problem.priors.of(i).place(value);
    let mut start = found.x.clone();
    start[DEAD_TIME] = place(DEAD_TIME, DEAD_TIME_S);
    let anew = STARTS.map(|[filter_s, delay_s, feed_forward]| {
        let mut x = start.clone();
        x[..LIMITS].fill(0.0);
        x[DEAD_TIME] = place(DEAD_TIME, DEAD_TIME_S);
        x[FEED_FORWARD] = place(FEED_FORWARD, feed_forward);
        x[FILTER] = place(FILTER, filter_s);
        x[SET_VALUE_DELAY] = place(SET_VALUE_DELAY, delay_s);
        x
    });
    std::iter::once(start).chain(anew).collect()
}
