//! Hingewise's part of the comparison with scikit-learn, and measurements without a counterpart; see
//! `coordinator/doc/validation.md`.
//!
//! `surrogate_hingewise write DIR`       writes the data of the comparison
//! `surrogate_hingewise fit DIR`         fits them; prints JSON
//! `surrogate_hingewise likelihood DIR`  our likelihood at the parameters of DIR/scikit.txt; prints it
//! `surrogate_hingewise predict`         times prediction, triangular solve and added points; prints JSON
//! `surrogate_hingewise memory`          caches 1e6 points of 150 data; prints JSON

use common::random::Distribution;
use coordinator::statistics::design::Population;
use coordinator::statistics::learning::{ClassifiedMode, classify_cached};
use coordinator::statistics::surrogate::{
    Correlation, Effort, Form, FormSettings, Kernel, Kriging, Likelihood, PredictionCache, TrainingSet,
    Trend, fit_correlation, fit_surrogate,
};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Mat, MatRef, Par};
use rayon::prelude::*;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

/// Variables, points and points to test on.
const D: usize = 30;
const N: usize = 937;
const TEST: usize = 2000;
/// Points of the population.
const POPULATION: usize = 100_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["write", folder] => write_data(Path::new(folder))?,
        ["fit", folder] => println!("{}", fit(Path::new(folder))?),
        ["likelihood", folder] => println!("{}", likelihood_of_theirs(Path::new(folder))?),
        ["predict"] => println!("{}", predict()?),
        ["memory"] => println!("{}", memory()?),
        _ => return Err("one of: write DIR, fit DIR, likelihood DIR, predict, memory".into()),
    }
    Ok(())
}

fn population(d: usize, points: usize) -> Population {
    let variable = Distribution::truncated_normal(0.0, 1.0, -4.0, 4.0).unwrap();
    Population::draw(&vec![variable; d], points, 1)
}

/// A sum of smooth terms with decaying weights, neighbours coupled:
/// sum_k (1 + k)^-1.5 (sin(x_k + 0.2 k) + 0.3 cos(x_k) cos(x_k+1)).
fn function(x: &[f64]) -> f64 {
    (0..x.len())
        .map(|k| {
            let weight = (1.0 + k as f64).powf(-1.5);
            let next = x[(k + 1) % x.len()];
            weight * ((x[k] + 0.2 * k as f64).sin() + 0.3 * x[k].cos() * next.cos())
        })
        .sum()
}

fn values_at(points: MatRef<'_, f64>) -> Mat<f64> {
    Mat::from_fn(points.ncols(), 1, |i, _| function(&points.col(i).iter().copied().collect::<Vec<f64>>()))
}

/// The points of the fit and those of the test.
fn data() -> (Mat<f64>, Mat<f64>) {
    let all = population(D, N + TEST);
    (all.columns(0..N).to_owned(), all.columns(N..N + TEST).to_owned())
}

fn write_data(folder: &Path) -> std::io::Result<()> {
    let (points, test) = data();
    for (name, points) in [("train.csv", points), ("test.csv", test)] {
        let values = values_at(points.as_ref());
        let mut text = String::new();
        for (i, point) in points.col_iter().enumerate() {
            for x in point.iter() {
                write!(text, "{x:e},").expect("a string takes all");
            }
            writeln!(text, "{:e}", values[(i, 0)]).expect("a string takes all");
        }
        std::fs::write(folder.join(name), text)?;
    }
    Ok(())
}

fn fit(folder: &Path) -> Result<String, Box<dyn std::error::Error>> {
    let (points, test) = data();
    let values = values_at(points.as_ref());
    let training =
        TrainingSet { points: points.as_ref(), values: values.as_ref(), noise: None, is_exact: false };
    let (wall, processor) = (Instant::now(), processor_seconds()?);
    let fitted = fit_correlation(training, Form::default(), None, Effort::MultiStart);
    let (wall, processor) = (wall.elapsed().as_secs_f64(), processor_seconds()? - processor);
    let model = Kriging::condition(points.as_ref(), values.as_ref(), &fitted.correlation)?;
    let truth = values_at(test.as_ref());
    let predicted = model.predict(test.as_ref()).mean;
    let mean = truth.col(0).iter().sum::<f64>() / TEST as f64;
    let error: f64 = (0..TEST).map(|i| (truth[(i, 0)] - predicted[(0, i)]).powi(2)).sum();
    let total: f64 = truth.col(0).iter().map(|y| (y - mean).powi(2)).sum();
    let mut parameters = format!("{:e}\n", fitted.correlation.nugget);
    fitted.correlation.theta.iter().for_each(|theta| parameters.push_str(&format!("{theta:e}\n")));
    std::fs::write(folder.join("hingewise.txt"), parameters)?;
    Ok(format!(
        "{{\"wall_s\": {wall}, \"processor_s\": {processor}, \"value\": {}, \"evaluations\": {}, \"q2\": {}, \
         \"leave_one_out_q2\": {}, \"sigma2\": {}}}",
        value_at(training, &fitted.correlation)?,
        fitted.evaluations,
        1.0 - error / total,
        model.leave_one_out(values.as_ref())[0].q2,
        model.sigma2[0],
    ))
}

/// Our concentrated likelihood for a correlation.
fn value_at(training: TrainingSet<'_>, correlation: &Correlation) -> Result<f64, &'static str> {
    let likelihood = Likelihood {
        points: training.points,
        values: training.values,
        trend: Trend::Constant,
        weights: None,
    };
    Ok(likelihood.evaluate(correlation).ok_or("no Cholesky factor at these parameters")?.0)
}

/// DIR/scikit.txt holds the nugget and then theta, one a line.
fn likelihood_of_theirs(folder: &Path) -> Result<f64, Box<dyn std::error::Error>> {
    let text = std::fs::read_to_string(folder.join("scikit.txt"))?;
    let numbers = text.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>()?;
    let (points, _) = data();
    let values = values_at(points.as_ref());
    let training =
        TrainingSet { points: points.as_ref(), values: values.as_ref(), noise: None, is_exact: false };
    let correlation = Correlation {
        kernel: Kernel::Gaussian,
        theta: numbers[1..].to_vec(),
        nugget: numbers[0],
        stated: 0.0,
    };
    Ok(value_at(training, &correlation)?)
}

fn predict() -> Result<String, Box<dyn std::error::Error>> {
    let population = population(D, POPULATION);
    let (points, _) = data();
    let values = values_at(points.as_ref());
    let theta = (0..D).map(|k| 0.1 / (1.0 + k as f64)).collect();
    let correlation = Correlation { kernel: Kernel::Gaussian, theta, nugget: 1e-8, stated: 0.0 };
    let condition = |n: usize| Kriging::condition(points.subcols(0, n), values.subrows(0, n), &correlation);
    let model = condition(N)?;
    let block = PredictionCache::BLOCK;
    let starts: Vec<usize> = (0..POPULATION).step_by(block).collect();

    // Mean and variance against the bare solve of as many right-hand sides, blocks of both alternately.
    let l = Mat::from_fn(N, N, |i, j| {
        if i == j {
            2.0
        } else if i > j {
            0.01
        } else {
            0.0
        }
    });
    let sides = Mat::from_fn(N, block, |i, j| ((i * block + j) as f64).sin());
    let (mut solve, mut whole) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..3 {
        let start = Instant::now();
        starts.par_iter().for_each(|_| {
            let mut sides = sides.clone();
            solve_lower_triangular_in_place(l.as_ref(), sides.as_mut(), Par::Seq);
            std::hint::black_box(&sides);
        });
        solve = f64::min(solve, start.elapsed().as_secs_f64());
        let start = Instant::now();
        starts.par_iter().for_each(|from| {
            let points = population.columns(*from..POPULATION.min(from + block));
            std::hint::black_box(model.predict(points));
        });
        whole = f64::min(whole, start.elapsed().as_secs_f64());
    }

    // Points added one by one: the model extended, the cache and the classification updated to it.
    let mut cache = PredictionCache::default();
    let mut model = condition(N - 5)?;
    let mode = ClassifiedMode { index: 0, threshold: 0.0, grid: &[0], inflation: 1.0, by_mean: false };
    classify_cached(&mut cache, &model, &population, &mode);
    let mut added = f64::INFINITY;
    for i in N - 5..N {
        let start = Instant::now();
        model = model.extended(points.subcols(i, 1), values.subrows(i, 1), None)?;
        if cache.update(&model, &population) != Some(1) {
            return Err("the cache did not see that one point was added".into());
        }
        std::hint::black_box(classify_cached(&mut cache, &model, &population, &mode));
        added = f64::min(added, start.elapsed().as_secs_f64());
    }
    Ok(format!(
        "{{\"solve_s\": {solve}, \"predict_s\": {whole}, \"added_s\": {added}, \"threads\": {}}}",
        rayon::current_num_threads()
    ))
}

/// A million points, 150 data, the 72 checkpoints of the built-in studies.
fn memory() -> Result<String, Box<dyn std::error::Error>> {
    const CHECKPOINTS: usize = 72;
    let population = population(11, 1_000_000);
    let points = population.columns(0..150).to_owned();
    let values = Mat::from_fn(150, CHECKPOINTS, |i, o| {
        (1.0 + 0.01 * o as f64) * function(population.standardised(i)) + 0.02 * o as f64
    });
    let before = status("VmRSS")?;
    let (early, known) = (points.subcols(0, 142), values.subrows(0, 142));
    let training = TrainingSet { points: early, values: known.subcols(0, 24), noise: None, is_exact: false };
    let mut model = fit_surrogate(
        training,
        FormSettings { kernel: Some(Kernel::Gaussian), trend: Some(Trend::Constant) },
        None,
        Effort::MultiStart,
    )?
    .model;
    model.set_values(known);
    let mut cache = PredictionCache::default();
    let grid: Vec<usize> = (0..24).map(|i| 3 * i).collect();
    let mode = ClassifiedMode { index: 0, threshold: 1.0, grid: &grid, inflation: 1.0, by_mean: false };
    let start = Instant::now();
    classify_cached(&mut cache, &model, &population, &mode);
    let first = start.elapsed().as_secs_f64();
    model = model.extended(points.subcols(142, 8), values.subrows(142, 8), None)?;
    let start = Instant::now();
    let classification = classify_cached(&mut cache, &model, &population, &mode);
    let second = start.elapsed().as_secs_f64();
    Ok(format!(
        "{{\"before_kB\": {before}, \"cache_kB\": {}, \"now_kB\": {}, \"peak_kB\": {}, \"computed_s\": {first}, \
         \"extended_s\": {second}, \"failed\": {}}}",
        cache.bytes() / 1024,
        status("VmRSS")?,
        status("VmHWM")?,
        classification.first_failure.iter().filter(|n| (**n as usize) < CHECKPOINTS).count(),
    ))
}

/// A figure of /proc/self/status [kB].
fn status(key: &str) -> Result<u64, Box<dyn std::error::Error>> {
    let text = std::fs::read_to_string("/proc/self/status")?;
    let line = text.lines().find(|line| line.starts_with(key)).ok_or("no such figure")?;
    Ok(line.split_whitespace().nth(1).ok_or("no number")?.parse()?)
}

/// Processor time of this process so far, of all its threads [s].
fn processor_seconds() -> Result<f64, Box<dyn std::error::Error>> {
    let text = std::fs::read_to_string("/proc/self/stat")?;
    let after = text.rsplit_once(')').ok_or("no name")?.1;
    let field = |k: usize| -> Result<f64, Box<dyn std::error::Error>> {
        Ok(after.split_whitespace().nth(k).ok_or("too few fields")?.parse::<f64>()?)
    };
    // User and system time in ticks of 10 ms.
    Ok((field(11)? + field(12)?) / 100.0)
}
