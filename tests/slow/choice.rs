//! The chosen plan under a ceiling, on all tasks.

use crate::support::choice::{TASKS, no_choice_is_above_the_best};

#[test]
#[ignore = "half a minute"]
fn no_choice_under_a_ceiling_is_a_thousandth_above_the_best_of_five_searches() {
    let (judged, others) = ([(1, 5000), (2, 5000)], [(3, 20_000), (4, 20_000), (5, 20_000)]);
    no_choice_is_above_the_best(&TASKS, 40, (&judged, &others));
}
