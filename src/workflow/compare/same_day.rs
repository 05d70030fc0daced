//! Runs of which all of a side are of one day.

use crate::{
    remark::{Code, Remarks},
    workflow::{days::days, report::Report},
};

/// Says that runs of two days alone tell nothing of what differs from day to day, where several of each side are compared.
pub(super) fn told([before, after]: [&[Report]; 2], by_runs: bool, remarks: &mut Remarks) {
    let began = |side: &[Report]| -> Option<Vec<i64>> {
        side.iter().map(|run| Some(run.source.began_ns()? / 1000)).collect()
    };
    let count = |mut began_us: Vec<i64>| {
        began_us.sort_unstable();
        days(&began_us, &[]).len()
    };
    let Some((before, after)) = began(before).zip(began(after)).filter(|_| by_runs) else { return };
    let of_one = count(before.clone()).min(count(after.clone())) == 1;
    let apart = count([before, after].concat()) > 1;
    let message = "the runs of a side are of one day: what differs from day to day, such as oil, load and weather, is in the change, and in \
                   neither its interval nor p; runs of three days a side tell it apart";
    remarks.add(Code::FewDays, u64::from(of_one && apart), message);
}
