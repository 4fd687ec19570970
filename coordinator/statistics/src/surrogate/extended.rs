//! A surrogate conditioned on further points with the same correlation: its factor grows by rows.
//!
//! With L21 = (L^-1 R12)' and L22 L22' = C22 - L21 L21' the rows of the new points are
//!
//!   T2 = L22^-1 (F2 - L21 T),   z2 = L22^-1 (y2 - L21 z).
//!
//! All old rows stay bit by bit, so [`super::PredictionCache`] can extend its cached predictions of a
//! population.
//!
//! # Source
//! Golub, Van Loan (2013), Matrix Computations, section 6.5.

use super::correlation::{correlation_below, squared_norms};
use super::factor::{cholesky, solve_lower};
use super::trend::Whitened;
use super::{Kriging, SurrogateError};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};

/// Least squared pivot of the factor [1]: a smaller rest of a new point's variance of 1 is rounding.
const ROUNDING: f64 = 1e-13;

impl Kriging {
    /// Returns the model conditioned on the values `(k, m)` of k further points `(d, k)` as well. `weights`
    /// `(k,)` are the weights of their noise in the scale of the model's weights, see
    /// [`super::NoiseShape::weights_of`]; without them each new point has the weight 1.
    ///
    /// # Errors
    /// [`SurrogateError::NotPositiveDefinite`] if the larger matrix has no factor. The nugget is then too
    /// small, and cannot be raised without changing the old rows; use [`Kriging::condition_noisy`].
    pub fn extended(
        &self,
        points: MatRef<'_, f64>,
        values: MatRef<'_, f64>,
        weights: Option<&[f64]>,
    ) -> Result<Self, SurrogateError> {
        let (n, k) = (self.points(), points.ncols());
        let mut extended = self.clone();

        // The factor.
        let across = self.whitened(points);
        let weights = self.weights.as_ref().map(|_| weights.map_or(vec![1.0; k], <[f64]>::to_vec));
        let mut below = correlation_below(&self.correlation, points);
        self.correlation.add_noise(below.as_mut(), weights.as_deref());
        matmul(below.as_mut(), Accum::Add, across.transpose(), across.as_ref(), -1.0, Par::Seq);
        let nugget = self.correlation.nugget;
        let refused =
            |pivot: usize| SurrogateError::NotPositiveDefinite { points: n + k, pivot: n + pivot, nugget };
        let l22 = cholesky(below).map_err(refused)?;
        if let Some(pivot) = (0..k).find(|i| l22[(*i, *i)].powi(2) < ROUNDING) {
            return Err(refused(pivot));
        }
        extended.l = Mat::from_fn(n + k, n + k, |i, j| match (i < n, j < n) {
            (true, true) => self.l[(i, j)],
            (true, false) => 0.0,
            (false, true) => across[(j, i - n)],
            (false, false) => l22[(i - n, j - n)],
        });

        // The points themselves.
        let scaled = self.correlation.scale(points);
        let column = |c, i| if i < n { self.scaled[(c, i)] } else { scaled[(c, i - n)] };
        extended.scaled = Mat::from_fn(scaled.nrows(), n + k, column);
        extended.norms.extend(squared_norms(scaled.as_ref()));
        if let (Some(all), Some(weights)) = (&mut extended.weights, weights) {
            all.extend(weights);
        }

        // Trend and values.
        let rows = |mut new: Mat<f64>, old: &Mat<f64>| {
            matmul(new.as_mut(), Accum::Add, across.transpose(), old.as_ref(), -1.0, Par::Seq);
            solve_lower(l22.as_ref(), new.as_mut());
            Mat::from_fn(n + k, old.ncols(), |i, o| if i < n { old[(i, o)] } else { new[(i - n, o)] })
        };
        let basis = self.trend.trend.basis(points).transpose().to_owned();
        extended.trend = Whitened::from_basis(self.trend.trend, rows(basis, &self.trend.t));
        extended.z = rows(Mat::from_fn(k, values.ncols(), |i, o| values[(i, o)] - self.shift[o]), &self.z);
        extended.set_trend();
        Ok(extended)
    }

    /// True if this model is `other` or an extension of it: it has the same correlation and, bit by bit, the
    /// rows of `other`.
    pub(super) fn extends(&self, other: &Self) -> bool {
        let n = other.points();
        let same = |a: &Mat<f64>, b: &Mat<f64>| {
            a.ncols() == b.ncols()
                && a.col_iter().zip(b.col_iter()).all(|(a, b)| a.iter().take(n).eq(b.iter().take(n)))
        };
        self.points() >= n
            && self.correlation == other.correlation
            && self.trend.trend == other.trend.trend
            && (self.shift == other.shift && self.sided == other.sided)
            && self.scaled.subcols(0, n) == other.scaled
            && self.l.submatrix(0, 0, n, n) == other.l
            && same(&self.trend.t, &other.trend.t)
            && same(&self.z, &other.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surrogate::{Correlation, Kernel, Trend};

    #[test]
    fn equals_conditioning_on_all_points_at_once() {
        let x = Mat::from_fn(3, 40, |k, i| ((i + 1) as f64 * [1.3, 2.1, 0.7][k]).sin() * 1.5);
        let y = Mat::from_fn(40, 2, |i, o| 5.0 + x[(0, i)] + x[(1, i)] * x[(2, i)] * (1.0 + o as f64));
        let at = Mat::from_fn(3, 25, |k, i| ((i + 1) as f64 * [0.9, 1.7, 2.3][k]).cos() * 1.5);
        let weights: Vec<f64> = (0..40).map(|i| 0.5 + (i % 3) as f64 / 2.0).collect();
        for (kernel, trend, noisy) in [
            (Kernel::Gaussian, Trend::Constant, false),
            (Kernel::Matern52, Trend::Linear, true),
            (Kernel::Matern32, Trend::Linear, false),
        ] {
            let correlation = Correlation { kernel, theta: vec![0.2, 0.1, 0.3], nugget: 1e-6, stated: 0.01 };
            let weights = noisy.then_some(weights.as_slice());
            let of = |n: usize| {
                let (x, y) = (x.subcols(0, n), y.subrows(0, n));
                Kriging::condition_noisy(x, y, &correlation, trend, weights.map(|w| &w[..n])).unwrap()
            };
            let (whole, start) = (of(40), of(33));
            let step = |model: &Kriging, from: usize, to: usize| {
                let (x, y) = (x.subcols(from, to - from), y.subrows(from, to - from));
                model.extended(x, y, weights.map(|w| &w[from..to])).unwrap()
            };
            let extended = step(&step(&start, 33, 34), 34, 40);
            assert!(extended.extends(&start) && start.extends(&start) && !start.extends(&extended));
            assert!(!whole.extends(&of(33)) || whole.l.submatrix(0, 0, 33, 33) == start.l);
            let (a, b) = (whole.predict(at.as_ref()), extended.predict(at.as_ref()));
            assert!((&a.mean - &b.mean).norm_max() < 1e-9, "{kernel:?}");
            for (a, b) in a.variance_factor.iter().zip(&b.variance_factor) {
                assert!((a - b).abs() < 1e-10, "{kernel:?} {a} {b}");
            }
            for (a, b) in whole.sigma2.iter().zip(&extended.sigma2) {
                assert!((a / b - 1.0).abs() < 1e-8, "{kernel:?} {a} {b}");
            }
        }
    }

    #[test]
    fn a_point_twice_is_refused_without_a_nugget() {
        let x = Mat::from_fn(1, 4, |_, i| i as f64);
        let y = Mat::from_fn(4, 1, |i, _| i as f64);
        let correlation =
            Correlation { kernel: Kernel::Gaussian, theta: vec![1.0], nugget: 0.0, stated: 0.0 };
        let model = Kriging::condition(x.as_ref(), y.as_ref(), &correlation).unwrap();
        let twice = model.extended(x.subcols(1, 1), y.subrows(1, 1), None).unwrap_err();
        assert_eq!(twice, SurrogateError::NotPositiveDefinite { points: 5, pivot: 4, nugget: 0.0 });
    }
}
