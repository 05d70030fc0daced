//! A document as Markdown.

use std::fmt::Write as _;

use super::{Align, Block, Check, Document, Fact, Table, clean, layout::filled};

/// For a wiki or a pull request.
pub fn markdown(document: &Document) -> String {
    let mut out = String::new();
    if let Some(title) = &document.title {
        let _ = writeln!(out, "# {}\n", escaped(title));
    }
    facts(&mut out, &document.facts);
    for section in &document.sections {
        if let Some(heading) = &section.heading {
            let _ = writeln!(out, "## {}\n", escaped(heading));
        }
        for block in &section.blocks {
            match block {
                Block::Sentence(sentence) => {
                    let _ = writeln!(out, "{}\n", escaped(&sentence.to_string()));
                }
                Block::Facts(list) | Block::Remarks(list) => facts(&mut out, list),
                Block::Checks(list) => checks(&mut out, list),
                Block::Table(whole) => table(&mut out, whole),
                Block::Command(line) => {
                    let _ = writeln!(out, "    {}\n", clean(line));
                }
            }
        }
    }
    out.truncate(out.trim_end().len());
    out.push('\n');
    out
}

fn facts(out: &mut String, facts: &[Fact]) {
    for Fact { name, value } in facts {
        let _ = writeln!(out, "- **{}**: {}", escaped(name), escaped(value));
    }
    out.push_str(if facts.is_empty() { "" } else { "\n" });
}

fn checks(out: &mut String, checks: &[Check]) {
    for Check { mark, name, found } in checks {
        let _ = writeln!(out, "- {} **{name}**: {}", mark.word(), escaped(found));
    }
    out.push('\n');
}

fn table(out: &mut String, table: &Table) {
    let rows = table.rows.iter().map(|row| row.iter().map(|cell| escaped(cell)).collect());
    let table = Table { rows: rows.collect(), ..table.clone() };
    for (place, row) in filled(&table).iter().enumerate() {
        let _ = writeln!(out, "| {} |", row.join(" | "));
        if place == 0 {
            let rule = row.iter().zip(&table.columns).map(|(cell, column)| {
                let dashes = "-".repeat(cell.chars().count() + 1);
                format!("{dashes}{}", if column.align == Align::Left { "-" } else { ":" })
            });
            let _ = writeln!(out, "|{}|", rule.collect::<Vec<_>>().join("|"));
        }
    }
    out.push('\n');
}

/// Names come from logs: nothing in them is markup.
fn escaped(text: &str) -> String {
    let text = clean(text);
    let mut out = String::with_capacity(text.len());
    let mut before = ' ';
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        // An underscore inside a word emphasises nothing.
        let inside = before.is_alphanumeric() && rest.peek().is_some_and(|next| next.is_alphanumeric());
        before = c;
        match c {
            '_' if inside => out.push(c),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '\\' | '`' | '*' | '_' | '[' | ']' | '|' | '#' => {
                out.push('\\');
                out.push(c);
            }
            _ => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::kit::{Id, Section, text};

    fn document() -> Document {
        let rows = [vec!["a".into(), "0.5".into()], vec!["<b>|\u{1b}[31m".into(), "12.25".into()]];
        Document::default().with(Section::plain(Id::OTHER, [Table::new(&["joint"], &["peak deg"], rows)]))
    }

    #[test]
    fn numbers_are_aligned_to_the_right_and_control_characters_are_gone() {
        let text = text(&document());
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "joint      peak deg");
        assert_eq!(lines[1], "a               0.5");
        assert!(!text.contains('\u{1b}'));
    }

    #[test]
    fn markdown_tables_align_numbers_and_hold_no_markup_from_a_log() {
        let text = markdown(&document());
        assert!(text.contains("-:|"), "{text}");
        assert!(text.contains(r"&lt;b&gt;\|"), "{text}");
    }
}
