//! The learning function of each point: U per mode and checkpoint, coupled over competing modes, and the dominance
//! weight between two of them.

use super::Classification;
use rayon::prelude::*;

/// U below which a classification counts as uncertain: Phi(-2) = 2.3 % risk of a wrong sign (Echard et al. 2011).
pub const UNCERTAIN: f64 = 2.0;

/// Coupled learning function of one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coupled {
    /// U_c: smallest U over checkpoints and the modes that decide the system there.
    pub system: f64,
    /// Smallest U over checkpoints and all modes: what the curves of the single modes depend on.
    pub any: f64,
}

/// Coupled learning function at every point `(N,)`.
///
/// The system is in series, so U_c(x, n) = min over modes of U_s(x, n), except that a mode does not count at a
/// checkpoint by which another has certainly failed (its U >= 2): its own state then changes nothing.
pub fn coupled_criterion(modes: &[Classification]) -> Vec<Coupled> {
    let points = modes[0].variance_factor.len();
    (0..points).into_par_iter().map(|j| coupled(modes, j)).collect()
}

fn coupled(modes: &[Classification], j: usize) -> Coupled {
    let mut smallest = Coupled { system: f64::INFINITY, any: f64::INFINITY };
    for n in 0..modes[0].grid() {
        for (s, mode) in modes.iter().enumerate() {
            let u = mode.u(j, n);
            smallest.any = smallest.any.min(u);
            if u < smallest.system && !another_has_certainly_failed(modes, s, j, n) {
                smallest.system = u;
            }
        }
    }
    smallest
}

/// Whether a mode other than `s` has failed by grid checkpoint `n` beyond doubt.
pub(super) fn another_has_certainly_failed(modes: &[Classification], s: usize, j: usize, n: usize) -> bool {
    let certain = |mode: &Classification| mode.means_of(j)[n] >= mode.threshold && mode.u(j, n) >= UNCERTAIN;
    modes.iter().enumerate().any(|(other, mode)| other != s && certain(mode))
}

/// Dominance weight k of two competing modes at point `j` and grid checkpoint `n`:
/// k = (mean_2 / mean_1) (sigma_1 / sigma_2), with the outputs and their predicted standard deviations in units of
/// their thresholds (which then cancel): the first mode's relative uncertainty over the second's.
///
/// `None` unless there are exactly two modes, both with an uncertainty and a first mean that is not zero.
pub fn dominance(modes: &[Classification], j: usize, n: usize) -> Option<f64> {
    let [first, second] = modes else { return None };
    let std = |mode: &Classification| mode.sigma[n] * mode.variance_factor[j].sqrt();
    let k = second.means_of(j)[n] / first.means_of(j)[n] * std(first) / std(second);
    k.is_finite().then_some(k)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// One mode with given means `(N, a)`, unit sigma and variance factors.
    pub fn mode(mean: &[f64], factors: &[f64], threshold: f64) -> Classification {
        Classification {
            mean: mean.to_vec(),
            variance_factor: factors.to_vec(),
            sigma: vec![1.0; mean.len() / factors.len()],
            first_failure: vec![0; factors.len()],
            threshold,
        }
    }

    #[test]
    fn a_mode_overtaken_by_certain_failure_does_not_call() {
        // Point 0: mode a has certainly failed (U = 3), mode b is on its limit. Point 1: a is uncertain instead.
        let a = mode(&[4.0, 2.0], &[1.0, 1.0], 1.0);
        let b = mode(&[10.0, 10.0], &[1.0, 1.0], 10.0);
        let coupled = coupled_criterion(&[a, b]);
        assert_eq!(coupled[0], Coupled { system: 3.0, any: 0.0 });
        assert_eq!(coupled[1], Coupled { system: 0.0, any: 0.0 });
    }

    #[test]
    fn dominance_is_the_ratio_of_relative_uncertainties() {
        let a = mode(&[2.0], &[0.04], 1.0);
        let b = mode(&[10.0], &[0.25], 10.0);
        let k = dominance(&[a.clone(), b], 0, 0).unwrap();
        assert!((k - (0.2 / 2.0) / (0.5 / 10.0)).abs() < 1e-12);
        assert_eq!(dominance(&[a], 0, 0), None);
    }
}
