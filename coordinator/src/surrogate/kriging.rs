//! Ordinary Kriging conditioned on data: one factorisation, many outputs.
//!
//! With C = R + nugget I + stated W = L L', W the diagonal of the points' noise weights, t = L^-1 1, w(x) = L^-1 r(x) and u(x) = 1 - t'w(x):
//!   mean_o(x)     = beta_o + w(x)' L^-1 (y_o - beta_o 1)
//!   variance_o(x) = sigma2_o (1 - w'w + u^2 / t't)
//! The variance is that of the smooth function without the simulator's noise; its factor is common to all outputs.
//!
//! Source: Sacks, Welch, Mitchell, Wynn (1989), eqs. 7 and 9.

use super::bounds::NUGGET;
use super::correlation::{correlation_matrix, cross_of_scaled_into, squared_norms};
use super::factor::{cholesky, solve_lower};
use super::{Correlation, SurrogateError};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use std::ops::Range;

/// An ordinary Kriging model of m outputs over n points.
#[derive(Debug, Clone)]
pub struct Kriging {
    correlation: Correlation,
    /// Points times sqrt(theta) `(d, n)` and their squared norms `(n,)`.
    scaled: Mat<f64>,
    norms: Vec<f64>,
    pub(super) l: Mat<f64>,
    /// t = L^-1 1 `(n, 1)`, and t't.
    pub(super) t: Mat<f64>,
    pub(super) tt: f64,
    beta: Vec<f64>,
    sigma2: Vec<f64>,
    /// L^-1 (y_o - beta_o 1) `(n, m)`.
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
    /// Conditions on values `(n, m)` at points `(d, n)`. Where C has no Cholesky factor the nugget is raised tenfold
    /// until it has; [`Kriging::raised`] counts.
    ///
    /// # Errors
    /// [`SurrogateError`] with fewer than 3 points, or if the largest nugget does not help.
    pub fn condition(
        points: MatRef<'_, f64>,
        values: MatRef<'_, f64>,
        correlation: &Correlation,
    ) -> Result<Self, SurrogateError> {
        Self::condition_noisy(points, values, correlation, None)
    }

    /// The same with the points' noise weights `(n,)` of mean 1, see [`super::NoiseShape`]; `None`: all alike.
    ///
    /// # Errors
    /// Those of [`Kriging::condition`].
    pub fn condition_noisy(
        points: MatRef<'_, f64>,
        values: MatRef<'_, f64>,
        correlation: &Correlation,
        weights: Option<&[f64]>,
    ) -> Result<Self, SurrogateError> {
        let n = points.ncols();
        if n < 3 {
            return Err(SurrogateError::TooFewPoints { points: n });
        }
        let mut correlation = correlation.clone();
        let r = correlation_matrix(&correlation, points);
        let mut raised = 0;
        let l = loop {
            let mut c = r.clone();
            correlation.add_noise(&mut c, weights);
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
        let mut t = Mat::from_fn(n, 1, |_, _| 1.0);
        solve_lower(l.as_ref(), t.as_mut());
        let tt = t.squared_norm_l2();
        let scaled = correlation.scale(points);
        let norms = squared_norms(scaled.as_ref());
        let mut model = Self {
            correlation,
            scaled,
            norms,
            l,
            t,
            tt,
            beta: vec![],
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
        self.residual = values.to_owned();
        self.beta.clear();
        self.sigma2.clear();
        // The mean is taken out first: solving with values far from zero would cost digits.
        let means: Vec<f64> = values.col_iter().map(|c| c.iter().sum::<f64>() / n as f64).collect();
        for (o, mean) in means.iter().enumerate() {
            self.residual.col_as_slice_mut(o).iter_mut().for_each(|y| *y -= mean);
        }
        solve_lower(self.l.as_ref(), self.residual.as_mut());
        let t = self.t.col_as_slice(0);
        for (o, mean) in means.iter().enumerate() {
            let column = self.residual.col_as_slice_mut(o);
            let beta = column.iter().zip(t).map(|(y, t)| y * t).sum::<f64>() / self.tt;
            column.iter_mut().zip(t).for_each(|(y, t)| *y -= beta * t);
            self.beta.push(mean + beta);
            self.sigma2.push(column.iter().map(|y| y * y).sum::<f64>() / n as f64);
        }
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

    /// How often the nugget had to be raised.
    pub fn raised(&self) -> usize {
        self.raised
    }

    /// w = L^-1 r(x) for points `(d, b)`: `(n, b)`.
    pub(super) fn whitened(&self, points: MatRef<'_, f64>) -> Mat<f64> {
        let scaled = self.correlation.scale(points);
        let mut w = Mat::zeros(self.points(), points.ncols());
        cross_of_scaled_into(w.as_mut(), self.scaled.as_ref(), &self.norms, scaled.as_ref());
        solve_lower(self.l.as_ref(), w.as_mut());
        w
    }

    /// u = 1 - t'w for each column of w.
    pub(super) fn trend_residual(&self, w: MatRef<'_, f64>) -> Vec<f64> {
        let t = self.t.col(0);
        w.col_iter().map(|w| 1.0 - w.iter().zip(t.iter()).map(|(w, t)| w * t).sum::<f64>()).collect()
    }

    /// Means and variance factors at points `(d, b)`.
    pub fn predict(&self, points: MatRef<'_, f64>) -> Prediction {
        let w = self.whitened(points);
        let mean = with_trend(&self.beta, self.residual.as_ref(), w.as_ref());
        let u = self.trend_residual(w.as_ref());
        let variance_factor = w
            .col_iter()
            .zip(u)
            .map(|(w, u)| (1.0 - w.squared_norm_l2() + u * u / self.tt).max(0.0))
            .collect();
        Prediction { mean, variance_factor }
    }

    /// Means of the outputs `outputs` alone at points `(d, b)`: `(outputs.len(), b)`, with [`Kriging::dual`] given.
    /// Cheaper than [`Kriging::predict`]: no triangular solve, since w' L^-1 r = r(x)' C^-1 r.
    pub fn predict_means(&self, points: MatRef<'_, f64>, dual: &Mat<f64>, outputs: Range<usize>) -> Mat<f64> {
        let scaled = self.correlation.scale(points);
        let mut r = Mat::zeros(self.points(), points.ncols());
        cross_of_scaled_into(r.as_mut(), self.scaled.as_ref(), &self.norms, scaled.as_ref());
        let dual = dual.subcols(outputs.start, outputs.len());
        with_trend(&self.beta[outputs], dual, r.as_ref())
    }

    /// C^-1 (y_o - beta_o 1) `(n, m)`, for [`Kriging::predict_means`].
    pub fn dual(&self) -> Mat<f64> {
        let mut dual = self.residual.clone();
        super::factor::solve_lower_transposed(self.l.as_ref(), dual.as_mut());
        dual
    }
}

/// beta_o + a_o' b for each column of a and b: `(m, b)`.
fn with_trend(beta: &[f64], a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    let mut mean = Mat::from_fn(beta.len(), b.ncols(), |o, _| beta[o]);
    matmul(mean.as_mut(), Accum::Add, a.transpose(), b, 1.0, Par::Seq);
    mean
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let correlation = Correlation { theta: vec![0.8, 0.8], nugget: 0.0, stated: 0.0 };
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
        let correlation = Correlation { theta: vec![1.0, 1.0], nugget: 1e-8, stated: 0.0 };
        let model = Kriging::condition(x.as_ref(), values(&x).as_ref(), &correlation).unwrap();
        let far = model.predict(Mat::from_fn(2, 1, |_, _| 100.0).as_ref());
        assert!((far.mean[(0, 0)] - model.beta[0]).abs() < 1e-12);
        assert!((far.variance_factor[0] - (1.0 + 1.0 / model.tt)).abs() < 1e-12);
    }

    #[test]
    fn means_alone_agree_with_the_whole_prediction() {
        let x = points(30);
        let correlation = Correlation { theta: vec![0.5, 0.9], nugget: 1e-6, stated: 0.0 };
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
        let correlation = Correlation { theta: vec![1.0, 1.0], nugget: 0.05, stated: 0.2 };
        let weights = [0.1, 0.5, 1.4, 2.0];
        let model = Kriging::condition_noisy(x.as_ref(), y.as_ref(), &correlation, Some(&weights)).unwrap();
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
        let correlation = Correlation { theta: vec![0.01, 0.01], nugget: 0.0, stated: 0.0 };
        let model = Kriging::condition(x.as_ref(), y.as_ref(), &correlation).unwrap();
        assert!(model.raised() > 0 && model.correlation().nugget >= NUGGET.0);
        assert!(model.predict(x.as_ref()).mean.norm_max().is_finite());
    }
}
