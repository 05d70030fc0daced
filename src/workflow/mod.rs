//! A folder a verb: what the caller wants in, what was found out. No printing, no clap.

pub mod carried;
pub mod compare;
mod correctable;
mod days;
pub mod excite;
pub mod export;
pub mod fit;
#[cfg(feature = "parquet")]
pub mod fleet;
mod idle_bound;
pub mod import;
pub mod info;
pub mod join;
mod leads;
mod names;
pub mod plan;
pub mod record;
pub mod recover;
pub mod replan;
pub mod report;
mod same_plan;
mod sensed;
pub mod simulate;
mod useless;
#[doc(hidden)]
pub mod view;
#[cfg(feature = "parquet")]
pub mod watch;

#[cfg(test)]
mod tests {
    use super::{compare, fit, fleet, import, info, join, plan, record, recover, replan, report, watch};
    use crate::schema::is_committed;

    #[test]
    fn the_committed_schemas_are_those_of_the_documents() {
        is_committed::<compare::Comparison>("compare.v2.schema.json", "hydrotrace comparison, version 2");
        is_committed::<fit::FitDocument>("fit.v1.schema.json", "hydrotrace fit, version 1");
        is_committed::<fit::LimitsFile>("limits.v1.schema.json", "hydrotrace limits, version 1");
        is_committed::<fleet::Compacted>(
            "fleet-compact.v1.schema.json", "hydrotrace fleet compact, version 1",
        );
        is_committed::<fleet::Drift>("fleet-drift.v1.schema.json", "hydrotrace fleet drift, version 1");
        is_committed::<fleet::Effect>("fleet-effect.v1.schema.json", "hydrotrace fleet effect, version 1");
        is_committed::<fleet::Gated>("fleet-gate.v1.schema.json", "hydrotrace fleet gate, version 1");
        is_committed::<fleet::Notes>("fleet-notes.v1.schema.json", "hydrotrace fleet note, version 1");
        is_committed::<fleet::Scanned>("fleet-scan.v1.schema.json", "hydrotrace fleet scan, version 1");
        is_committed::<fleet::Worst>("fleet-worst.v1.schema.json", "hydrotrace fleet worst, version 1");
        is_committed::<import::Imported>("import.v1.schema.json", "hydrotrace import, version 1");
        is_committed::<info::InfoDocument>("info.v1.schema.json", "hydrotrace info, version 1");
        is_committed::<join::Gathered>(
            "gathered.v1.schema.json",
            "hydrotrace join without a plan, version 1",
        );
        is_committed::<join::Joined>("join.v1.schema.json", "hydrotrace join, version 1");
        is_committed::<plan::PlanDocument>("plan.v1.schema.json", "hydrotrace plan, version 1");
        is_committed::<record::Recorded>("record.v1.schema.json", "hydrotrace record, version 1");
        is_committed::<recover::RecoverDocument>("recover.v1.schema.json", "hydrotrace recover, version 1");
        is_committed::<replan::ReplanDocument>("replan.v3.schema.json", "hydrotrace replan, version 3");
        is_committed::<report::Document>("report.v2.schema.json", "hydrotrace report, version 2");
        is_committed::<watch::Run>("watch.v1.schema.json", "hydrotrace watch, version 1");
    }
}
