//! Minimum of a smooth function under smooth inequalities and bounds, with the multipliers of the constraints.
//!
//!   minimise f(x) subject to c_i(x) >= 0, lower <= x <= upper
//!
//! by sequential quadratic programming (SLSQP). At the minimum, over the variables that are at no bound,
//!
//!   grad f = sum over the active i of lambda_i grad c_i,   lambda_i >= 0,
//!
//! from which the multipliers follow by least squares: lambda_i is the rise of the minimum per unit by which c_i is made
//! stricter. If no x is feasible, [`nearest`] maximises the smallest constraint.
//!
//! The variables should be of the order of one and so should be the constraints.
//!
//! # Source
//! Kraft (1988), A software package for sequential quadratic programming, DFVLR-FB 88-28; crate `slsqp`. Multipliers:
//! Nocedal, Wright (2006), Numerical Optimization, section 12.3.

use faer::Mat;
use faer::linalg::solvers::SolveLstsq;
use slsqp::{Func, StopTols};
use std::cell::RefCell;
use std::rc::Rc;

/// Violation of a constraint that counts as none [1].
const FEASIBLE: f64 = 1e-5;
/// Distance from a constraint or a bound below which it is active [1].
const ACTIVE: f64 = 1e-4;
/// Most evaluations of one descent.
const MOST_EVALUATIONS: usize = 60;
/// Change of the variables and of the objective at which a descent ends [1].
const TOLERANCE: f64 = 1e-6;

/// A function to be minimised under constraints.
pub trait Program {
    /// Bounds of the variables `(n,)`.
    fn bounds(&self) -> Vec<(f64, f64)>;

    /// The objective at x `(n,)`, and its gradient `(n,)`.
    fn objective(&self, x: &[f64]) -> (f64, Vec<f64>);

    /// The constraints at x `(c,)`, met where they are not negative.
    fn constraints(&self, x: &[f64]) -> Vec<f64>;

    /// Gradients of the constraints at x `(c)(n,)`.
    fn slopes(&self, x: &[f64]) -> Vec<Vec<f64>>;
}

/// The minimum found.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// The variables `(n,)`.
    pub x: Vec<f64>,
    /// Rise of the objective per unit of a stricter constraint `(c,)`; zero where a constraint is not active.
    pub multipliers: Vec<f64>,
    /// True if every constraint is met.
    pub feasible: bool,
}

/// Values at the last point, and the best point so far.
#[derive(Default)]
struct ProgramMemo {
    x: Option<Vec<f64>>,
    constraints: Vec<f64>,
    slopes: Option<Vec<Vec<f64>>>,
    /// Point, violation and objective of the best point.
    best: Option<(Vec<f64>, f64, f64)>,
}

/// A program whose constraints are evaluated once for each point, however often they are asked for.
struct Remembered<'a> {
    program: &'a dyn Program,
    memo: RefCell<ProgramMemo>,
}

impl Remembered<'_> {
    fn visit(&self, x: &[f64]) {
        if self.memo.borrow().x.as_deref() == Some(x) {
            return;
        }
        let constraints = self.program.constraints(x);
        let violation = violation(&constraints);
        let objective = self.program.objective(x).0;
        let mut memo = self.memo.borrow_mut();
        let better = |best: &(Vec<f64>, f64, f64)| {
            if violation.max(best.1) <= FEASIBLE { objective < best.2 } else { violation < best.1 }
        };
        if memo.best.as_ref().is_none_or(better) {
            memo.best = Some((x.to_vec(), violation, objective));
        }
        memo.x = Some(x.to_vec());
        (memo.constraints, memo.slopes) = (constraints, None);
    }
}

fn violation(constraints: &[f64]) -> f64 {
    constraints.iter().map(|c| -c).fold(0.0, f64::max)
}

/// Minimises a program of `constraints` constraints from `start` `(n,)`.
pub fn minimise(program: &dyn Program, constraints: usize, start: &[f64]) -> Minimum {
    let remembered = Rc::new(Remembered { program, memo: RefCell::default() });
    let mut x: Vec<f64> = clamped(start, &program.bounds());
    // A second descent forgets the curvature of the first, which may have led nowhere.
    for _ in 0..2 {
        descend(&remembered, constraints, &x);
        let memo = remembered.memo.borrow();
        let Some((best, violation, _)) = &memo.best else { break };
        x.clone_from(best);
        if *violation <= FEASIBLE {
            break;
        }
    }
    remembered.visit(&x);
    let values = remembered.memo.borrow().constraints.clone();
    let feasible = violation(&values) <= FEASIBLE;
    Minimum { multipliers: multipliers(program, &x, &values), feasible, x }
}

/// Maximises the smallest constraint of a program from `start` `(n,)`: the variables `(n,)` there.
pub fn nearest(program: &dyn Program, constraints: usize, start: &[f64]) -> Vec<f64> {
    let raised = Raised { program };
    let start = clamped(start, &program.bounds());
    let level = program.constraints(&start).into_iter().fold(f64::INFINITY, f64::min);
    let from: Vec<f64> = start.iter().copied().chain([level]).collect();
    minimise(&raised, constraints, &from).x[..start.len()].to_vec()
}

fn clamped(x: &[f64], bounds: &[(f64, f64)]) -> Vec<f64> {
    x.iter().zip(bounds).map(|(x, (lower, upper))| x.clamp(*lower, *upper)).collect()
}

type Callback<'a> = Box<dyn Fn(&[f64], Option<&mut [f64]>, &mut ()) -> f64 + 'a>;

fn descend(remembered: &Rc<Remembered<'_>>, constraints: usize, start: &[f64]) {
    let bounds = remembered.program.bounds();
    let objective = |x: &[f64], gradient: Option<&mut [f64]>, _: &mut ()| {
        remembered.visit(x);
        let (value, slope) = remembered.program.objective(x);
        if let Some(gradient) = gradient {
            gradient.copy_from_slice(&slope);
        }
        value
    };
    // SLSQP wants constraints that are negative where they are met.
    let constraint = |i: usize| -> Callback<'_> {
        let remembered = Rc::clone(remembered);
        Box::new(move |x: &[f64], gradient: Option<&mut [f64]>, _: &mut ()| {
            remembered.visit(x);
            let mut memo = remembered.memo.borrow_mut();
            if let Some(gradient) = gradient {
                let slopes = memo.slopes.get_or_insert_with(|| remembered.program.slopes(x));
                gradient.iter_mut().zip(&slopes[i]).for_each(|(into, slope)| *into = -slope);
            }
            -memo.constraints[i]
        })
    };
    let callbacks: Vec<Callback<'_>> = (0..constraints).map(constraint).collect();
    let callbacks: Vec<&dyn Func<()>> = callbacks.iter().map(|callback| callback as &dyn Func<()>).collect();
    let tolerances =
        StopTols { ftol_rel: TOLERANCE, xtol_abs: vec![TOLERANCE; start.len()], ..StopTols::default() };
    // A descent that ends with an error (a line search without progress) has left its best point in the memo.
    let ended =
        slsqp::minimize(objective, start, &bounds, &callbacks, (), MOST_EVALUATIONS, Some(tolerances));
    if let Err((status, ..)) = ended {
        tracing::debug!(?status, "a descent of the optimiser ended early");
    }
}

/// The program that maximises s subject to c_i(x) >= s; its last variable is s.
struct Raised<'a> {
    program: &'a dyn Program,
}

/// Largest |s|: of the order of the largest reliability index.
const LARGEST_LEVEL: f64 = 50.0;

impl Program for Raised<'_> {
    fn bounds(&self) -> Vec<(f64, f64)> {
        let mut bounds = self.program.bounds();
        bounds.push((-LARGEST_LEVEL, LARGEST_LEVEL));
        bounds
    }

    fn objective(&self, x: &[f64]) -> (f64, Vec<f64>) {
        let last = x.len() - 1;
        (-x[last], (0..=last).map(|k| if k == last { -1.0 } else { 0.0 }).collect())
    }

    fn constraints(&self, x: &[f64]) -> Vec<f64> {
        let (level, x) = x.split_last().expect("a program has variables");
        self.program.constraints(x).into_iter().map(|c| c - level).collect()
    }

    fn slopes(&self, x: &[f64]) -> Vec<Vec<f64>> {
        let mut slopes = self.program.slopes(&x[..x.len() - 1]);
        slopes.iter_mut().for_each(|slope| slope.push(-1.0));
        slopes
    }
}

/// Multipliers of the constraints `(c,)` at x: least squares over the active ones, those that come out negative dropped.
fn multipliers(program: &dyn Program, x: &[f64], values: &[f64]) -> Vec<f64> {
    let bounds = program.bounds();
    let is_free = |k: &usize| x[*k] - bounds[*k].0 > ACTIVE && bounds[*k].1 - x[*k] > ACTIVE;
    let free: Vec<usize> = (0..bounds.len()).filter(is_free).collect();
    let mut found = vec![0.0; values.len()];
    let mut active: Vec<usize> = (0..values.len()).filter(|i| values[*i] < ACTIVE).collect();
    if active.is_empty() || free.is_empty() {
        return found;
    }
    let (slopes, gradient) = (program.slopes(x), program.objective(x).1);
    while !active.is_empty() && active.len() <= free.len() {
        let columns = Mat::from_fn(free.len(), active.len(), |k, i| slopes[active[i]][free[k]]);
        let solved = columns.qr().solve_lstsq(Mat::from_fn(free.len(), 1, |k, _| gradient[free[k]]));
        let least = (0..active.len()).min_by(|a, b| solved[(*a, 0)].total_cmp(&solved[(*b, 0)]));
        match least.filter(|i| solved[(*i, 0)] < 0.0 || solved[(*i, 0)].is_nan()) {
            Some(negative) => {
                active.remove(negative);
            }
            None => {
                active.iter().enumerate().for_each(|(place, i)| found[*i] = solved[(place, 0)]);
                break;
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// min x + y subject to x y >= a, x <= 1.
    struct Hyperbola {
        a: f64,
        most: f64,
    }

    impl Program for Hyperbola {
        fn bounds(&self) -> Vec<(f64, f64)> {
            vec![(0.1, self.most); 2]
        }
        fn objective(&self, x: &[f64]) -> (f64, Vec<f64>) {
            (x[0] + x[1], vec![1.0; 2])
        }
        fn constraints(&self, x: &[f64]) -> Vec<f64> {
            vec![x[0] * x[1] - self.a, 3.0 - x[0]]
        }
        fn slopes(&self, x: &[f64]) -> Vec<Vec<f64>> {
            vec![vec![x[1], x[0]], vec![-1.0, 0.0]]
        }
    }

    #[test]
    fn the_minimum_has_the_multiplier_of_its_constraint() {
        let found = minimise(&Hyperbola { a: 4.0, most: 10.0 }, 2, &[1.0, 9.0]);
        assert!(found.feasible && (found.x[0] + found.x[1] - 4.0).abs() < 1e-6, "{found:?}");
        // The minimum is 2 sqrt(a), its derivative 1 / sqrt(a).
        assert!((found.multipliers[0] - 0.5).abs() < 1e-4, "{found:?}");
        assert_eq!(found.multipliers[1], 0.0);
    }

    #[test]
    fn without_a_feasible_point_the_nearest_one_is_found() {
        let program = Hyperbola { a: 4.0, most: 1.5 };
        assert!(!minimise(&program, 2, &[0.2, 0.2]).feasible);
        let found = nearest(&program, 2, &[0.2, 0.2]);
        assert!((program.constraints(&found)[0] - (1.5 * 1.5 - 4.0)).abs() < 1e-5, "{found:?}");
    }
}
