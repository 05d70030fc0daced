//! From message bytes to the few numbers and texts somebody asked for.
//!
//! A [`Program`] is compiled once per schema and walks CDR bytes without building values;
//! [`Tree`] does the same for JSON and Protobuf by way of a parsed value. Both report to a
//! [`Sink`] by slot number.

mod layout_cache;
mod program;
mod protobuf;
mod run;
mod sink;
mod template;
mod tree;

pub(super) use layout_cache::{Found, LayoutCache};
pub(super) use program::{Program, Want, shape_at};
pub(super) use protobuf::Whole;
pub(super) use sink::{Numbers, Sink, Slot, Texts, number_from};
pub(super) use template::Template;
pub(super) use tree::Tree;
