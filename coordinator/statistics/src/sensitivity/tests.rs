//! Derivatives against finite differences of probabilities that are known by quadrature.

use super::*;
use crate::design::InputModel;
use crate::reliability::SubsetSimulation;
use common::random::{Correlation, Distribution, GaussianCopula, standard_normal_cdf};
use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;

/// P(x_1 + 2 x_2 >= limit) for truncated normals, by Simpson's rule over x_1 and the exact distribution of
/// x_2.
fn exact(a: Distribution, b: Distribution, limit: f64) -> f64 {
    let (lower, upper) = a.support();
    let n = 40_000;
    let h = (upper - lower) / n as f64;
    let f = |x: f64| a.pdf(x.clamp(lower, upper)) * (1.0 - b.cdf((limit - x) / 2.0));
    let weight = |i: usize| if i == 0 || i == n { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 };
    (0..=n).map(|i| weight(i) * f(lower + h * i as f64)).sum::<f64>() * h / 3.0
}

#[test]
fn a_linear_limit_state_agrees_with_finite_differences_of_the_exact_probability() {
    let tn = |mean, std| Distribution::truncated_normal(mean, std, -1.5, 3.5).unwrap();
    let (a, b) = (tn(1.0, 0.9), tn(0.5, 0.6));
    let points = 200_000;
    let population = Population::draw(&[a.clone(), b.clone()], points, 17);
    let limits = [2.0, 3.5];
    let value = |j: usize| {
        let x = population.physical(j);
        x[0] + 2.0 * x[1]
    };
    // Two checkpoints: the higher limit is passed first in life, the lower one by the second checkpoint.
    let first: Vec<u32> = (0..points)
        .map(|j| if value(j) >= limits[1] { 0 } else { 1 + u32::from(value(j) < limits[0]) })
        .collect();
    let all: Vec<usize> = (0..points).collect();
    let rows = sensitivities(
        &Sampled { population: &population, points: &all, probability: 1.0 },
        &[first],
        &[0, 1],
        2,
    );
    let h = 1e-4;
    for row in rows {
        let limit = limits[1 - row.checkpoint];
        let with = |dm: f64, ds: f64| {
            if row.variable == 0 {
                exact(tn(1.0 + dm, 0.9 + ds), b.clone(), limit)
            } else {
                exact(a.clone(), tn(0.5 + dm, 0.6 + ds), limit)
            }
        };
        let to_mean = (with(h, 0.0) - with(-h, 0.0)) / (2.0 * h);
        let to_std = (with(0.0, h) - with(0.0, -h)) / (2.0 * h);
        for (estimate, truth) in [(row.to_mean, to_mean), (row.to_std, to_std)] {
            assert!((estimate.value - truth).abs() < 4.0 * estimate.standard_error, "{row:?}: {truth}");
            assert!(estimate.standard_error < 0.01 * truth.abs().max(0.3));
        }
    }
}

/// P(x_1 + 2 x_2 >= limit) of correlated variables, by Simpson's rule over the normal of x_1, given which the
/// normal of x_2 has the mean rho u and the variance 1 - rho^2.
fn exact_correlated(a: Distribution, b: Distribution, rho: f64, limit: f64) -> f64 {
    let n = 8_000;
    let h = 16.0 / n as f64;
    let f = |u: f64| {
        let needed = (limit - a.from_standard_normal(u)) / 2.0;
        let (lower, upper) = b.support();
        let beyond = if needed <= lower {
            1.0
        } else if needed >= upper {
            0.0
        } else {
            standard_normal_cdf((rho * u - b.to_standard_normal(needed)) / (1.0 - rho * rho).sqrt())
        };
        standard_normal_pdf(u) * beyond
    };
    let weight = |i: usize| if i == 0 || i == n { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 };
    (0..=n).map(|i| weight(i) * f(-8.0 + h * i as f64)).sum::<f64>() * h / 3.0
}

/// Derivatives at one limit against finite differences of the exact probability, for laws made by mean and
/// std.
fn check_correlated(
    make: [&dyn Fn(f64, f64) -> Distribution; 2],
    moments: [(f64, f64); 2],
    rho: f64,
    limit: f64,
) {
    let made = |k: usize, dm: f64, ds: f64| make[k](moments[k].0 + dm, moments[k].1 + ds);
    let laws = vec![made(0, 0.0, 0.0), made(1, 0.0, 0.0)];
    let pair = Correlation { first: 0, second: 1, coefficient: rho };
    let inputs = InputModel::new(laws.clone(), GaussianCopula::new(2, &[pair]).unwrap());
    let points = 200_000;
    let population = Population::draw(&inputs, points, 23);
    let first: Vec<u32> = (0..points)
        .map(|j| {
            let x = population.physical(j);
            u32::from(x[0] + 2.0 * x[1] < limit)
        })
        .collect();
    let pf = first.iter().filter(|first| **first == 0).count() as f64 / points as f64;
    let truth = exact_correlated(laws[0].clone(), laws[1].clone(), rho, limit);
    assert!((pf - truth).abs() < 4.0 * (truth * (1.0 - truth) / points as f64).sqrt(), "{pf} {truth}");
    let all: Vec<usize> = (0..points).collect();
    let h = 1e-4;
    for row in
        sensitivities(&Sampled { population: &population, points: &all, probability: 1.0 }, &[first], &[0], 1)
    {
        let with = |dm: f64, ds: f64| {
            if row.variable == 0 {
                exact_correlated(made(0, dm, ds), laws[1].clone(), rho, limit)
            } else {
                exact_correlated(laws[0].clone(), made(1, dm, ds), rho, limit)
            }
        };
        let to_mean = (with(h, 0.0) - with(-h, 0.0)) / (2.0 * h);
        let to_std = (with(0.0, h) - with(0.0, -h)) / (2.0 * h);
        for (estimate, truth) in [(row.to_mean, to_mean), (row.to_std, to_std)] {
            assert!((estimate.value - truth).abs() < 4.0 * estimate.standard_error, "{row:?}: {truth}");
            assert!(estimate.standard_error < 0.02 * truth.abs().max(0.3), "{row:?}: {truth}");
        }
    }
}

/// Two correlated normals: the sum is normal, which the quadrature itself is checked by.
#[test]
fn correlated_normals_agree_with_the_closed_form() {
    let normal = |mean, std| Distribution::normal(mean, std).unwrap();
    let (rho, limit) = (0.6, 3.0);
    let std = (0.9_f64.powi(2) + 4.0 * 0.36 + 4.0 * rho * 0.9 * 0.6).sqrt();
    let closed = standard_normal_cdf((1.0 + 2.0 * 0.5 - limit) / std);
    let quadrature = exact_correlated(normal(1.0, 0.9), normal(0.5, 0.6), rho, limit);
    assert!((closed - quadrature).abs() < 1e-9, "{closed} {quadrature}");
    check_correlated([&normal, &normal], [(1.0, 0.9), (0.5, 0.6)], rho, limit);
}

#[test]
fn other_correlated_laws_agree_with_quadrature() {
    let lognormal = |mean, std| Distribution::lognormal(mean, std).unwrap();
    let weibull = |mean, std| Distribution::weibull(mean, std).unwrap();
    check_correlated([&lognormal, &weibull], [(1.0, 0.3), (0.8, 0.3)], -0.5, 3.2);
    let beta = |mean, std| Distribution::beta(mean, std, -1.0, 4.0).unwrap();
    let truncated = |mean, std| Distribution::truncated_normal(mean, std, -1.5, 2.0).unwrap();
    check_correlated([&beta, &truncated], [(1.0, 0.8), (0.4, 0.6)], 0.7, 3.5);
}

/// Derivatives of P(x_1 + 2 x_2 + x_3 / 2 >= limit) = Phi(-beta) over samples conditional on an intermediate event, as
/// distances from the exact ones in stated standard errors.
fn rare_distances(seed: u64) -> Vec<f64> {
    let (weights, moments) = ([1.0, 2.0, 0.5], [(1.0, 1.0), (0.5, 0.8), (2.0, 1.5)]);
    let variables = moments.map(|(mean, std)| Distribution::normal(mean, std).unwrap());
    let inputs = InputModel::from(&variables);
    let sum = |x: &[f64]| x.iter().zip(weights).map(|(x, w)| w * x).sum::<f64>();
    let mean: f64 = moments.iter().zip(weights).map(|((mean, _), w)| w * mean).sum();
    let std = moments.iter().zip(weights).map(|((_, std), w)| (w * std).powi(2)).sum::<f64>().sqrt();
    let beta = 4.31;
    let limit = mean + beta * std;
    let respond = |u: &[f64]| -> Vec<f64> {
        u.chunks_exact(3).map(|u| sum(&inputs.from_independent_normals(u)) - limit).collect()
    };
    let mut rng = ChaCha12Rng::seed_from_u64(seed);
    let subset = SubsetSimulation { variables: 3, samples: 10_000, most_levels: 9 }.run(&mut rng, &respond);
    let z = subset.u.chunks_exact(3).flat_map(|u| inputs.standardise(&inputs.from_independent_normals(u)));
    let population = Population::draw(&inputs, 1, seed).with_descendants(z.collect(), subset.origin.clone());
    let first: Vec<u32> = subset.y.iter().map(|y| u32::from(*y < 0.0)).collect();
    let points: Vec<usize> = (0..population.len()).collect();
    let sampled = Sampled { population: &population, points: &points, probability: subset.probability };
    let rows = sensitivities(&sampled, &[first], &[0], 1);
    let distances = rows.iter().zip(weights).zip(moments).flat_map(|((row, w), (_, deviation))| {
        let to_mean = standard_normal_pdf(beta) * w / std;
        let to_std = standard_normal_pdf(beta) * beta * w * w * deviation / (std * std);
        [(row.to_mean, to_mean), (row.to_std, to_std)]
            .map(|(estimate, exact)| (estimate.value - exact) / estimate.standard_error)
    });
    distances.collect()
}

#[test]
fn issue_standard_errors_of_rare_sensitivities_hold_over_seeds() {
    let all: Vec<f64> = (0..40).flat_map(rare_distances).collect();
    let rms = (all.iter().map(|z| z * z).sum::<f64>() / all.len() as f64).sqrt();
    // Six distances of a run move together; 40 runs give a standard deviation of about 0.1.
    assert!((0.7..1.4).contains(&rms), "{rms}");
    assert!(all.iter().all(|z| z.abs() < 5.0), "{all:?}");
}
