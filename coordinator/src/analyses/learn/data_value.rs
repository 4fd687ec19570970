//! Which further data would narrow the bound of the life most: data sets are simulated from the posterior, each gives the sets of
//! parameters new weights, and these a narrower interval; the mean over the data sets is the expected narrowing.
//!
//! # Source
//! Raiffa, Schlaifer (1961), Applied Statistical Decision Theory, section 4.5 (preposterior analysis).

use super::population::WeightedPopulation;
use super::result::{DataValue, LearnSettings};
use crate::analyses::update::{FleetData, Observable, Observation, ObservedUnit, Quantity};
use crate::statistics::design::{InputModel, Stream, open_stream};
use crate::statistics::updating::{CurveDraws, ParameterSpace};
use common::scene::Scene;
use rand::{Rng, RngExt};
use rand_distr::{Distribution as _, StandardNormal};
use rayon::prelude::*;

/// Units or measured values of a data set, and simulated data sets.
const UNITS: usize = 5;
const DATA_SETS: u32 = 48;
/// Error of a recorded life [its value], and of a measured output whose error no unit states [scale of its limit state].
const LIFE_ERROR: f64 = 0.02;
const OUTPUT_ERROR: f64 = 0.03;
/// Shares of the median life at R = 0.5 at which units are inspected.
const INSPECTED_AT: [f64; 2] = [0.3, 0.7];
/// Index of R = 0.99 among the levels.
const LEVEL: usize = 0;

/// What data sets are simulated from.
pub struct DataSource<'a> {
    /// Scene of the study.
    pub scene: &'a Scene,
    /// Unknown parameters of the population.
    pub space: &'a ParameterSpace,
    /// Population of the study with its weights.
    pub population: &'a WeightedPopulation<'a>,
    /// Weight and distributions of every set `(P)`.
    pub sets: &'a [(f64, InputModel)],
    /// Weights of the first points under every set, and their sum `(P)(n,)`.
    pub points: &'a [(Vec<f64>, f64)],
    /// Curves and lives of every set.
    pub curves: &'a CurveDraws,
}

/// A kind of data.
enum Kind {
    /// Units that run to failure.
    Failures,
    /// An output is measured at a life, with an error.
    Inspections { output: usize, life: f64, error: f64 },
    /// Values of the variable at this place of the space.
    Values(usize),
}

/// The value of every kind of data, the most narrowing first, those with a price by the narrowing for it; empty if the interval has no
/// width within the study.
pub fn values_of(
    source: &DataSource<'_>,
    data: &FleetData,
    designs: &[usize],
    settings: &LearnSettings,
) -> Vec<DataValue> {
    let scene = source.scene;
    let end = source.population.prior.model.end();
    let width = |weights: &[f64]| {
        let [low, _, high] = source.curves.life_interval(weights, LEVEL, settings.confidence);
        high.min(end) - low.min(end)
    };
    let before: Vec<f64> = source.sets.iter().map(|(w, _)| *w).collect();
    let now = width(&before);
    if now <= 0.0 || source.curves.lives.len() != source.sets.len() {
        return vec![];
    }
    let median = source.curves.life_interval(&before, 2, 1e-9)[1].min(end);
    let checkpoints = scene.life.checkpoints();
    let nearest = |life: f64| {
        let distance = |n: &&u32| (f64::from(**n) - life).abs();
        checkpoints.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).map_or(life, |n| f64::from(*n))
    };
    let mut kinds = vec![(format!("{UNITS} more units run to failure"), Kind::Failures)];
    let mut outputs: Vec<usize> = scene.limit_states.iter().map(|limit| limit.output).collect();
    outputs.dedup();
    for output in outputs {
        let mut limits = scene.limit_states.iter().filter(|limit| limit.output == output);
        let limit = limits.next().expect("its own limit state");
        let error = stated_error(&data.units, output).unwrap_or(OUTPUT_ERROR * limit.scale());
        for life in INSPECTED_AT.map(|share| nearest(share * median)) {
            let words = format!("{} of {UNITS} more units at {life:.0} cycles", scene.outputs[output].name);
            kinds.push((words, Kind::Inspections { output, life, error }));
        }
    }
    let variables = source.space.variables.iter().enumerate();
    kinds.extend(variables.filter(|(_, v)| !v.is_known() && !designs.contains(&v.index)).map(
        |(place, v)| {
            (format!("{UNITS} measured values of {}", scene.variables[v.index].name), Kind::Values(place))
        },
    ));
    let narrowing = |kind: &Kind, number: u32| {
        let mut rng = open_stream(settings.units.seed, Stream::Parameters(1000 + number));
        1.0 - width(&source.weights_after(kind, &before, &mut rng)) / now
    };
    let cost = |kind: &Kind| {
        let of = match *kind {
            Kind::Failures => None,
            Kind::Inspections { output, .. } => Some(Observable::Output(output)),
            Kind::Values(place) => Some(Observable::Variable(source.space.variables[place].index)),
        };
        data.prices.iter().find(|(priced, _)| *priced == of).map(|(_, price)| UNITS as f64 * price)
    };
    let value = |(data, kind): (String, Kind)| {
        let all: Vec<f64> = (0..DATA_SETS).into_par_iter().map(|number| narrowing(&kind, number)).collect();
        let n = all.len() as f64;
        let mean = all.iter().sum::<f64>() / n;
        let variance = all.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
        DataValue { data, narrowing: mean, standard_error: (variance / n).sqrt(), cost: cost(&kind) }
    };
    let mut values: Vec<DataValue> = kinds.into_iter().map(value).collect();
    let rank = |value: &DataValue| value.narrowing / value.cost.unwrap_or(1.0);
    values.sort_by(|a, b| b.cost.is_some().cmp(&a.cost.is_some()).then(rank(b).total_cmp(&rank(a))));
    values
}

/// The least error with which an output was measured.
fn stated_error(units: &[ObservedUnit], output: usize) -> Option<f64> {
    let error = |o: &Observation| match o.quantity {
        Quantity::Measured { of: Observable::Output(own), error, .. } if own == output => Some(error),
        _ => None,
    };
    units.iter().flat_map(|unit| &unit.observations).filter_map(error).min_by(f64::total_cmp)
}

/// Index chosen with probabilities in proportion to `weights`.
fn choose(weights: &[f64], rng: &mut impl Rng) -> usize {
    let mut left = rng.random::<f64>() * weights.iter().sum::<f64>();
    let passes = |w: &f64| {
        left -= w;
        left < 0.0
    };
    weights.iter().position(passes).unwrap_or(weights.len() - 1)
}

impl DataSource<'_> {
    /// Weights of the sets after a data set of this kind, simulated from one of them `(P,)`.
    fn weights_after(&self, kind: &Kind, before: &[f64], rng: &mut impl Rng) -> Vec<f64> {
        let truth = choose(before, rng);
        let mut logs: Vec<f64> = before.iter().map(|w| w.ln()).collect();
        for _ in 0..UNITS {
            let likelihoods = self.likelihoods(kind, truth, rng);
            logs.iter_mut().zip(likelihoods).for_each(|(log, l)| *log += l.ln());
        }
        let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if largest == f64::NEG_INFINITY {
            return before.to_vec();
        }
        logs.iter().map(|log| (log - largest).exp()).collect()
    }

    /// Likelihood of one observation, simulated from the set `truth`, under every set `(P,)`.
    fn likelihoods(&self, kind: &Kind, truth: usize, rng: &mut impl Rng) -> Vec<f64> {
        let noise: f64 = StandardNormal.sample(rng);
        if let Kind::Values(place) = *kind {
            let x =
                self.sets[truth].1.variables()[place].quantile(rng.random::<f64>().clamp(1e-12, 1.0 - 1e-12));
            return self.sets.iter().map(|(_, laws)| laws.variables()[place].pdf(x)).collect();
        }
        let own = choose(&self.points[truth].0, rng);
        let n = self.points[truth].0.len();
        let normal = |difference: f64, std: f64| (-0.5 * (difference / std).powi(2)).exp();
        let WeightedPopulation { prior, lives, .. } = self.population;
        let agreement: Vec<f64> = match *kind {
            Kind::Inspections { output, life, error } => {
                let mut outputs = prior.wanted.iter().zip(&prior.responses.histories);
                let (_, history) =
                    outputs.find(|(w, _)| **w == output).expect("outputs of limit states are wanted");
                let value = |j: usize| prior.model.value_at(output, history, j, life);
                let measured = value(own) + error * noise;
                (0..n).map(|j| normal(value(j) - measured, error)).collect()
            }
            _ if lives[own].is_infinite() => {
                lives[..n].iter().map(|life| f64::from(u8::from(life.is_infinite()))).collect()
            }
            _ => {
                let error = LIFE_ERROR * lives[own].max(1.0);
                lives[..n].iter().map(|life| normal(life - lives[own] - error * noise, error)).collect()
            }
        };
        let near: Vec<(usize, f64)> = agreement.into_iter().enumerate().filter(|(_, a)| *a > 1e-8).collect();
        let points = self.points.iter();
        points.map(|(points, sum)| near.iter().map(|(j, a)| a * points[*j]).sum::<f64>() / sum).collect()
    }
}
