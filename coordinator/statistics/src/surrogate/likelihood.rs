//! Concentrated likelihood of the correlation parameters, with its analytic gradient, and its descent by L-BFGS over the free numbers of
//! [`Bounds`].
//!
//! For each of the m outputs o with values y_o `(n,)`, C = R(theta) + nugget I + stated W (W the diagonal of
//! the points' weights, if the simulations state errors), F the basis of the trend, the residual r_o = y_o -
//! F beta_o with beta_o by generalised least squares, and sigma2_o = r_o' C^-1 r_o / n, the value is
//!
//!   f = (1/m) sum over o of ln sigma2_o + (1/n) ln det C,
//!
//! that is -2 ln L / n averaged over the outputs, without constants. With alpha_o = C^-1 r_o and G = C^-1 -
//! (1/m) sum over o of alpha_o alpha_o' / sigma2_o, the derivative with respect to any parameter p is
//!
//!   df/dp = (1/n) sum over i, j of G_ij dC_ij/dp.
//!
//! For ln theta_k it needs sum M_ij (x_ik - x_jk)^2 = 2 sum s_i x_ik^2 - 2 x_k' M x_k with M = G o dR/dr2
//! (entry by entry) and s its row sums, so no `(n, n, d)` array is formed.
//!
//! Valid for Gaussian responses; sigma2 and beta are eliminated at their maximum, not integrated out.
//!
//! # Source
//! Lophaven, Nielsen, Sondergaard (2002), DACE, a Matlab Kriging toolbox; the gradient: Rasmussen, Williams
//! (2006), Gaussian Processes for Machine Learning, section 5.4.1. L-BFGS: Liu, Nocedal (1989), On the limited memory BFGS method for
//! large scale optimization, Mathematical Programming 45. Line search: More, Thuente (1994), Line search algorithms with guaranteed
//! sufficient decrease, ACM Transactions on Mathematical Software 20(3).

use super::bounds::Bounds;
use super::correlation::correlation_and_slopes_into;
use super::factor::{
    factor_in_place, invert_factor, log_determinant, solve_lower, solve_lower_transposed, square_of_inverse,
};
use super::trend::Whitened;
use super::{Correlation, Trend};
use argmin::core::{CostFunction, Error, Executor, Gradient};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use faer::linalg::matmul::triangular::{BlockStructure, matmul as triangular_matmul};
use faer::{Accum, Mat, MatRef, Par};
use std::cell::RefCell;

/// Least sigma2 over the mean square of the values [1]: a trend that explains the values completely leaves
/// rounding only, which carries no information on lengths.
const ROUNDING: f64 = 1e-24;

/// The data of one likelihood.
#[derive(Debug, Clone, Copy)]
pub struct Likelihood<'a> {
    /// Points in standardised units `(d, n)` [1].
    pub points: MatRef<'a, f64>,
    /// Values `(n, m)`, each column with positive variance.
    pub values: MatRef<'a, f64>,
    /// The trend; constant if the points cannot carry it.
    pub trend: Trend,
    /// Weights of the points' noise `(n,)`, of mean 1 [1]; `None` without stated errors.
    pub weights: Option<&'a [f64]>,
}

/// The value f, to be minimised [1], and its derivatives with respect to ln theta_1 .. ln theta_d, ln nugget and, with weights,
/// ln stated, `(d + 1,)` or `(d + 2,)` [1].
type ValueAndGradient = (f64, Vec<f64>);

/// Three matrices `(n, n)`, of which the lower triangles are used. Their memory is kept between evaluations:
/// allocation took a third of the time at n = 937.
#[derive(Debug)]
struct Workspace {
    /// C, then L, then G and M.
    c: Mat<f64>,
    /// Slopes -dR/dr2 of the correlations.
    slopes: Mat<f64>,
    /// Inverse factor L^-1.
    l_inverse: Mat<f64>,
}

impl Workspace {
    pub fn new(n: usize) -> Self {
        Self { c: Mat::zeros(n, n), slopes: Mat::zeros(n, n), l_inverse: Mat::zeros(n, n) }
    }
}

impl Likelihood<'_> {
    /// f and its gradient; `None` if C has no Cholesky factor or a value is not finite.
    pub fn evaluate(&self, correlation: &Correlation) -> Option<ValueAndGradient> {
        self.evaluate_in(&mut Workspace::new(self.points.ncols()), correlation)
    }

    /// f and its gradient as in [`Likelihood::evaluate`], in memory that is used again.
    fn evaluate_in(&self, work: &mut Workspace, correlation: &Correlation) -> Option<ValueAndGradient> {
        let (d, n, m) = (self.points.nrows(), self.points.ncols(), self.values.ncols());
        let Workspace { c: l, slopes, l_inverse } = work;
        correlation_and_slopes_into(correlation, self.points, l.as_mut(), slopes.as_mut());
        correlation.add_noise(l.as_mut(), self.weights);
        factor_in_place(l.as_mut()).ok()?;

        // Trend, residual and variance of each output.
        let trend = Whitened::new(self.trend.carried_by(d, n), self.points, l.as_ref());
        let mut alpha = self.values.to_owned();
        solve_lower(l.as_ref(), alpha.as_mut());
        let mut log_variances = 0.0;
        let mut variances = Vec::with_capacity(m);
        for o in 0..m {
            let column = alpha.col_as_slice_mut(o);
            trend.take_from(column);
            let left = column.iter().map(|y| y * y).sum::<f64>() / n as f64;
            let sigma2 = left.max(ROUNDING * self.values.col(o).squared_norm_l2() / n as f64);
            log_variances += sigma2.ln();
            variances.push(sigma2);
        }
        let value = log_variances / m as f64 + log_determinant(l.as_ref()) / n as f64;

        // G and M = G o -dR/dr2, the lower triangles: both are symmetric.
        solve_lower_transposed(l.as_ref(), alpha.as_mut());
        let scaled = Mat::from_fn(n, m, |i, o| alpha[(i, o)] / (variances[o] * m as f64).sqrt());
        invert_factor(l.as_ref(), l_inverse.as_mut());
        let g = l;
        square_of_inverse(l_inverse.as_ref(), g.as_mut());
        triangular_matmul(
            g.as_mut(),
            BlockStructure::TriangularLower,
            Accum::Add,
            scaled.as_ref(),
            BlockStructure::Rectangular,
            scaled.transpose(),
            BlockStructure::Rectangular,
            -1.0,
            Par::Seq,
        );
        let trace: f64 = (0..n).map(|i| g[(i, i)]).sum();
        let weighted_trace =
            self.weights.map(|weights| weights.iter().enumerate().map(|(i, w)| w * g[(i, i)]).sum::<f64>());
        for j in 0..n {
            let pairs = g.col_as_slice_mut(j)[j..].iter_mut().zip(&slopes.col_as_slice(j)[j..]);
            pairs.for_each(|(g, slope)| *g *= slope);
        }
        let mut gradient = self.moments(g.as_ref());
        gradient.iter_mut().zip(&correlation.theta).for_each(|(g, theta)| *g *= -2.0 * theta / n as f64);
        gradient.push(correlation.nugget * trace / n as f64);
        gradient.extend(weighted_trace.map(|trace| correlation.stated * trace / n as f64));
        (value.is_finite() && gradient.iter().all(|g| g.is_finite())).then_some((value, gradient))
    }

    /// sum_i s_i x_ik^2 - x_k' M x_k for every variable `(d,)`, from the lower triangle of M, whose diagonal
    /// is zero.
    fn moments(&self, below: MatRef<'_, f64>) -> Vec<f64> {
        let (d, n) = self.points.shape();
        // M times the points and times ones.
        let with_ones = Mat::from_fn(n, d + 1, |i, k| if k < d { self.points[(k, i)] } else { 1.0 });
        let mut product = Mat::zeros(n, d + 1);
        for (half, structure) in
            [(below, BlockStructure::TriangularLower), (below.transpose(), BlockStructure::TriangularUpper)]
        {
            triangular_matmul(
                product.as_mut(),
                BlockStructure::Rectangular,
                Accum::Add,
                half,
                structure,
                with_ones.as_ref(),
                BlockStructure::Rectangular,
                1.0,
                Par::Seq,
            );
        }
        let row_sums = product.col_as_slice(d);
        let moment = |k: usize| {
            let (x, mx) = (with_ones.col_as_slice(k), product.col_as_slice(k));
            (0..n).map(|i| x[i] * (row_sums[i] * x[i] - mx[i])).sum()
        };
        (0..d).map(moment).collect()
    }
}

/// Change of f per iteration below which the optimum counts as found; 1e-6 n in 2 ln L is far inside its
/// confidence region.
const VALUE_TOLERANCE: f64 = 1e-6;
/// Number of corrections that L-BFGS stores: about one per parameter of 30 variables; with 8 the lengths
/// without influence decrease slowly.
const MEMORY: usize = 30;

/// Result of one descent, and its last point: the optimiser requests value and gradient separately.
#[derive(Default)]
pub(super) struct DescentResult {
    last: Option<(Vec<f64>, ValueAndGradient)>,
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
    fn evaluate(&self, free: &[f64]) -> Result<ValueAndGradient, Error> {
        let mut memo = self.memo.borrow_mut();
        if let Some((point, value)) = &memo.last
            && point == free
        {
            return Ok(value.clone());
        }
        memo.evaluations += 1;
        let value = self.likelihood.evaluate_in(&mut self.work.borrow_mut(), &self.bounds.correlation(free));
        let found = value.ok_or_else(|| Error::msg("correlation matrix without Cholesky factor"));
        let (value, mut gradient) = found?;
        gradient.iter_mut().zip(free).enumerate().for_each(|(k, (g, t))| {
            *g *= self.bounds.slope(k, *t);
        });
        if memo.best.as_ref().is_none_or(|(_, best)| value < *best) {
            memo.best = Some((free.to_vec(), value));
        }
        memo.last = Some((free.to_vec(), (value, gradient.clone())));
        Ok((value, gradient))
    }
}

impl CostFunction for LikelihoodProblem<'_> {
    type Param = Vec<f64>;
    type Output = f64;
    fn cost(&self, param: &Self::Param) -> Result<f64, Error> {
        Ok(self.evaluate(param)?.0)
    }
}

impl Gradient for LikelihoodProblem<'_> {
    type Param = Vec<f64>;
    type Gradient = Vec<f64>;
    fn gradient(&self, param: &Self::Param) -> Result<Vec<f64>, Error> {
        Ok(self.evaluate(param)?.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surrogate::Kernel;

    #[test]
    fn gradient_matches_finite_differences() {
        let (d, n, m) = (4, 30, 3);
        let points = Mat::from_fn(d, n, |k, i| ((i * (2 * k + 3)) as f64 * 0.77 + k as f64).sin() * 1.7);
        let values = Mat::from_fn(n, m, |i, o| {
            points[(0, i)] * (1.0 + o as f64)
                + (points[(1, i)] * 1.3).sin()
                + 0.1 * points[(2, i)] * points[(3, i)]
        });
        let weights: Vec<f64> = (0..n).map(|i| 0.2 + 1.6 * (i % 2) as f64).collect();
        let (points, values) = (points.as_ref(), values.as_ref());
        for kernel in Kernel::ALL {
            for (trend, weights) in [
                (Trend::Constant, None),
                (Trend::Constant, Some(weights.as_slice())),
                (Trend::Linear, None),
                (Trend::Linear, Some(weights.as_slice())),
            ] {
                compare_with_differences(&Likelihood { points, values, trend, weights }, kernel);
            }
        }
    }

    fn compare_with_differences(likelihood: &Likelihood<'_>, kernel: Kernel) {
        let d = likelihood.points.nrows();
        let evaluate = |p: &[f64]| {
            let theta = p[..d].iter().map(|p| p.exp()).collect();
            let correlation = Correlation { kernel, theta, nugget: p[d].exp(), stated: p[d + 1].exp() };
            likelihood.evaluate(&correlation).unwrap()
        };
        let p = [-1.0, -0.5, -2.0, -3.0, -6.0, -4.0];
        let analytic = evaluate(&p).1;
        assert_eq!(analytic.len(), d + 1 + usize::from(likelihood.weights.is_some()));
        for (k, analytic) in analytic.into_iter().enumerate() {
            let h = 1e-5;
            let (mut up, mut down) = (p, p);
            up[k] += h;
            down[k] -= h;
            let numeric = (evaluate(&up).0 - evaluate(&down).0) / (2.0 * h);
            let case = (kernel, likelihood.trend, k);
            assert!(
                (numeric - analytic).abs() < 1e-6 * (1.0 + numeric.abs()),
                "{case:?}: {numeric} {analytic}"
            );
            assert!(analytic.abs() > 1e-5, "{case:?}: {analytic} is too small for this test");
        }
    }
}
