//! Importance sampling of a rare event that may consist of several regions: samples conditional on the event
//! and its probability.
//!
//! Proposals are drawn from a mixture of standard normals moved to K centres and one inflated normal,
//!
//!   q(u) = a_0 N(u; 0, s^2 I) + sum over k of a_k N(u; c_k, I),
//!   w(u) = phi(u) / q(u) = 1 / (a_0 s^-d exp(|u|^2 (1 - 1/s^2) / 2) + sum over k of a_k exp(c_k . u - |c_k|^2 / 2)),
//!
//! so that the probability of the event is the mean of w over the proposals in it. The centres are chosen among
//! points known to lie in the event: the nearest to the origin first, then the nearest of those that the mixture
//! so far covers badly, w > e^2 exp(-|c_1|^2 / 2), until few are left. With K = 1 and a plane limit this is the
//! design point. Proposals in the event are known points too: the mixture is chosen anew with them until the
//! coefficient of variation no longer asks for it. The inflated normal, whose samples lie in all directions at
//! the distance of c_1, bounds the weight of a region that no centre covers.
//!
//! Subset simulation loses such regions: where the response rises only beyond a kink, the samples of the first
//! levels follow the branch that rises earlier, and the few chains that are left on the other one make the
//! estimate right in the mean over many runs, and wrong in most of them.
//!
//! The samples returned are drawn from the proposals in the event in proportion to their weights, at equal
//! distances of the cumulated weight. The coefficient of variation is that of the weights beyond the limit,
//!
//!   cov^2 = sum of w^2 / (sum of w)^2 - 1 / M   over the proposals with y >= 0, of M in all.
//!
//! # Source
//! Centres at the design points of several regions: Melchers (1989), Importance sampling in structural systems,
//! Structural Safety 6; Au, Beck (1999), A new adaptive importance sampling scheme for reliability calculations,
//! Structural Safety 21. Mixture weights: Veach, Guibas (1995), Optimally combining sampling techniques for Monte
//! Carlo rendering; Owen, Zhou (2000), Safe and effective importance sampling. Systematic resampling: Kitagawa
//! (1996), Monte Carlo filter and smoother for non-Gaussian nonlinear state space models.

use super::{Responses, Subset};
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};

/// Largest number of centres of a mixture.
const CENTRES: usize = 64;
/// Share of the inflated normal among the proposals [1].
const INFLATED: f64 = 0.1;
/// Share of the known points that may be badly covered [1].
const UNCOVERED: f64 = 0.005;
/// Logarithm of the factor on the weight at the first centre from which a point is badly covered.
const BADLY: f64 = 2.0;
/// Proposals of a trial of the mixture, over the samples wanted [1].
const TRIAL: f64 = 0.2;
/// Proposals of the last mixture, over the samples wanted [1].
const PROPOSALS: f64 = 2.0;
/// Most trials, and coefficient of variation of a trial from which the next mixture is drawn [1].
const TRIALS: (usize, f64) = (4, 0.05);

/// An importance sampling in independent standard normals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImportanceSampling {
    /// Number d of independent standard normal variables.
    pub variables: usize,
    /// Number of samples conditional on the event.
    pub samples: usize,
    /// The event is y >= level.
    pub level: f64,
}

/// The mixture q.
struct Mixture {
    d: usize,
    /// Centres `(K, d)` row-major.
    centres: Vec<f64>,
    /// Shares a_k of the proposals `(K,)` [1].
    shares: Vec<f64>,
    /// Scale s of the inflated normal [1].
    inflated: f64,
}

/// Proposals with their responses and weights.
struct Proposals {
    /// Points `(M, d)` row-major.
    u: Vec<f64>,
    /// Responses y of the proposals `(M,)`.
    y: Vec<f64>,
    /// Weights w `(M,)`; zero outside the event.
    w: Vec<f64>,
}

impl ImportanceSampling {
    /// Runs the sampling from points `known` `(k, d)` row-major, some of which lie in the event. `respond` returns
    /// the responses `(k,)` at points `(k, d)` row-major. `None` if no known point lies in the event.
    pub fn run(&self, known: Vec<f64>, rng: &mut impl Rng, respond: &Responses<'_>) -> Option<Subset> {
        let d = self.variables;
        let y = respond(&known);
        let mut known = self.in_event(&known, &y);
        let mut mixture = Mixture::cover(&known, d)?;
        for _ in 0..TRIALS.0 {
            let trial = mixture.propose((TRIAL * self.samples as f64) as usize, self.level, rng, respond);
            known.extend(self.in_event(&trial.u, &trial.y));
            let enough = trial.variation() <= TRIALS.1;
            mixture = Mixture::cover(&known, d)?;
            if enough {
                break;
            }
        }
        let proposals = mixture.propose((PROPOSALS * self.samples as f64) as usize, self.level, rng, respond);
        let sum: f64 = proposals.w.iter().sum();
        (sum > 0.0).then(|| self.resampled(&proposals, sum, rng))
    }

    /// The points `u` `(k, d)` in the event.
    fn in_event(&self, u: &[f64], y: &[f64]) -> Vec<f64> {
        let points = u.chunks_exact(self.variables).zip(y);
        points.filter(|(_, y)| **y >= self.level).flat_map(|(u, _)| u.iter().copied()).collect()
    }

    /// Samples of equal weight from the proposals, whose weights have this sum.
    fn resampled(&self, proposals: &Proposals, sum: f64, rng: &mut impl Rng) -> Subset {
        let (n, d) = (self.samples, self.variables);
        let step = sum / n as f64;
        let (mut u, mut y, mut origin) =
            (Vec::with_capacity(n * d), Vec::with_capacity(n), Vec::with_capacity(n));
        let (mut at, mut next) = (0.0, step * rng.random::<f64>());
        for (j, w) in proposals.w.iter().enumerate() {
            at += w;
            while next < at && y.len() < n {
                u.extend_from_slice(&proposals.u[j * d..(j + 1) * d]);
                y.push(proposals.y[j]);
                origin.push(u32::try_from(j).expect("fewer than 2^32 proposals"));
                next += step;
            }
        }
        let (probability, cov) = (sum / proposals.w.len() as f64, proposals.variation());
        Subset { u, y, probability, cov, levels: vec![self.level], gamma: 0.0, origin }
    }
}

impl Mixture {
    /// The mixture that covers the points `known` `(k, d)` row-major, all in the event; `None` without any.
    fn cover(known: &[f64], d: usize) -> Option<Self> {
        let points: Vec<&[f64]> = known.chunks_exact(d).collect();
        let square = |u: &[f64]| u.iter().map(|u| u * u).sum::<f64>();
        let mut order: Vec<(f64, usize)> = points.iter().enumerate().map(|(i, u)| (square(u), i)).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let nearest = order.first()?.0;
        // Sum over the centres so far of N(u; c_k, I) / phi(u), of the points in this order.
        let mut covered = vec![0.0_f64; order.len()];
        let mut by: Vec<(f64, usize)> = vec![(f64::NEG_INFINITY, 0); order.len()];
        let bound = (0.5 * nearest - BADLY).exp();
        let mut centres = Vec::new();
        let mut count = 0;
        let mut from = 0;
        while count < CENTRES {
            let badly = covered.iter().filter(|ratio| **ratio < bound).count();
            if count > 0 && (badly as f64) < UNCOVERED * order.len() as f64 {
                break;
            }
            let Some(next) = (from..order.len()).find(|i| covered[*i] < bound) else { break };
            from = next + 1;
            let centre = points[order[next].1];
            let half = 0.5 * order[next].0;
            for (i, (_, place)) in order.iter().enumerate() {
                let along: f64 = centre.iter().zip(points[*place]).map(|(c, u)| c * u).sum();
                covered[i] += (along - half).exp();
                if along - half > by[i].0 {
                    by[i] = (along - half, count);
                }
            }
            centres.extend_from_slice(centre);
            count += 1;
        }
        // Half in equal shares, half by the points that each centre covers best.
        let mut counts = vec![0usize; count];
        by.iter().for_each(|(_, k)| counts[*k] += 1);
        let share = |covered: &usize| {
            (1.0 - INFLATED) * 0.5 * (1.0 / count as f64 + *covered as f64 / order.len() as f64)
        };
        let shares = counts.iter().map(share).collect();
        let inflated = ((nearest + d as f64 - 1.0).max(d as f64) / d as f64).sqrt();
        Some(Self { d, centres, shares, inflated })
    }

    /// Draws proposals: the given `count`, in shares as exact as whole numbers allow.
    fn propose(&self, count: usize, level: f64, rng: &mut impl Rng, respond: &Responses<'_>) -> Proposals {
        let d = self.d;
        let mut u = Vec::with_capacity(count * d);
        let mut cumulated = 0.0;
        for (centre, share) in self.centres.chunks_exact(d).zip(&self.shares) {
            cumulated += share;
            let end = (cumulated * count as f64).round() as usize;
            while u.len() < end * d {
                u.extend(centre.iter().map(|c| c + normal(rng)));
            }
        }
        while u.len() < count * d {
            u.push(self.inflated * normal(rng));
        }
        let y = respond(&u);
        let weight = |(u, y): (&[f64], &f64)| if *y >= level { self.weight(u) } else { 0.0 };
        let w = u.chunks_exact(d).zip(&y).map(weight).collect();
        Proposals { u, y, w }
    }

    /// Weight w of a point `(d,)`.
    fn weight(&self, u: &[f64]) -> f64 {
        let square: f64 = u.iter().map(|u| u * u).sum();
        let s = self.inflated;
        let inflated = INFLATED * (0.5 * square * (1.0 - s.powi(-2)) - self.d as f64 * s.ln()).exp();
        let of_centre = |(c, share): (&[f64], &f64)| {
            let exponent: f64 = c.iter().zip(u).map(|(c, u)| c * (u - 0.5 * c)).sum();
            share * exponent.exp()
        };
        let moved: f64 = self.centres.chunks_exact(self.d).zip(&self.shares).map(of_centre).sum();
        1.0 / (inflated + moved)
    }
}

impl Proposals {
    /// Coefficient of variation [1] of the probability beyond the limit, or of that of the event if no proposal is.
    fn variation(&self) -> f64 {
        let any = self.y.iter().any(|y| *y >= 0.0);
        let counted = || self.w.iter().zip(&self.y).filter(|(_, y)| !any || **y >= 0.0).map(|(w, _)| *w);
        let (sum, squares) = (counted().sum::<f64>(), counted().map(|w| w * w).sum::<f64>());
        if sum > 0.0 {
            (squares / (sum * sum) - 1.0 / self.w.len() as f64).max(0.0).sqrt()
        } else {
            f64::INFINITY
        }
    }
}

fn normal(rng: &mut impl Rng) -> f64 {
    StandardNormal.sample(rng)
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::random::standard_normal_cdf;
    use rand_chacha::ChaCha12Rng;
    use rand_chacha::rand_core::SeedableRng;

    /// Estimate and stated coefficient of variation; `far` are known points of the event.
    fn estimate(d: usize, level: f64, far: Vec<f64>, seed: u64, y: fn(&[f64]) -> f64) -> (f64, f64) {
        let respond = |u: &[f64]| -> Vec<f64> { u.chunks_exact(d).map(y).collect() };
        let mut rng = ChaCha12Rng::seed_from_u64(seed);
        let sampling = ImportanceSampling { variables: d, samples: 4000, level };
        let found = sampling.run(far, &mut rng, &respond).unwrap();
        assert_eq!((found.y.len(), found.u.len(), found.origin.len()), (4000, 4000 * d, 4000));
        assert!(found.y.iter().all(|y| *y >= level));
        assert_eq!(found.y, respond(&found.u));
        let share = found.failed_share();
        (found.probability * share, found.cov.hypot(((1.0 - share) / (share * 4000.0)).sqrt()))
    }

    /// Root mean square over seeds of the distance from `exact` in stated standard errors, with the largest stated
    /// coefficient of variation.
    fn distance(exact: f64, run: impl Fn(u64) -> (f64, f64)) -> (f64, f64) {
        let (mut squares, mut largest) = (0.0, 0.0_f64);
        for seed in 0..20 {
            let (pf, cov) = run(seed);
            squares += ((pf / exact - 1.0) / cov).powi(2) / 20.0;
            largest = largest.max(cov);
        }
        (squares.sqrt(), largest)
    }

    #[test]
    fn regions_in_any_direction_are_found_within_the_stated_error() {
        // A plane limit far off, from one point well inside.
        let (rms, cov) = distance(standard_normal_cdf(-5.0), |seed| {
            estimate(3, -0.5, vec![5.0, 5.0, 1.0], seed, |u| u[0] - 5.0)
        });
        assert!(rms < 1.6 && cov < 0.1, "{rms} {cov}");
        // Two branches, one of them known; the other, as probable as the first, is in the inflated normal.
        let branches = |u: &[f64]| (u[0] - 4.0).max(10.0 * (-u[1] - 3.9) - 1.0);
        let exact = 1.0 - standard_normal_cdf(4.0) * standard_normal_cdf(4.0);
        let (rms, cov) = distance(exact, |seed| estimate(2, -0.5, vec![4.2, 0.1], seed, branches));
        assert!(rms < 1.6 && cov < 0.1, "{rms} {cov}");
        // The outside of a circle: all directions.
        let circle = |u: &[f64]| u[0].hypot(u[1]) - 5.0;
        let (rms, cov) = distance((-12.5_f64).exp(), |seed| estimate(2, -0.3, vec![0.0, 5.0], seed, circle));
        assert!(rms < 1.6 && cov < 0.1, "{rms} {cov}");
    }

    #[test]
    fn without_a_point_in_the_event_there_is_no_estimate() {
        let respond = |u: &[f64]| vec![-1.0; u.len()];
        let sampling = ImportanceSampling { variables: 1, samples: 100, level: -0.5 };
        assert!(sampling.run(vec![1.0, 2.0], &mut ChaCha12Rng::seed_from_u64(1), &respond).is_none());
    }
}
