//! Sine and cosine of several angles at once, in a form that compilers turn into vector code.

/// 2/pi.
const QUADRANTS_PER_RAD: f64 = std::f64::consts::FRAC_2_PI;
/// pi/2 in three parts; the first two end in zeros, so that their products with a quadrant number
/// below 2^20 are exact (Cody and Waite 1980, chapter 8).
const QUADRANT_RAD: [f64; 3] = [
    f64::from_bits(0x3FF9_21FB_5440_0000),
    f64::from_bits(0x3DD0_B461_1A60_0000),
    f64::from_bits(0x3BA3_198A_2E03_7073),
];
/// Adding it leaves the nearest integer in the low bits.
const ROUND: f64 = 1.5 * (1_u64 << 52) as f64;
/// Beyond it the reduction is no longer exact.
const LARGEST_RAD: f64 = 1e6;

/// Sines and cosines, to 1e-15; the same on every machine for angles below 1e6 rad.
///
/// Taylor polynomials about the nearest multiple of pi/2, whose remainder there is below 5e-17.
#[inline(always)]
pub fn sin_cos<const L: usize>(angle_rad: &[f64; L]) -> ([f64; L], [f64; L]) {
    let (mut sin, mut cos) = ([0.0; L], [0.0; L]);
    if !angle_rad.iter().fold(true, |small, a| small & (a.abs() < LARGEST_RAD)) {
        for lane in 0..L {
            (sin[lane], cos[lane]) = angle_rad[lane].sin_cos();
        }
        return (sin, cos);
    }
    for lane in 0..L {
        let x = angle_rad[lane];
        let shifted = x * QUADRANTS_PER_RAD + ROUND;
        let quadrant = shifted.to_bits();
        let n = shifted - ROUND;
        let r = ((x - n * QUADRANT_RAD[0]) - n * QUADRANT_RAD[1]) - n * QUADRANT_RAD[2];
        let (s, c) = (sine(r), cosine(r));
        let swap = 0_u64.wrapping_sub(quadrant & 1);
        let (s, c) = (s.to_bits(), c.to_bits());
        let (s, c) = ((s & !swap) | (c & swap), (c & !swap) | (s & swap));
        sin[lane] = f64::from_bits(s ^ ((quadrant & 2) << 62));
        cos[lane] = f64::from_bits(c ^ ((quadrant.wrapping_add(1) & 2) << 62));
    }
    (sin, cos)
}

/// Coefficient of x^n, 1/n!.
const fn taylor(n: u32) -> f64 {
    let (mut factorial, mut k) = (1.0, 2);
    while k <= n {
        factorial *= k as f64;
        k += 1;
    }
    1.0 / factorial
}

#[inline]
fn sine(x: f64) -> f64 {
    const C: [f64; 7] = [-taylor(3), taylor(5), -taylor(7), taylor(9), -taylor(11), taylor(13), -taylor(15)];
    let y = x * x;
    let tail = C[0] + y * (C[1] + y * (C[2] + y * (C[3] + y * (C[4] + y * (C[5] + y * C[6])))));
    x + x * y * tail
}

#[inline]
fn cosine(x: f64) -> f64 {
    const C: [f64; 7] = [taylor(4), -taylor(6), taylor(8), -taylor(10), taylor(12), -taylor(14), taylor(16)];
    let y = x * x;
    let tail = C[0] + y * (C[1] + y * (C[2] + y * (C[3] + y * (C[4] + y * (C[5] + y * C[6])))));
    1.0 - (0.5 * y - y * y * tail)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_quadrant_agrees_with_the_library_to_two_units_in_the_last_place() {
        for k in -40_000..40_000 {
            let x = f64::from(k) * 0.000_731_9 + f64::from(k % 7) * 10_000.3;
            let ([s, _], [c, _]) = sin_cos(&[x, -x]);
            assert!((s - x.sin()).abs() < 4e-16 && (c - x.cos()).abs() < 4e-16, "{x}: {s} {c}");
        }
    }

    #[test]
    fn angles_too_large_to_reduce_and_infinite_ones_are_left_to_the_library() {
        let ([s, huge], _) = sin_cos(&[f64::INFINITY, 1e300]);
        assert!(s.is_nan());
        assert!((huge - 1e300_f64.sin()).abs() < 1e-15);
    }
}
