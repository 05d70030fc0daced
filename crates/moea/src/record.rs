//! What a run was told, to take it up again.

use serde::{Deserialize, Serialize};

use super::Population;

/// All values that a [`Run`](super::Run) was told, to be kept in any format of serde.
///
/// The run is taken up by telling the same values again: its state is a function of them and of the
/// settings. Takes eight bytes an objective and violation; no evaluation is made again. A checksum a generation tells
/// values that were damaged on the way.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Record {
    batches: Vec<Batch>,
    /// Knows the members again that were asked for next; none if the run was over.
    next: Option<u64>,
}

/// The members of one question.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Batch {
    /// Knows the members again.
    print: u64,
    /// Bits of objectives, total violation and violations of single constraints of each,
    /// `[n][objectives + 1 + constraints]`: no format loses a digit of them, or what is no number.
    values: Vec<u64>,
    /// Of the values. Records of before there were checksums have none, and are read from formats that name fields.
    #[serde(default)]
    checksum: Option<u64>,
}

/// FNV-1a of 64 bits over the bytes of the values, the lowest first: any single bit changes it.
fn checksum(values: &[u64]) -> u64 {
    values.iter().flat_map(|value| value.to_le_bytes()).fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

impl Record {
    pub(super) fn batches(&self) -> &[Batch] {
        &self.batches
    }

    pub(super) fn push(&mut self, asked: &Population, told: &Told) {
        let (m, n) = (asked.objectives(), asked.len());
        let c = told.each.len() / n.max(1);
        let mut values = Vec::with_capacity(n * (m + 1 + c));
        for (i, violation) in told.violations.iter().enumerate() {
            let member = told.f[i * m..][..m].iter().chain([violation]).chain(&told.each[i * c..][..c]);
            values.extend(member.map(|v| v.to_bits()));
        }
        let checksum = Some(checksum(&values));
        self.batches.push(Batch { print: asked.print(), values, checksum });
    }

    /// Notes the members asked for after the last values told.
    pub(super) fn ask_next(&mut self, asked: &Population) {
        self.next = (!asked.is_empty()).then(|| asked.print());
    }

    /// Whether both runs go on with the same members, unless one of them is over.
    pub(super) fn goes_on_as(&self, other: &Self) -> bool {
        self.next.zip(other.next).is_none_or(|(own, other)| own == other)
    }
}

/// Values of the members of one question: objectives `[n][objectives]`, total violations `[n]` and those of single
/// constraints `[n][constraints]`.
#[derive(Debug, Clone, Default)]
pub(super) struct Told {
    pub(super) f: Vec<f64>,
    pub(super) violations: Vec<f64>,
    pub(super) each: Vec<f64>,
}

impl Batch {
    /// Whether the values are those that were told, as far as a checksum knows.
    pub(super) fn is_sound(&self) -> bool {
        self.checksum.is_none_or(|sum| sum == checksum(&self.values))
    }

    /// What was told; none if it is of other members than those asked for.
    pub(super) fn values(&self, asked: &Population) -> Option<Told> {
        let (m, n) = (asked.objectives(), asked.len());
        let width = self.values.len() / n.max(1);
        if self.print != asked.print() || width <= m || self.values.len() != n * width {
            return None;
        }
        let mut told = Told::default();
        for member in self.values.chunks_exact(width) {
            let number = |&bits: &u64| f64::from_bits(bits);
            told.f.extend(member[..m].iter().map(number));
            told.violations.push(f64::from_bits(member[m]));
            told.each.extend(member[m + 1..].iter().map(number));
        }
        Some(told)
    }
}
