//! A fit as tables.

use std::f64::consts::TAU;

use super::{Shown, supply};
use crate::{
    fit::{
        Estimated, Fit, JointFit, LEAST_SHARP_SKILL, LEAST_SKILL, LEAST_SMOOTH_SKILL, LeftOut, MARGIN_STARTS,
        MOST_MARGIN, MOST_UNEXPLAINED, SharedJoint, SharedLimit,
    },
    render::{
        kit::{Column, Document, Id, Section, Sentence, Table, counted, some_of},
        metric::{Units, number, position, with_unit},
    },
    replay::Dimension,
    series::JointKind,
    text::shell_word,
    units::DEGREE_RAD,
    workflow::fit::{Fitted, torque::JointTorque},
};

/// A play of less, rad, goes without a word: what holds a joint before it reverses makes up to 0.22 deg of one where there is 0.04.
const PLAY_RAD: f64 = 0.3 * DEGREE_RAD;

const LOOP: [Shown; 5] = [
    shown("lag", "lag", |j| j.lag_s, Dimension::Duration, 0),
    shown("dead band", "dead band", |j| j.dead_band_rad_s, Dimension::Speed, 2),
    shown("dead-band error", "dead-band error", |j| j.dead_band_error_rad, Dimension::Position, 2),
    shown("gain 1/s", "position gain", |j| j.position_gain_1_s, Dimension::Count, 2),
    shown("feed-forward", "feed-forward", |j| j.feed_forward, Dimension::Count, 2),
];

const LIMITS: [Shown; 2] = [
    shown("speed +", "speed limit, growing", |j| j.speed_limit_growing_rad_s, Dimension::Speed, 1),
    shown("speed -", "speed limit, shrinking", |j| j.speed_limit_shrinking_rad_s, Dimension::Speed, 1),
];

/// A joint whose gain is that of the other way by less than this share is alike both ways.
const ALIKE: f64 = 0.03;

const RATIO: Shown = shown("ratio", "gain ratio", |j| j.gain_ratio, Dimension::Count, 2);

const LATE: Shown = shown("late", "set values late", |j| j.set_values_late_s, Dimension::Duration, 0);

/// Share of the full signal to each side.
const VALVE: [Shown; 2] = [
    shown("dead band + %", "valve dead band, growing", |j| valve(j, 0), Dimension::Share, 1),
    shown("dead band - %", "valve dead band, shrinking", |j| valve(j, 1), Dimension::Share, 1),
];

const fn shown(
    heading: &'static str,
    name: &'static str,
    of: fn(&JointFit) -> Estimated,
    dimension: Dimension,
    decimals: usize,
) -> Shown {
    Shown { heading, name, of, dimension, decimals }
}

fn valve(joint: &JointFit, side: usize) -> Estimated {
    joint.valve_dead_band.map_or(Estimated::default(), |sides| sides[side])
}

pub(crate) fn document(fitted: &Fitted) -> Document {
    let fit = &fitted.fit;
    let samples: usize = fit.joints.iter().map(|joint| joint.samples).sum();
    let logs: Vec<&str> = fitted.runs.iter().map(|run| run.log.as_str()).collect();
    let commanded = fitted.runs.iter().filter(|run| run.commanded).count();
    let sent = match commanded {
        0 => "the plan was sent".to_owned(),
        all if all == fitted.runs.len() => "the logged command was sent".to_owned(),
        some => format!("the logged command was sent in {some} of the runs, the plan in the others"),
    };
    let seen = format!(
        "{}, {samples} samples; {sent}. Each value has a 95 % interval, widened for model error.",
        counted(fit.joints.len(), "joint")
    );
    let mut document = Document::titled(format!("Limits of the machine in {}", logs.join(", ")))
        .with(Section::plain(Id::SUMMARY, [Sentence::finding(seen)]));
    document.sections.extend(machine(fit));
    document.sections.extend(torques(&fitted.torques));
    document.with(Section::new(Id::OTHER, "How far to trust it", trust(fitted))).remarked(&fitted.remarks)
}

pub(super) fn machine(fit: &Fit) -> Vec<Section> {
    let mut sections = vec![
        Section::new(Id::OTHER, "Closed loop", [table(fit, &LOOP, true)]).with(Sentence::note(
            "Held-out R2: share of the tracking error that the model predicts in data it was not fitted to. Unexplained: mean \
             peak of the error that it leaves there after a start. Dead band: speed that must be commanded before the joint \
             leaves rest, in the mean of both ways; dead-band error: the largest error that stays uncorrected in it. Gain: commanded speed per error; \
             feed-forward: commanded speed per speed of the plan. <= x: starts are too smooth to show the lag, and it is below. \
             A recorder that stamps the measurement late looks like a lag of that size.",
        )),
        Section::new(Id::OTHER, "Limits", [table(fit, &LIMITS, false)]).with(Sentence::note(
            "+ for growing, - for shrinking angles or lengths. >= x: x was reached, so the limit is no lower. (x): an assumption, not \
             measured.",
        )),
    ];
    if fit.joints.iter().any(|joint| joint.valve_dead_band.is_some()) {
        sections.push(Section::new(Id::OTHER, "Valves", [table(fit, &VALVE, false)]));
    }
    sections
}

fn torques(torques: &[JointTorque]) -> Option<Section> {
    let row = |torque: &JointTorque| {
        let both = torque.reached_n_m.iter().zip(torque.available_n_m);
        let cells = both.flat_map(|(reached, available)| [*reached, available]);
        let mut row = vec![torque.name.clone()];
        row.extend(cells.map(|n_m| format!("{n_m:.0}")));
        row
    };
    let numbers = ["reached + N m", "available +", "reached - N m", "available -"];
    let table = Table::new(&["joint"], &numbers, torques.iter().map(row));
    (!torques.is_empty()).then(|| {
        Section::new(Id::OTHER, "Torques from pressures", [table]).with(Sentence::note(
            "Available: torque at the logged supply pressure in the least favourable pose of the run; friction and flow \
             losses reduce it.",
        ))
    })
}

fn table(fit: &Fit, columns: &[Shown], skill: bool) -> Table {
    let units = Units::of(fit.joints.iter().map(|joint| joint.kind));
    let unexplained = units.heading("unexplained", Dimension::Position);
    let mut numbers = if skill { vec!["held-out R2".to_owned(), unexplained] } else { Vec::new() };
    numbers.extend(columns.iter().map(|shown| units.heading(shown.heading, shown.dimension)));
    let row = |joint: &JointFit| {
        let mut row = vec![joint.name.clone()];
        if skill {
            row.push(format!("{:.2}", joint.held_out_r2));
            let mean = joint.unexplained_peak_rad.map(|[mean, _]| mean);
            row.push(units.optional(Dimension::Position, joint.kind, mean));
        }
        row.extend(columns.iter().map(|shown| shown.cell(joint, units)));
        row
    };
    let columns = std::iter::once(Column::words("joint")).chain(numbers.into_iter().map(Column::numbers));
    Table::of(columns.collect::<Vec<_>>(), fit.joints.iter().map(row))
}

/// What joints share, and what each makes alone.
pub(in crate::render) fn shared(limit: &SharedLimit) -> String {
    let names: Vec<&str> = limit.joints.iter().map(|joint| joint.name.as_str()).collect();
    let alone = |joint: &SharedJoint| {
        let value = position(joint.kind, joint.alone_rad_s);
        let interval = joint.interval_rad_s.map_or(String::new(), |[low, high]| {
            let shown = |rad_s| number(Dimension::Position, joint.kind, rad_s);
            format!(" ({} to {})", shown(low), shown(high))
        });
        format!("{} {value}/s{interval}", joint.name)
    };
    format!(
        "{} share a limit, as those that one pump feeds do. With all of it {}; where they move together each makes its part of that, and \
         so they do for {:.0} % of the time in which two or more move ({:.1} s in {}).",
        names.join(", "),
        limit.joints.iter().map(alone).collect::<Vec<_>>().join(", "),
        100.0 * limit.share,
        limit.duration_s,
        counted(limit.stretches, "part")
    )
}

/// How far peaks may be above what is predicted.
pub(super) fn margin(fit: &Fit) -> String {
    let (starts, times) = (counted(fit.margin_starts, "held-out start"), fit.peak_margin);
    if fit.margin_starts < MARGIN_STARTS {
        return format!(
            "Measured peaks are taken to stay below {times:.2} times the predicted ones: {starts} tell nothing of it."
        );
    }
    let most = if times < MOST_MARGIN { "" } else { ", or above it: no more is reckoned with" };
    format!("In 90 % of {starts} the measured peak stays below {times:.2} times the predicted one{most}.")
}

/// What the numbers are good for, and what would tell the rest.
fn trust(fitted: &Fitted) -> Vec<Sentence> {
    let fit = &fitted.fit;
    let good = fit.joints.iter().filter(|joint| joint.trusted()).count();
    let doubtful = fit.joints.iter().filter(|joint| joint.trusted() && !joint.model_holds).count();
    let mut lines = vec![format!(
        "Commands can be made of the model alone for {}{}: a held-out R2 of {LEAST_SKILL} is enough. {}",
        some_of(good, fit.joints.len(), "joint"),
        if doubtful == 0 {
            String::new()
        } else {
            format!(", with care of {doubtful} whose model does not hold")
        },
        margin(fit)
    )];
    let starved = fit.supply.as_ref().map(supply);
    lines.extend(starved.or_else(|| fit.shared.as_ref().map(shared)));
    let all = || LOOP.iter().chain(&LIMITS);
    let open: Vec<String> = all()
        .filter_map(|shown| {
            let open = |joint: &&JointFit| joint.model_holds && !(shown.of)(joint).identified;
            let joints: Vec<&str> = fit.joints.iter().filter(open).map(|joint| joint.name.as_str()).collect();
            let of =
                if joints.len() == fit.joints.len() { "any joint".to_owned() } else { joints.join(", ") };
            (!joints.is_empty()).then(|| format!("{} of {of}", shown.name))
        })
        .collect();
    let spoilt = fitted.remarks.as_slice().iter().any(|remark| remark.code.spoils_runs());
    lines.extend(spoilt.then(|| {
        "A run does not belong to its plan, as the remarks say: the numbers are of that, too, not of the machine alone.".into()
    }));
    if open.is_empty() && fit.joints.iter().all(|joint| joint.model_holds) {
        lines.push("The logs identify every number above, if the machine has the model's form.".into());
    } else if !open.is_empty() {
        lines.push(format!("The logs do not identify: {}.", open.join("; ")));
        let why = if fitted.runs.iter().any(|run| run.identifies) {
            "In the strokes of the identification run these joints held no speed that is a limit: they kept up, or gained speed for as long as a \
             stroke lasts. Longer strokes, by a larger --max-speed-deg-s or --max-speed-mm-s of excite and where the range allows, show more."
                .to_owned()
        } else {
            let joints = fit.joints.iter().map(|joint| {
                let unit = if joint.kind == JointKind::Slides { "mm" } else { "" };
                format!(" --joint {}=HOME:LOW:HIGH{unit}", shell_word(&joint.name))
            });
            format!(
                "Smooth runs hardly reach the limits of speed. `hydrotrace excite -o id.mcap{}`, or with the --task of the arm, writes a run \
                 that does, with strokes faster than the machine; it also narrows the interval of the dead band. Fit it together with \
                 these logs.",
                joints.collect::<String>()
            )
        };
        lines.extend(open.iter().any(|open| open.starts_with("speed")).then_some(why));
    }
    lines.extend(named(fit, &|joint| !joint.model_holds).map(|joints| {
        format!(
            "The model does not hold for {joints}: what it leaves unexplained rings, or is more than {:.1} % of the peaks of sharp \
             starts, or its held-out R2 is below {LEAST_SMOOTH_SKILL}, or below {LEAST_SHARP_SKILL} where starts are sharp. \
             Numbers of these joints have no intervals.",
            100.0 * MOST_UNEXPLAINED
        )
    }));
    lines.extend(structure(fit));
    lines.extend(left_out_line(fit));
    lines.into_iter().map(Sentence::Finding).collect()
}

/// The joints of which something is so; `None` of none.
fn named(fit: &Fit, which: &dyn Fn(&JointFit) -> bool) -> Option<String> {
    let joints: Vec<&str> =
        fit.joints.iter().filter(|joint| which(joint)).map(|joint| joint.name.as_str()).collect();
    (!joints.is_empty()).then(|| joints.join(", "))
}

/// Which joints answer more one way than the other.
fn one_way_faster(fit: &Fit) -> Option<String> {
    let one = |joint: &JointFit| {
        let ([low, high], ratio) = (joint.gain_ratio.interval?, joint.gain_ratio.value?);
        let known = joint.model_holds && joint.gain_ratio.identified;
        (known && (low > 1.0 + ALIKE || high < 1.0 - ALIKE)).then(|| {
            let [growing, shrinking] = [ratio.sqrt(), 1.0 / ratio.sqrt()]
                .map(|by| by * joint.position_gain_1_s.value.unwrap_or(0.0));
            let gains = format!("gain {growing:.2} 1/s growing and {shrinking:.2} shrinking");
            format!("{} {} times ({gains})", joint.name, RATIO.alone(joint))
        })
    };
    let joints: Vec<String> = fit.joints.iter().filter_map(one).collect();
    (!joints.is_empty()).then(|| {
        format!(
            "Asked for the same speed, a joint moves growing by another share of it than shrinking: {}. Gains and feed-forwards of the table are \
             those between both ways.",
            joints.join(", ")
        )
    })
}

/// What only some machines have, of joints whose model holds.
fn structure(fit: &Fit) -> Vec<String> {
    let mut lines = Vec::new();
    lines.extend(named(fit, &|joint| joint.model_holds && joint.model.edge_rad_s > 0.0).map(|joints| {
        format!(
            "The speed of {joints} grows by more than what is asked: the valve opens gradually. Gains are those of the \
             wide-open valve."
        )
    }));
    lines.extend(named(fit, &|joint| joint.model_holds && joint.model.opens_beyond > 0.0).map(|joints| {
        format!(
            "The valve of {joints} opens farther than the largest speed takes, so something behind it, a pump or a flow regulator, \
             limits the speed: a joint at its limit comes back from it late."
        )
    }));
    lines.extend(one_way_faster(fit));
    let swinging = fit.joints.iter().filter(|joint| joint.model_holds && joint.model.swings());
    let swinging: Vec<String> = swinging
        .map(|joint| {
            let (hz, damped) = (joint.model.natural_frequency_rad_s / TAU, joint.model.damping_ratio);
            format!("{} at {hz:.1} Hz with {:.0} % of critical damping", joint.name, 100.0 * damped)
        })
        .collect();
    lines.extend((!swinging.is_empty()).then(|| {
        format!(
            "Between valve and sensor a joint swings, on its oil or its link: {}. The lag holds that.",
            swinging.join(", ")
        )
    }));
    let loose = fit.joints.iter().filter(|joint| joint.model_holds && joint.model.backlash_rad > PLAY_RAD);
    let loose: Vec<String> = loose
        .map(|joint| format!("{} {}", joint.name, position(joint.kind, joint.model.backlash_rad)))
        .collect();
    lines.extend(
        (!loose.is_empty()).then(|| {
            format!(
                "Joints are measured as if there were play before the sensor: {}. The hysteresis of a valve looks much alike.",
                loose.join(", ")
            )
        }),
    );
    // Where the gain is not known, neither is a speed by it.
    let held = fit.joints.iter().filter(|joint| joint.model_holds && joint.position_gain_1_s.identified);
    let held: Vec<String> = held
        .filter_map(|joint| {
            let limit = joint.model.integral_limit_rad_s?;
            Some(format!("{} {}", joint.name, with_unit(Dimension::Speed, joint.kind, limit)))
        })
        .collect();
    lines.extend((!held.is_empty()).then(|| {
        format!("The integral of the position loop is held within limits, as a speed: {}.", held.join(", "))
    }));
    let late = fit.joints.iter().filter(|joint| joint.model_holds && joint.model.set_values_late_s() > 0.0);
    let late: Vec<String> = late.map(|joint| format!("{} {}", joint.name, LATE.alone(joint))).collect();
    lines.extend((!late.is_empty()).then(|| {
        format!(
            "Loops answer as if what is sent reached them late, ms: {}. A filter of set values does so, a delay on the way, or \
             late stamps of the measured angles. Lags are those of loop and valve, after that.",
            late.join(", ")
        )
    }));
    lines.extend(named(fit, &|joint| joint.model_holds && !joint.feed_forward.identified).map(|joints| {
        format!(
            "The logs show no sure feed-forward of {joints}. Without one a filter of set values acts as a lower gain, more \
             lag and another dead band: logs of angles hardly tell them apart."
        )
    }));
    lines
}

/// Which joints are not fitted, and why; `None` if all are.
pub(super) fn left_out_line(fit: &Fit) -> Option<String> {
    let one = |joint: &LeftOut| {
        let [sent, needed] = [joint.travel_rad, joint.least_travel_rad].map(|m| position(joint.kind, m));
        format!("{} (its command moves {sent} in all, {needed} are needed)", joint.name)
    };
    let joints: Vec<String> = fit.left_out.iter().map(one).collect();
    (!joints.is_empty()).then(|| format!("Not fitted: {}.", joints.join(", ")))
}
