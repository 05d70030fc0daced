//! A list of checks: marks with words, so that no colour is needed to read them.

/// How a check came out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mark {
    /// Nothing speaks against it.
    Good,
    /// Look at it first.
    Caution,
    /// Do not go on.
    Bad,
}

/// One line of the list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Check {
    /// How it came out.
    pub mark: Mark,
    /// What was checked, a word or two.
    pub name: &'static str,
    /// What was found, a sentence.
    pub found: String,
}

impl Mark {
    /// The word beside the colour.
    pub fn word(self) -> &'static str {
        match self {
            Self::Good => "ok",
            Self::Caution => "CARE",
            Self::Bad => "STOP",
        }
    }

    pub(in crate::render) fn class(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Caution => "care",
            Self::Bad => "bad",
        }
    }
}
