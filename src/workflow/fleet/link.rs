//! How blocks of runs that share no start lie to one another, told by the other machines that ran the same plans: what they differ by as
//! well is of the plans, and what is left is of the machine.

use std::collections::BTreeMap;

use super::{
    blocks::count,
    history::{By, Event},
    leveled::{Leveled, Link},
};
use crate::math::{SIGMA_PER_MAD, mad, median};

/// Machines that tell it, at least, beside the one that it is told of.
const FEWEST_MACHINES: usize = 4;
/// The standard error of a median, in that of a mean.
const OF_MEDIAN: f64 = 1.2533;

/// A start of a joint on one machine.
#[derive(Clone, Copy)]
struct Start {
    /// The same on all machines.
    number: usize,
    /// What it is like, in the unit of the joint; of peak errors as logarithms.
    typical: f64,
    block: usize,
    weight: f64,
}

/// What joints are compared as.
type Key<'a> = (&'a str, &'a str, By, Option<i8>);

fn key(joint: &Leveled) -> Key<'_> {
    (&joint.joint, &joint.unit, joint.metric, joint.direction)
}

/// The links of joints with several blocks, in the order of the joints; `None` of one block, or where too few machines tell.
pub(super) fn links(joints: &[Leveled]) -> Vec<Option<Link>> {
    let mut alike: BTreeMap<Key<'_>, Vec<&Leveled>> = BTreeMap::new();
    for joint in joints {
        alike.entry(key(joint)).or_default().push(joint);
    }
    alike.retain(|_, own| own.iter().any(|joint| count(&joint.blocks) > 1));
    let starts: BTreeMap<Key<'_>, BTreeMap<&str, Vec<Start>>> =
        alike.into_iter().map(|(key, own)| (key, numbered(&own))).collect();
    let link = |joint: &Leveled| {
        let machines = starts.get(&key(joint)).filter(|_| count(&joint.blocks) > 1)?;
        let others = machines.iter().filter(|(machine, _)| **machine != joint.machine);
        link(joint, machines.get(joint.machine.as_str())?, others.map(|(_, starts)| starts.as_slice()))
    };
    joints.iter().map(link).collect()
}

/// The starts of each machine in the order of their numbers.
fn numbered<'a>(joints: &[&'a Leveled]) -> BTreeMap<&'a str, Vec<Start>> {
    let mut numbers: BTreeMap<&Event, usize> = BTreeMap::new();
    let mut machines = BTreeMap::new();
    for joint in joints {
        let mut starts = Vec::new();
        for (row, (event, typical)) in joint.starts.iter().enumerate() {
            let next = numbers.len();
            let number = *numbers.entry(event).or_insert(next);
            let (block, weight) = (joint.block_of(row), joint.weights[row]);
            starts.push(Start { number, typical: *typical, block, weight });
        }
        starts.retain(|start| start.typical.is_finite());
        starts.sort_by_key(|start| start.number);
        machines.insert(joint.machine.as_str(), starts);
    }
    machines
}

/// How far each block of a joint lies above the same starts of another machine, from the first block on; NaN where they share none.
fn above(own: &[Start], other: &[Start], blocks: usize) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); blocks];
    let mut others = other.iter().peekable();
    for start in own {
        while others.next_if(|other| other.number < start.number).is_some() {}
        if let Some(other) = others.peek().filter(|other| other.number == start.number) {
            sums[start.block].0 += start.weight * (start.typical - other.typical);
            sums[start.block].1 += start.weight;
        }
    }
    let above: Vec<f64> = sums.iter().map(|(sum, weight)| sum / weight).collect();
    above.iter().map(|own| own - above[0]).collect()
}

fn link<'a>(joint: &Leveled, own: &[Start], others: impl Iterator<Item = &'a [Start]>) -> Option<Link> {
    let blocks = count(&joint.blocks);
    let told: Vec<Vec<f64>> = others.map(|other| above(own, other, blocks)).collect();
    let mut link = Link { above: vec![0.0], error: 0.0 };
    for block in 1..blocks {
        let above: Vec<f64> =
            told.iter().map(|above| above[block]).filter(|above| above.is_finite()).collect();
        if above.len() < FEWEST_MACHINES {
            return None;
        }
        let noise = joint.noise_between([0, block]);
        let spread = (SIGMA_PER_MAD * mad(&above)).max(noise);
        // What machines differ by more than their runs do, this one may, too.
        let more = (spread * spread - noise * noise).max(0.0).sqrt();
        link.error = link.error.max((OF_MEDIAN * spread / (above.len() as f64).sqrt()).hypot(more));
        link.above.push(median(above));
    }
    Some(link)
}
