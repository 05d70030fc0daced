//! From samples of topics to plan, measurement and other signals on one clock.

use std::collections::BTreeMap;

use super::{
    beside,
    candidates::{Candidate, is_shown},
    choice::remark_choice,
    content::{Content, Extracted},
    cylinders::Kinds,
    held,
    joints::{add_new, keep_joints},
    origin::Imported,
    overlap, poses, quality,
    recording::{Command, Recording, SourceInfo},
    repeated,
    samples::{Axis, Reading, Samples, samples},
    select_topics::Choice,
    spoilt, time_base, trajectories, turns, unlike, unmeasured, unset,
    window::nothing_in,
};
use crate::{
    log::{
        error::LogError,
        options::{ReadOptions, SignalRole, TimeBase},
        range::TimeRange,
        source::{AXES, Stamps},
    },
    remark::{Code, Remarks},
    series::{Clock, JointKind, Series, Signal, continuous_clock},
    units::seconds_since,
};

pub(super) fn assemble(
    mut extracted: Extracted,
    choice: &Choice,
    options: &ReadOptions,
    mut kinds: Kinds,
) -> Result<Recording, LogError> {
    let mut remarks = std::mem::take(&mut extracted.remarks);
    // A side that was not asked for, or need not be there, is no doubt.
    let alone = (choice.planned.is_empty() || choice.measured.is_empty()).then(|| remarks.clone());
    let (base, base_why) = time_base::time_base(&extracted, choice, options.time_base, &mut remarks)?;
    remarks.extend(overlap::check(&extracted, choice.measured.iter().chain(&choice.planned), base)?);
    let plan_is_command = remark_choice(choice, options, &extracted.tables, &mut remarks);
    // Where they are the arm's, joints called x, y and z are no pose.
    let axes_slide = kinds.learn_sliding(options, &extracted);
    kinds.sliding.extend(
        choice.of_poses(&extracted).then(|| AXES[..3].iter().map(ToString::to_string)).into_iter().flatten(),
    );
    let beside = beside::of(&extracted, options, base)?;

    let delays_ns = delays_ns(&extracted, choice, base, &mut remarks);
    // Trajectories are laid onto the stamps of the measurement.
    let laid = |c: &&Candidate| matches!(extracted.sources[c.source].content, Content::Plans(_));
    let laid_onto = choice.planned.iter().find(laid).and(choice.measured.first()).map(|c| c.source);
    let chosen = choice.measured.iter().chain(&choice.planned);
    let delay_ns = options.measured_delay_ns.unwrap_or(0);
    let on = (base, options.range.widened(delay_ns));
    let mut assembly = Assembly::new(extracted, on, (kinds, laid_onto), chosen, &mut remarks);
    let mut pending: Vec<&Candidate> =
        choice.planned.iter().chain(beside.iter().flat_map(|(_, found)| found)).collect();
    Imported::check(&assembly.extracted.tables, options)?;
    let told = |side: &str| !Imported::guessed_degrees(&assembly.extracted.tables, side);
    let [measured_degrees, planned_degrees] =
        [options.measured_in_degrees && told("measured"), options.planned_in_degrees && told("planned")];
    let mut measured = assembly.series(&choice.measured, &pending, measured_degrees, None, &mut remarks);
    pending.drain(..choice.planned.len());
    let mut planned =
        assembly.series(&choice.planned, &pending, planned_degrees, Some((choice, &measured)), &mut remarks);
    let mut command = None;
    let mut signals = BTreeMap::new();
    for (wanted, found) in &beside {
        pending.drain(..found.len());
        // Doubts about signals are not doubts about the run.
        let mut doubts = Remarks::default();
        for candidate in found {
            assembly.add_axis(candidate, &mut doubts);
        }
        if wanted.role == SignalRole::Command {
            let run = (choice, &measured);
            match assembly.command(found, &pending, options, run, &mut doubts) {
                Err(LogError::NoJoint { .. }) if wanted.topic.is_none() => {}
                sent => command = Some(sent?),
            }
        } else {
            let signals_of = |c| assembly.signals(c, wanted.role, &pending, &mut doubts);
            let kept = |signal: &Signal| {
                options.joints.is_empty() || options.joints.iter().any(|j| j == signal.name())
            };
            signals.insert(wanted.role, found.iter().flat_map(signals_of).filter(kept).collect());
        }
    }
    let delay_s = seconds_since(0, delay_ns);
    measured.earlier(delay_s);
    let sent = command.as_mut().map(|own| &mut own.series);
    [&mut planned, &mut measured].into_iter().chain(sent).for_each(|series| options.range.cut(series));
    for (series, chosen) in [(&planned, &choice.planned), (&measured, &choice.measured)] {
        if series.tracks.is_empty() && options.range.cuts() && !chosen.is_empty() {
            return Err(nothing_in(options.range, &assembly.extracted, chosen));
        }
    }
    let poses = if axes_slide { None } else { poses::take(&mut planned, &mut measured) };
    keep_joints(&mut planned, &options.joints)?;
    keep_joints(&mut measured, &options.joints)?;
    assembly.kinds.check([&planned, &measured], &mut remarks)?;
    let sides = &mut [("planned", &mut planned), ("measured", &mut measured)];
    assembly.kinds.convert(JointKind::Turns, sides, &mut remarks)?;
    let continuous = turns::unwrap_sides(sides, &options.continuous, &mut remarks);
    if let Some(command) = &mut command {
        turns::unwrap_beside(sides[0].1, &mut command.series, &continuous, &mut remarks);
    }
    unset::of_sides(sides, &mut remarks);
    repeated::of_sides(sides, plan_is_command, &mut remarks);
    held::of_sides(choice, choice.of_one_recorder(&assembly.extracted), sides, &mut remarks);
    if let Some(command) = &mut command {
        repeated::of_command(&mut command.series, &mut remarks);
        held::of_command(command, sides[1].1, &mut remarks);
    }
    unmeasured::of_sides(sides, &mut remarks);
    let options = &ReadOptions { continuous, ..options.clone() };
    let stood_s = spoilt::of_sides([sides[0].1, sides[1].1], command.as_ref(), options, &mut remarks);
    quality::of_pairs([sides[0].1, sides[1].1], options, assembly.kinds.stated(), &mut remarks);
    assembly.kinds.convert(JointKind::Slides, sides, &mut remarks)?;
    unlike::of_sides(sides[0].1, sides[1].1, &mut remarks);
    let mut source = assembly.source_info(choice, base_why, delays_ns, [&measured, &planned]);
    unlike::of_command(&planned, command.as_ref(), &source.planned_topic, &mut remarks);
    source.measured_delay_s = Some(delay_s).filter(|delay_s| *delay_s != 0.0);
    let Extracted { attachments, metadata, .. } = assembly.extracted;
    // Where both sides are there, a table that lacks one is no doubt.
    let remarks = alone.unwrap_or_else(|| remarks.without(Code::OneSide));
    Ok(Recording {
        planned,
        measured,
        poses,
        plan_is_command,
        command,
        signals,
        source,
        stood_s,
        remarks,
        attachments,
        metadata,
        description: options.description.clone(),
    })
}

/// The content of the files, and the time axes of the tables that are used.
struct Assembly {
    extracted: Extracted,
    base: TimeBase,
    range: TimeRange,
    epoch_ns: i64,
    axes: BTreeMap<usize, Axis>,
    jumps_ns: Vec<i64>,
    kinds: Kinds,
    /// The source whose stamps are still needed once it has an axis.
    laid_onto: Option<usize>,
}

impl Assembly {
    /// The epoch is the first stamp of all `chosen`.
    fn new<'a>(
        extracted: Extracted,
        (base, range): (TimeBase, TimeRange),
        (kinds, laid_onto): (Kinds, Option<usize>),
        chosen: impl Iterator<Item = &'a Candidate>,
        remarks: &mut Remarks,
    ) -> Self {
        let (axes, jumps_ns) = (BTreeMap::new(), Vec::new());
        let mut new = Self { extracted, base, range, epoch_ns: 0, axes, jumps_ns, kinds, laid_onto };
        let mut clocks = BTreeMap::new();
        for candidate in chosen {
            if !clocks.contains_key(&candidate.source)
                && let Some(clock) = new.clock(candidate)
            {
                clocks.insert(candidate.source, (clock, candidate));
            }
        }
        new.epoch_ns =
            clocks.values().filter_map(|(clock, _)| clock.t_ns.first()).min().copied().unwrap_or(0);
        for (source, (clock, candidate)) in clocks {
            let axis = new.axis(candidate, clock, remarks);
            new.axes.insert(source, axis);
        }
        new
    }

    fn add_axis(&mut self, candidate: &Candidate, remarks: &mut Remarks) {
        if !self.axes.contains_key(&candidate.source)
            && let Some(clock) = self.clock(candidate)
        {
            let axis = self.axis(candidate, clock, remarks);
            self.axes.insert(candidate.source, axis);
        }
    }

    /// The clock of a table, in place of its stamps unless these are still needed: both at once are the most that a report ever holds.
    fn clock(&mut self, candidate: &Candidate) -> Option<Clock> {
        let needed = self.range.cuts() || self.laid_onto == Some(candidate.source);
        let Content::Table(table) = &mut self.extracted.sources[candidate.source].content else {
            return None;
        };
        let clock = continuous_clock(table.stamps.of(self.base), &table.stamps.log_ns, &self.jumps_ns);
        self.jumps_ns.extend(&clock.offsets_ns);
        if !needed {
            table.stamps = Stamps::default();
        }
        Some(clock)
    }

    /// The axis of a table on its clock, as far as the range goes. What is doubtful elsewhere is not remarked.
    fn axis(&mut self, candidate: &Candidate, mut clock: Clock, remarks: &mut Remarks) -> Axis {
        let topic = self.topic(candidate);
        if let Content::Table(table) = &self.extracted.sources[candidate.source].content {
            if self.range.cuts() {
                let (range, epoch_ns) = (self.range, self.epoch_ns);
                clock.keep(|at_ns| range.begins_by(epoch_ns, at_ns), |at_ns| range.holds(epoch_ns, at_ns));
                let rows = clock.rows.iter().min().zip(clock.rows.iter().max());
                let own = rows.map_or(0..0, |(first, last)| *first..last + 1);
                let (stamp_ns, log_ns) = (table.stamps.of(self.base), &table.stamps.log_ns);
                let here = continuous_clock(&stamp_ns[own.clone()], &log_ns[own], &[]);
                quality::of_clock(topic, self.base, &here, remarks);
            } else {
                quality::of_clock(topic, self.base, &clock, remarks);
            }
            quality::of_table(topic, table, remarks);
        }
        if self.laid_onto != Some(candidate.source)
            && let Content::Table(table) = &mut self.extracted.sources[candidate.source].content
        {
            table.stamps = Stamps::default();
        }
        Axis::new(clock, self.epoch_ns)
    }

    fn topic(&self, candidate: &Candidate) -> &str {
        &self.extracted.topic_of(candidate.source).topic
    }

    /// The samples of a field, of positions with whether the caller says degrees; moved out of the table unless it is `pending`.
    fn samples(
        &mut self,
        candidate: &Candidate,
        positions: Option<bool>,
        pending: &[&Candidate],
        remarks: &mut Remarks,
    ) -> Vec<Samples> {
        let (name, kinds) = (self.topic(candidate).to_owned(), &self.kinds);
        let (Content::Table(table), Some(field), Some(axis)) = (
            &mut self.extracted.sources[candidate.source].content,
            candidate.field,
            self.axes.get(&candidate.source),
        ) else {
            return Vec::new();
        };
        let last = !pending.iter().any(|c| c.source == candidate.source && c.field == candidate.field);
        let unit = |degrees| move |joint: &str| kinds.read_as((candidate.source, joint), degrees, |_| 1.0).1;
        samples(table, Reading { field, unit: positions.map(unit), last }, axis, &name, remarks)
    }

    /// The tracks of the chosen fields; of joints that several have, those of the first. Trajectories become tracks at the stamps of the measurement.
    fn series(
        &mut self,
        chosen: &[Candidate],
        pending: &[&Candidate],
        degrees: bool,
        measured: Option<(&Choice, &Series)>,
        remarks: &mut Remarks,
    ) -> Series {
        let mut series = Series::default();
        for (place, candidate) in chosen.iter().enumerate() {
            let pending: Vec<&Candidate> =
                chosen[place + 1..].iter().chain(pending.iter().copied()).collect();
            let found = self.samples(candidate, Some(degrees), &pending, remarks);
            let tracks = found.into_iter().filter_map(|one| {
                let of_field = |kind| self.extracted.scale(candidate.source, candidate.field, kind);
                let (kind, scale) = self.kinds.read_as((candidate.source, &one.name), degrees, of_field);
                one.into_track(kind, scale)
            });
            add_new(&mut series, tracks.collect());
        }
        for candidate in chosen {
            let (Content::Plans(plans), Some((choice, measured))) =
                (&self.extracted.sources[candidate.source].content, measured)
            else {
                continue;
            };
            let reading = trajectories::Reading {
                base: self.base,
                epoch_ns: self.epoch_ns,
                measured: choice.measured.first().and_then(|c| self.extracted.stamps(c.source)),
                degrees: self.kinds.degrees(candidate.source, degrees),
                topic: self.topic(candidate),
                shown: is_shown(&self.extracted.topic_of(candidate.source).type_name),
            };
            let kind = |joint: &str| self.kinds.of(candidate.source, joint);
            let measured = self.kinds.alike(measured, kind);
            let read_as = |joint: &str| self.kinds.read_as((candidate.source, joint), false, |_| 1.0);
            add_new(&mut series, trajectories::planned(plans, &reading, read_as, &measured, remarks));
        }
        series
    }

    fn command(
        &mut self,
        found: &[Candidate],
        pending: &[&Candidate],
        options: &ReadOptions,
        run: (&Choice, &Series),
        doubts: &mut Remarks,
    ) -> Result<Command, LogError> {
        let mut series = self.series(found, pending, options.planned_in_degrees, Some(run), doubts);
        keep_joints(&mut series, &options.joints)?;
        let sides = &mut [("commanded", &mut series)];
        self.kinds.convert(JointKind::Turns, sides, doubts)?;
        self.kinds.convert(JointKind::Slides, sides, doubts)?;
        let topic = found.first().map(|c| self.topic(c).to_owned()).unwrap_or_default();
        Ok(Command { topic, series })
    }

    fn signals(
        &mut self,
        candidate: &Candidate,
        role: SignalRole,
        pending: &[&Candidate],
        remarks: &mut Remarks,
    ) -> Vec<Signal> {
        let found = self.samples(candidate, None, pending, remarks);
        let quantity = |one: &Samples| role.quantity(self.kinds.of(candidate.source, &one.name));
        let found = found.into_iter().map(|one| (quantity(&one), one));
        found.filter_map(|(quantity, one)| one.into_signal(quantity)).collect()
    }

    fn source_info(
        &self,
        choice: &Choice,
        time_base_why: String,
        delays_ns: Option<[i64; 3]>,
        [measured, planned]: [&Series; 2],
    ) -> SourceInfo {
        let join = |all: &[Candidate], text: &dyn Fn(&Candidate) -> String| {
            let mut list: Vec<String> = Vec::new();
            for one in all.iter().map(text) {
                if !list.contains(&one) {
                    list.push(one);
                }
            }
            list.join(", ")
        };
        let name = |c: &Candidate| self.topic(c).to_owned();
        let field = |c: &Candidate| match (&self.extracted.sources[c.source].content, c.field) {
            (Content::Table(table), Some(field)) => table.fields[field].path.clone(),
            _ => "points.positions".to_owned(),
        };
        let tracks = || planned.tracks.iter().chain(&measured.tracks);
        let last_s = tracks().filter_map(|t| t.t_s().last()).copied().fold(0.0, f64::max);
        let first_s = tracks().filter_map(|t| t.t_s().first()).copied().fold(f64::INFINITY, f64::min);
        let cut = self.range.cuts();
        let topic = |c: &Candidate| self.extracted.sources[c.source].topic;
        let messages = |(place, c): (usize, &Candidate)| match self.axes.get(&c.source) {
            Some(axis) if cut => axis.len() as u64,
            _ if choice.measured[..place].iter().any(|before| topic(before) == topic(c)) => 0,
            _ => self.extracted.topic_of(c.source).messages,
        };
        SourceInfo {
            planned_topic: join(&choice.planned, &name),
            planned_field: join(&choice.planned, &field),
            measured_topic: join(&choice.measured, &name),
            measured_field: join(&choice.measured, &field),
            why: choice.why.clone(),
            time_base: self.base,
            time_base_why,
            messages: choice.measured.iter().enumerate().map(messages).sum(),
            epoch_ns: self.epoch_ns,
            epoch_set_ns: SourceInfo::epoch_set_ns(self.epoch_ns, &self.jumps_ns),
            duration_s: if cut { last_s - first_s.min(last_s) } else { last_s },
            recorder_delay_s: delays_ns
                .map(|[_, middle, most]| [middle, most].map(|ns| seconds_since(0, ns))),
            origin: None,
            measured_delay_s: None,
        }
    }
}

/// How late the measurement was received, least, median and most, ns, if its stamps are what counts.
fn delays_ns(
    extracted: &Extracted,
    choice: &Choice,
    base: TimeBase,
    remarks: &mut Remarks,
) -> Option<[i64; 3]> {
    let of = |side: &[Candidate]| extracted.stamps(side.first()?.source).and_then(Stamps::delays_ns);
    let sides = [&choice.planned, &choice.measured].map(|side| of(side).filter(|_| base == TimeBase::Header));
    quality::of_delays(sides, remarks);
    sides[1]
}
