//! What is known of the reliability while a study runs, and the rows in which it is told then and at the end.

use crate::results::summary::{PerLimitState, ReliabilityRow};
use crate::statistics::reliability::{Condition, CurvePoint, reliability_curve};
use std::collections::BTreeMap;

/// Failure shares and how far they can be trusted.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SoFar {
    /// `(limit states + 1, m)`, the system last.
    pub failed: Vec<Vec<f64>>,
    /// Samples counted.
    pub points: usize,
    /// Surrogate error and simulator noise per curve, at ascending checkpoints; empty without surrogates.
    pub surrogate: Vec<Vec<(usize, f64)>>,
    /// What the samples are conditional on.
    pub condition: Condition,
}

impl SoFar {
    /// One row per checkpoint, without the numerical range; `names` are those of the curves.
    pub fn rows(&self, names: &[String], cycles: &[u32]) -> Vec<ReliabilityRow> {
        let none = Vec::new();
        let curves: Vec<Vec<CurvePoint>> = self
            .failed
            .iter()
            .enumerate()
            .map(|(c, failed)| {
                let surrogate = self.surrogate.get(c).unwrap_or(&none);
                reliability_curve(failed, self.points, surrogate, &self.condition)
            })
            .collect();
        let row = |(n, cycles): (usize, &u32)| {
            let value = |of: fn(&CurvePoint) -> f64| -> PerLimitState {
                names.iter().zip(&curves).map(|(name, curve)| (name.clone(), of(&curve[n]))).collect()
            };
            ReliabilityRow {
                cycles: *cycles,
                reliability: value(|point| point.reliability),
                standard_error: value(|point| point.standard_error),
                numerical: BTreeMap::new(),
            }
        };
        cycles.iter().enumerate().map(row).collect()
    }
}
