//! Variance-based sensitivity of the outputs from the surrogates: Sobol indices of first order and total.
//!
//! With y(A) and y(B) the responses at two independent samples of n points, and y(A_k) those at A with column
//! k from B:
//!
//!   first order S_k = mean[y(B) (y(A_k) - y(A))] / V,    total T_k = mean[(y(A) - y(A_k))^2] / (2 V),
//!
//! with V the variance of y over A and B, and y about its mean. S_k is the share of the variance that
//! disappears if variable k is known, T_k the share that remains if all other variables are known. The
//! standard errors are those of the means. Valid for independent variables; the surrogate's own variance is
//! not included.
//!
//! # Source
//! Saltelli et al. (2010), Variance based sensitivity analysis of model output. Design and estimator for the
//! total sensitivity index, Computer Physics Communications 181(2), table 2 b and f; the latter from Jansen
//! (1999), Analysis of variance designs for model output, Computer Physics Communications 117.

use super::Estimate;
use crate::statistics::design::Population;
use faer::{Mat, MatRef};
use rayon::prelude::*;

/// Number of points of each sample: the indices are then known to about 1 / sqrt(4096) = 1.6 % of the
/// variance.
const SAMPLES: usize = 4096;
/// Number of points predicted together; fixed, so that sums do not depend on the number of threads.
const BLOCK: usize = 512;

/// Sobol indices of one output for one variable.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sobol {
    /// Index of first order S_k [1].
    pub first_order: Estimate,
    /// Total index T_k [1].
    pub total: Estimate,
}

/// Sums over the points, of one output.
#[derive(Clone)]
struct Sums {
    /// Sum and sum of squares of the summands of S.
    first: [f64; 2],
    /// Sum and sum of squares of the summands of T.
    total: [f64; 2],
}

/// Sobol indices `(outputs)(d,)` of the responses `(outputs, b)` that `predict` returns at standardised
/// points `(d, b)`. The two samples are the first points of the population, at most 4096 each. An output
/// without variance has indices zero.
pub fn sobol_indices(
    population: &Population,
    outputs: usize,
    predict: &(dyn Fn(MatRef<'_, f64>) -> Mat<f64> + Sync),
) -> Vec<Vec<Sobol>> {
    let d = population.dimension();
    let n = (population.len() / 2).min(SAMPLES);
    let starts: Vec<usize> = (0..n).step_by(BLOCK).collect();
    let predict_all = |first: usize| -> Vec<Mat<f64>> {
        let block = |start: &usize| {
            let end = n.min(start + BLOCK);
            predict(population.columns(first + start..first + end))
        };
        starts.par_iter().map(block).collect()
    };
    let (a, b) = (predict_all(0), predict_all(n));
    let moments: Vec<(f64, f64)> = (0..outputs).map(|o| moments(o, &a, &b)).collect();
    let by_variable = |k: usize| -> Vec<Sobol> {
        let mut sums = vec![Sums { first: [0.0; 2], total: [0.0; 2] }; outputs];
        for (block, start) in starts.iter().enumerate() {
            let end = n.min(start + BLOCK);
            let (points, other) = (population.columns(*start..end), population.columns(n + start..n + end));
            let mixed =
                Mat::from_fn(d, end - start, |i, j| if i == k { other[(i, j)] } else { points[(i, j)] });
            let y = predict(mixed.as_ref());
            for (o, sums) in sums.iter_mut().enumerate() {
                let mean = moments[o].0;
                for j in 0..end - start {
                    let (ya, yb, yk) = (a[block][(o, j)] - mean, b[block][(o, j)] - mean, y[(o, j)] - mean);
                    let (first, total) = (yb * (yk - ya), 0.5 * (ya - yk).powi(2));
                    sums.first = [sums.first[0] + first, sums.first[1] + first * first];
                    sums.total = [sums.total[0] + total, sums.total[1] + total * total];
                }
            }
        }
        let estimate = |[sum, squares]: [f64; 2], variance: f64| {
            let count = n as f64;
            let mean = sum / count;
            let spread = (squares / count - mean * mean).max(0.0) / count;
            Estimate { value: mean / variance, standard_error: spread.sqrt() / variance }
        };
        let index = |(sums, (mean, variance)): (&Sums, &(f64, f64))| {
            if *variance <= (1e-12 * mean).powi(2) {
                return Sobol::default();
            }
            Sobol { first_order: estimate(sums.first, *variance), total: estimate(sums.total, *variance) }
        };
        sums.iter().zip(&moments).map(index).collect()
    };
    let indices: Vec<Vec<Sobol>> = (0..d).into_par_iter().map(by_variable).collect();
    (0..outputs).map(|o| indices.iter().map(|outputs| outputs[o]).collect()).collect()
}

/// Mean and variance of output `o` over both samples.
fn moments(o: usize, a: &[Mat<f64>], b: &[Mat<f64>]) -> (f64, f64) {
    let values = || a.iter().chain(b).flat_map(|block| block.row(o).iter().copied());
    let count = values().count() as f64;
    let mean = values().sum::<f64>() / count;
    (mean, values().map(|y| (y - mean).powi(2)).sum::<f64>() / count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::random::Distribution;

    #[test]
    fn a_function_with_an_interaction_has_its_closed_form() {
        // y = 2 x1 + x2 + x2 x3 of standard normals: V = 4 + 1 + 1; S = 4/6, 1/6, 0; T = 4/6, 2/6, 1/6. And a
        // constant.
        let normal = Distribution::truncated_normal(0.0, 1.0, -8.0, 8.0).unwrap();
        let population = Population::draw(&vec![normal; 3], 10_000, 5);
        let predict = |x: MatRef<'_, f64>| {
            Mat::from_fn(2, x.ncols(), |o, j| {
                if o == 1 { 7.0 } else { 100.0 + 2.0 * x[(0, j)] + x[(1, j)] + x[(1, j)] * x[(2, j)] }
            })
        };
        let indices = sobol_indices(&population, 2, &predict);
        let exact = [(4.0, 4.0), (1.0, 2.0), (0.0, 1.0)].map(|(s, t)| (s / 6.0, t / 6.0));
        for (found, (first, total)) in indices[0].iter().zip(exact) {
            assert!(
                (found.first_order.value - first).abs() < 4.0 * found.first_order.standard_error,
                "{found:?}"
            );
            assert!((found.total.value - total).abs() < 4.0 * found.total.standard_error, "{found:?}");
            assert!(
                found.first_order.standard_error < 0.04 && found.total.standard_error < 0.03,
                "{found:?}"
            );
        }
        assert_eq!(indices[1], vec![Sobol::default(); 3]);
    }
}
