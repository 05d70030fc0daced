//! Which runs tell of something that was done to a machine: those between what was done before it and after it.

use super::{
    note::{Intervention, Note},
    run::Run,
};

/// Runs between two things that were done, at least: the effects of what lies nearer are one.
const FEWEST_BETWEEN: usize = 3;

/// The instants between which runs tell of what was done at one, from what was noted before it, where the
/// caller names no day, to what was noted after it. What is nearer than three runs of the machine is told together with it.
#[derive(Debug, Clone, Copy)]
#[expect(clippy::struct_field_names, reason = "all are instants")]
pub(super) struct Window {
    from_us: i64,
    at_us: i64,
    to_us: i64,
}

impl Window {
    pub(super) fn of<'a>(
        at_us: i64,
        since_us: Option<i64>,
        runs_us: &[i64],
        notes: impl Iterator<Item = &'a Note> + Clone,
    ) -> Self {
        let apart = |from_us: i64, to_us: i64| {
            let between = runs_us.iter().filter(|&&us| from_us <= us && us < to_us);
            (from_us < to_us && between.count() >= FEWEST_BETWEEN).then_some(())
        };
        let before = notes.clone().filter(|note| since_us.is_none() && apart(note.at_us, at_us).is_some());
        let after = notes.filter(|note| apart(at_us, note.at_us).is_some());
        Self {
            from_us: before.map(|note| note.at_us).max().unwrap_or(i64::MIN),
            at_us,
            to_us: after.map(|note| note.at_us).min().unwrap_or(i64::MAX),
        }
    }

    /// The same without what began before one instant or after another.
    pub(super) fn within(self, from_us: Option<i64>, until_us: Option<i64>) -> Self {
        Self {
            from_us: from_us.map_or(self.from_us, |us| us.max(self.from_us)),
            to_us: until_us.map_or(self.to_us, |us| us.saturating_add(1).min(self.to_us)),
            ..self
        }
    }

    pub(super) fn holds(&self, run: &Run) -> bool {
        (self.from_us..self.to_us).contains(&run.started_us)
    }

    pub(super) fn is_after(&self, run: &Run) -> bool {
        run.started_us >= self.at_us
    }

    /// What was noted at its ends, and between them beside what was done.
    pub(super) fn beside(&self, notes: &[&Note]) -> [Vec<Intervention>; 2] {
        let of = |holds: &dyn Fn(i64) -> bool| {
            notes.iter().filter(|note| holds(note.at_us)).map(|note| Intervention::from(*note)).collect()
        };
        let inside = |us: i64| us > self.from_us && us < self.to_us && us != self.at_us;
        [of(&|us| us == self.from_us || us == self.to_us), of(&inside)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_repair_has_the_runs_between_those_before_and_after_it() {
        let day = |day: i64| day * 86_400_000_000;
        let noted = [2, 5, 6, 8].map(|at| Note {
            at_us: day(at),
            machine: "M0".into(),
            joint: None,
            what: format!("day {at}"),
        });
        let runs_us: Vec<i64> = (0..10).map(day).collect();
        let noted: Vec<&Note> = noted.iter().collect();
        let of = |at, since| Window::of(day(at), since, &runs_us, noted.iter().copied());
        let run = |k| Run { id: String::new(), log: String::new(), started_us: day(k), machine: "M0".into() };
        let held: Vec<i64> = (0..10).filter(|k| of(5, None).holds(&run(*k))).collect();
        assert_eq!(held, [2, 3, 4, 5, 6, 7]);
        let what = |beside: [Vec<Intervention>; 2]| {
            beside.map(|of| of.into_iter().map(|of| of.what).collect::<Vec<_>>())
        };
        assert_eq!(what(of(5, None).beside(&noted)), [vec!["day 2", "day 8"], vec!["day 6"]]);
        let since = of(5, Some(day(1)));
        assert!(since.holds(&run(1)) && !since.holds(&run(8)), "the caller's own day counts");
    }
}
