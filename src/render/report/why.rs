//! Why starts come late, in words, a table and bars.

use crate::{
    math::whole,
    render::kit::{Block, Column, Id, Section, Sentence, Table, counted, ms},
    workflow::report::{LateStart, Part, Report, Why},
};

/// The section of it.
pub(super) const ID: Id = Id("why");

/// Characters of a bar.
const WIDE: f64 = 24.0;

/// Beyond this share of a delay that is unexplained, the rest explains nothing.
const MOSTLY: f64 = 0.5;

/// The parts: what fills the bar, heading, explanation, value.
type Row = (char, &'static str, &'static str, fn(&LateStart) -> Part);

const PARTS: [Row; 4] = [
    (
        '█',
        "dead band ms",
        "While what is sent stays below the dead band and static friction holds: gone without both.",
        |s| s.dead_band,
    ),
    (
        '▒',
        "lag ms",
        "Dead time, time constants and what the loop takes to follow: what the model is late without dead band and limits.",
        |s| s.lag,
    ),
    ('░', "limit ms", "Because a limit of speed or acceleration is reached: gone without it.", |s| s.limit),
    ('?', "unexplained ms", "What would be left without limits and dead band, and is not lag.", |s| {
        s.unexplained
    }),
];

/// The parts of one delay in a phrase, those of note first; one that is negative within its interval is none.
pub(super) fn phrase(start: &LateStart) -> String {
    if start.onset_delay_s < -0.0005 {
        return "the model fitted to this run does not explain why it is early".to_owned();
    }
    let unexplained_s = start.unexplained.delay_s;
    if unexplained_s.abs() > MOSTLY * start.onset_delay_s.abs() {
        return format!(
            "the model fitted to this run does not explain it ({} ms of {})",
            ms(unexplained_s),
            ms(start.onset_delay_s)
        );
    }
    let names = ["dead band", "lag", "limits", "unexplained"];
    let mut parts: Vec<(Part, &str)> =
        PARTS.iter().zip(names).map(|(part, name)| (part.3(start), name)).collect();
    parts.retain(|(part, _)| part.delay_s.abs() >= 0.0005);
    parts.sort_by(|a, b| b.0.delay_s.total_cmp(&a.0.delay_s));
    let word = |(part, name): &(Part, &str)| match part.interval_s {
        Some([low_s, high_s]) if is_unsure(part) || is_wide(part) => {
            format!("{} ms {name} (95 %: {} to {})", ms(part.delay_s), ms(low_s), ms(high_s))
        }
        _ if part.delay_s > 0.0 => format!("{} ms {name}", ms(part.delay_s)),
        Some([_, high_s]) if high_s >= 0.0005 => format!("{name} of at most {} ms", ms(high_s)),
        Some([_, high_s]) if high_s >= 0.0 => format!("no {name}"),
        _ => format!("less {} ms {name}", ms(-part.delay_s)),
    };
    let unsure: Vec<&(Part, &str)> = parts.iter().filter(|(part, _)| is_unsure(part)).collect();
    if let [first, rest @ ..] = unsure.as_slice()
        && !rest.is_empty()
    {
        let sum_s: f64 = unsure.iter().map(|(part, _)| part.delay_s).sum();
        let names: Vec<&str> = rest.iter().map(|(_, name)| *name).collect();
        let together = format!(
            "{} ms {} and {}, which this run does not tell apart",
            ms(sum_s),
            first.1,
            names.join(" and ")
        );
        let sure = parts.iter().filter(|(part, _)| !is_unsure(part)).map(word);
        return std::iter::once(together).chain(sure).collect::<Vec<_>>().join("; ");
    }
    let words: Vec<String> = parts.iter().map(word).collect();
    words.join(", ")
}

/// Whether a part may be none at all.
fn is_unsure(part: &Part) -> bool {
    part.delay_s > 0.0 && part.interval_s.is_some_and(|[low_s, _]| low_s <= 0.0)
}

/// Whether a part is hardly known: its interval is wider than it is large by this factor.
fn is_wide(part: &Part) -> bool {
    const WIDE: f64 = 1.25;
    part.delay_s > 0.0 && part.interval_s.is_some_and(|[low_s, high_s]| high_s - low_s > WIDE * part.delay_s)
}

/// What explains a start, if something does.
pub(super) fn of<'a>(report: &'a Report, id: &str) -> Option<&'a LateStart> {
    report.why.as_ref()?.as_ref().ok()?.starts.iter().find(|start| start.id == id)
}

/// Whether dead band and lag are told apart: one of them may be none, or is negative.
fn tells_apart(start: &LateStart) -> bool {
    let (dead_band, lag) = (&start.dead_band, &start.lag);
    let negative = dead_band.delay_s.min(lag.delay_s) < 0.0;
    !(negative || is_unsure(dead_band) && is_unsure(lag))
}

/// Starts in the order of their rows.
pub(super) fn latest_first(why: &Why) -> Vec<&LateStart> {
    let mut starts: Vec<&LateStart> = why.starts.iter().collect();
    starts.sort_by(|a, b| b.onset_delay_s.total_cmp(&a.onset_delay_s));
    starts
}

/// A row a start, the latest first; `most` is how many to list.
pub(super) fn section(report: &Report, most: usize) -> Option<Section> {
    let blocks = match report.why.as_ref()? {
        Err(reason) => {
            vec![Sentence::finding(format!("Why the starts come late cannot be told: {reason}.")).into()]
        }
        Ok(why) => explained(why, most),
    };
    Some(Section::new(ID, "Why late", blocks))
}

fn explained(why: &Why, most: usize) -> Vec<Block> {
    let starts = latest_first(why);
    let longest_s = starts.iter().map(|start| start.onset_delay_s).fold(1e-3, f64::max);
    let mut columns = vec![
        Column::words("joint"),
        Column::numbers("at s").meaning("When the plan starts."),
        Column::numbers("delay ms").meaning("Time between plan and joint passing the same speed."),
        Column::words("of it")
            .meaning("The parts that make a start late, on one scale: a bar is as long as the delay."),
    ];
    for (_, heading, meaning, _) in PARTS {
        columns.push(Column::numbers(heading).meaning(meaning));
    }
    let row = |start: &&LateStart| {
        let mut cells = vec![
            start.joint.clone(),
            format!("{:.2}", start.planned_onset_s),
            ms(start.onset_delay_s),
            bar(start, longest_s),
        ];
        cells.extend(PARTS.iter().map(|(.., part)| with_interval(&part(start))));
        cells
    };
    let mut blocks: Vec<Block> = Vec::new();
    if starts.is_empty() {
        blocks.push(Sentence::finding("No start has a time that a model explains.").into());
    } else {
        blocks.push(Table::of(columns, starts.iter().take(most).map(row).collect::<Vec<_>>()).into());
    }
    blocks.extend((starts.len() > most).then(|| {
        Sentence::note(format!("and {} more that are less late (--all lists them)", starts.len() - most))
            .into()
    }));
    if why.untimed > 0 {
        let count = counted(why.untimed, "more start");
        blocks.push(
            Sentence::note(format!("{count} cannot be timed without dead band and limits: not explained."))
                .into(),
        );
    }
    blocks.extend(
        why.untold
            .iter()
            .map(|joint| Sentence::note(format!("{joint}; its delays are not explained.")).into()),
    );
    blocks.push(Sentence::note(
        "█ dead band, ▒ lag, ▓ both where they are not told apart, ░ limits, ? unexplained. Lag is the delay of the fitted model without limits and dead band, timed with the noise of the run; limit is what the \
         model loses without its limits; the rest is the dead band's, and what is later than any likely one explains is unexplained. In brackets 95 % intervals, from those of the fit.",
    ).into());
    blocks
}

fn with_interval(part: &Part) -> String {
    let interval =
        part.interval_s.map_or(String::new(), |[low, high]| format!(" ({}..{})", ms(low), ms(high)));
    ms(part.delay_s) + &interval
}

/// The parts that make it late, side by side, in all as long as the delay.
fn bar(start: &LateStart, longest_s: f64) -> String {
    let parts: Vec<(char, f64)> = PARTS.iter().map(|(fill, .., part)| (*fill, part(start).delay_s)).collect();
    let parts = match parts.as_slice() {
        [dead_band, lag, rest @ ..] if !tells_apart(start) => {
            std::iter::once(('▓', dead_band.1 + lag.1)).chain(rest.iter().copied()).collect()
        }
        _ => parts,
    };
    let (mut sum_s, mut bar) = (0.0, String::new());
    for (fill, part_s) in parts {
        sum_s += part_s.max(0.0);
        let end = whole((WIDE * (sum_s.min(start.onset_delay_s) / longest_s).clamp(0.0, 1.0)).round());
        let more = end.saturating_sub(bar.chars().count());
        bar.extend(std::iter::repeat_n(fill, more));
    }
    bar
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_is_as_long_as_the_delay_and_parts_that_are_not_told_apart_are_one() {
        let part = |delay_s: f64, half_s: f64| Part {
            delay_s,
            interval_s: Some([delay_s - half_s, delay_s + half_s]),
        };
        let drawn = |dead_band: Part, lag: Part, limit_s: f64| {
            let limit = Part { delay_s: limit_s, interval_s: None };
            let start = LateStart {
                id: "1".to_owned(),
                joint: "J5".to_owned(),
                planned_onset_s: 2.0,
                onset_delay_s: dead_band.delay_s + lag.delay_s + limit_s,
                dead_band,
                lag,
                limit,
                unexplained: Part { delay_s: 0.0, interval_s: None },
            };
            bar(&start, 2.4)
        };
        assert_eq!(drawn(part(0.2, 0.1), part(0.3, 0.1), 0.1), "██▒▒▒░");
        assert_eq!(drawn(part(0.2, 0.5), part(0.3, 0.5), 0.1), "▓▓▓▓▓░");
        assert_eq!(drawn(part(-0.5, 0.1), part(0.8, 0.1), 0.0), "▓▓▓");
        assert_eq!(drawn(part(0.5, 0.1), part(0.8, 0.1), -0.3), "█████▒▒▒▒▒");
        assert_eq!(drawn(part(-0.5, 0.1), part(0.4, 0.1), 0.0), "");
    }

    #[test]
    fn no_part_of_a_delay_is_said_to_be_negative() {
        let part = |delay_s: f64, half_s: f64| Part {
            delay_s,
            interval_s: Some([delay_s - half_s, delay_s + half_s]),
        };
        let none = Part { delay_s: 0.0, interval_s: None };
        let said = |dead_band: Part, limit: Part| {
            let (lag, unexplained) = (part(0.147, 0.01), none);
            let (id, joint) = ("1".to_owned(), "J5".to_owned());
            let onset_delay_s = lag.delay_s + dead_band.delay_s + limit.delay_s;
            phrase(&LateStart {
                id,
                joint,
                planned_onset_s: 2.0,
                onset_delay_s,
                dead_band,
                lag,
                limit,
                unexplained,
            })
        };
        assert_eq!(said(part(-0.091, 0.25), none), "147 ms lag, dead band of at most 159 ms");
        assert_eq!(said(part(-0.091, 0.0911), none), "147 ms lag, no dead band");
        assert_eq!(said(part(-0.091, 0.05), none), "147 ms lag, less 91 ms dead band");
        let limit = Part { delay_s: -0.002, ..none };
        assert_eq!(said(part(0.2, 0.1), limit), "200 ms dead band, 147 ms lag, less 2 ms limits");
        assert_eq!(said(part(0.2, 0.15), none), "200 ms dead band (95 %: 50 to 350), 147 ms lag");
    }
}
