use super::*;
use crate::surrogate::{Correlation, Kernel};
use common::random::{Distribution, standard_normal_cdf};
use faer::Mat;

/// The classification with all predictions made anew.
pub fn classify(model: &Kriging, population: &Population, mode: &ClassifiedMode<'_>) -> Classification {
    let mut cache = PredictionCache::default();
    cache.set_limit(0);
    classify_cached(&mut cache, model, population, mode)
}

#[test]
fn curves_count_each_mode_and_the_first_of_them() {
    let (a, b) = ([0, 2, 3, 3], [3, 1, 3, 2]);
    let curves = curves(&with_system(vec![a.to_vec(), b.to_vec()]), 3);
    assert_eq!(curves[0], vec![0.25, 0.25, 0.5]);
    assert_eq!(curves[1], vec![0.0, 0.25, 0.5]);
    assert_eq!(curves[2], vec![0.25, 0.5, 0.75]);
}

#[test]
fn a_region_without_simulations_counts_with_its_probability() {
    // Simulated near zero only, where the response is 0: beyond a few lengths the prediction is the mean of
    // zero again, with a standard deviation that makes a failure at 1 as probable as the posterior says.
    let normal = Distribution::truncated_normal(0.0, 1.0, -8.0, 8.0).unwrap();
    let population = Population::draw(&[normal], 50_000, 1);
    let x = Mat::from_fn(1, 5, |_, i| 0.4 * i as f64 - 0.8);
    let y = Mat::from_fn(5, 1, |i, _| [0.3, -0.4, 0.1, 0.5, -0.5][i]);
    let correlation = Correlation { kernel: Kernel::Gaussian, theta: vec![4.0], nugget: 1e-9, stated: 0.0 };
    let model = Kriging::condition(x.as_ref(), y.as_ref(), &correlation).unwrap();
    for inflation in [1.0, 2.0] {
        let mode = ClassifiedMode { index: 0, threshold: 1.0, grid: &[0], inflation, by_mean: false };
        let classified = classify(&model, &population, &mode);
        let counted = curves(&[&classified.first_failure], 1)[0][0];
        let by_means = classified.mean.iter().filter(|mean| **mean >= 1.0).count();
        let probability = |j: usize| {
            let std = classified.sigma[0] * classified.variance_factor[j].sqrt();
            standard_normal_cdf((classified.mean[j] - 1.0) / std.max(1e-12))
        };
        let expected = (0..population.len()).map(probability).sum::<f64>() / 5e4;
        assert!(by_means == 0 && expected > 5e-3, "{by_means} {expected}");
        assert!((counted - expected).abs() < 4.0 * (expected / 5e4).sqrt(), "{counted} {expected}");
    }
}

#[test]
fn through_the_cache_every_point_is_classified_as_from_scratch() {
    let variable = Distribution::truncated_normal(0.0, 1.0, -5.0, 5.0).unwrap();
    let population = Population::draw(&vec![variable; 4], 20_000, 11);
    let n = 60;
    let x = population.columns(0..n).to_owned();
    // A history of five checkpoints that passes its limit at some of them.
    let y = Mat::from_fn(n, 5, |i, o| {
        let x = population.standardised(i);
        (0.2 + 0.2 * o as f64) * (1.0 + 0.3 * x[0] + 0.2 * (x[1] * x[2]).sin() + 0.05 * x[3] * x[3])
    });
    let theta = vec![0.02, 0.1, 0.1, 0.03];
    let correlation = Correlation { kernel: Kernel::Gaussian, theta, nugget: 1e-9, stated: 0.0 };
    let mode = ClassifiedMode { index: 0, threshold: 1.0, grid: &[1, 3, 4], inflation: 1.0, by_mean: false };
    let mut cache = PredictionCache::default();
    let mut model = Kriging::condition(x.subcols(0, 40), y.subrows(0, 40), &correlation).unwrap();
    for (from, to) in [(40, 41), (41, 48), (48, 60)] {
        classify_cached(&mut cache, &model, &population, &mode);
        model = model.extended(x.subcols(from, to - from), y.subrows(from, to - from), None).unwrap();
    }
    let cached = classify_cached(&mut cache, &model, &population, &mode);
    let whole = Kriging::condition(x.as_ref(), y.as_ref(), &correlation).unwrap();
    let fresh = classify(&whole, &population, &mode);
    assert_eq!(cached.first_failure, fresh.first_failure);
    assert!(fresh.first_failure.iter().any(|n| *n < 5) && fresh.first_failure.contains(&5));
    for j in 0..population.len() {
        let (a, b) = (cached.u(j, 1), fresh.u(j, 1));
        assert!((a - b).abs() < 1e-3 * (1.0 + b) || b > 50.0, "{j} {a} {b}");
    }
}

/// One mode with given means `(N, a)`, unit sigma and variance factors.
pub fn mode(mean: &[f64], factors: &[f64], threshold: f64) -> Classification {
    Classification {
        mean: mean.to_vec(),
        variance_factor: factors.to_vec(),
        sigma: vec![1.0; mean.len() / factors.len()],
        first_failure: vec![0; factors.len()],
        threshold,
    }
}

#[test]
fn a_mode_overtaken_by_certain_failure_does_not_call() {
    // Point 0: mode a has certainly failed (U = 3), mode b is on its limit. Point 1: a is uncertain
    // instead.
    let a = mode(&[4.0, 2.0], &[1.0, 1.0], 1.0);
    let b = mode(&[10.0, 10.0], &[1.0, 1.0], 10.0);
    let coupled = coupled_criterion(&[a, b]);
    assert_eq!(coupled[0], Coupled { system: 3.0, any: 0.0 });
    assert_eq!(coupled[1], Coupled { system: 0.0, any: 0.0 });
}

#[test]
fn dominance_is_the_ratio_of_relative_uncertainties() {
    let a = mode(&[2.0], &[0.04], 1.0);
    let b = mode(&[10.0], &[0.25], 10.0);
    let k = dominance(&[a.clone(), b], 0, 0).unwrap();
    assert!((k - (0.2 / 2.0) / (0.5 / 10.0)).abs() < 1e-12);
    assert_eq!(dominance(&[a], 0, 0), None);
}
