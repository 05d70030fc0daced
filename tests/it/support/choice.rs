//! The chosen plan under a ceiling, against the best that any of several searches finds under it.

use std::ops::ControlFlow;

use hydrotrace::{
    arm::Arm,
    moea::Budget,
    plan::{Rule, Search, Setup, Timing, choose, search},
    task::{Ceilings, Objective, Task},
};

pub(crate) const TASKS: [(&str, &str); 3] = [
    ("simulation", include_str!("../../../sample-logs/tasks/simulation.toml")),
    ("task 1", include_str!("../../../sample-logs/tasks/task-1.toml")),
    ("task 2", include_str!("../../../sample-logs/tasks/task-2.toml")),
];
/// The best of a rule, under a ceiling on another objective.
const RULES: [(Objective, Objective); 3] = [
    (Objective::Duration, Objective::RmsJerk),
    (Objective::RmsJerk, Objective::Duration),
    (Objective::RmsPower, Objective::Duration),
];
/// A seed and the evaluations of its search.
pub(crate) type Seed = (u64, u64);

/// No choice of the judged seeds is a thousandth above the best of all under any of so many ceilings.
pub(crate) fn no_choice_is_above_the_best(
    tasks: &[(&str, &str)],
    ceilings: usize,
    (judged, others): (&[Seed], &[Seed]),
) {
    for (name, text) in tasks {
        let setup = Setup::new(&Task::parse(text).unwrap(), Arm::sample().unwrap()).unwrap();
        let front = |&(seed, evaluations): &Seed| -> Vec<Timing> {
            let settings = Search { budget: Budget::Evaluations(evaluations), seed, ..Search::default() };
            search(&setup, &settings, |_| ControlFlow::Continue(())).unwrap().front
        };
        let fronts: Vec<Vec<Timing>> = judged.iter().chain(others).map(front).collect();
        for (sought, held) in RULES {
            let all = || fronts.iter().flatten().map(|timing| timing.objectives[held]);
            let (least, most) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
            let (mut worst, mut beyond) = (0.0_f64, 0);
            for i in 0..ceilings {
                // From just above the least of the other objective on.
                let ceiling = 1.01 * least * (most / least).powf(i as f64 / ceilings as f64);
                let ceilings = Ceilings::NONE.with(held, ceiling);
                let chosen = |front: &Vec<Timing>| {
                    let found = choose(&setup, front, &ceilings, (Rule::Best(sought), None)).unwrap();
                    assert!(found.timing.objectives.within(&ceilings), "{name}: {ceiling}");
                    found.timing.objectives[sought]
                };
                let found: Vec<f64> = fronts.iter().map(chosen).collect();
                let optimum = found.iter().copied().fold(f64::INFINITY, f64::min);
                for own in &found[..judged.len()] {
                    worst = worst.max(own / optimum - 1.0);
                    beyond += usize::from(own / optimum > 1.001);
                }
            }
            println!(
                "{name}, {sought:?} under {held:?}: {:.4} % above the best at most, {beyond} beyond",
                100.0 * worst
            );
            assert_eq!(beyond, 0, "{name}, {sought:?} under {held:?}: {:.3} %", 100.0 * worst);
        }
    }
}
