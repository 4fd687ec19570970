//! Range of the reliability under the numerical errors of the simulations: R(n) is counted twice more, with all responses
//! shifted by their errors to the unsafe and to the safe side.
//!
//! The numerical error of neighbouring simulations is alike, so it moves all responses together. It is 1.96 standard deviations of the
//! correction by pairs of levels, see [`super::super::levels`], or without pairs the error that the simulations state, which is larger
//! than nearly all true ones. The range enters the interval of R(n) as an independent part of it, on either side.
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

use faer::MatRef;

/// Failure shares with the responses shifted by their errors.
#[derive(Debug, Clone, PartialEq)]
pub struct NumericalBand {
    /// Failure shares with every response smaller `(limit states + 1, m)` [1].
    pub least: Vec<Vec<f64>>,
    /// Failure shares with every response larger `(limit states + 1, m)` [1].
    pub most: Vec<Vec<f64>>,
}

/// Stated error as a straight line over the value, clamped to [least, most].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorLine {
    centre: f64,
    mean: f64,
    slope: f64,
    least: f64,
    most: f64,
}

impl ErrorLine {
    /// The least-squares line through pairs of value and error; constant without any spread of the values.
    pub fn fit(pairs: &[(f64, f64)]) -> Self {
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

    /// The lines at each checkpoint `(m,)` through values and their errors `(n, m)`.
    pub fn by_checkpoint(values: MatRef<'_, f64>, errors: MatRef<'_, f64>) -> Vec<Self> {
        let pairs = |k: usize| values.col(k).iter().copied().zip(errors.col(k).iter().copied());
        (0..values.ncols()).map(|k| Self::fit(&pairs(k).collect::<Vec<_>>())).collect()
    }

    /// Error at a value [unit of the output].
    pub fn evaluate(&self, value: f64) -> f64 {
        (self.mean + self.slope * (value - self.centre)).clamp(self.least, self.most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_follows_the_errors_and_stays_among_them() {
        let line = ErrorLine::fit(&[(0.0, 0.1), (1.0, 0.3), (2.0, 0.5), (3.0, 0.7)]);
        assert!((line.evaluate(1.5) - 0.4).abs() < 1e-15 && (line.evaluate(2.5) - 0.6).abs() < 1e-15);
        assert_eq!((line.evaluate(-9.0), line.evaluate(9.0)), (0.1, 0.7));
        let alike = ErrorLine::fit(&[(5.0, 0.2), (5.0, 0.4)]);
        assert!((alike.evaluate(7.0) - 0.3).abs() < 1e-15);
    }
}
