//! What a terminal adds to a text: colours, and an end of the line.

use std::collections::BTreeSet;

use anstyle::{AnsiColor, Style};
use textwrap::{Options, WordSeparator, WordSplitter};

use super::{
    Align, Mark, Sentence, Table,
    layout::{GAP, widths},
};

const STRONG: Style = Style::new().bold();
const BAD: Style = AnsiColor::Red.on_default().bold();
const GOOD: Style = AnsiColor::Green.on_default();
const DOUBT: Style = AnsiColor::Yellow.on_default();

/// Leading columns among which rows are told apart.
const MOST_KEYS: usize = 5;

/// What a text may use; by default nothing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct TerminalStyle {
    /// Escape codes: heads bold, limits kept green and broken ones red, remarks yellow.
    pub(crate) coloured: bool,
    /// Characters in a line, beyond which sentences are folded and tables cut into blocks.
    pub(crate) width: Option<usize>,
}

impl TerminalStyle {
    fn paint(self, text: &str, style: Style) -> String {
        if self.coloured { format!("{style}{text}{style:#}") } else { text.to_owned() }
    }

    /// A head.
    pub(super) fn strong(self, text: &str) -> String {
        self.paint(text, STRONG)
    }

    pub(super) fn doubt(self, text: &str) -> String {
        self.paint(text, DOUBT)
    }

    pub(super) fn verdict(self, kept: bool) -> String {
        self.paint(Sentence::verdict(kept), if kept { GOOD } else { BAD })
    }

    /// How a check came out, four characters wide.
    pub(super) fn mark(self, mark: Mark) -> String {
        let style = match mark {
            Mark::Good => GOOD,
            Mark::Caution => DOUBT,
            Mark::Bad => BAD,
        };
        self.paint(&format!("{:4}", mark.word()), style)
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
    pub(super) fn blocks(self, table: &Table) -> Vec<Table> {
        let Some(most) = self.width else { return vec![table.clone()] };
        let (keys, widths) = (keys(table), widths(table));
        let wide = |columns: &[usize]| -> usize { columns.iter().map(|k| widths[*k] + GAP.len()).sum() };
        let goes_on = |k: &usize| table.columns.get(*k).is_some_and(|column| column.goes_on);
        let all: Vec<usize> = (0..widths.len()).collect();
        let mut blocks: Vec<Vec<usize>> = vec![Vec::new()];
        for group in all.chunk_by(|_, k| goes_on(k)) {
            let Some(block) = blocks.last_mut() else { break };
            let full = wide(block) + wide(group) > most + GAP.len();
            if full && block.iter().any(|column| !keys.contains(column)) {
                blocks.push(keys.clone());
            }
            if let Some(block) = blocks.last_mut() {
                let more: Vec<usize> = group.iter().filter(|k| !block.contains(k)).copied().collect();
                block.extend(more);
            }
        }
        blocks.iter().map(|columns| table.part(columns)).collect()
    }
}

/// The first column, and one more if only together they tell the rows apart; else all columns of words.
fn keys(table: &Table) -> Vec<usize> {
    let distinct = |columns: &[usize]| {
        let rows = table.rows.iter().map(|row| columns.iter().map(|k| row.get(*k)).collect::<Vec<_>>());
        rows.collect::<BTreeSet<_>>().len() == table.rows.len()
    };
    let second =
        (1..table.columns.len().min(MOST_KEYS)).map(|k| vec![0, k]).find(|columns| distinct(columns));
    let words = || table.columns.iter().take_while(|column| column.align == Align::Left).count();
    match second {
        _ if distinct(&[0]) => vec![0],
        Some(columns) => columns,
        None => (0..words().max(1).min(table.columns.len())).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::kit::{Block, Column, Document, Fact, Id, Section, fact, shown, text};

    fn table() -> Block {
        let rows = [["a", "0.5", "3.25"].map(str::to_owned).to_vec()];
        Table::new(&["joint"], &["peak deg", "at s"], rows).into()
    }

    fn verdict(limit: &str, kept: bool, found: &str) -> Block {
        Sentence::Verdict { limit: limit.into(), kept, found: found.into() }.into()
    }

    fn document(blocks: impl IntoIterator<Item = Block>) -> Document {
        Document::default().with(Section::plain(Id::OTHER, blocks))
    }

    #[test]
    fn a_terminal_is_shown_the_same_letters_in_the_same_places() {
        let doubts = vec![fact("gap x1", "in a")];
        let mut parts = document([
            verdict("Limit on lag", false, "a has 3 ms, 2 ms allowed."),
            verdict("Limit on rms error", true, "a has 3 deg, 4 deg allowed."),
            table(),
        ])
        .with(Section::new(Id::REMARKS, "Remarks on the data", [Block::Remarks(doubts)]));
        parts.title = Some("a\u{1b}[31mb.mcap".into());
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
        let found = "joint_1 has 3 ms where 2 ms are allowed by the caller.";
        let facts: Vec<Fact> = vec![fact("why", format!("Limit on lag: {found}")), fact("no", "more")];
        let parts = document([verdict("Limit on lag", false, found), facts.into()]);
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
        let of = |width| shown(&document([table()]), TerminalStyle { coloured: false, width: Some(width) });
        assert_eq!(of(16), "joint  peak deg\na           0.5\n\njoint  at s\na      3.25\n");
        assert_eq!(of(21), "joint  peak deg  at s\na           0.5  3.25\n");
        assert_eq!(shown(&document([table(), table()]), TerminalStyle::default()).lines().nth(2), Some(""));
    }

    #[test]
    fn a_heading_that_goes_on_is_not_parted_from_its_own() {
        let columns = ["joint", "peak deg", "rms deg", "after"].map(Column::numbers);
        let columns =
            columns.map(|column| if column.heading == "after" { column.going_on() } else { column });
        let rows = [["a", "0.5", "3.25", "4.25"].map(str::to_owned).to_vec()];
        let shown = shown(
            &document([Table::of(columns, rows).into()]),
            TerminalStyle { coloured: false, width: Some(24) },
        );
        assert_eq!(
            shown,
            "joint  peak deg\n    a       0.5\n\njoint  rms deg  after\n    a     3.25   4.25\n"
        );
    }
}
