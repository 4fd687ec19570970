//! Updating by weights, and by sequential Monte Carlo where too few points carry the weight.
//!
//! Observations are taken one after the other. Each multiplies the weights by its likelihood. If the effective sample size
//! stays above a bound, that is all. Otherwise the observation is taken in stages of the temperature phi from 0 to 1: the next
//! phi is the largest that keeps half of the effective size, the particles are resampled, and Markov chain moves that leave
//!
//!   pi(v) ~ N(v; 0, I) L_1(v) ... L_(i-1)(v) L_i(v)^phi
//!
//! invariant make them different again, until a state has lost its correlation with where it began.
//!
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
//! Del Moral, Doucet, Jasra (2006), Sequential Monte Carlo samplers, Journal of the Royal Statistical Society B 68(3), section
//! 3; next temperature: Jasra, Stephens, Doucet, Tsagaris (2011), Inference for Levy-driven stochastic volatility models via
//! adaptive sequential Monte Carlo, Scandinavian Journal of Statistics 38(1).
//! Rudolf, Sprungk (2018), On a generalization of the preconditioned Crank-Nicolson Metropolis algorithm, Foundations of
//! Computational Mathematics 18(2).

use super::evidence::Evidence;
use super::particles::{Particles, Predictions, effective_size};
use faer::Mat;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use thiserror::Error;

/// Correlation with the state before the moves, at which they end [1].
const FORGOTTEN: f64 = 0.05;
/// Least and most moves of a stage.
const MOVES: (usize, usize) = (3, 40);
/// Bisections of the next temperature.
const BISECTIONS: usize = 50;
/// Most stages of one observation.
const MOST_STAGES: usize = 400;
/// Least step of the temperature [1], and least effective size after it.
const LEAST_STEP: f64 = 1e-7;
const LEAST_SIZE: f64 = 20.0;

/// Predictions of measured values and lives from the state of a unit, or of likelihoods from the parameters of a population.
pub trait UnitModel {
    /// Predictions at states `(b, D)` row-major [1].
    fn predict(&self, states: &[f64]) -> Predictions;
}

/// Settings of the updating.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SequentialMonteCarlo {
    /// Number of particles that are moved.
    pub particles: usize,
    /// Least effective sample size of weights without moves; once particles were moved it is half of their number.
    pub least: f64,
}

/// No particle agrees with an observation, which has a small probability or none.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("no particle agrees with observation {place}: its probability is below {resolution:.1e}")]
pub struct Unsupported {
    /// Index of the observation.
    pub place: usize,
    /// Probability that the particles exclude with 95 % [1].
    pub resolution: f64,
}

/// Occurrences excluded with 95 % if none is seen: rule of three, Hanley, Lippman-Hand (1983).
const RULE_OF_THREE: f64 = 3.0;

/// The state of a unit after its observations.
#[derive(Debug, Clone)]
pub struct UnitPosterior {
    /// Weighted states with predictions.
    pub particles: Particles,
    /// Effective sample size, reduced by the correlation that moves have left [1].
    pub effective_size: f64,
    /// Predictive probability of each observation under those before it [1].
    pub probabilities: Vec<f64>,
    /// Probability that the particles do not show, 3 over their effective size, at most 1, at each observation [1].
    pub resolutions: Vec<f64>,
    /// Stages of tempering; 0 if weights sufficed.
    pub stages: usize,
    /// Share of the moves that were accepted [1]; `None` without any.
    pub acceptance: Option<f64>,
}

impl SequentialMonteCarlo {
    /// Updates `prior` by observations in their order.
    ///
    /// # Errors
    /// [`Unsupported`].
    pub fn update(
        &self,
        prior: Particles,
        evidence: &[Evidence],
        model: &dyn UnitModel,
        rng: &mut impl Rng,
    ) -> Result<UnitPosterior, Unsupported> {
        let mut run = Run { settings: *self, particles: prior, correlation: 0.0, stages: 0, moves: (0, 0) };
        let mut probabilities = Vec::with_capacity(evidence.len());
        let mut resolutions = Vec::with_capacity(evidence.len());
        for place in 0..evidence.len() {
            let resolution = (RULE_OF_THREE / run.effective_size().max(1.0)).min(1.0);
            probabilities.push(evidence[place].probability(&run.particles));
            resolutions.push(resolution);
            run.take(&evidence[..=place], model, rng).ok_or(Unsupported { place, resolution })?;
        }
        let (accepted, tried) = run.moves;
        Ok(UnitPosterior {
            effective_size: run.effective_size(),
            particles: run.particles,
            probabilities,
            resolutions,
            stages: run.stages,
            acceptance: (tried > 0).then(|| accepted as f64 / tried as f64),
        })
    }
}

/// An updating under way.
struct Run {
    settings: SequentialMonteCarlo,
    particles: Particles,
    /// Correlation that the last moves have left [1].
    correlation: f64,
    stages: usize,
    /// Accepted and tried moves.
    moves: (usize, usize),
}

impl Run {
    /// Effective sample size, reduced by the correlation that moves have left [1].
    fn effective_size(&self) -> f64 {
        self.particles.effective_size() * (1.0 - self.correlation) / (1.0 + self.correlation)
    }

    /// Takes the last of the observations so far; `None` if no particle agrees with it.
    fn take(&mut self, evidence: &[Evidence], model: &dyn UnitModel, rng: &mut impl Rng) -> Option<()> {
        let (newest, _) = evidence.split_last()?;
        let mut phi = 0.0;
        for _ in 0..MOST_STAGES {
            let whole = self.reweighted(newest, phi, 1.0);
            let size = effective_size(&whole);
            let SequentialMonteCarlo { particles, least } = self.settings;
            if size >= if self.stages == 0 { least } else { 0.5 * particles as f64 } {
                self.particles.weights = whole;
                return Some(());
            }
            let next = self.next_temperature(newest, phi)?;
            self.particles.weights = self.reweighted(newest, phi, next);
            phi = next;
            self.particles = self.particles.resampled(self.settings.particles, rng.random());
            self.stages += 1;
            self.move_particles(evidence, phi, model, rng);
            if phi >= 1.0 {
                return Some(());
            }
        }
        None
    }

    /// Weights after the change of the newest observation's temperature `(n,)`, of sum 1; all 0 if none agrees.
    fn reweighted(&self, newest: &Evidence, from: f64, to: f64) -> Vec<f64> {
        let change = |(i, w): (usize, &f64)| {
            if *w == 0.0 {
                return f64::NEG_INFINITY;
            }
            let [before, after] = [from, to].map(|phi| newest.log_likelihood(&self.particles, i, phi));
            w.ln() + (after - before)
        };
        let logs: Vec<f64> = self.particles.weights.iter().enumerate().map(change).collect();
        let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if largest == f64::NEG_INFINITY {
            return vec![0.0; logs.len()];
        }
        let weights: Vec<f64> = logs.iter().map(|l| (l - largest).exp()).collect();
        let sum: f64 = weights.iter().sum();
        weights.into_iter().map(|w| w / sum).collect()
    }

    /// The largest temperature that keeps half of the effective size, or half of the particles if these are fewer.
    fn next_temperature(&self, newest: &Evidence, phi: f64) -> Option<f64> {
        let target = 0.5 * self.particles.effective_size().min(self.settings.particles as f64);
        let size = |to: f64| effective_size(&self.reweighted(newest, phi, to));
        if size(1.0) >= target {
            return Some(1.0);
        }
        let (mut low, mut high) = (phi, 1.0);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if size(middle) >= target { low = middle } else { high = middle }
        }
        let next = low.max(phi + LEAST_STEP).min(1.0);
        (size(next) >= LEAST_SIZE.min(target)).then_some(next)
    }

    /// Moves all particles until they have lost the correlation with where they began.
    fn move_particles(&mut self, evidence: &[Evidence], phi: f64, model: &dyn UnitModel, rng: &mut impl Rng) {
        let mut proposal = Proposal::new(&self.particles);
        let (n, d) = (self.particles.len(), self.particles.dimension);
        let target = |particles: &Particles, i: usize| {
            let last = evidence.len() - 1;
            let likelihood = |(place, e): (usize, &Evidence)| {
                e.log_likelihood(particles, i, if place == last { phi } else { 1.0 })
            };
            let prior = -0.5 * particles.state(i).iter().map(|x| x * x).sum::<f64>();
            prior + evidence.iter().enumerate().map(likelihood).sum::<f64>()
        };
        self.correlation = 1.0;
        for count in 1..=MOVES.1 {
            let proposed: Vec<f64> =
                (0..n).flat_map(|i| proposal.propose(self.particles.state(i), rng)).collect();
            let predictions = model.predict(&proposed);
            let proposed = Particles::equal(d, proposed, predictions);
            let mut accepted = 0;
            for i in 0..n {
                let gain = target(&proposed, i) + proposal.distance(proposed.state(i))
                    - target(&self.particles, i)
                    - proposal.distance(self.particles.state(i));
                if rng.random::<f64>().ln() < gain {
                    accepted += 1;
                    self.particles.states[i * d..(i + 1) * d].copy_from_slice(proposed.state(i));
                    self.particles.predictions.copy(i, &proposed.predictions, i);
                }
            }
            self.moves = (self.moves.0 + accepted, self.moves.1 + n);
            let share = accepted as f64 / n as f64;
            self.correlation *= proposal.correlation(share);
            proposal.adapt(share);
            if count >= MOVES.0 && self.correlation < FORGOTTEN {
                return;
            }
        }
    }
}

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
