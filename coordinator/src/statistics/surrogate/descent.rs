//! One descent of the likelihood by L-BFGS over bounded logarithms.

use super::bounds::Bounds;
use super::likelihood::Workspace;
use super::{Likelihood, LikelihoodValue};
use argmin::core::{CostFunction, Error, Executor, Gradient};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use std::cell::RefCell;

/// Change of f per iteration below which the optimum counts as found; 1e-6 n is 2 ln L, far inside its confidence.
const VALUE_TOLERANCE: f64 = 1e-6;
/// Stored corrections of L-BFGS: about one for each parameter of 30 variables, with whose lengths of no influence 8
/// go down slowly.
const MEMORY: usize = 30;

/// What one descent came to.
pub(super) struct Outcome {
    /// Best free parameters met and f there.
    pub best: Option<(Vec<f64>, f64)>,
    pub evaluations: usize,
}

/// Goes down from `start` for at most so many iterations.
pub(super) fn descend(
    likelihood: &Likelihood<'_>,
    bounds: Bounds,
    start: Vec<f64>,
    iterations: u64,
) -> Outcome {
    let memo = RefCell::new(Memo::default());
    let work = RefCell::new(Workspace::new(likelihood.points.ncols()));
    let problem = Problem { likelihood, bounds, memo: &memo, work: &work };
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
    work: &'a RefCell<Workspace>,
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
            .evaluate_in(&mut self.work.borrow_mut(), &self.bounds.correlation(free))
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
