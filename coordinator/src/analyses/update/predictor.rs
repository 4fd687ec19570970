//! The prior of a unit, which is the beginning of the study's own population with its deviations, and the predictions of what
//! was measured of it.

use super::observation::Observable;
use crate::statistics::design::{Population, deviation};
use crate::statistics::updating::{Predictions, UnitModel};
use crate::study::{LifeModel, LifeResponses};
use faer::MatRef;
use rayon::prelude::*;

/// The population with its lives and the histories of the measured outputs.
pub(in crate::analyses) struct Prior<'a> {
    pub model: &'a LifeModel,
    /// States `(N, d + deviations)` row-major [1].
    pub states: Vec<f64>,
    /// Measured outputs of the fleet.
    pub wanted: Vec<usize>,
    pub responses: LifeResponses,
}

impl<'a> Prior<'a> {
    /// The first `points` points of the population of the study with this seed.
    pub fn new(model: &'a LifeModel, wanted: Vec<usize>, points: usize, seed: u64) -> Self {
        let inputs = &model.inputs;
        let population = Population::draw(inputs, points, seed);
        let width = model.deviations();
        let deviations: Vec<f64> =
            (0..population.len()).flat_map(|j| (0..width).map(move |s| deviation(s, j))).collect();
        let normals = |j: usize| {
            let x = population.physical(j);
            let normal = |(variable, x): (&common::random::Distribution, &f64)| {
                let u = if variable.is_constant() { 0.0 } else { variable.to_standard_normal(*x) };
                u.clamp(-8.0, 8.0)
            };
            let u: Vec<f64> = inputs.variables().iter().zip(&x).map(normal).collect();
            let own = &deviations[j * width..(j + 1) * width];
            [inputs.copula.decorrelate(&u).as_slice(), own].concat()
        };
        let states = (0..population.len()).into_par_iter().flat_map_iter(normals).collect();
        let responses = model.respond(population.columns(0..population.len()), &deviations, &wanted);
        Self { model, states, wanted, responses }
    }
}

/// The predictions that the observations of one unit need.
pub(in crate::analyses) struct UnitPredictor<'a> {
    pub model: &'a LifeModel,
    /// Measured quantities in the order of their values, with their lives.
    pub measured: Vec<(Observable, f64)>,
    /// Outputs among them.
    pub outputs: Vec<usize>,
    /// Whether the stated numerical errors of the simulations count.
    pub numerical_errors: bool,
}

impl UnitPredictor<'_> {
    /// Predictions from lives and histories of `wanted` outputs; `states` are rows of `dimension` coordinates.
    pub fn predictions(&self, states: &[f64], wanted: &[usize], responses: &LifeResponses) -> Predictions {
        let (model, d) = (self.model, self.model.inputs.dimension());
        let predicted = |(j, v): (usize, &[f64]), (measured, life): &(Observable, f64)| match *measured {
            Observable::Output(output) => {
                let place = wanted.iter().position(|w| *w == output).unwrap_or(0);
                let value = model.value_at(output, &responses.histories[place], j, *life);
                (value, model.error_at(output, value, *life, self.numerical_errors))
            }
            Observable::Variable(variable) => (physical(model, &v[..d], variable), 0.0),
        };
        let rows = states.chunks_exact(d + model.deviations()).enumerate();
        let all = rows.flat_map(|row| self.measured.iter().map(move |measured| predicted(row, measured)));
        let (values, errors) = all.unzip();
        let (values_of_state, limit_states) = (self.measured.len(), model.limit_states());
        Predictions { values_of_state, limit_states, values, errors, lives: responses.lives.clone() }
    }
}

impl UnitModel for UnitPredictor<'_> {
    fn predict(&self, states: &[f64]) -> Predictions {
        let (inputs, width) = (&self.model.inputs, self.model.deviations());
        let d = inputs.dimension();
        let rows = states.chunks_exact(d + width);
        let standardised = |v: &[f64]| inputs.standardise(&inputs.from_independent_normals(&v[..d]));
        let points: Vec<f64> = rows.clone().flat_map(standardised).collect();
        let deviations: Vec<f64> = rows.flat_map(|v| v[d..].iter().copied()).collect();
        let columns = MatRef::from_column_major_slice(&points, d, points.len() / d);
        let responses = self.model.respond(columns, &deviations, &self.outputs);
        self.predictions(states, &self.outputs, &responses)
    }
}

/// Variable `k` [SI] from independent normals `(d,)`.
fn physical(model: &LifeModel, v: &[f64], k: usize) -> f64 {
    let inputs = &model.inputs;
    if inputs.copula.is_correlated(k) {
        return inputs.from_independent_normals(v)[k];
    }
    inputs.variables()[k].from_standard_normal(v[k])
}
