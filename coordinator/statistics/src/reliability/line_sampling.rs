//! Line sampling: a failure probability, smooth in the parameters of the variables, and what its derivatives need.
//!
//! In independent standard normals v `(d,)`, a mode i fails where its margin y_i(v) >= 0, the system where any does. With
//! a direction a_i (unit vector) for each mode and v = w + t a_i, w perpendicular to a_i,
//!
//!   P_f = sum over i of E_w [ integral of I_i(w + t a_i) / K(w + t a_i) phi(t) dt ],
//!
//! I_i the indicator of mode i and K the number of modes that fail at the point: every failed point counts once. The
//! integral is exact between the roots of the margins along a line, which are bracketed on a grid of t and refined. The
//! mean over lines is unbiased for any direction; its variance is below that of counting, and vanishes for a plane limit
//! with a_i perpendicular to it. The lines are a Latin hypercube of normals, the same at every call (common random
//! numbers), so that P_f is a continuous function of any parameter p of the margins, with the derivative
//!
//!   dP_f/dp = mean over lines of sum over roots r of J_r phi(t_r) (dy/dp) / (dy/dt),
//!
//! J_r the jump of the integrand at the root, y the margin that passes through zero there.
//!
//! Valid as long as the margins change sign at most once between neighbouring grid points, one apart from -8 to 8;
//! probabilities below 1e-15 count as zero.
//!
//! # Source
//! Koutsourelakis, Pradlwarter, Schueller (2004), Reliability of structures in high dimensions, Probabilistic Engineering
//! Mechanics 19(4). Derivative: Lu, Song, Yue, Wang (2008), Reliability sensitivity method by line sampling, Structural
//! Safety 30(6). The partition 1/K: Owen, Maximov, Chertkov (2019), Importance sampling the union of rare events,
//! Electronic Journal of Statistics 13.

use crate::design::{InputModel, latin_hypercube};
use common::random::{Distribution, standard_normal_mass, standard_normal_pdf};
use faer::{Mat, MatRef};

/// Largest |t| of the grid along a line [1].
const REACH: i32 = 8;
/// Number of points of the grid.
const GRID: usize = 2 * REACH as usize + 1;
/// Steps of the refinement of a bracket of width one: its width is then below 1e-3, and the last step is Newton's.
const REFINEMENTS: usize = 4;
/// Half of the distance over which the slope along the line is taken [1].
const SLOPE_STEP: f64 = 1e-3;
/// Lines of the search for a direction.
const SEARCH_LINES: usize = 48;
/// Rounds of that search.
const SEARCH_ROUNDS: usize = 2;

/// Margins `(modes, b)` at the points v `(d, b)` of independent standard normals; a mode fails where its margin is not
/// negative.
pub type Margins<'a> = dyn Fn(MatRef<'_, f64>) -> Mat<f64> + 'a;

/// Lines through the space of independent standard normals.
#[derive(Debug, Clone)]
pub struct LineSampling {
    /// Points that the lines pass through `(d, L)` [1].
    normals: Mat<f64>,
}

/// A root of a margin along a line.
#[derive(Debug, Clone, PartialEq)]
pub struct LineRoot {
    /// The root in independent standard normals `(d,)` [1].
    pub point: Vec<f64>,
    /// Index of the mode whose margin passes through zero.
    pub mode: usize,
    /// dP_f per change of this margin [1/unit of the margin].
    pub weight: f64,
}

/// A failure probability.
#[derive(Debug, Clone, PartialEq)]
pub struct LineEstimate {
    /// Failure probability P_f [1].
    pub probability: f64,
    /// Standard error of it over independent lines [1]; the hypercube makes the error smaller.
    pub standard_error: f64,
    /// Roots of all lines, with the weights of the derivative.
    pub roots: Vec<LineRoot>,
}

/// A bracket of a root, or the root itself after refinement.
#[derive(Debug, Clone, Copy)]
struct RootBracket {
    line: usize,
    mode: usize,
    /// Ends with their margins.
    low: (f64, f64),
    high: (f64, f64),
    t: f64,
    slope: f64,
}

impl LineSampling {
    /// `lines` lines in `d` dimensions under `seed`.
    pub fn new(d: usize, lines: usize, seed: u64) -> Self {
        let normal = Distribution::normal(0.0, 1.0).expect("a standard deviation of one");
        let z = latin_hypercube(&InputModel::from(&vec![normal; d]), lines, seed);
        Self { normals: Mat::from_fn(d, lines, |k, l| z[l * d + k]) }
    }

    /// Number of lines for each mode.
    pub fn lines(&self) -> usize {
        self.normals.ncols()
    }

    /// The failure probability of the system of all modes, with a direction for each `(modes)(d,)`.
    pub fn estimate(&self, directions: &[Vec<f64>], margins: &Margins<'_>) -> LineEstimate {
        let lines = self.lines();
        let mut by_line = vec![0.0; lines];
        let mut roots = Vec::new();
        for (own, direction) in directions.iter().enumerate() {
            let (feet, first, brackets) = self.crossings(lines, direction, margins);
            let mut by = vec![Vec::new(); lines];
            brackets.into_iter().for_each(|bracket| by[bracket.line].push(bracket));
            for (l, mut crossed) in by.into_iter().enumerate() {
                crossed.sort_by(|a, b| a.t.total_cmp(&b.t));
                let mut failed: Vec<bool> = (0..directions.len()).map(|i| first[(i, l)] >= 0.0).collect();
                let share = |failed: &[bool]| {
                    let k = failed.iter().filter(|failed| **failed).count();
                    if failed[own] { 1.0 / k as f64 } else { 0.0 }
                };
                let (mut from, mut value) = (f64::NEG_INFINITY, share(&failed));
                for root in crossed {
                    by_line[l] += value * standard_normal_mass(from, root.t);
                    failed[root.mode] = !failed[root.mode];
                    let next = share(&failed);
                    let weight = (next - value) * standard_normal_pdf(root.t) / root.slope / lines as f64;
                    if weight != 0.0 && weight.is_finite() {
                        let point =
                            (0..direction.len()).map(|k| feet[(k, l)] + root.t * direction[k]).collect();
                        roots.push(LineRoot { point, mode: root.mode, weight });
                    }
                    (from, value) = (root.t, next);
                }
                by_line[l] += value * standard_normal_mass(from, f64::INFINITY);
            }
        }
        let n = lines as f64;
        let mean = by_line.iter().sum::<f64>() / n;
        let variance = by_line.iter().map(|p| (p - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
        LineEstimate { probability: mean, standard_error: (variance / n).sqrt(), roots }
    }

    /// Directions `(modes)(d,)` in which the margins rise where the probability of failure lies: first the gradients at
    /// the origin, then their means over the roots of some lines, weighted with the density.
    pub fn directions(&self, modes: usize, margins: &Margins<'_>) -> Vec<Vec<f64>> {
        let d = self.normals.nrows();
        let at_origin = gradients(Mat::zeros(d, 1).as_ref(), 0.5, margins);
        let of_mode = |i: usize| {
            let mut direction = unit((0..d).map(|k| at_origin[k][(i, 0)]).collect());
            for _ in 0..SEARCH_ROUNDS {
                let (feet, _, brackets) = self.crossings(self.lines().min(SEARCH_LINES), &direction, margins);
                // Only rises count: they bound the failures that lie along the direction.
                let is_rise = |root: &&RootBracket| root.mode == i && root.slope > 0.0;
                let rising: Vec<&RootBracket> = brackets.iter().filter(is_rise).collect();
                let nearest = rising.iter().map(|root| root.t.powi(2)).fold(f64::INFINITY, f64::min);
                if rising.is_empty() {
                    break;
                }
                let point = |k: usize, j: usize| feet[(k, rising[j].line)] + rising[j].t * direction[k];
                let slopes = gradients(Mat::from_fn(d, rising.len(), point).as_ref(), 0.05, margins);
                let mut mean = vec![0.0; d];
                for (j, root) in rising.iter().enumerate() {
                    let weight = (-0.5 * (root.t.powi(2) - nearest)).exp();
                    let gradient = unit((0..d).map(|k| slopes[k][(i, j)]).collect());
                    mean.iter_mut().zip(gradient).for_each(|(m, g)| *m += weight * g);
                }
                direction = unit(mean);
            }
            direction
        };
        (0..modes).map(of_mode).collect()
    }

    /// Points of the lines perpendicular to `direction` `(d, lines)`, the margins at the lower ends `(modes, lines)`, and
    /// all roots.
    fn crossings(
        &self,
        lines: usize,
        direction: &[f64],
        margins: &Margins<'_>,
    ) -> (Mat<f64>, Mat<f64>, Vec<RootBracket>) {
        let d = self.normals.nrows();
        let along_direction =
            |l: usize| -> f64 { (0..d).map(|k| self.normals[(k, l)] * direction[k]).sum::<f64>() };
        let offsets: Vec<f64> = (0..lines).map(along_direction).collect();
        let feet = Mat::from_fn(d, lines, |k, l| self.normals[(k, l)] - offsets[l] * direction[k]);
        let t_of = |g: usize| f64::from(g as i32 - REACH);
        let on_grid =
            Mat::from_fn(d, lines * GRID, |k, j| feet[(k, j / GRID)] + t_of(j % GRID) * direction[k]);
        let y = margins(on_grid.as_ref());
        let mut brackets = Vec::new();
        for line in 0..lines {
            for mode in 0..y.nrows() {
                for g in 1..GRID {
                    let (low, high) = (y[(mode, line * GRID + g - 1)], y[(mode, line * GRID + g)]);
                    if (low >= 0.0) != (high >= 0.0) {
                        let (low, high) = ((t_of(g - 1), low), (t_of(g), high));
                        brackets.push(RootBracket { line, mode, low, high, t: low.0, slope: 0.0 });
                    }
                }
            }
        }
        refine(&mut brackets, feet.as_ref(), direction, margins);
        let first = Mat::from_fn(y.nrows(), lines, |i, l| y[(i, l * GRID)]);
        (feet, first, brackets)
    }
}

/// Refines the brackets by the Illinois method, all at once, and takes the slopes along the lines.
fn refine(brackets: &mut [RootBracket], feet: MatRef<'_, f64>, direction: &[f64], margins: &Margins<'_>) {
    if brackets.is_empty() {
        return;
    }
    let at = |brackets: &[RootBracket], shifts: &[f64]| {
        let n = brackets.len();
        let points = Mat::from_fn(feet.nrows(), n * shifts.len(), |k, j| {
            let bracket = &brackets[j % n];
            feet[(k, bracket.line)] + (bracket.t + shifts[j / n]) * direction[k]
        });
        margins(points.as_ref())
    };
    let chord = |low: (f64, f64), high: (f64, f64)| {
        let t = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
        if t.is_finite() { t.clamp(low.0, high.0) } else { 0.5 * (low.0 + high.0) }
    };
    for step in 0..REFINEMENTS {
        for bracket in brackets.iter_mut() {
            // The second step halves: it bounds the width where the chord converges from one side.
            let middle = 0.5 * (bracket.low.0 + bracket.high.0);
            bracket.t = if step == 1 { middle } else { chord(bracket.low, bracket.high) };
        }
        let y = at(brackets, &[0.0]);
        for (j, bracket) in brackets.iter_mut().enumerate() {
            let value = y[(bracket.mode, j)];
            if (value >= 0.0) == (bracket.low.1 >= 0.0) {
                bracket.low = (bracket.t, value);
                bracket.high.1 *= 0.5;
            } else {
                bracket.high = (bracket.t, value);
                bracket.low.1 *= 0.5;
            }
        }
    }
    brackets.iter_mut().for_each(|bracket| bracket.t = chord(bracket.low, bracket.high));
    let y = at(brackets, &[-SLOPE_STEP, SLOPE_STEP]);
    let n = brackets.len();
    for (j, bracket) in brackets.iter_mut().enumerate() {
        let (below, above) = (y[(bracket.mode, j)], y[(bracket.mode, n + j)]);
        bracket.slope = (above - below) / (2.0 * SLOPE_STEP);
        let newton = bracket.t - 0.5 * (above + below) / bracket.slope;
        if (newton - bracket.t).abs() < 0.1 {
            bracket.t = newton;
        }
    }
}

/// Central differences of the margins over 2 `step` at points `(d, b)`: by variable `(d)(modes, b)`.
fn gradients(points: MatRef<'_, f64>, step: f64, margins: &Margins<'_>) -> Vec<Mat<f64>> {
    let shifted = |k: usize, by: f64| {
        let points = Mat::from_fn(points.nrows(), points.ncols(), |i, j| {
            points[(i, j)] + if i == k { by } else { 0.0 }
        });
        margins(points.as_ref())
    };
    (0..points.nrows()).map(|k| (shifted(k, step) - shifted(k, -step)) * (0.5 / step)).collect()
}

/// The unit vector of `vector`; the first axis if it vanishes.
fn unit(mut vector: Vec<f64>) -> Vec<f64> {
    let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() {
        vector.iter_mut().for_each(|x| *x /= length);
    } else {
        vector.iter_mut().enumerate().for_each(|(k, x)| *x = if k == 0 { 1.0 } else { 0.0 });
    }
    vector
}

#[cfg(test)]
mod tests;
