//! The detector at every noise.

use crate::support::detection::{BARS, all_runs, hold};

#[test]
#[ignore = "a table of three noises; half a minute"]
fn starts_are_found_at_every_noise() {
    for bar in BARS {
        hold(&bar, &all_runs(bar.noise_deg, 5, true));
    }
}
