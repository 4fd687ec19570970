//! Density, distribution function, quantile, moments and score functions of the truncated normal.
//!
//! X = N(mean, std) restricted to [lower, upper]; with z = (x - mean) / std, a and b the standardised bounds and
//! Z = Phi(b) - Phi(a): f(x) = phi(z) / (std Z). The parameters `mean` and `std` are those of the untruncated
//! parent; [`Distribution::mean`] and [`Distribution::std`] are the moments of X itself.
//!
//! Source: Johnson, Kotz, Balakrishnan (1994), Continuous Univariate Distributions, vol. 1, section 13.10.1.

use super::Distribution;
use statrs::function::erf::erfc_inv;
use std::f64::consts::{FRAC_1_SQRT_2, PI, SQRT_2};

/// Standard normal density phi(z) [1].
pub fn standard_normal_pdf(z: f64) -> f64 {
    libm::exp(-0.5 * z * z) / (2.0 * PI).sqrt()
}

/// Standard normal distribution function Phi(z) [1], relative accuracy kept in the lower tail.
pub fn standard_normal_cdf(z: f64) -> f64 {
    0.5 * libm::erfc(-z * FRAC_1_SQRT_2)
}

/// Standard normal quantile Phi^-1(p) for p in [0, 1]; infinite at the ends.
///
/// One Newton step on the distribution function removes the rounding of the rational approximation; in the tails
/// beyond |z| = 8 the step is left out, since there Phi itself has too few digits to improve on it.
pub fn standard_normal_quantile(p: f64) -> f64 {
    let z = -SQRT_2 * erfc_inv(2.0 * p);
    if z.abs() < 8.0 { z - (standard_normal_cdf(z) - p) / standard_normal_pdf(z) } else { z }
}

/// A truncated normal in standardised form: bounds a, b, sign-flipped when it lies in the upper tail so that
/// differences of Phi keep their digits.
struct Standardised {
    a: f64,
    b: f64,
    /// Z = Phi(b) - Phi(a).
    mass: f64,
}

impl Standardised {
    fn new(a: f64, b: f64) -> Self {
        Self { a, b, mass: interval_mass(a, b) }
    }

    /// phi at the bounds; zero at infinity.
    fn bound_densities(&self) -> (f64, f64) {
        (standard_normal_pdf(self.a), standard_normal_pdf(self.b))
    }

    /// a phi(a) and b phi(b), zero at infinity.
    fn bound_moments(&self) -> (f64, f64) {
        let moment = |z: f64| if z.is_finite() { z * standard_normal_pdf(z) } else { 0.0 };
        (moment(self.a), moment(self.b))
    }
}

/// Phi(b) - Phi(a), taken in the tail where it has most digits.
fn interval_mass(a: f64, b: f64) -> f64 {
    if a > 0.0 {
        standard_normal_cdf(-a) - standard_normal_cdf(-b)
    } else {
        standard_normal_cdf(b) - standard_normal_cdf(a)
    }
}

impl Distribution {
    fn standardised(&self) -> Standardised {
        let Distribution::TruncatedNormal { mean, std, lower, upper } = *self;
        Standardised::new((lower - mean) / std, (upper - mean) / std)
    }

    /// Mean of the parent [unit of the variable].
    pub fn parent_mean(&self) -> f64 {
        let Distribution::TruncatedNormal { mean, .. } = *self;
        mean
    }

    /// Standard deviation of the parent [unit of the variable].
    pub fn parent_std(&self) -> f64 {
        let Distribution::TruncatedNormal { std, .. } = *self;
        std
    }

    /// Density f(x) [1/unit of the variable]; zero outside the bounds.
    pub fn pdf(&self, x: f64) -> f64 {
        let Distribution::TruncatedNormal { mean, std, lower, upper } = *self;
        if x < lower || x > upper {
            return 0.0;
        }
        standard_normal_pdf((x - mean) / std) / (std * self.standardised().mass)
    }

    /// Distribution function F(x) [1].
    pub fn cdf(&self, x: f64) -> f64 {
        let Distribution::TruncatedNormal { mean, std, lower, upper } = *self;
        if x <= lower {
            return 0.0;
        }
        if x >= upper {
            return 1.0;
        }
        let s = self.standardised();
        interval_mass(s.a, (x - mean) / std) / s.mass
    }

    /// Quantile F^-1(p) for p in [0, 1] [unit of the variable], never outside the bounds.
    ///
    /// With p uniform this is sampling by inverse transform.
    pub fn quantile(&self, p: f64) -> f64 {
        let Distribution::TruncatedNormal { mean, std, lower, upper } = *self;
        let s = self.standardised();
        let z = if s.a > 0.0 {
            -standard_normal_quantile(standard_normal_cdf(-s.a) - p * s.mass)
        } else {
            standard_normal_quantile(standard_normal_cdf(s.a) + p * s.mass)
        };
        (mean + std * z).clamp(lower, upper)
    }

    /// Mean of the truncated variable: mean + std (phi(a) - phi(b)) / Z [unit of the variable].
    pub fn mean(&self) -> f64 {
        let Distribution::TruncatedNormal { mean, std, .. } = *self;
        let s = self.standardised();
        let (phi_a, phi_b) = s.bound_densities();
        mean + std * (phi_a - phi_b) / s.mass
    }

    /// Standard deviation of the truncated variable [unit of the variable]:
    /// std^2 (1 + (a phi(a) - b phi(b)) / Z - ((phi(a) - phi(b)) / Z)^2), rooted.
    pub fn std(&self) -> f64 {
        let s = self.standardised();
        let (phi_a, phi_b) = s.bound_densities();
        let (moment_a, moment_b) = s.bound_moments();
        let shift = (phi_a - phi_b) / s.mass;
        self.parent_std() * (1.0 + (moment_a - moment_b) / s.mass - shift * shift).max(0.0).sqrt()
    }

    /// Score d ln f(x) / d mean [1/unit of the variable], the bounds held fixed:
    /// z / std + (phi(b) - phi(a)) / (std Z).
    ///
    /// The bounds do not move with the parameter, although a scene may have set them at mean +- 3 std: a bound
    /// that moves would add a boundary term which a score function cannot carry, and at three standard
    /// deviations fixed bounds change the derivative by less than 3 phi(3) = 1.3 % of itself.
    pub fn score_mean(&self, x: f64) -> f64 {
        let Distribution::TruncatedNormal { mean, std, .. } = *self;
        let s = self.standardised();
        let (phi_a, phi_b) = s.bound_densities();
        ((x - mean) / std + (phi_b - phi_a) / s.mass) / std
    }

    /// Score d ln f(x) / d std [1/unit of the variable], the bounds held fixed:
    /// (z^2 - 1) / std + (b phi(b) - a phi(a)) / (std Z).
    pub fn score_std(&self, x: f64) -> f64 {
        let Distribution::TruncatedNormal { mean, std, .. } = *self;
        let s = self.standardised();
        let (moment_a, moment_b) = s.bound_moments();
        let z = (x - mean) / std;
        (z * z - 1.0 + (moment_b - moment_a) / s.mass) / std
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cases() -> [Distribution; 4] {
        let tn = |mean, std, lower, upper| Distribution::TruncatedNormal { mean, std, lower, upper };
        [
            tn(1.5, 0.2, 0.9, 2.1),
            tn(-3.0, 2.0, -4.0, 5.0),
            tn(0.0, 1.0, 4.0, 6.0),
            tn(10.0, 1.0, f64::NEG_INFINITY, 9.0),
        ]
    }

    /// Composite Simpson rule over the bounds (infinite ones cut at 12 std).
    fn integrate(d: &Distribution, h: impl Fn(f64) -> f64) -> f64 {
        let Distribution::TruncatedNormal { mean, std, lower, upper } = *d;
        let (a, b) = (lower.max(mean - 12.0 * std), upper.min(mean + 12.0 * std));
        let n = 20_000;
        let step = (b - a) / n as f64;
        let weight = |i: usize| {
            if i == 0 || i == n {
                1.0
            } else if i % 2 == 1 {
                4.0
            } else {
                2.0
            }
        };
        (0..=n).map(|i| weight(i) * h((a + step * i as f64).min(upper))).sum::<f64>() * step / 3.0
    }

    #[test]
    fn quantile_inverts_the_distribution_function() {
        for d in cases() {
            for p in [1e-9, 1e-4, 0.03, 0.25, 0.5, 0.8, 0.999, 1.0 - 1e-9] {
                let back = d.cdf(d.quantile(p));
                assert!((back - p).abs() < 1e-13 + 1e-9 * p.min(1.0 - p), "{d:?} {p} {back}");
            }
        }
    }

    #[test]
    fn quantile_stays_within_the_bounds() {
        for d in cases() {
            let Distribution::TruncatedNormal { lower, upper, .. } = d;
            for p in [0.0, f64::EPSILON, 0.5, 1.0 - f64::EPSILON, 1.0] {
                let x = d.quantile(p);
                assert!(x >= lower && x <= upper, "{d:?} {p} {x}");
            }
        }
    }

    #[test]
    fn moments_agree_with_quadrature() {
        for d in cases() {
            let mass = integrate(&d, |x| d.pdf(x));
            let mean = integrate(&d, |x| x * d.pdf(x));
            let var = integrate(&d, |x| (x - mean).powi(2) * d.pdf(x));
            assert!((mass - 1.0).abs() < 1e-8, "{d:?} {mass}");
            assert!((mean - d.mean()).abs() < 1e-8, "{d:?}");
            assert!((var.sqrt() - d.std()).abs() < 1e-7, "{d:?} {} {}", var.sqrt(), d.std());
        }
    }

    #[test]
    fn scores_are_the_derivatives_of_the_log_density() {
        for d in cases() {
            let Distribution::TruncatedNormal { mean, std, lower, upper } = d;
            let h = 1e-5 * std;
            for p in [0.1, 0.5, 0.9] {
                let x = d.quantile(p);
                let at = |mean, std| Distribution::TruncatedNormal { mean, std, lower, upper }.pdf(x).ln();
                let by_mean = (at(mean + h, std) - at(mean - h, std)) / (2.0 * h);
                let by_std = (at(mean, std + h) - at(mean, std - h)) / (2.0 * h);
                assert!((by_mean - d.score_mean(x)).abs() < 1e-5 * (1.0 / std + by_mean.abs()), "{d:?}");
                assert!((by_std - d.score_std(x)).abs() < 1e-5 * (1.0 / std + by_std.abs()), "{d:?}");
            }
        }
    }

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
