//! Correlation functions R of the scaled squared distance r2 = sum over k of theta_k (x_k - x'_k)^2 [1], with
//! theta_k = 1 / (2 length_k^2):
//!
//!   Gaussian     R = exp(-r2)
//!   Matern 5/2   R = (1 + s + s^2 / 3) exp(-s),  s = sqrt(10 r2)
//!   Matern 3/2   R = (1 + s) exp(-s),            s = sqrt(6 r2)
//!
//! With the distance h in lengths, r2 = h^2 / 2. All three are radial in the scaled space, so a correlation
//! matrix is one matrix product and one pass over its entries, and the derivative with respect to ln theta_k
//! is dR/dr2 theta_k (x_k - x'_k)^2: one further matrix serves all d derivatives.
//!
//! Both passes are compiled for the widest vectors of the processor; products and sums are not fused, so that their bits do not depend on it.
//!
//! The exponential function of correlations, in a form that the compiler vectorises.
//!
//! # Source
//! Rasmussen, Williams (2006), Gaussian Processes for Machine Learning, eqs. 4.9 and 4.17.

use crate::named::named;
use pulp::{Arch, NullaryFnOnce};

/// Correlation function, by the smoothness it assumes of the response.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum Kernel {
    /// Gaussian, derivatives of every order.
    #[default]
    Gaussian,
    /// Matern 5/2, two derivatives.
    Matern52,
    /// Matern 3/2, one derivative.
    Matern32,
}

// The smoothest first: the order in which cross-validation tries them.
named!(Kernel { Gaussian = "gaussian", Matern52 = "matern52", Matern32 = "matern32" });

impl Kernel {
    /// Overwrites scaled squared distances `(n,)` [1] with correlations [1]. Negative distances, which only
    /// rounding can give, count as zero.
    pub(crate) fn correlate(self, squares: &mut [f64]) {
        Arch::new().dispatch(Correlations { kernel: self, squares });
    }

    /// Overwrites scaled squared distances `(n,)` [1] with correlations [1] and writes -dR/dr2 [1] to
    /// `slopes` `(n,)`: R itself, 5/3 (1 + s) exp(-s), 3 exp(-s).
    pub(crate) fn correlate_with_slopes(self, squares: &mut [f64], slopes: &mut [f64]) {
        Arch::new().dispatch(CorrelationsAndSlopes { kernel: self, squares, slopes });
    }
}

/// The pass of [`Kernel::correlate`].
struct Correlations<'a> {
    kernel: Kernel,
    squares: &'a mut [f64],
}

impl NullaryFnOnce for Correlations<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let squares = self.squares.iter_mut();
        match self.kernel {
            Kernel::Gaussian => squares.for_each(|r2| *r2 = exp_nonpositive(-*r2)),
            Kernel::Matern52 => squares.for_each(|r2| {
                let s = (10.0 * r2.max(0.0)).sqrt();
                *r2 = (1.0 + s + s * s * (1.0 / 3.0)) * exp_nonpositive(-s);
            }),
            Kernel::Matern32 => squares.for_each(|r2| {
                let s = (6.0 * r2.max(0.0)).sqrt();
                *r2 = (1.0 + s) * exp_nonpositive(-s);
            }),
        }
    }
}

/// The pass of [`Kernel::correlate_with_slopes`].
struct CorrelationsAndSlopes<'a> {
    kernel: Kernel,
    squares: &'a mut [f64],
    slopes: &'a mut [f64],
}

impl NullaryFnOnce for CorrelationsAndSlopes<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let pairs = self.squares.iter_mut().zip(self.slopes);
        match self.kernel {
            Kernel::Gaussian => pairs.for_each(|(r2, slope)| {
                *r2 = exp_nonpositive(-*r2);
                *slope = *r2;
            }),
            Kernel::Matern52 => pairs.for_each(|(r2, slope)| {
                let s = (10.0 * r2.max(0.0)).sqrt();
                let e = exp_nonpositive(-s);
                *slope = (5.0 / 3.0) * (1.0 + s) * e;
                *r2 = (1.0 + s + s * s * (1.0 / 3.0)) * e;
            }),
            Kernel::Matern32 => pairs.for_each(|(r2, slope)| {
                let s = (6.0 * r2.max(0.0)).sqrt();
                let e = exp_nonpositive(-s);
                *slope = 3.0 * e;
                *r2 = (1.0 + s) * e;
            }),
        }
    }
}

/// e^x for x <= 0, to 2 units in the last place. Positive x, which only rounding can give, count as 0; x
/// below -200, where a correlation of 1e-87 is negligible, count as -200.
///
/// x = k ln 2 + r with |r| <= ln 2 / 2, and the exponential series of r to degree 13 (remainder 4e-18):
/// e^x = 2^k sum over i of r^i / i!.
///
/// Why not `f64::exp`: this form has no branches, so the compiler vectorises it, and no call to the system's
/// mathematical library, whose `exp` takes 330 ns instead of 5 after a matrix product has left the upper
/// halves of the vector registers in use (measured on an AVX-512 machine), and whose bits differ between
/// systems. The hyperbolic tangent of the worker's SIMD lanes has its own exponential, a 64th power accurate
/// to 1e-14 over a smaller range; replacing either by the other would change its bits.
///
/// # Source
/// Argument reduction with ln 2 in two parts: Cody, Waite (1980), Software Manual for the Elementary
/// Functions.
#[inline(always)]
pub(super) fn exp_nonpositive(x: f64) -> f64 {
    // Adding 1.5 * 2^52 rounds to an integer, which is then in the lowest bits.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    // ln 2 in two parts, the first with trailing zeros so that k ln 2 is exact.
    const LN2_HIGH: f64 = 0.693_147_180_369_123_8;
    const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;
    let x = x.clamp(-200.0, 0.0);
    let shifted = x * std::f64::consts::LOG2_E + ROUND;
    let k = shifted - ROUND;
    let r = (x - k * LN2_HIGH) - k * LN2_LOW;
    let mut series = 1.0 / 6_227_020_800.0;
    for inverse_factorial in [
        1.0 / 479_001_600.0,
        1.0 / 39_916_800.0,
        1.0 / 3_628_800.0,
        1.0 / 362_880.0,
        1.0 / 40_320.0,
        1.0 / 5_040.0,
        1.0 / 720.0,
        1.0 / 120.0,
        1.0 / 24.0,
        1.0 / 6.0,
        0.5,
        1.0,
        1.0,
    ] {
        series = series * r + inverse_factorial;
    }
    series * f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value_and_slope(kernel: Kernel, r2: f64) -> (f64, f64) {
        let (mut value, mut slope, mut alone) = ([r2], [0.0], [r2]);
        kernel.correlate_with_slopes(&mut value, &mut slope);
        kernel.correlate(&mut alone);
        assert_eq!(alone, value, "{kernel:?}");
        (value[0], slope[0])
    }

    #[test]
    fn values_are_those_of_the_closed_forms() {
        // Distance h in lengths, r2 = h^2 / 2.
        for h in [0.0, 1e-9, 0.1, 0.7, 1.0, 2.5, 9.0_f64] {
            let s5 = 5f64.sqrt() * h;
            let s3 = 3f64.sqrt() * h;
            let expected = [
                (-0.5 * h * h).exp(),
                (1.0 + s5 + 5.0 * h * h / 3.0) * (-s5).exp(),
                (1.0 + s3) * (-s3).exp(),
            ];
            for (kernel, expected) in Kernel::ALL.into_iter().zip(expected) {
                let found = value_and_slope(kernel, 0.5 * h * h).0;
                assert!((found - expected).abs() <= 1e-15, "{kernel:?} {h}: {found} {expected}");
            }
        }
    }

    #[test]
    fn slopes_match_differences() {
        for kernel in Kernel::ALL {
            for r2 in [0.01, 0.3, 1.0, 4.0] {
                let step = 1e-6;
                let numeric = (value_and_slope(kernel, r2 - step).0 - value_and_slope(kernel, r2 + step).0)
                    / (2.0 * step);
                assert!((value_and_slope(kernel, r2).1 - numeric).abs() < 1e-8, "{kernel:?} {r2}: {numeric}");
            }
            // At zero distance the slope is finite: 1, 5/3, 3.
            let expected = [1.0, 5.0 / 3.0, 3.0][kernel as usize];
            assert_eq!(value_and_slope(kernel, 0.0), (1.0, expected));
            assert_eq!(value_and_slope(kernel, -1e-17), (1.0, expected));
        }
    }

    #[test]
    fn the_vectors_of_the_processor_do_not_change_a_bit() {
        let distances: Vec<f64> = (0..1003).map(|i| 1e-3 * f64::from(i).powi(2) - 1e-12).collect();
        for kernel in Kernel::ALL {
            let (mut wide, mut wide_slopes) = (distances.clone(), distances.clone());
            let (mut narrow, mut narrow_slopes) = (distances.clone(), distances.clone());
            kernel.correlate(&mut wide);
            Correlations { kernel, squares: &mut narrow }.call();
            assert_eq!(wide, narrow, "{kernel:?}");
            let mut wide = distances.clone();
            kernel.correlate_with_slopes(&mut wide, &mut wide_slopes);
            narrow.copy_from_slice(&distances);
            CorrelationsAndSlopes { kernel, squares: &mut narrow, slopes: &mut narrow_slopes }.call();
            assert_eq!((wide, wide_slopes), (narrow, narrow_slopes), "{kernel:?}");
        }
    }

    #[test]
    fn the_exponential_is_accurate_to_two_units_in_the_last_place() {
        assert_eq!(exp_nonpositive(0.0), 1.0);
        assert_eq!(exp_nonpositive(1e-17), 1.0);
        for i in 0..200_000 {
            let x = -199.9 * (f64::from(i) / 200_000.0).powi(3);
            let exact = x.exp();
            assert!((exp_nonpositive(x) - exact).abs() <= 2.0 * f64::EPSILON * exact, "{x}");
        }
        assert!(exp_nonpositive(-1e9) > 0.0 && exp_nonpositive(-1e9) < 1e-86);
    }
}
