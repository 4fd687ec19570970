//! The scale in which a response is learned: its values, or their logarithms.
//!
//! Wear is a product of a wear coefficient, loads and paths (Archard's law), and where these scatter widely neither a stationary
//! correlation nor a linear trend fits it. The logarithm of a product of powers is linear in the logarithms of its factors. So
//! logarithms are learned where all values are positive, their logarithms scatter by [`LEAST_SCATTER`] or more, and the values left out of the fit are clearly more
//! probable by the surrogate of the logarithms, whose density of a value y is
//!
//!   ln p(y) = ln N(ln y; mean, variance) - ln y.
//!
//! # Source
//! Snelson, Rasmussen, Ghahramani (2003), Warped Gaussian processes, Advances in Neural Information Processing Systems 16; Box, Cox
//! (1964), An analysis of transformations, Journal of the Royal Statistical Society B 26.

use super::Chosen;
use super::choice::clearly_denser;
use super::leave_one_out::spread;
use faer::{Mat, MatRef};

/// Standard deviation of the logarithms from which on they are considered [1], as for the variables.
const LEAST_SCATTER: f64 = 0.2;

/// Scale in which a response is learned.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ResponseScale {
    /// The values themselves.
    #[default]
    Values,
    /// The natural logarithms of values in the unit of the output.
    Logarithms,
}

impl ResponseScale {
    /// The other one.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Values => Self::Logarithms,
            Self::Logarithms => Self::Values,
        }
    }

    /// The number that is learned of a value [unit of the output]; minus infinity for the logarithm of one that is not positive.
    pub fn learned(self, value: f64) -> f64 {
        match self {
            Self::Values => value,
            Self::Logarithms => value.max(0.0).ln(),
        }
    }

    /// The value [unit of the output] of a learned number.
    pub fn value(self, learned: f64) -> f64 {
        match self {
            Self::Values => learned,
            Self::Logarithms => learned.exp(),
        }
    }

    /// What a small change of the learned number changes its `value` by [unit of the output], over that change.
    pub fn slope(self, value: f64) -> f64 {
        match self {
            Self::Values => 1.0,
            Self::Logarithms => value,
        }
    }

    /// The numbers that are learned of these values `(n, m)` [unit of the output].
    pub fn learned_values(self, values: &Mat<f64>) -> Mat<f64> {
        Mat::from_fn(values.nrows(), values.ncols(), |i, o| self.learned(values[(i, o)]))
    }

    /// True if values `(n, m)` [unit of the output] can be learned in this scale.
    pub fn allows(self, values: MatRef<'_, f64>) -> bool {
        let is_possible = |y: &f64| *y > 0.0 || self == Self::Values;
        values.col_iter().all(|column| column.iter().all(is_possible))
    }

    /// True if positive values `(n, m)` [unit of the output] scatter so much that their logarithms are to be compared with them.
    pub fn is_wide(values: MatRef<'_, f64>) -> bool {
        let logarithms = Self::Logarithms.learned_values(&values.to_owned());
        logarithms.col_iter().any(|column| spread(column).sqrt() >= LEAST_SCATTER)
    }

    /// True if the surrogate `other` of the other scale makes these values `(n, m)` [unit of the output] clearly more probable than
    /// `standing`, that of this one.
    pub fn is_surpassed(self, values: MatRef<'_, f64>, standing: &Chosen, other: &Chosen) -> bool {
        let logarithms = Self::Logarithms.learned_values(&values.to_owned());
        let columns: Vec<usize> = (0..values.ncols()).filter(|o| spread(values.col(*o)) > 0.0).collect();
        // Densities of logarithms, in units of their standard deviation, as those of values in units of theirs.
        let by_value = |i: usize| {
            let of = |o: &usize| {
                0.5 * (spread(values.col(*o)) / spread(logarithms.col(*o))).ln() - logarithms[(i, *o)]
            };
            columns.iter().map(of).sum::<f64>() / columns.len() as f64
        };
        let sign = if self == Self::Values { 1.0 } else { -1.0 };
        let shifts: Vec<f64> = (0..values.nrows()).map(|i| sign * by_value(i)).collect();
        clearly_denser(standing, other, &shifts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surrogate::{Effort, FormSettings, TrainingSet, fit_surrogate};

    /// True if the other scale is clearly better for a response of three variables, starting from `standing`.
    fn is_surpassed(standing: ResponseScale, response: impl Fn([f64; 3]) -> f64) -> bool {
        let x = Mat::from_fn(3, 40, |k, i| {
            4.0 * ((i + 1) as f64 * [0.819_172_513, 0.671_043_607, 0.549_700_478][k]).fract() - 2.0
        });
        let values = Mat::from_fn(40, 2, |i, o| (1 + o) as f64 * response([0, 1, 2].map(|k| x[(k, i)])));
        assert!(ResponseScale::Logarithms.allows(values.as_ref()) && ResponseScale::is_wide(values.as_ref()));
        let fit = |scale: ResponseScale| {
            let learned = scale.learned_values(&values);
            let training =
                TrainingSet { points: x.as_ref(), values: learned.as_ref(), noise: None, is_exact: false };
            fit_surrogate(training, FormSettings::default(), None, Effort::MultiStart).unwrap()
        };
        standing.is_surpassed(values.as_ref(), &fit(standing), &fit(standing.other()))
    }

    #[test]
    fn products_take_logarithms_and_sums_take_values() {
        let product = |[a, b, c]: [f64; 3]| (0.6 * a - 0.4 * b + 0.3 * c).exp();
        let sum = |[a, b, c]: [f64; 3]| 6.0 + a + 0.8 * b - 0.5 * c;
        assert!(is_surpassed(ResponseScale::Values, product));
        assert!(!is_surpassed(ResponseScale::Logarithms, product));
        assert!(!is_surpassed(ResponseScale::Values, sum));
        assert!(is_surpassed(ResponseScale::Logarithms, sum));
    }

    #[test]
    fn logarithms_are_for_positive_values_that_scatter() {
        let of = |values: [f64; 4]| Mat::from_fn(4, 1, |i, _| values[i]);
        let is_wide = |values| ResponseScale::is_wide(of(values).as_ref());
        assert!(is_wide([1.0, 2.0, 3.0, 4.0]) && !is_wide([1.0, 1.1, 1.2, 1.3]));
        let without_sign = of([0.0, 2.0, 3.0, 4.0]);
        assert!(!ResponseScale::Logarithms.allows(without_sign.as_ref()));
        assert!(ResponseScale::Values.allows(without_sign.as_ref()));
    }

    #[test]
    fn a_value_comes_back_with_its_slope() {
        for (scale, slope) in [(ResponseScale::Values, 1.0), (ResponseScale::Logarithms, 0.7)] {
            assert!((scale.value(scale.learned(0.7)) - 0.7).abs() < 1e-15);
            assert_eq!(scale.slope(0.7), slope);
        }
        assert_eq!(ResponseScale::Logarithms.learned(-1.0), f64::NEG_INFINITY);
    }
}
