//! Difference of two levels at one checkpoint: a constant, or a line over the value of the coarser level, by least squares.
//!
//! With n pairs (y_i, d_i), means c of y and a of d, S = sum (y_i - c)^2 and residuals e_i,
//!
//!   d(y) = a + b (y - c),   s^2 = sum e_i^2 / f,   Var d(y) = t^2 s^2 [1/n + (y - c)^2 / S],
//!
//! where f = n - 1 and the second term is absent for a constant, and f = n - 2 for a line. t is the quantile of Student's distribution
//! over that of the normal one, so that 1.96 standard deviations hold in 95 % of cases. The value left out is predicted with the
//! error e_i / (1 - h_i), h_i = 1/n + (y_i - c)^2 / S.
//!
//! # Source
//! Draper, Smith (1998), Applied Regression Analysis, chapters 1 and 8.

use crate::reliability::REACH;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Form of a difference over the value of the coarser level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DifferenceForm {
    /// One number for all values.
    Constant,
    /// A line over the value.
    Line,
}

impl DifferenceForm {
    /// Number of coefficients.
    fn coefficients(self) -> usize {
        match self {
            Self::Constant => 1,
            Self::Line => 2,
        }
    }

    /// The form in a word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Line => "line",
        }
    }
}

/// Difference at one checkpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Mean c of the values of the coarser level [unit of the output].
    centre: f64,
    /// Mean a of the differences [unit of the output].
    mean: f64,
    /// Slope b over the value [1].
    slope: f64,
    /// Sum S of squares of the values around their mean; infinite for a constant.
    square: f64,
    /// Number n of pairs.
    pairs: usize,
    /// Standard deviation s of the residuals: the roughness [unit of the output].
    pub rough: f64,
    /// Mean square of the errors of predictions for pairs left out.
    pub left_out: f64,
}

impl Difference {
    /// The difference by pairs of value and difference. Values without spread have no slope. There is at least one pair; a
    /// single one has the roughness of its own difference.
    pub fn fit(pairs: &[(f64, f64)], form: DifferenceForm) -> Self {
        let n = pairs.len() as f64;
        let centre = pairs.iter().map(|(y, _)| y).sum::<f64>() / n;
        let mean = pairs.iter().map(|(_, d)| d).sum::<f64>() / n;
        let square: f64 = pairs.iter().map(|(y, _)| (y - centre).powi(2)).sum();
        let is_line = form == DifferenceForm::Line && square > 0.0;
        let square = if is_line { square } else { f64::INFINITY };
        let slope = pairs.iter().map(|(y, d)| (y - centre) * (d - mean)).sum::<f64>() / square;
        let mut difference = Self {
            centre,
            mean,
            slope,
            square,
            pairs: pairs.len(),
            rough: mean.abs(),
            left_out: mean * mean,
        };
        let freedom = difference.freedom();
        if freedom == 0 {
            return difference;
        }
        let residual = |(y, d): &(f64, f64)| d - difference.at(*y);
        let rough = (pairs.iter().map(|pair| residual(pair).powi(2)).sum::<f64>() / freedom as f64).sqrt();
        let left_out = |pair: &(f64, f64)| {
            let own = 1.0 / n + (pair.0 - centre).powi(2) / square;
            (residual(pair) / (1.0 - own).max(f64::EPSILON)).powi(2)
        };
        let left_out = pairs.iter().map(left_out).sum::<f64>() / n;
        (difference.rough, difference.left_out) = (rough, left_out);
        difference
    }

    /// Degrees of freedom of the residuals.
    fn freedom(&self) -> usize {
        let form = if self.square.is_finite() { DifferenceForm::Line } else { DifferenceForm::Constant };
        self.pairs.saturating_sub(form.coefficients())
    }

    /// The difference at a value of the coarser level [unit of the output].
    pub fn at(&self, value: f64) -> f64 {
        self.mean + self.slope * (value - self.centre)
    }

    /// Standard deviation of its error, common to all points, at a value [unit of the output].
    pub fn std_at(&self, value: f64) -> f64 {
        let own = 1.0 / self.pairs as f64 + (value - self.centre).powi(2) / self.square;
        student(self.freedom()) * self.rough * own.sqrt()
    }
}

/// Quantile of 97.5 % of Student's distribution over that of the normal one [1]; without a degree of freedom that of one.
pub(super) fn student(freedom: usize) -> f64 {
    let quantile = StudentsT::new(0.0, 1.0, freedom.max(1) as f64).map(|t| t.inverse_cdf(0.975));
    quantile.map_or(f64::INFINITY, |t| (t / REACH).max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_difference_is_known_without_error() {
        let pairs = [(1.0, 0.25), (2.0, 0.25), (5.0, 0.25)];
        for form in [DifferenceForm::Constant, DifferenceForm::Line] {
            let found = Difference::fit(&pairs, form);
            assert_eq!(
                (found.at(9.0), found.std_at(9.0), found.rough, found.left_out),
                (0.25, 0.0, 0.0, 0.0)
            );
        }
    }

    #[test]
    fn a_line_is_followed_where_a_constant_is_rough() {
        let pairs: Vec<(f64, f64)> = (0..8_i32).map(f64::from).map(|y| (y, 0.5 + 0.125 * y)).collect();
        let line = Difference::fit(&pairs, DifferenceForm::Line);
        assert!((line.at(10.0) - 1.75).abs() < 1e-14 && line.rough < 1e-14);
        let constant = Difference::fit(&pairs, DifferenceForm::Constant);
        // Standard deviation of 0, 1, ..., 7 with f = 7: sqrt(6).
        assert!((constant.rough - 0.125 * 6.0_f64.sqrt()).abs() < 1e-14);
        assert!(constant.left_out > 100.0 * line.left_out.max(1e-12));
    }

    #[test]
    fn a_rough_difference_leaves_the_error_of_its_mean() {
        let pairs = [(0.0, 1.0), (0.0, -1.0), (0.0, 1.0), (0.0, -1.0)];
        let found = Difference::fit(&pairs, DifferenceForm::Line);
        let rough = (4.0_f64 / 3.0).sqrt();
        assert!((found.rough - rough).abs() < 1e-14 && found.at(3.0) == 0.0);
        // Student's quantile for three degrees of freedom is 3.182.
        assert!((found.std_at(3.0) - 3.182 / 1.96 * rough / 2.0).abs() < 1e-3);
        // Each is predicted by the mean of the three others, off by 4/3.
        assert!((found.left_out - (4.0_f64 / 3.0).powi(2)).abs() < 1e-14);
    }
}
