//! Variance-based sensitivity of the outputs from the surrogates: Sobol indices of first order and total.
//!
//! With y(A) and y(B) the responses at two independent samples of n points, y(A_k) those at A with column k from B, and
//! y(B_k) those at B with column k from A:
//!
//!   first order S_k = mean[(y(A) - y(A_k)) (y(B_k) - y(B))] / (2 V),
//!   total       T_k = mean[(y(A) - y(A_k))^2 + (y(B_k) - y(B))^2] / (4 V),
//!
//! with V the variance of y over A and B. S_k is the share of the variance that disappears if variable k is known, T_k the
//! share that remains if all other variables are known. S_k <= T_k in every sample, because a b <= (a^2 + b^2) / 2, and
//! S_k = T_k where variable k has no interactions. The standard errors are those of the ratios of means, to first order.
//! Valid for independent variables; the error of a surrogate is not included, see [`surrogate_errors`].
//!
//! # Source
//! Jansen (1999), Analysis of variance designs for model output, Computer Physics Communications 117, for T_k; products of
//! differences for S_k: Owen (2013), Better estimation of small Sobol' sensitivity indices, ACM Transactions on Modeling and
//! Computer Simulation 23(2). Of the four products of S_k two have the mean mean(y)^2 + S_k V, y(A) y(B_k) and y(A_k) y(B), and
//! two, of independent points, mean(y)^2. Errors by leaving out groups: Quenouille (1956), Notes on bias in estimation, Biometrika 43;
//! Efron, Stein (1981), The jackknife estimate of variance, Annals of Statistics 9(3).

use super::Estimate;
use crate::design::Population;
use faer::{Mat, MatRef};
use rayon::prelude::*;

/// Number of points of each sample: the indices are then known to about 1 / sqrt(4096) = 1.6 % of the
/// variance.
pub const SAMPLES: usize = 4096;
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

/// Sums of a quantity q and of the variance v of the points.
#[derive(Clone, Copy, Default)]
struct RatioSums {
    q: f64,
    v: f64,
    qq: f64,
    qv: f64,
    vv: f64,
}

impl RatioSums {
    fn add(&mut self, q: f64, v: f64) {
        self.q += q;
        self.v += v;
        self.qq += q * q;
        self.qv += q * v;
        self.vv += v * v;
    }

    /// mean(q) / mean(v) with its standard error sqrt(mean((q - ratio v)^2)) / (sqrt(n) mean(v)).
    fn ratio(&self, count: usize) -> Estimate {
        let value = self.q / self.v;
        let squares = self.qq - 2.0 * value * self.qv + value * value * self.vv;
        Estimate {
            value,
            standard_error: squares.max(0.0).sqrt() / self.v * (count as f64 / (count as f64 - 1.0)).sqrt(),
        }
    }
}

/// Sobol indices `(outputs)(d,)` of the responses `(outputs, b)` that `predict` returns at standardised
/// points `(d, b)`. The two samples are the first points of the population, at most `samples` each. An output
/// without variance has indices zero.
pub fn sobol_indices(
    population: &Population,
    samples: usize,
    outputs: usize,
    predict: &(dyn Fn(MatRef<'_, f64>) -> Mat<f64> + Sync),
) -> Vec<Vec<Sobol>> {
    let d = population.dimension();
    let n = (population.len() / 2).min(samples);
    let starts: Vec<usize> = (0..n).step_by(BLOCK).collect();
    let points = |start: usize| {
        let end = n.min(start + BLOCK);
        (population.columns(start..end), population.columns(n + start..n + end))
    };
    let predicted = |start: &usize| {
        let (a, b) = points(*start);
        (predict(a), predict(b))
    };
    let unmixed: Vec<(Mat<f64>, Mat<f64>)> = starts.par_iter().map(predicted).collect();
    let moments: Vec<(f64, f64)> = (0..outputs).map(|o| moments(o, &unmixed)).collect();
    let by_variable = |k: usize| -> Vec<Sobol> {
        // Sums over the points, of each output for the index of first order and the total one.
        let mut sums = vec![[RatioSums::default(); 2]; outputs];
        for ((a, b), start) in unmixed.iter().zip(&starts) {
            let (of_a, of_b) = points(*start);
            let mixed = |own: MatRef<'_, f64>, other: MatRef<'_, f64>| {
                let mixed = |i, j| if i == k { other[(i, j)] } else { own[(i, j)] };
                predict(Mat::from_fn(d, own.ncols(), mixed).as_ref())
            };
            let (ak, bk) = (mixed(of_a, of_b), mixed(of_b, of_a));
            for (o, sums) in sums.iter_mut().enumerate() {
                let mean = moments[o].0;
                for j in 0..a.ncols() {
                    let (of_a, of_b) = (a[(o, j)] - ak[(o, j)], bk[(o, j)] - b[(o, j)]);
                    let v = 0.5 * ((a[(o, j)] - mean).powi(2) + (b[(o, j)] - mean).powi(2));
                    sums[0].add(0.5 * of_a * of_b, v);
                    sums[1].add(0.25 * (of_a * of_a + of_b * of_b), v);
                }
            }
        }
        let index = |(sums, (mean, variance)): (&[RatioSums; 2], &(f64, f64))| {
            if *variance <= (1e-12 * mean).powi(2) {
                return Sobol::default();
            }
            let [first_order, total] = sums.map(|sums| sums.ratio(n));
            Sobol { first_order, total }
        };
        sums.iter().zip(&moments).map(index).collect()
    };
    let indices: Vec<Vec<Sobol>> = (0..d).into_par_iter().map(by_variable).collect();
    (0..outputs).map(|o| indices.iter().map(|outputs| outputs[o]).collect()).collect()
}

/// Standard errors `(outputs)(d,)` of the indices of first order and total by the surrogate that predicts the responses, from
/// the indices `whole` by all results and `without` each of g groups of them `(g)(outputs)(d,)`, over the same points:
///
///   error^2 = (g - 1) / g sum over the groups of (index without - index)^2.
pub fn surrogate_errors(whole: &[Vec<Sobol>], without: &[Vec<Vec<Sobol>>]) -> Vec<Vec<(f64, f64)>> {
    let groups = without.len() as f64;
    let error = |o: usize, k: usize, of: fn(&Sobol) -> f64| {
        let square = |group: &Vec<Vec<Sobol>>| (of(&group[o][k]) - of(&whole[o][k])).powi(2);
        ((groups - 1.0) / groups * without.iter().map(square).sum::<f64>()).max(0.0).sqrt()
    };
    let both = |o: usize, k: usize| (error(o, k, |s| s.first_order.value), error(o, k, |s| s.total.value));
    let of_output = |(o, output): (usize, &Vec<Sobol>)| (0..output.len()).map(|k| both(o, k)).collect();
    whole.iter().enumerate().map(of_output).collect()
}

/// Mean and variance of output `o` over both samples.
fn moments(o: usize, samples: &[(Mat<f64>, Mat<f64>)]) -> (f64, f64) {
    let values = || samples.iter().flat_map(|(a, b)| a.row(o).iter().chain(b.row(o).iter()).copied());
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
        let indices = sobol_indices(&population, SAMPLES, 2, &predict);
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

    #[test]
    fn issue_the_first_order_was_above_the_total() {
        // A variable without interactions has equal indices, one that nothing depends on has none, whatever the sample.
        let normal = Distribution::truncated_normal(0.0, 1.0, -8.0, 8.0).unwrap();
        for seed in 0..10 {
            let population = Population::draw(&vec![normal.clone(); 4], 400, seed);
            let predict = |x: MatRef<'_, f64>| {
                Mat::from_fn(1, x.ncols(), |_, j| {
                    (2.0 * x[(0, j)]).sin() + x[(1, j)].powi(2) + x[(1, j)] * x[(2, j)]
                })
            };
            let indices = &sobol_indices(&population, SAMPLES, 1, &predict)[0];
            for found in indices {
                assert!(found.first_order.value <= found.total.value + 1e-12, "{seed}: {found:?}");
            }
            assert!((indices[0].first_order.value - indices[0].total.value).abs() < 1e-12);
            assert_eq!(indices[3], Sobol::default());
        }
    }

    #[test]
    fn errors_of_the_surrogate_are_those_of_a_mean_over_its_results() {
        // Of an index that is the mean of g numbers, each left out in turn, the error is that of the mean.
        let values = [0.1, 0.5, 0.2, 0.8];
        let mean = values.iter().sum::<f64>() / 4.0;
        let of = |value: f64| {
            let estimate = |value| Estimate { value, standard_error: 0.0 };
            vec![vec![Sobol { first_order: estimate(value), total: estimate(2.0 * value) }]]
        };
        let without: Vec<Vec<Vec<Sobol>>> = values.iter().map(|y| of((4.0 * mean - y) / 3.0)).collect();
        let (first, total) = surrogate_errors(&of(mean), &without)[0][0];
        let spread = values.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / 3.0;
        assert!((first - (spread / 4.0).sqrt()).abs() < 1e-12 && (total - 2.0 * first).abs() < 1e-12);
    }
}
