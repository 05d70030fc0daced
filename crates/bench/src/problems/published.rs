//! What the paper prints of its comparison.

use crate::study::Published;

/// The paper's Table 1: problem, algorithm, mean and spread. It names no budget.
const TABLE_1: [(&str, &str, f64, f64); 8] = [
    ("DTLZ3", "nsga3-fo", 341.3, 25.3),
    ("DTLZ3", "nsga3", 343.9, 24.9),
    ("DTLZ3", "moead", 387.1, 23.8),
    ("DTLZ3", "msops2", 352.4, 28.0),
    ("WFG3", "nsga3-fo", 0.6087, 0.028),
    ("WFG3", "nsga3", 0.6122, 0.038),
    ("WFG3", "moead", 0.6932, 0.051),
    ("WFG3", "msops2", 0.7547, 0.048),
];

/// The entry of the paper's Table 1.
pub(super) fn table_1(problem: &str, algorithm: &str) -> Option<Published> {
    TABLE_1
        .iter()
        .find(|row| (row.0, row.1) == (problem, algorithm))
        .map(|&(_, _, mean, spread)| Published::Table1 { mean, spread })
}

const CLOSE: &str = "close to the other two";
const NONE_YET: &str = "no effective solutions yet";
const NEAR: &str = "near its end";

/// Problem, algorithm, evaluations, words, figure.
const FIGURE_3: [(&str, &str, u64, &str, Option<f64>); 11] = [
    ("DTLZ3", "nsga3-fo", 20_000, "ahead of all", None),
    ("DTLZ3", "nsga3", 20_000, NONE_YET, Some(0.030)),
    ("DTLZ3", "moead", 20_000, NONE_YET, Some(0.064)),
    ("DTLZ3", "msops2", 20_000, "63.6 % of NSGA-III-FO", Some(0.097)),
    ("DTLZ3", "nsga3-fo", 50_000, CLOSE, None),
    ("DTLZ3", "nsga3", 50_000, CLOSE, Some(0.542)),
    ("DTLZ3", "moead", 50_000, "not yet converged", Some(0.533)),
    ("DTLZ3", "msops2", 50_000, CLOSE, Some(0.535)),
    ("WFG3", "nsga3-fo", 10_000, NEAR, None),
    ("WFG3", "nsga3", 10_000, NEAR, None),
    ("WFG3", "msops2", 10_000, NEAR, None),
];

/// What is known of Figure 3 there.
pub(super) fn figure_3(problem: &str, algorithm: &str, evaluations: u64) -> Option<Published> {
    FIGURE_3.iter().find(|row| (row.0, row.1, row.2) == (problem, algorithm, evaluations)).map(
        |&(_, _, _, said, platemo_defaults)| Published::Figure3 { said: said.to_owned(), platemo_defaults },
    )
}
