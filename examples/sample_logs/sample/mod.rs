//! Sample logs with known truth.

mod cut;
mod hydraulic;
mod machine;
mod plan;
mod plc;
mod readme;
mod recorder;
mod run;
mod truth;

use std::{collections::BTreeMap, error::Error};

use hydrotrace::log::{LogWriter, WriteError, WriteOptions};

use cut::cut_last_chunk;
use recorder::{Cycle, write_joints, write_measured, write_plan, write_state};
use run::Run;

/// A log and what the README says of it.
struct SampleLog {
    name: &'static str,
    bytes: Vec<u8>,
    run: Run,
    /// What is wrong with it, as (key in the truth, value).
    defects: Vec<(&'static str, String)>,
    /// What it holds, in a sentence.
    story: &'static str,
}

const IN_ORDER: [usize; 6] = [0, 1, 2, 3, 4, 5];
/// An order as hash maps give it.
const SHUFFLED: [usize; 6] = [5, 2, 0, 4, 1, 3];
/// The joint that never moves.
const STILL: usize = 5;

/// The measured stream is silent in these, s: in motion, and across a start of `joint_3`.
const GAPS_S: [[f64; 2]; 2] = [[12.0, 13.5], [20.0, 20.8]];
/// Cycles in which `joint_2` has no angle; the last one lies at rest.
const NOT_FINITE: [usize; 5] = [400, 401, 402, 1180, 3700];
/// Cycles whose measured state is sent twice.
const REPEATED: [usize; 4] = [150, 700, 2300, 3100];

/// The power fails in the last third, which is one chunk.
const LAST_CHUNK_FROM: usize = 2 * recorder::CYCLES / 3;

/// Name and content of a log.
type Title = (&'static str, &'static str);

const PANEL_INSTALL: Title = (
    "panel-install.mcap",
    "No faults: plan, measurement, controller state (20 Hz) and the trajectory, once. `joint_3` leaves standstill 0.25 s late and falls behind by a degree.",
);
const STILL_JOINT: Title = (
    "still-joint.mcap",
    "Plan and measurement, with the joints in the order 6, 3, 1, 5, 2, 4. `joint_6` never moves, and its plan rests.",
);
const GAPS: Title = (
    "gaps.mcap",
    "Plan and measurement; the measured stream has gaps (one in motion, one across a start of `joint_3`), NaN and repeated stamps.",
);
const POWER_LOSS: Title = (
    "power-loss.mcap",
    "Like the first, but cut in the middle of its last chunk, which holds the last third of the run.",
);
const TRAJECTORY_ONLY: Title = (
    "trajectory-only.mcap",
    "The plan only as one `trajectory_msgs/JointTrajectory`, stamped with the start of the run, and the measurement.",
);

const PLC_TRACE: Title = (
    "plc-trace.csv",
    "The first 20 s as a PLC writes them, 50 Hz: semicolons, decimal commas, degrees, a row of units, dates without time zone.",
);

/// Small files for a repository: the slowest compression.
pub(crate) const SMALL: u32 = 19;

/// Every file of the folder, by name; the log that is cut is always [`SMALL`], for its cut lies in compressed data.
pub(crate) fn files(compression_level: u32) -> Result<BTreeMap<String, Vec<u8>>, Box<dyn Error>> {
    let size = options(compression_level);
    let logs = [
        panel_install(&size)?,
        still_joint(&size)?,
        gaps(&size)?,
        power_loss(&options(SMALL))?,
        trajectory_only(&size)?,
        plc_trace()?,
    ];
    let plant = hydraulic::logs(&size)?;
    let mut files = BTreeMap::from([("README.md".to_owned(), readme::text(&logs, &plant)?.into_bytes())]);
    files.extend(plant.into_iter().map(|log| (log.name.to_owned(), log.bytes)));
    files.extend(logs.into_iter().map(|log| (log.name.to_owned(), log.bytes)));
    Ok(files)
}

fn panel_install(options: &WriteOptions) -> Result<SampleLog, Box<dyn Error>> {
    let run = Run::new(1, IN_ORDER, &[])?;
    write(options, PANEL_INSTALL, run, Vec::new(), |log, run| {
        write_plan(log, &run.plans)?;
        write_everything(log, &run.cycles)
    })
}

fn still_joint(options: &WriteOptions) -> Result<SampleLog, Box<dyn Error>> {
    let run = Run::new(2, SHUFFLED, &[STILL])?;
    let defects = vec![("still", format!("joint_{}", STILL + 1))];
    write(options, STILL_JOINT, run, defects, |log, run| {
        run.cycles.iter().try_for_each(|cycle| write_joints(log, cycle))
    })
}

fn gaps(options: &WriteOptions) -> Result<SampleLog, Box<dyn Error>> {
    let mut run = Run::new(3, IN_ORDER, &[])?;
    for cycle in &mut run.cycles {
        cycle.keep_measured &= !GAPS_S.iter().any(|&[from_s, to_s]| cycle.t_s > from_s && cycle.t_s < to_s);
    }
    for k in NOT_FINITE {
        run.cycles[k].measured_rad[1] = f64::NAN;
        run.cycles[k].keep_measured = true;
    }
    for k in REPEATED {
        run.cycles[k].keep_measured = true;
    }
    let gaps_s = GAPS_S.map(|[from_s, to_s]| format!("{from_s:.1}..{to_s:.1}"));
    let defects = vec![
        ("gaps_s", gaps_s.join(" ")),
        ("not_finite_joint_2", NOT_FINITE.len().to_string()),
        ("repeated_stamps", REPEATED.len().to_string()),
    ];
    write(options, GAPS, run, defects, |log, run| {
        run.cycles.iter().enumerate().try_for_each(|(k, cycle)| {
            write_joints(log, cycle)?;
            if REPEATED.contains(&k) { write_measured(log, cycle) } else { Ok(()) }
        })
    })
}

fn power_loss(options: &WriteOptions) -> Result<SampleLog, Box<dyn Error>> {
    let run = Run::new(4, IN_ORDER, &[])?;
    let measured = |cycles: &[Cycle]| cycles.iter().filter(|cycle| cycle.keep_measured).count();
    let defects = vec![
        ("measured_samples", measured(&run.cycles).to_string()),
        ("measured_before_cut_chunk", measured(&run.cycles[..LAST_CHUNK_FROM]).to_string()),
        ("cut_chunk_from_s", format!("{:.3}", run.cycles[LAST_CHUNK_FROM].t_s)),
    ];
    let mut log = write(options, POWER_LOSS, run, defects, |log, run| {
        write_plan(log, &run.plans)?;
        write_everything(log, &run.cycles[..LAST_CHUNK_FROM])?;
        log.flush()?;
        write_everything(log, &run.cycles[LAST_CHUNK_FROM..])
    })?;
    let cut = cut_last_chunk(&log.bytes, "/joint_states").ok_or("the log has no chunk to cut")?;
    log.bytes.truncate(cut.at);
    // Known only once the log is written, so not part of what it says of itself.
    log.defects.push(("measured_recoverable_from_cut_chunk", cut.recoverable.to_string()));
    Ok(log)
}

fn trajectory_only(options: &WriteOptions) -> Result<SampleLog, Box<dyn Error>> {
    let run = Run::new(5, IN_ORDER, &[])?;
    write(options, TRAJECTORY_ONLY, run, Vec::new(), |log, run| {
        write_plan(log, &run.plans)?;
        run.cycles.iter().try_for_each(|cycle| write_measured(log, cycle))
    })
}

fn plc_trace() -> Result<SampleLog, Box<dyn Error>> {
    let run = Run::new(6, IN_ORDER, &[])?;
    let bytes = plc::trace(&run).into_bytes();
    let (name, story) = PLC_TRACE;
    Ok(SampleLog { name, bytes, run, defects: Vec::new(), story })
}

/// Chunks as large as a run.
fn options(compression_level: u32) -> WriteOptions {
    WriteOptions { compression_level, chunk_bytes: 1 << 24, ..WriteOptions::default() }
}

/// Plan and measurement in every cycle, the controller's state in every fifth.
fn write_everything(log: &mut LogWriter<Vec<u8>>, cycles: &[Cycle]) -> Result<(), WriteError> {
    for (k, cycle) in cycles.iter().enumerate() {
        write_joints(log, cycle)?;
        if k % 5 == 0 {
            write_state(log, cycle)?;
        }
    }
    Ok(())
}

/// Writes a log that begins with its truth.
fn write(
    options: &WriteOptions,
    (name, story): Title,
    run: Run,
    defects: Vec<(&'static str, String)>,
    record: impl FnOnce(&mut LogWriter<Vec<u8>>, &Run) -> Result<(), WriteError>,
) -> Result<SampleLog, Box<dyn Error>> {
    let mut log = LogWriter::new(Vec::new(), &run.joint_names(), options.clone())?;
    log.metadata("truth", &truth::entries(&run, &defects))?;
    record(&mut log, &run)?;
    Ok(SampleLog { name, bytes: log.finish()?, run, defects, story })
}
