//! Learning (acquisition) functions of one candidate point, from its predicted mean and standard deviation
//! alone.
//!
//! With u = (mean - threshold) / sigma and s the predicted standard deviation sigma over the process standard
//! deviation:
//!
//! - U = |u|, smallest first; here -|u|, so that larger is better throughout.
//! - EFF, the expected feasibility with eps = 2 sigma:
//!   EFF = s {u [2 Phi(-u) - Phi(-2 - u) - Phi(2 - u)] - [2 phi(u) - phi(2 + u) - phi(2 - u)] + 2 [Phi(2 - u) - Phi(-2 - u)]}
//! - H, the information entropy within +-2 sigma of the limit, with m = u s:
//!   H = |ln(sqrt(2 pi) s + 1/2) [Phi(2 - u) - Phi(-2 - u)] - [(2 s - m) / 2 phi(2 - u) + (2 s + m) / 2 phi(-2 - u)]|
//!
//! Phi and phi are distribution function and density of the standard normal distribution. All three assume
//! that the prediction is Gaussian, and treat points one by one: neighbours are equally attractive until one
//! is believed.
//!
//! # Source
//! U: Echard, Gayton, Lemaire (2011), AK-MCS, Structural Safety 33(2). EFF: Bichon et al. (2008), Efficient
//! global reliability analysis for nonlinear implicit performance functions, AIAA Journal 46(10). H: Lv, Lu,
//! Wang (2015), A new learning function for Kriging and its applications to solve reliability problems in
//! engineering, Computers & Mathematics with Applications 70(5).

use crate::statistics::named::named;
use common::random::{standard_normal_cdf, standard_normal_pdf};

/// Learning function by which the next samples are chosen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum LearningFunction {
    /// Alternately the largest expected reduction of the variance near the limit and the largest risk of a
    /// wrong classification, see [`super::Selection`].
    #[default]
    Gain,
    /// U, smallest |mean - threshold| / sigma.
    U,
    /// EFF, largest expected feasibility.
    Eff,
    /// H, largest information entropy.
    H,
}

named!(LearningFunction { Gain = "gain", U = "u", Eff = "eff", H = "h" });

impl LearningFunction {
    /// Score [1] of a point at the distance `u` [predicted standard deviations] with the standard deviation
    /// `s` [process standard deviations]. Points of larger score come first; a score of zero or less, except
    /// that of U, excludes a point. A known point (s = 0) scores minus infinity. `None` for
    /// [`LearningFunction::Gain`], which needs the joint posterior of all points.
    pub fn score(self, u: f64, s: f64) -> Option<f64> {
        if s <= 0.0 {
            return (self != Self::Gain).then_some(f64::NEG_INFINITY);
        }
        let (phi, cdf) = (standard_normal_pdf, standard_normal_cdf);
        // Phi(2 - u) - Phi(-2 - u), taken in the tail that keeps its digits.
        let within = if u > 0.0 { cdf(2.0 - u) - cdf(-2.0 - u) } else { cdf(2.0 + u) - cdf(-2.0 + u) };
        match self {
            Self::Gain => None,
            Self::U => Some(-u.abs()),
            Self::Eff => {
                let u = u.abs();
                let first = u * (2.0 * cdf(-u) - cdf(-2.0 - u) - cdf(2.0 - u));
                let second = 2.0 * phi(u) - phi(2.0 + u) - phi(2.0 - u);
                Some(s * (first - second + 2.0 * within))
            }
            Self::H => {
                let m = u * s;
                let log = ((2.0 * std::f64::consts::PI).sqrt() * s + 0.5).ln();
                let ends = (2.0 * s - m) / 2.0 * phi(2.0 - u) + (2.0 * s + m) / 2.0 * phi(-2.0 - u);
                Some((log * within - ends).abs())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Integral of f over the normal density at (u s, s) within +-2 s of the limit, by Simpson's rule.
    fn expected(u: f64, s: f64, f: impl Fn(f64, f64) -> f64) -> f64 {
        let n = 4000;
        let h = 4.0 * s / n as f64;
        let weighted = |i: usize| {
            let g = -2.0 * s + h * i as f64;
            let density = standard_normal_pdf((g - u * s) / s) / s;
            let weight = if i == 0 || i == n { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 };
            weight * f(g, density)
        };
        (0..=n).map(weighted).sum::<f64>() * h / 3.0
    }

    #[test]
    fn expected_feasibility_is_its_integral() {
        for (u, s) in [(0.0, 1.0), (0.7, 0.3), (-1.6, 2.0), (3.1, 0.5), (-6.0, 1.0)] {
            let integral = expected(u, s, |g, density| (2.0 * s - g.abs()) * density);
            let value = LearningFunction::Eff.score(u, s).unwrap();
            assert!((value - integral).abs() < 1e-10 * s, "{u} {s}: {value} {integral}");
        }
    }

    #[test]
    fn entropy_is_largest_on_the_limit_and_grows_with_the_standard_deviation() {
        let h = |u, s| LearningFunction::H.score(u, s).unwrap();
        assert!(h(0.0, 1.0) > h(1.0, 1.0) && h(1.0, 1.0) > h(3.0, 1.0));
        assert!(h(0.0, 2.0) > h(0.0, 1.0));
        // On the limit, in closed form: |ln(sqrt(2 pi) s + 1/2) (2 Phi(2) - 1) - 2 s phi(2)|.
        let closed = ((2.0 * std::f64::consts::PI).sqrt() + 0.5).ln()
            * (2.0 * standard_normal_cdf(2.0) - 1.0)
            - 2.0 * standard_normal_pdf(2.0);
        assert!((h(0.0, 1.0) - closed).abs() < 1e-12);
    }

    #[test]
    fn a_known_point_scores_minus_infinity() {
        for function in [LearningFunction::U, LearningFunction::Eff, LearningFunction::H] {
            assert_eq!(function.score(0.0, 0.0), Some(f64::NEG_INFINITY));
        }
        assert_eq!(LearningFunction::U.score(-1.5, 0.1), Some(-1.5));
        assert_eq!(LearningFunction::Gain.score(0.0, 0.0), None);
    }
}
