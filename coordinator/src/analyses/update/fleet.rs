//! Updating of every unit of a fleet: observations as evidence, and the report of each unit from its posterior.

use super::observation::{Observation, ObservedUnit, Quantity};
use super::predictor::{Prior, UnitPredictor};
use super::result::{FleetReport, ObservationRow, RemainingLife, UnitReport, UpdatedVariable};
use crate::presentation::report::untested::not_in_answer;
use crate::results::life_summary::{CyclesRange, LifeRow};
use crate::results::summary::{PerLimitState, ReliabilityRow, StudySummary};
use crate::statistics::design::{Stream, open_stream};
use crate::statistics::reliability::REACH;
use crate::statistics::updating::{Evidence, Particles, SequentialMonteCarlo, UnitPosterior, Unsupported};
use crate::study::{LEVELS, LifeModel};
use common::scene::Scene;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Probability, times the number of a unit's observations, below which an observation is improbable [1].
const IMPROBABLE: f64 = 0.01;
/// Effective sample size below which no quantile is stated: at 10 the 95 % interval of the median reaches from the 19 % to the 81 %
/// quantile.
const LEAST_SIZE: f64 = 10.0;

/// Settings of the updating.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FleetSettings {
    /// Points of the population that are weighted.
    pub population: usize,
    /// Updating by weights and moves.
    pub monte_carlo: SequentialMonteCarlo,
    /// Whether the stated numerical errors of the simulations widen the likelihood of a measurement. They do, unless the units
    /// themselves were simulated, with the same errors.
    pub numerical_errors: bool,
    /// Seed of every random draw: that of the study.
    pub seed: u64,
}

impl FleetSettings {
    /// Defaults for a study with this seed.
    pub fn new(seed: u64) -> Self {
        let monte_carlo = SequentialMonteCarlo { particles: 2000, least: 500.0 };
        Self { population: 20_000, monte_carlo, numerical_errors: true, seed }
    }
}

/// Updates every unit.
pub fn update(
    scene: &Scene,
    summary: &StudySummary,
    model: &LifeModel,
    units: &[ObservedUnit],
    settings: &FleetSettings,
) -> FleetReport {
    let prior = Prior::new(model, outputs_of(units), settings.population, settings.seed);
    let updated = |(number, unit): (usize, &ObservedUnit)| match posterior(&prior, unit, number, settings) {
        Ok(posterior) => report(scene, model, unit, &posterior),
        Err(found) => unsupported(unit, found),
    };
    FleetReport {
        scene: scene.name.clone(),
        evaluations: 0,
        reliability: summary.reliability.clone(),
        lives: summary.lives.clone(),
        caution: not_in_answer(summary),
        end: model.end(),
        population: settings.population,
        units: units.par_iter().enumerate().map(updated).collect(),
    }
}

/// Outputs that were measured of any unit.
pub(in crate::analyses) fn outputs_of(units: &[ObservedUnit]) -> Vec<usize> {
    units.iter().flat_map(ObservedUnit::outputs).collect::<BTreeSet<_>>().into_iter().collect()
}

/// The evidence of a unit's observations, and what its predictor predicts for them.
pub(in crate::analyses) fn evidence_of<'a>(
    prior: &Prior<'a>,
    unit: &ObservedUnit,
    settings: &FleetSettings,
) -> (Vec<Evidence>, UnitPredictor<'a>) {
    let outputs = outputs_of(std::slice::from_ref(unit));
    let mut measured = Vec::new();
    let mut evidence = Vec::new();
    for &Observation { quantity, cycles: life, .. } in &unit.observations {
        evidence.push(match quantity {
            Quantity::Measured { of, value, error } => {
                measured.push((of, life));
                Evidence::Measured { index: measured.len() - 1, value, std: error }
            }
            Quantity::Survived => Evidence::Survived(life),
            Quantity::Failed { by, error: None } => Evidence::Failed { life, by },
            Quantity::Failed { by, error: Some(std) } => Evidence::Life { life, std, by },
        });
    }
    let (model, numerical_errors) = (prior.model, settings.numerical_errors);
    (evidence, UnitPredictor { model, measured, outputs, numerical_errors })
}

/// A unit after its observations, with the population of `prior` before them.
///
/// # Errors
/// [`Unsupported`].
pub(in crate::analyses) fn posterior(
    prior: &Prior<'_>,
    unit: &ObservedUnit,
    number: usize,
    settings: &FleetSettings,
) -> Result<UnitPosterior, Unsupported> {
    let (evidence, predictor) = evidence_of(prior, unit, settings);
    let predictions = predictor.predictions(&prior.states, &prior.wanted, &prior.responses);
    let dimension = prior.model.inputs.dimension() + prior.model.deviations();
    let particles = Particles::equal(dimension, prior.states.clone(), predictions);
    let mut rng = open_stream(settings.seed, Stream::Unit(number as u32));
    settings.monte_carlo.update(particles, &evidence, &predictor, &mut rng)
}

/// The report of a unit that no point of the model agrees with.
fn unsupported(unit: &ObservedUnit, Unsupported { place, resolution }: Unsupported) -> UnitReport {
    let Observation { name, cycles, line, .. } = &unit.observations[place];
    let warning = format!(
        "{name} at {cycles} cycles (line {line}) agrees with none of the points of the model that the earlier observations leave: its \
         probability is below {resolution:.1e} (95 %), and nothing is stated about this unit; more --samples show whether \
         it is possible"
    );
    let (failed_by, warning) = (unit.failed_by(), Some(warning));
    let (unit, observed_until) = (unit.name.clone(), unit.observed_until());
    UnitReport { unit, observed_until, failed_by, warning, ..UnitReport::default() }
}

fn report(scene: &Scene, model: &LifeModel, unit: &ObservedUnit, posterior: &UnitPosterior) -> UnitReport {
    let now = unit.observed_until();
    let predicted = posterior.probabilities.iter().zip(&posterior.resolutions);
    let rows = unit.observations.iter().zip(predicted);
    let rows = rows.map(|(o, (probability, resolution))| ObservationRow::new(o, *probability, *resolution));
    let observations: Vec<ObservationRow> = rows.collect();
    UnitReport {
        unit: unit.name.clone(),
        observed_until: now,
        failed_by: unit.failed_by(),
        reliability: reliability(scene, posterior, now),
        lives: lives(model, posterior),
        remaining: remaining(model, posterior, now),
        variables: variables(scene, model, posterior),
        resolved: is_resolved(posterior),
        effective_size: posterior.effective_size,
        stages: posterior.stages,
        acceptance: posterior.acceptance,
        warning: unresolved(posterior).or_else(|| warning(&observations)),
        observations,
    }
}

fn is_resolved(posterior: &UnitPosterior) -> bool {
    posterior.effective_size >= LEAST_SIZE
}

/// What is to be said of a unit whose quantiles are not stated.
fn unresolved(posterior: &UnitPosterior) -> Option<String> {
    (!is_resolved(posterior)).then(|| {
        format!(
            "the effective sample size is {:.2}, below {LEAST_SIZE}: no quantile of its life is stated; the error of a measurement is \
             small against what the points resolve: give more --samples and --particles",
            posterior.effective_size
        )
    })
}

/// The least probable observation, if it is improbable.
pub(in crate::analyses) fn warning(observations: &[ObservationRow]) -> Option<String> {
    let least = observations.iter().min_by(|a, b| a.probability.total_cmp(&b.probability))?;
    let ObservationRow { quantity, cycles, line, probability, resolution } = least;
    let unresolved = format!("below {resolution:.1e}, which the number of points does not resolve");
    let found = if probability < resolution { unresolved } else { format!("{probability:.1e}") };
    (probability * observations.len() as f64 <= IMPROBABLE).then(|| {
        format!(
            "{quantity} at {cycles} cycles (line {line}) is improbable under the model: probability {found}; check the measurement, or \
             whether the study describes this unit"
        )
    })
}

/// R(n | observations) at the life up to which the unit was observed, and at later checkpoints.
fn reliability(scene: &Scene, posterior: &UnitPosterior, now: f64) -> Vec<ReliabilityRow> {
    let UnitPosterior { particles, effective_size, .. } = posterior;
    let later = scene.life.checkpoints().into_iter().filter(|n| f64::from(*n) > now);
    let row = |cycles: u32| {
        let n = f64::from(cycles).max(now);
        let alive = |s: usize| particles.share(|i| particles.predictions.lives_of(i)[s] > n);
        let each = scene.limit_states.iter().enumerate().map(|(s, limit)| (limit.name.clone(), alive(s)));
        let total = ("total".to_owned(), particles.share(|i| particles.predictions.life(i) > n));
        let all = each.chain([total]).map(|(name, r)| (name, r.clamp(0.0, 1.0)));
        let reliability: PerLimitState = all.collect();
        let error = |r: &f64| {
            let p = (effective_size * (1.0 - r) + 1.0) / (effective_size + 2.0);
            (p * (1.0 - p) / effective_size.max(1.0)).sqrt()
        };
        let standard_error = reliability.iter().map(|(name, r)| (name.clone(), error(r))).collect();
        ReliabilityRow { cycles, reliability, standard_error, ..ReliabilityRow::default() }
    };
    std::iter::once(now as u32).chain(later).map(row).collect()
}

/// Quantiles of the life at probabilities `p`, each with its 95 % interval by the effective sample size [cycles].
fn quantiles(posterior: &UnitPosterior, p: &[f64]) -> Vec<[f64; 3]> {
    let UnitPosterior { particles, effective_size, .. } = posterior;
    let triple = |p: &f64| {
        let half = REACH * (p * (1.0 - p) / effective_size.max(1.0)).sqrt();
        [*p, (p - half).max(0.0), (p + half).min(1.0)]
    };
    let triples: Vec<f64> = p.iter().flat_map(triple).collect();
    particles.quantiles(&triples, |i| particles.predictions.life(i)).as_chunks().0.to_vec()
}

/// Lives of the levels of a study's summary.
fn lives(model: &LifeModel, posterior: &UnitPosterior) -> Vec<LifeRow> {
    let found = quantiles(posterior, &LEVELS.map(|level| 1.0 - level));
    let finite = |life: f64| life.is_finite().then_some(life);
    let row = |(level, [life, lower, upper]): (&f64, &[f64; 3])| LifeRow {
        limit_state: "total".to_owned(),
        reliability: *level,
        cycles: finite(*life).filter(|_| is_resolved(posterior)),
        interval: CyclesRange { lower: lower.min(model.end()), upper: finite(*upper) },
        with_numerical_error: None,
    };
    LEVELS.iter().zip(&found).map(row).collect()
}

fn remaining(model: &LifeModel, posterior: &UnitPosterior, now: f64) -> RemainingLife {
    let found = quantiles(posterior, &[0.05, 0.5, 0.95]);
    let left = |life: f64| (life <= model.end()).then(|| (life - now).max(0.0));
    let sampling = [0, 1, 2].map(|k: usize| [left(found[k][1]), left(found[k][2])]);
    let [p5, p50, p95] = [0, 1, 2].map(|k: usize| left(found[k][0]).filter(|_| is_resolved(posterior)));
    RemainingLife { p5, p50, p95, sampling }
}

fn variables(scene: &Scene, model: &LifeModel, posterior: &UnitPosterior) -> Vec<UpdatedVariable> {
    let particles = &posterior.particles;
    let d = model.inputs.dimension();
    // Particles without weight say nothing.
    let least = 1e-9 / particles.len() as f64;
    let kept = (0..particles.len()).filter(|i| particles.weights[*i] > least);
    let values = |i: usize| model.inputs.from_independent_normals(&particles.state(i)[..d]);
    let rows: Vec<(f64, Vec<f64>)> = kept.map(|i| (particles.weights[i], values(i))).collect();
    let sum: f64 = rows.iter().map(|(w, _)| w).sum();
    let mean_of = |of: &dyn Fn(&[f64]) -> f64| rows.iter().map(|(w, x)| w * of(x)).sum::<f64>() / sum;
    let updated = |(k, variable): (usize, &common::random::RandomVariable)| {
        let mean = mean_of(&|x| x[k]);
        UpdatedVariable {
            name: variable.name.clone(),
            unit: variable.unit.clone(),
            mean,
            std: mean_of(&|x| (x[k] - mean).powi(2)).sqrt(),
            prior_mean: variable.distribution.mean(),
            prior_std: variable.distribution.std(),
        }
    };
    scene.variables.iter().enumerate().map(updated).collect()
}
