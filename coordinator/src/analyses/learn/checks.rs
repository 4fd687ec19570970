//! What is to be checked: units that the population which the others have does not explain, and variables whose population leaves the
//! simulated values.

use super::population::WeightedPopulation;
use super::result::{LearnSettings, LearnedUnit, LeftVariable};
use crate::analyses::update::{Observation, ObservationRow, ObservedUnit, evidence_of, warning};
use crate::statistics::updating::{Evidence, Particles};
use common::random::Distribution;

/// Weights of the sets without each unit `(units)(P,)`, of sum 1.
pub fn weights_without(particles: &Particles, units: usize) -> Vec<Vec<f64>> {
    let of_unit = |i: usize| {
        let log = |t: usize| particles.weights[t].ln() - particles.predictions.value(t, i).0;
        let logs: Vec<f64> = (0..particles.len()).map(log).collect();
        let largest = logs.iter().copied().filter(|l| l.is_finite()).fold(f64::NEG_INFINITY, f64::max);
        let weights: Vec<f64> =
            logs.iter().map(|l| if l.is_finite() { (l - largest).exp() } else { 0.0 }).collect();
        let sum: f64 = weights.iter().sum();
        weights.into_iter().map(|w| w / sum).collect()
    };
    (0..units).map(of_unit).collect()
}

/// A unit whose observations are improbable under what the other units say.
pub fn check(
    population: &WeightedPopulation<'_>,
    unit: &ObservedUnit,
    weights: &[f64],
    settings: &LearnSettings,
) -> Option<LearnedUnit> {
    let prior = &population.prior;
    let (evidence, predictor) = evidence_of(prior, unit, &settings.units);
    let predictions = predictor.predictions(&prior.states, &prior.wanted, &prior.responses);
    let sum: f64 = weights.iter().sum();
    let weights = weights.iter().map(|w| w / sum).collect();
    let particles = Particles { dimension: 1, states: vec![], predictions, weights };
    let resolution = (3.0 / particles.effective_size()).min(1.0);
    let row = |(e, o): (&Evidence, &Observation)| ObservationRow {
        line: o.line,
        cycles: o.cycles,
        quantity: o.name.clone(),
        probability: e.probability(&particles),
        resolution,
    };
    let rows: Vec<ObservationRow> = evidence.iter().zip(&unit.observations).map(row).collect();
    warning(&rows).map(|warning| LearnedUnit { unit: unit.name.clone(), warning })
}

/// A variable whose population leaves the simulated values more than that of the study.
pub fn left(
    population: &WeightedPopulation<'_>,
    k: usize,
    known: &Distribution,
    name: &str,
    weights: &[f64],
) -> Option<LeftVariable> {
    let model = population.prior.model;
    let (lower, upper) = model.simulated_range(k);
    let width = model.inputs().dimension() + model.deviations();
    let law = &model.inputs().variables()[k];
    let is_outside = |v: &[f64]| !(lower..=upper).contains(&law.from_standard_normal(v[k]));
    let all = population.prior.states.chunks_exact(width).zip(weights);
    let outside: f64 =
        all.filter(|(v, _)| is_outside(v)).map(|(_, w)| w).sum::<f64>() / weights.iter().sum::<f64>();
    let of_study = known.cdf(lower) + known.survival(upper);
    (outside > 2.0 * of_study + 0.05).then(|| LeftVariable { name: name.to_owned(), outside, of_study })
}
