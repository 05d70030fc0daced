//! Commands made from fits, on the machines that the fits are of.

use hydrotrace::plant::Plant;

use crate::support::{
    compensation::{PRESETS, changed, check, learnt, tried},
    machine::task,
    variation::Variation,
};

#[test]
fn a_command_from_one_log_of_the_task_takes_six_tenths_off_the_mean_transition_peak() {
    for preset in PRESETS {
        let plant = Plant::preset(preset).unwrap();
        for number in [1, 2] {
            let job = task(number);
            let (before, after) = tried(&plant, &job, &learnt(&plant, &job, 1), 1);
            check(&format!("{preset} {number}"), &before, &after, (0.4, 2.0));
        }
    }
}

#[test]
fn a_command_still_helps_once_the_machine_has_changed() {
    let job = task(1);
    let command = learnt(&Plant::preset("default").unwrap(), &job, 1);
    for variation in [Variation::ColdOil, Variation::HeavyPayload] {
        let (plant, job) = changed("default", &job, variation);
        let (before, after) = tried(&plant, &job, &command, 1);
        check(&format!("{variation:?}"), &before, &after, (0.5, 2.0));
    }
}
