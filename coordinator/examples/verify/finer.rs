//! Studies against R(n) at a finer accuracy. Direct simulation at that accuracy is dear; here the samples of a direct study at a working
//! accuracy are corrected by a plane through the differences that a few of them show at the finer one, and what the plane leaves is
//! counted at those few, so that the estimate is right, but for terms of order 1/M, however good the plane is (control variates):
//!
//!   R(n) = mean_P 1(s_p + plane_p not failed) + mean_N [1(y_j + plane_j not failed) - 1(s_j + plane_j not failed)]
//!        + mean_M [1(f_i not failed) - 1(y_i + plane_-i,i not failed)],
//!
//! N samples with results y, of which M have a result f at the finer accuracy; plane_-i is fitted without pair i. s is the prediction of
//! surrogates that were fitted to other samples of the direct study, P a large population: it takes most of the sampling error away.
//! The variance is the sum of those of the three means. That of the last one is at least p / M, with the share p of the N samples whose
//! state changes when the residual f_i - y_i - plane_-i,i of one pair, another for each sample, is added: a difference that no pair shows
//! is an error too.
//!
//! # Source
//! Glasserman (2003), Monte Carlo Methods in Financial Engineering, Springer, section 4.1.

use crate::Study;
use crate::against::{first_failures, observations};
use crate::simulated::SimulatedPoint;
use coordinator::results::summary::StudySummary;
use coordinator::statistics::design::{InputModel, Population};
use coordinator::statistics::learning::Mode;
use coordinator::statistics::reliability::REACH;
use coordinator::study::{Problem, Surrogate, learn_from_results};
use faer::Mat;
use faer::linalg::solvers::SolveLstsq;
use std::collections::HashMap;
use std::error::Error;

/// First samples, to which the surrogates are fitted.
const FITTED: usize = 200;
/// Points of the population, classified in blocks.
const POPULATION: usize = 200_000;
const BLOCK: usize = 2000;

/// R(n) at the finer accuracy per curve and checkpoint, and its variance.
pub struct FinerReliability {
    /// Names of the curves, the system last.
    pub curves: Vec<String>,
    /// Checkpoints [cycles].
    pub cycles: Vec<u32>,
    /// R(n) `(curves)(m,)` [1].
    pub reliability: Vec<Vec<f64>>,
    /// Variances `(curves)(m,)` [1].
    pub variance: Vec<Vec<f64>>,
    /// Pairs.
    pub pairs: usize,
}

/// Estimates R(n) from a direct study and the same samples at a finer accuracy, as many as there are.
pub fn finer_reliability(direct: &Study, finer: &Study) -> Result<FinerReliability, Box<dyn Error>> {
    let scene = direct.source.nominal();
    let problem = Problem::from_scene(scene);
    let bits = |sample: &[f64]| sample.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
    // The first evaluation is the nominal point, which is no sample.
    let samples: Vec<SimulatedPoint> = direct.simulated().split_off(1);
    let at_finer: HashMap<Vec<u64>, SimulatedPoint> =
        finer.simulated().into_iter().skip(1).map(|point| (bits(&point.sample), point)).collect();
    let (places, fine): (Vec<usize>, Vec<&SimulatedPoint>) = samples
        .iter()
        .enumerate()
        .filter_map(|(j, point)| Some((j, at_finer.get(&bits(&point.sample))?)))
        .unzip();
    let basis = |j: usize| basis_of(&problem.inputs, &samples[j].sample);
    let columns = problem.inputs.dimension() + 1;
    if samples.len() < 2 * FITTED {
        return Err(format!("{} samples, expected {}", samples.len(), 2 * FITTED).into());
    }
    if places.len() < 3 * columns {
        return Err(format!("{} samples at both accuracies, expected {}", places.len(), 3 * columns).into());
    }
    let x = Mat::from_fn(places.len(), columns, |i, k| basis(places[i])[k]);
    let (qr, q) = (x.qr(), x.qr().compute_thin_Q());
    // How much of its own difference each pair has in the plane.
    let leverage: Vec<f64> = (0..places.len()).map(|i| q.row(i).iter().map(|v| v * v).sum()).collect();
    let mut planes = vec![vec![Vec::new(); problem.checkpoints.len()]; scene.outputs.len()];
    let mut corrected = samples.clone();
    let mut left_out: Vec<SimulatedPoint> = fine.iter().map(|point| (*point).clone()).collect();
    for (output, of_output) in planes.iter_mut().enumerate() {
        for (n, coefficients) in of_output.iter_mut().enumerate() {
            let value = |point: &SimulatedPoint| point.observed.histories[output][n];
            let difference =
                Mat::from_fn(places.len(), 1, |i, _| value(fine[i]) - value(&samples[places[i]]));
            let plane = qr.solve_lstsq(&difference);
            *coefficients = (0..columns).map(|k| plane[(k, 0)]).collect();
            let at = |j: usize| basis(j).iter().enumerate().map(|(k, b)| b * plane[(k, 0)]).sum::<f64>();
            for (j, point) in corrected.iter_mut().enumerate() {
                point.observed.histories[output][n] += at(j);
            }
            for (i, place) in places.iter().enumerate() {
                let residual = (difference[(i, 0)] - at(*place)) / (1.0 - leverage[i]);
                left_out[i].observed.histories[output][n] -= residual;
            }
        }
    }
    let learned = learn_from_results(scene, scene, &direct.settings, &direct.outcomes[..=FITTED])?;
    let surrogates = learned.assessment.surrogates;
    let (m, modes) = (problem.checkpoints.len(), &problem.modes);
    // First failures by the surrogates and the planes of standardised points `(n * d,)`.
    let predicted = |z: &[f64]| -> Vec<Vec<u32>> {
        let d = columns - 1;
        let points = Mat::from_fn(d, z.len() / d, |k, j| z[j * d + k]);
        let of_mode = |(mode, surrogate): (&Mode, &Surrogate)| {
            let mean = surrogate.model.predict(points.as_ref()).mean;
            let plane = |n: usize, j: usize| {
                let plane = &planes[mode.output][n];
                plane[0] + z[j * d..(j + 1) * d].iter().zip(&plane[1..]).map(|(z, b)| z * b).sum::<f64>()
            };
            let failed = |n: usize, j: usize| mean[(n, j)] + plane(n, j) >= surrogate.threshold.value;
            let first = |j: usize| (0..m).find(|n| failed(*n, j)).unwrap_or(m) as u32;
            (0..points.ncols()).map(first).collect::<Vec<u32>>()
        };
        with_system(modes.iter().zip(&surrogates).map(of_mode).collect())
    };
    let population = Population::draw(problem.inputs.clone(), POPULATION, direct.settings.seed + 1);
    let mut of_population = vec![Vec::new(); modes.len() + 1];
    for from in (0..POPULATION).step_by(BLOCK) {
        let z: Vec<f64> =
            (from..POPULATION.min(from + BLOCK)).flat_map(|j| population.standardised(j).to_vec()).collect();
        of_population.iter_mut().zip(predicted(&z)).for_each(|(all, block)| all.extend(block));
    }
    let others: Vec<f64> =
        samples[FITTED..].iter().flat_map(|point| problem.inputs.standardise(&point.sample)).collect();
    let of_others = predicted(&others);
    let firsts = |points: &[SimulatedPoint]| {
        with_system(first_failures(&problem, &observations(scene, &problem, points)))
    };
    let fine: Vec<SimulatedPoint> = fine.into_iter().cloned().collect();
    let mut shifted = corrected.clone();
    for (j, point) in shifted.iter_mut().enumerate() {
        let (f, rest) = (&fine[j % fine.len()].observed, &left_out[j % fine.len()].observed);
        for (output, history) in point.observed.histories.iter_mut().enumerate() {
            let residuals = f.histories[output].iter().zip(&rest.histories[output]).map(|(a, b)| a - b);
            history.iter_mut().zip(residuals).for_each(|(value, residual)| *value += residual);
        }
    }
    let [all, fine, left_out, shifted] =
        [&corrected, &fine, &left_out, &shifted].map(|points| firsts(points));
    let survives = |first: u32, n: usize| f64::from(u8::from(first as usize > n));
    let (mut reliability, mut variance) = (Vec::new(), Vec::new());
    for curve in 0..all.len() {
        let moments = |values: Vec<f64>| {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
            (mean, squares / (values.len() as f64 * (values.len() as f64 - 1.0)))
        };
        let at = |n: usize| {
            let (counted, of_points) =
                moments(of_population[curve].iter().map(|first| survives(*first, n)).collect());
            let pairs = all[curve][FITTED..].iter().zip(&of_others[curve]);
            let (missed, of_samples) =
                moments(pairs.map(|(a, b)| survives(*a, n) - survives(*b, n)).collect());
            let pairs = fine[curve].iter().zip(&left_out[curve]);
            let (rest, of_pairs) = moments(pairs.map(|(a, b)| survives(*a, n) - survives(*b, n)).collect());
            let differ = |(a, b): (&u32, &u32)| survives(*a, n) != survives(*b, n);
            let differing = shifted[curve].iter().zip(&all[curve]).filter(|pair| differ(*pair)).count();
            let of_pairs = of_pairs.max(differing as f64 / (samples.len() * places.len()) as f64);
            (counted + missed + rest, of_points + of_samples + of_pairs)
        };
        let (of_curve, its_variance) = (0..problem.checkpoints.len()).map(at).unzip();
        reliability.push(of_curve);
        variance.push(its_variance);
    }
    let curves =
        scene.limit_states.iter().map(|limit| limit.name.clone()).chain(["total".to_owned()]).collect();
    let cycles = scene.life.checkpoints();
    Ok(FinerReliability { curves, cycles, reliability, variance, pairs: places.len() })
}

/// The first failures of the limit states, and those of the system.
fn with_system(mut modes: Vec<Vec<u32>>) -> Vec<Vec<u32>> {
    let points = modes.first().map_or(0, Vec::len);
    let system = (0..points).map(|j| modes.iter().map(|mode| mode[j]).min().unwrap_or(0)).collect();
    modes.push(system);
    modes
}

/// One, and the standardised coordinates of a sample.
fn basis_of(inputs: &InputModel, sample: &[f64]) -> Vec<f64> {
    std::iter::once(1.0).chain(inputs.standardise(sample)).collect()
}

/// Prints R(n) where some units fail, and for each study how its 95 % intervals hold it, which is returned in words.
pub fn print_finer(truth: &FinerReliability, studies: &[(String, StudySummary)]) -> Vec<String> {
    let mut words = Vec::new();
    println!("R(n) at the finer accuracy from {} pairs, ± 95 %", truth.pairs);
    println!("cycles | {}", truth.curves.join(" | "));
    let of_interest = |curve: usize, n: usize| (0.01..0.99).contains(&truth.reliability[curve][n]);
    for (n, cycles) in truth.cycles.iter().enumerate() {
        let cell = |curve: usize| {
            format!("{:.4} ± {:.4}", truth.reliability[curve][n], REACH * truth.variance[curve][n].sqrt())
        };
        if (0..truth.curves.len()).any(|curve| of_interest(curve, n)) {
            println!("{cycles} | {}", (0..truth.curves.len()).map(cell).collect::<Vec<_>>().join(" | "));
        }
    }
    println!(
        "study | evaluations | held of checkpoints with 0.01 < R < 0.99 | held, truth within its own error | largest difference | widest interval"
    );
    for (name, summary) in studies {
        let (mut all, mut held, mut within, mut largest, mut widest) = (0, 0, 0, 0.0_f64, 0.0_f64);
        for (curve, name) in truth.curves.iter().enumerate() {
            for (n, row) in summary.reliability.iter().enumerate() {
                let Some(interval) = row.interval.get(name) else { continue };
                widest = widest.max(0.5 * (interval.upper - interval.lower));
                let (r, own) = (truth.reliability[curve][n], REACH * truth.variance[curve][n].sqrt());
                if !of_interest(curve, n) {
                    continue;
                }
                all += 1;
                held += usize::from((interval.lower..=interval.upper).contains(&r));
                within += usize::from(interval.lower - own <= r && r <= interval.upper + own);
                largest = largest.max((row.reliability[name] - r).abs());
            }
        }
        println!(
            "{name} | {} | {held} of {all} | {within} of {all} | {largest:.4} | ± {widest:.4}",
            summary.evaluations.total
        );
        words.push(format!(
            "they hold it at {held} of {all} checkpoints with 0.01 < R < 0.99, at {within} with its own error; largest difference {largest:.4}"
        ));
    }
    words
}
