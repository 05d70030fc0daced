//! What a terminal adds to a text: colours, and an end of the line.

use std::collections::BTreeSet;

use anstyle::{AnsiColor, Style};
use textwrap::{Options, WordSeparator, WordSplitter};

use super::markup::{KEPT, NOT_KEPT, Sheet};

const STRONG: Style = Style::new().bold();
const BAD: Style = AnsiColor::Red.on_default().bold();
const GOOD: Style = AnsiColor::Green.on_default();
const DOUBT: Style = AnsiColor::Yellow.on_default();

/// Between two columns of a table.
const GAP: usize = 2;
/// Leading columns among which rows are told apart.
const MOST_KEYS: usize = 5;

/// What a text may use; by default nothing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct TerminalStyle {
    /// Escape codes: heads bold, limits kept green and broken ones red, remarks yellow.
    pub coloured: bool,
    /// Characters in a line, beyond which sentences are folded and tables cut into blocks.
    pub width: Option<usize>,
}

impl TerminalStyle {
    fn paint(self, text: &str, style: Style) -> String {
        if self.coloured { format!("{style}{text}{style:#}") } else { text.to_owned() }
    }

    /// A head.
    pub(super) fn strong(self, text: &str) -> String {
        self.paint(text, STRONG)
    }

    /// A remark.
    pub(super) fn doubt(self, text: &str) -> String {
        self.paint(text, DOUBT)
    }

    /// A sentence, its verdict on a limit painted if it has one.
    pub(super) fn judged(self, line: &str) -> String {
        for (word, style) in [(NOT_KEPT, BAD), (KEPT, GOOD)] {
            if let Some((limit, found)) = line.split_once(&format!(" {word}: ")) {
                return format!("{limit} {}: {found}", self.paint(word, style));
            }
        }
        line.to_owned()
    }

    /// A sentence after its name, over several lines if it must be.
    pub(super) fn folded(self, name: &str, text: &str, indent: usize) -> String {
        let Some(width) = self.width.map(|width| width.saturating_sub(indent).max(20)) else {
            return format!("{name}{text}");
        };
        let options = Options::new(width)
            .word_separator(WordSeparator::AsciiSpace)
            .word_splitter(WordSplitter::NoHyphenation)
            .break_words(false);
        format!("{name}{}", textwrap::wrap(text, options).join(&format!("\n{:indent$}", "")))
    }

    /// A table as tables that fit, each with the columns that tell its rows apart.
    pub(super) fn blocks(self, sheet: &Sheet) -> Vec<Sheet> {
        let cell = |row: &[String], k: usize| row.get(k).map_or(0, |cell| cell.chars().count());
        let widths: Vec<usize> = sheet
            .head
            .iter()
            .enumerate()
            .map(|(k, head)| sheet.rows.iter().map(|row| cell(row, k)).fold(head.chars().count(), usize::max))
            .collect();
        let Some(most) = self.width else { return vec![sheet.clone()] };
        let keys = keys(sheet);
        let wide = |columns: &[usize]| -> usize { columns.iter().map(|k| widths[*k] + GAP).sum() };
        let mut blocks: Vec<Vec<usize>> = vec![Vec::new()];
        for (k, width) in widths.iter().enumerate() {
            let Some(block) = blocks.last_mut() else { break };
            let full = wide(block) + width > most;
            if full && block.iter().any(|column| !keys.contains(column)) {
                blocks.push(keys.clone());
            }
            if let Some(block) = blocks.last_mut().filter(|block| !block.contains(&k)) {
                block.push(k);
            }
        }
        blocks.iter().map(|columns| part_of(sheet, columns)).collect()
    }
}

/// The first column, and one more if only together they tell the rows apart; else all columns of words.
fn keys(sheet: &Sheet) -> Vec<usize> {
    let distinct = |columns: &[usize]| {
        let rows = sheet.rows.iter().map(|row| columns.iter().map(|k| row.get(*k)).collect::<Vec<_>>());
        rows.collect::<BTreeSet<_>>().len() == sheet.rows.len()
    };
    let second = (1..sheet.head.len().min(MOST_KEYS)).map(|k| vec![0, k]).find(|columns| distinct(columns));
    match second {
        _ if distinct(&[0]) => vec![0],
        Some(columns) => columns,
        None => (0..sheet.left.max(1).min(sheet.head.len())).collect(),
    }
}

fn part_of(sheet: &Sheet, columns: &[usize]) -> Sheet {
    let row = |row: &Vec<String>| columns.iter().filter_map(|k| row.get(*k).cloned()).collect();
    Sheet {
        head: columns.iter().filter_map(|k| sheet.head.get(*k).copied()).collect(),
        left: columns.iter().filter(|k| **k < sheet.left).count(),
        rows: sheet.rows.iter().map(row).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::markup::{Part, REMARKS, shown, text};

    fn sheet() -> Sheet {
        Sheet {
            head: vec!["joint", "peak deg", "at s"],
            left: 1,
            rows: vec![vec!["a".into(), "0.5".into(), "3.25".into()]],
        }
    }

    #[test]
    fn a_terminal_is_shown_the_same_letters_in_the_same_places() {
        let parts = [
            Part::Title("a\u{1b}[31mb.mcap".into()),
            Part::Line("Limit on lag NOT KEPT: a has 3 ms, 2 ms allowed.".into()),
            Part::Line("Limit on rms error kept: a has 3 deg, 4 deg allowed.".into()),
            Part::Sheet(sheet()),
            Part::Heading(REMARKS.into()),
            Part::Facts(vec![("gap x1".into(), "in a".into())]),
        ];
        let shown = shown(&parts, TerminalStyle { coloured: true, width: None });
        assert_eq!(anstream::adapter::strip_str(&shown).to_string(), text(&parts));
        for painted in [
            "\u{1b}[1mREMARKS ON THE DATA\u{1b}[0m",
            "\u{1b}[1m\u{1b}[31mNOT KEPT\u{1b}[0m: a has",
            "\u{1b}[32mkept\u{1b}[0m: a has",
            "\u{1b}[33mgap x1\u{1b}[0m",
            "\u{1b}[1mjoint  peak deg  at s\u{1b}[0m",
        ] {
            assert!(shown.contains(painted), "{painted:?} not in {shown:?}");
        }
    }

    #[test]
    fn no_line_is_longer_than_a_narrow_terminal_and_no_word_is_lost() {
        let sentence = "Limit on lag NOT KEPT: joint_1 has 3 ms where 2 ms are allowed by the caller.";
        let parts = [
            Part::Line(sentence.into()),
            Part::Facts(vec![("why".into(), sentence.into()), ("no".into(), "more".into())]),
        ];
        for coloured in [false, true] {
            let shown = shown(&parts, TerminalStyle { coloured, width: Some(30) });
            let plain = anstream::adapter::strip_str(&shown).to_string();
            assert!(plain.lines().all(|line| line.chars().count() <= 30), "{plain}");
            assert!(plain.contains("\n     "), "{plain}");
            assert_eq!(
                plain.split_whitespace().collect::<Vec<_>>(),
                text(&parts).split_whitespace().collect::<Vec<_>>()
            );
        }
    }

    #[test]
    fn a_wide_table_is_cut_into_blocks_that_repeat_its_first_column() {
        let cut = shown(&[Part::Sheet(sheet())], TerminalStyle { coloured: false, width: Some(16) });
        assert_eq!(cut, "joint  peak deg\na           0.5\n\njoint  at s\na      3.25\n");
        let whole = shown(&[Part::Sheet(sheet())], TerminalStyle { coloured: false, width: Some(21) });
        assert_eq!(whole, "joint  peak deg  at s\na           0.5  3.25\n");
    }
}
