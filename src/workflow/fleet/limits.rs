//! What each run tells of its machine: the numbers that a fit finds in it, as rows.

use super::tables::{Log, Name, Rows, limit_row, remark_row};
use crate::{
    document::explained,
    fit::JointFit,
    log::{Input, ReadOptions},
    remark::{Code, Remark},
    threads,
    workflow::fit,
};

/// Numbers that a fleet is followed by.
const FOLLOWED: [&str; 7] = [
    "lag_s", "dead_band_rad_s", "dead_band_error_rad", "position_gain_1_s", "gain_ratio",
    "speed_limit_growing_rad_s", "speed_limit_shrinking_rad_s",
];

/// The rows of a run; where it cannot be fitted, a remark that says why.
pub(super) fn rows(log: &Log, inputs: Vec<Input>, run_id: &str, read: &ReadOptions) -> Rows {
    let fitted = threads::alone(|| {
        let observed = fit::observe::observe(inputs, read).map_err(|failure| explained(&failure))?;
        fit::of(std::slice::from_ref(&log.uri), &[observed]).map_err(|failure| explained(&failure))
    });
    match fitted {
        Ok(fitted) => {
            let followed =
                |joint: &JointFit| joint.quantities().into_iter().filter(|(name, _)| FOLLOWED.contains(name));
            let of = |joint| {
                followed(joint).map(move |(name, found)| limit_row(&(log, run_id, joint, name, found)))
            };
            fitted.fit.joints.iter().flat_map(of).map(|row| (Name::Limits, row)).collect()
        }
        Err(error) => {
            let message = format!("the run tells nothing of the machine's limits: {error}");
            let remark = Remark { code: Code::PoorFit, count: 1, message };
            vec![(Name::Remarks, remark_row(log, run_id, &remark))]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(name: &str) -> Rows {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("sample-logs").join(name);
        let log = Log::at(&path, "a".into());
        rows(&log, vec![Input::Path(path)], "run", &ReadOptions::default())
    }

    #[test]
    fn a_run_gives_each_quantity_of_each_joint_and_one_that_is_no_run_a_remark() {
        let found = of("task-1-run.mcap");
        assert_eq!(found.len(), 6 * FOLLOWED.len());
        assert!(
            found
                .iter()
                .all(|(table, row)| { *table == Name::Limits && row.len() == Name::Limits.columns().len() })
        );
        let none = of("nothing.mcap");
        assert!(matches!(&none[..], [(Name::Remarks, row)] if row.len() == Name::Remarks.columns().len()));
    }
}
