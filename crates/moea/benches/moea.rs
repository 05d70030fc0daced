//! Evaluations per CPU second of whole runs on one core: DTLZ2, three objectives, 92 members, 19 964
//! evaluations, as a plain table. `moea_peers.py` does the same with pymoo and pagmo2.

use std::sync::LazyLock;
use std::time::Instant;

use moea::{Algorithm, Budget, Settings, benchmark::Benchmark, indicator::igd, optimise, silent};

const REPEATS: u64 = 31;

fn main() {
    let Some(problem) = Benchmark::named("DTLZ2", 3) else { return };
    let front = problem.front(91);
    for (name, algorithm) in [
        ("NSGA-III", Algorithm::Nsga3),
        ("NSGA-III-FO", Algorithm::NSGA3_FO),
        ("NSGA-II", Algorithm::Nsga2),
        ("MOEA/D", Algorithm::Moead { normalized: false }),
        ("MSOPS-II", Algorithm::Msops2),
    ] {
        let (mut rates, mut quality) = (Vec::new(), Vec::new());
        for seed in 1..=REPEATS {
            let settings =
                Settings { algorithm, seed, budget: Budget::Evaluations(217 * 92), ..Settings::default() };
            let start = cpu_s();
            let Ok(run) = optimise(&problem, &settings, silent) else { return };
            rates.push(run.evaluations as f64 / (cpu_s() - start));
            quality.push(igd(run.population.all_f(), &front, 3));
        }
        println!("{name:12} {:>10.0} evaluations/s   IGD {:.2e}", median(rates), median(quality));
    }
}

/// Time this thread has run, s; wall time where Linux does not tell, which is only as good as
/// the machine is idle.
fn cpu_s() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    let running_ns = std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
    running_ns.map_or_else(|| START.elapsed().as_secs_f64(), |ns| 1e-9 * ns)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}
