//! Integrals over time by Gauss-Legendre quadrature on every polynomial piece.

use multiversion::multiversion;

use super::{Spline, basis};

/// Number of nodes on every piece; n nodes integrate degree 2n - 1 exactly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gauss {
    /// Exact for the square of a sextic's jerk.
    Four,
    /// For integrands that are no polynomials, such as power.
    Eight,
}

/// Nodes in (-1, 1) and weights that sum to 2 (Abramowitz and Stegun, table 25.4).
type Rule<const L: usize> = [(f64, f64); L];

const THREE: Rule<3> = mirrored(&[(0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)]);
const FOUR: Rule<4> = mirrored(&[
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
]);
const FIVE: Rule<5> = mirrored(&[
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
]);
const EIGHT: Rule<8> = mirrored(&[
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
]);

/// A whole rule, ascending, from its half without negative nodes.
const fn mirrored<const L: usize>(half: &[(f64, f64)]) -> Rule<L> {
    let mut rule = [(0.0, 0.0); L];
    let mut i = 0;
    while i < half.len() {
        let (node, weight) = half[i];
        rule[L - half.len() + i] = (node, weight);
        rule[half.len() - 1 - i] = (-node, weight);
        i += 1;
    }
    rule
}

impl Spline {
    /// Nodes and weights of every one of the equal parts of every piece, ascending in time, appended to the buffers: the
    /// integral over time is the sum of values times weights. Nodes and weights in s.
    pub fn quadrature(&self, gauss: Gauss, parts: usize, nodes_s: &mut Vec<f64>, weights_s: &mut Vec<f64>) {
        let rule: &[(f64, f64)] = match gauss {
            Gauss::Four => &FOUR,
            Gauss::Eight => &EIGHT,
        };
        for ends in self.knots.breaks().windows(2) {
            let end = |part: usize| match part {
                _ if part == parts => ends[1],
                _ => ends[0] + (ends[1] - ends[0]) * (part as f64 / parts as f64),
            };
            for part in 0..parts {
                let (from, to) = (end(part), end(part + 1));
                let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
                for (node, weight) in rule {
                    nodes_s.push(middle + half * node);
                    weights_s.push(half * weight);
                }
            }
        }
    }

    /// Adds each joint's exact integral of jerk squared over time, rad²/s⁵, to `integral`, `[joint]`.
    #[inline]
    pub fn add_squared_jerk(&self, integral: &mut [f64]) {
        dispatched(self, integral);
    }

    /// By a rule of `L` nodes for jerk of degree `DEGREE`.
    #[inline(always)]
    fn add_squared_jerk_by<const DEGREE: usize, const L: usize>(&self, rule: &Rule<L>, integral: &mut [f64]) {
        let stride = self.knots.controls() - 3;
        for (piece, ends) in self.knots.breaks().windows(2).enumerate() {
            let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
            let t_s = rule.map(|(node, _)| middle + half * node);
            let row = basis::row::<DEGREE, L>(&self.knots, piece, &t_s);
            for (control, integral) in self.controls[3].chunks_exact(stride).zip(&mut *integral) {
                let jerk = basis::weigh(&control[piece..=piece + DEGREE], &row);
                let mean: f64 = jerk.iter().zip(rule).map(|(jerk, (_, weight))| weight * jerk * jerk).sum();
                *integral += half * mean;
            }
        }
    }

    /// Root mean square of each joint's jerk over the whole spline, rad/s³, into `rms`, `[joint]`.
    pub fn rms_jerk(&self, rms_rad_s3: &mut [f64]) {
        rms_rad_s3.fill(0.0);
        self.add_squared_jerk(rms_rad_s3);
        let duration_s = self.duration_s();
        for value in rms_rad_s3 {
            *value = (*value / duration_s).sqrt();
        }
    }
}

/// Integrals of jerk squared by the widest vector unit of the processor; the result does not depend on which.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2", "x86_64+sse4.1"))]
fn dispatched(spline: &Spline, integral: &mut [f64]) {
    match spline.knots.degree {
        5 => spline.add_squared_jerk_by::<2, 3>(&THREE, integral),
        6 => spline.add_squared_jerk_by::<3, 4>(&FOUR, integral),
        _ => spline.add_squared_jerk_by::<4, 5>(&FIVE, integral),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Integral of x^k over [-1, 1] by a rule.
    fn moment(rule: &[(f64, f64)], k: i32) -> f64 {
        rule.iter().map(|(x, w)| w * x.powi(k)).sum()
    }

    #[test]
    fn n_nodes_integrate_powers_up_to_twice_n_less_one() {
        for rule in [&THREE[..], &FOUR, &FIVE, &EIGHT] {
            for k in 0..2 * rule.len() {
                let k = i32::try_from(k).unwrap();
                let exact = if k % 2 == 0 { 2.0 / f64::from(k + 1) } else { 0.0 };
                assert!((moment(rule, k) - exact).abs() < 4e-16, "{} nodes, x^{k}", rule.len());
            }
            assert!(rule.windows(2).all(|pair| pair[0].0 < pair[1].0));
        }
    }
}
