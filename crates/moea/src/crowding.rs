//! Crowding distance of NSGA-II.
//!
//! # References
//!
//! Deb, Pratap, Agarwal and Meyarivan 2002, doi 10.1109/4235.996017.

use super::Population;

/// Measures crowding distances, with memory that is kept from call to call.
#[derive(Debug, Clone, Default)]
pub(super) struct CrowdingDistance {
    order: Vec<usize>,
    /// By member of the population measured last.
    distance: Vec<f64>,
}

impl CrowdingDistance {
    /// Sets the distances of all `n` members of a population to 0.
    pub(super) fn reset(&mut self, n: usize) {
        self.distance.clear();
        self.distance.resize(n, 0.0);
    }

    /// Measures the distances among the members of one front: the sum over the objectives of the gap
    /// between both neighbours, as a share of the front's range; infinite at the ends of an objective.
    pub(super) fn measure(&mut self, population: &Population, front: &[usize]) {
        let distance = &mut self.distance;
        for &i in front {
            distance[i] = 0.0;
        }
        for k in 0..population.objectives() {
            self.order.clear();
            self.order.extend_from_slice(front);
            let value = |i: usize| population.f(i)[k];
            self.order.sort_unstable_by(|&a, &b| value(a).total_cmp(&value(b)).then(a.cmp(&b)));
            let (Some(&first), Some(&last)) = (self.order.first(), self.order.last()) else { return };
            let range = value(last) - value(first);
            distance[first] = f64::INFINITY;
            distance[last] = f64::INFINITY;
            if range > 0.0 {
                for three in self.order.windows(3) {
                    distance[three[1]] += (value(three[2]) - value(three[0])) / range;
                }
            }
        }
    }

    /// Distance of a member since the last [`Self::reset`].
    pub(super) fn of(&self, i: usize) -> f64 {
        self.distance[i]
    }

    /// Orders items by the falling distance of their members, then by number.
    pub(super) fn sort(&self, items: &mut [usize], member: impl Fn(usize) -> usize) {
        let distance = |item: usize| self.of(member(item));
        items.sort_unstable_by(|&a, &b| distance(b).total_cmp(&distance(a)).then(a.cmp(&b)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_gaps_between_neighbours_and_infinite_at_the_ends() {
        let f = [0.0, 10.0, 1.0, 6.0, 4.0, 0.0, 9.0, 9.0, 3.0, 2.0];
        let population = Population::from_objectives(&f, 2);
        let mut crowding = CrowdingDistance::default();
        crowding.reset(5);
        crowding.measure(&population, &[0, 1, 2, 4]);
        let got: Vec<f64> = (0..5).map(|i| crowding.of(i)).collect();
        let want = [f64::INFINITY, 3.0 / 4.0 + 8.0 / 10.0, f64::INFINITY, 0.0, 3.0 / 4.0 + 6.0 / 10.0];
        let near = |got: f64, want: f64| got.total_cmp(&want).is_eq() || (got - want).abs() < 1e-15;
        assert!(got.iter().zip(want).all(|(&got, want)| near(got, want)), "{got:?}");
        // One objective: its worst is an end too.
        crowding.measure(&Population::from_objectives(&[1.0, 2.0, 4.0], 1), &[0, 1, 2]);
        assert!(crowding.of(2).is_infinite() && near(crowding.of(1), 1.0));
        let mut order = [4, 3, 2, 1, 0];
        crowding.sort(&mut order, |i| i);
        assert_eq!(order, [0, 2, 4, 1, 3]);
    }
}
