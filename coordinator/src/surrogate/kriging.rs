//! Kriging conditioned on data: one factorisation, many outputs.
//!
//! With C = R + nugget I + stated W = L L', W the diagonal of the points' noise weights, w(x) = L^-1 r(x), z_o = L^-1 y_o and
//! the trend's coefficients c_o, orthogonal columns Q and their squares D as in [`super::Trend`]'s module:
//!   mean_o(x)     = f(x)' U^-1 c_o + w(x)' (z_o - Q c_o)
//!   variance_o(x) = sigma2_o (1 - w'w + sum_k v_k^2 / D_k),  v = U^-T f(x) - Q'w
//!   sigma2_o      = |z_o - Q c_o|^2 / (n - p + 1), p the coefficients of the trend: the slopes cost degrees of freedom
//! The variance is that of the smooth function without the simulator's noise; its factor is common to all outputs.
//!
//! Source: Sacks, Welch, Mitchell, Wynn (1989), eqs. 7 and 9.

use super::bounds::NUGGET;
use super::correlation::{correlation_below, cross_of_scaled_into, squared_norms};
use super::factor::{cholesky, solve_lower};
use super::trend::Whitened;
use super::{Correlation, SurrogateError, Trend};
use faer::linalg::matmul::matmul;
use faer::{Accum, ColRef, Mat, MatRef, Par};
use std::ops::Range;

/// A Kriging model of m outputs over n points.
#[derive(Debug, Clone)]
pub struct Kriging {
    pub(super) correlation: Correlation,
    /// Weights of the points' noise `(n,)`, if they differ.
    pub(super) weights: Option<Vec<f64>>,
    /// Points times sqrt(theta) `(d, n)` and their squared norms `(n,)`.
    pub(super) scaled: Mat<f64>,
    pub(super) norms: Vec<f64>,
    pub(super) l: Mat<f64>,
    pub(super) trend: Whitened,
    /// Taken from the outputs before anything else, as solving with values far from zero would cost digits `(m,)`.
    pub(super) shift: Vec<f64>,
    /// z_o of the shifted values `(n, m)`.
    pub(super) z: Mat<f64>,
    /// c of the shifted values `(p, m)`.
    pub(super) coefficients: Mat<f64>,
    sigma2: Vec<f64>,
    /// z_o - Q c_o `(n, m)`.
    pub(super) residual: Mat<f64>,
    raised: usize,
}

/// Prediction at b points.
#[derive(Debug, Clone)]
pub struct Prediction {
    /// Means `(m, b)`, in the outputs' units.
    pub mean: Mat<f64>,
    /// Variance over sigma2 `(b,)` [1], at least 0.
    pub variance_factor: Vec<f64>,
}

impl Kriging {
    /// Conditions on values `(n, m)` at points `(d, n)` with a constant trend. Where C has no Cholesky factor the nugget
    /// is raised tenfold until it has; [`Kriging::raised`] counts.
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

    /// The same with this trend, where the points can carry it ([`Trend::carried_by`]), and the points' noise weights
    /// `(n,)` of mean 1, see [`super::NoiseShape`]; `None`: all alike.
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
                Err(at) => {
                    return Err(SurrogateError::NotPositiveDefinite {
                        points: n,
                        pivot: at.pivot,
                        nugget: correlation.nugget,
                    });
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
            raised,
        };
        model.set_values(values);
        Ok(model)
    }

    /// Replaces the outputs by others known at the same points `(n, m)`; the correlation and its factor stay.
    pub fn set_values(&mut self, values: MatRef<'_, f64>) {
        let n = values.nrows();
        self.shift = values.col_iter().map(|c| c.iter().sum::<f64>() / n as f64).collect();
        self.z = values.to_owned();
        for (o, shift) in self.shift.iter().enumerate() {
            self.z.col_as_slice_mut(o).iter_mut().for_each(|y| *y -= shift);
        }
        solve_lower(self.l.as_ref(), self.z.as_mut());
        self.set_trend();
    }

    /// Coefficients, residual and variance from z and the trend.
    pub(super) fn set_trend(&mut self) {
        let (n, m) = self.z.shape();
        self.residual = self.z.clone();
        self.coefficients = Mat::zeros(self.trend.squares.len(), m);
        let freedom = (n + 1 - self.trend.rank()) as f64;
        let of_output = |o: usize| {
            let column = self.residual.col_as_slice_mut(o);
            self.coefficients.col_as_slice_mut(o).copy_from_slice(&self.trend.take_from(column));
            column.iter().map(|y| y * y).sum::<f64>() / freedom
        };
        self.sigma2 = (0..m).map(of_output).collect();
    }

    /// Number of points n.
    pub fn points(&self) -> usize {
        self.norms.len()
    }

    /// Process variances `(m,)` [unit of the output squared].
    pub fn sigma2(&self) -> &[f64] {
        &self.sigma2
    }

    /// The correlation in use, its nugget as raised.
    pub fn correlation(&self) -> &Correlation {
        &self.correlation
    }

    /// The trend in use: constant where the points cannot carry another.
    pub fn trend(&self) -> Trend {
        self.trend.trend
    }

    /// How often the nugget had to be raised.
    pub fn raised(&self) -> usize {
        self.raised
    }

    /// r(x) for points `(d, b)`: `(n, b)`.
    pub(super) fn correlations(&self, points: MatRef<'_, f64>) -> Mat<f64> {
        let scaled = self.correlation.scale(points);
        let mut r = Mat::zeros(self.points(), points.ncols());
        let kernel = self.correlation.kernel;
        cross_of_scaled_into(kernel, r.as_mut(), self.scaled.as_ref(), &self.norms, scaled.as_ref());
        r
    }

    /// r(x)' for points `(d, b)` with the points of the model from `first` on: `(b, n - first)`.
    pub(super) fn correlations_with(&self, points: MatRef<'_, f64>, first: usize) -> Mat<f64> {
        let scaled = self.correlation.scale(points);
        let norms = squared_norms(scaled.as_ref());
        let own = self.scaled.subcols(first, self.points() - first);
        let mut r = Mat::zeros(points.ncols(), own.ncols());
        cross_of_scaled_into(self.correlation.kernel, r.as_mut(), scaled.as_ref(), &norms, own);
        r
    }

    /// w = L^-1 r(x) for points `(d, b)`: `(n, b)`.
    pub(super) fn whitened(&self, points: MatRef<'_, f64>) -> Mat<f64> {
        let mut w = self.correlations(points);
        solve_lower(self.l.as_ref(), w.as_mut());
        w
    }

    /// Means and variance factors at points `(d, b)`.
    pub fn predict(&self, points: MatRef<'_, f64>) -> Prediction {
        let w = self.whitened(points);
        let m = self.shift.len();
        let mean = self.means(points, self.residual.as_ref(), w.as_ref(), 0..m);
        let v = self.trend.extrapolation(points, w.as_ref());
        let factor =
            |(w, v): (ColRef<'_, f64>, _)| (1.0 - w.squared_norm_l2() + self.trend.variance(v)).max(0.0);
        Prediction { mean, variance_factor: w.col_iter().zip(v.col_iter()).map(factor).collect() }
    }

    /// Means of the outputs `outputs` alone at points `(d, b)`: `(outputs.len(), b)`, with [`Kriging::dual`] given.
    /// Cheaper than [`Kriging::predict`]: no triangular solve, since w' L^-1 r = r(x)' C^-1 r.
    pub fn predict_means(&self, points: MatRef<'_, f64>, dual: &Mat<f64>, outputs: Range<usize>) -> Mat<f64> {
        let r = self.correlations(points);
        self.means(points, dual.subcols(outputs.start, outputs.len()), r.as_ref(), outputs)
    }

    /// Trend and a_o' b for each output and each column of b: `(outputs.len(), b)`.
    fn means(
        &self,
        points: MatRef<'_, f64>,
        a: MatRef<'_, f64>,
        b: MatRef<'_, f64>,
        outputs: Range<usize>,
    ) -> Mat<f64> {
        let coefficients = self.coefficients.subcols(outputs.start, outputs.len());
        let mut mean = Mat::from_fn(outputs.len(), points.ncols(), |o, _| self.shift[outputs.start + o]);
        let basis = self.trend.at(points);
        matmul(mean.as_mut(), Accum::Add, coefficients.transpose(), basis, 1.0, Par::Seq);
        matmul(mean.as_mut(), Accum::Add, a.transpose(), b, 1.0, Par::Seq);
        mean
    }

    /// L'^-1 (z_o - Q c_o) `(n, m)`, for [`Kriging::predict_means`].
    pub fn dual(&self) -> Mat<f64> {
        let mut dual = self.residual.clone();
        super::factor::solve_lower_transposed(self.l.as_ref(), dual.as_mut());
        dual
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surrogate::Kernel;
    use faer::linalg::solvers::DenseSolveCore;

    fn points(n: usize) -> Mat<f64> {
        Mat::from_fn(2, n, |k, i| 4.0 * ((i + 1) as f64 * [0.754_877_666, 0.569_840_296][k]).fract() - 2.0)
    }

    fn values(x: &Mat<f64>) -> Mat<f64> {
        Mat::from_fn(x.ncols(), 2, |i, o| 7.0 + x[(0, i)].sin() + (1.0 + o as f64) * x[(0, i)] * x[(1, i)])
    }

    #[test]
    fn interpolates_its_data_without_a_nugget() {
        let x = points(25);
        let y = values(&x);
        let correlation =
            Correlation { kernel: Kernel::Gaussian, theta: vec![0.8, 0.8], nugget: 0.0, stated: 0.0 };
        let model = Kriging::condition(x.as_ref(), y.as_ref(), &correlation).unwrap();
        assert_eq!(model.raised(), 0);
        let prediction = model.predict(x.as_ref());
        for i in 0..25 {
            assert!(prediction.variance_factor[i] < 1e-9);
            for o in 0..2 {
                assert!((prediction.mean[(o, i)] - y[(i, o)]).abs() < 1e-8);
            }
        }
    }

    #[test]
    fn far_from_the_data_it_returns_to_the_trend_with_the_full_variance() {
        let x = points(25);
        let correlation =
            Correlation { kernel: Kernel::Gaussian, theta: vec![1.0, 1.0], nugget: 1e-8, stated: 0.0 };
        let model = Kriging::condition(x.as_ref(), values(&x).as_ref(), &correlation).unwrap();
        let far = model.predict(Mat::from_fn(2, 1, |_, _| 100.0).as_ref());
        let mean = model.shift[0] + model.coefficients[(0, 0)];
        assert!((far.mean[(0, 0)] - mean).abs() < 1e-12);
        assert!((far.variance_factor[0] - (1.0 + 1.0 / model.trend.squares[0])).abs() < 1e-12);
    }

    #[test]
    fn means_alone_agree_with_the_whole_prediction() {
        let x = points(30);
        let correlation =
            Correlation { kernel: Kernel::Gaussian, theta: vec![0.5, 0.9], nugget: 1e-6, stated: 0.0 };
        let model = Kriging::condition(x.as_ref(), values(&x).as_ref(), &correlation).unwrap();
        let at = Mat::from_fn(2, 7, |k, i| (i as f64 + 2.0 * k as f64).cos());
        let (whole, alone) =
            (model.predict(at.as_ref()).mean, model.predict_means(at.as_ref(), &model.dual(), 0..2));
        assert!((&whole - &alone).norm_max() < 1e-7);
    }

    #[test]
    fn noisy_values_of_one_place_are_weighted_by_their_precision() {
        // Four simulations of the same point. The trend is unknown, so they are all there is to know: the mean is that
        // weighted by precision, the variance over sigma2 the inverse of the summed precisions.
        let x = Mat::from_fn(2, 4, |k, _| 0.3 * k as f64);
        let y = Mat::from_fn(4, 1, |i, _| [1.0, 2.0, 4.0, 8.0][i]);
        let correlation =
            Correlation { kernel: Kernel::Gaussian, theta: vec![1.0, 1.0], nugget: 0.05, stated: 0.2 };
        let weights = [0.1, 0.5, 1.4, 2.0];
        let model =
            Kriging::condition_noisy(x.as_ref(), y.as_ref(), &correlation, Trend::Constant, Some(&weights))
                .unwrap();
        let precision = weights.map(|w| 1.0 / (0.05 + 0.2 * w));
        let sum: f64 = precision.iter().sum();
        let mean = precision.iter().zip(y.col_as_slice(0)).map(|(p, y)| p * y).sum::<f64>() / sum;
        let prediction = model.predict(x.subcols(0, 1));
        assert!((prediction.mean[(0, 0)] - mean).abs() < 1e-12);
        assert!(
            (prediction.variance_factor[0] - 1.0 / sum).abs() < 1e-12,
            "{}",
            prediction.variance_factor[0]
        );
        assert_eq!(model.raised(), 0);
    }

    #[test]
    fn coincident_points_raise_the_nugget_and_say_so() {
        let x = Mat::from_fn(2, 12, |k, i| (i / 2) as f64 + k as f64);
        let y = values(&x);
        let correlation =
            Correlation { kernel: Kernel::Gaussian, theta: vec![0.01, 0.01], nugget: 0.0, stated: 0.0 };
        let model = Kriging::condition(x.as_ref(), y.as_ref(), &correlation).unwrap();
        assert!(model.raised() > 0 && model.correlation().nugget >= NUGGET.0);
        assert!(model.predict(x.as_ref()).mean.norm_max().is_finite());
    }

    #[test]
    fn a_linear_function_is_known_everywhere_by_a_linear_trend() {
        // The limit state of Rackwitz in 40 standardised lognormal variables is linear in them.
        let (d, n) = (40, 90);
        let x = Mat::from_fn(d, n, |k, i| 4.0 * (4e4 * ((i * d + k + 1) as f64).sin()).fract());
        let function = |x: faer::ColRef<'_, f64>| {
            40.0 + 3.0 * 0.2 * 40f64.sqrt() - x.iter().map(|x| 1.0 + 0.2 * x).sum::<f64>()
        };
        let y = Mat::from_fn(n, 1, |i, _| function(x.col(i)));
        let at = Mat::from_fn(d, 20, |k, i| 5.0 * ((i * 41 + k) as f64).sin());
        for kernel in Kernel::ALL {
            let correlation = Correlation { kernel, theta: vec![0.01; d], nugget: 1e-10, stated: 0.0 };
            let conditioned =
                |trend| Kriging::condition_noisy(x.as_ref(), y.as_ref(), &correlation, trend, None).unwrap();
            let model = conditioned(Trend::Linear);
            let mean = model.predict(at.as_ref()).mean;
            let far = (0..20).map(|i| (mean[(0, i)] - function(at.col(i))).abs()).fold(0.0, f64::max);
            assert!(far < 1e-10 && model.sigma2()[0] < 1e-20, "{kernel:?} {far}");
            // Which a constant trend is far from, so the test can fail.
            let mean = conditioned(Trend::Constant).predict(at.as_ref()).mean;
            assert!((0..20).any(|i| (mean[(0, i)] - function(at.col(i))).abs() > 0.1));
        }
    }

    #[test]
    fn the_trend_enters_the_variance_as_in_universal_kriging() {
        let x = points(30);
        let correlation =
            Correlation { kernel: Kernel::Matern52, theta: vec![0.5, 0.9], nugget: 1e-3, stated: 0.0 };
        let model =
            Kriging::condition_noisy(x.as_ref(), values(&x).as_ref(), &correlation, Trend::Linear, None)
                .unwrap();
        // c0 - r' C^-1 r + (f - F' C^-1 r)' (F' C^-1 F)^-1 (f - F' C^-1 r) by dense inverses.
        let at = Mat::from_fn(2, 6, |k, i| 3.0 * (i as f64 + 2.0 * k as f64).cos());
        let mut c = crate::surrogate::correlation_matrix(&correlation, x.as_ref());
        correlation.add_noise(c.as_mut(), None);
        let c_inverse = c.partial_piv_lu().inverse();
        let r = crate::surrogate::cross_correlation(&correlation, x.as_ref(), at.as_ref());
        let basis = |x: &Mat<f64>| Trend::Linear.basis(x.as_ref()).transpose().to_owned();
        let f = basis(&x);
        let u = basis(&at).transpose() - f.transpose() * &c_inverse * &r;
        let gram = (f.transpose() * &c_inverse * &f).partial_piv_lu().inverse();
        let explained = r.transpose() * &c_inverse * &r;
        let extrapolated = u.transpose() * gram * &u;
        let found = model.predict(at.as_ref()).variance_factor;
        for (i, found) in found.into_iter().enumerate() {
            let expected = 1.0 - explained[(i, i)] + extrapolated[(i, i)];
            assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
        }
    }
}
