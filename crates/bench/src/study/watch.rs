//! When to measure a run for its curve.

/// When to measure a run for its curve.
#[derive(Debug, Clone, Copy)]
pub struct Watch {
    budget: u64,
    steps: u64,
    next: u64,
}

impl Watch {
    /// So many steps over a budget of evaluations, and the first population; never for no steps.
    pub fn new(budget: u64, steps: u64) -> Self {
        Self { budget, steps, next: 0 }
    }

    /// Whether a step is due at so many evaluations; then it is counted as taken.
    pub fn is_due(&mut self, evaluations: u64) -> bool {
        let made = u128::from(evaluations) * u128::from(self.steps);
        let due = self.steps > 0 && u128::from(self.next) * u128::from(self.budget) <= made;
        let due = due && self.next <= self.steps;
        if due {
            let reached = made / u128::from(self.budget.max(1));
            self.next = u64::try_from(reached).unwrap_or(u64::MAX).saturating_add(1);
        }
        due
    }
}

#[cfg(test)]
mod tests {
    use super::Watch;

    #[test]
    fn a_watch_measures_the_start_once_a_step_and_the_end() {
        let looks = |made: &[u64], steps| {
            let mut watch = Watch::new(1000, steps);
            made.iter().copied().filter(|&n| watch.is_due(n)).collect::<Vec<u64>>()
        };
        assert_eq!(looks(&[92, 184, 276, 900, 950, 992, 1000], 4), [92, 276, 900, 1000]);
        assert_eq!(looks(&[92, 1000], 0), [0_u64; 0]);
        assert_eq!(looks(&[700, 1000, 1000], 4), [700, 1000]);
    }
}
