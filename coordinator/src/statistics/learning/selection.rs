//! Which points of the pool to simulate next: some, chosen one after the other as a Kriging believer, those that are under
//! way believed before.
//!
//! With [`LearningFunction::Gain`] picks alternate between two aims, so that both stopping rules come nearer:
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
use super::{Classification, LearningFunction, Pool, classification::distance_over_std, dominance};
use crate::statistics::surrogate::Posterior;
use common::random::{standard_normal_cdf, standard_normal_pdf};
use std::ops::Range;

/// |k| beyond which sampling shifts toward the first mode (wear).
const DOMINANT: f64 = 0.5;
/// Share of the favoured mode of two.
const FAVOURED: f64 = 2.0 / 3.0;
/// Weight of a mode where another has certainly failed.
const OVERTAKEN: f64 = 0.2;

/// A choice under way: points are taken one after the other, each believed before the next.
#[derive(Debug)]
pub struct Selection {
    pool: Pool,
    /// Of the modes, at the pool's members.
    posteriors: Vec<Posterior>,
    weights: Weights,
    /// Estimated probability of a result at each member `(p,)` [1].
    feasible: Vec<f64>,
    function: LearningFunction,
    free: Vec<bool>,
    picked: usize,
}

impl Selection {
    /// Over the members of a pool; those of `under_way` (places in the pool) are asked for already: they are believed, not chosen.
    /// `governing` is the grid checkpoint at which dominance is taken.
    pub fn new(
        modes: &[Classification],
        pool: Pool,
        posteriors: Vec<Posterior>,
        feasible: Vec<f64>,
        under_way: Range<usize>,
        (governing, function): (usize, LearningFunction),
    ) -> Self {
        let weights = Weights::new(modes, &pool, governing);
        let free = vec![true; pool.members.len()];
        let mut selection = Self { pool, posteriors, weights, feasible, function, free, picked: 0 };
        under_way.for_each(|i| selection.believe(i));
        selection
    }

    fn believe(&mut self, i: usize) {
        self.free[i] = false;
        self.posteriors.iter_mut().for_each(|posterior| posterior.believe(i));
    }

    /// Believes a point of the population that is asked for otherwise, if it is a member.
    pub fn leave(&mut self, point: usize) {
        if let Some(place) = self.pool.members.iter().position(|member| *member == point) {
            self.believe(place);
        }
    }

    /// The next `count` members, as indices into the population, in order of choice; fewer if no more are free.
    pub fn choose(&mut self, modes: &[Classification], count: usize) -> Vec<usize> {
        let mut chosen = Vec::with_capacity(count);
        while chosen.len() < count {
            let Some(pick) = self.best(modes) else { break };
            self.believe(pick);
            self.picked += 1;
            chosen.push(self.pool.members[pick]);
        }
        chosen
    }

    /// Place in the pool of the most wanted member.
    fn best(&self, modes: &[Classification]) -> Option<usize> {
        let near = Nearness::new(modes, &self.pool, &self.posteriors, &self.weights);
        let mut score = match self.function {
            LearningFunction::Gain if self.picked.is_multiple_of(2) => gains(&self.posteriors, &near),
            LearningFunction::Gain => near.risk.clone(),
            function => self.scores(modes, function),
        };
        // U is negative: the less so, the better, and the less likely a result, the worse.
        let weigh = |s: f64, p: f64| if s >= 0.0 { s * p } else { s / p.max(1e-6) };
        score.iter_mut().zip(&self.feasible).for_each(|(s, p)| *s = weigh(*s, *p));
        let found =
            best(&score, &self.free).filter(|i| score[*i] > 0.0 || self.function == LearningFunction::U);
        // A score of zero everywhere (all U far out): the largest variance of any mode explores.
        found.filter(|i| score[*i].is_finite()).or_else(|| {
            let variance = |i| self.posteriors.iter().map(|p| p.variance(i)).fold(0.0, f64::max);
            let spread: Vec<f64> = (0..self.free.len()).map(|i| variance(i) * self.feasible[i]).collect();
            best(&spread, &self.free)
        })
    }

    /// Best score of each member over the modes and checkpoints, those that another mode's certain failure leaves without
    /// influence on the system at the end of the queue `(p,)`.
    fn scores(&self, modes: &[Classification], function: LearningFunction) -> Vec<f64> {
        let a = modes[0].grid();
        let of = |(i, j): (usize, &usize)| {
            let mut largest = f64::NEG_INFINITY;
            for (s, mode) in modes.iter().enumerate() {
                let deviation = self.posteriors[s].variance(i).sqrt();
                for (n, mean) in mode.means_of(*j).iter().enumerate() {
                    let scale = mode.sigma[n];
                    if scale <= 0.0 {
                        continue;
                    }
                    let u = (mean - mode.threshold) / (scale * deviation);
                    let score = function.score(u, deviation).unwrap_or(f64::NEG_INFINITY);
                    let weight = self.weights.0[s][i * a + n];
                    largest = largest.max(if score >= 0.0 { score * weight } else { score / weight });
                }
            }
            largest
        };
        self.pool.members.iter().enumerate().map(of).collect()
    }
}

/// Index of the largest score among the free, the first at a tie.
fn best(score: &[f64], free: &[bool]) -> Option<usize> {
    (0..score.len()).filter(|i| free[*i]).reduce(|best, i| if score[i] > score[best] { i } else { best })
}

/// Weight of each mode at each pool member and grid checkpoint, `(modes)(p, a)`.
#[derive(Debug)]
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
    use crate::statistics::learning::criterion::tests::mode;
    use crate::statistics::surrogate::{Correlation, Kernel, Kriging};
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

    /// A choice over points at the given places.
    fn selection(
        modes: &[Classification],
        places: &[f64],
        feasible: Vec<f64>,
        under_way: Range<usize>,
        function: LearningFunction,
    ) -> Selection {
        let n = places.len();
        let pool = Pool { members: (0..n).collect(), sampled: n, uncertain: n };
        Selection::new(modes, pool, vec![posterior(places)], feasible, under_way, (0, function))
    }

    #[test]
    fn a_batch_spreads_instead_of_piling_up() {
        // Two clusters on the limit, the first with more points: one pick in each.
        let places = [0.0, 0.01, 0.02, 50.0, 50.01];
        let n = places.len();
        let modes = [mode(&vec![1.1; n], &vec![1.3; n], 1.0)];
        for function in
            [LearningFunction::Gain, LearningFunction::U, LearningFunction::Eff, LearningFunction::H]
        {
            let chosen = selection(&modes, &places, vec![1.0; n], 0..0, function).choose(&modes, 2);
            assert!(chosen[0] < 3 && chosen[1] >= 3, "{function:?} {chosen:?}");
            // The first cluster is being simulated already: the other one is left.
            let chosen = selection(&modes, &places, vec![1.0; n], 1..2, function).choose(&modes, 1);
            assert!(chosen[0] >= 3, "{function:?} {chosen:?}");
            // In the second nothing gives a result.
            let feasible = vec![1.0, 1.0, 1.0, 0.0, 0.0];
            let chosen = selection(&modes, &places, feasible, 1..2, function).choose(&modes, 1);
            assert!(chosen[0] < 3, "{function:?} {chosen:?}");
        }
    }

    #[test]
    fn without_any_risk_it_explores_where_the_variance_is_largest() {
        let places = [99.99, 40.0];
        let modes = [mode(&[1e9, 1e9], &[1.0, 1.0], 1.0)];
        let modes =
            [Classification { mean: vec![1e9; 10], variance_factor: vec![1.0; 10], ..modes[0].clone() }];
        let mut selection = selection(&modes, &places, vec![1.0; 2], 0..0, LearningFunction::Gain);
        assert_eq!(selection.choose(&modes, 1), vec![1]);
        // And then the other, and no more.
        assert_eq!(selection.choose(&modes, 5), vec![0]);
    }
}
