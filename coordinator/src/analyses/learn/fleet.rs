//! The posterior of the parameters of a population, in passes: points for the parameters that the prior allows, then for those that the
//! pass before has found.

use super::data_value::{DataSource, values_of};
use super::population::{WeightedPopulation, model_of};
use super::result::{LearnReport, LearnSettings, LearnedParameter, LearnedUnit, LeftVariable};
use super::space::{default_unknown, moments_of, proposal, space_of};
use crate::analyses::error::RefusedQuestion;
use crate::analyses::update::{
    FleetData, Observation, ObservationRow, ObservedUnit, evidence_of, outputs_of, posterior, warning,
};
use crate::presentation::report::untested::not_in_answer;
use crate::results::summary::StudySummary;
use crate::statistics::design::{InputModel, Stream, open_stream};
use crate::statistics::updating::{
    Evidence, Fleet, ParameterSpace, Particles, PopulationParameter, SequentialMonteCarlo, UncertainVariable,
    UnitModel, UnitPoints, UnitPosterior, Unsupported,
};
use crate::study::LifeModel;
use common::random::{Correlation, Distribution};
use common::scene::Scene;
use rand_distr::{Distribution as _, StandardNormal};
use rayon::prelude::*;

/// Most passes, and the share of the points [1] that the effective size reaches in a pass after which none follows.
const PASSES: u32 = 4;
const ENOUGH: f64 = 0.15;
/// Sets of the prior for which the points of the first pass are made, and of a posterior by which their effective size is found.
const SETS: usize = 400;
const PROBED: usize = 40;
/// Factor of the particles of a unit where design variables are unknown: near a value that all units share lie few of them.
const SHARED: usize = 4;
/// Points whose weights the value of further data is computed from.
const VALUED: usize = 3000;

/// Learns the parameters of the population of `model`, whose variables `designs` are design variables; `fixed` tells which bounds of
/// each variable stay where they are.
///
/// # Errors
/// [`RefusedQuestion`].
pub fn learn(
    scene: &Scene,
    summary: &StudySummary,
    model: LifeModel,
    data: &FleetData,
    designs: &[usize],
    fixed: &[[bool; 2]],
    settings: &LearnSettings,
) -> Result<LearnReport, RefusedQuestion> {
    let by_default = data.unknown.is_empty();
    let unknown =
        if by_default { default_unknown(&model, &data.units, designs) } else { data.unknown.clone() };
    if unknown.is_empty() {
        let fault = "the observations speak of no variable whose parameters are learned; name parameters in rows of the unit `population`";
        return Err(RefusedQuestion::new("nothing is unknown", fault));
    }
    let mut settings = *settings;
    if unknown.iter().any(|parameter| designs.contains(&parameter.variable)) {
        let of_units = &mut settings.units.monte_carlo;
        (of_units.particles, of_units.least) = (SHARED * of_units.particles, SHARED as f64 * of_units.least);
    }
    let settings = &settings;
    let ranges: Vec<(f64, f64)> = model.inputs.variables().iter().map(|law| law.support()).collect();
    let known = model.inputs.variables().to_vec();
    let space = space_of(&model.inputs, scene, &unknown, designs, fixed);
    let indices: Vec<usize> = space.variables.iter().map(|variable| variable.index).collect();
    let dimension = space.dimension();
    let mut rng = open_stream(settings.units.seed, Stream::Parameters(0));
    let mut normals = |sets: usize| -> Vec<f64> {
        (0..sets * dimension).map(|_| StandardNormal.sample(&mut rng)).collect()
    };
    // Weights and moments of sets of parameters by variable.
    let moments_by_variable = |states: &[f64], weight: &dyn Fn(usize) -> f64| -> Vec<Vec<(f64, [f64; 2])>> {
        let sets: Vec<Vec<[f64; 2]>> = states.chunks_exact(dimension).map(|v| space.moments(v)).collect();
        let of_set = |place: usize, (t, set): (usize, &Vec<[f64; 2]>)| (weight(t), set[place]);
        let of_variable = |place: usize| sets.iter().enumerate().map(|set| of_set(place, set)).collect();
        (0..space.variables.len()).map(of_variable).collect()
    };
    let redistributed = |model: LifeModel, moments: &[Vec<(f64, [f64; 2])>]| {
        let of = |(own, sets): (&UncertainVariable, &Vec<_>)| {
            if own.is_known() {
                return own.law.clone();
            }
            proposal(&own.law, designs.contains(&own.index).then(|| ranges[own.index]), sets)
        };
        let proposals: Vec<Distribution> = space.variables.iter().zip(moments).map(of).collect();
        model_of(model, scene, &indices, &proposals)
    };
    let mut model = redistributed(model, &moments_by_variable(&normals(SETS), &|_| 1.0));
    let mut pass = 1;
    let (found, moments) = loop {
        let (found, size) = pass_of(&model, &space, data, normals(settings.sets), settings, pass)?;
        let Particles { states, weights, .. } = &found.particles;
        let moments = moments_by_variable(states, &|t| weights[t]);
        let is_last = pass == PASSES || (pass > 1 && size >= ENOUGH * settings.units.population as f64);
        model = redistributed(model, &moments);
        if is_last {
            break (found, moments);
        }
        pass += 1;
    };
    let particles = &found.particles;
    let one_more = one_more(scene, &known, &space, particles, &moments);
    let set = |t: usize| Some((particles.weights[t], space.laws(particles.state(t))?));
    let sets: Vec<(f64, InputModel)> = (0..particles.len()).filter_map(set).collect();
    let mut wanted = outputs_of(&data.units);
    wanted.extend(scene.limit_states.iter().map(|limit| limit.output));
    wanted.sort_unstable();
    wanted.dedup();
    let population = WeightedPopulation::new(&model, &indices, wanted, settings.points, settings.units.seed);
    let without = weights_without(particles, data.units.len());
    let mut predictive = vec![0.0; settings.points];
    let mut of_unit = vec![vec![0.0; settings.points]; data.units.len()];
    let mut valued: Vec<(Vec<f64>, f64)> = Vec::new();
    let curves = population.curves(scene, &sets, |t, points| {
        let sum: f64 = points.iter().sum();
        let add = |all: &mut Vec<f64>, weight: f64| {
            all.iter_mut().zip(points).for_each(|(all, r)| *all += weight * r / sum);
        };
        add(&mut predictive, sets[t].0);
        of_unit.par_iter_mut().zip(&without).for_each(|(all, weights)| add(all, weights[t]));
        let first = &points[..VALUED.min(points.len())];
        valued.push((first.to_vec(), first.iter().sum()));
    });
    let (space, population, curves) = (&space, &population, &curves);
    let source =
        DataSource { scene, space, population, sets: &sets, points: &valued, curves: curves.total() };
    let parameter =
        |place: usize| parameter_row(scene, space, particles, place, settings.confidence, designs);
    let check = |(unit, weights): (&_, &Vec<f64>)| check(population, unit, weights, settings);
    let left = |k: &usize| left(population, *k, &known[*k], &scene.variables[*k].name, &predictive);
    Ok(LearnReport {
        scene: scene.name.clone(),
        evaluations: 0,
        units: data.units.len(),
        confident: curves.at_confidence(scene, settings.confidence),
        before: None,
        one_more,
        study: summary.reliability.clone(),
        caution: not_in_answer(summary),
        end: model.end(),
        chosen_by_default: by_default,
        parameters: (0..dimension).map(parameter).collect(),
        checks: data.units.iter().zip(&of_unit).filter_map(check).collect(),
        left: indices.iter().filter_map(left).collect(),
        values: if settings.ranks { values_of(&source, data, designs, settings) } else { vec![] },
        effective_size: found.effective_size,
        stages: found.stages,
        acceptance: found.acceptance,
        passes: pass,
    })
}

/// Distributions of the variables of one more unit, and their correlations.
fn one_more(
    scene: &Scene,
    known: &[Distribution],
    space: &ParameterSpace,
    particles: &Particles,
    moments: &[Vec<(f64, [f64; 2])>],
) -> (Vec<Distribution>, Vec<Correlation>) {
    let mut laws = known.to_vec();
    for (variable, sets) in space.variables.iter().zip(moments) {
        let [mean, std] = moments_of(sets);
        laws[variable.index] = variable.law_at(mean, std).unwrap_or_else(|_| variable.law.clone());
    }
    let index = |place: usize| space.variables[place].index;
    let mean = |(place, (pair, _)): (usize, &(Correlation, _))| {
        let coefficient = particles.mean(|t| space.correlations(particles.state(t))[place].coefficient);
        Correlation { first: index(pair.first), second: index(pair.second), coefficient }
    };
    let own: Vec<usize> = space.variables.iter().map(|variable| variable.index).collect();
    let others = scene.correlations.iter().filter(|c| !own.contains(&c.first)).copied();
    (laws, others.chain(space.correlations.iter().enumerate().map(mean)).collect())
}

/// The posterior from one population of points, and the median effective number of these under it.
fn pass_of(
    model: &LifeModel,
    space: &ParameterSpace,
    data: &FleetData,
    states: Vec<f64>,
    settings: &LearnSettings,
    pass: u32,
) -> Result<(UnitPosterior, f64), RefusedQuestion> {
    let units = &data.units;
    let indices: Vec<usize> = space.variables.iter().map(|variable| variable.index).collect();
    let count = settings.units.population;
    let population = WeightedPopulation::new(model, &indices, outputs_of(units), count, settings.units.seed);
    let width = model.inputs.dimension() + model.deviations();
    let update = |(number, unit)| posterior(&population.prior, unit, number, &settings.units);
    let updated: Vec<Result<UnitPosterior, Unsupported>> = units.par_iter().enumerate().map(update).collect();
    let points = population.points.clone();
    let mut sets = vec![UnitPoints { units: vec![], weights: vec![], points, is_population: true }];
    let mut excluded = Vec::new();
    for (number, found) in updated.into_iter().enumerate() {
        let Particles { states, weights, .. } = match found {
            Ok(found) if found.stages == 0 => {
                sets[0].units.push(number);
                sets[0].weights.push(found.particles.weights);
                continue;
            }
            Ok(found) => found.particles,
            Err(Unsupported { place, resolution }) => {
                let (unit, Observation { line, name, .. }) =
                    (&units[number].name, &units[number].observations[place]);
                excluded.push(format!(
                    "line {line}: {name} of unit {unit} agrees with no point of the model, whatever the population: its probability is \
                     below {resolution:.1e} (95 %)"
                ));
                continue;
            }
        };
        let points = population.reweighting.points(&states, width);
        let (units, weights) = (vec![number], vec![weights]);
        sets.push(UnitPoints { units, weights, points, is_population: false });
    }
    if !excluded.is_empty() {
        return Err(RefusedQuestion::new("what was observed", excluded.join("; ")));
    }
    let fleet =
        Fleet { space: space.clone(), reweighting: population.reweighting.clone(), sets, units: units.len() };
    let predictions = fleet.predict(&states);
    let particles = Particles::equal(space.dimension(), states, predictions);
    let evidence: Vec<Evidence> = (0..units.len()).map(Evidence::LogLikelihood).collect();
    let monte_carlo = SequentialMonteCarlo { particles: settings.sets, least: 0.5 * settings.sets as f64 };
    let mut rng = open_stream(settings.units.seed, Stream::Parameters(pass));
    let found = monte_carlo.update(particles, &evidence, &fleet, &mut rng);
    let found = found.map_err(|Unsupported { place, .. }| {
        let ObservedUnit { name, observations } = &units[place];
        let fault =
            format!("no population explains unit {name} beside the units before it; check its observations, and the priors");
        RefusedQuestion::new(format!("line {}", observations[0].line), fault)
    })?;
    let size = |t: usize| {
        let r = population.reweighting.weights(&space.laws(found.particles.state(t))?, &population.points);
        let (sum, squares) = r.iter().fold((0.0, 0.0), |(s, q), r| (s + r, q + r * r));
        Some(if squares > 0.0 { sum * sum / squares } else { 0.0 })
    };
    let step = (found.particles.len() / PROBED).max(1);
    let mut sizes: Vec<f64> = (0..found.particles.len()).step_by(step).filter_map(size).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let size = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    Ok((found, size))
}

fn parameter_row(
    scene: &Scene,
    space: &ParameterSpace,
    particles: &Particles,
    place: usize,
    confidence: f64,
    designs: &[usize],
) -> LearnedParameter {
    let (kind, prior) = space.parameters().nth(place).expect("a parameter of the space");
    let variable = |k: usize| &scene.variables[space.variables[k].index];
    let law = |k: usize| &space.variables[k].law;
    let word = |k: usize| if designs.contains(&space.variables[k].index) { "" } else { ".mean" };
    let (name, unit, study) = match kind {
        PopulationParameter::Mean(k) => {
            (format!("{}{}", variable(k).name, word(k)), &*variable(k).unit, law(k).parent_mean())
        }
        PopulationParameter::Std(k) => {
            (format!("{}.std", variable(k).name), &*variable(k).unit, law(k).given_std())
        }
        PopulationParameter::Correlation(Correlation { first, second, coefficient }) => {
            (format!("correlation({},{})", variable(first).name, variable(second).name), "1", coefficient)
        }
    };
    let value = |t: usize| prior.value(particles.state(t)[place]);
    let mean = particles.mean(value);
    let std = particles.mean(|t| (value(t) - mean).powi(2)).sqrt();
    let q = particles.quantiles(&[0.5, 0.5 * (1.0 - confidence), 0.5 * (1.0 + confidence)], value);
    LearnedParameter {
        name,
        unit: unit.to_owned(),
        mean,
        std,
        median: q[0],
        interval: [q[1], q[2]],
        study,
        prior: [-1.644_854, 1.644_854].map(|u| prior.value(u)),
        is_flat: matches!(prior.law, Distribution::Uniform(_)),
    }
}

/// Weights of the sets without each unit `(units)(P,)`, of sum 1.
pub fn weights_without(particles: &Particles, units: usize) -> Vec<Vec<f64>> {
    let of_unit = |i: usize| {
        let log = |t: usize| particles.weights[t].ln() - particles.predictions.value(t, i).0;
        let logs: Vec<f64> = (0..particles.len()).map(log).collect();
        let largest = logs.iter().copied().filter(|l| l.is_finite()).fold(f64::NEG_INFINITY, f64::max);
        let weight = |l: &f64| if l.is_finite() { (l - largest).exp() } else { 0.0 };
        let weights: Vec<f64> = logs.iter().map(weight).collect();
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
    let rows = evidence.iter().map(|e| e.probability(&particles)).zip(&unit.observations);
    let rows: Vec<_> = rows.map(|(probability, o)| ObservationRow::new(o, probability, resolution)).collect();
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
    let width = model.inputs.dimension() + model.deviations();
    let law = &model.inputs.variables()[k];
    let is_outside = |v: &[f64]| !(lower..=upper).contains(&law.from_standard_normal(v[k]));
    let all = population.prior.states.chunks_exact(width).zip(weights).filter(|(v, _)| is_outside(v));
    let outside = all.map(|(_, w)| w).sum::<f64>() / weights.iter().sum::<f64>();
    let of_study = known.cdf(lower) + known.survival(upper);
    (outside > 2.0 * of_study + 0.05).then(|| LeftVariable { name: name.to_owned(), outside, of_study })
}
