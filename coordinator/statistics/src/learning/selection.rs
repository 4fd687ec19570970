//! Selection of the next samples from the pool, one after the other; each is believed before the next is
//! chosen, and the samples under way are believed first.
//!
//! With [`LearningFunction::Gain`] two criteria alternate, so that both stopping rules come nearer:
//! - the point whose result reduces the variance near the limit most,
//!   gain_j = sum over i of H_i c_ij^2 / (c_jj + noise),   H_i = sum over s, n of phi(U_i) / c_ii,
//!   with c the posterior covariance over sigma2. It is the share of each point's variance that the result removes, weighted by
//!   the density of the prediction at the limit; pool points are draws of the population, so its density is in the sum.
//! - the point of largest own risk, sum over s, n of Phi(-U), times the share of its variance that
//!   earlier choices of the batch have left. Without this factor a point on the limit, whose Phi(-U) is 1/2
//!   however well it is known, would be chosen again and again together with its neighbours.
//!
//! With U the smallest U over modes and checkpoints decides, with the coupled learning function the smallest U_s / w_s: of two modes
//! w_s is 2/3 for the first and 1/3 for the second where their dominance abs(k) > 0.5, the reverse elsewhere.
//!
//! After each choice the posterior covariances of all modes are reduced as if the result were the predicted
//! mean. A mode has its whole weight where another has failed before: a fifth of it there made the error of its own curve 1.7
//! times as large on the drive (means of ten studies).
//!
//! Learning (acquisition) functions by which the next samples are chosen.
//!
//! # Source
//! Targeted variance: Picheny et al. (2010), Adaptive designs of experiments for accurate approximation of a
//! target region, Journal of Mechanical Design 132(7). Kriging believer: Ginsbourger, Le Riche, Carraro
//! (2010), Kriging is well-suited to parallelize optimization. Dominance weight: Cui et al. (2026), China
//! Mechanical Engineering 37(6), 1472-1485, doi 10.3969/j.issn.1004-132X.2026.06.020.
//! U: Echard, Gayton, Lemaire (2011), AK-MCS, Structural Safety 33(2). The coupled one: Cui et al. (2026), China Mechanical
//! Engineering 37(6), 1472-1485, doi 10.3969/j.issn.1004-132X.2026.06.020. The gain is that of [`super::Selection`].

use super::{Classification, JointPool, classification::distance_over_std, dominance};
use crate::named::named;
use common::random::{standard_normal_cdf, standard_normal_pdf};

/// |k| beyond which sampling shifts toward the first mode.
const DOMINANT: f64 = 0.5;
/// Weight of the favoured mode of two [1].
const FAVOURED: f64 = 2.0 / 3.0;

/// A selection in progress: members of the pool are chosen one after the other, each believed before the
/// next.
#[derive(Debug)]
pub struct Selection {
    pool: JointPool,
    feasible: Vec<f64>,
    governing: usize,
    function: LearningFunction,
    /// Marks the members that can still be chosen `(p,)`.
    free: Vec<bool>,
    /// Number of members chosen.
    chosen: usize,
}

impl Selection {
    /// A selection from the members of a pool by a learning function; the samples under way are believed, not chosen. `feasible` is the
    /// estimated probability of a result at each member `(p,)` [1], `governing` the checkpoint of the grid at which dominance is taken.
    pub fn new(pool: JointPool, feasible: Vec<f64>, governing: usize, function: LearningFunction) -> Self {
        let free = vec![true; pool.members.len()];
        let under_way = pool.under_way.clone();
        let mut selection = Self { pool, feasible, governing, function, free, chosen: 0 };
        under_way.for_each(|i| selection.believe(i));
        selection
    }

    fn believe(&mut self, i: usize) {
        self.free[i] = false;
        self.pool.believe(i);
    }

    /// Believes point `point` of the population, requested elsewhere, if it is a member.
    pub fn believe_point(&mut self, point: usize) {
        if let Some(place) = self.pool.members.iter().position(|member| *member == point) {
            self.believe(place);
        }
    }

    /// Chooses the next member, as an index in the population; `None` if no more are free. `modes` are the classifications the
    /// selection was made with.
    pub fn choose(&mut self, modes: &[Classification]) -> Option<usize> {
        let place = self.best(modes)?;
        self.believe(place);
        self.chosen += 1;
        Some(self.pool.members[place])
    }

    /// Place in the pool of the free member with the best score.
    fn best(&self, modes: &[Classification]) -> Option<usize> {
        let (targeted, risk) = nearness(modes, &self.pool);
        let Self { feasible, governing, function, .. } = self;
        let mut score = match function {
            LearningFunction::Gain if self.chosen.is_multiple_of(2) => gains(&self.pool, &targeted),
            LearningFunction::Gain => risk,
            LearningFunction::U => self.scores(modes, |_, _| 1.0),
            LearningFunction::Coupled => {
                self.scores(modes, |s, j| weight_by_dominance(modes, s, j, *governing))
            }
        };
        // Scores of U are negative: an unlikely result must make them more so.
        let weigh = |s: f64, p: f64| if s >= 0.0 { s * p } else { s / p.max(1e-6) };
        score.iter_mut().zip(feasible).for_each(|(s, p)| *s = weigh(*s, *p));
        let found =
            best(&score, &self.free).filter(|i| score[*i] > 0.0 || *function != LearningFunction::Gain);
        // A score of zero everywhere (all U large): the largest variance of any mode decides.
        found.filter(|i| score[*i].is_finite()).or_else(|| {
            let variance = |i| self.pool.posteriors.iter().map(|p| p.variance(i)).fold(0.0, f64::max);
            let spread: Vec<f64> = (0..self.free.len()).map(|i| variance(i) * feasible[i]).collect();
            best(&spread, &self.free)
        })
    }

    /// The negative of U of each member `(p,)` [1]: the smallest over modes and checkpoints, over the `weight` of mode s at point j.
    fn scores(&self, modes: &[Classification], weight: impl Fn(usize, usize) -> f64) -> Vec<f64> {
        let score_of = |(i, j): (usize, &usize)| {
            let mut smallest = f64::INFINITY;
            for (s, mode) in modes.iter().enumerate() {
                let deviation = self.pool.posteriors[s].variance(i).sqrt();
                let weight = weight(s, *j);
                for (n, mean) in mode.means_of(*j).iter().enumerate() {
                    let u = distance_over_std(mean - mode.threshold, mode.sigma[n] * deviation);
                    smallest = smallest.min(u / weight);
                }
            }
            -smallest
        };
        self.pool.members.iter().enumerate().map(score_of).collect()
    }
}

/// Index of the largest score among the free, the first at a tie.
fn best(score: &[f64], free: &[bool]) -> Option<usize> {
    (0..score.len()).filter(|i| free[*i]).reduce(|best, i| if score[i] > score[best] { i } else { best })
}

/// Weight w_s of mode s at point `j` by the dominance at grid checkpoint `governing` [1].
fn weight_by_dominance(modes: &[Classification], s: usize, j: usize, governing: usize) -> f64 {
    match dominance(modes, j, governing) {
        Some(k) if (k.abs() > DOMINANT) == (s == 0) => FAVOURED,
        Some(_) => 1.0 - FAVOURED,
        None => 1.0 / modes.len() as f64,
    }
}

/// Closeness of the members to the limits, with the present variances: H per mode `(modes)(p,)` [1] and the risk of a wrong
/// classification `(p,)` [1].
fn nearness(modes: &[Classification], pool: &JointPool) -> (Vec<Vec<f64>>, Vec<f64>) {
    let p = pool.members.len();
    let mut risk = vec![0.0; p];
    let mut targeted = vec![vec![0.0; p]; modes.len()];
    for (s, mode) in modes.iter().enumerate() {
        for (i, j) in pool.members.iter().enumerate() {
            let variance = pool.posteriors[s].variance(i);
            let root = variance.sqrt();
            let left = if mode.variance_factor[*j] > 0.0 { variance / mode.variance_factor[*j] } else { 0.0 };
            let mut density = 0.0;
            for (n, mean) in mode.means_of(*j).iter().enumerate() {
                let u = distance_over_std(mean - mode.threshold, mode.sigma[n] * root);
                density += standard_normal_pdf(u);
                risk[i] += left * standard_normal_cdf(-u);
            }
            // Below this the point is known to rounding, and no variance is left to reduce.
            targeted[s][i] = if variance > 1e-14 { density / variance } else { 0.0 };
        }
    }
    (targeted, risk)
}

/// gain_j of every member `(p,)` [1], summed over modes.
fn gains(pool: &JointPool, targeted: &[Vec<f64>]) -> Vec<f64> {
    let mut gains = vec![0.0; pool.members.len()];
    for (posterior, targeted) in pool.posteriors.iter().zip(targeted) {
        for (j, gain) in gains.iter_mut().enumerate() {
            let denominator = posterior.variance(j) + posterior.noise;
            if denominator > 0.0 {
                let reduced: f64 = posterior.column(j).iter().zip(targeted).map(|(c, h)| h * c * c).sum();
                *gain += reduced / denominator;
            }
        }
    }
    gains
}

/// Learning function by which the next samples are chosen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum LearningFunction {
    /// Alternately the largest expected reduction of the variance near the limit and the largest risk of a
    /// wrong classification, see [`super::Selection`].
    #[default]
    Gain,
    /// U, smallest |mean - threshold| / sigma of any limit state.
    U,
    /// U_c: U of each limit state over its weight by dominance, see [`super::dominance`].
    Coupled,
}

named!(LearningFunction { Gain = "gain", U = "u", Coupled = "coupled" });

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::Population;
    use crate::learning::Pool;
    use crate::learning::classification::tests::mode;
    use crate::surrogate::{Correlation, Kernel, Kriging};
    use common::random::Distribution;
    use faer::Mat;
    use std::ops::Range;

    /// One-dimensional pool at the given places, the last of them under way; data at 100 and beyond.
    fn joint_pool(places: &[f64], under_way: Range<usize>) -> JointPool {
        let data = Mat::from_fn(1, 3, |_, i| 100.0 + 10.0 * i as f64);
        let values = Mat::from_fn(3, 1, |i, _| i as f64);
        let correlation =
            Correlation { kernel: Kernel::Gaussian, theta: vec![1.0], nugget: 1e-8, stated: 0.0 };
        let model = Kriging::condition(data.as_ref(), values.as_ref(), &correlation).unwrap();
        let variable = Distribution::normal(0.0, 1.0).unwrap();
        let population = Population::draw(&[variable], 0, 1).with_descendants(places.to_vec(), vec![]);
        let members: Vec<usize> = (0..places.len()).filter(|i| !under_way.contains(i)).collect();
        let pool = Pool { sampled: members.len(), uncertain: members.len(), members };
        JointPool::new(pool, &under_way.collect::<Vec<usize>>(), &population, &[&model])
    }

    /// A selection over points at the given places; `feasible` is by place.
    fn selection(
        places: &[f64],
        feasible: &[f64],
        under_way: Range<usize>,
        function: LearningFunction,
    ) -> Selection {
        let pool = joint_pool(places, under_way);
        let feasible = pool.members.iter().map(|j| feasible[*j]).collect();
        Selection::new(pool, feasible, 0, function)
    }

    #[test]
    fn a_batch_spreads_instead_of_piling_up() {
        // Two clusters on the limit, the first with more points: one choice in each.
        let places = [0.0, 0.01, 0.02, 50.0, 50.01];
        let n = places.len();
        let modes = [mode(&vec![1.1; n], &vec![1.3; n], 1.0)];
        for function in LearningFunction::ALL {
            let mut both = selection(&places, &vec![1.0; n], 0..0, function);
            let chosen = [both.choose(&modes).unwrap(), both.choose(&modes).unwrap()];
            assert!(chosen[0] < 3 && chosen[1] >= 3, "{function:?} {chosen:?}");
            // The first cluster is being simulated already: the other one remains.
            let chosen = selection(&places, &vec![1.0; n], 1..2, function).choose(&modes);
            assert!(chosen.unwrap() >= 3, "{function:?} {chosen:?}");
            // In the second no simulation gives a result.
            let feasible = [1.0, 1.0, 1.0, 0.0, 0.0];
            let chosen = selection(&places, &feasible, 1..2, function).choose(&modes);
            assert!(chosen.unwrap() < 3, "{function:?} {chosen:?}");
        }
    }

    #[test]
    fn without_any_risk_it_explores_where_the_variance_is_largest() {
        let places = [99.99, 40.0];
        let modes = [mode(&[1e9, 1e9], &[1.0, 1.0], 1.0)];
        let modes =
            [Classification { mean: vec![1e9; 10], variance_factor: vec![1.0; 10], ..modes[0].clone() }];
        let mut selection = selection(&places, &[1.0; 2], 0..0, LearningFunction::Gain);
        assert_eq!(selection.choose(&modes), Some(1));
        // And then the other, and no more.
        assert_eq!((selection.choose(&modes), selection.choose(&modes)), (Some(0), None));
    }
}
