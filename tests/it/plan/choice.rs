//! The chosen plan under a ceiling.

use crate::support::choice::{TASKS, no_choice_is_above_the_best};

/// Three tasks, 40 ceilings, two seeds: `cargo test --release --test slow choice -- --ignored --nocapture`.
#[test]
fn no_choice_under_a_ceiling_is_a_thousandth_above_the_best_of_two_searches() {
    no_choice_is_above_the_best(&TASKS[..1], 20, (&[(1, 5000)], &[(3, 10_000)]));
}
