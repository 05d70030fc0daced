//! The detector against the truth of the hydraulic arm.

use crate::support::detection::{BARS, all_runs, hold};

#[test]
fn starts_of_the_hydraulic_arm_are_found_where_the_angle_without_noise_has_them() {
    hold(&BARS[0], &all_runs(BARS[0].noise_deg, 2, false));
}
