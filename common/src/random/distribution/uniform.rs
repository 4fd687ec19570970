//! The uniform and the triangular distribution between two bounds.

use super::law::{Law, LawError, between, moments, tilted};
use crate::random::standard::Tail;
use serde::{Deserialize, Serialize};

/// E[t^4] of the standardised uniform variable.
const UNIFORM_KURTOSIS: f64 = 1.8;

/// Uniform distribution between two bounds.
///
/// | | |
/// |---|---|
/// | parameters | lower < upper, in the unit of the variable |
/// | support | [lower, upper] |
/// | density | f(x) = 1 / (upper - lower) |
/// | distribution function | F(x) = (x - lower) / (upper - lower) |
/// | mean, variance | (lower + upper) / 2, (upper - lower)^2 / 12; E[t^4] = 9/5 of the standardised t |
///
/// Its scores hold the bounds fixed: see `law::tilted`.
///
/// # Source
/// Johnson, Kotz, Balakrishnan (1995), Continuous Univariate Distributions, vol. 2, chapter 26.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Uniform {
    lower: f64,
    upper: f64,
}

impl Uniform {
    pub(super) fn new(lower: f64, upper: f64) -> Result<Self, LawError> {
        let lower = between("lower", lower, f64::NEG_INFINITY, f64::INFINITY)?;
        Ok(Self { lower, upper: between("upper", upper, lower, f64::INFINITY)? })
    }

    /// The one with bounds at mean -+ sqrt(3) std.
    pub(super) fn by_moments(mean: f64, std: f64) -> Result<Self, LawError> {
        let (mean, std) = moments(mean, std)?;
        let half = 3.0_f64.sqrt() * std;
        Self::new(mean - half, mean + half)
    }

    fn width(&self) -> f64 {
        self.upper - self.lower
    }

    /// t = (x - mean) / std [1].
    fn t(&self, x: f64) -> f64 {
        (x - self.mean()) / self.std()
    }
}

impl Law for Uniform {
    fn pdf(&self, x: f64) -> f64 {
        if x < self.lower || x > self.upper { 0.0 } else { 1.0 / self.width() }
    }

    fn probability(&self, x: f64, tail: Tail) -> f64 {
        let part = if tail == Tail::Lower { x - self.lower } else { self.upper - x };
        (part / self.width()).clamp(0.0, 1.0)
    }

    fn at(&self, p: f64, tail: Tail) -> f64 {
        match tail {
            Tail::Lower => (self.lower + p * self.width()).min(self.upper),
            Tail::Upper => (self.upper - p * self.width()).max(self.lower),
        }
    }

    fn mean_and_std(&self) -> (f64, f64) {
        (self.lower + 0.5 * self.width(), self.width() / 12.0_f64.sqrt())
    }

    fn support(&self) -> (f64, f64) {
        (self.lower, self.upper)
    }

    fn scores(&self, x: f64) -> [f64; 2] {
        let t = self.t(x);
        tilted(t, t * t - 1.0, self.std(), 0.0, UNIFORM_KURTOSIS)
    }

    fn cdf_derivatives(&self, x: f64) -> [f64; 2] {
        let root = 3.0_f64.sqrt();
        let t = self.t(x).clamp(-root, root);
        // Integrals of t and t^2 - 1 over the density 1 / (2 sqrt(3)) from -sqrt(3) to t.
        let (linear, quadratic) = (0.5 * (t * t - 3.0), t * (t * t / 3.0 - 1.0));
        tilted(linear / (2.0 * root), quadratic / (2.0 * root), self.std(), 0.0, UNIFORM_KURTOSIS)
    }
}

/// E[t^4] of the standardised triangular variable.
const TRIANGULAR_KURTOSIS: f64 = 2.4;

/// Triangular distribution between two bounds: a density that rises linearly to the mode and falls linearly from it.
///
/// | | |
/// |---|---|
/// | parameters | a = lower <= c = mode <= b = upper, a < b, in the unit of the variable |
/// | support | [a, b] |
/// | density | f(x) = 2 (x - a) / ((b - a) (c - a)) for x <= c, 2 (b - x) / ((b - a) (b - c)) for x >= c |
/// | distribution function | (x - a)^2 / ((b - a) (c - a)) for x <= c, 1 - (b - x)^2 / ((b - a) (b - c)) for x >= c |
/// | mean, variance | (a + b + c) / 3, (a^2 + b^2 + c^2 - a b - a c - b c) / 18; E[t^4] = 12/5 of the standardised t |
///
/// Its scores hold the bounds fixed: see `law::tilted`.
///
/// # Source
/// Kotz, van Dorp (2004), Beyond Beta: Other Continuous Families of Distributions with Bounded Support and
/// Applications, chapter 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Triangular {
    lower: f64,
    /// The likeliest value [unit of the variable].
    pub(super) mode: f64,
    upper: f64,
}

impl Triangular {
    pub(super) fn new(lower: f64, mode: f64, upper: f64) -> Result<Self, LawError> {
        let lower = between("lower", lower, f64::NEG_INFINITY, f64::INFINITY)?;
        let upper = between("upper", upper, lower, f64::INFINITY)?;
        if !(lower..=upper).contains(&mode) {
            return Err(LawError::NotEnclosed { parameter: "mode", value: mode, lower, upper });
        }
        Ok(Self { lower, mode, upper })
    }

    /// Lengths of the rising part, the falling part and both [unit of the variable].
    fn parts(&self) -> (f64, f64, f64) {
        (self.mode - self.lower, self.upper - self.mode, self.upper - self.lower)
    }

    /// Skewness E[t^3] [1], with r the length of the rising and l that of the falling part of the density:
    /// sqrt(2) (l - r) (2 r + l) (r + 2 l) / (5 (r^2 + r l + l^2)^(3/2)).
    fn skewness(&self) -> f64 {
        let (r, l, _) = self.parts();
        let spread = r * r + r * l + l * l;
        2.0_f64.sqrt() * (l - r) * (2.0 * r + l) * (r + 2.0 * l) / (5.0 * spread * spread.sqrt())
    }
}

impl Law for Triangular {
    fn pdf(&self, x: f64) -> f64 {
        let (r, l, both) = self.parts();
        if x < self.lower || x > self.upper {
            0.0
        } else if x < self.mode {
            2.0 * (x - self.lower) / (both * r)
        } else if l > 0.0 {
            2.0 * (self.upper - x) / (both * l)
        } else {
            2.0 / both
        }
    }

    fn probability(&self, x: f64, tail: Tail) -> f64 {
        let (r, l, both) = self.parts();
        // Of the tail on this side of the mode, which is a triangle.
        let (nearer, w, part) = if x < self.mode {
            (Tail::Lower, (x - self.lower).max(0.0), r)
        } else {
            (Tail::Upper, (self.upper - x).max(0.0), l)
        };
        let triangle = if part > 0.0 { w * w / (both * part) } else { 0.0 };
        if tail == nearer { triangle } else { 1.0 - triangle }
    }

    fn at(&self, p: f64, tail: Tail) -> f64 {
        let (r, l, both) = self.parts();
        let part = if tail == Tail::Lower { r } else { l };
        // Measured from the bound on whose side of the mode the value lies.
        let (p, tail) = if p * both <= part { (p, tail) } else { (1.0 - p, tail.other()) };
        match tail {
            Tail::Lower => (self.lower + (p * both * r).max(0.0).sqrt()).min(self.mode),
            Tail::Upper => (self.upper - (p * both * l).max(0.0).sqrt()).max(self.mode),
        }
    }

    fn mean_and_std(&self) -> (f64, f64) {
        let (r, l, both) = self.parts();
        (self.lower + (r + both) / 3.0, ((r * r + r * l + l * l) / 18.0).sqrt())
    }

    fn support(&self) -> (f64, f64) {
        (self.lower, self.upper)
    }

    fn scores(&self, x: f64) -> [f64; 2] {
        let t = (x - self.mean()) / self.std();
        tilted(t, t * t - 1.0, self.std(), self.skewness(), TRIANGULAR_KURTOSIS)
    }

    fn cdf_derivatives(&self, x: f64) -> [f64; 2] {
        let (r, l, both) = self.parts();
        let std = self.std();
        // Integrals of t f and (t^2 - 1) f over the distance w from the nearer end, where t = from + towards w.
        let integrals = |w: f64, part: f64, from: f64, towards: f64| {
            let density = if part > 0.0 { 2.0 / (both * part) } else { 0.0 };
            let (w2, w3) = (w * w / 2.0, w * w * w / 3.0);
            let linear = density * (from * w2 + towards * w3);
            let w4 = towards * towards * w * w * w * w / 4.0;
            let quadratic = density * ((from * from - 1.0) * w2 + 2.0 * from * towards * w3 + w4);
            (linear, quadratic)
        };
        let (linear, quadratic) = if x < self.mode {
            let w = (x - self.lower).max(0.0);
            integrals(w, r, (self.lower - self.mean()) / std, 1.0 / std)
        } else {
            // Over the whole support both integrals vanish.
            let w = (self.upper - x).max(0.0);
            let (linear, quadratic) = integrals(w, l, (self.upper - self.mean()) / std, -1.0 / std);
            (-linear, -quadratic)
        };
        tilted(linear, quadratic, std, self.skewness(), TRIANGULAR_KURTOSIS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_moments() {
        // On [0, 1] with mode 0: mean 1/3, variance 1/18, skewness 2 sqrt(2) / 5.
        let falling = Triangular::new(0.0, 0.0, 1.0).unwrap();
        assert!((falling.mean() - 1.0 / 3.0).abs() < 1e-15);
        assert!((falling.std() - (1.0_f64 / 18.0).sqrt()).abs() < 1e-15);
        assert!((falling.skewness() - 2.0 * 2.0_f64.sqrt() / 5.0).abs() < 1e-14);
        let even = Triangular::new(-1.0, 0.0, 1.0).unwrap();
        assert!(even.skewness().abs() < 1e-15 && (even.std() - (1.0_f64 / 6.0).sqrt()).abs() < 1e-15);
        let rising = Triangular::new(0.0, 1.0, 1.0).unwrap();
        assert!((rising.skewness() + falling.skewness()).abs() < 1e-14);
        assert_eq!((rising.pdf(1.0), rising.quantile(0.25), rising.survival(1.0)), (2.0, 0.5, 0.0));
    }
}
