//! One descent of the likelihood by L-BFGS over the free numbers of [`Bounds`].
//!
//! # Source
//! L-BFGS: Liu, Nocedal (1989), On the limited memory BFGS method for large scale optimization, Mathematical
//! Programming
//! 45. Line search: More, Thuente (1994), Line search algorithms with guaranteed sufficient decrease, ACM
//!     Transactions on Mathematical Software 20(3).

use super::bounds::Bounds;
use super::likelihood::Workspace;
use super::{Likelihood, LikelihoodValue};
use argmin::core::{CostFunction, Error, Executor, Gradient};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use std::cell::RefCell;

/// Change of f per iteration below which the optimum counts as found; 1e-6 n in 2 ln L is far inside its
/// confidence region.
const VALUE_TOLERANCE: f64 = 1e-6;
/// Number of corrections that L-BFGS stores: about one per parameter of 30 variables; with 8 the lengths
/// without influence decrease slowly.
const MEMORY: usize = 30;

/// Result of one descent, and its last point: the optimiser requests value and gradient separately.
#[derive(Default)]
pub(super) struct DescentResult {
    last: Option<(Vec<f64>, LikelihoodValue)>,
    /// Best free parameters `(d + 1,)` or `(d + 2,)` and their f; `None` if f could not be evaluated
    /// anywhere.
    pub best: Option<(Vec<f64>, f64)>,
    /// Number of evaluations of the likelihood.
    pub evaluations: usize,
}

/// Descends from the free parameters `start` for at most `iterations` iterations.
pub(super) fn descend(
    likelihood: &Likelihood<'_>,
    bounds: Bounds,
    start: Vec<f64>,
    iterations: u64,
) -> DescentResult {
    let memo = RefCell::new(DescentResult::default());
    let work = RefCell::new(Workspace::new(likelihood.points.ncols()));
    let problem = LikelihoodProblem { likelihood, bounds, memo: &memo, work: &work };
    let search = MoreThuenteLineSearch::new();
    // An error of the line search (a step to an indefinite matrix) ends the descent; the best point evaluated
    // counts.
    let run = LBFGS::new(search, MEMORY)
        .with_tolerance_grad(1e-5)
        .and_then(|solver| solver.with_tolerance_cost(VALUE_TOLERANCE))
        .and_then(|solver| {
            Executor::new(problem, solver).configure(|state| state.param(start).max_iters(iterations)).run()
        });
    if let Err(error) = run {
        tracing::debug!(%error, "a descent of the likelihood ended early");
    }
    memo.into_inner()
}

/// The likelihood over free parameters, as `argmin` takes it.
struct LikelihoodProblem<'a> {
    likelihood: &'a Likelihood<'a>,
    bounds: Bounds,
    memo: &'a RefCell<DescentResult>,
    work: &'a RefCell<Workspace>,
}

impl LikelihoodProblem<'_> {
    fn evaluate(&self, free: &[f64]) -> Result<LikelihoodValue, Error> {
        let mut memo = self.memo.borrow_mut();
        if let Some((point, value)) = &memo.last
            && point == free
        {
            return Ok(value.clone());
        }
        memo.evaluations += 1;
        let value = self.likelihood.evaluate_in(&mut self.work.borrow_mut(), &self.bounds.correlation(free));
        let mut value = value.ok_or_else(|| Error::msg("correlation matrix without Cholesky factor"))?;
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

impl CostFunction for LikelihoodProblem<'_> {
    type Param = Vec<f64>;
    type Output = f64;
    fn cost(&self, param: &Self::Param) -> Result<f64, Error> {
        Ok(self.evaluate(param)?.value)
    }
}

impl Gradient for LikelihoodProblem<'_> {
    type Param = Vec<f64>;
    type Gradient = Vec<f64>;
    fn gradient(&self, param: &Self::Param) -> Result<Vec<f64>, Error> {
        Ok(self.evaluate(param)?.gradient)
    }
}
