//! The words of `join`.

use std::path::Path;

use super::{
    kit::{Block, Document, Fact, Id, Section, Sentence, counted, fact},
    metric::{lengths_as_angles, position},
    next,
};
use crate::{
    series::JointKind,
    workflow::join::{Gathered, Joined},
};

/// The files of a run as one log.
pub(crate) fn gathered(gathered: &Gathered, output: &Path) -> Document {
    let Gathered { files, messages, duration_s, remarks, .. } = gathered;
    let written = format!(
        "{messages} messages of {} written to {}: all that they hold, {duration_s:.2} s.",
        counted(*files, "file"),
        output.display()
    );
    let section = Section::plain(Id::SUMMARY, [Sentence::finding(written)]);
    let next = if gathered.planned_joints == 0 {
        next::plan_missing(section, &[output])
    } else {
        next::report(section, &[output])
    };
    Document::default().with(next).remarked(remarks)
}

pub(crate) fn document(joined: &Joined, plan: &Path, output: &Path) -> Document {
    let Joined { sent, sent_is_command, located, at_s, duration_s, joints, messages, .. } = joined;
    let plan = plan.display();
    if joined.keeps_plan {
        return with_its_plan(joined, &plan.to_string(), output);
    }
    let what = if *sent_is_command { "command" } else { "plan" };
    let sent = match (sent, located) {
        (Some(topic), Some(found)) => format!(
            "{topic}: the {what} of {plan} from {at_s:.3} s on, {} rms apart on {}{}",
            position(JointKind::common(joined.kinds.iter().copied()), found.rms_rad),
            counted(found.joints, "joint"),
            lengths_as_angles(joined.kinds.iter().copied())
                .map_or(String::new(), |counts| format!(" ({counts})"))
        ),
        _ => format!("the {what} of {plan} from {at_s:.3} s on, as given"),
    };
    let planned = format!(
        "{duration_s:.2} s of {} in /planned/joint_states, held {:.2} s before and {:.2} s after",
        counted(*joints, "joint"),
        joined.rest_before_s,
        joined.rest_after_s
    );
    let written =
        format!("{messages} messages of the run and the plan of {plan} written to {}.", output.display());
    told(joined, written, vec![fact("sent", sent), fact("plan", planned)], output)
}

/// Of a log that had the plan.
fn with_its_plan(joined: &Joined, plan: &str, output: &Path) -> Document {
    let Joined { at_s, duration_s, joints, messages, .. } = joined;
    let planned =
        format!("{duration_s:.2} s of {} as the log has it, from {at_s:.3} s on", counted(*joints, "joint"));
    let sent =
        format!("the command of {plan}, which was sent as it stands if the log does not say otherwise");
    let written = format!(
        "{messages} messages of the run, which holds its plan, and the command of {plan} written to {}.",
        output.display()
    );
    told(joined, written, vec![fact("plan", planned), fact("sent", sent)], output)
}

fn told(joined: &Joined, written: String, mut facts: Vec<Fact>, output: &Path) -> Document {
    if !joined.files.is_empty() {
        facts.push(fact("files", joined.files.join(", ")));
    }
    let section = Section::plain(Id::SUMMARY, [Sentence::finding(written)]).with(Block::Facts(facts));
    Document::default().with(next::report(section, &[output])).remarked(&joined.remarks)
}
