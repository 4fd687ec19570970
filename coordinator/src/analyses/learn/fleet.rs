//! The posterior of the parameters of a population, in passes: points for the parameters that the prior allows, then for those that the
//! pass before has found.

use super::data_value::{DataSource, values_of};
use super::population::{WeightedPopulation, model_of};
use super::result::{LearnReport, LearnSettings, LearnedParameter, LearnedUnit, LeftVariable};
use super::space::{default_unknown, moments_of, proposal, space_of};
use crate::analyses::error::RefusedQuestion;
use crate::analyses::update::{
    FleetData, Moment, Observation, ObservationRow, ObservedUnit, evidence_of, outputs_of, posterior, warning,
};
use crate::results::summary::StudySummary;
use crate::statistics::design::{Stream, open_stream};
use crate::statistics::updating::{
    Evidence, Fleet, ParameterSpace, Particles, SequentialMonteCarlo, UncertainVariable, UnitModel,
    UnitPoints, UnitPosterior, Unsupported,
};
use crate::study::LifeModel;
use common::random::Distribution;
use common::scene::Scene;
use rand_distr::{Distribution as _, StandardNormal};
use rayon::prelude::*;

/// Most passes, and the share of the points [1] that the effective size reaches in a pass after which none follows.
const PASSES: u32 = 4;
const ENOUGH: f64 = 0.15;
/// Sets of the prior for which the points of the first pass are made, and of a posterior by which their effective size is found.
const SETS: usize = 400;
const PROBED: usize = 40;
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
        return Err(RefusedQuestion::new(
            "nothing is unknown",
            "the observations speak of no variable whose parameters are learned; name parameters in rows of the unit `population`",
        ));
    }
    let ranges: Vec<(f64, f64)> = model.inputs().variables().iter().map(|law| law.support()).collect();
    let known = model.inputs().variables().to_vec();
    let space = space_of(model.inputs(), &unknown, designs, fixed);
    let indices: Vec<usize> = space.variables.iter().map(|variable| variable.index).collect();
    let shared = |k: &usize| designs.contains(k).then(|| ranges[*k]);
    let of_place = |sets: &[(f64, Vec<[f64; 2]>)], place: usize| -> Vec<(f64, [f64; 2])> {
        sets.iter().map(|(w, moments)| (*w, moments[place])).collect()
    };
    let proposals_for = |sets: &[(f64, Vec<[f64; 2]>)]| -> Vec<Distribution> {
        let of = |(place, variable): (usize, &UncertainVariable)| {
            proposal(&variable.law, shared(&variable.index), &of_place(sets, place))
        };
        space.variables.iter().enumerate().map(of).collect()
    };
    let dimension = space.dimension();
    let mut rng = open_stream(settings.units.seed, Stream::Parameters(0));
    let mut normals = |sets: usize| -> Vec<f64> {
        (0..sets * dimension).map(|_| StandardNormal.sample(&mut rng)).collect()
    };
    let of_prior: Vec<(f64, Vec<[f64; 2]>)> =
        normals(SETS).chunks_exact(dimension).map(|v| (1.0, space.moments(v))).collect();
    let mut model = model_of(model, &indices, &proposals_for(&of_prior));
    let mut pass = 1;
    let (found, moments) = loop {
        let states = normals(settings.sets);
        let (found, size) = pass_of(&model, &space, data, states, settings, pass)?;
        let sets: Vec<(f64, Vec<[f64; 2]>)> = (0..found.particles.len())
            .map(|t| (found.particles.weights[t], space.moments(found.particles.state(t))))
            .collect();
        let is_last = pass == PASSES || (pass > 1 && size >= ENOUGH * settings.units.population as f64);
        model = model_of(model, &indices, &proposals_for(&sets));
        if is_last {
            break (found, sets);
        }
        pass += 1;
    };
    let mut one_more = known.clone();
    for (place, variable) in space.variables.iter().enumerate() {
        let [mean, std] = moments_of(&of_place(&moments, place));
        one_more[variable.index] = variable.law_at(mean, std).unwrap_or_else(|_| variable.law.clone());
    }
    let particles = &found.particles;
    let sets: Vec<(f64, Vec<Distribution>)> = (0..particles.len())
        .filter_map(|t| Some((particles.weights[t], space.laws(particles.state(t))?)))
        .collect();
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
    let values = if settings.ranks {
        let source = DataSource {
            scene,
            space: &space,
            population: &population,
            sets: &sets,
            points: &valued,
            curves: &curves,
        };
        values_of(&source, data, designs, settings)
    } else {
        vec![]
    };
    let confident = curves.at_confidence(settings.confidence);
    let name = |k: usize| &scene.variables[k];
    let parameter =
        |place: usize| parameter_row(scene, &space, particles, place, settings.confidence, designs);
    Ok(LearnReport {
        scene: scene.name.clone(),
        evaluations: 0,
        units: data.units.len(),
        confident,
        before: None,
        one_more,
        study: summary.reliability.clone(),
        end: model.end(),
        chosen_by_default: by_default,
        parameters: (0..dimension).map(parameter).collect(),
        checks: data
            .units
            .iter()
            .zip(&of_unit)
            .filter_map(|(unit, w)| check(&population, unit, w, settings))
            .collect(),
        left: indices
            .iter()
            .filter_map(|k| left(&population, *k, &known[*k], &name(*k).name, &predictive))
            .collect(),
        values,
        effective_size: found.effective_size,
        stages: found.stages,
        acceptance: found.acceptance,
        passes: pass,
    })
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
    let width = model.inputs().dimension() + model.deviations();
    let update =
        |(number, unit): (usize, &ObservedUnit)| posterior(&population.prior, unit, number, &settings.units);
    let updated: Vec<Result<UnitPosterior, Unsupported>> = units.par_iter().enumerate().map(update).collect();
    let mut sets = vec![UnitPoints {
        units: vec![],
        weights: vec![],
        points: population.points.clone(),
        is_population: true,
    }];
    for (number, found) in updated.into_iter().enumerate() {
        let found = found.map_err(|Unsupported { place, resolution }| {
            let observation = &units[number].observations[place];
            let fault = format!(
                "{} of unit {} agrees with no point of the model, whatever the population: its probability is below \
                 {resolution:.1e} (95 %)",
                observation.name, units[number].name
            );
            RefusedQuestion::new(format!("line {}", observation.line), fault)
        })?;
        let Particles { states, weights, .. } = found.particles;
        if found.stages == 0 {
            sets[0].units.push(number);
            sets[0].weights.push(weights);
        } else {
            let points = population.reweighting.points(&states, width);
            sets.push(UnitPoints {
                units: vec![number],
                weights: vec![weights],
                points,
                is_population: false,
            });
        }
    }
    let fleet =
        Fleet { space: space.clone(), reweighting: population.reweighting.clone(), sets, units: units.len() };
    let predictions = fleet.predict(&states);
    let particles = Particles::equal(space.dimension(), states, predictions);
    let evidence: Vec<Evidence> = (0..units.len()).map(Evidence::LogLikelihood).collect();
    let monte_carlo = SequentialMonteCarlo { particles: settings.sets, least: 0.5 * settings.sets as f64 };
    let mut rng = open_stream(settings.units.seed, Stream::Parameters(pass));
    let found = monte_carlo.update(particles, &evidence, &fleet, &mut rng).map_err(
        |Unsupported { place, .. }| {
            let ObservedUnit { name, observations } = &units[place];
            let fault = format!(
                "no population explains unit {name} beside the units before it; check its observations, and the priors"
            );
            RefusedQuestion::new(format!("line {}", observations[0].line), fault)
        },
    )?;
    let mut sizes: Vec<f64> = (0..found.particles.len())
        .step_by((found.particles.len() / PROBED).max(1))
        .filter_map(|t| space.laws(found.particles.state(t)))
        .map(|laws| {
            let r = population.reweighting.weights(&laws, &population.points);
            let (sum, squares) = r.iter().fold((0.0, 0.0), |(s, q), r| (s + r, q + r * r));
            if squares > 0.0 { sum * sum / squares } else { 0.0 }
        })
        .collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let size = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    Ok((found, size))
}

/// Variable and moment of the parameter at `place`.
fn unknown_of(space: &ParameterSpace, place: usize) -> (usize, Moment) {
    let of = |v: &UncertainVariable| {
        let both = [(v.mean.is_some(), Moment::Mean), (v.std.is_some(), Moment::Std)];
        both.into_iter().filter(|(is, _)| *is).map(|(_, moment)| (v.index, moment)).collect::<Vec<_>>()
    };
    space.variables.iter().flat_map(of).nth(place).expect("a parameter of the space")
}

fn parameter_row(
    scene: &Scene,
    space: &ParameterSpace,
    particles: &Particles,
    place: usize,
    confidence: f64,
    designs: &[usize],
) -> LearnedParameter {
    let (index, moment) = unknown_of(space, place);
    let variable = &scene.variables[index];
    let own = space.variables.iter().find(|v| v.index == index).expect("its own variable");
    let prior = match moment {
        Moment::Mean => own.mean.clone(),
        Moment::Std => own.std.clone(),
    }
    .expect("an unknown parameter has a prior");
    let value = |t: usize| prior.value(particles.state(t)[place]);
    let mean = particles.mean(value);
    let std = particles.mean(|t| (value(t) - mean).powi(2)).sqrt();
    let q = particles.quantiles(&[0.5, 0.5 * (1.0 - confidence), 0.5 * (1.0 + confidence)], value);
    let at = |u: f64| prior.value(u);
    LearnedParameter {
        name: match moment {
            _ if designs.contains(&index) => variable.name.clone(),
            Moment::Mean => format!("{}.mean", variable.name),
            Moment::Std => format!("{}.std", variable.name),
        },
        unit: variable.unit.clone(),
        mean,
        std,
        median: q[0],
        interval: [q[1], q[2]],
        study: if moment == Moment::Mean { own.law.parent_mean() } else { own.law.given_std() },
        prior: [at(-1.644_854), at(1.644_854)],
        is_flat: matches!(prior.law, Distribution::Uniform(_)),
    }
}

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
