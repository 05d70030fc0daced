//! As one JSON document.

use serde::Serialize;

use super::published::name;
use crate::{
    document,
    workflow::contest::{BASELINE, Cell, Inputs, Row, Ruler, Study, Tally},
};

#[derive(Serialize)]
struct Document<'a> {
    format: &'static str,
    program: &'static str,
    first_seed: u64,
    seeds: u64,
    reference_evaluations: u64,
    baseline: &'static str,
    notes: Vec<String>,
    tasks: &'a [Ruler],
    cells: &'a [Cell],
    tallies: &'a [Tally],
    table_3: Vec<Plan<'a>>,
}

/// A plan of the comparison with the paper's Table 3.
#[expect(clippy::struct_field_names, reason = "the names of the document")]
#[derive(Serialize)]
struct Plan<'a> {
    plan: String,
    printed_f2: Option<f64>,
    printed_f3: Option<f64>,
    times_s: Option<&'a [f64]>,
    duration_s: Option<f64>,
    rms_jerk_rad_s3: Option<f64>,
    rms_power_w: Option<f64>,
    limits_broken: Option<usize>,
}

fn plan(row: &Row) -> Plan<'_> {
    let evaluation = row.evaluation.as_ref();
    let f = evaluation.map(|evaluation| [0, 1, 2].map(|k| evaluation.objectives.plan()[k]));
    Plan {
        plan: name(row.whose),
        printed_f2: row.printed.map(|printed| printed.f2),
        printed_f3: row.printed.and_then(|printed| printed.f3),
        times_s: evaluation.map(|evaluation| evaluation.times_s.as_slice()),
        duration_s: f.map(|f| f[0]),
        rms_jerk_rad_s3: f.map(|f| f[1]),
        rms_power_w: f.map(|f| f[2]),
        limits_broken: evaluation.map(|evaluation| evaluation.broken().len()),
    }
}

/// Tasks, then cells by task, budget and algorithm, then the paper's Table 3. Times are seconds, jerk is
/// rad/s³, power W; what no run has is null.
pub fn contest_json(inputs: &Inputs, study: &Study) -> String {
    document::pretty(&Document {
        format: "hydrotrace.bench-plan.v1",
        program: document::PROGRAM,
        first_seed: inputs.first_seed,
        seeds: inputs.seeds,
        reference_evaluations: inputs.reference_evaluations,
        baseline: BASELINE,
        notes: super::notes(inputs),
        tasks: &study.rulers,
        cells: &study.cells,
        tallies: &study.tallies,
        table_3: study.table_3.iter().flat_map(|table| &table.rows).map(plan).collect(),
    })
}
