//! What a run was told, to take it up again.

use serde::{Deserialize, Serialize};

use super::Population;

/// All values that a [`Run`](super::Run) was told, to be kept in any format of serde.
///
/// The run is taken up by telling the same values again: its state is a function of them and of the
/// settings. Takes eight bytes an objective and violation; no evaluation is made again.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Record {
    batches: Vec<Batch>,
}

/// The members of one question.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Batch {
    /// Knows the members again.
    print: u64,
    /// Bits of objectives and violation of each, `[n][objectives + 1]`: no format loses a digit of them,
    /// or what is no number.
    values: Vec<u64>,
}

impl Record {
    pub(super) fn batches(&self) -> &[Batch] {
        &self.batches
    }

    pub(super) fn push(&mut self, asked: &Population, f: &[f64], violations: &[f64]) {
        let m = asked.objectives().max(1);
        let members = f.chunks_exact(m).zip(violations);
        let values = members.flat_map(|(f, violation)| f.iter().chain([violation]).map(|v| v.to_bits()));
        self.batches.push(Batch { print: asked.print(), values: values.collect() });
    }
}

impl Batch {
    /// Objectives and violations; none if they are of other members than those asked for.
    pub(super) fn values(&self, asked: &Population) -> Option<(Vec<f64>, Vec<f64>)> {
        let m = asked.objectives();
        if self.print != asked.print() || self.values.len() != asked.len() * (m + 1) {
            return None;
        }
        let (mut f, mut violations) = (Vec::new(), Vec::new());
        for member in self.values.chunks_exact(m + 1) {
            f.extend(member[..m].iter().map(|&bits| f64::from_bits(bits)));
            violations.push(f64::from_bits(member[m]));
        }
        Some((f, violations))
    }
}
