//! Weighted least squares within bounds, by L-BFGS on the logit of each parameter's place between its bounds.

use argmin::core::{CostFunction, Error, Executor, Gradient, IterState};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use faer::Mat;
use faer::prelude::*;

/// Step of the differences, in units of the free number.
const STEP: f64 = 1e-3;
const ITERATIONS: u64 = 60;
/// Change of half the sum of squares, and its slope in the free numbers, below which a descent ends: a hundredth of the change that
/// one standard uncertainty makes.
const TOLERANCE: f64 = 5e-3;
/// Nearest that a start comes to a bound, as a share of the distance between the bounds.
const INSIDE: f64 = 0.02;

/// Residuals `(m,)` of parameters `(p,)` in [0, 1], each in units of its tolerance.
pub(super) struct Problem<R> {
    pub residuals: R,
    /// Weights of the squared residuals `(m,)`.
    pub weights: Vec<f64>,
}

impl<R: Fn(&[f64]) -> Vec<f64> + Sync> Problem<R> {
    /// Half the weighted sum of squares.
    pub fn value(&self, places: &[f64]) -> f64 {
        let residuals = (self.residuals)(places);
        0.5 * residuals.iter().zip(&self.weights).map(|(r, w)| w * r * r).sum::<f64>()
    }

    /// The best places `(p,)` from these starts.
    pub fn minimise(&self, starts: &[Vec<f64>]) -> Vec<f64> {
        let descend = |start: &Vec<f64>| {
            let free: Vec<f64> = start.iter().map(|place| logit(place.clamp(INSIDE, 1.0 - INSIDE))).collect();
            let run = LBFGS::new(MoreThuenteLineSearch::new(), free.len().max(2))
                .with_tolerance_grad(TOLERANCE)
                .and_then(|solver| solver.with_tolerance_cost(TOLERANCE))
                .and_then(|solver| {
                    let configure = |state: IterState<_, _, _, _, _, f64>| {
                        state.param(free.clone()).max_iters(ITERATIONS)
                    };
                    Executor::new(Free(self), solver).configure(configure).run()
                });
            // A line search that fails ends a descent; what it started from still counts.
            let best = run.ok().and_then(|run| run.state.best_param).unwrap_or(free);
            best.iter().map(|t| place(*t)).collect::<Vec<f64>>()
        };
        let found = starts.iter().map(descend);
        let valued = found.map(|places| (self.value(&places), places));
        valued.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, places)| places).unwrap_or_default()
    }

    /// Jacobian `(m, p)` of the residuals, by central differences in the places.
    pub fn jacobian(&self, places: &[f64]) -> Mat<f64> {
        let column = |k: usize| {
            let (mut low, mut high) = (places.to_vec(), places.to_vec());
            low[k] = (places[k] - 0.01).max(0.0);
            high[k] = (places[k] + 0.01).min(1.0);
            let (a, b) = ((self.residuals)(&low), (self.residuals)(&high));
            let width = high[k] - low[k];
            a.iter().zip(b).map(|(a, b)| (b - a) / width).collect::<Vec<f64>>()
        };
        let columns: Vec<Vec<f64>> = (0..places.len()).map(column).collect();
        Mat::from_fn(columns.first().map_or(0, Vec::len), places.len(), |i, k| columns[k][i])
    }
}

/// Covariance `(p, p)` of the places by linear error propagation, (J' J + I / s^2)^-1: with the bounds as prior knowledge,
/// s = 1 / sqrt(12) being the standard deviation of a uniform law, so that what the targets leave open stays finite.
pub(super) fn covariance(jacobian: &Mat<f64>) -> Mat<f64> {
    let p = jacobian.ncols();
    let prior = Mat::from_fn(p, p, |i, j| if i == j { 12.0 } else { 0.0 });
    let information = jacobian.transpose() * jacobian + prior;
    match information.llt(faer::Side::Lower) {
        Ok(factor) => factor.solve(Mat::<f64>::identity(p, p)),
        Err(_) => Mat::from_fn(p, p, |i, j| if i == j { 1.0 / 12.0 } else { 0.0 }),
    }
}

fn logit(place: f64) -> f64 {
    (place / (1.0 - place)).ln()
}

fn place(t: f64) -> f64 {
    1.0 / (1.0 + (-t).exp())
}

/// The problem over free numbers.
struct Free<'a, R>(&'a Problem<R>);

impl<R: Fn(&[f64]) -> Vec<f64> + Sync> CostFunction for Free<'_, R> {
    type Param = Vec<f64>;
    type Output = f64;
    fn cost(&self, free: &Self::Param) -> Result<f64, Error> {
        Ok(self.0.value(&free.iter().map(|t| place(*t)).collect::<Vec<f64>>()))
    }
}

impl<R: Fn(&[f64]) -> Vec<f64> + Sync> Gradient for Free<'_, R> {
    type Param = Vec<f64>;
    type Gradient = Vec<f64>;
    fn gradient(&self, free: &Self::Param) -> Result<Vec<f64>, Error> {
        let moved = |k: usize, by: f64| {
            let mut moved = free.clone();
            moved[k] += by;
            self.cost(&moved)
        };
        (0..free.len()).map(|k| Ok((moved(k, STEP)? - moved(k, -STEP)?) / (2.0 * STEP))).collect()
    }
}
