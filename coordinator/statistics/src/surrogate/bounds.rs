//! Bounded parameters of a correlation as free numbers: each logarithm p in [low, high] is written as
//!
//!   p = low + (high - low) / (1 + exp(-t)),   dp/dt = (high - low) s (1 - s),  s = 1 / (1 + exp(-t)),
//!
//! and the free number t is optimised. No projection is needed, and the parameter of a variable without
//! influence drifts to its lower bound, where the likelihood is flat.
//!
//! # Source
//! The logistic transformation of a bounded parameter; bounds on standardised inputs are this project's own
//! choice.

use super::{Correlation, Kernel};

/// Bounds of theta in standardised inputs [1]: lengths from 0.2 to 700 standard deviations.
pub(super) const THETA: (f64, f64) = (1e-6, 10.0);
/// Bounds of the nugget [1]. Below 1e-10 a Gaussian correlation matrix of a few hundred points loses its
/// Cholesky factor to rounding; above 0.3 the noise would have half the standard deviation of the output.
pub(super) const NUGGET: (f64, f64) = (1e-10, 0.3);

/// Bounds of every parameter of a correlation in d variables.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    kernel: Kernel,
    d: usize,
    /// Bounds of the level of the noise in proportion to stated errors [1]; `None` without such errors.
    stated: Option<(f64, f64)>,
    /// Bounds of the nugget [1].
    nugget: (f64, f64),
}

impl Bounds {
    /// Bounds in `d` variables; `stated` are those of the level of the stated noise, if the points have such
    /// noise. For `exact` values, without noise, the nugget is held at its lower bound, against round-off.
    pub fn new(kernel: Kernel, d: usize, stated: Option<(f64, f64)>, exact: bool) -> Self {
        Self { kernel, d, stated, nugget: if exact { (NUGGET.0, NUGGET.0) } else { NUGGET } }
    }

    /// Logarithmic bounds of parameter `k`: d lengths, the nugget, and the level of the stated noise if there
    /// is one.
    fn logarithms(&self, k: usize) -> (f64, f64) {
        let (low, high) = match k.checked_sub(self.d) {
            None => THETA,
            Some(0) => self.nugget,
            Some(_) => self.stated.unwrap_or(NUGGET),
        };
        (low.ln(), high.ln())
    }

    /// The correlation of free parameters `(d + 1,)` or `(d + 2,)`.
    pub fn correlation(&self, free: &[f64]) -> Correlation {
        let value = |k: usize| {
            let (low, high) = self.logarithms(k);
            (low + (high - low) / (1.0 + (-free[k]).exp())).exp()
        };
        Correlation {
            kernel: self.kernel,
            theta: (0..self.d).map(value).collect(),
            nugget: value(self.d),
            stated: self.stated.map_or(0.0, |_| value(self.d + 1)),
        }
    }

    /// A cautious correlation (long lengths, some noise), for data whose likelihood cannot be evaluated.
    pub fn cautious(&self) -> Correlation {
        let theta = vec![0.1 / self.d as f64; self.d];
        Correlation { kernel: self.kernel, theta, nugget: 1e-4, stated: 0.0 }
    }

    /// dp/dt of the bounded logarithm `k` at the free number `t`.
    pub fn slope(&self, k: usize, t: f64) -> f64 {
        let (low, high) = self.logarithms(k);
        let s = 1.0 / (1.0 + (-t).exp());
        (high - low) * s * (1.0 - s)
    }

    /// Inverse of [`Bounds::correlation`]; parameters at a bound are moved inside by 2 %, so that the slope
    /// never vanishes.
    pub fn free(&self, correlation: &Correlation) -> Vec<f64> {
        let level = self.stated.map(|_| correlation.stated);
        let all = correlation.theta.iter().copied().chain([correlation.nugget]).chain(level);
        let free = |(k, value): (usize, f64)| {
            let (low, high) = self.logarithms(k);
            // A held parameter has an interval of no width, which any free number represents.
            let share = if high > low { (value.ln() - low) / (high - low) } else { 0.5 };
            let s = share.clamp(0.02, 0.98);
            (s / (1.0 - s)).ln()
        };
        all.enumerate().map(free).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn free_numbers_give_the_correlation_and_back() {
        let correlation =
            Correlation { kernel: Kernel::Matern32, theta: vec![0.3, 2e-3], nugget: 1e-5, stated: 0.02 };
        let bounds = Bounds::new(Kernel::Matern32, 2, Some((1e-10, 0.3)), false);
        let back = bounds.correlation(&bounds.free(&correlation));
        for (a, b) in [(back.theta[1], 2e-3), (back.nugget, 1e-5), (back.stated, 0.02)] {
            assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
        }
        // Held at 0.7, and without stated errors.
        let held = Bounds::new(Kernel::Matern32, 2, Some((0.7, 0.7)), false);
        assert!((held.correlation(&held.free(&correlation)).stated - 0.7).abs() < 1e-15);
        assert_eq!(held.slope(3, 1.0), 0.0);
        let none = Bounds::new(Kernel::Matern32, 2, None, false);
        assert_eq!((none.free(&correlation).len(), none.correlation(&[0.0; 3]).stated), (3, 0.0));
    }
}
