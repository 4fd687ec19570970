//! Moves of states that leave a normal approximation N(m, C) of their distribution invariant:
//!
//!   v' = m + sqrt(1 - b^2) (v - m) + b L xi,   C = L L',   xi standard normal,
//!
//! accepted with the ratio of pi(v) / N(v; m, C) at v' and v. Where the distribution pi is nearly normal, almost all moves are
//! accepted at b = 1, whatever the number of coordinates; elsewhere b is adapted to the acceptance.
//!
//! C is the covariance of the particles, with correlations shrunk in proportion to coordinates over particles, and enlarged so
//! that its tails are not lighter than those of pi.
//!
//! # Source
//! Rudolf, Sprungk (2018), On a generalization of the preconditioned Crank-Nicolson Metropolis algorithm, Foundations of
//! Computational Mathematics 18(2).

use super::particles::Particles;
use faer::Mat;
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

/// Factor on the covariance of the particles.
const ENLARGED: f64 = 1.2;
/// Least variance of a coordinate [1].
const LEAST_VARIANCE: f64 = 1e-10;
/// Acceptance below and above which b is changed [1], and by what factor.
const ACCEPTANCE: (f64, f64) = (0.25, 0.5);
const CHANGE: f64 = 1.5;
/// First and least b [1].
const FIRST: f64 = 0.9;
const LEAST: f64 = 1e-3;

/// The normal approximation and the size of a move.
#[derive(Debug, Clone)]
pub(super) struct Proposal {
    mean: Vec<f64>,
    /// Lower factor of the covariance `(D, D)`.
    factor: Mat<f64>,
    /// Size of the move, in (0, 1].
    size: f64,
}

impl Proposal {
    /// The approximation of particles of equal weight.
    pub fn new(particles: &Particles) -> Self {
        let (n, d) = (particles.len(), particles.dimension);
        let mean: Vec<f64> = (0..d).map(|k| particles.mean(|i| particles.state(i)[k])).collect();
        let centred = Mat::from_fn(n, d, |i, k| particles.state(i)[k] - mean[k]);
        let mut covariance = (centred.transpose() * &centred) * (ENLARGED / n as f64);
        let kept = 1.0 - (d as f64 / n as f64).min(0.5);
        for k in 0..d {
            for l in 0..d {
                if k != l {
                    covariance[(k, l)] *= kept;
                }
            }
            covariance[(k, k)] = covariance[(k, k)].max(LEAST_VARIANCE);
        }
        Self { factor: cholesky(&covariance), mean, size: FIRST }
    }

    /// A move from state `v` `(D,)`.
    pub fn propose(&self, v: &[f64], rng: &mut impl Rng) -> Vec<f64> {
        let d = v.len();
        let xi: Vec<f64> = (0..d).map(|_| StandardNormal.sample(rng)).collect();
        let kept = (1.0 - self.size * self.size).sqrt();
        let coordinate = |k: usize| {
            let step: f64 = (0..=k).map(|l| self.factor[(k, l)] * xi[l]).sum();
            self.mean[k] + kept * (v[k] - self.mean[k]) + self.size * step
        };
        (0..d).map(coordinate).collect()
    }

    /// -ln N(v; m, C) up to a constant.
    pub fn distance(&self, v: &[f64]) -> f64 {
        let mut solved: Vec<f64> = Vec::with_capacity(v.len());
        for (k, (v, mean)) in v.iter().zip(&self.mean).enumerate() {
            let known: f64 = (0..k).map(|l| self.factor[(k, l)] * solved[l]).sum();
            solved.push((v - mean - known) / self.factor[(k, k)]);
        }
        0.5 * solved.iter().map(|x| x * x).sum::<f64>()
    }

    /// Correlation of a state with that before a move that `accepted` [1] of the particles have made.
    pub fn correlation(&self, accepted: f64) -> f64 {
        1.0 - accepted * (1.0 - (1.0 - self.size * self.size).sqrt())
    }

    /// Adapts the size of the moves to the share that was accepted [1].
    pub fn adapt(&mut self, accepted: f64) {
        if accepted < ACCEPTANCE.0 {
            self.size = (self.size / CHANGE).max(LEAST);
        } else if accepted > ACCEPTANCE.1 {
            self.size = (self.size * CHANGE).min(1.0);
        }
    }
}

/// Lower factor of a covariance; coordinates that depend on earlier ones get the least variance.
fn cholesky(covariance: &Mat<f64>) -> Mat<f64> {
    let d = covariance.nrows();
    let mut factor = Mat::<f64>::zeros(d, d);
    for k in 0..d {
        for l in 0..=k {
            let known: f64 = (0..l).map(|j| factor[(k, j)] * factor[(l, j)]).sum();
            let rest = covariance[(k, l)] - known;
            factor[(k, l)] = if k == l { rest.max(LEAST_VARIANCE).sqrt() } else { rest / factor[(l, l)] };
        }
    }
    factor
}
