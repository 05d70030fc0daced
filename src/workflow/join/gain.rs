//! How much of the correction of a plan was sent: commands of one plan are so alike that each fits where another was sent.

use crate::series::{Series, Track};

/// Instants that are looked at.
const INSTANTS: u32 = 1_000;
/// Another share of the correction leaves this of what the whole leaves, or none of it, as root mean squares.
const CLEARLY: f64 = 0.5;
/// Shares nearer to the whole, or to none, are those.
const NEAR: f64 = 0.15;
/// Less than this, rad or m, root mean square, tells nothing.
const LEAST: f64 = 1e-4;
/// How much earlier or later it may have been sent than where it was found, s, and the first steps in which that is sought: a
/// correction leads its plan, so that another share of it is found a little beside its time.
const BESIDE_S: f64 = 0.6;
const STEP_S: f64 = 0.02;
const FINEST_S: f64 = 1e-4;

/// What was sent and what might have been, less the plan, at the same instants: sums of squares and of products.
#[derive(Clone, Copy)]
struct Sums {
    sent: f64,
    both: f64,
    correction: f64,
}

impl Sums {
    /// Squares that a share of the correction leaves.
    fn left(self, share: f64) -> f64 {
        (self.sent - 2.0 * share * self.both + share * share * self.correction).max(0.0)
    }

    /// The share that leaves least.
    fn share(self) -> f64 {
        self.both / self.correction
    }
}

/// The share of the correction of `command` on its `plan` that was sent, where that is clearly neither the whole nor none; `at_s` is
/// where the time 0 of the plan lies. What is sent a little earlier or later is no other share.
pub(super) fn other_share(plan: &Series, command: &Series, sent: &Series, at_s: f64) -> Option<f64> {
    let [from_s, to_s] = plan.span_s()?;
    let instants: Vec<f64> =
        (0..INSTANTS).map(|k| from_s + (to_s - from_s) * f64::from(k) / f64::from(INSTANTS - 1)).collect();
    let placed = |track: &Track, later_s: f64| -> Vec<f64> {
        let mut cursor = 0;
        instants.iter().map(|t_s| track.held_after(&mut cursor, later_s + t_s).position).collect()
    };
    let of_joint = |plan: &Track| {
        let (command, sent) = (command.track(plan.name())?, sent.track(plan.name())?);
        let wanted = placed(plan, 0.0);
        let correction: Vec<f64> = placed(command, 0.0).iter().zip(&wanted).map(|(c, w)| c - w).collect();
        Some((wanted, correction, sent))
    };
    let joints: Vec<_> = plan.tracks.iter().filter_map(of_joint).collect();
    let sums = |later_s: f64| {
        let mut sums = Sums { sent: 0.0, both: 0.0, correction: 0.0 };
        for (wanted, correction, sent) in &joints {
            for ((sent, wanted), correction) in
                placed(sent, at_s + later_s).iter().zip(wanted).zip(correction)
            {
                let off = sent - wanted;
                sums.sent += off * off;
                sums.both += off * correction;
                sums.correction += correction * correction;
            }
        }
        sums
    };
    let least = LEAST * LEAST * f64::from(INSTANTS);
    if sums(0.0).correction <= least {
        return None;
    }
    // Each at the time at which it leaves least.
    let best = nearest(&sums, |sums| sums.left(sums.share()));
    let [none, whole] = [0.0, 1.0].map(|share| nearest(&sums, |sums| sums.left(share)).left(share));
    let share = best.share();
    let clearly = best.left(share) < CLEARLY * CLEARLY * whole.min(none);
    (whole.min(none) > least && clearly && share > NEAR && (share - 1.0).abs() > NEAR).then_some(share)
}

/// The sums at the time beside the one found at which least is left.
fn nearest(sums: &impl Fn(f64) -> Sums, left: impl Fn(Sums) -> f64) -> Sums {
    let steps = (BESIDE_S / STEP_S).round();
    let at = |later_s: f64| (later_s, sums(later_s));
    let better = |a: (f64, Sums), b: (f64, Sums)| if left(b.1) < left(a.1) { b } else { a };
    let mut best = std::iter::successors(Some(-steps), |k| Some(k + 1.0))
        .take_while(|k| *k <= steps)
        .map(|k| at(k * STEP_S))
        .fold(at(0.0), better);
    let mut step_s = STEP_S;
    while step_s > FINEST_S {
        step_s *= 0.5;
        best = [best.0 - step_s, best.0 + step_s].map(at).into_iter().fold(best, better);
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::smooth_step as step;

    #[test]
    fn another_share_of_a_correction_is_told_and_another_time_or_a_held_sample_is_not() {
        let plan = |t: f64| step((t - 1.0) / 3.0) - 0.5 * step((t - 6.0) / 3.0);
        let bump =
            |t: f64| 0.02 * (-((t - 1.3) / 0.2).powi(2)).exp() - 0.015 * (-((t - 6.3) / 0.2).powi(2)).exp();
        let series = |q: &dyn Fn(f64) -> f64| Series::sampled("swing", 1000, q);
        let command = |share: f64| move |t: f64| plan(t) + share * bump(t);
        let of = |sent: &dyn Fn(f64) -> f64, at_s: f64| {
            other_share(&series(&plan), &series(&command(1.0)), &series(sent), at_s)
        };
        for share in [0.25, 0.5, 1.3, 2.0] {
            let found = of(&command(share), 0.0).unwrap_or_default();
            assert!((found - share).abs() < 0.02, "{share}: {found}");
            // Where its time was found by what it is not.
            let found = of(&command(share), 0.1).unwrap_or_default();
            assert!((found - share).abs() < 0.02, "{share}: {found}");
        }
        assert_eq!([of(&command(1.0), 0.0), of(&command(1.0), 0.02), of(&plan, 0.0)], [None; 3]);
        // A correction that leads is, at another time, near another share of itself.
        let leads = |share: f64| move |t: f64| plan(t) + share * (plan(t + 0.3) - plan(t) + bump(t));
        for share in [0.5, 2.0] {
            let sent = series(&leads(share));
            for at_s in [0.0, -0.15, 0.15] {
                let found =
                    other_share(&series(&plan), &series(&leads(1.0)), &sent, at_s).unwrap_or_default();
                assert!((found - share).abs() < 0.02, "{share} {at_s}: {found}");
            }
        }
        let held = |t: f64| command(1.0)((t / 0.05).floor() * 0.05);
        assert_eq!(of(&held, 0.025), None);
    }
}
