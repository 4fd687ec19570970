//! Surrogates of the responses that the targets need, and the values of the targets predicted with them at any parameters.

use super::space::Space;
use super::target_file::{OutputStatistic, Target, TargetQuantity};
use crate::statistics::design::Population;
use crate::statistics::learning::running_maximum;
use crate::statistics::surrogate::{
    Effort, FormSettings, Kriging, Prediction, SurrogateError, TrainingSet, fit_surrogate,
};
use common::outputs::Evaluation;
use common::random::standard_normal_cdf;
use common::scene::LimitState;
use faer::Mat;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Number of samples of the random variables for means, standard deviations and reliabilities: points of a Latin hypercube.
pub(super) const POPULATION: usize = 2000;

/// Responses that share the correlation of one surrogate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Group {
    /// Running maximum of the response of a limit state at checkpoints.
    Largest(usize),
    /// Values of an output at checkpoints.
    Value(usize),
    /// Peak forces of joints.
    Forces,
    /// Wear depths of a joint at angles.
    Bore(usize),
}

/// One response of a group.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Column {
    Checkpoint(usize),
    Joint(usize),
    Angle(f64),
}

/// Surrogates of the responses of all targets.
pub(super) struct ResponseSurrogates<'a> {
    pub space: &'a Space,
    pub targets: &'a [Target],
    /// Columns, model and smallest leave-one-out Q2 [1] of the responses of each group.
    surrogates: BTreeMap<Group, (Vec<Column>, Kriging, f64)>,
    /// Standardised variables `(POPULATION)(d,)`.
    population: Population,
}

impl<'a> ResponseSurrogates<'a> {
    /// Fits the surrogates to the simulated points; a function of its arguments only.
    pub fn fit(
        space: &'a Space,
        targets: &'a [Target],
        simulated: &[(Vec<f64>, Evaluation)],
        seed: u64,
    ) -> Result<Self, SurrogateError> {
        let mut columns: BTreeMap<Group, Vec<Column>> = BTreeMap::new();
        let limits = &space.scene().limit_states;
        for (group, column) in targets.iter().flat_map(|target| needed(&target.quantity, limits)) {
            let all = columns.entry(group).or_default();
            if !all.contains(&column) {
                all.push(column);
            }
        }
        let d = simulated.first().map_or(0, |(features, _)| features.len());
        let points = Mat::from_fn(d, simulated.len(), |k, i| simulated[i].0[k]);
        let fitted = |(group, columns): (Group, Vec<Column>)| {
            let of_point = |(_, found): &(Vec<f64>, Evaluation)| values(group, &columns, found, limits);
            let rows: Vec<Vec<f64>> = simulated.iter().map(of_point).collect();
            let table = Mat::from_fn(rows.len(), columns.len(), |i, o| rows[i][o]);
            let (points, values) = (points.as_ref(), table.as_ref());
            let training = TrainingSet { points, values, noise: None, is_exact: false };
            let model = fit_surrogate(training, FormSettings::default(), None, Effort::MultiStart)?.model;
            let q2 = model.leave_one_out(values).iter().map(|l| l.q2).fold(1.0, f64::min);
            Ok((group, (columns, model, q2)))
        };
        let surrogates = columns.into_par_iter().map(fitted).collect::<Result<_, SurrogateError>>()?;
        let population = Population::latin_hypercube(&space.inputs, POPULATION, seed);
        Ok(Self { space, targets, surrogates, population })
    }

    /// Predicted values of the targets `(targets,)` [SI] at these parameters `(p,)`.
    pub fn target_values(&self, parameters: &[f64]) -> Vec<f64> {
        let nominal = vec![0.0; self.space.inputs.dimension()];
        let samples = (0..POPULATION).map(|j| self.population.standardised(j)).chain([nominal.as_slice()]);
        let placed = self.space.placed(parameters);
        let features: Vec<Vec<f64>> = samples.map(|z| placed.features(&placed.sample(z))).collect();
        let points = Mat::from_fn(features[0].len(), features.len(), |k, j| features[j][k]);
        let models = self.surrogates.iter().map(|(group, (_, model, _))| (*group, model));
        let predictions: BTreeMap<Group, Prediction> =
            models.map(|(group, model)| (group, model.predict(points.as_ref()))).collect();
        self.targets.iter().map(|target| self.value(&target.quantity, &predictions)).collect()
    }

    /// Smallest leave-one-out Q2 of the surrogates of a target [1].
    pub fn q2(&self, target: &Target) -> f64 {
        let groups = needed(&target.quantity, &self.space.scene().limit_states);
        groups.iter().map(|(group, _)| self.surrogates[group].2).fold(1.0, f64::min)
    }

    fn value(&self, quantity: &TargetQuantity, predictions: &BTreeMap<Group, Prediction>) -> f64 {
        let limits = &self.space.scene().limit_states;
        let mut survival = vec![1.0; POPULATION];
        for (group, column) in needed(quantity, limits) {
            let (columns, model, _) = &self.surrogates[&group];
            let place = columns.iter().position(|other| *other == column).expect("a needed column");
            let Prediction { mean: means, variance_factor, .. } = &predictions[&group];
            let Group::Largest(s) = group else {
                let values: Vec<f64> = (0..POPULATION).map(|j| means[(place, j)]).collect();
                let centre = mean(&values);
                let TargetQuantity::Output { statistic, .. } = quantity else {
                    return means[(place, POPULATION)];
                };
                return match statistic {
                    OutputStatistic::Mean => centre,
                    OutputStatistic::Std => {
                        let squares: f64 = values.iter().map(|y| (y - centre).powi(2)).sum();
                        (squares / (POPULATION - 1) as f64).sqrt()
                    }
                    OutputStatistic::Nominal => means[(place, POPULATION)],
                };
            };
            // The predicted probability of survival: smooth in the parameters, unbiased where the surrogate is uncertain.
            let noise = model.correlation.noise();
            for (j, survives) in survival.iter_mut().enumerate() {
                let std = (model.sigma2[place] * (variance_factor[j] + noise)).sqrt().max(f64::MIN_POSITIVE);
                *survives *= standard_normal_cdf((limits[s].response_threshold() - means[(place, j)]) / std);
            }
        }
        mean(&survival)
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The responses that a target needs.
fn needed(quantity: &TargetQuantity, limits: &[LimitState]) -> Vec<(Group, Column)> {
    match quantity {
        TargetQuantity::Output { output, n, .. } => vec![(Group::Value(*output), Column::Checkpoint(*n))],
        TargetQuantity::Reliability { limit_state, n } => {
            let chosen = (0..limits.len()).filter(|s| limit_state.is_none_or(|chosen| chosen == *s));
            chosen.map(|s| (Group::Largest(s), Column::Checkpoint(*n))).collect()
        }
        TargetQuantity::PeakForce { joint } => vec![(Group::Forces, Column::Joint(*joint))],
        TargetQuantity::Depth { joint, angle } => vec![(Group::Bore(*joint), Column::Angle(*angle))],
    }
}

/// Values of a group's columns `(c,)` in one evaluation.
fn values(group: Group, columns: &[Column], evaluation: &Evaluation, limits: &[LimitState]) -> Vec<f64> {
    let history = match group {
        Group::Largest(s) => {
            let (limit, output) = (&limits[s], limits[s].output);
            let start = evaluation.start.get(output).copied().flatten().map(|value| limit.response(value));
            let history = evaluation.histories[output].iter().map(|value| limit.response(*value));
            running_maximum(start, &history.collect::<Vec<_>>())
        }
        Group::Value(output) => evaluation.histories[output].clone(),
        Group::Forces | Group::Bore(_) => Vec::new(),
    };
    let value = |column: &Column| match (group, column) {
        (_, Column::Checkpoint(n)) => history[*n],
        (_, Column::Joint(joint)) => evaluation.joints[*joint].peak_force,
        (Group::Bore(joint), Column::Angle(angle)) => depth(&evaluation.joints[joint].wear_depth, *angle),
        (_, Column::Angle(_)) => 0.0,
    };
    columns.iter().map(value).collect()
}

/// Depth [m] at an angle [rad] by linear interpolation between control points at equal angles from zero; zero for a joint
/// without wear.
pub(super) fn depth(depths: &[f64], angle: f64) -> f64 {
    if depths.is_empty() {
        return 0.0;
    }
    let place = angle.rem_euclid(TAU) / TAU * depths.len() as f64;
    let (left, share) = (place.floor(), place.fract());
    let control_point = |k: f64| depths[k as usize % depths.len()];
    control_point(left) * (1.0 - share) + control_point(left + 1.0) * share
}
