//! Whether the error lives in the transitions.

use statrs::stats_tests::{
    Alternative,
    mannwhitneyu::{MannWhitneyUMethod, mannwhitneyu},
};

use super::{Concentration, ConcentrationTest, Rules, Verdict, tracking::Sample};

/// What the comparison needs of one joint whose plan moves.
pub(super) struct JointError<'a, S> {
    pub(super) samples: S,
    /// For each sample, whether the plan moves.
    pub(super) moving: &'a [bool],
    /// Transition windows, ascending, s.
    pub(super) windows_s: &'a [[f64; 2]],
}

#[derive(Default, Clone, Copy)]
struct Sum {
    time_s: f64,
    square: f64,
}

impl Sum {
    fn add(&mut self, sample: Sample) {
        self.time_s += sample.weight_s;
        self.square += sample.weight_s * sample.error_rad * sample.error_rad;
    }

    fn rms(self) -> Option<f64> {
        (self.time_s > 0.0).then(|| (self.square / self.time_s).sqrt())
    }
}

/// A window or the stretch between two, with its error relative to the joint's.
struct Block {
    start_s: f64,
    sum: Sum,
}

/// Compares the error inside transition windows with that elsewhere; `None` without joints.
pub(super) fn concentration<'a, S: Iterator<Item = Sample>>(
    joints: impl Iterator<Item = JointError<'a, S>>,
    rules: &Rules,
) -> Option<Concentration> {
    let (mut inside, mut outside, mut moving) = (Sum::default(), Sum::default(), Sum::default());
    let (mut inside_blocks, mut outside_blocks) = (Vec::new(), Vec::new());
    for joint in joints {
        let mut whole = Sum::default();
        let (mut joint_inside, mut joint_outside): (Vec<Block>, Vec<Block>) = (Vec::new(), Vec::new());
        // 2k + 1 inside window k, 2k in the stretch before it.
        let mut place = usize::MAX;
        let mut k = 0;
        for (sample, &plan_moves) in joint.samples.zip(joint.moving) {
            whole.add(sample);
            while joint.windows_s.get(k).is_some_and(|w| w[1] <= sample.t_s) {
                k += 1;
            }
            let is_inside = joint.windows_s.get(k).is_some_and(|w| w[0] <= sample.t_s);
            let (total, blocks) = if is_inside {
                (&mut inside, &mut joint_inside)
            } else {
                if plan_moves {
                    moving.add(sample);
                }
                (&mut outside, &mut joint_outside)
            };
            total.add(sample);
            let here = 2 * k + usize::from(is_inside);
            if here != place {
                blocks.push(Block { start_s: sample.t_s, sum: Sum::default() });
                place = here;
            }
            if let Some(block) = blocks.last_mut() {
                block.sum.add(sample);
            }
        }
        let Some(scale) = whole.rms().filter(|&rms| rms > 0.0) else {
            continue;
        };
        let relative = |block: Block| {
            let rms_rad = block.sum.rms().filter(|_| block.sum.time_s >= rules.min_stretch_s)?;
            Some((block.start_s, rms_rad / scale))
        };
        inside_blocks.extend(joint_inside.into_iter().filter_map(relative));
        outside_blocks.extend(joint_outside.into_iter().filter_map(relative));
    }
    let (time_s, square) = (inside.time_s + outside.time_s, inside.square + outside.square);
    if time_s <= 0.0 {
        return None;
    }
    let test = test(&events(inside_blocks, rules), &events(outside_blocks, rules));
    let (rms_inside, rms_outside) = (inside.rms().unwrap_or(0.0), outside.rms().unwrap_or(0.0));
    // Elsewhere is mostly rest; a plan that also moves there must be followed better there.
    let beats_moving = moving.rms().is_none_or(|rms_rad| rms_inside > rms_rad);
    Some(Concentration {
        rms_inside,
        rms_outside,
        rms_outside_moving: moving.rms(),
        time_share_inside: inside.time_s / time_s,
        squared_error_share_inside: if square > 0.0 { inside.square / square } else { 0.0 },
        test,
        verdict: match test {
            Some(test) if test.p_value >= rules.significance => Verdict::Undecided,
            Some(test) if test.effect > 0.5 && rms_inside > rms_outside && beats_moving => {
                Verdict::Transitions
            }
            Some(test) if test.effect < 0.5 && rms_outside > rms_inside => Verdict::Elsewhere,
            _ => Verdict::Undecided,
        },
    })
}

/// Averages values, each of which begins within a moment of the one before it.
fn events(mut blocks: Vec<(f64, f64)>, rules: &Rules) -> Vec<f64> {
    blocks.sort_by(|a, b| a.0.total_cmp(&b.0));
    let together = blocks.chunk_by(|a, b| b.0 - a.0 <= rules.same_event_s);
    together.map(|event| event.iter().map(|block| block.1).sum::<f64>() / event.len() as f64).collect()
}

fn test(inside: &[f64], outside: &[f64]) -> Option<ConcentrationTest> {
    let method = MannWhitneyUMethod::AsymptoticInclContinuityCorrection;
    let (u, p_value) = mannwhitneyu(inside, outside, method, Alternative::TwoSided).ok()?;
    Some(ConcentrationTest {
        inside_count: inside.len(),
        outside_count: outside.len(),
        p_value,
        effect: u / (inside.len() as f64 * outside.len() as f64),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A joint of 100 s whose error is `inside` for 2 s after every tenth second.
    fn verdict(inside: f64, outside: f64) -> Concentration {
        let windows_s: Vec<[f64; 2]> =
            (0..10).map(|k| [f64::from(10 * k + 5), f64::from(10 * k + 7)]).collect();
        let samples: Vec<Sample> = (0..1000)
            .map(|k| {
                let t_s = 0.1 * f64::from(k);
                let within = windows_s.iter().any(|w| w[0] <= t_s && t_s < w[1]);
                let error_rad = if within { inside } else { outside } * (1.0 + 0.001 * t_s);
                Sample { t_s, error_rad, weight_s: 0.1 }
            })
            .collect();
        let samples = samples.into_iter();
        let joint = JointError { samples, moving: &[false; 1000], windows_s: &windows_s };
        concentration(std::iter::once(joint), &Rules::default()).unwrap()
    }

    #[test]
    fn the_verdict_follows_the_error() {
        assert_eq!(verdict(2.0, 1.0).verdict, Verdict::Transitions);
        assert_eq!(verdict(1.0, 2.0).verdict, Verdict::Elsewhere);
        assert_eq!(verdict(1.0, 1.0).verdict, Verdict::Undecided);
    }

    #[test]
    fn shares_and_counts_are_those_of_the_windows() {
        let found = verdict(1.0, 0.0);
        assert!((found.time_share_inside - 0.2).abs() < 1e-9);
        assert!((found.squared_error_share_inside - 1.0).abs() < 1e-12);
        let test = found.test.unwrap();
        assert_eq!((test.inside_count, test.outside_count, test.effect), (10, 11, 1.0));
    }

    #[test]
    fn the_p_value_is_that_of_scipy() {
        // scipy.stats.mannwhitneyu([1.1, 2.2, 3.9, 5.0], [0.5, 1.0, 1.9], method="asymptotic")
        let found = test(&[1.1, 2.2, 3.9, 5.0], &[0.5, 1.0, 1.9]).unwrap();
        assert!((found.p_value - 0.111_611_768_298_292_24).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn joints_that_start_together_are_one_event() {
        let blocks = vec![(1.0, 2.0), (1.4, 4.0), (9.0, 1.0)];
        assert_eq!(events(blocks, &Rules::default()), [3.0, 1.0]);
    }
}
