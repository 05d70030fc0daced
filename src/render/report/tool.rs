//! What the errors of the joints are at the tool, in words and tables.

use crate::{
    render::{
        kit::{Block, Column, Id, Section, Sentence, Table, deg, mm, optional, share},
        metric::{Units, position},
    },
    replay::{TOOL, ToolCause, ToolDeviation, ToolReplay, ToolRest},
    series::JointKind,
    workflow::report::{Report, Tool},
};

pub(super) const ID: Id = Id("tool");

/// The answer in a sentence; `None` where there is no arm.
pub(super) fn sentence(tool: &Tool) -> Option<String> {
    let Some(found) = tool.found() else {
        return tool.why_not().map(|why| format!("At the tool: the error is not known, because {why}."));
    };
    let worst = &found.worst;
    let end = found
        .end()
        .map_or(String::new(), |end| format!(", {} mm when it came to rest", mm(end.deviation.error_m)));
    Some(format!(
        "At the tool: {} mm off at {:.1} s (RMS {} mm){end}{}.",
        mm(worst.deviation.error_m),
        worst.time_s,
        mm(found.rms_m),
        main_cause(&worst.deviation).map_or(String::new(), |cause| format!("; {cause} of the worst"))
    ))
}

/// `J3 causes 62 %`.
pub(super) fn main_cause(deviation: &ToolDeviation) -> Option<String> {
    deviation.main_cause().map(|cause| format!("{} causes {}", cause.joint, share(cause.share)))
}

/// Figures, causes and rests; `most` is how many rests to list.
pub(super) fn section(report: &Report, most: usize) -> Option<Section> {
    let tool = report.tool.found()?;
    let units = Units::of(std::iter::once(JointKind::Slides));
    let mut blocks: Vec<Block> = vec![units.table(TOOL, std::iter::once((tool, JointKind::Slides))).into()];
    if !tool.worst.deviation.causes.is_empty() {
        blocks.push(causes(tool).into());
    }
    if !tool.rests.is_empty() {
        blocks.push(rests(&tool.rests, most).into());
    }
    blocks.push(Sentence::note(how(tool)).into());
    Some(Section::new(ID, "At the tool", blocks))
}

fn how(tool: &ToolReplay) -> String {
    let moving = tool.split.map_or(0, |split| split.samples);
    let causes = match tool.worst.deviation.causes.as_slice() {
        [] => "",
        _ => {
            " A joint makes of the distance its error times the Jacobian's column; what is not linear in the errors is left \
             over."
        }
    };
    format!(
        "Distance between the planned and the measured {} at {} instants from {:.2} s to {:.2} s; along and across the planned \
         direction at the {moving} instants at which the plan moves it.{causes}",
        tool.tool, tool.samples, tool.window_s[0], tool.window_s[1],
    )
}

/// What each joint makes of the worst distance, and of that at the end.
fn causes(tool: &ToolReplay) -> Table {
    let sides: Vec<&ToolDeviation> =
        std::iter::once(&tool.worst.deviation).chain(tool.end().map(|end| &end.deviation)).collect();
    let mut columns = vec![Column::words("joint")];
    for side in ["at worst", "at the end"].iter().take(sides.len()) {
        columns.push(
            Column::numbers(format!("error {side}")).meaning("Planned minus measured position of the joint."),
        );
        columns.push(
            Column::numbers("makes mm")
                .meaning("What that makes of the tool's distance; negative if it lessens it.")
                .going_on(),
        );
        columns.push(Column::numbers("share").meaning("The same as a share of the distance.").going_on());
    }
    let cells = |cause: Option<&ToolCause>| match cause {
        Some(cause) => [position(cause.kind, cause.joint_error), mm(cause.error_m), share(cause.share)],
        None => ["-".to_owned(), mm(0.0), share(0.0)],
    };
    let joints = sides.iter().map(|side| &side.causes).max_by_key(|causes| causes.len());
    let mut rows: Vec<Vec<String>> = joints
        .into_iter()
        .flatten()
        .enumerate()
        .map(|(k, cause)| {
            let all = sides.iter().flat_map(|side| cells(side.causes.get(k)));
            std::iter::once(cause.joint.clone()).chain(all).collect()
        })
        .collect();
    let left = sides.iter().flat_map(|side| {
        ["-".to_owned(), mm(side.nonlinear_share * side.error_m), share(side.nonlinear_share)]
    });
    rows.push(std::iter::once("left over".to_owned()).chain(left).collect());
    Table::of(columns, rows)
}

fn rests(rests: &[ToolRest], most: usize) -> Table {
    let row = |rest: &ToolRest| {
        vec![
            if rest.at_end { "end" } else { "dwell" }.to_owned(),
            rest.deviation.main_cause().map_or("-".to_owned(), |cause| cause.joint.clone()),
            format!("{:.2}", rest.from_s),
            format!("{:.2}", rest.to_s),
            mm(rest.arrival_m),
            mm(rest.deviation.error_m),
            optional(rest.deviation.orientation_rad, deg),
        ]
    };
    let columns = [
        Column::words("rest"),
        Column::words("main cause").meaning("The joint that makes most of the distance at rest."),
        Column::numbers("from s").meaning("When the plan comes to rest."),
        Column::numbers("to s").meaning("When the plan moves on, or the run ends."),
        Column::numbers("on arrival mm").meaning("Distance when the plan comes to rest."),
        Column::numbers("at rest mm")
            .meaning("Distance at which the tool stands at last: mean over the end of the rest."),
        Column::numbers("angle deg").meaning("Angle between planned and measured orientation there."),
    ];
    Table::of(columns, rests.iter().take(most).map(row).collect::<Vec<_>>())
}
