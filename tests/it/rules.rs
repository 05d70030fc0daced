//! Rules of the replay that no caller would give.

use std::slice::from_ref;

use hydrotrace::replay::{Rules, replay};
use hydrotrace_bench::detector::{Sensing, synthetic_run};

/// Each number of the rules in turn, as a caller or a file may have it.
#[test]
fn no_rule_out_of_range_is_a_panic() {
    let run = synthetic_run(3, &Sensing { sigma_rad: 0.0, delay_s: 0.2, ..Sensing::default() }).pair;
    let all = serde_json::to_value(Rules::default()).unwrap();
    let (mut tried, mut broken) = (0, Vec::new());
    let mut with = |path: &[&str], value: f64| {
        let mut rules = all.clone();
        let at = path.iter().fold(&mut rules, |at, key| &mut at[*key]);
        *at = if at.is_u64() { serde_json::json!(value.abs() as u64) } else { serde_json::json!(value) };
        let rules: Rules = serde_json::from_value(rules).unwrap();
        let calm = std::panic::catch_unwind(|| replay(from_ref(&run), &rules)).is_ok();
        broken.extend((!calm).then(|| format!("{path:?} = {value:e}")));
        tried += 1;
    };
    for (key, value) in all.as_object().unwrap() {
        let inner: Vec<&str> =
            value.as_object().into_iter().flatten().map(|(inner, _)| inner.as_str()).collect();
        let paths = if inner.is_empty() {
            vec![vec![key.as_str()]]
        } else {
            inner.iter().map(|own| vec![key.as_str(), own]).collect()
        };
        for path in paths {
            for value in [-1e300, -1.0, 0.0, 1e-12, 1.0, 1e12, 1e300] {
                with(&path, value);
            }
        }
    }
    assert!(tried > 250 && broken.is_empty(), "{tried}, {broken:?}");
}
