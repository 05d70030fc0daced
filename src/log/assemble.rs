//! From samples of topics to planned and measured series on one clock.

use std::collections::{BTreeMap, BTreeSet};

use super::{
    LogError, ReadOptions, Recording, SourceInfo, TimeBase, overlap, quality,
    read::{Content, Extracted},
    select_topics::{Candidate, Choice},
    source::{Plans, RawTrajectory, Stamps},
    track::{Axis, Unit, tracks},
};
use crate::{
    math::median,
    remark::{Code, Remarks},
    series::{Clock, PlannedPoint, PlannedTrajectory, Series, Track, continuous_clock, plan_tracks},
    suggest::nearest,
    units::{radians_from_degrees, seconds_since},
};

pub(super) fn assemble(
    mut extracted: Extracted,
    choice: &Choice,
    options: &ReadOptions,
) -> Result<Recording, LogError> {
    let mut remarks = std::mem::take(&mut extracted.remarks);
    let (base, base_why) = time_base(&extracted, choice, options, &mut remarks)?;
    let chosen: Vec<&Candidate> = choice.measured.iter().chain(&choice.planned).collect();
    overlap::check(&extracted, &chosen, base)?;
    for rival in &choice.rivals {
        let message = format!("{rival} measures the same joints and was not used; choose with --measured");
        remarks.add(Code::Ambiguous, 1, message);
    }
    let commanded: Vec<&str> =
        if options.planned.is_empty() { choice.commanded().collect() } else { Vec::new() };
    if let [first, ..] = commanded.as_slice() {
        let message = format!(
            "{first} is what was sent, and nothing in the log looks like the plan behind it: the error is against \
             the command, not against what was wanted; `hydrotrace join LOG --plan next.mcap` puts the plan into \
             the log, --planned TOPIC names it"
        );
        remarks.add(Code::PlanIsCommand, commanded.len() as u64, message);
    }
    let plan_is_command = !commanded.is_empty();
    let mut clocks: BTreeMap<usize, Clock> = BTreeMap::new();
    let mut jumps_ns: Vec<i64> = Vec::new();
    for candidate in choice.measured.iter().chain(&choice.planned) {
        if let Content::Table(table) = &extracted.sources[candidate.source].content {
            clocks.entry(candidate.source).or_insert_with(|| {
                let clock = continuous_clock(stamps_of(&table.stamps, base), &table.stamps.log_ns, &jumps_ns);
                jumps_ns.extend(&clock.offsets_ns);
                quality::of_clock(topic(&extracted, candidate), base, &clock, &mut remarks);
                quality::of_table(topic(&extracted, candidate), table, &mut remarks);
                clock
            });
        }
    }
    let epoch_ns = clocks.values().filter_map(|clock| clock.t_ns.first()).min().copied().unwrap_or(0);
    let axes: BTreeMap<usize, Axis> =
        clocks.into_iter().map(|(source, clock)| (source, Axis::new(clock, epoch_ns))).collect();
    let mut measured = gather(
        &mut extracted,
        &choice.measured,
        &choice.planned,
        if options.measured_in_degrees { Unit::Degrees } else { Unit::Radians },
        &axes,
        &mut remarks,
    );
    let mut planned =
        gather(&mut extracted, &choice.planned, &[], planned_unit(options), &axes, &mut remarks);
    for candidate in &choice.planned {
        if let Content::Plans(plans) = &extracted.sources[candidate.source].content {
            let receipt = Receipt::new(&extracted, choice, base, epoch_ns);
            let name = topic(&extracted, candidate);
            let mut trajectories =
                trajectories(plans, &receipt, options.planned_in_degrees, name, &mut remarks);
            trajectories.sort_by(|a, b| a.start_s.total_cmp(&b.start_s));
            let (series, replaced) = plan_tracks(&trajectories, &measured);
            remarks.add(
                Code::TrajectoryReplaced,
                replaced,
                format!("trajectories of {name} that the next one, or a cancel, cut short"),
            );
            let joints: BTreeSet<&str> =
                trajectories.iter().flat_map(|t| &t.joints).map(|(joint, _)| joint.as_str()).collect();
            for joint in joints.into_iter().filter(|joint| measured.track(joint).is_none()) {
                quality::unmeasured(joint, &mut remarks);
            }
            let new = series.tracks.into_iter().filter(|t| planned.track(t.name()).is_none());
            planned.tracks.extend(new.collect::<Vec<_>>());
        }
    }
    for series in [&mut planned, &mut measured] {
        keep_joints(series, &options.joints)?;
        quality::unwrap_turns(series, &options.continuous, &mut remarks);
    }
    quality::of_pairs(&planned, &measured, options, &mut remarks);
    let source = source_info(&extracted, choice, base, base_why, epoch_ns, &measured, &planned);
    Ok(Recording {
        planned,
        measured,
        plan_is_command,
        source,
        remarks,
        attachments: extracted.attachments,
        metadata: extracted.metadata,
    })
}

/// What the numbers of the plan are.
fn planned_unit(options: &ReadOptions) -> Unit {
    match (options.planned_is_no_angle, options.planned_in_degrees) {
        (true, _) => Unit::Other,
        (false, true) => Unit::Degrees,
        (false, false) => Unit::Radians,
    }
}

/// The tracks of the chosen fields; of joints that several have, those of the first.
///
/// Moves samples out of what was extracted, but for fields that are `needed_later`.
fn gather(
    extracted: &mut Extracted,
    chosen: &[Candidate],
    needed_later: &[Candidate],
    unit: Unit,
    axes: &BTreeMap<usize, Axis>,
    remarks: &mut Remarks,
) -> Series {
    let mut series = Series::default();
    for (place, candidate) in chosen.iter().enumerate() {
        let name = topic(extracted, candidate).to_owned();
        let (Content::Table(table), Some(field), Some(axis)) =
            (&mut extracted.sources[candidate.source].content, candidate.field, axes.get(&candidate.source))
        else {
            continue;
        };
        let same = |c: &Candidate| c.source == candidate.source && c.field == candidate.field;
        let last = !chosen[place + 1..].iter().chain(needed_later).any(same);
        let tracks = tracks(table, field, axis, unit, last, &name, remarks);
        let new: Vec<Track> = tracks.into_iter().filter(|t| series.track(t.name()).is_none()).collect();
        series.tracks.extend(new);
    }
    series
}

fn topic<'a>(extracted: &'a Extracted, candidate: &Candidate) -> &'a str {
    &extracted.topics[extracted.sources[candidate.source].topic].topic
}

pub(super) fn stamps_of(stamps: &Stamps, base: TimeBase) -> &[i64] {
    match base {
        TimeBase::Header => &stamps.header_ns,
        TimeBase::Publish => &stamps.publish_ns,
        TimeBase::Log => &stamps.log_ns,
    }
}

/// The one clock for all chosen topics: two clocks would differ by more than the lag measured.
fn time_base(
    extracted: &Extracted,
    choice: &Choice,
    options: &ReadOptions,
    remarks: &mut Remarks,
) -> Result<(TimeBase, String), LogError> {
    let tables: Vec<(&str, &Stamps)> = choice
        .measured
        .iter()
        .chain(&choice.planned)
        .filter_map(|c| match &extracted.sources[c.source].content {
            Content::Table(table) => Some((topic(extracted, c), &table.stamps)),
            _ => None,
        })
        .collect();
    let unusable =
        |base| tables.iter().find(|(_, stamps)| !moves(stamps_of(stamps, base))).map(|(name, _)| *name);
    if let Some(base) = options.time_base {
        return match unusable(base) {
            Some(topic) => Err(LogError::NoClock { clock: base.name(), topic: topic.to_owned() }),
            None => Ok((base, "as given".to_owned())),
        };
    }
    let Some(topic) = unusable(TimeBase::Header) else {
        return Ok((TimeBase::Header, "header stamps move; they say when a sample was taken".to_owned()));
    };
    let base = if unusable(TimeBase::Publish).is_none() { TimeBase::Publish } else { TimeBase::Log };
    let why = format!("the header stamps of {topic} are absent, zero or constant");
    remarks.add(
        Code::UnusableStamp,
        1,
        format!("{why}; {} time is used, transport delay included", base.name()),
    );
    Ok((base, why))
}

/// Whether a clock is set and runs: most readings differ from the one before.
fn moves(stamp_ns: &[i64]) -> bool {
    let set = stamp_ns.iter().filter(|&&ns| ns != 0).count();
    let steps = stamp_ns.windows(2).filter(|w| w[0] != w[1]).count();
    2 * set > stamp_ns.len() && 2 * steps >= stamp_ns.len().saturating_sub(1)
}

/// Turns a receipt on the recorder's clock into a time on the header's.
struct Receipt {
    base: TimeBase,
    epoch_ns: i64,
    /// Least delay from header to recorder and the spread up to the median, ns.
    delay_ns: Option<(i64, i64)>,
}

impl Receipt {
    fn new(extracted: &Extracted, choice: &Choice, base: TimeBase, epoch_ns: i64) -> Self {
        let delay_ns = choice.measured.first().and_then(|c| match &extracted.sources[c.source].content {
            Content::Table(table) if base == TimeBase::Header => delays_ns(&table.stamps),
            _ => None,
        });
        Self { base, epoch_ns, delay_ns: delay_ns.map(|(least, middle, _)| (least, middle - least)) }
    }
}

/// Least, median and largest delay from header stamp to recorder, ns.
#[expect(clippy::cast_possible_truncation, reason = "delays of a recording")]
fn delays_ns(stamps: &Stamps) -> Option<(i64, i64, i64)> {
    let delays: Vec<i64> = stamps
        .log_ns
        .iter()
        .zip(&stamps.header_ns)
        .filter(|(_, header)| **header != 0)
        .map(|(log, header)| log.saturating_sub(*header))
        .collect();
    let middle = median(delays.iter().map(|&ns| ns as f64).collect()) as i64;
    Some((*delays.iter().min()?, middle, *delays.iter().max()?))
}

fn trajectories(
    plans: &Plans,
    receipt: &Receipt,
    degrees: bool,
    topic: &str,
    remarks: &mut Remarks,
) -> Vec<PlannedTrajectory> {
    let mut out: Vec<PlannedTrajectory> = Vec::new();
    let mut previous_end_s = 0.0;
    for raw in &plans.trajectories {
        let start_s = if raw.place > 0 && raw.header_ns == 0 {
            previous_end_s
        } else if raw.header_ns != 0 && receipt.base == TimeBase::Header {
            seconds_since(receipt.epoch_ns, raw.header_ns)
        } else {
            let received_ns = if receipt.base == TimeBase::Publish { raw.publish_ns } else { raw.log_ns };
            let (delay_ns, spread_ns) = receipt.delay_ns.unwrap_or((0, 0));
            remarks.add(
                Code::StartOnReceipt,
                1,
                format!(
                    "trajectories of {topic} start when received; that is known to about {:.0} ms",
                    (spread_ns as f64 / 1e6).max(1.0)
                ),
            );
            seconds_since(receipt.epoch_ns, received_ns.saturating_sub(delay_ns))
        };
        match trajectory(raw, start_s, degrees) {
            Some(one) => {
                previous_end_s = one.joints.iter().filter_map(|(_, p)| p.last()).map(|p| p.t_s).fold(start_s, f64::max);
                out.push(one);
            }
            None => remarks.add(
                Code::LengthMismatch,
                1,
                format!("trajectories of {topic} whose points do not fit their joints or whose times do not increase, skipped"),
            ),
        }
    }
    out
}

fn trajectory(raw: &RawTrajectory, start_s: f64, degrees: bool) -> Option<PlannedTrajectory> {
    let n = raw.joints.len();
    let unit = |value: f64| if degrees { radians_from_degrees(value) } else { value };
    let fits =
        |values: &[f64]| values.is_empty() || values.len() == n && values.iter().all(|v| v.is_finite());
    let sound = raw.points.iter().all(|p| {
        p.position_rad.len() == n
            && [&p.position_rad, &p.velocity_rad_s, &p.acceleration_rad_s2].iter().all(|v| fits(v))
    });
    let increasing = raw.points.windows(2).all(|w| w[0].since_start_ns < w[1].since_start_ns);
    if !sound || !increasing || raw.points.first().is_some_and(|p| p.since_start_ns < 0) {
        return None;
    }
    if raw.points.is_empty() {
        return Some(PlannedTrajectory { start_s, joints: Vec::new() });
    }
    let joints = (0..n).map(|j| {
        let points = raw.points.iter().map(|p| PlannedPoint {
            t_s: start_s + seconds_since(0, p.since_start_ns),
            position: unit(p.position_rad[j]),
            velocity: p.velocity_rad_s.get(j).map(|&v| unit(v)),
            acceleration: p.acceleration_rad_s2.get(j).map(|&a| unit(a)),
        });
        (raw.joints[j].clone(), points.collect())
    });
    Some(PlannedTrajectory { start_s, joints: joints.collect() })
}

/// Keeps the joints that the caller named, in the caller's order.
fn keep_joints(series: &mut Series, wanted: &[String]) -> Result<(), LogError> {
    if wanted.is_empty() {
        return Ok(());
    }
    let mut kept = Vec::with_capacity(wanted.len());
    for name in wanted {
        let track = series.track(name).ok_or_else(|| LogError::NoJoint {
            joint: name.clone(),
            nearest: nearest(name, series.tracks.iter().map(Track::name)),
            present: series.tracks.iter().map(Track::name).collect::<Vec<_>>().join(", "),
        })?;
        kept.push(track.clone());
    }
    series.tracks = kept;
    Ok(())
}

fn source_info(
    extracted: &Extracted,
    choice: &Choice,
    time_base: TimeBase,
    time_base_why: String,
    epoch_ns: i64,
    measured: &Series,
    planned: &Series,
) -> SourceInfo {
    let join = |all: &[Candidate], text: &dyn Fn(&Candidate) -> String| {
        let mut list: Vec<String> = all.iter().map(text).collect();
        list.dedup();
        list.join(", ")
    };
    let name = |c: &Candidate| topic(extracted, c).to_owned();
    let field = |c: &Candidate| match (&extracted.sources[c.source].content, c.field) {
        (Content::Table(table), Some(field)) => table.fields[field].path.clone(),
        _ => "points.positions".to_owned(),
    };
    let messages =
        choice.measured.iter().map(|c| extracted.topics[extracted.sources[c.source].topic].messages).sum();
    let delays = choice.measured.first().and_then(|c| match &extracted.sources[c.source].content {
        Content::Table(table) if time_base == TimeBase::Header => delays_ns(&table.stamps),
        _ => None,
    });
    let ends = planned.tracks.iter().chain(&measured.tracks).filter_map(|t| t.t_s().last());
    SourceInfo {
        planned_topic: join(&choice.planned, &name),
        planned_field: join(&choice.planned, &field),
        measured_topic: join(&choice.measured, &name),
        measured_field: join(&choice.measured, &field),
        why: choice.why.clone(),
        time_base,
        time_base_why,
        messages,
        epoch_ns,
        duration_s: ends.copied().fold(0.0, f64::max),
        recorder_delay_s: delays.map(|(_, middle, most)| [seconds_since(0, middle), seconds_since(0, most)]),
    }
}
