//! Effect of the simulator's numerical noise on the failure shares.
//!
//! The surrogates classify by the smooth function under the noise. A simulation at x adds noise of standard
//! deviation tau = sqrt((nugget + stated) sigma2), so counting noisy simulations would give the share
//!
//!   mean over j of Phi((mean_j - threshold) / tau)
//!
//! instead of the share of mean_j >= threshold. The difference is no error of the surrogates, and no number
//! of samples removes it; it enters the standard error of the curves but not the stopping rules. The noises
//! of different modes are taken as independent.
//!
//! # Source
//! The expectation of an indicator under Gaussian noise; noise as a nugget: Ankenman, Nelson, Staum (2010),
//! Stochastic kriging for simulation metamodeling, Operations Research 58(2).

use super::{Classification, classification::distance_over_std};
use common::random::standard_normal_cdf;
use rayon::prelude::*;

/// Number of points summed together; fixed, so that sums do not depend on the number of threads.
const BLOCK: usize = 4096;

/// Absolute differences of the share counted with noise and the share of the smooth function `(modes + 1, a)`
/// [1] at the grid checkpoints, the system last. `roots` `(modes,)` holds the square roots of the modes'
/// noise variances over their process variances [1].
pub fn noise_shifts(modes: &[Classification], roots: &[f64]) -> Vec<Vec<f64>> {
    let (a, points) = (modes[0].grid(), modes[0].variance_factor.len());
    let blocks: Vec<usize> = (0..points).step_by(BLOCK).collect();
    let partial: Vec<Vec<f64>> = blocks
        .into_par_iter()
        .map(|start| {
            let mut sums = vec![0.0; (modes.len() + 1) * a];
            for j in start..points.min(start + BLOCK) {
                for n in 0..a {
                    let (mut safe_with_noise, mut safe) = (1.0, 1.0);
                    for (s, mode) in modes.iter().enumerate() {
                        let margin = mode.threshold - mode.means_of(j)[n];
                        let failed = f64::from(u8::from(margin <= 0.0));
                        let u = distance_over_std(margin, roots[s] * mode.sigma[n]);
                        let flipped = standard_normal_cdf(-u);
                        let with_noise = if margin <= 0.0 { 1.0 - flipped } else { flipped };
                        sums[s * a + n] += with_noise - failed;
                        safe_with_noise *= 1.0 - with_noise;
                        safe *= 1.0 - failed;
                    }
                    sums[modes.len() * a + n] += safe - safe_with_noise;
                }
            }
            sums
        })
        .collect();
    let total = |i: usize| (partial.iter().map(|sums| sums[i]).sum::<f64>() / points as f64).abs();
    (0..=modes.len()).map(|c| (0..a).map(|n| total(c * a + n)).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learning::coupled_criterion::tests::mode;

    #[test]
    fn noise_moves_points_across_the_limit_by_phi() {
        // Sigma 1, nugget 0.25: tau = 0.5. Means 0.5 below, 0.5 below and 1.5 above a threshold of 2.
        let shift = noise_shifts(&[mode(&[1.5, 1.5, 3.5], &[0.1; 3], 2.0)], &[0.5]);
        let expected = (2.0 * standard_normal_cdf(-1.0) - standard_normal_cdf(-3.0)) / 3.0;
        assert!((shift[0][0] - expected).abs() < 1e-15 && (shift[1][0] - expected).abs() < 1e-15);
    }

    #[test]
    fn without_noise_nothing_moves() {
        assert_eq!(noise_shifts(&[mode(&[1.0, 2.0], &[0.1; 2], 2.0)], &[0.0]), vec![vec![0.0]; 2]);
    }
}
