//! A plan for the next run as tables.

use super::{OF_COMMAND, joint_name};
use crate::{
    log::Topics,
    plan::Margin,
    render::{NONE, Part, Sheet, counted, deg, plan, tables::remark_parts},
    units::degrees_from_radians,
    workflow::replan::{HeldTo, JointCommand, Origin, Predicted, Replanned},
};

/// A limit used more than this is near.
const NEAR: f64 = 0.9;

/// A plan for the next run, for people.
pub fn replan_parts(replanned: &Replanned) -> Vec<Part> {
    let title = replanned.request.as_ref().map_or("the logged plan", |request| request.task.title.as_str());
    let mut parts = vec![
        Part::Title(format!("Next run of {title}")),
        Part::Line(format!("Learnt from {}.", replanned.fitted_to.join(", "))),
        Part::Heading("Expected".into()),
        expected(replanned),
        Part::Line(format!(
            "Expected peaks hold what the model left unexplained after held-out starts; nine of ten stay below: the \
             predicted peak times {:.2}, or what was left unexplained in nine of ten.",
            replanned.fit.peak_margin
        )),
        Part::Heading("Levers".into()),
        Part::Facts(levers(replanned)),
    ];
    if let Some(command) = &replanned.command {
        parts.push(Part::Heading("Command".into()));
        parts.push(Part::Sheet(Sheet {
            head: vec![
                "joint",
                "held-out R2",
                "gain",
                "off plan deg",
                "rms error deg",
                "then deg",
                "speed x",
                "acceleration x",
            ],
            left: 1,
            rows: command.joints.iter().map(|joint| command_row(replanned, joint)).collect(),
        }));
        parts.push(Part::Line(
            "Rms errors are predicted, of the plan sent as it is and then of the command; speed x and acceleration x are \
             the command's peaks by those of the plan."
                .into(),
        ));
        parts.extend(cut_off(&command.joints).map(Part::Line));
        parts.push(Part::Line(nearest(replanned, &command.margins)));
    }
    if let Some(search) = &replanned.search {
        parts.push(Part::Heading("The plan was held to".into()));
        parts.push(Part::Sheet(Sheet {
            head: vec!["joint", "speed deg/s", "by", "acceleration deg/s2", "by"],
            left: 1,
            rows: search.held.iter().map(held_row).collect(),
        }));
    }
    remark_parts(&replanned.remarks, &mut parts);
    parts
}

fn percent(now: f64, then: f64) -> String {
    if now > 0.0 { format!("{:+.0} %", 100.0 * (then / now - 1.0)) } else { NONE.to_owned() }
}

fn expected(replanned: &Replanned) -> Part {
    let (before, after) = (&replanned.before, &replanned.after);
    let now = &before.predicted;
    let optional = |value: Option<f64>| value.map_or(NONE.to_owned(), deg);
    let error = |name: &str, measured: Option<f64>, of: fn(&Predicted) -> f64| {
        let change = percent(of(now), of(after));
        vec![name.to_owned(), optional(measured), deg(of(now)), deg(of(after)), change]
    };
    let count = |p: &Predicted| p.transitions.len();
    let mut rows = vec![
        error("mean transition peak deg", before.measured_mean_peak_rad, |p| p.mean_peak_rad),
        error("  nine of ten below deg", None, |p| p.mean_peak_margin_rad),
        error("worst transition peak deg", before.measured_worst_peak_rad, |p| p.worst_peak_rad),
        error("sum of peaks deg", None, |p| p.sum_of_peaks_rad),
        vec![
            "starts + reversals".into(),
            before.measured_transitions.to_string(),
            format!("{} + {}", now.starts, now.reversals),
            format!("{} + {}", after.starts, after.reversals),
            percent(count(now) as f64, count(after) as f64),
        ],
        vec![
            "time of motion s".into(),
            format!("{:.2}", before.duration_s),
            NONE.into(),
            format!("{:.2}", replanned.duration_s),
            percent(before.duration_s, replanned.duration_s),
        ],
    ];
    let costs =
        (&replanned.objectives_before, replanned.evaluation.as_ref().map(|evaluation| evaluation.objectives));
    if let (Some(was), Some(is)) = costs {
        let [jerk, then] = [was.rms_jerk_rad_s3, is.rms_jerk_rad_s3];
        rows.push(vec![
            "RMS jerk deg/s3".into(),
            format!("{:.4}", degrees_from_radians(jerk)),
            NONE.into(),
            format!("{:.4}", degrees_from_radians(then)),
            percent(jerk, then),
        ]);
        rows.push(vec![
            "RMS power W".into(),
            format!("{:.1}", was.rms_power_w),
            NONE.into(),
            format!("{:.1}", is.rms_power_w),
            percent(was.rms_power_w, is.rms_power_w),
        ]);
    }
    Part::Sheet(Sheet { head: vec!["", "last run", "its model", "next run", "change"], left: 1, rows })
}

fn levers(replanned: &Replanned) -> Vec<(String, String)> {
    let plan = match (&replanned.search, replanned.retimed, &replanned.evaluation) {
        (None, ..) => "stays as it was".to_owned(),
        (Some(search), false, _) => format!(
            "stays: of {} timings with no more time, jerk and power than allowed none is expected to follow better",
            search.front.len()
        ),
        (Some(search), true, evaluation) => {
            let times = evaluation.as_ref().map_or_else(String::new, |evaluation| {
                evaluation.times_s.iter().map(|t| format!("{t:.2}")).collect::<Vec<_>>().join(" ")
            });
            format!(
                "re-timed, one of {} timings of {} evaluations: {times} s",
                search.front.len(),
                search.evaluations
            )
        }
    };
    let command = replanned.command.as_ref().map_or("is the plan".to_owned(), |command| {
        let joints = &command.joints;
        let applied = joints.iter().filter(|joint| joint.compensation.applied && joint.gain > 0.0);
        let most = joints.iter().map(|joint| joint.compensation.peak_correction_rad).fold(0.0, f64::max);
        format!(
            "pre-compensated on {} of {}, up to {} deg off the plan",
            applied.count(),
            counted(joints.len(), "joint"),
            deg(most)
        )
    });
    let ours = Topics::default();
    let trajectory = replanned.trajectory.as_deref().unwrap_or(&ours.trajectory);
    let samples = if replanned.command.is_some() { &ours.command } else { &ours.planned };
    let send =
        format!("{samples}, or the same as a trajectory, {trajectory}; judge against {}", ours.planned);
    vec![("plan".into(), plan), ("command".into(), command), ("send".into(), send)]
}

fn command_row(replanned: &Replanned, joint: &JointCommand) -> Vec<String> {
    let made = &joint.compensation;
    let skill = replanned.fit.joint(&made.name).map(|fit| format!("{:.2}", fit.held_out_r2));
    let rms = |value: Option<f64>| value.map_or(NONE.to_owned(), deg);
    vec![
        made.name.clone(),
        skill.unwrap_or_else(|| NONE.to_owned()),
        format!("{:.2}", joint.gain),
        deg(made.peak_correction_rad),
        rms(made.plain_rms_rad),
        rms(made.compensated_rms_rad),
        format!("{:.2}", made.speed_ratio),
        format!("{:.2}", made.acceleration_ratio),
    ]
}

/// Which corrections would have been larger.
fn cut_off(joints: &[JointCommand]) -> Option<String> {
    let all: Vec<&JointCommand> = joints.iter().filter(|joint| joint.compensation.cut_off).collect();
    let most = all.iter().map(|joint| joint.compensation.peak_correction_rad).reduce(f64::max)?;
    let names: Vec<&str> = all.iter().map(|joint| joint.compensation.name.as_str()).collect();
    Some(format!(
        "Cut off at {} deg, gain counted, on {}: with a larger --max-correction-deg more of the error is expected to go.",
        deg(most),
        names.join(", ")
    ))
}

fn nearest(replanned: &Replanned, margins: &[Margin]) -> String {
    let mut own: Vec<&Margin> = margins
        .iter()
        .filter(|margin| OF_COMMAND.contains(&margin.limit) || margin.joint.is_none())
        .collect();
    own.sort_by(|a, b| b.share.total_cmp(&a.share));
    let Some(worst) = own.first() else {
        return "Without a task no limits of the arm are known: hold the command against yours before it is sent.".into();
    };
    let near = own.iter().filter(|margin| margin.share > NEAR).count();
    let joint = joint_name(replanned, worst.joint).map_or(String::new(), |name| format!("{name} "));
    format!(
        "Limits re-checked on the command: nearest is {joint}{}, {} of {} allowed at {:.2} s{}.",
        plan::name(worst.limit),
        plan::shown(worst.limit, worst.value.abs()),
        plan::shown(worst.limit, worst.allowed),
        worst.t_s,
        if near > 1 { format!("; {near} are used to nine tenths or more") } else { String::new() }
    )
}

fn held_row(held: &HeldTo) -> Vec<String> {
    let by = |origin: Origin| match origin {
        Origin::Task => "the task",
        Origin::Fitted => "the fit",
        Origin::Shown => "what was shown",
    };
    let number =
        |rad: f64| if rad.is_finite() { format!("{:.1}", degrees_from_radians(rad)) } else { NONE.into() };
    vec![
        held.joint.clone(),
        number(held.speed_rad_s),
        by(held.speed_origin).into(),
        number(held.acceleration_rad_s2),
        by(held.acceleration_origin).into(),
    ]
}
