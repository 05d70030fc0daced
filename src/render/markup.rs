//! The few shapes a report is made of, and their two renderings.

use std::fmt::Write as _;

use comfy_table::{CellAlignment, Table, presets};

use super::terminal_style::TerminalStyle;

/// A piece of a report.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    /// What the whole is about.
    Title(String),
    /// A heading.
    Heading(String),
    /// A paragraph of one line.
    Line(String),
    /// Names and what they stand for, aligned.
    Facts(Vec<(String, String)>),
    /// A table.
    Sheet(Sheet),
}

/// A table: the first `left` columns are words, the others numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// Column heads.
    pub head: Vec<&'static str>,
    /// Columns aligned to the left.
    pub left: usize,
    /// Cells.
    pub rows: Vec<Vec<String>>,
}

/// Heading of the doubts about the data, which stand out.
pub(super) const REMARKS: &str = "Remarks on the data";
/// How a sentence says that a limit is not kept.
pub(super) const NOT_KEPT: &str = "NOT KEPT";
/// How a sentence says that a limit is kept.
pub(super) const KEPT: &str = "kept";

/// With a sentence more, before the doubts.
pub fn noted(mut parts: Vec<Part>, line: String) -> Vec<Part> {
    let doubts = parts.iter().position(|part| matches!(part, Part::Heading(title) if title == REMARKS));
    parts.insert(doubts.unwrap_or(parts.len()), Part::Line(line));
    parts
}

/// For a plain file.
pub fn text(parts: &[Part]) -> String {
    shown(parts, TerminalStyle::default())
}

/// For a terminal.
pub fn shown(parts: &[Part], style: TerminalStyle) -> String {
    let mut out = String::new();
    let mut doubtful = false;
    for part in parts {
        match part {
            Part::Title(title) => {
                let _ = writeln!(out, "{}", style.strong(&clean(title)));
            }
            Part::Heading(title) => {
                doubtful = title == REMARKS;
                let gap = if out.is_empty() { "" } else { "\n" };
                let _ = writeln!(out, "{gap}{}", style.strong(&clean(title).to_uppercase()));
            }
            Part::Line(line) => {
                let _ = writeln!(out, "{}", style.folded("", &style.judged(&clean(line)), 0));
            }
            Part::Facts(facts) => {
                let width = facts.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
                for (name, value) in facts {
                    let name = format!("{:width$}", clean(name));
                    let name = if doubtful { style.doubt(&name) } else { name };
                    let _ = writeln!(out, "{}", style.folded(&format!("{name}  "), &clean(value), width + 2));
                }
            }
            Part::Sheet(sheet) => {
                for (block, sheet) in style.blocks(sheet).iter().enumerate() {
                    out.push_str(if block == 0 { "" } else { "\n" });
                    for (row, line) in table(sheet, false).lines().enumerate() {
                        let line = line.trim_end();
                        let line = if row == 0 { style.strong(line) } else { line.to_owned() };
                        let _ = writeln!(out, "{line}");
                    }
                }
            }
        }
    }
    out
}

/// For a wiki or a pull request.
pub fn markdown(parts: &[Part]) -> String {
    let mut out = String::new();
    for part in parts {
        match part {
            Part::Title(title) => {
                let _ = writeln!(out, "# {}\n", escaped(title));
            }
            Part::Heading(title) => {
                let _ = writeln!(out, "## {}\n", escaped(title));
            }
            Part::Line(line) => {
                let _ = writeln!(out, "{}\n", escaped(line));
            }
            Part::Facts(facts) => {
                for (name, value) in facts {
                    let _ = writeln!(out, "- **{}**: {}", escaped(name), escaped(value));
                }
                out.push('\n');
            }
            Part::Sheet(sheet) => {
                let rows =
                    sheet.rows.iter().map(|row| row.iter().map(|cell| escaped(cell)).collect()).collect();
                let sheet = Sheet { rows, ..sheet.clone() };
                let mut lines = table(&sheet, true).lines().map(str::to_owned).collect::<Vec<_>>();
                if let Some(rule) = lines.get_mut(1) {
                    *rule = alignment_rule(rule, sheet.left);
                }
                out.push_str(&lines.join("\n"));
                out.push_str("\n\n");
            }
        }
    }
    out.truncate(out.trim_end().len());
    out.push('\n');
    out
}

fn table(sheet: &Sheet, markdown: bool) -> String {
    let mut table = Table::new();
    table
        .load_style(if markdown { presets::ASCII_MARKDOWN } else { presets::NOTHING })
        .set_header(sheet.head.clone());
    for row in &sheet.rows {
        table.add_row(row.iter().map(|cell| clean(cell)));
    }
    for (index, column) in table.column_iter_mut().enumerate() {
        column.set_cell_alignment(if index < sheet.left {
            CellAlignment::Left
        } else {
            CellAlignment::Right
        });
        let outer = if index == 0 { 0 } else { 2 };
        if !markdown {
            column.set_padding((outer, 0));
        }
    }
    table.to_string()
}

/// Marks the columns of numbers as aligned to the right.
fn alignment_rule(rule: &str, left: usize) -> String {
    let cells: Vec<&str> = rule.trim_matches('|').split('|').collect();
    let cells = cells.iter().enumerate().map(|(index, cell)| {
        if index < left || cell.len() < 2 {
            (*cell).to_owned()
        } else {
            format!("{}:", &cell[..cell.len() - 1])
        }
    });
    format!("|{}|", cells.collect::<Vec<_>>().join("|"))
}

/// Names come from logs: control characters would reach the reader's terminal.
pub(super) fn clean(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c }).collect()
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

    fn sheet() -> Part {
        Part::Sheet(Sheet {
            head: vec!["joint", "peak deg"],
            left: 1,
            rows: vec![vec!["a".into(), "0.5".into()], vec!["<b>|\u{1b}[31m".into(), "12.25".into()]],
        })
    }

    #[test]
    fn numbers_are_aligned_to_the_right_and_control_characters_are_gone() {
        let text = text(&[sheet()]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "joint      peak deg");
        assert_eq!(lines[1], "a               0.5");
        assert!(!text.contains('\u{1b}'));
    }

    #[test]
    fn markdown_tables_align_numbers_and_hold_no_markup_from_a_log() {
        let text = markdown(&[sheet()]);
        assert!(text.contains("-:|"), "{text}");
        assert!(text.contains(r"&lt;b&gt;\|"), "{text}");
    }
}
