//! Points of the fixture: most probable failures, predictions, and samples without simulations.

use super::report_input;
use crate::presentation::report::ReportInput;
use crate::results::summary_rows::{CoordinateRow, FailurePointRow, PredictionRow};
use common::random::RandomVariable;
use common::scene::Scene;

pub(super) fn failure_point(limit_state: &str, scene: &Scene) -> FailurePointRow {
    let coordinate = |(k, variable): (usize, &RandomVariable)| {
        let normal = (1.3 * k as f64).sin();
        let value = variable.distribution.from_standard_normal(normal);
        CoordinateRow { variable: variable.name.clone(), value, normal }
    };
    FailurePointRow {
        limit_state: limit_state.to_owned(),
        cycles: 62_000,
        failed: 0.0137,
        distance: 2.5,
        variables: scene.variables.iter().enumerate().map(coordinate).collect(),
    }
}

pub(super) fn prediction(limit_state: &str) -> PredictionRow {
    let simulated: Vec<f64> = (0..40).map(|k| 2.9e-5 + 1e-7 * f64::from(k)).collect();
    PredictionRow {
        limit_state: limit_state.to_owned(),
        cycles: 66_000,
        unit: "m".into(),
        predicted: simulated.iter().enumerate().map(|(k, y)| y + 2e-7 * (k as f64).sin()).collect(),
        std: vec![1.5e-7; 40],
        simulated,
        q2: 0.99,
    }
}

/// The same with many more simulations: quantiles of the variables at the points of a lattice.
pub fn report_with_samples() -> ReportInput {
    let mut input = report_input();
    let laws: Vec<_> = input.scene.variables.iter().map(|variable| variable.distribution.clone()).collect();
    let probability =
        |j: usize, k: usize| ((j as f64 + 0.5) * (2.0 + k as f64).sqrt()).fract().clamp(0.001, 0.999);
    input.samples = (0..200)
        .map(|j| {
            let values = laws.iter().enumerate().map(|(k, law)| law.quantile(probability(j, k)));
            (values.collect(), vec![(j % 4 == 0).then_some(65_000), (j % 6 == 0).then_some(64_000)])
        })
        .collect();
    input
}
