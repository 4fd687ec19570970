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
//! What the finer level leaves, by a third one at few points.
//!
//! With the mean difference a from the first to the second level, and b from the second to the third, at the same points, each level
//! refined by the same factor,
//!
//!   q = b / a,   r = b + b q / (1 - q)   if 0 < q <= 1/2,   r = b   otherwise:
//!
//! a geometric series, half of whose sum beyond the third level is a standard deviation, and to it come the errors s of a and b, by
//! dr = (db - q^2 da) / (1 - q)^2, which share the second level: (s_b + q^2 s_a) / (1 - q)^2. Where the levels do not converge like
//! that, r is as uncertain as b itself. The observed order of convergence under halving is -log2(q). Without a third level r = 0, with a
//! standard deviation of |a| / 3: what a method of second order leaves.
//!
//! Difference of two levels as a function of the variables, by Kriging over the pairs.
//!
//! Where levels differ by a smooth function of the variables that is none of the value, a constant or a line takes it for noise. Kriging
//! follows it; its stated error is that of predictions for pairs left out, with e_i the error at fixed lengths of pair i,
//!
//!   s^2 = (1/n) sum e_i^2,   Var d = t^2 s^2,
//!
//! the same at all points, and common to all, although it is none at the pairs themselves. t is the quantile of Student's distribution
//! for f = n - 1 - d over that of the normal one.
//!
//! # Source
//! Draper, Smith (1998), Applied Regression Analysis, chapters 1 and 8.
//! Roache (1994), Perspective: a method for uniform reporting of grid refinement studies, Journal of Fluids Engineering 116(3).
//! Kennedy, O'Hagan (2000), Predicting the output from a complex computer code when fast approximations are available, Biometrika 87(1).

use crate::reliability::REACH;
use crate::surrogate::{Effort, FormSettings, Kriging, TrainingSet, fit_surrogate};
use faer::Mat;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Form of a difference over the value of the coarser level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DifferenceForm {
    /// One number for all values, one coefficient.
    Constant = 1,
    /// A line over the value, two coefficients.
    Line = 2,
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
        let square = if form == DifferenceForm::Line && square > 0.0 { square } else { f64::INFINITY };
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
        self.pairs.saturating_sub(form as usize)
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

/// Largest ratio of successive differences that counts as convergence [1].
const CONVERGES: f64 = 0.5;

/// What the finer level leaves at one checkpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Remainder {
    /// Estimate [unit of the output].
    pub mean: f64,
    /// Its standard deviation [unit of the output].
    pub std: f64,
    /// The part of it that more points at the third level reduce [unit of the output].
    pub of_points: f64,
    /// Observed order of convergence under halving [1]; `None` without a third level, or without convergence.
    pub order: Option<f64>,
}

impl Remainder {
    /// The remainder by the `coarse` differences from the first to the second level and the `fine` ones from the second to the third, at
    /// the same points, and by the mean difference `known` of all pairs, which counts without a third level [unit of the output].
    pub fn new(coarse: &[f64], fine: &[f64], known: f64) -> Self {
        if fine.is_empty() || coarse.len() != fine.len() {
            return Self { mean: 0.0, std: known.abs() / 3.0, of_points: 0.0, order: None };
        }
        let mean = |differences: &[f64]| {
            let pairs: Vec<(f64, f64)> = differences.iter().map(|difference| (0.0, *difference)).collect();
            let difference = Difference::fit(&pairs, DifferenceForm::Constant);
            (difference.at(0.0), difference.std_at(0.0))
        };
        let ((a, of_a), (b, scatter)) = (mean(coarse), mean(fine));
        let ratio = b / a;
        if ratio > 0.0 && ratio <= CONVERGES {
            let beyond = b * ratio / (1.0 - ratio);
            let of_points = (scatter + ratio * ratio * of_a) / (1.0 - ratio).powi(2);
            let std = of_points.hypot(0.5 * beyond);
            return Self { mean: b + beyond, std, of_points, order: Some(-ratio.log2()) };
        }
        // No difference at all, or none that falls.
        Self { mean: b, std: scatter.hypot(b), of_points: scatter, order: None }
    }
}

/// Pairs beyond the number of variables that the lengths and an error need.
const BEYOND: usize = 4;

/// A difference as a function of the variables, at each checkpoint.
#[derive(Debug, Clone)]
pub(super) struct KrigedDifference {
    /// Mean and spread of the pairs' values of each variable `(d,)`.
    scales: Vec<(f64, f64)>,
    model: Kriging,
    dual: Mat<f64>,
    /// Mean square of the errors of predictions for pairs left out `(m,)`.
    pub(super) left_out: Vec<f64>,
}

impl KrigedDifference {
    /// The difference by points `(n)(d,)` and differences there `(n)(m,)`; `None` with too few pairs, or if no model can be conditioned
    /// on them.
    pub fn fit(points: &[&[f64]], differences: &[Vec<f64>]) -> Option<Self> {
        let (n, m) = (points.len(), differences[0].len());
        let scale = |k: usize| {
            let mean = points.iter().map(|x| x[k]).sum::<f64>() / n as f64;
            let variance = points.iter().map(|x| (x[k] - mean).powi(2)).sum::<f64>() / n as f64;
            (mean, variance.sqrt())
        };
        // A variable that is the same at all points says nothing.
        let scales: Vec<(f64, f64)> = (0..points[0].len()).map(scale).collect();
        let varied = scales.iter().filter(|(_, spread)| *spread > 0.0).count();
        if varied == 0 || n < varied + BEYOND {
            return None;
        }
        let at = Mat::from_fn(scales.len(), n, |k, i| scaled(&scales, points[i])[k]);
        let values = Mat::from_fn(n, m, |i, o| differences[i][o]);
        let training =
            TrainingSet { points: at.as_ref(), values: values.as_ref(), noise: None, is_exact: false };
        let model = fit_surrogate(training, FormSettings::default(), None, Effort::MultiStart).ok()?.model;
        let freedom = n - 1 - varied;
        let left_out = |o: usize| {
            let predicted = model.left_out(values.as_ref(), o);
            let square =
                |(i, left): (usize, &crate::surrogate::LeftOut)| (values[(i, o)] - left.mean).powi(2);
            student(freedom).powi(2) * predicted.iter().enumerate().map(square).sum::<f64>() / n as f64
        };
        let left_out: Vec<f64> = (0..m).map(left_out).collect();
        let dual = model.dual();
        left_out.iter().all(|square| square.is_finite()).then_some(Self { scales, model, dual, left_out })
    }

    /// The difference at values of the variables `(d,)`, at checkpoint `n` [unit of the output].
    pub fn at(&self, n: usize, point: &[f64]) -> f64 {
        let z = scaled(&self.scales, point);
        let z = Mat::from_fn(z.len(), 1, |k, _| z[k]);
        self.model.predict_means(z.as_ref(), &self.dual, n..n + 1)[(0, 0)]
    }
}

/// Values of the variables over the spread of the pairs `(d,)` [1].
fn scaled(scales: &[(f64, f64)], point: &[f64]) -> Vec<f64> {
    let scale =
        |(x, (mean, spread)): (&f64, &(f64, f64))| if *spread > 0.0 { (x - mean) / spread } else { 0.0 };
    point.iter().zip(scales).map(scale).collect()
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

    #[test]
    fn a_geometric_series_is_summed() {
        // Errors of 16, 4 and 1: differences of 12 and 3; the second level leaves 4.
        let found = Remainder::new(&[12.0; 3], &[3.0; 3], 12.0);
        assert!((found.mean - 4.0).abs() < 1e-14 && (found.std - 0.5).abs() < 1e-14);
        assert!((found.order.unwrap() - 2.0).abs() < 1e-14);
    }

    #[test]
    fn the_error_of_the_ratio_is_in_that_of_the_sum() {
        // Three points each: errors of the means 4.303 / 1.96 / sqrt(3) times the spreads 1.2 and 0.3; q = 1/4.
        let found = Remainder::new(&[10.8, 12.0, 13.2], &[2.7, 3.0, 3.3], 12.0);
        let of_means = 4.303 / 1.96 / 3f64.sqrt();
        let expected = of_means * (0.3 + 1.2 / 16.0) / 0.75f64.powi(2);
        assert!((found.of_points / expected - 1.0).abs() < 1e-3, "{found:?}");
    }

    #[test]
    fn levels_that_do_not_converge_are_as_uncertain_as_their_difference() {
        for (fine, std) in [(9.0, 9.0), (-3.0, 3.0), (0.0, 0.0)] {
            let found = Remainder::new(&[12.0; 3], &[fine; 3], 12.0);
            assert_eq!(found, Remainder { mean: fine, std, of_points: 0.0, order: None });
        }
        let without = Remainder { mean: 0.0, std: 2.0, of_points: 0.0, order: None };
        assert_eq!(Remainder::new(&[], &[], -6.0), without);
        assert_eq!(Remainder::new(&[0.0; 3], &[0.0; 3], 0.0).std, 0.0);
    }
}
