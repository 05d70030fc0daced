//! What lanes look like; one of a run with more stretches than can be seen: the height of a colour is its share of the time.

use std::fmt::Write as _;

use maud::{Markup, html};

use crate::{
    math::whole,
    render::kit::page::Shows,
    replay::{Phase, Stretch},
};

/// Thousandths of the run, and the height of a lane: the drawing is stretched, so it holds no text.
pub(super) const WIDTH: f64 = 1000.0;
pub(super) const HEIGHT: f64 = 30.0;
/// Below it, the strip of waits: where it begins and how high it is, and how wide a wait is at least.
const STRIP: [f64; 2] = [31.0, 5.0];
const LEAST: f64 = 3.0;
/// More stretches than this are a crowd.
pub(super) const CROWD: usize = 250;
/// Columns, and how many of them a click shows.
const COLUMNS: usize = 240;
const SHOWN: usize = 4;

/// What a phase is called, in words and in the sheet of styles.
pub(super) fn class(phase: Phase) -> &'static str {
    match phase {
        Phase::Waits => "waits",
        Phase::Never => "never",
        Phase::Follows => "follows",
        Phase::Settles => "settles",
    }
}

/// The same in a sentence.
pub(super) fn word(phase: Phase) -> &'static str {
    if phase == Phase::Never { "never answered" } else { class(phase) }
}

/// The stretches of a joint as shares of columns of equal time.
pub(super) fn crowd(stretches: &[Stretch], joint: &str, [from_s, to_s]: [f64; 2]) -> Markup {
    let each_s = (to_s - from_s) / COLUMNS as f64;
    let mut below = [0.0; COLUMNS];
    let phases = [Phase::Never, Phase::Waits, Phase::Settles, Phase::Follows].map(|phase| {
        let shares = shares(stretches.iter().filter(|one| one.phase == phase), from_s, each_s);
        (class(phase), path(&shares, &mut below))
    });
    let column_s = |k: usize| from_s + each_s * k as f64;
    let wide = WIDTH / COLUMNS as f64;
    html! {
        @for (class, path) in phases { path class=(class) d=(path) {} }
        @for k in (0..COLUMNS).step_by(SHOWN) {
            @let shows = Shows::around(joint, [column_s(k), column_s(k + SHOWN)]);
            rect class="any" x=(format!("{:.1}", wide * k as f64)) y="0" height=(HEIGHT) width=(format!("{:.1}", wide * SHOWN as f64))
                data-from=(shows.from) data-to=(shows.to) data-joint=(shows.joint) {}
        }
    }
}

/// Where a joint waits, however shortly: a strip below the lane.
pub(super) fn waits(stretches: &[Stretch], [from_s, to_s]: [f64; 2]) -> Markup {
    let place = |s: f64| ((s - from_s) / (to_s - from_s) * WIDTH).clamp(0.0, WIDTH);
    let strip = |phase: Phase| {
        let mut path = String::new();
        let mut end = f64::NEG_INFINITY;
        for one in stretches.iter().filter(|one| one.phase == phase) {
            let from = place(one.from_s).min(WIDTH - LEAST);
            let to = place(one.to_s).max(from + LEAST);
            // A crowd runs together.
            if to > end {
                let [top, high] = STRIP;
                let _ = write!(path, "M{:.1} {top}v{high}H{to:.1}v-{high}z", from.max(end));
                end = to;
            }
        }
        path
    };
    html! {
        @for phase in [Phase::Waits, Phase::Never] {
            @let path = strip(phase);
            @if !path.is_empty() { path class=(class(phase)) d=(path) {} }
        }
    }
}

/// The share of each column that some stretches take.
fn shares<'a>(stretches: impl Iterator<Item = &'a Stretch>, from_s: f64, each_s: f64) -> [f64; COLUMNS] {
    let mut shares = [0.0; COLUMNS];
    for one in stretches {
        let [first, last] =
            [one.from_s, one.to_s].map(|s| ((s - from_s) / each_s).clamp(0.0, COLUMNS as f64));
        let own = shares.iter_mut().enumerate().take(whole(last.ceil())).skip(whole(first));
        for (k, share) in own {
            *share += (last.min(k as f64 + 1.0) - first.max(k as f64)).max(0.0);
        }
    }
    shares
}

/// Bars of these shares over what lies below, which they then are part of.
fn path(shares: &[f64; COLUMNS], below: &mut [f64; COLUMNS]) -> String {
    let wide = WIDTH / COLUMNS as f64;
    let mut path = String::new();
    for (k, (share, below)) in shares.iter().zip(below).enumerate().filter(|(_, (share, _))| **share > 0.0) {
        let (bottom, high) = (HEIGHT * (1.0 - *below), HEIGHT * share);
        let _ = write!(path, "M{:.1} {bottom:.1}v-{high:.1}h{wide:.1}v{high:.1}z", wide * k as f64);
        *below += share;
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_wait_of_a_long_run_is_as_wide_as_can_be_seen() {
        let stretch = |phase, from_s, to_s| Stretch { phase, from_s, to_s };
        let all = [
            stretch(Phase::Waits, 100.0, 100.3),
            stretch(Phase::Waits, 101.0, 101.3),
            stretch(Phase::Never, 3599.9, 3600.0),
        ];
        let strips = waits(&all, [0.0, 3600.0]).into_string();
        assert!(strips.contains("class=\"waits\" d=\"M27.8 31v5H30.8v-5zM30.8 31v5H31.1v-5z\""), "{strips}");
        assert!(strips.contains("class=\"never\" d=\"M997.0 31v5H1000.0v-5z\""), "{strips}");
    }

    #[test]
    fn shares_of_columns_are_those_of_the_time() {
        let stretch = |from_s, to_s| Stretch { phase: Phase::Waits, from_s, to_s };
        let all = [stretch(0.0, 0.5), stretch(1.5, 3.25), stretch(239.5, 260.0)];
        let found = shares(all.iter(), 0.0, 1.0);
        assert_eq!((found[0], found[1], found[2], found[3], found[4]), (0.5, 0.5, 1.0, 0.25, 0.0));
        assert_eq!((found[238], found[239]), (0.0, 0.5));
        let mut below = [0.0; COLUMNS];
        assert!(path(&found, &mut below).starts_with("M0.0 30.0v-15.0h4.2v15.0zM"));
        assert!((below[2] - 1.0).abs() < 1e-12);
    }
}
