//! The studies and the built binary.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::float_cmp)]

mod moea;
mod plan;
mod quality;
mod readme;

use std::process::{Command, Output};

use hydrotrace_bench::study::{Entrant, Inputs};

/// Runs the binary.
fn bench(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hydrotrace-bench")).args(args).output().unwrap()
}

fn stdout(run: &Output) -> String {
    String::from_utf8(run.stdout.clone()).unwrap()
}

fn stderr(run: &Output) -> String {
    String::from_utf8(run.stderr.clone()).unwrap()
}

/// Algorithms by name and budgets, three seeds from 5, on nothing yet.
fn shared(algorithms: &[&str], evaluations: &[u64]) -> Inputs<()> {
    let find = |name: &&str| Entrant::from(::moea::NamedAlgorithm::find(name).unwrap());
    Inputs {
        baseline: "nsga3".to_owned(),
        subjects: Vec::new(),
        entrants: algorithms.iter().map(find).collect(),
        evaluations: evaluations.to_vec(),
        first_seed: 5,
        seeds: 3,
        steps: 4,
        fronts: true,
        settings: std::collections::BTreeMap::new(),
        notes: Vec::new(),
    }
}

/// The same findings for any number of threads.
fn is_the_same_on_any_number_of_threads(rendered: impl Fn() -> Vec<String> + Sync + Send) {
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(&rendered)
    };
    let one = with(1);
    for threads in [2, 5] {
        assert!(with(threads) == one, "{threads} threads differ");
    }
}
