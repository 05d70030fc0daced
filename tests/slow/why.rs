//! Why a start comes late, on three machines.

use crate::support::why::parts_are_right;

#[test]
#[ignore = "half a minute"]
fn the_part_of_the_dead_band_is_what_goes_with_it_on_three_machines() {
    parts_are_right(&["default", "dead-band-limited", "lag-limited"], &[1, 2], true, [0.95, 0.6, 0.85, 0.9]);
}
