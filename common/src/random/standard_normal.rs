//! The standard normal distribution N(0, 1), on which the other distributions build their tails.
//!
//! | | |
//! |---|---|
//! | support | all real numbers |
//! | density | phi(z) = exp(-z^2 / 2) / sqrt(2 pi) |
//! | distribution function | Phi(z) = erfc(-z / sqrt(2)) / 2 |
//! | quantile | Phi^-1(p) = -sqrt(2) erfc^-1(2 p) |
//!
//! # Source
//! Johnson, Kotz, Balakrishnan (1994), Continuous Univariate Distributions, vol. 1, chapter 13. `erfc` is that of the
//! crate `libm`, its inverse that of `statrs`.

use statrs::function::erf::erfc_inv;
use std::f64::consts::{FRAC_1_SQRT_2, PI, SQRT_2};

/// Standard normal density phi(z) [1] at z [1].
pub fn standard_normal_pdf(z: f64) -> f64 {
    libm::exp(-0.5 * z * z) / (2.0 * PI).sqrt()
}

/// Standard normal distribution function Phi(z) [1] at z [1], relative accuracy kept in the lower tail.
pub fn standard_normal_cdf(z: f64) -> f64 {
    0.5 * libm::erfc(-z * FRAC_1_SQRT_2)
}

/// Probability Phi(b) - Phi(a) [1] of a standard normal variable between a and b, computed in the tail where it has most digits.
pub fn standard_normal_mass(a: f64, b: f64) -> f64 {
    if a > 0.0 {
        standard_normal_cdf(-a) - standard_normal_cdf(-b)
    } else {
        standard_normal_cdf(b) - standard_normal_cdf(a)
    }
}

/// Standard normal quantile Phi^-1(p) [1] for p in [0, 1]; infinite at the ends.
///
/// One Newton step on the distribution function removes the rounding of the rational approximation; in the tails
/// beyond |z| = 8 the step is omitted, since Phi has too few digits there to improve it.
pub fn standard_normal_quantile(p: f64) -> f64 {
    let z = -SQRT_2 * erfc_inv(2.0 * p);
    if z.abs() < 8.0 { z - (standard_normal_cdf(z) - p) / standard_normal_pdf(z) } else { z }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standard_normal_quantile_round_trip_in_both_tails() {
        for z in [-7.5, -5.0, -1.0, -1e-3, 0.0, 0.7, 3.0] {
            assert!(
                (standard_normal_quantile(standard_normal_cdf(z)) - z).abs()
                    < 1e-12 * (1.0 + z.abs()) / (1.0 - standard_normal_cdf(z))
            );
        }
    }
}
