//! The true failure probability of a random problem, and the limit at which it has the wanted value.
//!
//! Points are drawn around every centre c_k (the origin, and where rare failures are most likely), as many around each, and
//! weighted by
//!
//!   w(u) = 1 / (1/K sum over k of exp(c_k . u - |c_k|^2 / 2)),
//!
//! which makes the mean of w times the indicator of failure unbiased for any centres. With up to three variables the points
//! are those of a shifted lattice, with more they are random; either way in eight independent batches, whose
//! spread gives the standard error. Lives of known distribution have a closed form instead.
//!
//! # Source
//! Balance heuristic: Veach, Guibas (1995); Owen, Zhou (2000), Safe and effective importance sampling. Lattices:
//! generalised golden ratio, Roberts (2018).

use super::course::Course;
use super::known_lives::{failed_by, life_of_share};
use super::problem::RandomProblem;
use super::response::dot;
use common::random::{Distribution as Law, standard_normal_quantile};
use rand::RngExt;
use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

/// Number of independent batches.
const BATCHES: u64 = 8;
/// Points of a batch on a lattice, and random ones.
const LATTICE: usize = 120_000;
const RANDOM: usize = 240_000;
/// Most variables of a lattice.
const LATTICE_VARIABLES: usize = 3;

/// Limit and truth of a problem.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// Limit of the response [1].
    pub limit: f64,
    /// Standard deviation of the first response at the end of life [1].
    pub spread: f64,
    /// Failure probability by each checkpoint `(m,)` [1].
    pub pf: Vec<f64>,
    /// Standard error of each `(m,)` [1].
    pub standard_error: Vec<f64>,
}

/// Weight and running maxima of one batch.
struct Batch {
    weights: Vec<f64>,
    /// Running maxima `(points, kept)` row-major [1]; see [`kept`].
    maxima: Vec<f64>,
}

/// Checkpoints whose running maxima are kept: all, or the first where the others are its multiples.
const fn kept(problem: &RandomProblem) -> usize {
    match problem.course {
        Course::Wear { .. } => 1,
        _ => problem.course.checkpoints(),
    }
}

/// Truth of a problem; the limit has the wanted probability at the end of life.
pub fn truth(problem: &RandomProblem) -> Truth {
    match &problem.course {
        Course::Wear { checkpoints, laws } if !laws.is_empty() => {
            of_known_lives(laws, *checkpoints, problem.wanted)
        }
        _ => integrated(problem),
    }
}

/// Truth of a problem whose life over the limit is the least of independent variables.
fn of_known_lives(laws: &[Law], m: usize, wanted: f64) -> Truth {
    let limit = m as f64 / life_of_share(laws, wanted);
    let pf = (1..=m).map(|n| failed_by(laws, n as f64 / limit)).collect();
    Truth { limit, spread: 0.0, pf, standard_error: vec![0.0; m] }
}

fn integrated(problem: &RandomProblem) -> Truth {
    let (m, kept) = (problem.checkpoints(), kept(problem));
    let batches: Vec<Batch> = (0..BATCHES).into_par_iter().map(|batch| evaluate(problem, batch)).collect();
    let points: usize = batches.iter().map(|batch| batch.weights.len()).sum();
    let mut last: Vec<(f64, f64)> = Vec::with_capacity(points);
    for batch in &batches {
        let factor = (m / kept) as f64;
        let of_batch = batch.maxima.iter().skip(kept - 1).step_by(kept).map(|y| y * factor);
        last.extend(of_batch.zip(batch.weights.iter().copied()));
    }
    let moment = |power: i32| last.iter().map(|(y, w)| w * y.powi(power)).sum::<f64>() / points as f64;
    let spread = (moment(2) - moment(1).powi(2)).max(0.0).sqrt();
    last.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    let (mut sum, mut limit) = (0.0, f64::NAN);
    for pair in last.windows(2) {
        sum += pair[0].1;
        if sum >= problem.wanted * points as f64 {
            limit = 0.5 * (pair[0].0 + pair[1].0);
            break;
        }
    }
    let (mut pf, mut standard_error) = (Vec::with_capacity(m), Vec::with_capacity(m));
    for n in 0..m {
        let shares: Vec<f64> = batches.iter().map(|batch| batch.share(n, kept, limit)).collect();
        let mean = shares.iter().sum::<f64>() / shares.len() as f64;
        let variance = shares.iter().map(|share| (share - mean).powi(2)).sum::<f64>();
        let count = shares.len() as f64;
        pf.push(mean);
        standard_error.push((variance / (count - 1.0) / count).sqrt());
    }
    Truth { limit, spread, pf, standard_error }
}

impl Batch {
    /// Estimate of the failure probability by checkpoint n [1] from `kept` running maxima of each point.
    fn share(&self, n: usize, kept: usize, limit: f64) -> f64 {
        let place = n.min(kept - 1);
        let factor = (n - place + 1) as f64;
        let failed =
            self.weights.iter().enumerate().filter(|(j, _)| self.maxima[j * kept + place] * factor >= limit);
        failed.map(|(_, w)| w).sum::<f64>() / self.weights.len() as f64
    }
}

fn evaluate(problem: &RandomProblem, batch: u64) -> Batch {
    let (d, kept) = (problem.dimension(), kept(problem));
    let mut rng = ChaCha12Rng::seed_from_u64(problem.index);
    rng.set_stream(batch);
    let centres = &problem.centres;
    let each = if d <= LATTICE_VARIABLES { LATTICE } else { RANDOM } / centres.len();
    let mut weights = Vec::with_capacity(each * centres.len());
    let mut maxima = Vec::with_capacity(each * centres.len() * kept);
    let (mut u, mut z, mut history) = (vec![0.0; d], vec![0.0; d], vec![0.0; kept]);
    for centre in centres {
        let lattice = (d <= LATTICE_VARIABLES).then(|| Lattice::new(each, d, &mut rng));
        for i in 0..each {
            match &lattice {
                Some(lattice) => lattice.point(i, &mut u),
                None => u.iter_mut().for_each(|u| *u = StandardNormal.sample(&mut rng)),
            }
            u.iter_mut().zip(centre).for_each(|(u, c)| *u += c);
            let density = |c: &Vec<f64>| (dot(c, &u) - 0.5 * dot(c, c)).exp();
            weights.push(centres.len() as f64 / centres.iter().map(density).sum::<f64>());
            problem.standardised(&u, &mut z);
            problem.running_maximum(&z, &mut history);
            maxima.extend_from_slice(&history);
        }
    }
    Batch { weights, maxima }
}

/// A lattice of standard normals with a random shift.
struct Lattice {
    /// Quantiles of the n cells of (0, 1).
    quantiles: Vec<f64>,
    /// Step and shift of each variable, in cells.
    steps: Vec<(usize, usize)>,
}

impl Lattice {
    fn new(n: usize, d: usize, rng: &mut ChaCha12Rng) -> Self {
        let within: f64 = rng.random_range(0.05..0.95);
        let quantiles = (0..n).map(|j| standard_normal_quantile((j as f64 + within) / n as f64)).collect();
        // The first variable runs through its cells in turn; the others step by powers of the root of x^d = x + 1.
        let root = (0..50).fold(1.5_f64, |x, _| (1.0 + x).powf(1.0 / d as f64));
        let steps = (0..d).map(|k| {
            let step = if k == 0 { 1 } else { (n as f64 / root.powi(k as i32)).round() as usize };
            (step, rng.random_range(0..n))
        });
        Self { quantiles, steps: steps.collect() }
    }

    fn point(&self, i: usize, u: &mut [f64]) {
        let n = self.quantiles.len();
        for (u, (step, shift)) in u.iter_mut().zip(&self.steps) {
            *u = self.quantiles[(i * step + shift) % n];
        }
    }
}
