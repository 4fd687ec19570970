//! Which points of the pool to simulate next: a batch, chosen one after the other as a Kriging believer.
//!
//! Picks alternate between two aims, so that both stopping rules come nearer:
//! - the point whose datum would settle most: gain_j = sum_i H_i c_ij^2 / (c_jj + noise), with c the posterior
//!   covariance over sigma2 and H_i = sum over modes and checkpoints of weight phi(U_i) / c_ii; that is the share of
//!   each point's variance that goes, weighted by how near the point lies to the limit (pool points are draws of the
//!   population, so its density is in the sum);
//! - the point with the largest risk of its own, sum over modes and checkpoints of weight Phi(-U), times the share
//!   of its variance that earlier picks of the batch have left: a point on the limit has Phi(-U) = 1/2 however well it
//!   is known, and would be picked again and again beside its neighbours.
//!
//! After each pick the posterior covariances of all modes are reduced as if its value were the predicted mean.
//! The weight of a mode at a point is its share by dominance (two modes: 2/3 for the first and 1/3 for the second
//! where |k| > 0.5, the other way round elsewhere; otherwise equal), times 0.2 at checkpoints by which another mode has
//! certainly failed: those matter to the curve of the single mode only.
//!
//! Source: targeted variance, Picheny et al. (2010), section 3; the believer, Ginsbourger et al. (2010).

use super::criterion::another_has_certainly_failed;
use super::{Classification, Pool, classification::distance_over_std, dominance};
use crate::surrogate::Posterior;
use common::random::{standard_normal_cdf, standard_normal_pdf};

/// |k| beyond which sampling shifts toward the first mode (wear).
const DOMINANT: f64 = 0.5;
/// Share of the favoured mode of two.
const FAVOURED: f64 = 2.0 / 3.0;
/// Weight of a mode where another has certainly failed.
const OVERTAKEN: f64 = 0.2;

/// Chooses `batch` members of the pool; returns indices into the population, in order of choice. `governing` is the
/// grid checkpoint at which dominance is taken. The posteriors are those of the modes at the pool's members.
pub fn select_batch(
    modes: &[Classification],
    pool: &Pool,
    mut posteriors: Vec<Posterior>,
    governing: usize,
    batch: usize,
) -> Vec<usize> {
    let weights = Weights::new(modes, pool, governing);
    let mut free = vec![true; pool.members.len()];
    let mut chosen = Vec::with_capacity(batch);
    while chosen.len() < batch.min(pool.members.len()) {
        let near = Nearness::new(modes, pool, &posteriors, &weights);
        let score = if chosen.len() % 2 == 0 { gains(&posteriors, &near) } else { near.risk.clone() };
        // A score of zero everywhere (all U far out): the largest variance of any mode explores.
        let score = if best(&score, &free).is_some_and(|i| score[i] > 0.0) {
            score
        } else {
            let variance = |i| posteriors.iter().map(|p| p.variance(i)).fold(0.0, f64::max);
            (0..free.len()).map(variance).collect()
        };
        let Some(pick) = best(&score, &free) else { break };
        free[pick] = false;
        chosen.push(pool.members[pick]);
        posteriors.iter_mut().for_each(|posterior| posterior.believe(pick));
    }
    chosen
}

/// Index of the largest score among the free, the first at a tie.
fn best(score: &[f64], free: &[bool]) -> Option<usize> {
    (0..score.len()).filter(|i| free[*i]).reduce(|best, i| if score[i] > score[best] { i } else { best })
}

/// Weight of each mode at each pool member and grid checkpoint, `(modes)(p, a)`.
struct Weights(Vec<Vec<f64>>);

impl Weights {
    fn new(modes: &[Classification], pool: &Pool, governing: usize) -> Self {
        let a = modes[0].grid();
        let of_mode = |s: usize| {
            let mut weights = Vec::with_capacity(pool.members.len() * a);
            for j in &pool.members {
                let share = match dominance(modes, *j, governing) {
                    Some(k) if (k.abs() > DOMINANT) == (s == 0) => FAVOURED,
                    Some(_) => 1.0 - FAVOURED,
                    None => 1.0 / modes.len() as f64,
                };
                weights.extend((0..a).map(|n| {
                    let overtaken = another_has_certainly_failed(modes, s, *j, n);
                    if overtaken { OVERTAKEN * share } else { share }
                }));
            }
            weights
        };
        Self((0..modes.len()).map(of_mode).collect())
    }
}

/// How near the pool's members are to the limits, given the variances as they stand.
struct Nearness {
    /// H per mode `(modes)(p,)`.
    targeted: Vec<Vec<f64>>,
    /// Weighted risk of a wrong classification `(p,)`.
    risk: Vec<f64>,
}

impl Nearness {
    fn new(modes: &[Classification], pool: &Pool, posteriors: &[Posterior], weights: &Weights) -> Self {
        let a = modes[0].grid();
        let mut risk = vec![0.0; pool.members.len()];
        let mut targeted = vec![vec![0.0; pool.members.len()]; modes.len()];
        for (s, mode) in modes.iter().enumerate() {
            for (i, j) in pool.members.iter().enumerate() {
                let variance = posteriors[s].variance(i);
                let root = variance.sqrt();
                let left =
                    if mode.variance_factor[*j] > 0.0 { variance / mode.variance_factor[*j] } else { 0.0 };
                let mut density = 0.0;
                for (n, mean) in mode.means_of(*j).iter().enumerate() {
                    let u = distance_over_std(mean - mode.threshold, mode.sigma[n] * root);
                    let weight = weights.0[s][i * a + n];
                    density += weight * standard_normal_pdf(u);
                    risk[i] += weight * left * standard_normal_cdf(-u);
                }
                // Below this the point is known to rounding: nothing of it can still be settled.
                targeted[s][i] = if variance > 1e-14 { density / variance } else { 0.0 };
            }
        }
        Self { targeted, risk }
    }
}

/// gain_j of every member `(p,)`, summed over modes.
fn gains(posteriors: &[Posterior], near: &Nearness) -> Vec<f64> {
    let members = near.risk.len();
    let mut gains = vec![0.0; members];
    for (posterior, targeted) in posteriors.iter().zip(&near.targeted) {
        for (j, gain) in gains.iter_mut().enumerate() {
            let denominator = posterior.variance(j) + posterior.noise();
            if denominator > 0.0 {
                let settled: f64 = posterior.column(j).iter().zip(targeted).map(|(c, h)| h * c * c).sum();
                *gain += settled / denominator;
            }
        }
    }
    gains
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learning::criterion::tests::mode;
    use crate::surrogate::{Correlation, Kernel, Kriging};
    use faer::Mat;

    /// One-dimensional pool at given places, data at 100 and beyond.
    fn posterior(places: &[f64]) -> Posterior {
        let data = Mat::from_fn(1, 3, |_, i| 100.0 + 10.0 * i as f64);
        let values = Mat::from_fn(3, 1, |i, _| i as f64);
        let correlation =
            Correlation { kernel: Kernel::Gaussian, theta: vec![1.0], nugget: 1e-8, stated: 0.0 };
        let model = Kriging::condition(data.as_ref(), values.as_ref(), &correlation).unwrap();
        Posterior::new(&model, Mat::from_fn(1, places.len(), |_, i| places[i]).as_ref())
    }

    #[test]
    fn a_batch_spreads_instead_of_piling_up() {
        // Two clusters on the limit, the first with more points: one pick in each.
        let places = [0.0, 0.01, 0.02, 50.0, 50.01];
        let n = places.len();
        let modes = [mode(&vec![1.0; n], &vec![1.3; n], 1.0)];
        let pool = Pool { members: (0..n).collect(), sampled: n, uncertain: n };
        let chosen = select_batch(&modes, &pool, vec![posterior(&places)], 0, 2);
        assert!(chosen[0] < 3 && chosen[1] >= 3, "{chosen:?}");
    }

    #[test]
    fn without_any_risk_it_explores_where_the_variance_is_largest() {
        let places = [99.99, 40.0];
        let modes = [mode(&[1e9, 1e9], &[1.0, 1.0], 1.0)];
        let pool = Pool { members: vec![7, 9], sampled: 0, uncertain: 0 };
        let modes =
            [Classification { mean: vec![1e9; 10], variance_factor: vec![1.0; 10], ..modes[0].clone() }];
        assert_eq!(select_batch(&modes, &pool, vec![posterior(&places)], 0, 1), vec![9]);
    }
}
