//! The rendering kit: a document of sections and sentences, and its forms: terminal, text, Markdown, CSV, page, figure.
//!
//! It knows nothing of any verb; the words of a verb lie beside it, in a file or folder of its own.

mod axis;
mod check;
mod clean;
mod command;
mod csv;
mod document;
pub(in crate::render) mod figure;
mod layout;
mod markdown;
mod number;
pub(in crate::render) mod page;
#[cfg(feature = "png")]
mod raster;
mod spare;
mod spark;
mod table;
mod terminal;
mod terminal_style;

pub use check::{Check, Mark};
pub use document::{Block, Document, Fact, Id, Section, Sentence, fact};
pub use markdown::markdown;
pub(in crate::render) use number::capital;
pub use number::{
    NONE, counted, deg, late, mm, ms, optional, percent, probability, share, short, signed, significant,
    some_of, starts_of,
};
pub use table::{Align, Column, Table};
pub use terminal::text;

#[cfg(test)]
pub(crate) use command::READERS;
pub(crate) use command::{argument, command, reading, word};
pub(crate) use csv::csv;
pub(crate) use figure::Figure;
pub(crate) use page::paper::Failure;
#[cfg(feature = "png")]
pub(crate) use raster::{Raster, raster};
pub(crate) use terminal::shown;
pub(crate) use terminal_style::TerminalStyle;

pub(in crate::render) use clean::clean;
pub(in crate::render) use spark::spark;
