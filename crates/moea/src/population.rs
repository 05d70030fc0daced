//! Solutions in flat arrays.

/// Solutions with their objectives and violations, `[n]` of each, in flat arrays.
///
/// Objectives of a member whose violation is infinite are meaningless: it could not be
/// evaluated.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Population {
    variables: usize,
    objectives: usize,
    x: Vec<f64>,
    f: Vec<f64>,
    violation: Vec<f64>,
    fingerprint: Vec<u64>,
    parts: Parts,
}

/// What the total violation of each member is made of, `[n][1 + constraints]`: a total without constraints, and the
/// violation of each. Of no width if no constraint is told one by one; no property of members that they are equal by.
#[derive(Debug, Clone, Default)]
struct Parts {
    width: usize,
    flat: Vec<f64>,
}

impl PartialEq for Parts {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Parts {
    /// Adds a member of which only the total is known.
    fn push_total(&mut self, total: f64) {
        if self.width > 0 {
            self.flat.push(total);
            self.flat.resize(self.flat.len() + self.width - 1, 0.0);
        }
    }
}

/// Numbers that room is made for at most before there are any.
const MOST_ROOM: usize = 1 << 20;

/// Row `i` of `[n][width]`; empty if there is none.
fn row(flat: &[f64], i: usize, width: usize) -> &[f64] {
    let start = i.saturating_mul(width);
    flat.get(start..start.saturating_add(width)).unwrap_or_default()
}

impl Population {
    /// An empty population with room for `capacity` members.
    pub fn with_capacity(variables: usize, objectives: usize, capacity: usize) -> Self {
        let room = |each: usize| each.saturating_mul(capacity).min(MOST_ROOM);
        Self {
            variables,
            objectives,
            x: Vec::with_capacity(room(variables)),
            f: Vec::with_capacity(room(objectives)),
            violation: Vec::with_capacity(room(1)),
            fingerprint: Vec::with_capacity(room(1)),
            parts: Parts::default(),
        }
    }

    /// Number of members.
    pub fn len(&self) -> usize {
        self.violation.len()
    }

    /// Whether there is no member.
    pub fn is_empty(&self) -> bool {
        self.violation.is_empty()
    }

    /// Number of variables of a member.
    pub fn variables(&self) -> usize {
        self.variables
    }

    /// Number of objectives of a member.
    pub fn objectives(&self) -> usize {
        self.objectives
    }

    /// Variables of member `i`, `[variables]`; empty if there is none.
    pub fn x(&self, i: usize) -> &[f64] {
        row(&self.x, i, self.variables)
    }

    /// Objectives of member `i`, `[objectives]`; empty if there is none.
    pub fn f(&self, i: usize) -> &[f64] {
        row(&self.f, i, self.objectives)
    }

    /// Total violation of constraints of member `i`, 0 if feasible; infinite if there is none.
    pub fn violation(&self, i: usize) -> f64 {
        self.violation.get(i).copied().unwrap_or(f64::INFINITY)
    }

    /// Whether member `i` violates nothing.
    pub fn is_feasible(&self, i: usize) -> bool {
        self.violation(i) <= 0.0
    }

    /// Variables of all members, `[n][variables]` in one slice.
    pub fn all_x(&self) -> &[f64] {
        &self.x
    }

    /// Objectives of all members, `[n][objectives]` in one slice.
    pub fn all_f(&self) -> &[f64] {
        &self.f
    }

    /// Feasible members of which only the objectives are known, `[n][objectives]` in one slice. Zeros lose their sign.
    pub fn from_objectives(f: &[f64], objectives: usize) -> Self {
        let n = f.len() / objectives.max(1);
        let f = f[..n * objectives].iter().map(|f| f + 0.0).collect();
        let (x, violation, fingerprint) = (Vec::new(), vec![0.0; n], vec![0; n]);
        Self { variables: 0, objectives, x, f, violation, fingerprint, parts: Parts::default() }
    }

    /// Adds a member that has been evaluated: `x` `[variables]`, `f` `[objectives]`. One of another
    /// shape is left out; a violation that is no number is infinite, and zeros of objectives lose their sign. Objectives that are no number
    /// are taken as they are: a problem that is evaluated makes such a member the worst.
    pub fn push(&mut self, x: &[f64], f: &[f64], violation: f64) {
        if x.len() == self.variables && f.len() == self.objectives {
            self.x.extend_from_slice(x);
            self.f.extend(f.iter().map(|f| f + 0.0));
            self.violation.push(if violation.is_nan() { f64::INFINITY } else { violation });
            self.fingerprint.push(fingerprint(x));
            self.parts.push_total(self.violation.last().copied().unwrap_or_default());
        }
    }

    pub(super) fn clear(&mut self) {
        self.x.clear();
        self.f.clear();
        self.violation.clear();
        self.fingerprint.clear();
        self.parts.flat.clear();
    }

    /// Adds a member that is still to be evaluated; what its total is made of is told of all members at once.
    pub(super) fn push_x(&mut self, x: &[f64]) {
        self.x.extend_from_slice(x);
        self.f.resize(self.f.len() + self.objectives, f64::INFINITY);
        self.violation.push(f64::INFINITY);
        self.fingerprint.push(fingerprint(x));
    }

    /// Adds member `i` of another population of the same shape.
    pub(super) fn push_from(&mut self, other: &Self, i: usize) {
        if self.is_empty() {
            self.parts.width = other.parts.width;
        }
        self.x.extend_from_slice(other.x(i));
        self.f.extend_from_slice(other.f(i));
        self.violation.push(other.violation[i]);
        self.fingerprint.push(other.fingerprint[i]);
        match row(&other.parts.flat, i, other.parts.width) {
            parts if parts.len() == self.parts.width => self.parts.flat.extend_from_slice(parts),
            _ => self.parts.push_total(other.violation[i]),
        }
    }

    pub(super) fn append(&mut self, other: &Self) {
        for i in 0..other.len() {
            self.push_from(other, i);
        }
    }

    /// Replaces member `i` by member `j` of `other`.
    pub(super) fn replace(&mut self, i: usize, other: &Self, j: usize) {
        let (d, m, width) = (self.variables, self.objectives, self.parts.width);
        self.x[i * d..][..d].copy_from_slice(other.x(j));
        self.f[i * m..][..m].copy_from_slice(other.f(j));
        self.violation[i] = other.violation[j];
        self.fingerprint[i] = other.fingerprint[j];
        let own = self.parts.flat.chunks_exact_mut(width.max(1)).nth(i);
        own.into_iter()
            .flatten()
            .zip(row(&other.parts.flat, j, width))
            .for_each(|(own, other)| *own = *other);
    }

    /// Notes that the totals are without the violations of single constraints, `[n][constraints]`.
    pub(super) fn divide_totals(&mut self, each: &[f64], constraints: usize) {
        self.parts.width = constraints + 1;
        self.parts.flat.clear();
        for (base, each) in self.violation.iter().zip(each.chunks_exact(constraints.max(1))) {
            self.parts.flat.push(*base);
            self.parts.flat.extend_from_slice(each);
        }
    }

    /// Forms all totals anew from what they are made of: a total without constraints, and the violation of each.
    pub(super) fn retotal(&mut self, total: impl Fn((f64, &[f64])) -> f64) {
        let parts = self.parts.flat.chunks_exact(self.parts.width.max(1));
        for (violation, parts) in self.violation.iter_mut().zip(parts) {
            if let Some((base, each)) = parts.split_first() {
                *violation = total((*base, each));
            }
        }
    }

    /// Whether a member has exactly these variables.
    pub(super) fn contains(&self, x: &[f64]) -> bool {
        let wanted = fingerprint(x);
        self.fingerprint.iter().enumerate().any(|(i, &print)| print == wanted && self.x(i) == x)
    }

    /// A number that other members almost never share.
    pub(super) fn print(&self) -> u64 {
        self.fingerprint
            .iter()
            .fold(0, |hash: u64, &print| (hash ^ print).wrapping_mul(0xff51_afd7_ed55_8ccd))
    }

    /// Variables of all members beside objectives and violations, for an evaluation.
    pub(super) fn evaluation_parts(&mut self) -> (&[f64], &mut [f64], &mut [f64]) {
        (&self.x, &mut self.f, &mut self.violation)
    }
}

/// Equal variables give equal numbers; different ones almost never do.
fn fingerprint(x: &[f64]) -> u64 {
    x.iter().fold(0x9e37_79b9_7f4a_7c15, |hash: u64, v| {
        (hash ^ v.to_bits()).wrapping_mul(0xff51_afd7_ed55_8ccd).rotate_left(29)
    })
}
