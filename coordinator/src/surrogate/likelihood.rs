//! Concentrated likelihood of the correlation parameters, with its analytic gradient.
//!
//! For each output o with values y_o, C = R(theta) + nugget I + stated W
//! (W the diagonal of the points' weights, if the simulations state errors), trend beta_o = (1' C^-1 y_o) / (1' C^-1 1), residual
//! r_o = y_o - beta_o 1 and sigma2_o = r_o' C^-1 r_o / n, the value is
//!
//!   f = (1/m) sum_o ln sigma2_o + (1/n) ln det C,
//!
//! that is -2 ln L / n averaged over the m outputs, constants left out. With alpha_o = C^-1 r_o and
//! G = C^-1 - (1/m) sum_o alpha_o alpha_o' / sigma2_o the derivative to any parameter p is (1/n) sum_ij G_ij dC_ij/dp;
//! for ln theta_k it needs sum_ij M_ij (x_ik - x_jk)^2 = 2 sum_i s_i x_ik^2 - 2 x_k' M x_k with M = G o R and s its row
//! sums, so no `(n, n, d)` array is formed.
//!
//! Source: Lophaven, Nielsen, Sondergaard (2002), DACE; Rasmussen, Williams (2006), section 5.4.1.

use super::Correlation;
use super::correlation::correlation_matrix;
use super::factor::{cholesky, inverse, log_determinant, solve_lower, solve_lower_transposed};
use faer::{Mat, MatRef};

/// The data of one likelihood.
#[derive(Debug, Clone, Copy)]
pub struct Likelihood<'a> {
    /// Points in standardised units `(d, n)` [1].
    pub points: MatRef<'a, f64>,
    /// Values `(n, m)`, each column of some variance.
    pub values: MatRef<'a, f64>,
    /// Weights of the points' noise `(n,)`, of mean 1, if the simulations state errors [1].
    pub weights: Option<&'a [f64]>,
}

/// Value and gradient.
#[derive(Debug, Clone, PartialEq)]
pub struct LikelihoodValue {
    /// f, to be minimised.
    pub value: f64,
    /// Derivatives to ln theta_1 .. ln theta_d, to ln nugget and, where there are weights, to ln stated, `(d + 1,)` or
    /// `(d + 2,)`.
    pub gradient: Vec<f64>,
}

impl Likelihood<'_> {
    /// f and its gradient; `None` where C has no Cholesky factor in this arithmetic.
    pub fn evaluate(&self, correlation: &Correlation) -> Option<LikelihoodValue> {
        let (d, n, m) = (self.points.nrows(), self.points.ncols(), self.values.ncols());
        let r = correlation_matrix(correlation, self.points);
        let mut c = r.clone();
        correlation.add_noise(&mut c, self.weights);
        let l = cholesky(c).ok()?;

        // Trend, residual and variance of each output.
        let mut ones = Mat::from_fn(n, 1, |_, _| 1.0);
        solve_lower(l.as_ref(), ones.as_mut());
        let mut alpha = self.values.to_owned();
        solve_lower(l.as_ref(), alpha.as_mut());
        let trend_norm = ones.squared_norm_l2();
        let mut log_variances = 0.0;
        let mut variances = Vec::with_capacity(m);
        let t = ones.col_as_slice(0);
        for o in 0..m {
            let column = alpha.col_as_slice_mut(o);
            let beta = column.iter().zip(t).map(|(y, t)| y * t).sum::<f64>() / trend_norm;
            column.iter_mut().zip(t).for_each(|(y, t)| *y -= beta * t);
            let sigma2 = column.iter().map(|y| y * y).sum::<f64>() / n as f64;
            log_variances += sigma2.ln();
            variances.push(sigma2);
        }
        let value = log_variances / m as f64 + log_determinant(l.as_ref()) / n as f64;

        // G, and from it M = G o R.
        solve_lower_transposed(l.as_ref(), alpha.as_mut());
        let scaled = Mat::from_fn(n, m, |i, o| alpha[(i, o)] / (variances[o] * m as f64).sqrt());
        let mut g = inverse(l.as_ref());
        g -= &scaled * scaled.transpose();
        let trace: f64 = (0..n).map(|i| g[(i, i)]).sum();
        let weighted_trace =
            self.weights.map(|weights| weights.iter().enumerate().map(|(i, w)| w * g[(i, i)]).sum::<f64>());
        for j in 0..n {
            g.col_as_slice_mut(j).iter_mut().zip(r.col_as_slice(j)).for_each(|(g, r)| *g *= r);
        }
        let row_sums: Vec<f64> = g.col_iter().map(|column| column.iter().sum()).collect();
        let mx = &g * self.points.transpose();
        let mut gradient: Vec<f64> = (0..d)
            .map(|k| {
                let moment: f64 = (0..n)
                    .map(|i| {
                        let x = self.points[(k, i)];
                        x * (row_sums[i] * x - mx[(i, k)])
                    })
                    .sum();
                -2.0 * correlation.theta[k] * moment / n as f64
            })
            .collect();
        gradient.push(correlation.nugget * trace / n as f64);
        gradient.extend(weighted_trace.map(|trace| correlation.stated * trace / n as f64));
        (value.is_finite() && gradient.iter().all(|g| g.is_finite()))
            .then_some(LikelihoodValue { value, gradient })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradient_matches_finite_differences() {
        let (d, n, m) = (4, 30, 3);
        let points = Mat::from_fn(d, n, |k, i| ((i * (2 * k + 3)) as f64 * 0.77 + k as f64).sin() * 1.7);
        let values = Mat::from_fn(n, m, |i, o| {
            points[(0, i)] * (1.0 + o as f64)
                + (points[(1, i)] * 1.3).sin()
                + 0.1 * points[(2, i)] * points[(3, i)]
        });
        let weights: Vec<f64> = (0..n).map(|i| 0.2 + 1.6 * (i % 2) as f64).collect();
        let (points, values) = (points.as_ref(), values.as_ref());
        for weights in [None, Some(weights.as_slice())] {
            let likelihood = Likelihood { points, values, weights };
            let at = |p: &[f64]| {
                let theta = p[..d].iter().map(|p| p.exp()).collect();
                likelihood
                    .evaluate(&Correlation { theta, nugget: p[d].exp(), stated: p[d + 1].exp() })
                    .unwrap()
            };
            let p = [-1.0, -0.5, -2.0, -3.0, -6.0, -4.0];
            let analytic = at(&p).gradient;
            assert_eq!(analytic.len(), d + 1 + usize::from(weights.is_some()));
            for (k, analytic) in analytic.into_iter().enumerate() {
                let h = 1e-5;
                let (mut up, mut down) = (p, p);
                up[k] += h;
                down[k] -= h;
                let numeric = (at(&up).value - at(&down).value) / (2.0 * h);
                assert!(
                    (numeric - analytic).abs() < 1e-6 * (1.0 + numeric.abs()),
                    "{k}: {numeric} {analytic}"
                );
                assert!(analytic.abs() > 1e-5, "{k}: {analytic} says nothing");
            }
        }
    }
}
