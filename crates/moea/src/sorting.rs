//! Non-dominated sorting.
//!
//! Members are visited in lexicographic order of their objectives, so that nobody is
//! dominated by a later one (Zhang, Tian, Cheng and Jin 2015, doi 10.1109/TEVC.2014.2308305).

use super::Population;

/// Fronts of feasible members, with memory that is kept from call to call.
#[derive(Debug, Clone, Default)]
pub struct Sorting {
    order: Vec<usize>,
    /// Objectives of the members placed so far, front by front.
    placed: Vec<Vec<f64>>,
    fronts: Vec<Vec<usize>>,
    used: usize,
}

/// Whether `a` dominates `b`: nowhere worse and somewhere better.
pub fn dominates(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| a <= b) && a.iter().zip(b).any(|(a, b)| a < b)
}

impl Sorting {
    /// Sorts the given members into fronts by objectives alone; members with equal objectives
    /// share a front. Members that the population has not are left out.
    pub fn sort(&mut self, population: &Population, members: &[usize]) {
        for front in &mut self.fronts[..self.used] {
            front.clear();
        }
        for placed in &mut self.placed[..self.used] {
            placed.clear();
        }
        self.used = 0;
        self.order.clear();
        self.order.extend(members.iter().filter(|i| **i < population.len()));
        let m = population.objectives();
        self.order.sort_unstable_by(|&a, &b| {
            let (fa, fb) = (population.f(a), population.f(b));
            for k in 0..m {
                match fa[k].total_cmp(&fb[k]) {
                    std::cmp::Ordering::Equal => {}
                    unequal => return unequal,
                }
            }
            a.cmp(&b)
        });
        for place in 0..self.order.len() {
            let i = self.order[place];
            let f = population.f(i);
            let rank = match *f {
                // The last of each front has the least second objective, and none less than that of a better front.
                [f0, f1] => self.placed[..self.used].partition_point(
                    |placed| matches!(placed[..], [.., a0, a1] if a1 <= f1 && (a1 < f1 || a0 < f0)),
                ),
                _ => (0..self.used)
                    .find(|&rank| !dominated_by_earlier(&self.placed[rank], f))
                    .unwrap_or(self.used),
            };
            if rank == self.used {
                self.used += 1;
                if self.fronts.len() < self.used {
                    self.fronts.push(Vec::new());
                    self.placed.push(Vec::new());
                }
            }
            self.fronts[rank].push(i);
            self.placed[rank].extend_from_slice(f);
        }
    }

    /// Number of fronts.
    pub fn count(&self) -> usize {
        self.used
    }

    /// Members of one front, in lexicographic order of objectives; empty beyond the last.
    pub fn front(&self, rank: usize) -> &[usize] {
        if rank < self.used { &self.fronts[rank] } else { &[] }
    }
}

impl Population {
    /// Members that are feasible and dominated by no feasible member, in order.
    /// O(n log n) comparisons of members for two objectives; for more, O(n²) where many are in one front.
    pub fn front(&self) -> Vec<usize> {
        let feasible: Vec<usize> = (0..self.len()).filter(|&i| self.is_feasible(i)).collect();
        let mut sorting = Sorting::default();
        sorting.sort(self, &feasible);
        let mut first = sorting.front(0).to_vec();
        first.sort_unstable();
        first
    }
}

/// Whether a member placed before `f` dominates it; the first objective of all of them is no
/// worse by the order of visits. Later ones are closer and asked first.
fn dominated_by_earlier(placed: &[f64], f: &[f64]) -> bool {
    match *f {
        [f0, f1, f2] => {
            placed.rchunks_exact(3).any(|a| a[1] <= f1 && a[2] <= f2 && (a[1] < f1 || a[2] < f2 || a[0] < f0))
        }
        _ => placed.rchunks_exact(f.len().max(1)).any(|a| dominates(a, f)),
    }
}
