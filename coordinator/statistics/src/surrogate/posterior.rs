//! Joint posterior covariance of a pool of points, and its reduction by further data.
//!
//! Over sigma2, at p points with w = L^-1 r and v as in [`super::Kriging`]'s module,
//!
//!   K = R_pp - W'W + V' D^-1 V,   after a result at point j:  K - c_j c_j' / (c_jj + noise),
//!
//! with c_j the column j of K. It is common to all outputs of a model, and independent of their values.
//!
//! # Source
//! Rasmussen, Williams (2006), Gaussian Processes for Machine Learning, sections 2.2 and 2.7; the reduction
//! by a point without its value: Ginsbourger, Le Riche, Carraro (2010), Kriging is well-suited to parallelize
//! optimization.

use super::Kriging;
use super::correlation::correlation_matrix;
use super::factor::cholesky;
use super::trend::ratio;
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};

/// Posterior covariance of p points over sigma2, common to all outputs of a model.
#[derive(Debug, Clone)]
pub struct Posterior {
    /// K `(p, p)` [1].
    covariance: Mat<f64>,
    /// Expected noise variance of a further result over sigma2 [1].
    pub noise: f64,
}

impl Posterior {
    /// Posterior covariance of `model` at standardised points `(d, p)`.
    pub fn new(model: &Kriging, points: MatRef<'_, f64>) -> Self {
        let w = model.whitened(points);
        let v = model.trend.extrapolation(points, w.as_ref());
        let mut covariance = correlation_matrix(&model.correlation, points);
        matmul(covariance.as_mut(), Accum::Add, w.transpose(), w.as_ref(), -1.0, Par::Seq);
        let over_square = |k: usize, j: usize| ratio(v[(k, j)], model.trend.squares[k]);
        let weighted = Mat::from_fn(v.nrows(), v.ncols(), over_square);
        matmul(covariance.as_mut(), Accum::Add, v.transpose(), weighted, 1.0, Par::Seq);
        Self { covariance, noise: model.correlation.noise() }
    }

    /// Number of points p.
    pub(crate) fn len(&self) -> usize {
        self.covariance.nrows()
    }

    /// Variance of point `i` over sigma2 [1], at least 0.
    pub fn variance(&self, i: usize) -> f64 {
        self.covariance[(i, i)].max(0.0)
    }

    /// Covariances of all points with point `j` over sigma2 `(p,)` [1].
    pub fn column(&self, j: usize) -> &[f64] {
        self.covariance.col_as_slice(j)
    }

    /// Adds point `j` to the data at fixed lengths and variance without its value: the covariance is reduced
    /// by c_j c_j' / (c_jj + noise), whatever the value. This is the step of the Kriging believer, whose
    /// means stay as predicted, at the cost of one outer product.
    pub fn believe(&mut self, j: usize) {
        let column = self.column(j).to_vec();
        let denominator = column[j].max(0.0) + self.noise;
        if denominator <= 0.0 {
            return;
        }
        for (k, target) in self.covariance.col_iter_mut().enumerate() {
            let factor = column[k] / denominator;
            target.iter_mut().zip(&column).for_each(|(c, v)| *c -= factor * v);
        }
    }

    /// Returns joint deviations from the mean over sqrt(sigma2) `(p, r)` [1], from standard normal draws
    /// `(p, r)`.
    ///
    /// The diagonal is raised by 1e-12 of the largest variance, and by 1e-10, 1e-8, ... if rounding made the
    /// covariance indefinite; the share used is returned too.
    pub fn realise(&self, normals: MatRef<'_, f64>) -> (Mat<f64>, f64) {
        let p = self.len();
        let largest = (0..p).map(|i| self.variance(i)).fold(0.0, f64::max);
        let mut lift = 1e-12;
        let l = loop {
            let mut lifted = self.covariance.clone();
            for i in 0..p {
                lifted[(i, i)] += lift * largest;
            }
            match cholesky(lifted) {
                Ok(l) => break l,
                // All variances are zero.
                Err(_) if largest == 0.0 || lift > 1.0 => break Mat::zeros(p, p),
                Err(_) => lift *= 100.0,
            }
        };
        let mut deviations = Mat::zeros(p, normals.ncols());
        matmul(deviations.as_mut(), Accum::Replace, l.as_ref(), normals, 1.0, faer::get_global_parallelism());
        (deviations, lift)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surrogate::{Correlation, Kernel, Trend};

    fn points(n: usize, shift: f64) -> Mat<f64> {
        Mat::from_fn(3, n, |k, i| ((i as f64 + shift) * [1.3, 2.1, 0.7][k]).sin() * 1.5)
    }

    fn values(x: &Mat<f64>) -> Mat<f64> {
        Mat::from_fn(x.ncols(), 1, |i, _| x[(0, i)] + x[(1, i)] * x[(2, i)])
    }

    #[test]
    fn a_believed_point_equals_conditioning_from_scratch() {
        let (x, pool) = (points(20, 0.0), points(15, 0.43));
        for (kernel, trend) in [(Kernel::Gaussian, Trend::Constant), (Kernel::Matern52, Trend::Linear)] {
            let correlation = Correlation { kernel, theta: vec![0.2, 0.1, 0.3], nugget: 1e-5, stated: 0.0 };
            compare_believed_with_conditioned(&x, &pool, &correlation, trend);
        }
    }

    fn compare_believed_with_conditioned(
        x: &Mat<f64>,
        pool: &Mat<f64>,
        correlation: &Correlation,
        trend: Trend,
    ) {
        let condition = |x: &Mat<f64>| {
            Kriging::condition_noisy(x.as_ref(), values(x).as_ref(), correlation, trend, None).unwrap()
        };
        let model = condition(x);
        let mut posterior = Posterior::new(&model, pool.as_ref());
        let added = [4, 9];
        for j in added {
            posterior.believe(j);
        }
        let extended = Mat::from_fn(3, 22, |k, i| if i < 20 { x[(k, i)] } else { pool[(k, added[i - 20])] });
        let whole = condition(&extended);
        let fresh = Posterior::new(&whole, pool.as_ref());
        assert!((&posterior.covariance - &fresh.covariance).norm_max() < 1e-8);
    }

    #[test]
    fn variances_agree_with_prediction_and_realisations() {
        let (x, pool) = (points(12, 0.0), points(6, 0.43));
        let correlation =
            Correlation { kernel: Kernel::Gaussian, theta: vec![0.5, 0.4, 0.6], nugget: 1e-8, stated: 0.0 };
        let model = Kriging::condition(x.as_ref(), values(&x).as_ref(), &correlation).unwrap();
        let posterior = Posterior::new(&model, pool.as_ref());
        let predicted = model.predict(pool.as_ref()).variance_factor;
        let draws = 20_000;
        let mut rng = crate::design::open_stream(1, crate::design::Stream::Design);
        let normals = Mat::from_fn(6, draws, |_, _| {
            rand_distr::Distribution::<f64>::sample(&rand_distr::StandardNormal, &mut rng)
        });
        let (deviations, lift) = posterior.realise(normals.as_ref());
        assert!(lift < 1e-6);
        for (i, predicted) in predicted.iter().enumerate() {
            assert!((posterior.variance(i) - predicted).abs() < 1e-12);
            let sampled = deviations.row(i).iter().map(|d| d * d).sum::<f64>() / draws as f64;
            // A sampled variance has relative standard error sqrt(2 / draws) = 1 %.
            assert!((sampled / predicted - 1.0).abs() < 0.04, "{i} {sampled} {predicted}");
        }
    }
}
