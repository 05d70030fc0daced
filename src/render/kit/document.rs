//! A document: title, facts, and sections whose identity and sentences whose kind are types, not text.

use std::{borrow::Cow, fmt};

use super::{Check, Table};
use crate::remark::Remarks;

/// A name and what it stands for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fact {
    /// One or two words.
    pub name: String,
    /// A phrase.
    pub value: String,
}

/// A [`Fact`].
pub fn fact(name: impl Into<String>, value: impl Into<String>) -> Fact {
    Fact { name: name.into(), value: value.into() }
}

/// Which section one is, whatever its heading says; on a page the anchor to jump to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Id(pub &'static str);

impl Id {
    /// The answer in a few sentences.
    pub const SUMMARY: Self = Self("summary");
    /// One row a transition.
    pub const TRANSITIONS: Self = Self("transitions");
    /// One row a joint.
    pub const JOINTS: Self = Self("joints");
    /// Doubts about the data.
    pub const REMARKS: Self = Self("remarks");
    /// How the numbers were made.
    pub const METHOD: Self = Self("method");
    /// What to do with the result.
    pub const NEXT: Self = Self("next");
    /// Any other, which nothing looks for.
    pub const OTHER: Self = Self("numbers");
}

/// Everything that a reader is told, in order.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Document {
    /// What it is about.
    pub title: Option<String>,
    /// Where it comes from.
    pub facts: Vec<Fact>,
    /// The rest.
    pub sections: Vec<Section>,
}

/// Blocks under a heading.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Which one it is.
    pub id: Id,
    /// Its heading; the first blocks of a document may have none.
    pub heading: Option<Cow<'static, str>>,
    /// In order.
    pub blocks: Vec<Block>,
}

/// A piece of a section.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// A paragraph.
    Sentence(Sentence),
    /// Names and what they stand for, aligned.
    Facts(Vec<Fact>),
    /// Doubts: their code and count, and what they say.
    Remarks(Vec<Fact>),
    /// What was checked before something is done.
    Checks(Vec<Check>),
    /// A table.
    Table(Table),
    /// What to type, on a line of its own so that it can be pasted.
    Command(String),
}

/// A sentence by what it is for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Sentence {
    /// What was found.
    Finding(String),
    /// How to read what stands beside it.
    Note(String),
    /// What to do.
    Advice(String),
    /// Whether a limit that the caller set is kept.
    Verdict {
        /// The limit.
        limit: String,
        /// Whether it is.
        kept: bool,
        /// The worst value found, and what is allowed.
        found: String,
    },
}

impl Document {
    /// Its commands with the options by which the logs were read.
    pub fn reading(mut self, options: &[String]) -> Self {
        self.sections = self.sections.into_iter().map(|section| section.reading(options)).collect();
        self
    }

    /// Under a title.
    pub fn titled(title: impl Into<String>) -> Self {
        Self { title: Some(title.into()), ..Self::default() }
    }

    /// The same under a title.
    pub fn titled_as(self, title: &str) -> Self {
        Self { title: Some(title.to_owned()), ..self }
    }

    /// With one section more at its end.
    pub fn with(mut self, section: Section) -> Self {
        self.sections.push(section);
        self
    }

    /// With remarks at its end, if there are any.
    pub fn remarked(mut self, remarks: &Remarks) -> Self {
        self.sections.extend(Section::remarks(remarks));
        self
    }

    /// With a section more, above the remarks.
    pub fn with_above_remarks(mut self, section: Section) -> Self {
        let place = self.sections.iter().position(|other| other.id == Id::REMARKS);
        self.sections.insert(place.unwrap_or(self.sections.len()), section);
        self
    }

    /// The first section of this identity.
    pub fn section(&self, id: Id) -> Option<&Section> {
        self.sections.iter().find(|section| section.id == id)
    }

    /// Its blocks; none where there is no such section.
    pub fn blocks(&self, id: Id) -> &[Block] {
        self.section(id).map_or(&[], |section| &section.blocks)
    }
}

impl Section {
    /// Its commands with the options by which the logs were read, each from [`argument`](super::argument).
    pub fn reading(mut self, options: &[String]) -> Self {
        for block in &mut self.blocks {
            if let Block::Command(line) = block {
                *line = super::command::reading(line, options);
            }
        }
        self
    }

    /// Blocks under a heading.
    pub fn new(
        id: Id,
        heading: impl Into<Cow<'static, str>>,
        blocks: impl IntoIterator<Item = impl Into<Block>>,
    ) -> Self {
        let blocks = blocks.into_iter().map(Into::into).collect();
        Self { id, heading: Some(heading.into()), blocks }
    }

    /// Blocks without a heading.
    pub fn plain(id: Id, blocks: impl IntoIterator<Item = impl Into<Block>>) -> Self {
        Self { id, heading: None, blocks: blocks.into_iter().map(Into::into).collect() }
    }

    /// With one block more at its end.
    pub fn with(mut self, block: impl Into<Block>) -> Self {
        self.blocks.push(block.into());
        self
    }

    /// With blocks more at its end.
    pub fn with_all(mut self, blocks: impl IntoIterator<Item = impl Into<Block>>) -> Self {
        self.blocks.extend(blocks.into_iter().map(Into::into));
        self
    }

    /// Doubts, if there are any.
    pub fn remarks(remarks: &Remarks) -> Option<Self> {
        let doubt = |r: &crate::remark::Remark| fact(format!("{} x{}", r.code.name(), r.count), &r.message);
        let doubts: Vec<Fact> = remarks.as_slice().iter().map(doubt).collect();
        (!doubts.is_empty()).then(|| Self::new(Id::REMARKS, "Remarks on the data", [Block::Remarks(doubts)]))
    }
}

impl Sentence {
    /// What was found.
    pub fn finding(text: impl Into<String>) -> Self {
        Self::Finding(text.into())
    }

    /// How to read what stands beside it.
    pub fn note(text: impl Into<String>) -> Self {
        Self::Note(text.into())
    }

    /// What to do.
    pub fn advice(text: impl Into<String>) -> Self {
        Self::Advice(text.into())
    }

    /// Whether it says that a limit is broken.
    pub fn is_broken(&self) -> bool {
        matches!(self, Self::Verdict { kept: false, .. })
    }

    pub(super) fn verdict(kept: bool) -> &'static str {
        if kept { "kept" } else { "NOT KEPT" }
    }
}

impl fmt::Display for Sentence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Finding(text) | Self::Note(text) | Self::Advice(text) => f.write_str(text),
            Self::Verdict { limit, kept, found } => {
                write!(f, "{limit} {}: {found}", Self::verdict(*kept))
            }
        }
    }
}

impl From<Sentence> for Block {
    fn from(sentence: Sentence) -> Self {
        Self::Sentence(sentence)
    }
}

impl From<Table> for Block {
    fn from(table: Table) -> Self {
        Self::Table(table)
    }
}

impl From<Vec<Fact>> for Block {
    fn from(facts: Vec<Fact>) -> Self {
        Self::Facts(facts)
    }
}
