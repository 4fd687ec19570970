//! Maximum likelihood of the correlation parameters by L-BFGS over bounded logarithms.
//!
//! Each logarithm p in [low, high] is written p = low + (high - low) / (1 + exp(-t)) and the free t is optimised, so
//! no projection is needed and a variable without influence drifts to its lower bound where the likelihood is flat.

use super::{Correlation, Likelihood, LikelihoodValue};
use argmin::core::{CostFunction, Error, Executor, Gradient};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use faer::MatRef;
use rayon::prelude::*;
use std::cell::RefCell;

/// Bounds of theta in standardised inputs: lengths from 0.2 to 700 standard deviations.
const THETA_BOUNDS: (f64, f64) = (1e-6, 10.0);
/// Bounds of the nugget. Below 1e-10 a Gaussian correlation matrix of a few hundred points loses its Cholesky
/// factor to rounding; above 0.3 the noise would have half the standard deviation of the output.
pub(crate) const NUGGET_BOUNDS: (f64, f64) = (1e-10, 0.3);
/// Change of f per iteration below which the optimum counts as found; 1e-6 n is 2 ln L, far inside its confidence.
const VALUE_TOLERANCE: f64 = 1e-6;
/// Stored corrections of L-BFGS.
const MEMORY: usize = 8;

/// How much to spend on a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// From the previous parameters.
    Warm,
    /// From several fixed starts and the previous parameters.
    MultiStart,
}

/// A fitted correlation.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// The parameters.
    pub correlation: Correlation,
    /// f at them.
    pub value: f64,
    /// Likelihood evaluations spent.
    pub evaluations: usize,
    /// Starts that gave nothing usable.
    pub failed_starts: usize,
}

/// Correlation of greatest likelihood for points `(d, n)` and values `(n, m)`.
///
/// Columns of `values` without variance carry no information on lengths and are left out; if none is left the lengths
/// are the longest allowed. The result depends on the data and `previous` only.
pub fn fit_correlation(
    points: MatRef<'_, f64>,
    values: MatRef<'_, f64>,
    previous: Option<&Correlation>,
    effort: Effort,
) -> Fitted {
    let d = points.nrows();
    let values = standardise(values);
    if values.ncols() == 0 {
        let correlation = Correlation { theta: vec![THETA_BOUNDS.0; d], nugget: NUGGET_BOUNDS.0 };
        return Fitted { correlation, value: f64::NEG_INFINITY, evaluations: 0, failed_starts: 0 };
    }
    let likelihood = Likelihood { points, values: values.as_ref() };
    let mut starts: Vec<Vec<f64>> = previous.map(to_free).into_iter().collect();
    if starts.is_empty() || effort == Effort::MultiStart {
        starts.extend(fixed_starts(&likelihood).iter().map(to_free));
    }
    // A first round of all starts side by side, each far enough to tell them apart; then the best to its end.
    let budget = if starts.len() > 1 { 25 } else { 60 };
    let outcomes: Vec<Outcome> =
        starts.into_par_iter().map(|start| descend(&likelihood, start, budget)).collect();
    let mut evaluations = outcomes.iter().map(|o| o.evaluations).sum();
    let failed_starts = outcomes.iter().filter(|o| o.best.is_none()).count();
    let alone = outcomes.len() == 1;
    let best = outcomes.into_iter().filter_map(|o| o.best).reduce(|a, b| if b.1 < a.1 { b } else { a });
    let Some((mut free, mut value)) = best else {
        let correlation = Correlation { theta: vec![0.1 / d as f64; d], nugget: 1e-4 };
        return Fitted { correlation, value: f64::INFINITY, evaluations, failed_starts };
    };
    if !alone {
        let polished = descend(&likelihood, free.clone(), 60);
        evaluations += polished.evaluations;
        if let Some((better, lower)) = polished.best.filter(|b| b.1 < value) {
            (free, value) = (better, lower);
        }
    }
    Fitted { correlation: from_free(&free), value, evaluations, failed_starts }
}

/// Columns with variance, each to mean 0 and variance 1, so that outputs of any unit weigh the same.
fn standardise(values: MatRef<'_, f64>) -> faer::Mat<f64> {
    let n = values.nrows() as f64;
    let columns: Vec<Vec<f64>> = values
        .col_iter()
        .filter_map(|column| {
            let mean = column.iter().sum::<f64>() / n;
            let std = (column.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / n).sqrt();
            (std > 1e-12 * mean.abs() && std > 0.0).then(|| column.iter().map(|y| (y - mean) / std).collect())
        })
        .collect();
    faer::Mat::from_fn(values.nrows(), columns.len(), |i, o| columns[o][i])
}

/// Isotropic starts at three lengths, and two with theta in proportion to the squared linear correlation between
/// variable and outputs, which is close to the optimum where few variables matter.
fn fixed_starts(likelihood: &Likelihood<'_>) -> Vec<Correlation> {
    let d = likelihood.points.nrows();
    let isotropic = |sum: f64| Correlation { theta: vec![sum / d as f64; d], nugget: 1e-4 };
    let influence: Vec<f64> = (0..d).map(|k| mean_squared_correlation(likelihood, k)).collect();
    let total: f64 = influence.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let weighted = |sum: f64| Correlation {
        theta: influence.iter().map(|w| sum * (0.02 / d as f64 + 0.98 * w / total)).collect(),
        nugget: 1e-4,
    };
    vec![isotropic(0.02), isotropic(0.2), isotropic(2.0), weighted(0.02), weighted(0.4)]
}

fn mean_squared_correlation(likelihood: &Likelihood<'_>, k: usize) -> f64 {
    let x = likelihood.points.row(k);
    let n = x.ncols() as f64;
    let mean = x.iter().sum::<f64>() / n;
    let var = x.iter().map(|x| (x - mean).powi(2)).sum::<f64>().max(f64::MIN_POSITIVE);
    let squared = |y: faer::ColRef<'_, f64>| {
        let cov: f64 = x.iter().zip(y.iter()).map(|(x, y)| (x - mean) * y).sum();
        cov * cov / (var * n)
    };
    likelihood.values.col_iter().map(squared).sum::<f64>() / likelihood.values.ncols() as f64
}

/// What one descent came to.
struct Outcome {
    /// Best free parameters met and f there.
    best: Option<(Vec<f64>, f64)>,
    evaluations: usize,
}

fn descend(likelihood: &Likelihood<'_>, start: Vec<f64>, iterations: u64) -> Outcome {
    let memo = RefCell::new(Memo::default());
    let problem = Problem { likelihood, memo: &memo };
    let search = MoreThuenteLineSearch::new();
    // An error of the line search (a step into an indefinite matrix) ends the descent; the best point met counts.
    let run = LBFGS::new(search, MEMORY)
        .with_tolerance_grad(1e-5)
        .and_then(|solver| solver.with_tolerance_cost(VALUE_TOLERANCE))
        .and_then(|solver| {
            Executor::new(problem, solver).configure(|state| state.param(start).max_iters(iterations)).run()
        });
    if let Err(error) = run {
        tracing::debug!(%error, "a descent of the likelihood ended early");
    }
    let memo = memo.into_inner();
    Outcome { best: memo.best, evaluations: memo.evaluations }
}

/// Last point and best point met: the optimiser asks for value and gradient separately.
#[derive(Default)]
struct Memo {
    last: Option<(Vec<f64>, LikelihoodValue)>,
    best: Option<(Vec<f64>, f64)>,
    evaluations: usize,
}

struct Problem<'a> {
    likelihood: &'a Likelihood<'a>,
    memo: &'a RefCell<Memo>,
}

impl Problem<'_> {
    fn at(&self, free: &[f64]) -> Result<LikelihoodValue, Error> {
        let mut memo = self.memo.borrow_mut();
        if let Some((point, value)) = &memo.last
            && point == free
        {
            return Ok(value.clone());
        }
        memo.evaluations += 1;
        let mut value = self
            .likelihood
            .evaluate(&from_free(free))
            .ok_or_else(|| Error::msg("correlation matrix without Cholesky factor"))?;
        value.gradient.iter_mut().zip(free).enumerate().for_each(|(k, (g, t))| {
            *g *= slope(k, free.len(), *t);
        });
        if memo.best.as_ref().is_none_or(|(_, best)| value.value < *best) {
            memo.best = Some((free.to_vec(), value.value));
        }
        memo.last = Some((free.to_vec(), value.clone()));
        Ok(value)
    }
}

impl CostFunction for Problem<'_> {
    type Param = Vec<f64>;
    type Output = f64;
    fn cost(&self, param: &Self::Param) -> Result<f64, Error> {
        Ok(self.at(param)?.value)
    }
}

impl Gradient for Problem<'_> {
    type Param = Vec<f64>;
    type Gradient = Vec<f64>;
    fn gradient(&self, param: &Self::Param) -> Result<Vec<f64>, Error> {
        Ok(self.at(param)?.gradient)
    }
}

/// Logarithmic bounds of parameter `k` of `count`, the last of which is the nugget.
fn log_bounds(k: usize, count: usize) -> (f64, f64) {
    let (low, high) = if k + 1 == count { NUGGET_BOUNDS } else { THETA_BOUNDS };
    (low.ln(), high.ln())
}

fn from_free(free: &[f64]) -> Correlation {
    let value = |k: usize| {
        let (low, high) = log_bounds(k, free.len());
        (low + (high - low) / (1.0 + (-free[k]).exp())).exp()
    };
    let d = free.len() - 1;
    Correlation { theta: (0..d).map(value).collect(), nugget: value(d) }
}

/// dp/dt of the bounded logarithm.
fn slope(k: usize, count: usize, t: f64) -> f64 {
    let (low, high) = log_bounds(k, count);
    let s = 1.0 / (1.0 + (-t).exp());
    (high - low) * s * (1.0 - s)
}

/// Inverse of [`from_free`]; at the bounds a little inside, so that the slope never vanishes altogether.
fn to_free(correlation: &Correlation) -> Vec<f64> {
    let count = correlation.theta.len() + 1;
    let all = correlation.theta.iter().chain(std::iter::once(&correlation.nugget));
    all.enumerate()
        .map(|(k, value)| {
            let (low, high) = log_bounds(k, count);
            let s = ((value.ln() - low) / (high - low)).clamp(0.02, 0.98);
            (s / (1.0 - s)).ln()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::Mat;

    /// Points of a fixed low-discrepancy sequence in [-2, 2].
    fn points(d: usize, n: usize) -> Mat<f64> {
        Mat::from_fn(d, n, |k, i| {
            let irrational = [0.754_877_666, 0.569_840_296, 0.819_172_513][k % 3];
            4.0 * ((i + 1) as f64 * irrational).fract() - 2.0
        })
    }

    #[test]
    fn finds_which_variable_matters_and_that_there_is_no_noise() {
        let x = points(3, 60);
        let y = Mat::from_fn(60, 1, |i, _| (1.5 * x[(0, i)]).sin() + 0.3 * x[(1, i)]);
        let fitted = fit_correlation(x.as_ref(), y.as_ref(), None, Effort::MultiStart);
        let theta = &fitted.correlation.theta;
        assert!(theta[0] > 10.0 * theta[1] && theta[1] > theta[2], "{theta:?}");
        assert!(theta[2] < 1e-4 && fitted.correlation.nugget < 1e-6, "{:?}", fitted.correlation);
    }

    #[test]
    fn estimates_the_share_of_noise() {
        use rand::SeedableRng;
        use rand_distr::Distribution;
        let n = 200;
        let x = points(2, n);
        let mut rng = rand_chacha::ChaCha12Rng::seed_from_u64(1);
        let noise: Vec<f64> =
            (0..n).map(|_| rand_distr::StandardNormal.sample(&mut rng)).map(|e: f64| 0.05 * e).collect();
        let y = Mat::from_fn(n, 1, |i, _| (1.5 * x[(0, i)]).sin() + 0.3 * x[(1, i)] + noise[i]);
        let fitted = fit_correlation(x.as_ref(), y.as_ref(), None, Effort::MultiStart);
        let model =
            crate::surrogate::Kriging::condition(x.as_ref(), y.as_ref(), &fitted.correlation).unwrap();
        // The noise's standard deviation from 200 points: known to about 6 %.
        let std = (model.sigma2()[0] * model.correlation().nugget).sqrt();
        assert!((std / 0.05 - 1.0).abs() < 0.2, "{std}");
    }

    #[test]
    fn optimum_is_stationary_and_reproducible() {
        let x = points(3, 50);
        let y = Mat::from_fn(50, 2, |i, o| (x[(0, i)] + 0.5 * o as f64).sin() + 0.2 * x[(1, i)] * x[(2, i)]);
        let fitted = fit_correlation(x.as_ref(), y.as_ref(), None, Effort::MultiStart);
        assert_eq!(fitted, fit_correlation(x.as_ref(), y.as_ref(), None, Effort::MultiStart));
        let again = fit_correlation(x.as_ref(), y.as_ref(), Some(&fitted.correlation), Effort::Warm);
        assert!(
            (fitted.value - again.value).abs() < 1e-2,
            "{} {} {:?} {:?}",
            fitted.value,
            again.value,
            fitted.correlation,
            again.correlation
        );
    }

    #[test]
    fn constant_values_give_the_longest_lengths() {
        let x = points(2, 10);
        let y = Mat::from_fn(10, 1, |_, _| 3.0);
        let fitted = fit_correlation(x.as_ref(), y.as_ref(), None, Effort::MultiStart);
        assert_eq!(fitted.correlation.theta, vec![THETA_BOUNDS.0; 2]);
    }
}
