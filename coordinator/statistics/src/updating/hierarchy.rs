//! Likelihood of the parameters theta of a population from what was observed of its units, which differ:
//!
//!   L_i(theta) = integral of l_i(x) f(x | theta) dx ~ sum over j of w_ij r_j(theta),   r = f(x | theta) / q(x),
//!
//! where the points x_ij with weights w_ij are those of unit i updated by its own observations with q as prior
//! ([`SequentialMonteCarlo`](super::SequentialMonteCarlo)): what was observed is evaluated once, whatever the number of parameters
//! that are tried. Units whose points are the same population share its weights r, and L_i is divided by their mean, so that the
//! error of a finite population mostly cancels.
//!
//! # Source
//! Hogg, Myers, Bovy (2010), Inferring the eccentricity distribution, The Astrophysical Journal 725(2), equation 9; Lunn, Barrett,
//! Sweeting, Thompson (2013), Fully Bayesian hierarchical modelling in two stages, Journal of the Royal Statistical Society C 62(4).

use super::parameters::ParameterSpace;
use super::particles::Predictions;
use super::reweighting::{PointPlaces, Reweighting};
use super::sequential::UnitModel;
use rayon::prelude::*;

/// Weighted points of units.
#[derive(Debug, Clone)]
pub struct UnitPoints {
    /// Places of the units among all.
    pub units: Vec<usize>,
    /// Weights of each of these units, of sum 1 `(units)(n,)` [1].
    pub weights: Vec<Vec<f64>>,
    /// Their places in the tables.
    pub points: PointPlaces,
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
        for set in &self.sets {
            let r = self.reweighting.weights(&laws, &set.points);
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
