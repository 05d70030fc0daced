//! Time of one evaluation of a plan of seven key points and six joints, every limit judged; of
//! `benches/plan_peers.py` the same with SciPy and Pinocchio.

use divan::{Bencher, black_box};
use hydrotrace::{
    arm::Arm,
    plan::{Evaluator, Setup},
    task::Task,
};

fn main() {
    divan::main();
}

fn simulation() -> Option<Setup> {
    let task = Task::parse(include_str!("../sample-logs/tasks/simulation.toml")).ok()?;
    Setup::new(&task, Arm::sample().ok()?).ok()
}

/// Times of movement of the paper's plans A (near several limits) and B, and of one that breaks many.
const PLANS: [(&str, [f64; 6]); 3] = [
    ("A", [2.01, 1.76, 2.02, 0.74, 2.32, 1.63]),
    ("B", [3.51, 3.83, 3.57, 2.4, 2.01, 3.62]),
    ("broken", [1.0, 1.6, 1.3, 0.7, 1.6, 1.2]),
];

#[divan::bench(args = PLANS.map(|plan| plan.0))]
fn evaluation(bencher: Bencher, name: &str) {
    let (Some(setup), Some((_, interval_s))) = (simulation(), PLANS.into_iter().find(|plan| plan.0 == name))
    else {
        return;
    };
    let mut evaluator = Evaluator::new(&setup);
    bencher.bench_local(|| {
        let objectives = evaluator.evaluate(&setup, black_box(&interval_s));
        (objectives, evaluator.violation())
    });
}
