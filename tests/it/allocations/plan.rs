//! Evaluations of plans allocate nothing.

use hydrotrace::{
    arm::Arm,
    plan::{Evaluator, Setup},
    task::{Objective, Task},
};

#[test]
fn after_the_first_evaluation_none_allocates() {
    let task = Task::parse(include_str!("../../../sample-logs/tasks/task-1.toml")).unwrap();
    let setup = Setup::new(&task, Arm::sample().unwrap()).unwrap();
    let mut evaluator = Evaluator::new(&setup);
    let fast = [2.4, 2.8, 1.9, 2.1, 1.2];
    evaluator.evaluate(&setup, &fast).unwrap();
    let counted = allocation_counter::measure(|| {
        for slower in 1..50 {
            let interval_s = fast.map(|s| s * (1.0 + 0.02 * f64::from(slower)));
            assert!(evaluator.evaluate(&setup, &interval_s).unwrap()[Objective::Duration] > 12.0);
        }
    });
    assert_eq!(counted.count_total, 0);
}
