//! Why a start comes late.

use crate::support::why::parts_are_right;

/// Three machines and both tasks: `cargo test --release --test slow why -- --ignored --nocapture`.
#[test]
fn the_part_of_the_dead_band_is_what_goes_with_it() {
    parts_are_right(&["default"], &[1], false, [0.9, 0.55, 0.75, 0.85]);
}
