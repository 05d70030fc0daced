//! The supply, from the logged pressure before the valves.

use crate::{
    arm::Arm,
    fit::{Fed, Supply, supply},
    log::{Recording, SignalRole},
    series::Signal,
    workflow::carried::Carried,
};

/// The supply of runs whose logs have its pressure, where it fell; of an arm that is given, or else of that which each log holds.
pub(in crate::workflow) fn supply_of(runs: &[&Recording], given: Option<&Arm>) -> Option<Supply> {
    fn pressure(run: &Recording) -> Option<&Signal> {
        run.signals.get(&SignalRole::SupplyPressure)?.first()
    }
    let own = |run: &Recording| if given.is_none() { Carried::of(run).arm()?.ok() } else { None };
    let known: Vec<(&Recording, &Signal, Option<Arm>)> =
        runs.iter().filter_map(|run| Some((*run, pressure(run)?, own(run)))).collect();
    let fed = known.iter().map(|(run, pressure, own)| {
        let arm = given.or(own.as_ref());
        let sent = run.command.as_ref().map_or(&run.planned, |command| &command.series);
        Fed { sent, measured: &run.measured, pressure, arm }
    });
    supply(&fed.collect::<Vec<_>>())
}
