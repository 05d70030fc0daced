//! Runs of one machine on one day: they share oil, load and weather, so that the mean of a day counts as one run.

use std::collections::BTreeMap;

use super::{
    history::{History, Values},
    run::Run,
};
use crate::workflow::days::days;

impl History {
    /// The same with one run a day of each machine that ran on enough days, by the starts of these; of a start its mean over the day,
    /// which begins with its first run. At each of `splits_us` a day ends. Also the machines that ran several times on fewer days.
    pub(super) fn by_day(&self, splits_us: &[i64], enough: impl Fn(&[i64]) -> bool) -> (Self, Vec<String>) {
        let mut of_machines: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for (k, run) in self.runs.iter().enumerate() {
            of_machines.entry(&run.machine).or_default().push(k);
        }
        // The first run of the day that each run is of.
        let mut first: Vec<usize> = (0..self.runs.len()).collect();
        let mut few = Vec::new();
        for (machine, runs) in of_machines {
            let began_us: Vec<i64> = runs.iter().map(|run| self.runs[*run].started_us).collect();
            let days = days(&began_us, splits_us);
            if days.len() == runs.len() {
                continue;
            }
            if enough(&days.iter().map(|day| began_us[day.start]).collect::<Vec<_>>()) {
                for day in days {
                    for run in &runs[day.clone()] {
                        first[*run] = runs[day.start];
                    }
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
        let (daily, few) = history.by_day(&[], |days| days.len() >= 4);
        assert_eq!((daily.runs.len(), few), (4 + 3, vec!["B".to_owned()]));
        let means = |machine: &str| -> Vec<f64> {
            daily.values[&(axis(machine), By::Peak)][&event].values().copied().collect()
        };
        assert_eq!((means("A"), means("B")), (vec![3.0, 27.0, 51.0, 75.0], vec![1.0, 2.0, 3.0]));
        let (split, _) = history.by_day(&[25 * HOUR_US], |days| days.len() >= 4);
        assert_eq!(split.runs.iter().filter(|run| run.machine == "A").count(), 5);
    }
}
