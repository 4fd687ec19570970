//! A response that is the larger of two: the distance of an output from a middle, largest over a life.
//!
//!   |y - c| = max(y - c, c - y)
//!
//! has a kink where y passes c, and its largest value so far another one where the side of the largest changes, which no
//! correlation of smooth functions fits. Its two sides, the largest y - c and the largest c - y so far, are as smooth as
//! y. So a surrogate learns both with one correlation, in 2 m outputs: the first side at all m checkpoints, then the second.
//! Its prediction is the larger of the two means, with the larger of the two process variances.
//!
//! # Source
//! Derived here. The error of the larger of two predictions is at most the larger of their errors.

use faer::Mat;

/// The larger of the two means per output `(m, b)`, from those of both sides `(2 m, b)`.
pub(super) fn larger_means(both: &Mat<f64>) -> Mat<f64> {
    let m = both.nrows() / 2;
    Mat::from_fn(m, both.ncols(), |o, j| both[(o, j)].max(both[(o + m, j)]))
}

/// The larger of the two variances per output `(m,)`, from those of both sides `(2 m,)`.
pub(super) fn larger_variances(both: &[f64]) -> Vec<f64> {
    let (first, second) = both.split_at(both.len() / 2);
    first.iter().zip(second).map(|(a, b)| a.max(*b)).collect()
}
