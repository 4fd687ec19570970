//! The coupled learning function U_c of a point over competing modes and checkpoints, and the dominance
//! weight of two modes.
//!
//!   U_c(x) = min over n of min over s of U_s(x, n),   U_s as in [`Classification::u`],
//!
//! where a mode s is left out at a checkpoint n by which another mode has certainly failed (U >= 2): the
//! system has failed there whatever mode s does. U_c >= 2 everywhere means that every point is classified
//! with a risk of at most Phi(-2) per mode and checkpoint. The dominance weight of two modes is
//!
//!   k = (mean_2 / mean_1) (sigma_1 s_1 / (sigma_2 s_2)),
//!
//! the relative uncertainty of the first mode over that of the second [1].
//!
//! # Source
//! U: Echard, Gayton, Lemaire (2011), AK-MCS, Structural Safety 33(2). Minimum over the components of a
//! series system: Fauriat, Gayton (2014), AK-SYS, Reliability Engineering & System Safety 123. U_c and k for
//! competing failures: Cui et al. (2026), China Mechanical Engineering 37(6), 1472-1485, doi
//! 10.3969/j.issn.1004-132X.2026.06.020.

use super::Classification;
use rayon::prelude::*;

/// U below which a classification counts as uncertain: Phi(-2) = 2.3 % risk of a wrong sign (Echard et al.
/// 2011).
pub const UNCERTAIN: f64 = 2.0;

/// Coupled learning functions of one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coupled {
    /// U_c: smallest U over the checkpoints and the modes that decide on the system there [1].
    pub system: f64,
    /// Smallest U over the checkpoints and all modes, which decides on the curves of the single modes [1].
    pub any: f64,
}

/// Coupled learning functions of every point `(N,)`, from the classifications by all modes on the same grid.
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

/// True if a mode other than `s` has certainly failed at point `j` by grid checkpoint `n`: it is predicted to
/// have failed, with U >= 2.
pub(super) fn another_has_certainly_failed(modes: &[Classification], s: usize, j: usize, n: usize) -> bool {
    let certain = |mode: &Classification| mode.means_of(j)[n] >= mode.threshold && mode.u(j, n) >= UNCERTAIN;
    modes.iter().enumerate().any(|(other, mode)| other != s && certain(mode))
}

/// Dominance weight k [1] of two competing modes at point `j` and grid checkpoint `n`, from means and
/// predicted standard deviations; scaling the outputs by their thresholds would not change it.
///
/// `None` unless there are exactly two modes, both with a positive standard deviation, and a first mean other
/// than zero.
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
        // Point 0: mode a has certainly failed (U = 3), mode b is on its limit. Point 1: a is uncertain
        // instead.
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
