//! The beta distribution between two bounds.
//!
//! | | |
//! |---|---|
//! | parameters | lower < mean < upper and std, in the unit of the variable: the moments and the bounds |
//! | support | [lower, upper] |
//! | standardised | y = (x - lower) / (upper - lower), with mean m and variance v |
//! | density | f(x) = y^(alpha - 1) (1 - y)^(beta - 1) / (B(alpha, beta) (upper - lower)) |
//! | distribution function | F(x) = I_y(alpha, beta), the regularised incomplete beta function |
//! | shape parameters | alpha = m nu, beta = (1 - m) nu, nu = m (1 - m) / v - 1 [1] |
//! | limits | 0.05 < alpha, beta < 10000 |
//!
//! Mean and standard deviation change at fixed bounds.
//!
//! # Source
//! Johnson, Kotz, Balakrishnan (1995), Continuous Univariate Distributions, vol. 2, chapter 25.

use super::law::{Law, LawError, between, chain};
use crate::random::standard::Tail;
use serde::{Deserialize, Serialize};
use statrs::function::beta::beta_reg;
use statrs::function::gamma::digamma;

/// Largest alpha and beta: beyond, the continued fraction of the distribution function is too long, and the bounds of
/// so narrow a distribution have no effect.
const LARGEST: f64 = 1e4;
/// Smallest alpha and beta: below, almost all samples equal one of the bounds.
const SMALLEST: f64 = 0.05;
/// Relative step of the central difference for the derivatives of the distribution function; truncation and rounding
/// are both about 1e-10 of it.
const STEP: f64 = 1e-5;

/// Beta distribution between two bounds with a mean and a standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Beta {
    mean: f64,
    std: f64,
    lower: f64,
    upper: f64,
    alpha: f64,
    beta: f64,
}

impl Beta {
    pub(super) fn new(mean: f64, std: f64, lower: f64, upper: f64) -> Result<Self, LawError> {
        let lower = between("lower", lower, f64::NEG_INFINITY, f64::INFINITY)?;
        let upper = between("upper", upper, lower, f64::INFINITY)?;
        if !(lower < mean && mean < upper) {
            return Err(LawError::NotEnclosed { parameter: "mean", value: mean, lower, upper });
        }
        let width = upper - lower;
        let m = (mean - lower) / width;
        // std at which the smaller of alpha and beta is the smallest allowed, the larger the largest.
        let (small, large) = (m.min(1.0 - m), m.max(1.0 - m));
        let std_of_nu = |nu: f64| width * (m * (1.0 - m) / (nu + 1.0)).sqrt();
        let std = between("std", std, std_of_nu(LARGEST / large), std_of_nu(SMALLEST / small))?;
        let s = std / width;
        let nu = m * (1.0 - m) / (s * s) - 1.0;
        Ok(Self { mean, std, lower, upper, alpha: m * nu, beta: (1.0 - m) * nu })
    }

    fn width(&self) -> f64 {
        self.upper - self.lower
    }

    /// y and 1 - y [1], each computed from its own bound so that neither loses digits.
    fn y(&self, x: f64) -> (f64, f64) {
        let width = self.width();
        (((x - self.lower) / width).clamp(0.0, 1.0), ((self.upper - x) / width).clamp(0.0, 1.0))
    }

    /// x [unit of the variable] for y and 1 - y = `rest` [1], measured from the nearer bound.
    fn place(&self, [y, rest]: [f64; 2]) -> f64 {
        let width = self.width();
        let x = if y <= 0.5 { self.lower + width * y } else { self.upper - width * rest };
        x.clamp(self.lower, self.upper)
    }

    /// Rows d alpha and d beta, each by mean and std `(2, 2)`.
    fn own(&self) -> [[f64; 2]; 2] {
        let (width, nu) = (self.width(), self.alpha + self.beta);
        let m = self.alpha / nu;
        let s = self.std / width;
        let nu_by = [(1.0 - 2.0 * m) / (s * s * width), -2.0 * (nu + 1.0) / self.std];
        [
            [nu / width + m * nu_by[0], m * nu_by[1]],
            [-nu / width + (1.0 - m) * nu_by[0], (1.0 - m) * nu_by[1]],
        ]
    }
}

/// The y with I_y(a, b) = p <= 1/2, and 1 - y [1].
///
/// Newton's method on ln I over t = ln(y / (1 - y)): the density y^a (1 - y)^b of t is log-concave, hence ln I is
/// concave in t, and from any start every iterate but the first lies below the root and rises to it.
fn inverse(a: f64, b: f64, p: f64) -> (f64, f64) {
    let ln_b = libm::lgamma(a) + libm::lgamma(b) - libm::lgamma(a + b);
    let ln_p = libm::log(p);
    // I_y is y^a / (a B) near zero; no further up than the mean.
    let mut t = ((ln_p + libm::log(a) + ln_b) / a).min(libm::log(a / b));
    let mut best = f64::INFINITY;
    for _ in 0..200 {
        let (y, rest) = logistic(t);
        let below = if t < -600.0 { 0.0 } else { beta_reg(a, b, y) };
        // ln of the density of t; over a, the first term of the series of I, which will do where I underflows.
        let ln_density = a * log_logistic(t) + b * log_logistic(-t) - ln_b;
        let ln_below = if below > 0.0 { libm::log(below) } else { ln_density - libm::log(a) };
        let slope = libm::exp(ln_density - ln_below);
        let step = (ln_p - ln_below) / slope;
        // Ends when a step no longer is smaller than the one before: nothing but rounding is left.
        if step == 0.0 || (step.abs() >= best && best < 1e-6) {
            return (y, rest);
        }
        best = step.abs();
        t += step;
    }
    logistic(t)
}

/// 1 / (1 + exp(-t)) and 1 / (1 + exp(t)).
fn logistic(t: f64) -> (f64, f64) {
    (1.0 / (1.0 + libm::exp(-t)), 1.0 / (1.0 + libm::exp(t)))
}

fn log_logistic(t: f64) -> f64 {
    if t < 0.0 { t - libm::log1p(libm::exp(t)) } else { -libm::log1p(libm::exp(-t)) }
}

impl Law for Beta {
    fn pdf(&self, x: f64) -> f64 {
        if x < self.lower || x > self.upper {
            return 0.0;
        }
        let (a, b) = (self.alpha, self.beta);
        let (y, rest) = self.y(x);
        let ln_b = libm::lgamma(a) + libm::lgamma(b) - libm::lgamma(a + b);
        let power = |y: f64, n: f64| if n == 0.0 { 0.0 } else { n * libm::log(y) };
        libm::exp(power(y, a - 1.0) + power(rest, b - 1.0) - ln_b) / self.width()
    }

    fn probability(&self, x: f64, tail: Tail) -> f64 {
        let (y, rest) = self.y(x);
        match tail {
            Tail::Lower => beta_reg(self.alpha, self.beta, y),
            Tail::Upper => beta_reg(self.beta, self.alpha, rest),
        }
    }

    fn at(&self, p: f64, tail: Tail) -> f64 {
        if p > 0.5 {
            return self.at(1.0 - p, tail.other());
        }
        match tail {
            Tail::Lower if p <= 0.0 => self.lower,
            Tail::Upper if p <= 0.0 => self.upper,
            Tail::Lower => self.place(inverse(self.alpha, self.beta, p).into()),
            Tail::Upper => {
                let (rest, y) = inverse(self.beta, self.alpha, p);
                self.place([y, rest])
            }
        }
    }

    fn mean_and_std(&self) -> (f64, f64) {
        (self.mean, self.std)
    }

    fn support(&self) -> (f64, f64) {
        (self.lower, self.upper)
    }

    fn scores(&self, x: f64) -> [f64; 2] {
        let (a, b) = (self.alpha, self.beta);
        let (y, rest) = self.y(x);
        let both = digamma(a + b);
        let log = |y: f64| libm::log(y.max(f64::MIN_POSITIVE));
        chain([log(y) - digamma(a) + both, log(rest) - digamma(b) + both], self.own())
    }

    fn cdf_derivatives(&self, x: f64) -> [f64; 2] {
        let (a, b) = (self.alpha, self.beta);
        let (y, rest) = self.y(x);
        // The smaller tail, which keeps its digits.
        let lower_tail = y <= a / (a + b);
        let tail = |a: f64, b: f64| if lower_tail { beta_reg(a, b, y) } else { -beta_reg(b, a, rest) };
        let by = |h: f64, tail: &dyn Fn(f64) -> f64| (tail(h) - tail(-h)) / (2.0 * h);
        let by_alpha = by(STEP * a, &|h| tail(a + h, b));
        let by_beta = by(STEP * b, &|h| tail(a, b + h));
        chain([by_alpha, by_beta], self.own())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_forms() {
        // alpha = beta = 1 is uniform; alpha = 2, beta = 1 has F = y^2; alpha = beta = 1/2 is the arcsine law.
        let uniform = Beta::new(0.5, (1.0_f64 / 12.0).sqrt(), 0.0, 1.0).unwrap();
        assert!((uniform.alpha - 1.0).abs() < 1e-12 && (uniform.beta - 1.0).abs() < 1e-12);
        let rising = Beta::new(2.0 / 3.0, (1.0_f64 / 18.0).sqrt(), 0.0, 1.0).unwrap();
        let arcsine = Beta::new(0.5, 0.125_f64.sqrt(), 0.0, 1.0).unwrap();
        for p in [1e-9_f64, 1e-3, 0.2, 0.5, 0.9] {
            assert!((uniform.quantile(p) / p - 1.0).abs() < 1e-10, "{p} {}", uniform.quantile(p));
            assert!((rising.quantile(p) / p.sqrt() - 1.0).abs() < 1e-10, "{p} {}", rising.quantile(p));
            let exact = (std::f64::consts::FRAC_PI_2 * p).sin().powi(2);
            assert!((arcsine.quantile(p) / exact - 1.0).abs() < 1e-10, "{p} {}", arcsine.quantile(p));
        }
    }

    #[test]
    fn the_widest_and_the_narrowest() {
        for (mean, width) in [(0.3, 1.0), (0.05, 1.0), (0.98, 1.0)] {
            let refused = Beta::new(mean, 10.0, 0.0, width).unwrap_err();
            let LawError::OutOfRange { above, below, .. } = refused else { panic!("{refused:?}") };
            for std in [above * 1.001, below * 0.999] {
                let law = Beta::new(mean, std, 0.0, width).unwrap();
                for p in [1e-9, 1e-3, 0.3, 0.5] {
                    // What one rounding of x is worth in probability; all of it where x falls on the bound itself.
                    let rounding = |x: f64| 4.0 * f64::EPSILON * x * law.pdf(x);
                    let (low, high) = (law.quantile(p), law.upper_quantile(p));
                    assert!((law.cdf(low) - p).abs() <= 1e-8 * p + rounding(low), "{law:?} {p}");
                    let off = (law.survival(high) - p).abs();
                    assert!(off <= 1e-8 * p + rounding(high), "{law:?} {p} {off}");
                }
            }
        }
    }
}
