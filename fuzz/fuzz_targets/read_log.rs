//! Any bytes as a log file.
#![no_main]

use hydrotrace::log::{ReadOptions, survey_bytes};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = survey_bytes(bytes, &ReadOptions::default());
});
