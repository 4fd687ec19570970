//! Leave-one-out check of a surrogate from its factor alone, without refitting.
//!
//! With Q = C^-1 - C^-1 1 1' C^-1 / (1' C^-1 1), leaving point i out changes the prediction there by
//! e_i = (Q y)_i / Q_ii, with variance sigma2 / Q_ii (simulator noise included).
//!
//! Source: Dubrule (1983), Cross validation of kriging in a unique neighborhood.

use super::Kriging;
use super::factor::{inverse, solve_lower_transposed};

/// Leave-one-out figures of one output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeaveOneOut {
    /// Q2 = 1 - sum e_i^2 / sum (y_i - mean)^2 [1]; 1 for an output without variance.
    pub q2: f64,
    /// Mean of e_i^2 over its predicted variance [1]; 1 if the predicted variances are right.
    pub variance_ratio: f64,
}

impl Kriging {
    /// Leave-one-out figures per output `(m,)`, for the values `(n, m)` the model was conditioned on.
    pub fn leave_one_out(&self, values: faer::MatRef<'_, f64>) -> Vec<LeaveOneOut> {
        let n = self.points();
        let mut t = self.t.clone();
        solve_lower_transposed(self.l.as_ref(), t.as_mut());
        let c_inverse = inverse(self.l.as_ref());
        let q_diagonal: Vec<f64> =
            (0..n).map(|i| c_inverse[(i, i)] - t[(i, 0)] * t[(i, 0)] / self.tt).collect();
        let qy = self.dual();
        (0..values.ncols())
            .map(|o| {
                let column = values.col(o);
                let mean = column.iter().sum::<f64>() / n as f64;
                let total: f64 = column.iter().map(|y| (y - mean).powi(2)).sum();
                if total == 0.0 || self.sigma2()[o] == 0.0 {
                    return LeaveOneOut { q2: 1.0, variance_ratio: 1.0 };
                }
                let (mut squares, mut ratio) = (0.0, 0.0);
                for (i, q) in q_diagonal.iter().enumerate() {
                    let error = qy[(i, o)] / q;
                    squares += error * error;
                    ratio += error * error * q / (self.sigma2()[o] * n as f64);
                }
                LeaveOneOut { q2: 1.0 - squares / total, variance_ratio: ratio }
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surrogate::Correlation;
    use faer::Mat;

    #[test]
    fn equals_leaving_each_point_out_in_turn() {
        let n = 18;
        let x = Mat::from_fn(2, n, |k, i| (i as f64 * [1.3, 2.1][k]).sin() * 1.5);
        let y = Mat::from_fn(n, 1, |i, _| (2.0 * x[(0, i)]).sin() + x[(1, i)] * x[(1, i)]);
        let correlation = Correlation { theta: vec![0.4, 0.4], nugget: 1e-4, stated: 0.02 };
        let weights: Vec<f64> = (0..n).map(|i| 0.5 + (i % 2) as f64).collect();
        let model = Kriging::condition_noisy(x.as_ref(), y.as_ref(), &correlation, Some(&weights)).unwrap();
        let mut squares = 0.0;
        for out in 0..n {
            let keep: Vec<usize> = (0..n).filter(|i| *i != out).collect();
            let xs = Mat::from_fn(2, n - 1, |k, i| x[(k, keep[i])]);
            let ys = Mat::from_fn(n - 1, 1, |i, _| y[(keep[i], 0)]);
            let kept: Vec<f64> = keep.iter().map(|i| weights[*i]).collect();
            let reduced =
                Kriging::condition_noisy(xs.as_ref(), ys.as_ref(), &correlation, Some(&kept)).unwrap();
            let at = Mat::from_fn(2, 1, |k, _| x[(k, out)]);
            squares += (reduced.predict(at.as_ref()).mean[(0, 0)] - y[(out, 0)]).powi(2);
        }
        let mean = y.col(0).iter().sum::<f64>() / n as f64;
        let total: f64 = y.col(0).iter().map(|y| (y - mean).powi(2)).sum();
        let q2 = model.leave_one_out(y.as_ref())[0].q2;
        assert!((q2 - (1.0 - squares / total)).abs() < 1e-8, "{q2}");
    }
}
