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
//! Kennedy, O'Hagan (2000), Predicting the output from a complex computer code when fast approximations are available, Biometrika 87(1).

use super::difference::student;
use crate::surrogate::{Effort, FormSettings, Kriging, TrainingSet, fit_surrogate};
use faer::Mat;

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
