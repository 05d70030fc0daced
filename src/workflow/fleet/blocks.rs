//! Blocks of runs whose starts tell nothing of one another: a new plan has other starts than the one before, so how the levels of the two
//! lie to one another is not in them.

use std::collections::BTreeSet;

/// Plans that follow one another so often take turns: from run to run their levels tell one another.
const TURNS: usize = 8;
/// Runs on both sides of an instant within blocks, as if so many before and as many after were of one: three, as of a step.
const TELL: f64 = 1.5;

/// The block of each run, from 0 on in the order of time: runs of one share starts, by others or directly, or their plans take turns. A
/// run without values is of the first. Starts are rows by run; NaN: no value.
pub(super) fn blocks(rows: &[Vec<f64>], runs: usize) -> Vec<usize> {
    let mut of: Vec<usize> = (0..runs).collect();
    let mut known = vec![false; runs];
    for row in rows {
        let here: Vec<usize> = (0..runs).filter(|run| row.get(*run).is_some_and(|v| v.is_finite())).collect();
        for run in &here {
            known[*run] = true;
        }
        let joined = here.iter().map(|run| of[*run]).collect();
        join(&mut of, &joined);
    }
    let told: Vec<usize> = (0..runs).filter(|run| known[*run]).collect();
    let each = |of: &[usize]| told.iter().map(|run| of[*run]).collect::<BTreeSet<usize>>();
    let plans = each(&of);
    for first in &plans {
        for second in plans.range(first + 1..) {
            let both = BTreeSet::from([of[*first], of[*second]]);
            let order: Vec<usize> =
                told.iter().map(|run| of[*run]).filter(|own| both.contains(own)).collect();
            if order.windows(2).filter(|two| two[0] != two[1]).count() >= TURNS {
                join(&mut of, &both);
            }
        }
    }
    let left: Vec<usize> = each(&of).into_iter().collect();
    of.iter().map(|own| left.iter().position(|block| block == own).unwrap_or(0)).collect()
}

/// Makes some blocks the least of them.
fn join(of: &mut [usize], blocks: &BTreeSet<usize>) {
    let Some(least) = blocks.first() else { return };
    for own in of.iter_mut().filter(|own| blocks.contains(own)) {
        *own = *least;
    }
}

/// How many blocks there are.
pub(super) fn count(blocks: &[usize]) -> usize {
    blocks.iter().max().map_or(0, |last| last + 1)
}

/// Values less the mean of their block.
pub(super) fn centred(values: &[f64], blocks: &[usize]) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); count(blocks)];
    for (value, block) in values.iter().zip(blocks) {
        let (sum, number) = &mut sums[*block];
        *sum += value;
        *number += 1.0;
    }
    values.iter().zip(blocks).map(|(value, block)| value - sums[*block].0 / sums[*block].1).collect()
}

/// Whether what the runs before one and those from it on differ by is told within blocks.
pub(super) fn tell_step(blocks: &[usize], at: usize) -> bool {
    let after: Vec<f64> = (0..blocks.len()).map(|run| if run < at { 0.0 } else { 1.0 }).collect();
    centred(&after, blocks).iter().map(|x| x * x).sum::<f64>() >= TELL - 1e-9
}

/// The first runs of blocks at which a step cannot be told.
pub(super) fn borders(blocks: &[usize]) -> Vec<usize> {
    (1..blocks.len()).filter(|at| blocks[at - 1] != blocks[*at] && !tell_step(blocks, *at)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two starts of each plan, by run.
    fn rows(plans: &[usize]) -> Vec<Vec<f64>> {
        let row = |own: usize| plans.iter().map(|plan| if *plan == own { 1.0 } else { f64::NAN }).collect();
        (0..6).map(|start| row(start / 2)).collect()
    }

    #[test]
    fn a_plan_after_another_is_a_block_and_plans_in_turns_are_one() {
        let of = |plans: &[usize]| blocks(&rows(plans), plans.len());
        assert_eq!(of(&[0, 0, 0, 1, 1, 1]), [0, 0, 0, 1, 1, 1]);
        assert_eq!(borders(&of(&[0, 0, 0, 1, 1, 1])), [3]);
        assert_eq!(of(&[0, 1, 0, 1, 0, 1, 0, 1, 0, 1]), [0; 10]);
        // What is between two runs of one plan is another block, and these tell whether the level changed.
        let back = of(&[0, 0, 0, 1, 1, 1, 0, 0, 0]);
        assert_eq!(back, [0, 0, 0, 1, 1, 1, 0, 0, 0]);
        assert!(borders(&back).is_empty());
        // A start that is in both joins them.
        let mut shared = rows(&[0, 0, 0, 1, 1, 1]);
        shared.push(vec![2.0; 6]);
        assert_eq!(blocks(&shared, 6), [0; 6]);
    }
}
