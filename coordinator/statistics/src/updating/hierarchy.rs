//! Likelihood of the parameters theta of a population from what was observed of its units, which differ:
//!
//!   L_i(theta) = integral of l_i(x) f(x | theta) dx ~ sum over j of w_ij r_j(theta),   r = f(x | theta) / q(x),
//!
//! where the points x_ij with weights w_ij are those of unit i updated by its own observations with q as prior
//! ([`SequentialMonteCarlo`](super::SequentialMonteCarlo)): what was observed is evaluated once, whatever the number of parameters
//! that are tried. Units whose points are the same population share its weights r, and L_i is divided by their mean, so that the
//! error of a finite population mostly cancels.
//!
//! Weights of points that were drawn from one distribution, under others:
//!
//!   r_j = c(u_j) product over the changed variables k of f_k(x_jk) / q_k(x_jk),   u_jk = Phi^-1(F_k(x_jk)),
//!
//! with q the distribution of the points, independent in all these variables, f the changed one and c its copula. The changed variables are
//! independent of all others. With t the standard normal of a variable under q, f_k(x(t)) / q_k(x(t)), and u_k(t) where the copula is not
//! 1, are tabulated over t in [-5, 5] and interpolated linearly between the nodes, so that a change costs as many densities as there are
//! nodes, whatever the number of points.
//!
//! # Source
//! Hogg, Myers, Bovy (2010), Inferring the eccentricity distribution, The Astrophysical Journal 725(2), equation 9; Lunn, Barrett,
//! Sweeting, Thompson (2013), Fully Bayesian hierarchical modelling in two stages, Journal of the Royal Statistical Society C 62(4).
//! Importance sampling: Owen (2013), Monte Carlo theory, methods and examples, chapter 9.

use super::parameters::ParameterSpace;
use super::particles::Predictions;
use super::sequential::UnitModel;
use crate::design::InputModel;
use common::random::{Distribution, GaussianCopula};
use rayon::prelude::*;

/// Weighted points of units.
#[derive(Debug, Clone)]
pub struct UnitPoints {
    /// Places of the units among all.
    pub units: Vec<usize>,
    /// Weights of each of these units, of sum 1 `(units)(n,)` [1].
    pub weights: Vec<Vec<f64>>,
    /// Their places in the tables.
    pub points: Vec<f64>,
    /// True for a population drawn from q.
    pub is_population: bool,
}

/// A fleet whose population has unknown parameters; a state are its parameters as standard normals.
#[derive(Debug, Clone)]
pub struct Fleet {
    /// Space of the unknown parameters.
    pub space: ParameterSpace,
    /// Weights under changed parameters.
    pub reweighting: Reweighting,
    /// The units by their points; each unit once.
    pub sets: Vec<UnitPoints>,
    /// Number of units.
    pub units: usize,
}

impl Fleet {
    /// ln L of every unit at v `(p,)` [1]; minus infinity where a distribution does not exist or no point agrees `(units,)`.
    pub fn log_likelihoods(&self, v: &[f64]) -> Vec<f64> {
        let mut all = vec![f64::NEG_INFINITY; self.units];
        let Some(laws) = self.space.laws(v) else { return all };
        let ratios = self.reweighting.ratios(&laws);
        for set in &self.sets {
            let r = ratios.weights(&set.points);
            let mean = if set.is_population { r.iter().sum::<f64>() / r.len() as f64 } else { 1.0 };
            for (unit, weights) in set.units.iter().zip(&set.weights) {
                let sum: f64 = weights.iter().zip(&r).map(|(w, r)| w * r).sum();
                if sum > 0.0 && mean > 0.0 {
                    all[*unit] = (sum / mean).ln();
                }
            }
        }
        all
    }
}

impl UnitModel for Fleet {
    fn predict(&self, states: &[f64]) -> Predictions {
        let rows: Vec<&[f64]> = states.chunks_exact(self.space.dimension()).collect();
        let values: Vec<f64> = rows.par_iter().flat_map_iter(|v| self.log_likelihoods(v)).collect();
        let errors = vec![0.0; values.len()];
        Predictions { values_of_state: self.units, limit_states: 0, values, errors, lives: vec![] }
    }
}

/// Nodes of a table, and the standard normal of the last one.
const NODES: usize = 513;
const REACH: f64 = 5.0;
/// Largest standard normal of a point under a changed distribution [1].
const FARTHEST: f64 = 9.0;

/// The distributions of the points, tabulated.
#[derive(Debug, Clone)]
pub struct Reweighting {
    /// Index of each changed variable among the coordinates of a state `(K,)`.
    indices: Vec<usize>,
    /// Values at the nodes `(K)(NODES,)` [SI], and the densities of the points there.
    nodes: Vec<Vec<(f64, f64)>>,
}

impl Reweighting {
    /// Tables for points whose variables `indices` have the distributions `proposals` `(K,)`.
    pub fn new(indices: Vec<usize>, proposals: &[Distribution]) -> Self {
        let node = |law: &Distribution, i: usize| {
            let x = law.from_standard_normal(2.0 * REACH * i as f64 / (NODES - 1) as f64 - REACH);
            (x, law.pdf(x))
        };
        let nodes = proposals.iter().map(|law| (0..NODES).map(|i| node(law, i)).collect()).collect();
        Self { indices, nodes }
    }

    /// Points from states of `dimension` coordinates, independent standard normals `(n, D)` row-major.
    pub fn points(&self, states: &[f64], dimension: usize) -> Vec<f64> {
        let last = (NODES - 1) as f64;
        let place = |t: f64| ((t + REACH) / (2.0 * REACH) * last).clamp(0.0, last - 1e-9);
        let of_state = |v: &[f64]| self.indices.iter().map(|k| place(v[*k])).collect::<Vec<f64>>();
        states.chunks_exact(dimension).flat_map(of_state).collect()
    }

    /// Weights r of the points under the K distributions of `laws` with their dependence, not normalised `(n,)`.
    pub fn weights(&self, laws: &InputModel, points: &[f64]) -> Vec<f64> {
        self.ratios(laws).weights(points)
    }

    /// The K distributions of `laws` over those of the points, tabulated once for any points.
    fn ratios<'a>(&self, laws: &'a InputModel) -> DensityRatios<'a> {
        let tables = |of: &dyn Fn(&Distribution, &(f64, f64)) -> f64| -> Vec<Vec<f64>> {
            let table =
                |(law, nodes): (_, &Vec<(f64, f64)>)| nodes.iter().map(|node| of(law, node)).collect();
            laws.variables().iter().zip(&self.nodes).map(table).collect()
        };
        let ratios = tables(&|law, (x, q)| if *q > 0.0 { law.pdf(*x) / q } else { 0.0 });
        let normal =
            |law: &Distribution, (x, _): &(f64, f64)| law.to_standard_normal(*x).clamp(-FARTHEST, FARTHEST);
        let copula = (!laws.copula.is_independent()).then(|| (&laws.copula, tables(&normal)));
        DensityRatios { ratios, copula }
    }
}

/// f / q of every changed variable at the nodes `(K)(NODES,)` [1], and where the copula is not 1 that with the u there.
struct DensityRatios<'a> {
    ratios: Vec<Vec<f64>>,
    copula: Option<(&'a GaussianCopula, Vec<Vec<f64>>)>,
}

impl DensityRatios<'_> {
    fn weights(&self, points: &[f64]) -> Vec<f64> {
        let value = |(place, table): (&f64, &Vec<f64>)| {
            let node = *place as usize;
            let share = *place - node as f64;
            table[node] + share * (table[node + 1] - table[node])
        };
        let rows = points.chunks_exact(self.ratios.len());
        let product = |places: &[f64]| places.iter().zip(&self.ratios).map(value).product();
        let products = rows.clone().map(product);
        let Some((copula, normals)) = &self.copula else { return products.collect() };
        let u: Vec<f64> = rows.flat_map(|places| places.iter().zip(normals).map(value)).collect();
        products.zip(copula.log_densities(&u)).map(|(product, log): (f64, f64)| product * log.exp()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::random::Correlation;

    /// Points with standard normal variables under a bivariate normal: the ratio of both densities.
    #[test]
    fn weights_under_a_correlation_have_their_closed_form() {
        let (r, law) = (0.7_f64, Distribution::normal(3.0, 2.0).unwrap());
        let pair = Correlation { first: 0, second: 1, coefficient: r };
        let laws = InputModel::new(vec![law.clone(); 2], GaussianCopula::new(2, &[pair]).unwrap());
        let reweighting = Reweighting::new(vec![0, 2], &[law.clone(), law]);
        let states = [1.25, 9.0, -0.5, 0.0, 9.0, 2.5];
        let found = reweighting.weights(&laws, &reweighting.points(&states, 3));
        for (weight, v) in found.iter().zip(states.chunks_exact(3)) {
            let (a, b, rest) = (v[0], v[2], 1.0 - r * r);
            let exact = (-(r * r * (a * a + b * b) - 2.0 * r * a * b) / (2.0 * rest)).exp() / rest.sqrt();
            assert!((weight / exact - 1.0).abs() < 1e-9, "{weight} {exact}");
        }
    }
}
