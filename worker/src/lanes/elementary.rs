//! Elementary functions of additions, multiplications, divisions and square roots alone, so that every lane
//! of every processor gives the same digits: sine and cosine, angle of a direction, hyperbolic tangent.
//!
//! # Source
//! Argument reduction in parts of pi: Cody, Waite (1980), Software Manual for the Elementary Functions.
//! Arcsine: interpolation at Chebyshev points. Sine, cosine and exponential: Taylor polynomials.

use super::Real;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_4, PI};

/// The sine of pi/8, where the angle to the diagonal gets smaller than that to the axis.
const SIN_PI_8: f64 = 0.3826834323650898;

/// pi in three parts, the first two with trailing zeros, so that their multiples by whole numbers below 2^21
/// are exact.
const PI_PARTS: [f64; 3] = [3.1415926534682512, 1.2154201012607932e-10, 4.044532497591901e-21];

/// 1/1!, -1/3!, ... and 1, -1/2!, ...: on [-pi/2, pi/2] what is left out is below 3e-16.
const SINE: [f64; 10] = alternating_inverse_factorials(1);
const COSINE: [f64; 11] = alternating_inverse_factorials(0);

const fn alternating_inverse_factorials<const N: usize>(first: usize) -> [f64; N] {
    let mut out = [0.0; N];
    let mut k = 0;
    while k < N {
        let (mut factorial, mut m) = (1.0, 1);
        while m <= first + 2 * k {
            factorial *= m as f64;
            m += 1;
        }
        out[k] = if k % 2 == 0 { 1.0 / factorial } else { -1.0 / factorial };
        k += 1;
    }
    out
}

/// Sine and cosine, to 1e-15 of angles below 1e6 [rad].
#[inline(always)]
pub(crate) fn sincos<R: Real>(angle: R) -> (R, R) {
    let turns = (angle * (1.0 / PI)).round();
    let r = ((angle - turns * PI_PARTS[0]) - turns * PI_PARTS[1]) - turns * PI_PARTS[2];
    // Half turns change the signs of both: +1 for even, -1 for odd ones.
    let half = turns * 0.5;
    let sign = turns.like(1.0) - (half - half.round()).abs() * 4.0;
    let z = r * r;
    (sign * r * polynomial(z, &SINE), sign * polynomial(z, &COSINE))
}

/// a0 + a1 z + a2 z^2 + ..., even and odd powers apart: two short chains instead of one long one.
#[inline(always)]
fn polynomial<R: Real, const N: usize>(z: R, a: &[f64; N]) -> R {
    let w = z * z;
    let (last, before) = (N - 1, N - 2);
    let (mut top, mut next) = (z.like(a[last]), z.like(a[before]));
    let mut k = before;
    while k >= 2 {
        top = top * w + a[k - 1];
        next = next * w + a[k - 2];
        k -= 2;
    }
    // Of an odd number of terms one is left.
    if k == 1 { top * w + next * z + a[0] } else { top * z + next }
}

/// Of z = x^2 in (asin(x) / x - 1) / z, |x| <= sin(pi/8): interpolates at eleven Chebyshev points, to 2e-18 of asin(x).
const ARCSINE: [f64; 11] = [
    0.16666666666666666,
    0.0749999999999928,
    0.044642857144818006,
    0.030381944236636167,
    0.02237217035271985,
    0.017352409710914115,
    0.013971772596409786,
    0.011465566508595338,
    0.010441852148105453,
    0.0051454552951189945,
    0.01548929717341966,
];

/// Angle of the unit vector `u` in [-pi, pi], to 1e-15 [rad]; zero of the zero vector.
#[inline(always)]
pub(crate) fn direction_angle<R: Real>([x, y]: [R; 2]) -> R {
    let (ax, ay) = (x.abs(), y.abs());
    let (small, large) = (ax.smaller(ay), ax.larger(ay));
    // The sine of the angle to the nearer axis, beyond pi/8 that of the angle to the diagonal.
    let beyond = small.like(SIN_PI_8).below(small);
    let sine = R::select(beyond, (small - large) * FRAC_1_SQRT_2, small);
    let z = sine * sine;
    let near = sine + sine * z * polynomial(z, &ARCSINE);
    let angle = R::select(beyond, near + FRAC_PI_4, near);
    let angle = R::select(ax.below(ay), angle.like(FRAC_PI_2) - angle, angle);
    let nothing = x.zero();
    let angle = R::select(x.below(nothing), angle.like(PI) - angle, angle);
    R::select(y.below(nothing), -angle, angle)
}

const EXPONENTIAL: [f64; 16] = {
    let mut out = [1.0; 16];
    let mut k = 1;
    while k < 16 {
        out[k] = out[k - 1] / k as f64;
        k += 1;
    }
    out
};

/// Hyperbolic tangent, to 1e-14: (1 - z) / (1 + z) with z = exp(-2 |x|), which is a 64th power of the
/// exponential of at most 0.63.
#[inline(always)]
pub(crate) fn tanh<R: Real>(x: R) -> R {
    let y = x.abs().smaller(x.like(20.0)) * (-2.0 / 64.0);
    let mut z = polynomial(y, &EXPONENTIAL);
    for _ in 0..6 {
        z = z * z;
    }
    let size = (z.like(1.0) - z) / (z + 1.0);
    R::select(x.below(x.zero()), -size, size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Lanes;
    use pulp::{Arch, Simd, WithSimd};

    #[test]
    fn functions_agree_with_the_library() {
        let (mut sine, mut angle, mut tangent) = (0.0_f64, 0.0_f64, 0.0_f64);
        for k in -40_000..40_000 {
            let x = 0.000_37 * f64::from(k) * (1.0 + f64::from(k).abs() * 1e-2);
            let (s, c) = sincos(x);
            sine = sine.max((s - x.sin()).abs()).max((c - x.cos()).abs());
            let (y, x) = (x.sin(), (1.7 * x).cos());
            let u = [x / x.hypot(y), y / x.hypot(y)];
            angle = angle.max((direction_angle(u) - y.atan2(x)).abs());
            let v = 0.001 * f64::from(k);
            tangent = tangent.max((tanh(v) - v.tanh()).abs());
        }
        println!("sincos {sine:e}, direction {angle:e}, tanh {tangent:e}");
        assert!(sine < 1e-15 && angle < 1e-15 && tangent < 1e-14);
        let along_axes = [[0.0, 0.0], [-1.0, 0.0], [1.0, 0.0], [0.0, -1.0]].map(direction_angle);
        assert_eq!(along_axes, [0.0, PI, 0.0, -FRAC_PI_2]);
        assert_eq!((sincos(0.0), tanh(0.0)), ((0.0, 1.0), 0.0));
        assert!(sincos(f64::NAN).0.is_nan() && tanh(f64::INFINITY) == 1.0);
    }

    /// Every function of these numbers.
    fn every<R: Real>(x: R, y: R) -> [R; 7] {
        [
            sincos(x).0,
            sincos(x).1,
            direction_angle([y, x]),
            tanh(x),
            x.larger(y),
            x.smaller(y),
            Real::round(x),
        ]
    }

    /// Every function in lanes against one number at a time.
    struct Compare;

    impl WithSimd for Compare {
        type Output = usize;
        fn with_simd<S: Simd>(self, simd: S) -> usize {
            for k in 0..5000 {
                let x = Lanes::all(simd, 0.0).each(|lane| (f64::from(k) * 0.037 + 1.3 * lane as f64).tan());
                let y = x.each(|lane| (f64::from(k) * 0.11 - 0.7 * lane as f64).sin());
                let found = every(x, y);
                for lane in 0..S::F64_LANES {
                    let (x, y) = (x.lane(lane), y.lane(lane));
                    let alone = every(x, y);
                    for (found, alone) in found.iter().zip(alone) {
                        assert_eq!(found.lane(lane).to_bits(), alone.to_bits(), "{x} {y}");
                    }
                }
            }
            S::F64_LANES
        }
    }

    #[test]
    fn lanes_have_the_bits_of_one_number() {
        println!("{} lanes", Arch::new().dispatch(Compare));
        assert_eq!(pulp::Scalar::new().vectorize(Compare), 1);
    }
}
