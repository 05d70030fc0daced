//! Runs in the order in which they were made: a pattern of names gives `run-10` before `run-2`, and the newest counts most.

use super::Inputs;
use crate::{
    log::Recording,
    remark::{Code, Remarks},
    workflow::names::told_apart,
};

/// Runs by when they began, where the stamps of each say a date, and what is said where that is another order.
pub(super) fn in_order(inputs: &Inputs, observed: Vec<Recording>) -> (Inputs, Vec<Recording>, Remarks) {
    let mut doubts = Remarks::default();
    let began: Option<Vec<i64>> = observed.iter().map(|run| run.source.began_ns()).collect();
    let Some(began_ns) = began.filter(|began_ns| !began_ns.is_sorted()) else {
        return (inputs.clone(), observed, doubts);
    };
    let mut places: Vec<usize> = (0..observed.len()).collect();
    places.sort_by_key(|place| began_ns[*place]);
    let names = told_apart(&inputs.logs);
    let order: Vec<&str> = places.iter().map(|place| names[*place].as_str()).collect();
    let message = format!(
        "the runs are given in another order than that in which they began by their stamps: they are taken as {}",
        order.join(", ")
    );
    doubts.add(Code::Reordered, 1, message);
    let logs = places.iter().map(|place| inputs.logs[*place].clone()).collect();
    let mut runs: Vec<(i64, Recording)> = began_ns.into_iter().zip(observed).collect();
    runs.sort_by_key(|(began_ns, _)| *began_ns);
    let observed = runs.into_iter().map(|(_, run)| run).collect();
    (Inputs { logs, ..inputs.clone() }, observed, doubts)
}
