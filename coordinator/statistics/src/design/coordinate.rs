//! The coordinate of one random variable in which surrogates are fitted.
//!
//! Most variables are shifted and scaled,
//!
//!   z = (x - location) / scale,
//!
//! with location and scale of the variable. Where a positive variable scatters over a factor, responses are as a rule smooth in
//! its logarithm, and a surrogate over x itself would need lengths that grow with x:
//!
//!   z = (ln x - location) / scale,   location = ln x_50,   scale = (ln x_84 - ln x_16) / 2,
//!
//! with the quantiles x_p of the variable at the probabilities of a standard normal's median and -1 and 1. The logarithm is taken
//! from [`LEAST_SCATTER`] on.
//!
//! # Source
//! Transformation to normal scores before fitting: Box, Cox (1964), An analysis of transformations, Journal of the Royal
//! Statistical Society B 26(2); the bound is this project's own choice.

use common::random::{Distribution, standard_normal_cdf};

/// Scatter of ln x [1] from which a positive variable is seen by its logarithm: x_84 / x_16 = 1.5.
const LEAST_SCATTER: f64 = 0.2;
/// Distance [1] of a value of zero from the median, in place of minus infinity.
const ZERO: f64 = -40.0;

/// Coordinate of one variable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Coordinate {
    /// True for (ln x - location) / scale, for x > 0; false for (x - location) / scale.
    of_logarithm: bool,
    /// Location of the variable [SI], or logarithm of its median [ln of SI].
    location: f64,
    /// Scale of the variable [SI], or scatter of its logarithm [1].
    scale: f64,
}

impl Coordinate {
    /// The coordinate of a variable.
    pub fn of(variable: &Distribution) -> Self {
        let (location, scale) = (variable.parent_mean(), variable.parent_std());
        let linear = Self { of_logarithm: false, location, scale };
        if variable.is_constant() || !is_positive(variable) {
            return linear;
        }
        let [low, median, high] = [-1.0, 0.0, 1.0].map(|u| variable.quantile(standard_normal_cdf(u)).ln());
        let scale = 0.5 * (high - low);
        if scale >= LEAST_SCATTER && low.is_finite() {
            Self { of_logarithm: true, location: median, scale }
        } else {
            linear
        }
    }

    /// True if values of the variable have this coordinate: all of them are positive, or it needs no logarithm.
    pub fn fits(&self, variable: &Distribution) -> bool {
        !self.of_logarithm || is_positive(variable)
    }

    /// z [1] of the value x [SI].
    pub fn of_value(&self, x: f64) -> f64 {
        let z = |x: f64| (x - self.location) / self.scale;
        if self.of_logarithm { z(x.ln()).max(ZERO) } else { z(x) }
    }

    /// The value x [SI] at z [1].
    pub fn value(&self, z: f64) -> f64 {
        let x = self.location + self.scale * z;
        if self.of_logarithm { x.exp() } else { x }
    }
}

/// True if no value of the variable is negative.
fn is_positive(variable: &Distribution) -> bool {
    variable.support().0 >= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positive_variables_that_scatter_widely_are_seen_by_their_logarithm() {
        let of = |law: Result<Distribution, _>| Coordinate::of(&law.unwrap());
        let is_logarithm = |coordinate: Coordinate| coordinate.of_logarithm;
        assert!(is_logarithm(of(Distribution::lognormal(1000.0, 700.0))));
        assert!(is_logarithm(of(Distribution::exponential(10.0, 10.0))));
        assert!(is_logarithm(of(Distribution::weibull(3.0, 1.5))));
        for law in [
            Distribution::lognormal(2.0, 0.3),
            Distribution::normal(5.0, 4.0),
            Distribution::truncated_normal(1.0, 0.1, 0.5, 1.5),
            Distribution::constant(3.0),
            Distribution::uniform(-1.0, 5.0),
        ] {
            assert!(!is_logarithm(of(law)));
        }
        // A lognormal variable becomes standard normal.
        let (mean, std) = (1000.0, 700.0_f64);
        let sigma = (1.0 + (std / mean).powi(2)).ln().sqrt();
        let Coordinate { of_logarithm: true, location, scale } = of(Distribution::lognormal(mean, std))
        else {
            unreachable!("asserted above")
        };
        assert!((scale - sigma).abs() < 1e-9 && (location - (mean.ln() - 0.5 * sigma * sigma)).abs() < 1e-9);
    }

    #[test]
    fn values_go_there_and_back_and_zero_stays_finite() {
        for law in [Distribution::lognormal(3.0, 2.0).unwrap(), Distribution::normal(3.0, 2.0).unwrap()] {
            let coordinate = Coordinate::of(&law);
            for x in [1e-3, 0.7, 4.0, 50.0] {
                assert!((coordinate.value(coordinate.of_value(x)) / x - 1.0).abs() < 1e-12, "{x}");
            }
            assert!(coordinate.of_value(0.0).is_finite());
        }
        let wide = Coordinate::of(&Distribution::lognormal(3.0, 2.0).unwrap());
        assert!(wide.fits(&Distribution::uniform(1.0, 2.0).unwrap()));
        assert!(!wide.fits(&Distribution::normal(3.0, 0.1).unwrap()));
    }
}
