//! The mean of a surrogate as plain numbers, so that other programs can predict with it:
//!
//!   mean_o(x) = trend_o (1, z_1 .. z_d)' + sum over i of weights_oi R(|f z - p_i|^2),
//!
//! with the standardised point z, factors f = sqrt(theta), the scaled points p_i of the data and the correlation function R of the
//! [`super::Kernel`], a function of the squared distance.
//!
//! # Source
//! Sacks, Welch, Mitchell, Wynn (1989), Design and analysis of computer experiments, Statistical Science 4(4), eq. 7, in the dual form.

use super::Kriging;
use serde::{Deserialize, Serialize};

/// Numbers of the predicted means of m outputs over n points in d variables.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExplicitMean {
    /// Name of the correlation function.
    pub kernel: String,
    /// Factors of the standardised coordinates `(d,)` [1].
    pub factors: Vec<f64>,
    /// Points of the data times these factors `(n)(d,)` [1].
    pub points: Vec<Vec<f64>>,
    /// Coefficients of the trend, of 1 and with a linear trend of every coordinate `(m)(p,)` [unit of the output].
    pub trend: Vec<Vec<f64>>,
    /// Weights of the correlations with the data `(m)(n,)` [unit of the output].
    pub weights: Vec<Vec<f64>>,
}

impl Kriging {
    /// The means of these outputs as numbers; of a model of two sides the outputs are those of the sides.
    pub fn explicit_mean(&self, outputs: &[usize]) -> ExplicitMean {
        let (dual, slopes) = (self.dual(), self.trend.in_plain_basis(&self.coefficients));
        let trend = |o: &usize| {
            let shift = std::iter::once(self.shift[*o]).chain(std::iter::repeat(0.0));
            slopes.col_as_slice(*o).iter().zip(shift).map(|(slope, shift)| slope + shift).collect()
        };
        ExplicitMean {
            kernel: self.correlation.kernel.name().to_owned(),
            factors: self.correlation.theta.iter().map(|theta| theta.sqrt()).collect(),
            points: self.scaled.col_iter().map(|point| point.iter().copied().collect()).collect(),
            trend: outputs.iter().map(trend).collect(),
            weights: outputs.iter().map(|o| dual.col_as_slice(*o).to_vec()).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surrogate::{Correlation, Kernel, Trend};
    use faer::Mat;

    #[test]
    fn the_numbers_give_the_means_of_the_model() {
        let x = Mat::from_fn(2, 20, |k, i| ((i + 1) as f64 * [1.3, 2.1][k]).sin() * 1.5);
        let y = Mat::from_fn(20, 2, |i, o| 5.0 + x[(0, i)] + x[(0, i)] * x[(1, i)] * (1.0 + o as f64));
        let at = [0.4, -0.7];
        for trend in [Trend::Constant, Trend::Linear] {
            let correlation =
                Correlation { kernel: Kernel::Matern52, theta: vec![0.2, 0.1], nugget: 1e-6, stated: 0.0 };
            let model = Kriging::condition_noisy(x.as_ref(), y.as_ref(), &correlation, trend, None).unwrap();
            let expected = model.predict(Mat::from_fn(2, 1, |k, _| at[k]).as_ref()).mean[(1, 0)];
            let mean = model.explicit_mean(&[1]);
            let correlate = |point: &Vec<f64>| {
                let distance = |k: usize| mean.factors[k] * at[k] - point[k];
                let mut square = [(0..2).map(|k| distance(k).powi(2)).sum::<f64>()];
                Kernel::Matern52.correlate(&mut square);
                square[0]
            };
            let basis = [1.0, at[0], at[1]];
            let of_trend: f64 = mean.trend[0].iter().zip(basis).map(|(slope, basis)| slope * basis).sum();
            let of_data =
                mean.points.iter().zip(&mean.weights[0]).map(|(p, w)| w * correlate(p)).sum::<f64>();
            assert!((of_trend + of_data - expected).abs() < 1e-9, "{trend:?}");
        }
    }
}
