//! The reliability during a study and at its end, as rows of the summary.
//!
//! Whether simulations have tested the failure probability that surrogates state, and the bound that simulations alone support
//! where none has.
//!
//! A failure probability P of a limit state, or of the system, has been tested if at least one simulation failed where failures
//! of that probability lie: in independent standard normals u, at a point with
//!
//!   P(|U| > |u|) >= P / 1000.
//!
//! What fails farther out than that is no sign of the failures that make up P, and a surrogate that predicts none at all only
//! repeats what it has learned from results without failures. Then the independent samples of the initial design are all that is
//! known: of n without a failure,
//!
//!   P < 1 - 0.05^(1/n)   with a confidence of 95 %.
//!
//! A limit state fails no more often than the system, whose interval bounds it, too.
//!
//! # Source
//! Clopper, Pearson (1934), The use of confidence or fiducial limits illustrated in the case of the binomial, Biometrika 26(4). The
//! share of a thousand is this project's own choice: a region beyond it has no part in three digits of P.

use super::observations::Observations;
use super::plan::Problem;
use super::{Assessment, Campaign};
use crate::results::reliability_summary::ErrorParts;
use crate::results::summary::{PerLimitState, ReliabilityRange, ReliabilityRow, UntestedRow};
use crate::statistics::learning::Mode;
use crate::statistics::reliability::{
    Condition, CurvePoint, half_width, reliability_curve, surrogate_error_at,
};
use statrs::distribution::{ChiSquared, ContinuousCDF};
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

    /// 95 % interval of R of the system at the checkpoints `(m,)`, without the numerical error.
    pub fn intervals_of_system(&self) -> Vec<ReliabilityRange> {
        let (curves, system) = (self.curves(), self.failed.len() - 1);
        (0..self.failed[system].len()).map(|n| self.interval(system, n, &curves)).collect()
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
            missing: assessment.feasibility.largest_barred_share(self.classified.unconditional()),
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

/// Probability beyond a failed simulation, over the failure probability that it tests, below which it lies too far out [1].
const TOO_FAR: f64 = 1e-3;
/// Distance of a value on the bound of its variable from the median [standard deviations of a normal variable].
const ON_A_BOUND: f64 = 9.0;

/// Failure probabilities that no simulation has tested.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Untested {
    /// Whether no simulation has tested the curve `(limit states + 1,)`, the system last; empty with direct simulation.
    pub curves: Vec<bool>,
    /// Number of independent samples without a failure.
    pub samples: usize,
}

impl Untested {
    /// The curves of a problem that no simulation has tested. `pf` `(modes + 1,)` the failure probabilities at
    /// the end of life [1], the system last, `initial` is the number of simulations of the initial design, the nominal one included.
    pub fn new(problem: &Problem, observations: &Observations, pf: &[f64], initial: usize) -> Self {
        let Problem { modes, inputs, .. } = problem;
        let random = inputs.variables().iter().filter(|variable| !variable.is_constant()).count();
        let beyond = ChiSquared::new(random.max(1) as f64).expect("a positive number of variables");
        let distance = |u: f64| if u.is_finite() { u * u } else { ON_A_BOUND * ON_A_BOUND };
        let beyond = observations.standardised().map(|z| {
            let normals = inputs.independent_normals(&inputs.to_physical(z));
            beyond.sf(normals.into_iter().filter(|u| !u.is_nan()).map(distance).sum())
        });
        let beyond: Vec<f64> = beyond.collect();
        // The probability beyond the nearest failure of each limit state, and of any.
        let nearest = |mode: &Mode| {
            let values = observations.running_maxima(mode.output);
            let failed = (0..values.nrows()).filter(|i| values.row(*i).iter().any(|y| *y >= mode.threshold));
            failed.map(|i| beyond[i]).fold(0.0, f64::max)
        };
        let mut nearest: Vec<f64> = modes.iter().map(nearest).collect();
        nearest.push(nearest.iter().copied().fold(0.0, f64::max));
        let untested = |(nearest, pf): (&f64, &f64)| *pf == 0.0 || *nearest < TOO_FAR * pf || *nearest == 0.0;
        let samples = initial.min(observations.len()).saturating_sub(1);
        Self { curves: nearest.iter().zip(pf).map(untested).collect(), samples }
    }

    /// The bound on the failure probability of curve `c` by the samples alone [1], if no simulation has tested it.
    pub fn bound(&self, c: usize) -> Option<f64> {
        let untested = self.curves.get(c).copied().unwrap_or(false);
        untested.then(|| 1.0 - 0.05f64.powf(1.0 / self.samples.max(1) as f64))
    }

    /// The largest failure probability that is possible for curve `c` [1], if no simulation has tested it, where that of the system
    /// is at most `system` [1].
    pub fn possible(&self, c: usize, system: f64) -> Option<f64> {
        let of_system = c + 1 == self.curves.len();
        self.bound(c).map(|bound| if of_system { bound } else { bound.min(system) })
    }
}

#[cfg(test)]
mod tests {
    use super::super::Observed;
    use super::*;
    use crate::statistics::design::InputModel;
    use common::random::Distribution;

    #[test]
    fn issue_a_bound_was_the_surrogates_word_alone() {
        let inputs = InputModel::from(&vec![Distribution::normal(3.0, 2.0).unwrap(); 2]);
        let modes = [0, 1].map(|output| Mode { output, threshold: 1.0 }).to_vec();
        let problem = Problem { inputs, outputs: 2, modes, checkpoints: vec![1] };
        let mut observations = Observations::new(2);
        // Twelve results without failures; then the first limit state fails at 3 and at 8 standard deviations, the second nowhere.
        for i in 0..12 {
            observations.add(&[0.1 * i as f64, -1.0], Observed::exact(vec![vec![0.0], vec![0.0]]));
        }
        let found = Untested::new(&problem, &observations, &[1e-9, 0.0, 1e-9], 12);
        assert_eq!(found, Untested { curves: vec![true; 3], samples: 11 });
        // 0.05 = (1 - P)^11.
        assert!((found.bound(2).unwrap() - 0.23840).abs() < 1e-5);
        observations.add(&[8.0, 0.0], Observed::exact(vec![vec![2.0], vec![0.0]]));
        // P(|U| > 8) = exp(-32) = 1.3e-14.
        for (pf, untested) in [(1e-10, true), (1e-12, false)] {
            let found = Untested::new(&problem, &observations, &[pf, 0.0, pf], 12);
            assert_eq!(found.curves, [untested, true, untested], "{pf}");
        }
        observations.add(&[0.0, -3.0], Observed::exact(vec![vec![2.0], vec![0.0]]));
        let found = Untested::new(&problem, &observations, &[1e-3, 0.0, 1e-3], 12);
        assert_eq!(found.curves, [false, true, false]);
        // The second fails no more often than the system, and without a prediction nothing is tested.
        assert_eq!((found.possible(1, 2e-3), found.possible(0, 2e-3)), (Some(2e-3), None));
        let none = Untested::new(&problem, &observations, &[0.0; 3], 12);
        assert_eq!((none.possible(2, 0.0), &none.curves), (none.bound(2), &vec![true; 3]));
        assert_eq!(Untested::default().bound(0), None);
    }
}
