//! The triangular distribution: a density that rises linearly to the mode and falls linearly from it.
//!
//! | | |
//! |---|---|
//! | parameters | a = lower <= c = mode <= b = upper, a < b, in the unit of the variable |
//! | support | [a, b] |
//! | density | f(x) = 2 (x - a) / ((b - a) (c - a)) for x <= c, 2 (b - x) / ((b - a) (b - c)) for x >= c |
//! | distribution function | (x - a)^2 / ((b - a) (c - a)) for x <= c, 1 - (b - x)^2 / ((b - a) (b - c)) for x >= c |
//! | mean, variance | (a + b + c) / 3, (a^2 + b^2 + c^2 - a b - a c - b c) / 18; E[t^4] = 12/5 of the standardised t |
//!
//! Its scores hold the bounds fixed: see `law::tilted`.
//!
//! # Source
//! Kotz, van Dorp (2004), Beyond Beta: Other Continuous Families of Distributions with Bounded Support and
//! Applications, chapter 1.

use super::law::{Law, LawError, between, tilted};
use crate::random::standard::Tail;
use serde::{Deserialize, Serialize};

/// E[t^4] of the standardised variable.
const KURTOSIS: f64 = 2.4;

/// Triangular distribution between two bounds with a mode.
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
        tilted(t, t * t - 1.0, self.std(), self.skewness(), KURTOSIS)
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
        tilted(linear, quadratic, std, self.skewness(), KURTOSIS)
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
