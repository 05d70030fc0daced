//! A page: one file that fetches nothing, with plots that zoom.
//!
//! Markup is built by a macro that escapes whatever is put into it; data stand in a block that is not run, and a policy
//! in the head lets the page's own script and styles run and nothing else.

mod blocks;
mod card;
pub(in crate::render) mod chart;
pub(in crate::render) mod choice;
pub(in crate::render) mod envelope;
mod frame;
pub(in crate::render) mod paper;
pub(in crate::render) mod scene;
pub(in crate::render) mod strip;

pub(in crate::render) use blocks::{Shows, blocks, blocks_of, headed, table};
pub(in crate::render) use card::{card, next_steps, verdict};
pub(in crate::render) use frame::{Chapter, Plots, page};
