//! Largest and smallest value of a sequence; NaN is ignored.

/// Largest value, and not below zero: zero for an empty sequence.
pub(crate) fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, f64::max)
}

/// Smallest value; infinite for an empty sequence.
pub(crate) fn smallest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(f64::INFINITY, f64::min)
}
