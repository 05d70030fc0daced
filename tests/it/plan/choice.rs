//! The chosen plan under a ceiling, against the best that any of several searches finds under it.

use std::ops::ControlFlow;

use hydrotrace::{
    arm::Arm,
    moea::Budget,
    plan::{Rule, Search, Setup, Timing, choose, search},
    task::{Ceilings, Objective, Task},
};

const TASKS: [(&str, &str); 3] = [
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
const CEILINGS: usize = 40;
/// Seeds that are judged, and evaluations of their searches; the others only help to find the optimum.
const JUDGED: u64 = 2;
const SEEDS: [(u64, u64); 5] = [(1, 5000), (2, 5000), (3, 20_000), (4, 20_000), (5, 20_000)];

#[test]
fn no_choice_under_a_ceiling_is_a_thousandth_above_the_best_of_five_searches() {
    for (name, text) in TASKS {
        let setup = Setup::new(&Task::parse(text).unwrap(), Arm::sample().unwrap()).unwrap();
        let front = |(seed, evaluations)| -> Vec<Timing> {
            let settings = Search { budget: Budget::Evaluations(evaluations), seed, ..Search::default() };
            search(&setup, &settings, |_| ControlFlow::Continue(())).unwrap().front
        };
        let fronts: Vec<Vec<Timing>> = SEEDS.into_iter().map(front).collect();
        for (sought, held) in RULES {
            let all = || fronts.iter().flatten().map(|timing| timing.objectives[held]);
            let (least, most) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
            let (mut worst, mut beyond) = (0.0_f64, 0);
            for i in 0..CEILINGS {
                // From just above the least of the other objective on.
                let ceiling = 1.01 * least * (most / least).powf(i as f64 / CEILINGS as f64);
                let ceilings = Ceilings::NONE.with(held, ceiling);
                let chosen = |front: &Vec<Timing>| {
                    let found = choose(&setup, front, &ceilings, (Rule::Best(sought), None)).unwrap();
                    assert!(found.timing.objectives.within(&ceilings), "{name}: {ceiling}");
                    found.timing.objectives[sought]
                };
                let found: Vec<f64> = fronts.iter().map(chosen).collect();
                let optimum = found.iter().copied().fold(f64::INFINITY, f64::min);
                for own in &found[..JUDGED as usize] {
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
