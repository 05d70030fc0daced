//! All tests of the crate from outside, in one binary: each binary more would link the crate once more.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::float_cmp,
    reason = "what fails here fails the test; values are copied, not computed"
)]
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap,
    reason = "counts and stamps of tests are small"
)]
#![allow(
    clippy::format_push_string,
    clippy::format_collect,
    clippy::needless_for_each,
    reason = "texts are written as they read"
)]
#![allow(clippy::wildcard_imports, reason = "a folder's modules share its helpers")]
#![allow(missing_docs, reason = "a test's name says it")]

mod allocations;
mod architecture;
mod arm;
mod cli;
mod delay;
mod docs;
mod drift;
mod fit;
mod golden;
mod log_read;
mod log_write;
mod one_pass;
mod plan;
mod plant;
mod replay;
mod rounded;
mod rules;
mod sample_logs;
mod spline;
mod support;
mod tool;
mod why;
