//! Leave-one-out errors of a surrogate from its factor alone, without refitting.
//!
//! With S = C^-1 - L'^-1 Q D^-1 Q' L^-1 (C^-1 without the part of the trend), the error of the prediction of
//! point i from all other points, and the variance of that error, are
//!
//!   e_i = (S y)_i / S_ii,   variance_i = sigma2 / S_ii  (simulator noise included).
//!
//! The lengths and sigma2 are those of all points, which makes the figures too favourable; see
//! `cross_validation`.
//!
//! # Source
//! Dubrule (1983), Cross validation of kriging in a unique neighborhood, Mathematical Geology 15; the
//! predictive density: Rasmussen, Williams (2006), Gaussian Processes for Machine Learning, eqs. 5.10 to
//! 5.12.

use super::Kriging;
use super::factor::{inverse_below, solve_lower_transposed};
use super::trend::ratio;
use faer::{ColRef, MatRef};

/// Least predictive variance over the variance of the values [1]: a smaller error is rounding, and an
/// unbounded density would prefer the surrogate with the smallest rounding errors.
pub(super) const ROUNDING: f64 = 1e-24;

/// Leave-one-out figures of one output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeaveOneOut {
    /// Q2 = 1 - sum e_i^2 / sum (y_i - mean)^2 [1]; 1 for an output without variance.
    pub q2: f64,
    /// Mean of e_i^2 over its predicted variance [1]; about 1 if the predicted variances are right.
    pub variance_ratio: f64,
}

/// Prediction of the value of one point from all other points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeftOut {
    /// Mean [unit of the output].
    pub mean: f64,
    /// Standard deviation, simulator noise included [unit of the output].
    pub std: f64,
}

impl Kriging {
    /// Prediction of every point of response `o` from all others `(n,)`; `values` `(n, m)` are those the model was conditioned on,
    /// with two sides `(n, 2 m)`.
    pub fn left_out(&self, values: MatRef<'_, f64>, o: usize) -> Vec<LeftOut> {
        let (dual, sigma2) = (self.dual(), self.sigma2[o]);
        let prediction = |(i, s): (usize, &f64)| LeftOut {
            mean: self.response(o, |o| values[(i, o)] - dual[(i, o)] / s),
            std: (sigma2 / s).sqrt(),
        };
        self.kept_precision().iter().enumerate().map(prediction).collect()
    }

    /// Response `o` from its value, or from those of its two sides.
    fn response(&self, o: usize, value: impl Fn(usize) -> f64) -> f64 {
        if self.sided { value(o).max(value(o + self.sigma2.len())) } else { value(o) }
    }

    /// Leave-one-out figures per response `(m,)`; `values` `(n, m)` are those the model was conditioned on, with two sides
    /// `(n, 2 m)`.
    pub fn leave_one_out(&self, values: MatRef<'_, f64>) -> Vec<LeaveOneOut> {
        let n = self.points();
        let (kept, dual) = (self.kept_precision(), self.dual());
        let of_response = |o: usize| {
            let column: Vec<f64> = (0..n).map(|i| self.response(o, |o| values[(i, o)])).collect();
            let total = spread(ColRef::from_slice(&column)) * n as f64;
            if total == 0.0 || self.sigma2[o] == 0.0 {
                return LeaveOneOut { q2: 1.0, variance_ratio: 1.0 };
            }
            let (mut squares, mut ratio) = (0.0, 0.0);
            for (i, s) in kept.iter().enumerate() {
                let error = if self.sided {
                    column[i] - self.response(o, |o| values[(i, o)] - dual[(i, o)] / s)
                } else {
                    dual[(i, o)] / s
                };
                squares += error * error;
                ratio += error * error * s / (self.sigma2[o] * n as f64);
            }
            LeaveOneOut { q2: 1.0 - squares / total, variance_ratio: ratio }
        };
        (0..self.sigma2.len()).map(of_response).collect()
    }

    /// Log predictive density [1] of the values of each point left out `(n,)`, mean over the outputs;
    /// `values` `(n, m)` are those the model was conditioned on. Outputs are in units of the standard
    /// deviation of their values; constant outputs are ignored.
    pub fn log_densities(&self, values: MatRef<'_, f64>) -> Vec<f64> {
        let (kept, dual) = (self.kept_precision(), self.dual());
        let mut densities = vec![0.0; self.points()];
        let mut outputs = 0.0;
        for o in 0..values.ncols() {
            let spread = spread(values.col(o));
            if spread == 0.0 {
                continue;
            }
            outputs += 1.0;
            for (i, (density, s)) in densities.iter_mut().zip(&kept).enumerate() {
                let error = dual[(i, o)] / s;
                *density += log_density(error * error, self.sigma2[o] / s, spread);
            }
        }
        densities.iter_mut().for_each(|density| *density = ratio(*density, outputs));
        densities
    }

    /// Diagonal S_ii `(n,)`.
    fn kept_precision(&self) -> Vec<f64> {
        let mut q = self.trend.q.clone();
        solve_lower_transposed(self.l.as_ref(), q.as_mut());
        let c_inverse = inverse_below(self.l.as_ref());
        let by_trend = |i: usize| -> f64 {
            q.row(i).iter().zip(&self.trend.squares).map(|(q, square)| ratio(q * q, *square)).sum()
        };
        (0..self.points()).map(|i| c_inverse[(i, i)] - by_trend(i)).collect()
    }
}

/// Log predictive density [1] of a value with the squared error `square` and the predicted `variance`, in
/// units of the standard deviation sqrt(`spread`) of all values.
pub(super) fn log_density(square: f64, variance: f64, spread: f64) -> f64 {
    let variance = variance / spread + ROUNDING;
    -0.5 * ((std::f64::consts::TAU * variance).ln() + square / (spread * variance))
}

/// Variance of values `(n,)`, sum (y - mean)^2 / n.
pub(super) fn spread(values: faer::ColRef<'_, f64>) -> f64 {
    let n = values.nrows() as f64;
    let mean = values.iter().sum::<f64>() / n;
    values.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / n
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surrogate::{Correlation, Kernel, Trend};
    use faer::Mat;

    #[test]
    fn equals_leaving_each_point_out_in_turn() {
        for (kernel, trend) in [
            (Kernel::Gaussian, Trend::Constant),
            (Kernel::Matern52, Trend::Linear),
            (Kernel::Matern32, Trend::Linear),
        ] {
            compare_with_refits(kernel, trend);
        }
    }

    fn compare_with_refits(kernel: Kernel, trend: Trend) {
        let n = 18;
        let x = Mat::from_fn(2, n, |k, i| (i as f64 * [1.3, 2.1][k]).sin() * 1.5);
        let y = Mat::from_fn(n, 1, |i, _| (2.0 * x[(0, i)]).sin() + x[(1, i)] * x[(1, i)]);
        let correlation = Correlation { kernel, theta: vec![0.4, 0.4], nugget: 1e-4, stated: 0.02 };
        let weights: Vec<f64> = (0..n).map(|i| 0.5 + (i % 2) as f64).collect();
        let model =
            Kriging::condition_noisy(x.as_ref(), y.as_ref(), &correlation, trend, Some(&weights)).unwrap();
        assert_eq!(model.trend(), trend);
        let densities = model.log_densities(y.as_ref());
        let spread = spread(y.col(0));
        let predicted = model.left_out(y.as_ref(), 0);
        let mut squares = 0.0;
        for out in 0..n {
            let keep: Vec<usize> = (0..n).filter(|i| *i != out).collect();
            let xs = Mat::from_fn(2, n - 1, |k, i| x[(k, keep[i])]);
            let ys = Mat::from_fn(n - 1, 1, |i, _| y[(keep[i], 0)]);
            let kept: Vec<f64> = keep.iter().map(|i| weights[*i]).collect();
            let reduced =
                Kriging::condition_noisy(xs.as_ref(), ys.as_ref(), &correlation, trend, Some(&kept)).unwrap();
            let at = Mat::from_fn(2, 1, |k, _| x[(k, out)]);
            let prediction = reduced.predict(at.as_ref());
            let error = prediction.mean[(0, 0)] - y[(out, 0)];
            squares += error * error;
            // The process variance is that of all points; the noise is in the left-out value too.
            let noise = correlation.nugget + correlation.stated * weights[out];
            let variance = model.sigma2[0] * (prediction.variance_factor[0] + noise);
            let LeftOut { mean, std } = predicted[out];
            assert!((mean - prediction.mean[(0, 0)]).abs() < 1e-8, "{kernel:?} {out}: {mean}");
            assert!((std - variance.sqrt()).abs() < 1e-8, "{kernel:?} {out}: {std}");
            let density = -0.5 * ((std::f64::consts::TAU * variance).ln() + error * error / variance)
                + 0.5 * spread.ln();
            assert!(
                (densities[out] - density).abs() < 1e-6,
                "{kernel:?} {out}: {density} {}",
                densities[out]
            );
        }
        let q2 = model.leave_one_out(y.as_ref())[0].q2;
        assert!((q2 - (1.0 - squares / (spread * n as f64))).abs() < 1e-8, "{kernel:?} {q2}");
    }
}
