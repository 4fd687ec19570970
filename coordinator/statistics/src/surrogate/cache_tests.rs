//! The cache against predictions from scratch.

use super::*;
use crate::design::Population;
use common::random::Distribution;
use faer::Mat;

fn population(points: usize) -> Population {
    let variable = Distribution::truncated_normal(0.0, 1.0, -5.0, 5.0).unwrap();
    Population::draw(&vec![variable; 3], points, 3)
}

fn function(x: &[f64], output: usize) -> f64 {
    5.0 + x[0].sin() + (0.3 + 0.2 * output as f64) * x[1] * x[2]
}

/// The first `n` points of the population as data.
fn data(population: &Population, n: usize) -> (Mat<f64>, Mat<f64>) {
    let x = population.columns(0..n).to_owned();
    let y = Mat::from_fn(n, 2, |i, o| function(population.standardised(i), o));
    (x, y)
}

fn correlation(kernel: Kernel) -> Correlation {
    Correlation { kernel, theta: vec![0.1, 0.05, 0.05], nugget: 1e-8, stated: 0.0 }
}

/// Largest differences of means and variance factors between the cache and a prediction from scratch.
fn differences(cache: &PredictionCache, model: &Kriging, population: &Population) -> (f64, f64) {
    let (mut of_mean, mut of_factor) = (0.0, 0.0);
    let blocks = population.len().div_ceil(PredictionCache::BLOCK);
    for i in 0..blocks {
        let from = i * PredictionCache::BLOCK;
        let points = population.columns(from..population.len().min(from + PredictionCache::BLOCK));
        let (cached, fresh) = (cache.block(i).unwrap(), model.predict(points));
        assert_eq!(cached.mean.shape(), fresh.mean.shape());
        of_mean = f64::max(of_mean, (&cached.mean - &fresh.mean).norm_max());
        for (a, b) in cached.variance_factor.iter().zip(&fresh.variance_factor) {
            of_factor = f64::max(of_factor, (a - b).abs());
        }
    }
    assert_eq!(cache.block(blocks), None);
    (of_mean, of_factor)
}

#[test]
fn points_and_population_added_bit_by_bit_equal_a_prediction_from_scratch() {
    for (kernel, trend) in [(Kernel::Gaussian, Trend::Constant), (Kernel::Matern52, Trend::Linear)] {
        let mut population = population(1200);
        let (x, y) = data(&population, 60);
        let of = |n: usize| {
            let (x, y) = (x.subcols(0, n), y.subrows(0, n));
            Kriging::condition_noisy(x, y, &correlation(kernel), trend, None).unwrap()
        };
        let mut cache = PredictionCache::default();
        let mut model = of(20);
        assert_eq!(cache.update(&model, &population), None);
        assert_eq!(cache.update(&model, &population), Some(0));
        for (from, to) in [(20, 21), (21, 29), (29, 60)] {
            model = model.extended(x.subcols(from, to - from), y.subrows(from, to - from), None).unwrap();
            assert_eq!(cache.update(&model, &population), Some(to - from));
            population.grow_to(population.len() + 300);
            assert_eq!(cache.update(&model, &population), Some(0));
        }
        let (of_mean, of_factor) = differences(&cache, &of(60), &population);
        assert!(of_mean < 1e-7 && of_factor < 1e-9, "{kernel:?} {of_mean:e} {of_factor:e}");
        // Other lengths are seen.
        let other = Correlation { theta: vec![0.11, 0.05, 0.05], ..correlation(kernel) };
        let other = Kriging::condition_noisy(x.as_ref(), y.as_ref(), &other, trend, None).unwrap();
        assert_eq!(cache.update(&other, &population), None);
        let (of_mean, of_factor) = differences(&cache, &other, &population);
        assert!(of_mean < 1e-9 && of_factor < 1e-11, "{kernel:?} {of_mean:e} {of_factor:e}");
        // So are other values of the same points.
        let mut moved = other.clone();
        moved.set_values((&y * faer::Scale(2.0)).as_ref());
        assert_eq!(cache.update(&moved, &population), None);
    }
}

#[test]
fn issue_a_cache_stays_within_its_limit_of_memory() {
    let population = population(6000);
    let (x, y) = data(&population, 60);
    let mut model = Kriging::condition_noisy(
        x.subcols(0, 40),
        y.subrows(0, 40),
        &correlation(Kernel::Gaussian),
        Trend::Constant,
        None,
    )
    .unwrap();
    let mut cache = PredictionCache::default();
    cache.set_limit(1_000_000);
    let mut kept = usize::MAX;
    for to in [40, 41, 60] {
        let from = model.points();
        if to > from {
            model = model.extended(x.subcols(from, to - from), y.subrows(from, to - from), None).unwrap();
        }
        cache.update(&model, &population);
        assert!(cache.bytes() <= 1_000_000, "{}", cache.bytes());
        let now = (0..12).take_while(|i| cache.block(*i).is_some()).count();
        assert!((2..12).contains(&now) && now <= kept, "{now} {kept}");
        kept = now;
    }
    let fresh = model.predict(population.columns(0..PredictionCache::BLOCK));
    let difference = (&cache.block(0).unwrap().mean - &fresh.mean).norm_max();
    assert!(difference < 1e-7, "{difference:e}");
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let population = population(3000);
    let (x, y) = data(&population, 40);
    let of = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let training =
                TrainingSet { points: x.as_ref(), values: y.as_ref(), noise: None, is_exact: false };
            let chosen = fit_surrogate(training, FormSettings::default(), None, Effort::MultiStart).unwrap();
            let mut cache = PredictionCache::default();
            cache.update(&chosen.model, &population);
            let blocks: Vec<Prediction> = (0..6).map(|i| cache.block(i).unwrap()).collect();
            (chosen.fitted, blocks)
        })
    };
    assert_eq!(of(1), of(3));
}

#[test]
fn single_precision_would_move_small_variances() {
    let population = population(512);
    let (x, y) = data(&population, 60);
    let model = Kriging::condition(x.as_ref(), y.as_ref(), &correlation(Kernel::Gaussian)).unwrap();
    let points = population.columns(60..512);
    let factors = model.predict(points).variance_factor;
    let w = model.whitened(points);
    // Rounded rows of the first half; the others follow from them, as they do when the cache is extended.
    let half = 30;
    let r = model.correlations(points);
    let mut rounded =
        Mat::from_fn(60, w.ncols(), |i, j| if i < half { f64::from(w[(i, j)] as f32) } else { r[(i, j)] });
    for j in 0..w.ncols() {
        for i in half..60 {
            let known: f64 = (0..i).map(|k| model.l[(i, k)] * rounded[(k, j)]).sum();
            rounded[(i, j)] = f64::from(((rounded[(i, j)] - known) / model.l[(i, i)]) as f32);
        }
    }
    let u = model.trend.extrapolation(points, rounded.as_ref());
    let worst = (0..w.ncols())
        .filter(|j| factors[*j] > 0.0)
        .map(|j| {
            let factor = 1.0 - rounded.col(j).squared_norm_l2() + model.trend.variance(u.col(j));
            (factor / factors[j] - 1.0).abs()
        })
        .fold(0.0, f64::max);
    assert!(worst > 0.5, "{worst}");
}
