//! Runs from which nothing is learnt: given twice, broken off, held back by an override, or with a joint that stood though it answers
//! in others, as of a valve without current, which says nothing of its machine.

use super::{Inputs, out_of_time::out_of_time};
use crate::{
    log::Recording,
    remark::{Code, Remarks},
    series::{Series, bridged},
    workflow::{
        names::told_apart,
        same_plan::{ahead, cut},
        useless::{LeftOut, dead, stopped, twice},
    },
};

/// What is sent later than its plan by more was held back, s: corrections run ahead.
const BEHIND_S: f64 = 0.5;
/// Joints that lead their plan by more were sent their command early, s: no correction asks for that.
const EARLY_S: f64 = 0.25;
/// The same that explains at least this share of their error: where corrections ask for what the machine has not, it is off anyhow.
const SHIFTED: f64 = 0.5;
/// What is said of the runs that are left out.
pub(super) struct Useless {
    pub(super) doubts: Remarks,
    /// Of the newest run, where it is one.
    pub(super) newest: Option<(Code, String)>,
}

/// Without the runs from which nothing is learnt, and what is said of them. One run is left.
pub(super) fn without_useless(
    inputs: &Inputs,
    observed: Vec<Recording>,
) -> (Inputs, Vec<Recording>, Useless) {
    let names = told_apart(&inputs.logs);
    // The newest is refused as a whole.
    let mut left = stopped(observed.split_last().map_or(&[][..], |(_, others)| others));
    twice(&observed, &names, &mut left);
    unlike_others(&observed, &mut left, held_back);
    unlike_others(&observed, &mut left, early);
    unlike_others(&observed, &mut left, out_of_time);
    let stay: Vec<usize> = (0..observed.len()).filter(|k| !left.contains_key(k)).collect();
    let sides = |k: &usize| [&observed[*k].planned, &observed[*k].measured];
    let dead = dead(&stay.iter().map(sides).collect::<Vec<_>>());
    left.extend(dead.into_iter().map(|(place, why)| (stay[place], why)));
    let mut doubts = Remarks::default();
    for (place, (code, why)) in &left {
        doubts.add(*code, 1, format!("{}: {why}; nothing is learnt from this run", names[*place]));
    }
    let newest = observed.len().checked_sub(1).and_then(|newest| Some((newest, left.get(&newest)?)));
    let newest = newest.filter(|(_, (code, _))| *code != Code::SameRun);
    let newest = newest.map(|(place, (code, why))| (*code, format!("{}: {why}", names[place])));
    let stays = |k: &usize| !left.contains_key(k);
    let logs = inputs.logs.iter().enumerate().filter(|(k, _)| stays(k)).map(|(_, path)| path.clone());
    let inputs = Inputs { logs: logs.collect(), ..inputs.clone() };
    let observed = observed.into_iter().enumerate().filter(|(k, _)| stays(k)).map(|(_, run)| run);
    (inputs, observed.collect(), Useless { doubts, newest })
}

/// Runs of which something is to be said, where there are others of which it is not.
fn unlike_others(
    observed: &[Recording],
    left: &mut LeftOut,
    why: impl Fn(&Recording) -> Option<(Code, String)>,
) {
    let stay: Vec<usize> = (0..observed.len()).filter(|k| !left.contains_key(k)).collect();
    let found: Vec<(usize, (Code, String))> =
        stay.iter().filter_map(|k| Some((*k, why(&observed[*k])?))).collect();
    if found.len() < stay.len() {
        left.extend(found);
    }
}

/// What was sent came after its plan.
fn held_back(run: &Recording) -> Option<(Code, String)> {
    let by_s = -ahead_of_plan(run, &run.command.as_ref()?.series)?.0;
    let why = || {
        format!(
            "what was sent came after its plan, by {by_s:.1} s in the mean of its motion: an override or a pause held it back"
        )
    };
    (by_s > BEHIND_S).then(|| (Code::Paused, why()))
}

/// Joints led their plan by far, and what was sent by more: it came too early.
fn early(run: &Recording) -> Option<(Code, String)> {
    let (sent_s, _) = ahead_of_plan(run, &run.command.as_ref()?.series)?;
    let (by_s, share) = ahead_of_plan(run, &run.measured)?;
    let why = || {
        format!(
            "its joints led their plan by {by_s:.1} s in the mean of its motion: what was sent came before its time"
        )
    };
    (by_s > EARLY_S && sent_s > by_s && share > SHIFTED).then(|| (Code::OtherTime, why()))
}

/// How far joints of a run are ahead of their plan, s, and the share of their error that this explains.
fn ahead_of_plan(run: &Recording, series: &Series) -> Option<(f64, f64)> {
    let [from_s, to_s] = run.planned.span_s()?;
    let of = |series: &Series| cut(&*bridged(series).ok()?, from_s, to_s).ok();
    Some(ahead(&of(series)?, &of(&run.planned)?))
}
