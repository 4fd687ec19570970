//! Weighted least squares within bounds, by the method of Levenberg and Marquardt.
//!
//! Minimises `S(u) = 1/2 sum_i w_i r_i(u)^2` over places `u_k` in (0, 1) between the bounds of the parameters [1]; `r_i`: residual
//! in units of its tolerance [1], `w_i`: weight [1]. The search is over `t_k = ln(u_k / (1 - u_k))`, which has no bounds. Each step
//! `d` solves
//!
//! `(J' W J + lambda D) d = -J' W r`
//!
//! with the Jacobian `J = dr/dt`, `W = diag(w)`, `D` the diagonal of `J' W J`, and a damping `lambda` that is decreased after a step
//! which reduces `S` and increased after one which does not. A start on a bound is moved inside; a minimum on a bound is
//! approached asymptotically. The minimum found is the best of several starts, not necessarily the global one.
//!
//! # Source
//! Levenberg (1944), A method for the solution of certain non-linear problems in least squares, Quarterly of Applied
//! Mathematics 2; Marquardt (1963), An algorithm for least-squares estimation of nonlinear parameters, Journal of the Society
//! for Industrial and Applied Mathematics 11. Covariance: Tarantola (2005), Inverse problem theory, linear problem with
//! Gaussian prior.

use faer::Mat;
use faer::prelude::*;

/// Half the width of the central differences of the Jacobian, as a share of the distance between the bounds.
const DIFFERENCE: f64 = 0.01;
/// Largest number of steps from one start.
const STEPS: usize = 60;
/// Change of S below which a descent ends: a hundredth of the change that one standard uncertainty makes.
const TOLERANCE: f64 = 5e-3;
/// Smallest distance of a start from a bound, as a share of the distance between the bounds.
const INSIDE: f64 = 0.02;
/// Damping of the first step [1], its factor between steps, and the damping at which a descent ends.
const FIRST_DAMPING: f64 = 1e-3;
const DAMPING_FACTOR: f64 = 10.0;
const LARGEST_DAMPING: f64 = 1e10;
/// Smallest diagonal element of the damping matrix relative to the largest one.
const SMALLEST_DIAGONAL: f64 = 1e-12;

/// A problem of weighted least squares.
pub(super) struct LeastSquares<R> {
    /// Residuals `(m,)` at places `(p,)` in [0, 1], each in units of its tolerance.
    pub residuals: R,
    /// Weights of the squared residuals `(m,)` [1].
    pub weights: Vec<f64>,
}

/// A minimum and its uncertainty.
pub(super) struct Fit {
    /// Places between the bounds `(p,)` [1].
    pub best: Vec<f64>,
    /// Covariance of the places `(p, p)` [1].
    covariance: Mat<f64>,
}

impl Fit {
    /// Standard uncertainty of a place [1].
    pub fn uncertainty(&self, k: usize) -> f64 {
        self.covariance[(k, k)].sqrt()
    }

    /// Correlation of the uncertainties of two places [1].
    pub fn correlation(&self, i: usize, j: usize) -> f64 {
        self.covariance[(i, j)] / (self.covariance[(i, i)] * self.covariance[(j, j)]).sqrt()
    }
}

/// A point of a descent.
struct Point {
    /// Free numbers t `(p,)` [1].
    free: Vec<f64>,
    /// Their places between the bounds `(p,)` [1].
    places: Vec<f64>,
    /// Residuals times the square roots of their weights `(m,)`.
    residuals: Vec<f64>,
    /// Half the sum of their squares.
    value: f64,
}

impl<R: Fn(&[f64]) -> Vec<f64>> LeastSquares<R> {
    /// The best minimum from these starts `(starts)(p,)`, and its uncertainty.
    pub fn fit(&self, starts: &[Vec<f64>]) -> Fit {
        let best = self.minimise(starts);
        Fit { covariance: covariance(&self.jacobian(&best)), best }
    }

    /// The places `(p,)` of the best minimum from these starts `(starts)(p,)`.
    pub fn minimise(&self, starts: &[Vec<f64>]) -> Vec<f64> {
        let minima = starts.iter().map(|start| self.descend(start));
        minima.min_by(|a, b| a.value.total_cmp(&b.value)).map(|best| best.places).unwrap_or_default()
    }

    fn descend(&self, start: &[f64]) -> Point {
        let inside = start.iter().map(|place| place.clamp(INSIDE, 1.0 - INSIDE));
        let mut point = self.point(inside.map(|place| (place / (1.0 - place)).ln()).collect());
        let mut damping = FIRST_DAMPING;
        for _ in 0..STEPS {
            let Some(next) = self.step(&point, &mut damping) else { break };
            let decrease = point.value - next.value;
            point = next;
            // A small decrease under strong damping is no sign of a minimum.
            if decrease < TOLERANCE && damping < 1.0 {
                break;
            }
        }
        point
    }

    /// The next point of a descent, or `None` if no damping gives a smaller value.
    fn step(&self, point: &Point, damping: &mut f64) -> Option<Point> {
        let places = &point.places;
        // Of the weighted residuals with respect to the free numbers; du/dt = u (1 - u).
        let jacobian = self.jacobian(places);
        let jacobian = Mat::from_fn(jacobian.nrows(), jacobian.ncols(), |i, k| {
            self.weights[i].sqrt() * jacobian[(i, k)] * (places[k] * (1.0 - places[k]))
        });
        let residuals = Mat::from_fn(point.residuals.len(), 1, |i, _| point.residuals[i]);
        let normal = jacobian.transpose() * &jacobian;
        let gradient = jacobian.transpose() * residuals;
        let p = point.free.len();
        let largest = (0..p).map(|k| normal[(k, k)]).fold(f64::MIN_POSITIVE, f64::max);
        while *damping < LARGEST_DAMPING {
            let diagonal = |k: usize| *damping * normal[(k, k)].max(SMALLEST_DIAGONAL * largest);
            let damped = Mat::from_fn(p, p, |i, j| normal[(i, j)] + if i == j { diagonal(i) } else { 0.0 });
            if let Ok(factor) = damped.llt(faer::Side::Lower) {
                let step = factor.solve(&gradient);
                let next = self.point((0..p).map(|k| point.free[k] - step[(k, 0)]).collect());
                if next.value < point.value {
                    *damping /= DAMPING_FACTOR;
                    return Some(next);
                }
            }
            *damping *= DAMPING_FACTOR;
        }
        None
    }

    fn point(&self, free: Vec<f64>) -> Point {
        let places: Vec<f64> = free.iter().map(|t| 1.0 / (1.0 + (-t).exp())).collect();
        let residuals = (self.residuals)(&places);
        let residuals: Vec<f64> = residuals.iter().zip(&self.weights).map(|(r, w)| w.sqrt() * r).collect();
        let value = 0.5 * residuals.iter().map(|r| r * r).sum::<f64>();
        Point { free, places, residuals, value }
    }

    /// Jacobian `(m, p)` of the residuals with respect to the places, by central differences within the bounds.
    fn jacobian(&self, places: &[f64]) -> Mat<f64> {
        let column = |k: usize| {
            let ends = [(places[k] - DIFFERENCE).max(0.0), (places[k] + DIFFERENCE).min(1.0)];
            let [a, b] = ends.map(|end| {
                let mut moved = places.to_vec();
                moved[k] = end;
                (self.residuals)(&moved)
            });
            a.iter().zip(b).map(|(a, b)| (b - a) / (ends[1] - ends[0])).collect::<Vec<f64>>()
        };
        let columns: Vec<Vec<f64>> = (0..places.len()).map(column).collect();
        Mat::from_fn(columns.first().map_or(0, Vec::len), places.len(), |i, k| columns[k][i])
    }
}

/// Covariance `(p, p)` of the places by linear error propagation, `(J' J + I / s^2)^-1` with `s = 1 / sqrt(12)`: the standard
/// deviation of a uniform distribution between the bounds, taken as prior, which keeps the uncertainty of undetermined
/// parameters finite.
fn covariance(jacobian: &Mat<f64>) -> Mat<f64> {
    let p = jacobian.ncols();
    let prior = Mat::from_fn(p, p, |i, j| if i == j { 12.0 } else { 0.0 });
    let information = jacobian.transpose() * jacobian + prior;
    match information.llt(faer::Side::Lower) {
        Ok(factor) => factor.solve(Mat::<f64>::identity(p, p)),
        Err(_) => Mat::from_fn(p, p, |i, j| if i == j { 1.0 / 12.0 } else { 0.0 }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    /// Rosenbrock's function as two residuals, its minimum (1, 1) at the places (0.75, 0.75) of bounds from -2 to 2.
    ///
    /// # Source
    /// Rosenbrock (1960), An automatic method for finding the greatest or least value of a function.
    #[test]
    fn the_minimum_of_rosenbrocks_function_takes_few_residuals() {
        let calls = Cell::new(0);
        let residuals = |places: &[f64]| {
            calls.set(calls.get() + 1);
            let [x, y] = [0, 1].map(|k| 4.0 * places[k] - 2.0);
            vec![100.0 * (y - x * x), 10.0 * (1.0 - x)]
        };
        let problem = LeastSquares { residuals, weights: vec![1.0; 2] };
        let fit = problem.fit(&[vec![0.2, 0.8]]);
        assert!(fit.best.iter().all(|place| (place - 0.75).abs() < 3e-3), "{:?}", fit.best);
        assert!(calls.get() < 150, "{} evaluations of the residuals", calls.get());
        assert!(fit.uncertainty(0) < 0.03 && fit.correlation(0, 1) > 0.9);
    }

    #[test]
    fn a_minimum_beyond_a_bound_is_found_on_it() {
        let residuals = |places: &[f64]| vec![3.0 * (places[0] - 2.0)];
        let problem = LeastSquares { residuals, weights: vec![1.0] };
        let fit = problem.fit(&[vec![0.5, 0.5]]);
        assert!(fit.best[0] > 0.99, "{:?}", fit.best);
        // The second parameter has no effect: its uncertainty is that of the bounds.
        assert!((fit.best[1] - 0.5).abs() < 1e-9 && (fit.uncertainty(1) - 12f64.sqrt().recip()).abs() < 1e-9);
    }
}
