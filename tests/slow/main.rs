//! What takes minutes or needs a log of its own, on request and optimised:
//! `cargo test --release --test slow -- --ignored --nocapture`.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::float_cmp,
    reason = "what fails here fails the test; values are copied, not computed"
)]
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "counts of tests are small")]
#![allow(missing_docs, reason = "a test's name says it")]

mod choice;
mod compensation;
mod detection;
mod fleet;
#[cfg(target_os = "linux")]
mod memory;
mod real_log;
mod recovery;
mod structures;
#[path = "../it/support/mod.rs"]
#[allow(dead_code, reason = "shared with the tests that run always")]
mod support;
mod whole_loop;
mod why;
