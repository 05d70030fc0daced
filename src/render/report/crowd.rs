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
/// More stretches than this are a crowd.
pub(super) const CROWD: usize = 250;
/// Columns, and how many of them a click shows.
const COLUMNS: usize = 240;
const SHOWN: usize = 4;

/// What a phase is called, in words and in the sheet of styles.
pub(super) fn class(phase: Phase) -> &'static str {
    match phase {
        Phase::Waits => "waits",
        Phase::Follows => "follows",
        Phase::Settles => "settles",
    }
}

/// The stretches of a joint as shares of columns of equal time.
pub(super) fn crowd(stretches: &[Stretch], joint: &str, [from_s, to_s]: [f64; 2]) -> Markup {
    let each_s = (to_s - from_s) / COLUMNS as f64;
    let mut below = [0.0; COLUMNS];
    let phases = [Phase::Waits, Phase::Settles, Phase::Follows].map(|phase| {
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
