//! Fits to machines of other structure: their intervals hold the truth, or the model is said not to hold.

use hydrotrace::{
    arm::Arm,
    fit::Excitation,
    plant::{Parameters, Plant},
};

use crate::support::{
    machine::{excitation, fitted, run, task},
    recovery::{QUANTITIES, middle_rad},
};

/// Machines whose set values pass a filter before a loop that feeds them forward, or are delayed, and by how much in all, s.
const LATE: [(&str, &str, f64); 5] = [
    ("filtered", "base = 'default'\n[control]\nset_value_filter_s = 0.1\n", 0.1),
    ("slowly filtered", "base = 'default'\n[control]\nset_value_filter_s = 0.25\nfeed_forward = 0.7\n", 0.25),
    ("delayed", "base = 'default'\n[control]\nset_value_delay_s = 0.15\n", 0.15),
    (
        "filtered and delayed",
        "base = 'default'\n[control]\nset_value_filter_s = 0.1\nset_value_delay_s = 0.08\n",
        0.18,
    ),
    ("filtered and late", "base = 'lag-limited'\n[control]\nset_value_filter_s = 0.15\n", 0.15),
];

#[test]
#[ignore = "minutes; in release by .ci/run"]
fn intervals_hold_nine_in_ten_truths_on_every_structure() {
    let mut short = Vec::new();
    let late = LATE.map(|(name, text, late_s)| {
        (name, Parameters::parse(&format!("title = '{name}'\n{text}")).unwrap(), Some(late_s))
    });
    let presets = Parameters::preset_names().map(|name| (name, Parameters::preset(name).unwrap(), None));
    for (preset, parameters, late_s) in presets.chain(late) {
        let (mut claimed, mut covered) = (0, 0);
        let plant = Plant::new(&Arm::sample().unwrap(), parameters).unwrap();
        for (name, job) in [("excite", excitation(&Excitation::minimal())), ("task 1", task(1))] {
            let truth = plant.truth(&middle_rad(&job.plan), 0.0).unwrap();
            let fit = fitted(&[(&job.plan, &run(&plant, &job.plan, &job, 1))]);
            let holding = fit.joints.iter().filter(|joint| joint.model_holds).count();
            print!("{preset}, {name}: holds for {holding} of {};", fit.joints.len());
            for (quantity, found, truth_of) in QUANTITIES {
                let (mut here, mut hit) = (0, 0);
                for joint in &fit.joints {
                    let truth = truth.joints.iter().find(|truth| truth.name == joint.name).unwrap();
                    let number = found(joint);
                    assert!(joint.model_holds || (!number.identified && number.interval.is_none()));
                    if number.identified {
                        let [low, high] = number.interval.unwrap();
                        here += 1;
                        hit += usize::from((low..=high).contains(&truth_of(truth)));
                    }
                }
                if here > 0 {
                    print!(" {quantity} {hit}/{here}");
                }
                (claimed, covered) = (claimed + here, covered + hit);
            }
            let late = fit.joints.iter().map(|joint| joint.set_values_late_s);
            for (number, truth_s) in late.filter(|number| number.identified).zip(late_s.iter().cycle()) {
                let [low, high] = number.interval.unwrap();
                let hit = (low..=high).contains(truth_s);
                print!(" late by {:.3} s {}", number.value.unwrap(), if hit { "+" } else { "-" });
                (claimed, covered) = (claimed + 1, covered + usize::from(hit));
            }
            println!();
        }
        let coverage = f64::from(covered as u32) / f64::from(claimed as u32);
        println!("{preset}: {covered} of {claimed}, {coverage:.3}");
        if coverage < 0.90 {
            short.push(preset);
        }
    }
    assert!(short.is_empty(), "{short:?}");
}
