//! Derivatives of failure probabilities with respect to the means and standard deviations of the random
//! variables, from the classified population alone.
//!
//! With I the failure indicator, f the joint density and s = d ln f(x) / dp the score of variable k for its
//! parameter p,
//!
//!   dP_f/dp = E[I s] = E[(I - P_f) s],   standard error = sqrt(Var[(I - P_f) s] / N).
//!
//! The second form holds because a score has mean zero; it has the smaller variance, above all where P_f is
//! near 1. The standard error contains sampling only, not the surrogate error; for a Latin hypercube, which is
//! taken as independent samples, it is too large. The bounds of bounded variables are held fixed.
//!
//! Under a condition C that every failure implies, dP_f/dp = P(C) E[I s | C]. The samples given C descend by
//! Markov chains from N independent samples j of the first level; with T_j the sum of I s over the descendants
//! of j among the N samples given C,
//!
//!   standard error^2 = P(C)^2 [sum over j of T_j^2 / N^2 - (sum over j of T_j)^2 / N^3],
//!
//! which contains the uncertainty of P(C) and the correlation along the chains and between levels.
//!
//! The score of independent variables is that of x_k alone. With a Gaussian copula, f(x) = c(u) prod_j
//! f_j(x_j), u_j = Phi^-1(F_j(x_j)), the parameter of variable k moves u_k at a fixed x as well:
//!
//!   s = d ln f_k(x_k) / dp + (d ln c / du_k) (dF_k(x_k) / dp) / phi(u_k),   d ln c / du_k = -((R^-1 - I) u)_k.
//!
//! The correlation matrix R of the copula is held fixed. The derivative exists for every parameter on which
//! the support of the density does not depend.
//!
//! # Source
//! Wu (1994), Computational methods for efficient structural reliability and reliability sensitivity
//! analysis, AIAA Journal 32(8); Millwater (2009), Universal properties of kernel functions for probabilistic
//! sensitivity analysis, Probabilistic Engineering Mechanics 24(1). Over conditional samples: Song, Lu, Qiao
//! (2009), Subset simulation for structural reliability sensitivity analysis, Reliability Engineering &
//! System Safety 94(2). Their variance from the genealogy: Lee, Whiteley (2018), Variance estimation in the
//! particle filter, Biometrika 105(3). The copula's term follows by the chain rule.
//!
//! # Example
//! The probability that a normal variable of mean 1 and standard deviation 2 exceeds 3 is Phi(-1); its
//! derivative with respect to the mean is phi(1) / 2 = 0.121:
//!
//! ```
//! use common::random::Distribution;
//! use statistics::design::Population;
//! use statistics::sensitivity::{Sampled, sensitivities};
//!
//! let population = Population::draw(&[Distribution::normal(1.0, 2.0).unwrap()], 20_000, 7);
//! let points: Vec<usize> = (0..population.len()).collect();
//! // One curve over one checkpoint: failed by checkpoint 0, or never (1).
//! let first_failure = points.iter().map(|j| u32::from(population.physical(*j)[0] < 3.0)).collect();
//! let sampled = Sampled { population: &population, points: &points, probability: 1.0 };
//! let derivative = sensitivities(&sampled, &[first_failure], &[0], 1)[0].to_mean;
//! assert!((derivative.value - 0.12099).abs() < 4.0 * derivative.standard_error);
//! ```

mod sobol;

pub use sobol::{SAMPLES, Sobol, sobol_indices, surrogate_errors};

use crate::design::Population;
use common::random::{Distribution, standard_normal_pdf};
use rayon::prelude::*;

/// Derivatives of one curve at one checkpoint with respect to the parameters of one variable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensitivity {
    /// Index of the curve: the modes in order, then the system.
    pub curve: usize,
    /// Index of the checkpoint.
    pub checkpoint: usize,
    /// Index of the variable.
    pub variable: usize,
    /// Derivative of P_f with respect to the mean [1/unit of the variable].
    pub to_mean: Estimate,
    /// Derivative of P_f with respect to the standard deviation [1/unit of the variable].
    pub to_std: Estimate,
}

/// A value and its standard error.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Estimate {
    /// Estimate of the quantity.
    pub value: f64,
    /// Standard error of the value.
    pub standard_error: f64,
}

impl Estimate {
    fn times(self, factor: f64) -> Self {
        Self { value: factor * self.value, standard_error: factor * self.standard_error }
    }
}

/// Bound of |u| [1]: normals of points that rounding has put on a bound are infinite, and no draw of a
/// population lies further out.
const LARGEST_NORMAL: f64 = 9.0;

/// Derivative of a failure share at a checkpoint, where this share has failed [1].
type Derivative = Box<dyn Fn(usize, f64) -> Estimate + Send>;

/// E[I s | C] by the sums of I s over the descendants of each origin; `descent` `(N,)` numbers the origins with descendants from 0.
fn over_descendants(scores: &[f64], first_failure: &[u32], descent: &[usize], m: usize) -> Derivative {
    let origins = descent.iter().max().map_or(0, |last| last + 1);
    // By origin and first failure `(origins with descendants, m + 1)`.
    let mut by_origin = vec![vec![0.0; m + 1]; origins];
    for ((s, first), origin) in scores.iter().zip(first_failure).zip(descent) {
        by_origin[*origin][*first as usize] += s;
    }
    let count = scores.len() as f64;
    Box::new(move |n, _| {
        let sums = by_origin.iter().map(|sums| sums[..=n].iter().sum::<f64>());
        let (sum, squares) = sums.fold((0.0, 0.0), |(sum, squares), t| (sum + t, squares + t * t));
        let variance = (squares - sum * sum / count).max(0.0) / (count * count);
        Estimate { value: sum / count, standard_error: variance.sqrt() }
    })
}

/// E[(I - P_f) s] by the sums of the score and of its square over independent samples.
fn over_independent(scores: &[f64], first_failure: &[u32], m: usize) -> Derivative {
    // By first failure `(m + 1, 2)`; the last row is of the points that never fail.
    let mut by_first_failure = vec![[0.0; 2]; m + 1];
    for (s, first) in scores.iter().zip(first_failure) {
        let sums = &mut by_first_failure[*first as usize];
        sums[0] += s;
        sums[1] += s * s;
    }
    let count = scores.len() as f64;
    Box::new(move |n, pf| {
        let sum = |range: &[[f64; 2]]| range.iter().fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
        let (failed, all) = (sum(&by_first_failure[..=n]), sum(&by_first_failure));
        let value = (failed[0] - pf * all[0]) / count;
        let square = ((1.0 - 2.0 * pf) * failed[1] + pf * pf * all[1]) / count;
        Estimate { value, standard_error: ((square - value * value).max(0.0) / count).sqrt() }
    })
}

/// Classified samples of a population.
#[derive(Debug, Clone, Copy)]
pub struct Sampled<'a> {
    /// Population of the samples.
    pub population: &'a Population,
    /// Indices of the samples in the population `(N,)`.
    pub points: &'a [usize],
    /// Probability of the event the population is conditional on [1]; 1 without condition.
    pub probability: f64,
}

/// Derivatives of every curve at the given checkpoints with respect to every variable, ordered by checkpoint,
/// curve, variable.
///
/// `first_failures` `(curves)(N,)` holds the index of the checkpoint by which each sample has failed, m if
/// never. Where the population descends from fewer independent samples, the form for a condition is used.
pub fn sensitivities(
    sampled: &Sampled<'_>,
    first_failures: &[Vec<u32>],
    checkpoints: &[usize],
    m: usize,
) -> Vec<Sensitivity> {
    let Sampled { population, points, probability } = *sampled;
    let count = points.len();
    let failed_share = |first: &[u32], n: usize| {
        first.iter().filter(|first| **first as usize <= n).count() as f64 / count as f64
    };
    let descent = numbered_origins(population, points);
    // By variable, parameter and curve.
    let of_variable = |(k, variable): (usize, &Distribution)| {
        let own = variable.score_function();
        let scores: Vec<[f64; 2]> = points.iter().map(|j| scores(population, &own, *j, k)).collect();
        [0, 1].map(|parameter| -> Vec<Derivative> {
            let scores: Vec<f64> = scores.iter().map(|s| s[parameter]).collect();
            let derivative = |first: &Vec<u32>| match &descent {
                None => over_independent(&scores, first, m),
                Some(descent) => over_descendants(&scores, first, descent, m),
            };
            first_failures.iter().map(derivative).collect()
        })
    };
    let derivatives: Vec<[Vec<Derivative>; 2]> =
        population.inputs.variables().par_iter().enumerate().map(of_variable).collect();
    let mut rows = Vec::new();
    for checkpoint in checkpoints {
        for (curve, first) in first_failures.iter().enumerate() {
            let pf = failed_share(first, *checkpoint);
            let estimate = |of: &[Derivative]| of[curve](*checkpoint, pf).times(probability);
            for (variable, [mean, std]) in derivatives.iter().enumerate() {
                rows.push(Sensitivity {
                    curve,
                    checkpoint: *checkpoint,
                    variable,
                    to_mean: estimate(mean),
                    to_std: estimate(std),
                });
            }
        }
    }
    rows
}

/// Number, from 0, of the origin of each sample `(N,)`; `None` if the samples are independent.
fn numbered_origins(population: &Population, points: &[usize]) -> Option<Vec<usize>> {
    let origins = &population.origins;
    if origins.is_empty() {
        return None;
    }
    let mut distinct: Vec<u32> = points.iter().map(|j| origins[*j]).collect();
    distinct.sort_unstable();
    distinct.dedup();
    let number = |j: &usize| distinct.binary_search(&origins[*j]).expect("each origin is among them");
    Some(points.iter().map(number).collect())
}

/// Scores of point `j` for the mean and the standard deviation of variable `k`, which has the scores `own` by itself `(2,)`
/// [1/unit of the variable].
fn scores(population: &Population, own: &dyn Fn(f64) -> [f64; 2], j: usize, k: usize) -> [f64; 2] {
    let x = population.physical_value(j, k);
    let own = own(x);
    let copula = &population.inputs.copula;
    if !copula.is_correlated(k) {
        return own;
    }
    let normal = |i: usize| {
        let u = population.inputs.variables()[i].to_standard_normal(population.physical_value(j, i));
        u.clamp(-LARGEST_NORMAL, LARGEST_NORMAL)
    };
    let slope = copula.score(k, normal) / standard_normal_pdf(normal(k));
    let moved = population.inputs.variables()[k].cdf_derivatives(x);
    [0, 1].map(|p| own[p] + slope * moved[p])
}

#[cfg(test)]
mod tests;
