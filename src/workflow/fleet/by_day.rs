//! Runs of one machine on one day: they share oil, load and weather, so that the mean of a day counts as one run.

use std::collections::BTreeMap;

use super::{
    history::{History, Values},
    run::Run,
};
use crate::workflow::days::is_of_day;

impl History {
    /// The same with one run a day of each machine that ran on enough days, by the starts of these; of a start its mean over the day,
    /// which begins with its first run. At `split_us` a day ends. Also the machines that ran several times on fewer days.
    pub(super) fn by_day(
        &self,
        split_us: Option<i64>,
        enough: impl Fn(&[i64]) -> bool,
    ) -> (Self, Vec<String>) {
        let mut of_machines: BTreeMap<&str, Vec<Vec<usize>>> = BTreeMap::new();
        for (k, run) in self.runs.iter().enumerate() {
            let days = of_machines.entry(&run.machine).or_default();
            let began = |at: usize| self.runs[at].started_us;
            let ends =
                |from_us: i64| split_us.is_some_and(|at_us| from_us < at_us && at_us <= run.started_us);
            let same = |day: &&mut Vec<usize>| {
                let ends_us = [began(day[0]), began(day[day.len() - 1])];
                is_of_day(ends_us, run.started_us) && !ends(ends_us[1])
            };
            match days.last_mut().filter(same) {
                Some(day) => day.push(k),
                None => days.push(vec![k]),
            }
        }
        // The first run of the day that each run is of.
        let mut first: Vec<usize> = (0..self.runs.len()).collect();
        let mut few = Vec::new();
        for (machine, days) in of_machines {
            if days.iter().all(|day| day.len() == 1) {
                continue;
            }
            if enough(&days.iter().map(|day| self.runs[day[0]].started_us).collect::<Vec<_>>()) {
                for (day, run) in days.iter().flat_map(|day| day.iter().map(|run| (day[0], *run))) {
                    first[run] = day;
                }
            } else {
                few.push(machine.to_owned());
            }
        }
        let kept: Vec<usize> = (0..self.runs.len()).filter(|k| first[*k] == *k).collect();
        let runs: Vec<Run> = kept.iter().map(|k| self.runs[*k].clone()).collect();
        let place = |run: &usize| kept.partition_point(|k| *k < first[*run]);
        let mean = |of_runs: &BTreeMap<usize, f64>| -> BTreeMap<usize, f64> {
            let mut sums: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
            for (run, value) in of_runs {
                let sum = sums.entry(place(run)).or_default();
                *sum = (sum.0 + value, sum.1 + 1.0);
            }
            sums.into_iter().map(|(day, (sum, count))| (day, sum / count)).collect()
        };
        let daily = |values: &Values| values.iter().map(|(event, of)| (event.clone(), mean(of))).collect();
        let values = self.values.iter().map(|(key, values)| (key.clone(), daily(values))).collect();
        let directions = self.directions.clone();
        (Self { runs, values, directions, ..Self::default() }, few)
    }
}

#[cfg(test)]
mod tests {
    use super::{
        super::history::{Axis, By, Event},
        *,
    };

    const HOUR_US: i64 = 3_600_000_000;

    #[test]
    fn runs_of_a_day_are_one_where_there_are_days_enough() {
        // Two runs a day, six hours apart, over four days; a second machine runs all on the first day.
        let at_us = [0, 6, 24, 30, 48, 54, 72, 78].map(|hour| hour * HOUR_US);
        let run = |machine: &str, at_us: i64| Run {
            id: format!("{machine}{at_us}"),
            machine: machine.into(),
            log: String::new(),
            started_us: at_us,
        };
        let mut runs: Vec<Run> = at_us.map(|at_us| run("A", at_us)).to_vec();
        runs.extend((1..4).map(|hour| run("B", hour * HOUR_US)));
        runs.sort_by_key(|run| run.started_us);
        let of = |machine: &str| {
            let own = runs.iter().enumerate().filter(|(_, run)| run.machine == machine);
            own.map(|(k, run)| (k, (run.started_us / HOUR_US) as f64)).collect::<BTreeMap<_, _>>()
        };
        let event = Event { plan_id: "p".into(), index: 1 };
        let axis = |machine: &str| Axis { machine: machine.into(), joint: "boom".into(), unit: "rad".into() };
        let values = ["A", "B"]
            .map(|machine| ((axis(machine), By::Peak), Values::from([(event.clone(), of(machine))])));
        let history = History { runs: runs.clone(), values: values.into(), ..History::default() };
        let (daily, few) = history.by_day(None, |days| days.len() >= 4);
        assert_eq!((daily.runs.len(), few), (4 + 3, vec!["B".to_owned()]));
        let means = |machine: &str| -> Vec<f64> {
            daily.values[&(axis(machine), By::Peak)][&event].values().copied().collect()
        };
        assert_eq!((means("A"), means("B")), (vec![3.0, 27.0, 51.0, 75.0], vec![1.0, 2.0, 3.0]));
        let (split, _) = history.by_day(Some(25 * HOUR_US), |days| days.len() >= 4);
        assert_eq!(split.runs.iter().filter(|run| run.machine == "A").count(), 5);
    }
}
