//! Maximum likelihood of the correlation parameters by L-BFGS over bounded logarithms.

use super::bounds::{Bounds, NUGGET, THETA};
use super::{Correlation, Likelihood, LikelihoodValue, NoiseShape};
use argmin::core::{CostFunction, Error, Executor, Gradient};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use faer::MatRef;
use rayon::prelude::*;
use std::cell::RefCell;

/// Change of f per iteration below which the optimum counts as found; 1e-6 n is 2 ln L, far inside its confidence.
const VALUE_TOLERANCE: f64 = 1e-6;
/// Level of the stated noise at the starts.
const STATED_START: f64 = 1e-4;
/// Stored corrections of L-BFGS.
const MEMORY: usize = 8;

/// How much to spend on a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// None: the previous parameters stay.
    Keep,
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
/// are the longest allowed. `noise` is what the stated errors say of the points, if anything. The result depends on
/// the data and `previous` only.
pub fn fit_correlation(
    points: MatRef<'_, f64>,
    values: MatRef<'_, f64>,
    noise: Option<&NoiseShape>,
    previous: Option<&Correlation>,
    effort: Effort,
) -> Fitted {
    let d = points.nrows();
    let values = standardise(values);
    if values.ncols() == 0 {
        let correlation = Correlation { theta: vec![THETA.0; d], nugget: NUGGET.0, stated: 0.0 };
        return Fitted { correlation, value: f64::NEG_INFINITY, evaluations: 0, failed_starts: 0 };
    }
    let weights = noise.map(|noise| noise.weights.as_slice());
    let likelihood = Likelihood { points, values: values.as_ref(), weights };
    let bounds = Bounds::new(d, noise);
    let to_free = |correlation: &Correlation| bounds.free(correlation);
    let mut starts: Vec<Vec<f64>> = previous.map(to_free).into_iter().collect();
    if starts.is_empty() || effort == Effort::MultiStart {
        starts.extend(fixed_starts(&likelihood).iter().map(to_free));
    }
    // A first round of all starts side by side, each far enough to tell them apart; then the best to its end.
    let budget = if starts.len() > 1 { 25 } else { 60 };
    let outcomes: Vec<Outcome> =
        starts.into_par_iter().map(|start| descend(&likelihood, bounds, start, budget)).collect();
    let mut evaluations = outcomes.iter().map(|o| o.evaluations).sum();
    let failed_starts = outcomes.iter().filter(|o| o.best.is_none()).count();
    let alone = outcomes.len() == 1;
    let best = outcomes.into_iter().filter_map(|o| o.best).reduce(|a, b| if b.1 < a.1 { b } else { a });
    let Some((mut free, mut value)) = best else {
        let correlation = Correlation { theta: vec![0.1 / d as f64; d], nugget: 1e-4, stated: 0.0 };
        return Fitted { correlation, value: f64::INFINITY, evaluations, failed_starts };
    };
    if !alone {
        let polished = descend(&likelihood, bounds, free.clone(), 60);
        evaluations += polished.evaluations;
        if let Some((better, lower)) = polished.best.filter(|b| b.1 < value) {
            (free, value) = (better, lower);
        }
    }
    Fitted { correlation: bounds.correlation(&free), value, evaluations, failed_starts }
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
    let isotropic =
        |sum: f64| Correlation { theta: vec![sum / d as f64; d], nugget: 1e-4, stated: STATED_START };
    let influence: Vec<f64> = (0..d).map(|k| mean_squared_correlation(likelihood, k)).collect();
    let total: f64 = influence.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let weighted = |sum: f64| Correlation {
        theta: influence.iter().map(|w| sum * (0.02 / d as f64 + 0.98 * w / total)).collect(),
        nugget: 1e-4,
        stated: STATED_START,
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

fn descend(likelihood: &Likelihood<'_>, bounds: Bounds, start: Vec<f64>, iterations: u64) -> Outcome {
    let memo = RefCell::new(Memo::default());
    let problem = Problem { likelihood, bounds, memo: &memo };
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
    bounds: Bounds,
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
            .evaluate(&self.bounds.correlation(free))
            .ok_or_else(|| Error::msg("correlation matrix without Cholesky factor"))?;
        value.gradient.iter_mut().zip(free).enumerate().for_each(|(k, (g, t))| {
            *g *= self.bounds.slope(k, *t);
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
        let fitted = fit_correlation(x.as_ref(), y.as_ref(), None, None, Effort::MultiStart);
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
        let fitted = fit_correlation(x.as_ref(), y.as_ref(), None, None, Effort::MultiStart);
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
        let fitted = fit_correlation(x.as_ref(), y.as_ref(), None, None, Effort::MultiStart);
        assert_eq!(fitted, fit_correlation(x.as_ref(), y.as_ref(), None, None, Effort::MultiStart));
        let again = fit_correlation(x.as_ref(), y.as_ref(), None, Some(&fitted.correlation), Effort::Warm);
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
        let fitted = fit_correlation(x.as_ref(), y.as_ref(), None, None, Effort::MultiStart);
        assert_eq!(fitted.correlation.theta, vec![THETA.0; 2]);
    }
}
