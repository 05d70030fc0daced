//! The best of a whole run.

use super::{Population, sorting::dominates};

/// Members that room is made for at once.
const ROOM: usize = 1 << 12;

/// Feasible solutions of those offered to it, none of which dominates another, at most `capacity` of them.
///
/// When it overflows, solutions whose nearest neighbour in normalised objectives is closest go
/// first; the best of each objective always stays. What has gone no longer keeps out what it dominates: a member may be dominated by one
/// that was offered and is no more.
#[derive(Debug, Clone, PartialEq)]
pub struct Archive {
    kept: Population,
    spare: Population,
    capacity: usize,
}

impl Archive {
    /// An empty archive.
    pub fn new(variables: usize, objectives: usize, capacity: usize) -> Self {
        // Twice as many are held between two clearings.
        let capacity = capacity.max(objectives).min(usize::MAX / 2);
        let room = capacity.min(ROOM) * 2;
        Self {
            kept: Population::with_capacity(variables, objectives, room),
            spare: Population::with_capacity(variables, objectives, room),
            capacity,
        }
    }

    /// What is kept now; up to twice the capacity between two clearings.
    pub fn population(&self) -> &Population {
        &self.kept
    }

    /// What is kept, at most the capacity.
    pub fn into_population(mut self) -> Population {
        if self.kept.len() > self.capacity {
            self.thin();
        }
        self.kept
    }

    /// Offers every member; none of another shape. O(members x kept).
    pub fn extend(&mut self, members: &Population) {
        let shape = |of: &Population| (of.variables(), of.objectives());
        if shape(members) != shape(&self.kept) {
            return;
        }
        for i in 0..members.len() {
            if members.is_feasible(i) {
                self.offer(members, i);
            }
        }
    }

    fn offer(&mut self, members: &Population, i: usize) {
        let f = members.f(i);
        let mut beaten = false;
        for kept in 0..self.kept.len() {
            let other = self.kept.f(kept);
            if other == f || dominates(other, f) {
                return;
            }
            beaten |= dominates(f, other);
        }
        if beaten {
            self.spare.clear();
            for kept in 0..self.kept.len() {
                if !dominates(f, self.kept.f(kept)) {
                    self.spare.push_from(&self.kept, kept);
                }
            }
            std::mem::swap(&mut self.kept, &mut self.spare);
        }
        self.kept.push_from(members, i);
        if self.kept.len() >= 2 * self.capacity {
            self.thin();
        }
    }

    /// Drops the most crowded until the capacity is met: of the two closest solutions one at a
    /// time. O(n²) once, O(n) per solution dropped on average.
    fn thin(&mut self) {
        let (n, m) = (self.kept.len(), self.kept.objectives());
        let mut scale = Vec::with_capacity(m);
        let mut protected = vec![false; n];
        for k in 0..m {
            let best = (0..n).min_by(|&a, &b| self.kept.f(a)[k].total_cmp(&self.kept.f(b)[k]));
            if let Some(best) = best {
                protected[best] = true;
            }
            let values = || (0..n).map(|i| self.kept.f(i)[k]);
            scale.push((values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max)));
        }
        let apart = |a: usize, b: usize| -> f64 {
            let squares = scale.iter().enumerate().map(|(k, &(low, high))| {
                let span = if high > low { high - low } else { 1.0 };
                ((self.kept.f(a)[k] - self.kept.f(b)[k]) / span).powi(2)
            });
            squares.sum()
        };
        let mut alive = vec![true; n];
        let nearest = |i: usize, alive: &[bool]| {
            (0..n)
                .filter(|&j| j != i && alive[j])
                .map(|j| (apart(i, j), j))
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .unwrap_or((f64::INFINITY, i))
        };
        let mut near: Vec<(f64, usize)> = (0..n).map(|i| nearest(i, &alive)).collect();
        for _ in self.capacity..n {
            let closest = (0..n)
                .filter(|&i| alive[i] && !protected[i])
                .min_by(|&a, &b| near[a].0.total_cmp(&near[b].0));
            let Some(gone) = closest else { break };
            alive[gone] = false;
            for i in 0..n {
                if alive[i] && near[i].1 == gone {
                    near[i] = nearest(i, &alive);
                }
            }
        }
        self.spare.clear();
        for i in (0..n).filter(|&i| alive[i]) {
            self.spare.push_from(&self.kept, i);
        }
        std::mem::swap(&mut self.kept, &mut self.spare);
    }
}
