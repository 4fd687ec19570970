//! The reliability during a study and at its end, as rows of the summary.

use super::untested::Untested;
use super::{Assessment, Campaign};
use crate::results::reliability_summary::ErrorParts;
use crate::results::summary::{PerLimitState, ReliabilityRange, ReliabilityRow, UntestedRow};
use crate::statistics::reliability::{
    Condition, CurvePoint, half_width, reliability_curve, surrogate_error_at,
};
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
    /// Curves whose failures no simulation has tested.
    pub untested: Untested,
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

    /// One row per checkpoint `(m,)`, without the numerical error. `names` are the names of the curves,
    /// `cycles` `(m,)` the checkpoints [cycles].
    pub fn rows(&self, names: &[String], cycles: &[u32]) -> Vec<ReliabilityRow> {
        let curves = self.curves();
        let row = |(n, cycles): (usize, &u32)| {
            let value = |of: fn(&CurvePoint) -> f64| -> PerLimitState {
                names.iter().zip(&curves).map(|(name, curve)| (name.clone(), of(&curve[n]))).collect()
            };
            let interval = |(c, name): (usize, &String)| (name.clone(), self.interval(c, n, &curves));
            let parts = |(c, name): (usize, &String)| (name.clone(), self.parts(c, n, &curves[c][n]));
            ReliabilityRow {
                parts: names.iter().enumerate().map(parts).collect(),
                interval: names.iter().enumerate().map(interval).collect(),
                cycles: *cycles,
                reliability: value(|point| point.reliability),
                standard_error: value(|point| point.standard_error),
                numerical: BTreeMap::new(),
            }
        };
        cycles.iter().enumerate().map(row).collect()
    }

    /// Parts of the standard error of R at checkpoint `n` of curve `c`, whose point is `point`.
    fn parts(&self, c: usize, n: usize, point: &CurvePoint) -> ErrorParts {
        let of_share = self.surrogate.get(c).map_or(0.0, |errors| surrogate_error_at(n, errors));
        let surrogate = (self.condition.probability * of_share).min(point.standard_error);
        let sampling = (point.standard_error.powi(2) - surrogate.powi(2)).max(0.0).sqrt();
        ErrorParts { sampling, surrogate, numerical: 0.0 }
    }

    /// 95 % interval of R at checkpoint `n` of curve `c`.
    fn interval(&self, c: usize, n: usize, curves: &[Vec<CurvePoint>]) -> ReliabilityRange {
        let predicted = self.predicted(c, n, curves);
        let system = curves.len() - 1;
        let of_system = if c == system { predicted } else { self.interval(system, n, curves) };
        let possible = self.untested.possible(c, 1.0 - of_system.lower);
        let lower = possible.map_or(predicted.lower, |pf| predicted.lower.min(1.0 - pf));
        ReliabilityRange { lower, ..predicted }
    }

    /// 95 % interval of R by the surrogates, whether simulations have tested it or not.
    fn predicted(&self, c: usize, n: usize, curves: &[Vec<CurvePoint>]) -> ReliabilityRange {
        let point = &curves[c][n];
        let width = half_width(self.failed[c][n], point, self.points, &self.condition);
        let (r, width) = (point.reliability, self.condition.probability * width);
        ReliabilityRange { lower: (r - width).max(0.0), upper: (r + width).min(1.0) }
    }

    /// The curves that no simulation has tested, by `names`, for the summary; `None` without any.
    pub fn untested_row(&self, names: &[String]) -> Option<UntestedRow> {
        let curves = names.iter().enumerate().filter_map(|(c, name)| self.untested.bound(c).map(|_| name));
        let curves: Vec<String> = curves.cloned().collect();
        let bound = (0..names.len()).find_map(|c| self.untested.bound(c))?;
        let (system, last) = (names.len() - 1, self.failed[0].len() - 1);
        let predicted = 1.0 - self.predicted(system, last, &self.curves()).lower;
        Some(UntestedRow { curves, samples: self.untested.samples, bound, predicted })
    }
}

impl Campaign {
    /// The reliability after the last round, if no outcome was recorded since.
    pub(super) fn interim(&self) -> Option<InterimResult> {
        let assessment = self.assessment.as_ref()?;
        Some(InterimResult {
            failed: assessment.curves.clone(),
            points: self.classified.population.len(),
            missing: assessment.feasibility.barred_share(self.classified.unconditional()),
            surrogate: assessment.combined_errors(),
            condition: self.classified.condition,
            untested: self.untested(assessment),
        })
    }

    /// Curves whose failures no simulation has tested.
    fn untested(&self, assessment: &Assessment) -> Untested {
        let probability = self.classified.condition.probability;
        let pf = |curve: &Vec<f64>| probability * curve.last().copied().unwrap_or(0.0);
        let pf: Vec<f64> = assessment.curves.iter().map(pf).collect();
        Untested::new(&self.problem, &self.data.observations, &pf, self.plan.settings.initial)
    }
}
