//! The reliability during a study and at its end, as rows of the summary.

use crate::results::summary::{PerLimitState, ReliabilityRange, ReliabilityRow};
use crate::statistics::reliability::{Condition, CurvePoint, half_width, reliability_curve};
use std::collections::BTreeMap;

/// Failure shares with the errors known for them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct InterimResult {
    /// Failure shares `(limit states + 1, m)`, the system last [1].
    pub failed: Vec<Vec<f64>>,
    /// Number of samples counted.
    pub points: usize,
    /// Share of all samples that have no result and are not counted, or of the population that surrogates predict though it cannot be
    /// simulated [1].
    pub missing: f64,
    /// Surrogate error with simulator noise [1] per curve, at ascending checkpoints; empty without
    /// surrogates.
    pub surrogate: Vec<Vec<(usize, f64)>>,
    /// The event the samples are conditional on.
    pub condition: Condition,
}

impl InterimResult {
    /// R(n) with its standard error, per curve `(limit states + 1)(m,)`.
    pub fn curves(&self) -> Vec<Vec<CurvePoint>> {
        let none = Vec::new();
        let curve = |(c, failed): (usize, &Vec<f64>)| {
            let surrogate = self.surrogate.get(c).unwrap_or(&none);
            let curve = reliability_curve(failed, self.points, surrogate, &self.condition);
            curve.into_iter().map(|point| point.with_missing(self.missing)).collect()
        };
        self.failed.iter().enumerate().map(curve).collect()
    }

    /// One row per checkpoint `(m,)`, without the numerical range. `names` are the names of the curves,
    /// `cycles` `(m,)` the checkpoints [cycles].
    pub fn rows(&self, names: &[String], cycles: &[u32]) -> Vec<ReliabilityRow> {
        let curves = self.curves();
        let row = |(n, cycles): (usize, &u32)| {
            let value = |of: fn(&CurvePoint) -> f64| -> PerLimitState {
                names.iter().zip(&curves).map(|(name, curve)| (name.clone(), of(&curve[n]))).collect()
            };
            let interval = |(c, name): (usize, &String)| (name.clone(), self.interval(c, n, &curves[c][n]));
            ReliabilityRow {
                interval: names.iter().enumerate().map(interval).collect(),
                cycles: *cycles,
                reliability: value(|point| point.reliability),
                standard_error: value(|point| point.standard_error),
                numerical: BTreeMap::new(),
            }
        };
        cycles.iter().enumerate().map(row).collect()
    }
    /// 95 % interval of R at checkpoint `n` of curve `c`.
    fn interval(&self, c: usize, n: usize, point: &CurvePoint) -> ReliabilityRange {
        let width = half_width(self.failed[c][n], point, self.points, &self.condition);
        let (r, width) = (point.reliability, self.condition.probability * width);
        ReliabilityRange { lower: (r - width).max(0.0), upper: (r + width).min(1.0) }
    }
}
