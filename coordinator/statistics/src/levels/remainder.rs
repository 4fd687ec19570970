//! What the finer level leaves, by a third one at few points.
//!
//! With the mean difference a from the first to the second level, and b from the second to the third, at the same points, each level
//! refined by the same factor,
//!
//!   q = b / a,   r = b + b q / (1 - q)   if 0 < q <= 1/2,   r = b   otherwise:
//!
//! a geometric series, half of whose sum beyond the third level is a standard deviation, and to it come the errors s of a and b, by
//! dr = (db - q^2 da) / (1 - q)^2, which share the second level: (s_b + q^2 s_a) / (1 - q)^2. Where the levels do not converge like
//! that, r is as uncertain as b itself. The observed order of convergence under halving is -log2(q). Without a third level r = 0, with a
//! standard deviation of |a| / 3: what a method of second order leaves.
//!
//! # Source
//! Roache (1994), Perspective: a method for uniform reporting of grid refinement studies, Journal of Fluids Engineering 116(3).

use super::difference::{Difference, DifferenceForm};

/// Largest ratio of successive differences that counts as convergence [1].
const CONVERGES: f64 = 0.5;

/// What the finer level leaves at one checkpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Remainder {
    /// Estimate [unit of the output].
    pub mean: f64,
    /// Its standard deviation [unit of the output].
    pub std: f64,
    /// The part of it that more points at the third level reduce [unit of the output].
    pub of_points: f64,
    /// Observed order of convergence under halving [1]; `None` without a third level, or without convergence.
    pub order: Option<f64>,
}

impl Remainder {
    /// The remainder by the `coarse` differences from the first to the second level and the `fine` ones from the second to the third, at
    /// the same points, and by the mean difference `known` of all pairs, which counts without a third level [unit of the output].
    pub fn new(coarse: &[f64], fine: &[f64], known: f64) -> Self {
        if fine.is_empty() || coarse.len() != fine.len() {
            return Self { mean: 0.0, std: known.abs() / 3.0, of_points: 0.0, order: None };
        }
        let mean = |differences: &[f64]| {
            let pairs: Vec<(f64, f64)> = differences.iter().map(|difference| (0.0, *difference)).collect();
            let difference = Difference::fit(&pairs, DifferenceForm::Constant);
            (difference.at(0.0), difference.std_at(0.0))
        };
        let ((a, of_a), (b, scatter)) = (mean(coarse), mean(fine));
        let ratio = b / a;
        if ratio > 0.0 && ratio <= CONVERGES {
            let beyond = b * ratio / (1.0 - ratio);
            let of_points = (scatter + ratio * ratio * of_a) / (1.0 - ratio).powi(2);
            let std = of_points.hypot(0.5 * beyond);
            return Self { mean: b + beyond, std, of_points, order: Some(-ratio.log2()) };
        }
        // No difference at all, or none that falls.
        Self { mean: b, std: scatter.hypot(b), of_points: scatter, order: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_geometric_series_is_summed() {
        // Errors of 16, 4 and 1: differences of 12 and 3; the second level leaves 4.
        let found = Remainder::new(&[12.0; 3], &[3.0; 3], 12.0);
        assert!((found.mean - 4.0).abs() < 1e-14 && (found.std - 0.5).abs() < 1e-14);
        assert!((found.order.unwrap() - 2.0).abs() < 1e-14);
    }

    #[test]
    fn the_error_of_the_ratio_is_in_that_of_the_sum() {
        // Three points each: errors of the means 4.303 / 1.96 / sqrt(3) times the spreads 1.2 and 0.3; q = 1/4.
        let found = Remainder::new(&[10.8, 12.0, 13.2], &[2.7, 3.0, 3.3], 12.0);
        let of_means = 4.303 / 1.96 / 3f64.sqrt();
        let expected = of_means * (0.3 + 1.2 / 16.0) / 0.75f64.powi(2);
        assert!((found.of_points / expected - 1.0).abs() < 1e-3, "{found:?}");
    }

    #[test]
    fn levels_that_do_not_converge_are_as_uncertain_as_their_difference() {
        for (fine, std) in [(9.0, 9.0), (-3.0, 3.0), (0.0, 0.0)] {
            let found = Remainder::new(&[12.0; 3], &[fine; 3], 12.0);
            assert_eq!(found, Remainder { mean: fine, std, of_points: 0.0, order: None });
        }
        let without = Remainder { mean: 0.0, std: 2.0, of_points: 0.0, order: None };
        assert_eq!(Remainder::new(&[], &[], -6.0), without);
        assert_eq!(Remainder::new(&[0.0; 3], &[0.0; 3], 0.0).std, 0.0);
    }
}
