//! Remarks on data that look wrong.

use std::{collections::BTreeSet, f64::consts::TAU};

use super::{jumps, turns::turns};
use crate::{
    log::{
        options::{ReadOptions, TimeBase},
        source::{Field, MAX_JOINTS, Role, Table},
    },
    math::quantile,
    remark::{Code, Remark, Remarks},
    series::{Clock, Series, Track, frozen},
    units::{DEGREE_RAD, NS_PER_S},
};

pub(super) fn of_clock(topic: &str, base: TimeBase, clock: &Clock, remarks: &mut Remarks) {
    let base = base.name();
    remarks.add(
        Code::UnusableStamp,
        clock.unstamped,
        format!("messages of {topic} without a {base} stamp, left out"),
    );
    remarks.add(
        Code::UnusableStamp,
        clock.misfits,
        format!("messages of {topic} whose {base} stamp fits neither their neighbours nor the recorder's clock, dropped"),
    );
    remarks.add(
        Code::DuplicateStamp,
        clock.duplicates,
        format!("samples of {topic} that repeat a {base} stamp, dropped"),
    );
    remarks.add(
        Code::Reordered,
        clock.reordered,
        format!("samples of {topic} that came late, put in order of their {base} stamps"),
    );
    let jump_s = clock.longest_jump_ns as f64 / NS_PER_S;
    remarks.add(
        Code::ClockJump,
        clock.cuts.len() as u64,
        format!(
            "jumps of the {base} clock in {topic}, by up to {jump_s:.3} s; the run is split there and \
             time goes on by the recorder's clock, or where that jumped, too, by the order of the file"
        ),
    );
}

/// The recorder receives plan and measurement later than their stamps by amounts that differ by more than this, ns, where
/// they are stamped by two clocks.
const TWO_CLOCKS_NS: i64 = 50_000_000;

/// Remarks on plan and measurement that are stamped by two clocks; delays from stamp to receipt: least, median, most, ns.
pub(super) fn of_delays([planned_ns, measured_ns]: [Option<[i64; 3]>; 2], remarks: &mut Remarks) {
    let (Some([_, planned_ns, _]), Some([_, measured_ns, _])) = (planned_ns, measured_ns) else { return };
    let ms = |ns: i64| ns as f64 / 1e6;
    if planned_ns.abs_diff(measured_ns) > TWO_CLOCKS_NS.unsigned_abs() {
        let message = format!(
            "the recorder was {:.0} ms behind the stamps of the plan, and {:.0} ms behind those of the measurement: where that \
             is two clocks, delays are off by the difference; --time log goes by the recorder's clock for both",
            ms(planned_ns),
            ms(measured_ns)
        );
        remarks.add(Code::Guessed, 1, message);
    }
}

pub(super) fn of_table(topic: &str, table: &Table, remarks: &mut Remarks) {
    let positions = |field: &&Field| !field.is_velocity && field.role != Role::Beside;
    for (k, field) in table.fields.iter().enumerate().filter(|(_, field)| positions(field)) {
        let path = &field.path;
        remarks.add(
            Code::NotFinite,
            table.not_finite[k],
            format!("values of {topic}:{path} that are NaN or infinite, dropped"),
        );
        remarks.add(
            Code::LengthMismatch,
            table.length_mismatch[k],
            format!("messages of {topic} whose {path} is not as long as its list of joints, left out"),
        );
    }
    remarks.add(
        Code::JointsChange,
        table.list_changes(),
        format!("changes of order or set of the joints within {topic}; joined by name"),
    );
    remarks.add(
        Code::NotSupported,
        table.too_many,
        format!("messages or joints of {topic} beyond the first {MAX_JOINTS} joints, left out"),
    );
    let (paused, slowed) = scaling(&table.speed_scaling);
    remarks.add(
        Code::Paused,
        paused,
        format!("samples of {topic} with the controller paused (speed scaling 0)"),
    );
    remarks.add(
        Code::Paused,
        slowed,
        format!("samples of {topic} with the controller slowed (speed scaling below 1)"),
    );
}

/// How many silences the joint has that has most of them, and the longest of any.
#[derive(Default)]
pub(super) struct Gaps {
    count: u64,
    longest_s: f64,
    at_s: f64,
}

impl Gaps {
    /// `jumps` ascend.
    pub(super) fn note(&mut self, t_s: &[f64], cuts: &[usize], jumps: &[usize]) {
        let mut count = 0;
        for &cut in cuts.iter().filter(|cut| jumps.binary_search(cut).is_err()) {
            count += 1;
            let length_s = t_s[cut] - t_s[cut - 1];
            if length_s > self.longest_s {
                (self.longest_s, self.at_s) = (length_s, t_s[cut - 1]);
            }
        }
        self.count = self.count.max(count);
    }

    pub(super) fn remark(&self, topic: &str, remarks: &mut Remarks) {
        let Self { longest_s, at_s, .. } = self;
        remarks.add(
            Code::Gap,
            self.count,
            format!("{GAPS}{topic}, the longest {longest_s:.2} s after {at_s:.2} s; nothing is computed across them"),
        );
    }
}

const GAPS: &str = "gaps in ";

/// Whether a remark is of the gaps of a topic.
pub(super) fn is_of_gaps(remark: &Remark, topic: &str) -> bool {
    let of = remark.message.strip_prefix(GAPS).and_then(|rest| rest.strip_prefix(topic));
    remark.code == Code::Gap && of.is_some_and(|rest| rest.starts_with(','))
}

/// Numbers of samples paused and slowed; 0 where the field is never filled.
fn scaling(factors: &[(f64, u64)]) -> (u64, u64) {
    let most = factors.iter().map(|(factor, _)| *factor).fold(0.0, f64::max);
    if most <= 0.0 {
        return (0, 0);
    }
    let full = most.min(1.0);
    let samples = |of: &dyn Fn(f64) -> bool| {
        factors.iter().filter(|(factor, _)| of(*factor)).map(|(_, samples)| samples).sum()
    };
    (samples(&|factor| factor <= 0.0), samples(&|factor| factor > 0.0 && factor < full - 1e-6))
}

/// Remarks on plan and measurement, joint by joint.
///
/// `stated` are joints of a table whose header says the unit: an option would convert them a second time.
pub(super) fn of_pairs(
    [planned, measured]: [&Series; 2],
    options: &ReadOptions,
    stated: &BTreeSet<String>,
    remarks: &mut Remarks,
) {
    for track in &planned.tracks {
        jumps::of_plan(track, remarks);
        match measured.track(track.name()) {
            None => unmeasured(track.name(), remarks),
            Some(measured) => of_pair(track, measured, (options, stated.contains(track.name())), remarks),
        }
    }
}

pub(super) fn unmeasured(joint: &str, remarks: &mut Remarks) {
    remarks.add(Code::UnpairedJoint, 1, format!("{joint} is planned but was not measured; left out"));
}

/// Ratios of measured to planned range that mean degrees in place of radians, or the reverse.
const DEGREES_IN_RADIAN: f64 = 1.0 / DEGREE_RAD;
const RATIO_TOLERANCE: f64 = 0.15;
/// Joints with end stops span less.
const TURN_AND_A_HALF_RAD: f64 = 1.5 * TAU;

fn of_pair(
    planned: &Track,
    measured: &Track,
    (options, stated): (&ReadOptions, bool),
    remarks: &mut Remarks,
) {
    if planned.turns() {
        of_units(planned, measured, (options, stated), remarks);
    }
    // Full turns are told of elsewhere.
    if turns(measured) == 0 {
        jumps::of_measurement(planned, measured, remarks);
    }
    if let Some((from_s, to_s, samples)) = frozen(planned, measured) {
        let name = planned.name();
        remarks.add(
            Code::FrozenSensor,
            samples,
            format!(
                "samples of {name} repeat one value from {from_s:.2} s to {to_s:.2} s while the plan moves: \
                 frozen sensor, or a joint that did not answer"
            ),
        );
    }
}

/// Whether one range is so many times the other as degrees are radians.
pub(super) fn looks_like_degrees(ratio: f64) -> bool {
    (ratio / DEGREES_IN_RADIAN - 1.0).abs() < RATIO_TOLERANCE
}

/// Remarks on angles that look like degrees.
fn of_units(
    planned: &Track,
    measured: &Track,
    (options, stated): (&ReadOptions, bool),
    remarks: &mut Remarks,
) {
    let (plan_rad, angle_rad) = (span_rad(planned.position()), span_rad(measured.position()));
    let name = planned.name();
    let drop = |option: &str, of: &str| format!("{option} does that to {of} in radians: drop it");
    // Headers, or an option of the import, state units, and the ranges do not agree: what spans more than a joint does was in degrees,
    // or else what spans less was in radians.
    let say = |hint: &str, [less, more]: [&str; 2]| {
        let too_much = plan_rad.max(angle_rad) > TURN_AND_A_HALF_RAD;
        let (side, factor) = if too_much { (more, "0.01745329") } else { (less, "57.29578") };
        let wrong = format!(
            "one of the two was read in a wrong unit, by its header or an option: put that right, or import it with {side} \
             {name}={factor}*COLUMN"
        );
        if stated { wrong } else { hint.to_owned() }
    };
    let message = if looks_like_degrees(angle_rad / plan_rad) {
        let cause = if options.planned_in_degrees {
            drop("--planned-degrees", "a plan")
        } else {
            say("measured in degrees? then say --measured-degrees", ["--planned", "--measured"])
        };
        format!("{name} spans 57.3 times its plan: {cause}")
    } else if looks_like_degrees(plan_rad / angle_rad) {
        let cause = if options.measured_in_degrees {
            drop("--measured-degrees", "a measurement")
        } else {
            say("in degrees? then say --planned-degrees", ["--measured", "--planned"])
        };
        format!("the plan of {name} spans 57.3 times the measurement: {cause}")
    } else if plan_rad.min(angle_rad) > TURN_AND_A_HALF_RAD && !options.continuous.iter().any(|c| c == name) {
        let spans = format!("{name} spans {angle_rad:.1} rad in plan and measurement");
        if stated {
            format!(
                "{spans}: if it turns as far, as of a joint without end stops, --continuous {name}; else the unit in its header is wrong"
            )
        } else {
            format!(
                "{spans}: both in degrees? then say --planned-degrees --measured-degrees; or, if it slides, --slides {name}=mm (of a table \
                 that was imported, import it so); or, if it has no end stops, --continuous {name}"
            )
        }
    } else {
        return;
    };
    remarks.add(Code::LooksLikeDegrees, 1, message);
}

/// So many samples tell a range.
const ENOUGH: usize = 10_000;

/// Range without the outermost hundredth at either end, rad; of a long log, of samples evenly spread over it.
fn span_rad(angle_rad: &[f64]) -> f64 {
    let step = (angle_rad.len() / ENOUGH).max(1);
    let some: Vec<f64> = angle_rad.iter().copied().step_by(step).collect();
    quantile(some.clone(), 0.99) - quantile(some, 0.01)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(position: impl Fn(f64) -> f64) -> Track {
        Track::sampled("a", 500, position)
    }

    fn codes(planned: Track, measured: Track) -> Vec<Code> {
        let mut remarks = Remarks::default();
        let (planned, measured) = (Series { tracks: vec![planned] }, Series { tracks: vec![measured] });
        of_pairs([&planned, &measured], &ReadOptions::default(), &BTreeSet::new(), &mut remarks);
        remarks.as_slice().iter().map(|r| r.code).collect()
    }

    #[test]
    fn degrees_against_radians_are_noticed_and_equal_units_are_not() {
        let plan = |t: f64| (t * 1.3).sin();
        assert_eq!(codes(track(plan), track(move |t| plan(t) / DEGREE_RAD)), [Code::LooksLikeDegrees]);
        assert_eq!(codes(track(move |t| plan(t) / DEGREE_RAD), track(plan)), [Code::LooksLikeDegrees]);
        assert_eq!(codes(track(plan), track(move |t| plan(t) * 0.8)), []);
    }

    #[test]
    fn a_sensor_that_stands_still_while_the_plan_moves_is_noticed() {
        let frozen = |t: f64| if (1.0..2.0).contains(&t) { 0.2 } else { 0.2 * t };
        assert_eq!(codes(track(|t| 0.2 * t), track(frozen)), [Code::Implausible, Code::FrozenSensor]);
        assert_eq!(codes(track(|_| 0.0), track(|_| 0.0)), []);
    }
}
