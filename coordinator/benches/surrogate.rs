//! Times of a surrogate: one likelihood with its gradient, a fit, the choice of the form, predictions of a
//! population, and a point added to a cached prediction.
//!
//! `cargo bench -p coordinator --bench surrogate` runs all; `-- likelihood` selects by name. The load of the
//! machine changes all times: compare within one run. Items counted are predicted points.

use common::random::Distribution;
use coordinator::statistics::design::Population;
use coordinator::statistics::surrogate::{
    Correlation, Effort, Form, FormSettings, Kernel, Kriging, Likelihood, PredictionCache, TrainingSet,
    Trend, fit_correlation, fit_surrogate,
};
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Mat, Par};
use rayon::prelude::*;
use std::cmp::Ordering;

/// Number of points of the population.
const POPULATION: usize = 20_000;

fn main() {
    divan::main();
}

fn population(d: usize, points: usize) -> Population {
    let variable = Distribution::truncated_normal(0.0, 1.0, -4.0, 4.0).unwrap();
    Population::draw(&vec![variable; d], points, 1)
}

/// Points `(d, n)` and values `(n, m)` of a smooth function.
fn data(d: usize, n: usize, m: usize) -> (Mat<f64>, Mat<f64>) {
    let population = population(d, n);
    let value = |i: usize, o: usize| {
        let x = population.standardised(i);
        let terms = x.iter().enumerate().map(|(k, x)| (x + 0.2 * k as f64).sin() / (1.0 + k as f64));
        (1.0 + 0.1 * o as f64) * terms.sum::<f64>()
    };
    (population.columns(0..n).to_owned(), Mat::from_fn(n, m, value))
}

fn correlation(kernel: Kernel, d: usize) -> Correlation {
    let theta = (0..d).map(|k| 0.1 / (1.0 + k as f64)).collect();
    Correlation { kernel, theta, nugget: 1e-8, stated: 0.0 }
}

#[divan::bench(args = [(Kernel::Gaussian, Trend::Constant), (Kernel::Matern52, Trend::Constant), (Kernel::Gaussian, Trend::Linear)], sample_count = 5)]
fn likelihood_of_937_points(bencher: Bencher, (kernel, trend): (Kernel, Trend)) {
    let (points, values) = data(30, 937, 1);
    let likelihood = Likelihood { points: points.as_ref(), values: values.as_ref(), trend, weights: None };
    let correlation = correlation(kernel, 30);
    bencher.bench_local(|| likelihood.evaluate(black_box(&correlation)));
}

/// One form as in a study: 11 variables, 24 checkpoints.
#[divan::bench(args = [30, 60, 120], sample_count = 3, sample_size = 1)]
fn fit_of_one_form(bencher: Bencher, n: usize) {
    let (points, values) = data(11, n, 24);
    let training =
        TrainingSet { points: points.as_ref(), values: values.as_ref(), noise: None, is_exact: false };
    bencher.bench_local(|| fit_correlation(black_box(training), Form::default(), None, Effort::MultiStart));
}

#[divan::bench(args = [30, 60, 120], sample_count = 3, sample_size = 1)]
fn choice_of_the_form(bencher: Bencher, n: usize) {
    let (points, values) = data(11, n, 24);
    let training =
        TrainingSet { points: points.as_ref(), values: values.as_ref(), noise: None, is_exact: false };
    let settings = FormSettings::default();
    bencher.bench_local(|| fit_surrogate(black_box(training), settings, None, Effort::MultiStart));
}

fn model(n: usize) -> Kriging {
    let (points, values) = data(30, n, 1);
    let correlation = correlation(Kernel::Gaussian, 30);
    Kriging::condition(points.as_ref(), values.as_ref(), &correlation).expect("a sound model")
}

#[divan::bench(args = [150, 937], sample_count = 3, sample_size = 1)]
fn predictions(bencher: Bencher, n: usize) {
    let (population, model) = (population(30, POPULATION), model(n));
    let counter = ItemsCount::new(POPULATION);
    bencher.counter(counter).bench_local(|| PredictionCache::default().update(&model, &population));
}

/// The part of `predictions` that no method with this factor can leave out: one triangular solve for each point, in blocks of
/// the same size on all cores, by the linear algebra library alone.
#[divan::bench(args = [150, 937], sample_count = 3, sample_size = 1)]
fn bare_solves(bencher: Bencher, n: usize) {
    let factor = Mat::from_fn(n, n, |i, k| match i.cmp(&k) {
        Ordering::Greater => 0.1 / (1.0 + (i - k) as f64),
        Ordering::Equal => 1.0,
        Ordering::Less => 0.0,
    });
    let starts: Vec<usize> = (0..POPULATION).step_by(PredictionCache::BLOCK).collect();
    bencher.counter(ItemsCount::new(POPULATION)).bench_local(|| {
        starts.par_iter().for_each(|&first| {
            let width = PredictionCache::BLOCK.min(POPULATION - first);
            let mut right = Mat::from_fn(n, width, |i, k| (i + k) as f64);
            solve_lower_triangular_in_place(factor.as_ref(), right.as_mut(), Par::Seq);
            black_box(&right);
        });
    });
}

#[divan::bench(args = [150, 937], sample_count = 5, sample_size = 1)]
fn one_point_added(bencher: Bencher, n: usize) {
    let (population, model) = (population(30, POPULATION), model(n));
    let (points, values) = data(30, n + 1, 1);
    let extended = model.extended(points.subcols(n, 1), values.subrows(n, 1), None).expect("its own place");
    let mut cache = PredictionCache::default();
    cache.update(&model, &population);
    let counter = ItemsCount::new(POPULATION);
    bencher.counter(counter).with_inputs(|| cache.clone()).bench_local_values(|mut cache| {
        cache.update(black_box(&extended), &population);
        cache
    });
}
