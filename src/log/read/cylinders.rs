//! Lengths of cylinders become the angles of their joints, or angles lengths, by a file of the arm's cylinders.

use std::{
    borrow::Cow,
    collections::{BTreeMap, BTreeSet},
};

use super::{
    content::{Content, Extracted},
    origin::joints_with_unit,
};
use crate::{
    arm::{Rod, Rods, names_a_cylinder, names_a_stroke, sliding_joints},
    input_file,
    log::{
        csv::LengthUnit,
        error::LogError,
        joined,
        joint_kind::{self, doubt_sliding},
        options::ReadOptions,
        source::AXES,
    },
    remark::{Code, Remarks},
    series::{JointKind, Series, Track},
    units::{DEGREE_RAD, Degrees},
};

/// A cylinder has to hold its rod when it is drawn in: it extends to less than twice its length, with a margin for its ends.
const MOST_EXTENDED: f64 = 2.1;
/// Sensors and limits differ by this much, rad.
const PAST_LIMIT_RAD: f64 = 5.0 * DEGREE_RAD;

/// How joints move, and what becomes of those with a cylinder.
#[derive(Default)]
pub(super) struct Kinds {
    /// Names of joints that slide.
    pub(super) sliding: BTreeSet<String>,
    /// Names in the log of joints that have others here, by source and name.
    renamed: BTreeMap<(usize, String), String>,
    conversion: Option<Conversion>,
    /// Whether a URDF says how joints move.
    told: bool,
    /// Joints whose columns had a unit in the table that was imported.
    stated: BTreeSet<String>,
    /// Joints that a log of ours says to slide.
    in_metres: BTreeSet<String>,
    /// Joints that the caller says to slide, and the unit.
    slides: BTreeMap<String, LengthUnit>,
    /// Sources that a join wrote, and those that it says to be in degrees.
    written: BTreeSet<usize>,
    in_degrees: BTreeSet<usize>,
    /// Units of lengths that a join says of all others.
    recorded: BTreeMap<String, LengthUnit>,
}

struct Conversion {
    rods: Rods,
    into: JointKind,
    file: String,
}

impl Kinds {
    /// Calls joints as the file of cylinders does, if there is one, in the log and as the caller names them. A source that
    /// has a joint and its cylinder keeps both names.
    pub(super) fn of_names(extracted: &mut Extracted, options: &mut ReadOptions) -> Result<Self, LogError> {
        let Some(wanted) = &options.cylinders else { return Ok(Self::default()) };
        let text = input_file::read_to_string(&wanted.file).map_err(LogError::file("read", &wanted.file))?;
        let file = wanted.file.display().to_string();
        let rods = Rods::from_toml(&text, &file, options.description.as_deref()).map_err(Box::new)?;
        let (mut renamed, mut kept) = (BTreeMap::new(), BTreeSet::new());
        for (source, of) in extracted.sources.iter_mut().enumerate() {
            let lists: Vec<&mut Vec<String>> = match &mut of.content {
                Content::Table(table) => vec![&mut table.joints],
                Content::Plans(plans) => plans.trajectories.iter_mut().map(|one| &mut one.joints).collect(),
                _ => continue,
            };
            for names in lists {
                for at in 0..names.len() {
                    let joint = rods.meant(&names[at]).map(str::to_owned);
                    if let Some(joint) = joint.filter(|joint| !names.contains(joint)) {
                        let name = std::mem::replace(&mut names[at], joint.clone());
                        renamed.insert((source, joint), name);
                    } else {
                        kept.insert(names[at].clone());
                    }
                }
            }
        }
        for name in options.joints.iter_mut().filter(|name| !kept.contains(*name)) {
            *name = rods.meant(name).unwrap_or(name).to_owned();
        }
        let conversion = Some(Conversion { rods, into: wanted.into, file });
        Ok(Self { renamed, conversion, ..Self::default() })
    }

    /// A joint of a source has another name in the log.
    pub(super) fn call(&mut self, source: usize, joint: &str, name: String) {
        self.renamed.entry((source, joint.to_owned())).or_insert(name);
    }

    /// Learns from the URDF, the log and the caller which joints slide; whether joints of the arm are called as the axes
    /// of a pose are.
    pub(super) fn learn_sliding(&mut self, options: &ReadOptions, extracted: &Extracted) -> bool {
        self.told = options.description.is_some();
        self.slides.clone_from(&options.slides);
        self.stated = extracted.tables.iter().flat_map(joints_with_unit).map(str::to_owned).collect();
        self.sliding.extend(options.description.as_deref().map(sliding_joints).unwrap_or_default());
        let axes_slide = self.sliding.contains(AXES[0]);
        self.in_metres = joint_kind::sliding(&extracted.metadata);
        self.sliding.extend(self.in_metres.iter().cloned());
        self.sliding.extend(options.slides.keys().cloned());
        let (written, recorded) = joined::units(&extracted.metadata);
        let of = |topics: &BTreeSet<String>| {
            let is = |source: &usize| topics.contains(&extracted.topic_of(*source).topic);
            (0..extracted.sources.len()).filter(is).collect()
        };
        (self.written, self.in_degrees) = (of(&written), of(&recorded.degrees));
        self.sliding.extend(recorded.lengths.keys().cloned());
        self.recorded = recorded.lengths;
        axes_slide
    }

    /// Whether positions of a source are in degrees, where the caller says so of its side, or a join said it of its topic.
    pub(super) fn degrees(&self, source: usize, said: bool) -> bool {
        !self.written.contains(&source) && (said || self.in_degrees.contains(&source))
    }

    /// How a joint of a source moves.
    pub(super) fn of(&self, source: usize, joint: &str) -> JointKind {
        let named = self.renamed.get(&(source, joint.to_owned()));
        let slides = named.is_some_and(|name| names_a_cylinder(name) || self.sliding.contains(name));
        if slides || self.sliding.contains(joint) { JointKind::Slides } else { JointKind::Turns }
    }

    /// Joints of a table whose header says the unit.
    pub(super) fn stated(&self) -> &BTreeSet<String> {
        &self.stated
    }

    /// The unit that the caller says of lengths of a joint of a source, m.
    pub(super) fn unit_m(&self, source: usize, joint: &str) -> Option<f64> {
        if self.written.contains(&source) {
            return None;
        }
        let named = || self.slides.get(self.renamed.get(&(source, joint.to_owned()))?);
        // What our logs say to slide, they have in metres.
        let given = self.slides.get(joint).or_else(named).filter(|_| !self.in_metres.contains(joint));
        let given = self.recorded.get(joint).or(given);
        // Metres are what is meant where nothing else says a unit, as the name of a field may.
        given.filter(|unit| **unit != LengthUnit::Metres).map(|unit| unit.metres())
    }

    /// How a joint of a source moves, and what its numbers are to be multiplied by; `of_field` is that of its field.
    pub(super) fn read_as(
        &self,
        (source, joint): (usize, &str),
        degrees: bool,
        of_field: impl Fn(JointKind) -> f64,
    ) -> (JointKind, f64) {
        let kind = self.of(source, joint);
        if self.degrees(source, degrees) && kind == JointKind::Turns {
            return (kind, DEGREE_RAD);
        }
        let scale = self.unit_m(source, joint).unwrap_or_else(|| of_field(kind));
        (kind, scale * self.travel_per_rod(source, joint))
    }

    /// What lengths of a joint are to be multiplied by so that they are its positions: where its cylinder slides it and the log has
    /// the rod.
    fn travel_per_rod(&self, source: usize, joint: &str) -> f64 {
        let is_rod =
            || self.renamed.get(&(source, joint.to_owned())).is_some_and(|name| names_a_cylinder(name));
        let rod_per_travel = self.conversion.as_ref().and_then(|own| own.rods.rod_per_travel(joint));
        rod_per_travel.filter(|_| is_rod()).map_or(1.0, f64::recip)
    }

    /// Says of a run what stays as it is although it was to be converted.
    pub(super) fn check(&self, sides: [&Series; 2], remarks: &mut Remarks) -> Result<(), LogError> {
        let tracks = || sides.into_iter().flat_map(|side| &side.tracks);
        let here = |name: &String| {
            tracks().any(|track| track.name() == name) || self.renamed.values().any(|own| own == name)
        };
        for name in self.slides.keys().filter(|name| !here(name)) {
            remarks.add(
                Code::UnpairedJoint,
                1,
                format!("joint {name} that --slides names is not among those read"),
            );
        }
        let Some(Conversion { rods, into, file }) = &self.conversion else {
            let turning =
                tracks().filter(|track| !self.told && track.turns() && !self.stated.contains(track.name()));
            doubt_sliding(turning.map(Track::name), remarks);
            return Ok(());
        };
        let mut found = tracks().filter_map(|track| Some((track, rods.of(track.name())?))).peekable();
        let slides = tracks().any(|track| rods.rod_per_travel(track.name()).is_some());
        if found.peek().is_none() && !slides {
            let present: BTreeSet<&str> = tracks().map(Track::name).collect();
            let present = present.into_iter().collect::<Vec<_>>().join(", ");
            let joints = rods.joints().collect::<Vec<_>>().join(", ");
            return Err(LogError::NoCylinder { file: file.clone(), joints, present });
        }
        // Of a URDF it is known that they turn.
        let known = |(track, rod): (&Track, &Rod)| !track.turns() || rod.range_rad.is_some();
        if *into == JointKind::Turns && found.peek().is_some() && !found.any(known) {
            let message = "no joint with a cylinder is logged as a length, all are taken as angles; --slides NAME says of \
                           a joint that it is a length";
            remarks.add(Code::Guessed, 1, message);
        }
        Ok(())
    }

    /// Converts the joints of some sides that have a cylinder, if they are to become of this kind.
    pub(super) fn convert(
        &self,
        into: JointKind,
        sides: &mut [(&'static str, &mut Series)],
        remarks: &mut Remarks,
    ) -> Result<(), LogError> {
        let Some(Conversion { rods, .. }) = self.conversion.as_ref().filter(|own| own.into == into) else {
            return Ok(());
        };
        for (side, series) in sides {
            if into == JointKind::Slides {
                for track in series.tracks.iter_mut().filter(|track| !track.turns()) {
                    let Some(rod_per_travel) = rods.rod_per_travel(track.name()) else { continue };
                    let rod = |position_m: f64| Some((rod_per_travel * position_m, rod_per_travel));
                    *track = track.mapped(into, rod).unwrap_or_else(|| track.clone());
                }
            }
            for track in series.tracks.iter_mut().filter(|track| track.kind() != into) {
                let Some(rod) = rods.of(track.name()) else { continue };
                let (found, expected) = (span(track.position()), possible(into, rod));
                let hint = hint(track.name(), into, found, expected);
                let Some(after) = converted(track, rod) else {
                    let (joint, unit, hint) = (track.name().into(), track.kind().unit(), hint.into());
                    let (found, expected) = (Box::new(found), Box::new(expected));
                    return Err(LogError::NoTriangle { joint, side, found, expected, unit, hint });
                };
                doubt((side, track, &after), rod, (found, expected, &hint), remarks);
                if into == JointKind::Turns && rod.zero_m == 0.0 {
                    self.doubt_stroke(track.name(), remarks);
                }
                *track = after;
            }
        }
        Ok(())
    }

    /// A remark on a joint whose lengths were taken from mount to mount although their name says that they count from the
    /// cylinder drawn in.
    fn doubt_stroke(&self, joint: &str, remarks: &mut Remarks) {
        let mut named = self.renamed.iter().filter(|((_, own), _)| own == joint).map(|(_, name)| name);
        if let Some(name) = named.find(|name| names_a_stroke(name)) {
            let message = format!(
                "{name} is called a stroke and was taken as the length from mount to mount: if it counts from the \
                 cylinder drawn in, give that one's length as sensor_zero_m of [joint.{joint}]"
            );
            remarks.add(Code::Guessed, 1, message);
        }
    }

    /// Tracks in the kinds that another source has of their joints.
    pub(super) fn alike<'a>(&self, series: &'a Series, kind: impl Fn(&str) -> JointKind) -> Cow<'a, Series> {
        let Some(Conversion { rods, .. }) = &self.conversion else { return Cow::Borrowed(series) };
        let alike = |track: &Track| match rods.of(track.name()) {
            Some(rod) if kind(track.name()) != track.kind() => converted(track, rod),
            _ => Some(track.clone()),
        };
        Cow::Owned(Series { tracks: series.tracks.iter().filter_map(alike).collect() })
    }
}

/// A joint in the other kind; `None` if no sample fits the triangle.
fn converted(track: &Track, rod: &Rod) -> Option<Track> {
    match track.kind() {
        JointKind::Slides => track.mapped(JointKind::Turns, |logged_m| rod.angle_at(logged_m)),
        JointKind::Turns => track.mapped(JointKind::Slides, |angle_rad| rod.logged_at(angle_rad)),
    }
}

/// What can be converted into a kind: the triangle's lengths, m, or angles, rad.
fn possible(into: JointKind, rod: &Rod) -> [f64; 2] {
    if into == JointKind::Turns {
        return rod.logged_range_m();
    }
    let ends = [0.0, std::f64::consts::PI].map(|rad| rod.linkage.sense * (rad - rod.linkage.offset_rad));
    [ends[0].min(ends[1]), ends[0].max(ends[1])]
}

fn span(values: &[f64]) -> [f64; 2] {
    values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &v| [a.min(v), b.max(v)])
}

/// What is most likely wrong with values that do not fit.
fn hint(joint: &str, into: JointKind, found: [f64; 2], expected: [f64; 2]) -> String {
    let within = |[least, most]: [f64; 2]| least > expected[0] && most < expected[1];
    if into == JointKind::Slides {
        return "are they degrees? then say --planned-degrees and --measured-degrees".to_owned();
    }
    if within(found.map(|mm| 1e-3 * mm)) {
        return "they fit as mm: then say --slides NAME=mm".to_owned();
    }
    let fits = found[1] - found[0] < expected[1] - expected[0];
    if fits && (found[0] < expected[0] || found[1] > MOST_EXTENDED * found[0]) {
        return format!(
            "if they are strokes from the retracted cylinder, give its length from mount to mount as sensor_zero_m of \
             [joint.{joint}]"
        );
    }
    format!(
        "check that the lengths are in m and from mount to mount (of strokes give sensor_zero_m), and a_m, b_m and \
         delta_rad of [joint.{joint}]"
    )
}

/// Remarks on what was left out, and on lengths and angles that this machine can hardly have.
fn doubt(
    (side, before, after): (&str, &Track, &Track),
    rod: &Rod,
    ([least, most], [from, to], hint): ([f64; 2], [f64; 2], &str),
    remarks: &mut Remarks,
) {
    let (joint, unit) = (before.name(), before.kind().unit());
    let dropped = (before.len() - after.len()) as u64;
    let message = format!(
        "{side} samples of {joint} that its cylinder cannot have, dropped: they run {least:.4} to {most:.4} {unit}, the \
         triangle has {from:.4} to {to:.4}; {hint}"
    );
    remarks.add(Code::Implausible, dropped, message);
    if !after.turns() {
        return;
    }
    if dropped == 0 && most + rod.zero_m > MOST_EXTENDED * (least + rod.zero_m) {
        let message = format!(
            "{side} lengths of {joint} run {least:.4} to {most:.4} m, taken as from mount to mount: no cylinder extends \
             to more than twice its length; {hint}"
        );
        remarks.add(Code::Guessed, 1, message);
    }
    let (lower, upper) = rod.range_rad.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
    let past = |angle: &&f64| **angle < lower - PAST_LIMIT_RAD || **angle > upper + PAST_LIMIT_RAD;
    let outside = after.position().iter().filter(past).count();
    if 2 * outside > after.len() {
        let [[a, b], [lower, upper]] = [span(after.position()), [lower, upper]].map(|ends| ends.map(Degrees));
        let message = format!(
            "{side} samples of {joint} outside its limits in the URDF, {lower} to {upper}: by its cylinder it runs {a} \
             to {b}; {hint}"
        );
        remarks.add(Code::Guessed, outside as u64, message);
    }
}
