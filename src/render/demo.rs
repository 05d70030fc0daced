//! The loop, told in one screen.

use std::path::Path;

use super::compare::at_the_tool;
use super::kit::{Document, Id, NONE, Section, Sentence, Table, counted, deg, optional, probability};
use crate::{
    math::whole,
    replay::PEAK_ERROR,
    task::Objective,
    workflow::{
        compare::{Comparison, Scope, Summary, Verdict},
        fit::Fitted,
        plan::Planned,
        replan::Replanned,
    },
};

#[derive(Debug)]
pub(crate) struct Story<'a> {
    /// Where the files are.
    pub(crate) dir: &'a Path,
    /// The words of both simulations.
    pub(crate) machine: [String; 2],
    pub(crate) planned: &'a Planned,
    pub(crate) fitted: &'a Fitted,
    pub(crate) replanned: &'a Replanned,
    pub(crate) comparison: &'a Comparison,
}

/// Columns of a bar for the largest value.
const WIDTH: f64 = 40.0;

pub(crate) fn document(story: &Story<'_>) -> Document {
    let Story { planned, fitted, replanned, comparison, .. } = story;
    let before = &replanned.before;
    let skills = || fitted.fit.joints.iter().map(|joint| joint.held_out_r2);
    let commands = replanned.command.as_ref();
    let most = commands.map_or(0.0, |command| {
        command.joints.iter().map(|joint| joint.peak_correction_rad).fold(0.0, f64::max)
    });
    let steps = [
        (
            "plan task-1.toml -o plan.mcap".to_owned(),
            format!(
                "{:.2} s through the key points, chosen among {} plans",
                planned.chosen.objectives[Objective::Duration],
                planned.front.len()
            ),
        ),
        (
            story.machine[0].clone(),
            "simulates valves, oil, friction, encoders; the arm starts late".to_owned(),
        ),
        (
            "report run-1.mcap".to_owned(),
            format!(
                "{} starts and reversals, peak error {} deg in the mean, {} deg at worst",
                before.measured_transitions,
                optional(before.measured_mean_peak_rad, deg),
                optional(before.measured_worst_peak_rad, deg)
            ),
        ),
        (
            "fit run-1.mcap -o limits.toml".to_owned(),
            format!(
                "{} joints; in data not fitted to, R2 of the prediction is {:.2} to {:.2}",
                fitted.fit.joints.len(),
                skills().fold(f64::INFINITY, f64::min),
                skills().fold(f64::NEG_INFINITY, f64::max)
            ),
        ),
        (
            "replan run-1.mcap --limits limits.toml -o next.mcap --force".to_owned(),
            format!(
                "plan {}, command corrected by {} deg at most; peak error of {} deg expected",
                if replanned.retimed { "re-timed" } else { "kept" },
                deg(most),
                deg(replanned.after.mean_peak_rad)
            ),
        ),
        (story.machine[1].clone(), "the same machine, other noise".to_owned()),
        ("compare run-1.mcap run-2.mcap".to_owned(), compared(comparison)),
    ];
    let told = |(command, found)| [format!("$ hydrotrace {command}"), format!("    {found}")];
    let lines = steps.into_iter().flat_map(told);
    let tool = at_the_tool(comparison).map(|changes| format!("at the tool {changes}"));
    let said = tool.into_iter().chain(luck(comparison));
    let page = [
        "$ hydrotrace compare run-1.mcap run-2.mcap -o compare.html",
        "    the same as a page: open it in a browser",
    ];
    let lines = lines.chain(said.map(|said| format!("    {said}"))).chain(page.map(str::to_owned));
    let lines = lines.map(Sentence::Finding);
    let dir = story.dir.display();
    let last = format!(
        "Plan {:.2} s before, {:.2} s after. Run any of these commands in {dir} to see its full output.",
        before.duration_s, replanned.duration_s
    );
    let title = "From a task to a better run, on a simulated hydraulic arm; the files are in";
    let heading = "Mean peak error at starts and reversals, first and second run";
    let table = Table::new(&["joint", "run", ""], &["deg"], bars(comparison));
    Document::titled(format!("{title} {dir}"))
        .with(Section::new(Id::OTHER, "Steps", lines))
        .with(Section::new(Id::SUMMARY, heading, [table]).with(Sentence::finding(last)))
        .remarked(&replanned.remarks)
}

fn peaks<'a>(comparison: &'a Comparison, scope: &Scope) -> Option<&'a Summary> {
    comparison.summaries.iter().find(|s| s.measure.key == PEAK_ERROR && s.scope == *scope)
}

fn compared(comparison: &Comparison) -> String {
    let Some(all) = peaks(comparison, &Scope::All) else { return NONE.to_owned() };
    let (Some(before), Some(after), Some(change)) = (all.mean_before, all.mean_after, all.relative_change)
    else {
        return "no transition has a counterpart".to_owned();
    };
    format!(
        "peak error {} -> {} deg in the mean ({:+.0} %), {} of {} that both runs have smaller",
        deg(before),
        deg(after),
        100.0 * change,
        all.smaller,
        counted(all.pairs, "start"),
    )
}

/// What the test says; one run each cannot say more where the starts are few.
fn luck(comparison: &Comparison) -> Option<String> {
    let all = peaks(comparison, &Scope::All)?;
    let events = counted(all.events, "event");
    let (too_few, p) = (all.verdict == Verdict::TooFew, probability(all.p_value));
    let few = || format!("{events} of starts are too few for p below {}", probability(all.least_p()));
    Some(if too_few { few() } else { format!("{events} of starts, p = {p}") })
}

/// A bar for each joint before and after.
fn bars(comparison: &Comparison) -> Vec<Vec<String>> {
    let joints = || {
        comparison.joints.iter().filter_map(|joint| {
            let found = peaks(comparison, &Scope::Joint(joint.clone()))?;
            Some((joint, found.mean_before?, found.mean_after?))
        })
    };
    let most = joints().map(|(_, before, after)| before.max(after)).fold(f64::MIN_POSITIVE, f64::max);
    let bar = |value: f64| "#".repeat(whole((value / most * WIDTH).round()).max(1));
    joints()
        .flat_map(|(joint, before, after)| {
            [
                vec![joint.clone(), "1".into(), bar(before), deg(before)],
                vec![String::new(), "2".into(), bar(after), deg(after)],
            ]
        })
        .collect()
}
