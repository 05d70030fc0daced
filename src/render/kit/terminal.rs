//! A document as text: for a terminal of some width, or for a plain file.

use std::fmt::Write as _;

use super::{
    Block, Check, Document, Fact, Sentence, Table, TerminalStyle, clean,
    layout::{GAP, filled},
};

/// For a plain file.
pub fn text(document: &Document) -> String {
    shown(document, TerminalStyle::default())
}

pub(crate) fn shown(document: &Document, style: TerminalStyle) -> String {
    let mut out = String::new();
    if let Some(title) = &document.title {
        let _ = writeln!(out, "{}", style.strong(&clean(title)));
    }
    facts(&mut out, &document.facts, style, false);
    for section in &document.sections {
        if let Some(heading) = &section.heading {
            let gap = if out.is_empty() { "" } else { "\n" };
            let _ = writeln!(out, "{gap}{}", style.strong(&clean(heading).to_uppercase()));
        }
        for (k, block) in section.blocks.iter().enumerate() {
            let before = k.checked_sub(1).and_then(|before| section.blocks.get(before));
            if let (Some(Block::Table(_)), Block::Table(_)) = (before, block) {
                out.push('\n');
            }
            match block {
                Block::Sentence(text) => {
                    let _ = writeln!(out, "{}", style.folded("", &sentence(text, style), 0));
                }
                Block::Facts(list) => facts(&mut out, list, style, false),
                Block::Remarks(list) => facts(&mut out, list, style, true),
                Block::Checks(list) => checks(&mut out, list, style),
                Block::Table(whole) => table(&mut out, whole, style),
                // Never folded: a line break would end the command.
                Block::Command(line) => {
                    let _ = writeln!(out, "{GAP}{}", clean(line));
                }
            }
        }
    }
    out
}

fn sentence(sentence: &Sentence, style: TerminalStyle) -> String {
    match sentence {
        Sentence::Verdict { limit, kept, found } => {
            format!("{} {}: {}", clean(limit), style.verdict(*kept), clean(found))
        }
        other => clean(&other.to_string()),
    }
}

fn facts(out: &mut String, facts: &[Fact], style: TerminalStyle, doubtful: bool) {
    let width = facts.iter().map(|fact| fact.name.chars().count()).max().unwrap_or(0);
    for Fact { name, value } in facts {
        let name = format!("{:width$}", clean(name));
        let name = if doubtful { style.doubt(&name) } else { name };
        let _ = writeln!(out, "{}", style.folded(&format!("{name}{GAP}"), &clean(value), width + GAP.len()));
    }
}

fn checks(out: &mut String, checks: &[Check], style: TerminalStyle) {
    let width = checks.iter().map(|check| check.name.chars().count()).max().unwrap_or(0);
    for Check { mark, name, found } in checks {
        let head = format!("{}{GAP}{name:width$}{GAP}", style.mark(*mark));
        let _ = writeln!(out, "{}", style.folded(&head, &clean(found), 4 + width + 2 * GAP.len()));
    }
}

fn table(out: &mut String, whole: &Table, style: TerminalStyle) {
    let rows = whole.rows.iter().map(|row| row.iter().map(|cell| clean(cell)).collect());
    for (block, part) in style.blocks(&Table { rows: rows.collect(), ..whole.clone() }).iter().enumerate() {
        out.push_str(if block == 0 { "" } else { "\n" });
        for (row, cells) in filled(part).iter().enumerate() {
            let line = cells.join(GAP);
            let line = line.trim_end();
            let line = if row == 0 { style.strong(line) } else { line.to_owned() };
            let _ = writeln!(out, "{line}");
        }
    }
}
