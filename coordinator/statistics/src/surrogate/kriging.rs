//! Kriging conditioned on data: one factorisation for all outputs.
//!
//! With C = R + nugget I + stated W = L L', W the diagonal of the points' noise weights, w(x) = L^-1 r(x),
//! z_o = L^-1 y_o, and the trend's coefficients c_o, orthogonal columns Q and squares D as in [`Trend`]'s
//! module:
//!
//!   mean_o(x)     = f(x)' U^-1 c_o + w(x)' (z_o - Q c_o)
//!   variance_o(x) = sigma2_o s^2(x),   s^2(x) = 1 - w'w + sum over k of v_k^2 / D_k,   v = U^-T f(x) - Q'w
//!   sigma2_o      = |z_o - Q c_o|^2 / (n - p + 1), p the number of trend coefficients
//!
//! The variance is that of the smooth function without the simulator's noise; its factor s^2 is common to all
//! outputs. The prediction is Gaussian for known lengths and nugget; their own uncertainty is not included,
//! which is why cross-validation corrects the variances.
//!
//! A response that is the larger of two: the distance of an output from a middle, largest over a life.
//!
//!   |y - c| = max(y - c, c - y)
//!
//! has a kink where y passes c, and its largest value so far another one where the side of the largest changes, which no
//! correlation of smooth functions fits. Its two sides, the largest y - c and the largest c - y so far, are as smooth as
//! y. So a surrogate learns both with one correlation, in 2 m outputs: the first side at all m checkpoints, then the second.
//! Its prediction is the larger of the two means, with the larger of the two process variances.
//!
//! # Source
//! Sacks, Welch, Mitchell, Wynn (1989), Design and analysis of computer experiments, Statistical Science
//! 4(4), eqs. 7 and 9.
//! Derived here. The error of the larger of two predictions is at most the larger of their errors.

use super::bounds::NUGGET;
use super::correlation::{correlation_below, cross_of_scaled_into, squared_norms};
use super::factor::{cholesky, solve_lower, solve_lower_transposed};
use super::trend::Whitened;
use super::{Correlation, SurrogateError, Trend};
use faer::linalg::matmul::matmul;
use faer::{Accum, ColRef, Mat, MatRef, Par};
use std::ops::Range;

/// A Kriging model of m outputs over n points.
#[derive(Debug, Clone)]
pub struct Kriging {
    /// The correlation in use, with the raised nugget.
    pub correlation: Correlation,
    /// Weights of the points' noise `(n,)` [1]; `None` if all are equal.
    pub(super) weights: Option<Vec<f64>>,
    /// Points times sqrt(theta) `(d, n)` [1].
    pub(super) scaled: Mat<f64>,
    /// Squared norms of the scaled points `(n,)` [1].
    pub(super) norms: Vec<f64>,
    /// Factor L `(n, n)`.
    pub(super) l: Mat<f64>,
    pub(super) trend: Whitened,
    /// Means of the outputs `(m,)`, subtracted first, because solving with values far from zero would cost
    /// digits.
    pub(super) shift: Vec<f64>,
    /// z_o of the shifted values `(n, m)`.
    pub(super) z: Mat<f64>,
    /// c of the shifted values `(p, m)`.
    pub(super) coefficients: Mat<f64>,
    /// Process variances of the responses `(m,)` [unit of the output squared].
    pub sigma2: Vec<f64>,
    /// z_o - Q c_o `(n, m)`.
    pub(super) residual: Mat<f64>,
    /// True if the outputs are the two sides of half as many responses, see the head of this file.
    pub(super) sided: bool,
    /// Number of times the nugget was raised.
    pub(super) raised: usize,
}

/// Prediction at b points.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// Means `(m, b)` [unit of the output].
    pub mean: Mat<f64>,
    /// Variances over sigma2 `(b,)` [1], at least 0.
    pub variance_factor: Vec<f64>,
}

impl Kriging {
    /// Conditions a model with a constant trend on values `(n, m)` at points `(d, n)`. If C has no Cholesky
    /// factor, the nugget is raised tenfold until it has; `raised` says how often.
    ///
    /// # Errors
    /// [`SurrogateError`] with fewer than 3 points, or if the largest nugget does not help.
    pub fn condition(
        points: MatRef<'_, f64>,
        values: MatRef<'_, f64>,
        correlation: &Correlation,
    ) -> Result<Self, SurrogateError> {
        Self::condition_noisy(points, values, correlation, Trend::Constant, None)
    }

    /// Conditions a model on values `(n, m)` at points `(d, n)`, with a trend, which is constant if the
    /// points cannot carry it ([`Trend::carried_by`]), and with noise weights `(n,)` of mean 1 [1], see
    /// [`super::NoiseShape`]; `None` for equal weights. The nugget is raised as in [`Kriging::condition`].
    ///
    /// # Errors
    /// Those of [`Kriging::condition`].
    pub fn condition_noisy(
        points: MatRef<'_, f64>,
        values: MatRef<'_, f64>,
        correlation: &Correlation,
        trend: Trend,
        weights: Option<&[f64]>,
    ) -> Result<Self, SurrogateError> {
        let (d, n) = points.shape();
        if n < 3 {
            return Err(SurrogateError::TooFewPoints { points: n });
        }
        let mut correlation = correlation.clone();
        let r = correlation_below(&correlation, points);
        let mut raised = 0;
        let l = loop {
            let mut c = r.clone();
            correlation.add_noise(c.as_mut(), weights);
            match cholesky(c) {
                Ok(l) => break l,
                Err(_) if correlation.nugget < NUGGET.1 => {
                    correlation.nugget = (10.0 * correlation.nugget).clamp(NUGGET.0, NUGGET.1);
                    raised += 1;
                }
                Err(pivot) => {
                    let nugget = correlation.nugget;
                    return Err(SurrogateError::NotPositiveDefinite { points: n, pivot, nugget });
                }
            }
        };
        let scaled = correlation.scale(points);
        let mut model = Self {
            trend: Whitened::new(trend.carried_by(d, n), points, l.as_ref()),
            norms: squared_norms(scaled.as_ref()),
            correlation,
            weights: weights.map(<[f64]>::to_vec),
            scaled,
            l,
            shift: vec![],
            z: Mat::new(),
            coefficients: Mat::new(),
            sigma2: vec![],
            residual: Mat::new(),
            sided: false,
            raised,
        };
        model.set_values(values);
        Ok(model)
    }

    /// The model with this correlation and trend of the results `kept` only, of all that it was conditioned on: points `(d, n)`
    /// and values `(n, m)`.
    ///
    /// # Errors
    /// Those of [`Kriging::condition`].
    pub fn conditioned_on(
        &self,
        points: MatRef<'_, f64>,
        values: MatRef<'_, f64>,
        kept: &[usize],
    ) -> Result<Self, SurrogateError> {
        let points = Mat::from_fn(points.nrows(), kept.len(), |k, i| points[(k, kept[i])]);
        let values = Mat::from_fn(kept.len(), values.ncols(), |i, o| values[(kept[i], o)]);
        let weights = self.weights.as_ref().map(|all| kept.iter().map(|i| all[*i]).collect::<Vec<f64>>());
        let (correlation, trend) = (&self.correlation, self.trend.trend);
        Self::condition_noisy(points.as_ref(), values.as_ref(), correlation, trend, weights.as_deref())
    }

    /// Replaces the outputs by other outputs with values `(n, m)` at the same points; the correlation and its
    /// factor stay.
    pub fn set_values(&mut self, values: MatRef<'_, f64>) {
        self.take_values(values, false);
    }

    /// Replaces the outputs by the two sides `(n, 2 m)` of m responses, each of which is the larger of its two; all of the first
    /// side come first.
    pub fn set_sides(&mut self, sides: MatRef<'_, f64>) {
        self.take_values(sides, true);
    }

    fn take_values(&mut self, values: MatRef<'_, f64>, sided: bool) {
        self.sided = sided;
        self.shift = values.col_iter().map(|c| c.iter().sum::<f64>() / values.nrows() as f64).collect();
        self.z = values.to_owned();
        for (o, shift) in self.shift.iter().enumerate() {
            self.z.col_as_slice_mut(o).iter_mut().for_each(|y| *y -= shift);
        }
        solve_lower(self.l.as_ref(), self.z.as_mut());
        self.set_trend();
    }

    /// Computes coefficients, residual and variance from z and the trend.
    pub(super) fn set_trend(&mut self) {
        let (n, m) = self.z.shape();
        self.residual = self.z.clone();
        self.coefficients = Mat::zeros(self.trend.squares.len(), m);
        let freedom = (n + 1 - self.trend.rank()) as f64;
        let variance_of = |o: usize| {
            let column = self.residual.col_as_slice_mut(o);
            self.coefficients.col_as_slice_mut(o).copy_from_slice(&self.trend.take_from(column));
            column.iter().map(|y| y * y).sum::<f64>() / freedom
        };
        let variances: Vec<f64> = (0..m).map(variance_of).collect();
        self.sigma2 = if self.sided { larger_variances(&variances) } else { variances };
    }

    /// Number of points n.
    pub fn points(&self) -> usize {
        self.norms.len()
    }

    /// Number of sides of a response: 1, or 2 of a distance from a middle.
    pub fn sides(&self) -> usize {
        1 + usize::from(self.sided)
    }

    /// True if the model is conditioned on values at exactly these points `(d, n)` [1].
    pub fn is_at(&self, points: MatRef<'_, f64>) -> bool {
        points.ncols() == self.points() && self.correlation.scale(points) == self.scaled
    }

    /// The trend in use: constant where the points cannot carry another.
    pub fn trend(&self) -> Trend {
        self.trend.trend
    }

    /// Correlations r(x) `(n, b)` of points `(d, b)` with the data.
    pub(super) fn correlations(&self, points: MatRef<'_, f64>) -> Mat<f64> {
        let scaled = self.correlation.scale(points);
        let mut r = Mat::zeros(self.points(), points.ncols());
        let kernel = self.correlation.kernel;
        cross_of_scaled_into(kernel, r.as_mut(), self.scaled.as_ref(), &self.norms, scaled.as_ref());
        r
    }

    /// Correlations r(x)' `(b, n - first)` of points `(d, b)` with the data from `first` on.
    pub(super) fn correlations_with(&self, points: MatRef<'_, f64>, first: usize) -> Mat<f64> {
        let scaled = self.correlation.scale(points);
        let norms = squared_norms(scaled.as_ref());
        let own = self.scaled.subcols(first, self.points() - first);
        let mut r = Mat::zeros(points.ncols(), own.ncols());
        cross_of_scaled_into(self.correlation.kernel, r.as_mut(), scaled.as_ref(), &norms, own);
        r
    }

    /// w = L^-1 r(x) `(n, b)` of points `(d, b)`.
    pub(super) fn whitened(&self, points: MatRef<'_, f64>) -> Mat<f64> {
        let mut w = self.correlations(points);
        solve_lower(self.l.as_ref(), w.as_mut());
        w
    }

    /// Means and variance factors at standardised points `(d, b)`.
    pub fn predict(&self, points: MatRef<'_, f64>) -> Prediction {
        let w = self.whitened(points);
        let mean = self.means(points, self.residual.as_ref(), w.as_ref(), 0..self.shift.len());
        let mean = if self.sided { larger_means(&mean) } else { mean };
        let v = self.trend.extrapolation(points, w.as_ref());
        let factor =
            |(w, v): (ColRef<'_, f64>, _)| (1.0 - w.squared_norm_l2() + self.trend.variance(v)).max(0.0);
        Prediction { mean, variance_factor: w.col_iter().zip(v.col_iter()).map(factor).collect() }
    }

    /// Means `(outputs.len(), b)` [unit of the output] of the outputs `outputs` at points `(d, b)`; `dual` is
    /// that of [`Kriging::dual`]. Cheaper than [`Kriging::predict`] because it needs no triangular solve.
    pub fn predict_means(&self, points: MatRef<'_, f64>, dual: &Mat<f64>, outputs: Range<usize>) -> Mat<f64> {
        let r = self.correlations(points);
        let of = |outputs: Range<usize>| {
            self.means(points, dual.subcols(outputs.start, outputs.len()), r.as_ref(), outputs)
        };
        if !self.sided {
            return of(outputs);
        }
        let m = self.sigma2.len();
        let (first, second) = (of(outputs.clone()), of(outputs.start + m..outputs.end + m));
        Mat::from_fn(outputs.len(), points.ncols(), |o, j| first[(o, j)].max(second[(o, j)]))
    }

    /// Trend plus a_o' b `(outputs.len(), b)` for each output and each column of b.
    fn means(
        &self,
        points: MatRef<'_, f64>,
        a: MatRef<'_, f64>,
        b: MatRef<'_, f64>,
        outputs: Range<usize>,
    ) -> Mat<f64> {
        let coefficients = self.coefficients.subcols(outputs.start, outputs.len());
        let mut mean = Mat::from_fn(outputs.len(), points.ncols(), |o, _| self.shift[outputs.start + o]);
        let basis = self.trend.orthogonal_basis(points);
        matmul(mean.as_mut(), Accum::Add, coefficients.transpose(), basis, 1.0, Par::Seq);
        matmul(mean.as_mut(), Accum::Add, a.transpose(), b, 1.0, Par::Seq);
        mean
    }

    /// Dual coefficients L'^-1 (z_o - Q c_o) `(n, m)` for [`Kriging::predict_means`].
    pub fn dual(&self) -> Mat<f64> {
        let mut dual = self.residual.clone();
        solve_lower_transposed(self.l.as_ref(), dual.as_mut());
        dual
    }
}

/// The larger of the two means per output `(m, b)`, from those of both sides `(2 m, b)`.
pub(super) fn larger_means(both: &Mat<f64>) -> Mat<f64> {
    let m = both.nrows() / 2;
    Mat::from_fn(m, both.ncols(), |o, j| both[(o, j)].max(both[(o + m, j)]))
}

/// The larger of the two variances per output `(m,)`, from those of both sides `(2 m,)`.
pub(super) fn larger_variances(both: &[f64]) -> Vec<f64> {
    let (first, second) = both.split_at(both.len() / 2);
    first.iter().zip(second).map(|(a, b)| a.max(*b)).collect()
}

#[cfg(test)]
#[path = "kriging_tests.rs"]
mod tests;
