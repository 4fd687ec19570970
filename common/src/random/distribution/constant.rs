//! A variable with one value: it is held fixed without being removed from a study.
//!
//! P(X = value) = 1: the mean is the value [unit of the variable], the variance 0, all derivatives 0.

use super::law::{Law, LawError, between};
use crate::random::standard::Tail;
use serde::{Deserialize, Serialize};

/// Distribution with one value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Constant {
    value: f64,
}

impl Constant {
    pub(super) fn new(value: f64) -> Result<Self, LawError> {
        Ok(Self { value: between("mean", value, f64::NEG_INFINITY, f64::INFINITY)? })
    }
}

impl Law for Constant {
    /// Infinite at the value, else zero.
    fn pdf(&self, x: f64) -> f64 {
        if x == self.value { f64::INFINITY } else { 0.0 }
    }

    fn probability(&self, x: f64, tail: Tail) -> f64 {
        f64::from(u8::from((x < self.value) == (tail == Tail::Upper)))
    }

    fn at(&self, _: f64, _: Tail) -> f64 {
        self.value
    }

    fn mean_and_std(&self) -> (f64, f64) {
        (self.value, 0.0)
    }

    fn support(&self) -> (f64, f64) {
        (self.value, self.value)
    }

    /// Zero: no density to change.
    fn scores(&self, _: f64) -> [f64; 2] {
        [0.0; 2]
    }

    fn cdf_derivatives(&self, _: f64) -> [f64; 2] {
        [0.0; 2]
    }

    fn to_standard_normal(&self, _: f64) -> f64 {
        0.0
    }
}
