//! Elementary functions of additions, multiplications, divisions and square roots alone, so that every lane
//! of every processor gives the same digits: sine and cosine, angle of a direction, hyperbolic tangent.
//!
//! # Source
//! Argument reduction in parts of pi: Cody, Waite (1980), Software Manual for the Elementary Functions.
//! Polynomials: interpolation at Chebyshev points, Trefethen (2019), Approximation Theory and Approximation Practice.

use super::Real;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_4, PI};

/// The sine of pi/8, where the angle to the diagonal gets smaller than that to the axis.
const SIN_PI_8: f64 = 0.3826834323650898;

/// pi in three parts, the first two with trailing zeros, so that their multiples by whole numbers below 2^21
/// are exact.
const PI_PARTS: [f64; 3] = [3.1415926534682512, 1.2154201012607932e-10, 4.044532497591901e-21];

/// Of z = r^2 in sin(r) / r and cos(r), |r| <= pi/2: 1, and interpolates of the rest over z at seven and eight Chebyshev points, to 7e-16
/// of sin(r) and 2e-17 of cos(r).
const SINE: [f64; 8] = [
    1.0,
    -0.1666666666666665,
    0.008333333333325933,
    -0.00019841269836469024,
    2.7557318055685783e-06,
    -2.505197292154555e-08,
    1.6050972244135636e-10,
    -7.40805488954261e-13,
];
const COSINE: [f64; 9] = [
    1.0,
    -0.5,
    0.04166666666666634,
    -0.0013888888888860709,
    2.4801587292446213e-05,
    -2.755731776732053e-07,
    2.0876630867422994e-09,
    -1.1464689885720029e-11,
    4.6276759850181716e-14,
];

/// Sine and cosine, to 1e-15 of angles below 1e6 [rad].
#[inline(always)]
pub(crate) fn sincos<R: Real>(angle: R) -> (R, R) {
    let turns = (angle * (1.0 / PI)).round();
    // Without `map`, whose closure is not compiled for the instruction set of the lanes.
    let mut r = angle;
    for part in PI_PARTS {
        r = r.minus_product(turns, angle.like(part));
    }
    // Half turns change the signs of both: +1 for even, -1 for odd ones.
    let half = turns * 0.5;
    let sign = turns.like(1.0).minus_product((half - half.round()).abs(), turns.like(4.0));
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
        top = z.like(a[k - 1]).plus_product(top, w);
        next = z.like(a[k - 2]).plus_product(next, w);
        k -= 2;
    }
    // Of an odd number of terms one is left.
    let odd = if k == 1 { z.like(a[0]).plus_product(top, w) } else { top };
    if k == 1 { odd.plus_product(next, z) } else { next.plus_product(top, z) }
}

/// Of z = x^2 in (asin(x) / x - 1) / z, |x| <= sin(pi/8): interpolates at eight Chebyshev points, to 7e-15 of asin(x).
const ARCSINE: [f64; 8] = [
    0.16666666666655944,
    0.07500000009364116,
    0.044642843782768275,
    0.030382667133030127,
    0.022353087622857398,
    0.017623190997033304,
    0.011883288914892818,
    0.019481960446313038,
];

/// Angle of the unit vector `u` in [-pi, pi], to 1e-14 [rad]; zero of the zero vector. Where it places a contact, the radius of the bore
/// differs by less than 1e-18 m.
#[inline(always)]
pub(crate) fn direction_angle<R: Real>([x, y]: [R; 2]) -> R {
    let (ax, ay) = (x.abs(), y.abs());
    let (small, large) = (ax.smaller(ay), ax.larger(ay));
    // The sine of the angle to the nearer axis, beyond pi/8 that of the angle to the diagonal.
    let beyond = small.like(SIN_PI_8).below(small);
    let sine = R::select(beyond, (small - large) * FRAC_1_SQRT_2, small);
    let z = sine * sine;
    let near = sine.plus_product(sine * z, polynomial(z, &ARCSINE));
    let angle = R::select(beyond, near + FRAC_PI_4, near);
    let angle = R::select(ax.below(ay), angle.like(FRAC_PI_2) - angle, angle);
    let nothing = x.zero();
    let angle = R::select(x.below(nothing), angle.like(PI) - angle, angle);
    R::select(y.below(nothing), -angle, angle)
}

/// Of y in exp(y), -0.625 <= y <= 0: 1, and the interpolate of the rest over y at eight Chebyshev points, to 9e-13.
const EXPONENTIAL: [f64; 9] = [
    1.0,
    0.9999999999984713,
    0.4999999996867616,
    0.16666665611507442,
    0.04166653093745765,
    0.00833247308818961,
    0.0013859120845655592,
    0.00019264634367185414,
    1.8836101929104765e-05,
];

/// Hyperbolic tangent, to 1e-12, of which friction needs five digits: (1 - z) / (1 + z) with z = exp(-2 |x|), which is a 64th power of the
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

/// Cube root of numbers not below zero, to 4e-16 of itself; zero for subnormal numbers.
///
/// A third of the bits is the logarithm to 4 %; Halley's method triples the digits three times.
#[inline(always)]
pub(crate) fn cube_root<R: Real>(x: R) -> R {
    /// Two thirds of the bits of one, less what makes the largest errors of both signs equal.
    const SHIFT: u64 = 0x2A9F_7893_782D_A1CE;
    let mut y = x.each(|k| f64::from_bits(x.lane(k).to_bits() / 3 + SHIFT));
    for _ in 0..3 {
        let cube = y * y * y;
        y = y * ((cube + x * 2.0) / (cube * 2.0 + x));
    }
    R::select(x.like(f64::MIN_POSITIVE).below(x), y, x * 0.0)
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
        assert!(sine < 1e-15 && angle < 1e-14 && tangent < 1e-12);
        let along_axes = [[0.0, 0.0], [-1.0, 0.0], [1.0, 0.0], [0.0, -1.0]].map(direction_angle);
        assert_eq!(along_axes, [0.0, PI, 0.0, -FRAC_PI_2]);
        assert_eq!((sincos(0.0), tanh(0.0)), ((0.0, 1.0), 0.0));
        assert!(sincos(f64::NAN).0.is_nan() && tanh(f64::INFINITY) == 1.0);
    }

    #[test]
    fn cube_roots_agree_with_the_library_over_all_magnitudes() {
        let mut worst = 0.0_f64;
        for k in -60_000..60_000 {
            let x = (0.0117 * f64::from(k)).exp();
            worst = worst.max((cube_root(x) / x.cbrt() - 1.0).abs());
        }
        println!("cube root {worst:e}");
        assert!(worst < 5e-16, "{worst}");
        assert_eq!((cube_root(0.0), cube_root(8.0)), (0.0, 2.0));
        assert!(cube_root(f64::NAN).is_nan());
    }

    /// Every function of these numbers.
    fn every<R: Real>(x: R, y: R) -> [R; 10] {
        [
            sincos(x).0,
            sincos(x).1,
            direction_angle([y, x]),
            tanh(x),
            x.larger(y),
            x.smaller(y),
            Real::round(x),
            x.plus_product(x, y),
            y.minus_product(x, x),
            cube_root(x.abs()),
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
                let below = |lane: usize| u64::from(x.lane(lane) < y.lane(lane)) << lane;
                assert_eq!(Lanes::bits(x.below(y)), (0..S::F64_LANES).map(below).sum::<u64>());
                let mut stored = [0.0_f64; 16];
                x.store(&mut stored);
                assert_eq!(&stored[..S::F64_LANES], x.values());
                // Of three rows a lane the second or third.
                let number = x.each(|lane| f64::from_bits(0xABC0_0000_0000_0001 + lane as u64 % 2));
                let row = |k: usize| [0, 1, 2, 3].map(|column| (4 * k + column) as f64);
                let table: Vec<[f64; 4]> = (0..3 * S::F64_LANES).map(row).collect();
                let columns = number.columns(&table, 3);
                for lane in 0..S::F64_LANES {
                    let (x, y) = (x.lane(lane), y.lane(lane));
                    assert_eq!(columns.map(|column| column.lane(lane)), row(3 * lane + 1 + lane % 2));
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
        #[cfg(target_arch = "x86_64")]
        if let Some(narrower) = pulp::x86::V3::try_new() {
            assert_eq!(pulp::Simd::vectorize(narrower, Compare), 4);
        }
    }
}
