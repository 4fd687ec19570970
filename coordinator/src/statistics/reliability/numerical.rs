//! Range of the reliability under the numerical errors that simulations state: R(n) is counted twice more,
//! with all responses shifted by their stated errors to the unsafe and to the safe side.
//!
//! A stated error is a bound (a value lies within twice of it in 95 % of cases), and neighbouring simulations
//! err alike. So the range is the worst case, all errors at once in the same direction. It is no standard
//! error; more simulations do not narrow it, only finer time and wear steps do.
//!
//! With surrogates the error of a point of the population follows from a straight line through the stated
//! errors e_i over the values y_i at the same checkpoint, by least squares, clamped to the range of the
//! stated errors:
//!
//!   e(y) = mean(e) + slope (y - mean(y)),   slope = sum (y_i - mean(y)) (e_i - mean(e)) / sum (y_i - mean(y))^2.
//!
//! So the error may grow with the response, as that of a growing vibration does.
//!
//! # Source
//! The line is ordinary least squares; the range is this project's own convention.

use crate::statistics::design::Population;
use crate::statistics::learning::curves;
use crate::statistics::surrogate::Kriging;
use faer::MatRef;
use rayon::prelude::*;

/// Number of points predicted together.
const BLOCK: usize = 512;

/// First failures of one limit state with the responses shifted by their errors.
#[derive(Debug, Clone, PartialEq)]
pub struct ShiftedFailures {
    /// Index of the first failure with every response larger by its error `(N,)`.
    pub larger: Vec<u32>,
    /// Index of the first failure with every response smaller by its error `(N,)`.
    pub smaller: Vec<u32>,
}

/// Failure shares with the responses shifted by their errors.
#[derive(Debug, Clone, PartialEq)]
pub struct NumericalBand {
    /// Failure shares with every response smaller `(limit states + 1, m)` [1].
    pub least: Vec<Vec<f64>>,
    /// Failure shares with every response larger `(limit states + 1, m)` [1].
    pub most: Vec<Vec<f64>>,
}

impl NumericalBand {
    /// Counts the shares over m checkpoints from the shifted first failures of every limit state; the system,
    /// last, fails with the first of them, all shifted in the same direction.
    pub fn count(modes: &[ShiftedFailures], m: usize) -> Self {
        let shares =
            |side: fn(&ShiftedFailures) -> &[u32]| curves(&modes.iter().map(side).collect::<Vec<_>>(), m);
        Self { least: shares(|mode| &mode.smaller), most: shares(|mode| &mode.larger) }
    }
}

/// Index of the first checkpoint at which a history `(m,)`, shifted by `sign` times its errors `(m,)`,
/// reaches the threshold; m if never. All values have the unit of the output.
pub fn first_failure_with(history: &[f64], errors: &[f64], sign: f64, threshold: f64) -> u32 {
    let failed = history.iter().zip(errors).position(|(value, error)| value + sign * error >= threshold);
    u32::try_from(failed.unwrap_or(history.len())).expect("a life has fewer than 2^32 checkpoints")
}

/// Stated error as a straight line over the value, clamped to [least, most].
#[derive(Debug, Clone, Copy, PartialEq)]
struct ErrorLine {
    centre: f64,
    mean: f64,
    slope: f64,
    least: f64,
    most: f64,
}

impl ErrorLine {
    /// The least-squares line through pairs of value and error; constant without any spread of the values.
    fn fit(pairs: &[(f64, f64)]) -> Self {
        let n = pairs.len().max(1) as f64;
        let centre = pairs.iter().map(|(y, _)| y).sum::<f64>() / n;
        let mean = pairs.iter().map(|(_, e)| e).sum::<f64>() / n;
        let square: f64 = pairs.iter().map(|(y, _)| (y - centre).powi(2)).sum();
        let product: f64 = pairs.iter().map(|(y, e)| (y - centre) * (e - mean)).sum();
        let slope = if square > 0.0 { product / square } else { 0.0 };
        let least = pairs.iter().map(|(_, e)| *e).fold(mean, f64::min);
        let most = pairs.iter().map(|(_, e)| *e).fold(mean, f64::max);
        Self { centre, mean, slope, least, most }
    }

    /// Error at a value [unit of the output].
    fn evaluate(&self, value: f64) -> f64 {
        (self.mean + self.slope * (value - self.centre)).clamp(self.least, self.most)
    }
}

/// First failures of the population by a model whose m outputs are the checkpoints of one limit state, with
/// the predicted means shifted by the errors `(n, m)` stated for the values `(n, m)` of the simulations.
pub fn shift_population(
    model: &Kriging,
    population: &Population,
    values: MatRef<'_, f64>,
    errors: MatRef<'_, f64>,
    threshold: f64,
) -> ShiftedFailures {
    let m = values.ncols();
    let pairs = |n: usize| -> Vec<(f64, f64)> {
        (0..values.nrows()).map(|i| (values[(i, n)], errors[(i, n)])).collect()
    };
    let lines: Vec<ErrorLine> = (0..m).map(|n| ErrorLine::fit(&pairs(n))).collect();
    let dual = model.dual();
    let blocks: Vec<usize> = (0..population.len()).step_by(BLOCK).collect();
    let by_block = |start: usize| -> Vec<(u32, u32)> {
        let means =
            model.predict_means(population.columns(start..population.len().min(start + BLOCK)), &dual, 0..m);
        let mut errors = vec![0.0; m];
        let first_failures = |j: usize| {
            let history = means.col_as_slice(j);
            errors.iter_mut().zip(&lines).zip(history).for_each(|((e, line), y)| *e = line.evaluate(*y));
            let with = |sign| first_failure_with(history, &errors, sign, threshold);
            (with(1.0), with(-1.0))
        };
        (0..means.ncols()).map(first_failures).collect()
    };
    let (larger, smaller) =
        blocks.into_par_iter().map(by_block).collect::<Vec<_>>().into_iter().flatten().unzip();
    ShiftedFailures { larger, smaller }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::surrogate::{Correlation, Kernel};
    use common::random::{Distribution, standard_normal_cdf};
    use faer::Mat;

    #[test]
    fn a_line_follows_the_errors_and_stays_among_them() {
        let line = ErrorLine::fit(&[(0.0, 0.1), (1.0, 0.3), (2.0, 0.5), (3.0, 0.7)]);
        assert!((line.evaluate(1.5) - 0.4).abs() < 1e-15 && (line.evaluate(2.5) - 0.6).abs() < 1e-15);
        assert_eq!((line.evaluate(-9.0), line.evaluate(9.0)), (0.1, 0.7));
        let alike = ErrorLine::fit(&[(5.0, 0.2), (5.0, 0.4)]);
        assert!((alike.evaluate(7.0) - 0.3).abs() < 1e-15);
    }

    #[test]
    fn a_linear_response_is_shifted_by_its_error() {
        // One standard normal variable, response z + n at checkpoints n = 0, 1, 2, limit 1, error 0.5:
        // P_f = Phi(n - 1 +- 0.5).
        let normal = Distribution::truncated_normal(0.0, 1.0, -8.0, 8.0).unwrap();
        let population = Population::draw(&[normal], 40_000, 1);
        let x = Mat::from_fn(1, 30, |_, i| population.standardised(i)[0]);
        let y = Mat::from_fn(30, 3, |i, n| x[(0, i)] + n as f64);
        let correlation =
            Correlation { kernel: Kernel::Gaussian, theta: vec![1e-3], nugget: 1e-10, stated: 0.0 };
        let model = Kriging::condition(x.as_ref(), y.as_ref(), &correlation).unwrap();
        let errors = Mat::from_fn(30, 3, |_, _| 0.5);
        let shifted = shift_population(&model, &population, y.as_ref(), errors.as_ref(), 1.0);
        // A second limit state that never fails changes nothing in the system.
        let never = ShiftedFailures { larger: vec![3; 40_000], smaller: vec![3; 40_000] };
        let band = NumericalBand::count(&[shifted, never], 3);
        for n in 0..3 {
            for (shares, sign) in [(&band.most, 0.5), (&band.least, -0.5)] {
                let expected = standard_normal_cdf(n as f64 - 1.0 + sign);
                // Four standard errors of a share of 40 000.
                assert!(
                    (shares[0][n] - expected).abs() < 4.0 * 0.5 / 200.0,
                    "{n} {} {expected}",
                    shares[0][n]
                );
                assert_eq!((shares[2][n], shares[1][n]), (shares[0][n], 0.0));
            }
        }
    }

    #[test]
    fn a_failure_stays_though_the_error_shrinks() {
        let (history, errors) = ([1.0, 1.1, 1.2], [0.5, 0.0, 0.0]);
        assert_eq!(first_failure_with(&history, &errors, 1.0, 1.5), 0);
        assert_eq!(first_failure_with(&history, &errors, -1.0, 1.15), 2);
        assert_eq!(first_failure_with(&history, &errors, -1.0, 2.0), 3);
    }
}
