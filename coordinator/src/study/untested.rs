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
use crate::statistics::learning::Mode;
use statrs::distribution::{ChiSquared, ContinuousCDF};

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
