//! Reliability index of every target as a smooth function of the design, from the surrogates, by line sampling.
//!
//! A quantity q between its bounds a and b is represented by y in [0, 1], with q = a + (b - a) y for a mean and
//! q = a (b / a)^y for a spread, whose effect on cost and reliability is one of proportion. The constraint of a target is
//! beta - beta_target, with beta = -Phi^-1(P_f): nearly linear in the design, where P_f is nearly exponential. Points v of
//! independent standard normals are fixed; the design moves their values x = T(v; q), so that
//!
//!   dP_f/dq = sum over the roots of weight_r dY(T(v_r; q)) / dq
//!
//! with the weights of [`LineRoot`](crate::statistics::reliability::LineRoot) and Y the predicted mean less the threshold.
//! This holds for any distribution and dependence, bounds that move included.
//!
//! Where no failure, or nothing else, is found along the lines, beta is that of the tangent plane at v = 0 (mean value
//! first-order), which leads a search back.

use super::problem::{DesignProblem, DesignQuantity};
use crate::statistics::design::InputModel;
use crate::statistics::optimisation::Program;
use crate::statistics::reliability::{LineEstimate, LineSampling};
use crate::statistics::surrogate::Kriging;
use common::random::{LawError, standard_normal_pdf, standard_normal_quantile};
use faer::{Mat, MatRef};
use rayon::prelude::*;
use std::cell::RefCell;

/// Number of points predicted together.
const BLOCK: usize = 256;
/// Lines of a target at first, and at most.
const LINES: (usize, usize) = (256, 4096);
/// Relative standard error of the smaller of P_f and R above which the lines are doubled [1].
const LINE_ERROR: f64 = 0.015;
/// Smallest P_f, and smallest R, that is read from lines.
const LEAST: f64 = 1e-14;
/// Reliability index that stands for what the lines do not reach.
const BEYOND: f64 = 8.0;
/// Half of the distance in y over which derivatives are taken.
const STEP: f64 = 1e-3;
/// Constraint of a design whose distributions do not exist.
const IMPOSSIBLE: f64 = -20.0;

/// A target over the surrogates.
#[derive(Debug, Clone)]
pub(super) struct Constraint {
    /// Indices of its modes among the surrogates.
    pub modes: Vec<usize>,
    /// Index of its curve in the campaigns.
    pub curve: usize,
    /// Index of its checkpoint among the columns of the surrogates.
    pub column: usize,
    /// Reliability index to be reached.
    pub beta: f64,
}

/// The failure probability of a target at a design.
#[derive(Debug, Clone)]
pub(super) struct TargetValue {
    /// Reliability index [1].
    pub beta: f64,
    /// The estimate by lines.
    pub estimate: LineEstimate,
    /// True if the index is that of the tangent plane.
    pub tangent: bool,
}

/// Reliability over designs.
pub(super) struct DesignReliability<'a> {
    pub problem: &'a DesignProblem,
    /// Inputs of the study.
    pub reference: &'a InputModel,
    /// Surrogate, threshold [unit of the output] and dual weights of every mode.
    pub surrogates: Vec<(&'a Kriging, f64, Mat<f64>)>,
    pub constraints: Vec<Constraint>,
    /// Region of y in which the surrogates are trusted `(q,)`.
    pub region: Vec<(f64, f64)>,
    /// Unit of the objective.
    pub cost_scale: f64,
    /// Lines and directions by target.
    lines: Vec<(LineSampling, Vec<Vec<f64>>)>,
    seed: u64,
    memo: RefCell<Option<(Vec<f64>, Vec<TargetValue>)>>,
}

impl<'a> DesignReliability<'a> {
    /// Reliability over designs, with lines placed for the design y `(q,)`.
    pub fn new(
        problem: &'a DesignProblem,
        reference: &'a InputModel,
        surrogates: Vec<(&'a Kriging, f64, Mat<f64>)>,
        constraints: Vec<Constraint>,
        seed: u64,
        y: &[f64],
    ) -> Self {
        let (memo, lines) = (RefCell::default(), vec![]);
        let region = vec![(0.0, 1.0); problem.quantities.len()];
        let mut made =
            Self { problem, reference, surrogates, constraints, region, cost_scale: 1.0, lines, seed, memo };
        // The cost of one design may be zero.
        let typical = 0.5 * (made.cost(y).abs() + made.cost(&vec![0.5; y.len()]).abs());
        made.cost_scale = if typical > 0.0 && typical.is_finite() { typical } else { 1.0 };
        made.place_lines(y);
        made
    }

    /// Places the lines anew: directions and number for the design y.
    pub fn place_lines(&mut self, y: &[f64]) {
        self.memo.replace(None);
        let Ok(inputs) = self.inputs(y) else { return };
        let place = |constraint: &Constraint| {
            let margins = |v: MatRef<'_, f64>| self.margins(&inputs, constraint, v);
            let mut lines = LineSampling::new(self.reference.dimension(), LINES.0, self.seed);
            let directions = lines.directions(constraint.modes.len(), &margins);
            loop {
                let found = lines.estimate(&directions, &margins);
                let share = found.probability.min(1.0 - found.probability);
                let enough = found.standard_error <= LINE_ERROR * share || share < LEAST;
                if enough || lines.lines() >= LINES.1 {
                    return (lines, directions);
                }
                lines = LineSampling::new(self.reference.dimension(), 2 * lines.lines(), self.seed);
            }
        };
        self.lines = self.constraints.iter().map(place).collect();
    }

    fn inputs(&self, y: &[f64]) -> Result<InputModel, LawError> {
        self.problem.inputs(self.reference, &self.problem.values(y))
    }

    /// Cost of the design y.
    pub fn cost(&self, y: &[f64]) -> f64 {
        self.problem.cost(&self.problem.values(y))
    }

    /// Every target at the design y; `None` if its distributions do not exist.
    pub fn targets(&self, y: &[f64]) -> Option<Vec<TargetValue>> {
        if let Some((at, values)) = &*self.memo.borrow()
            && at == y
        {
            return Some(values.clone());
        }
        let inputs = self.inputs(y).ok()?;
        let value = |(constraint, (lines, directions)): (&Constraint, &(LineSampling, Vec<Vec<f64>>))| {
            let margins = |v: MatRef<'_, f64>| self.margins(&inputs, constraint, v);
            let estimate = lines.estimate(directions, &margins);
            let p = estimate.probability;
            let tangent = !(LEAST..=1.0 - LEAST).contains(&p);
            let beta = if tangent {
                let beta = self.tangent_index(&inputs, constraint);
                if p < 0.5 { beta.clamp(BEYOND, 2.0 * BEYOND) } else { beta.clamp(-2.0 * BEYOND, -BEYOND) }
            } else {
                -standard_normal_quantile(p)
            };
            TargetValue { beta, estimate, tangent }
        };
        let values: Vec<TargetValue> = self.constraints.iter().zip(&self.lines).map(value).collect();
        self.memo.replace(Some((y.to_vec(), values.clone())));
        Some(values)
    }

    /// Index of the tangent planes at v = 0, the smallest of the modes.
    fn tangent_index(&self, inputs: &InputModel, constraint: &Constraint) -> f64 {
        let d = inputs.dimension();
        let h = 0.1;
        let points = Mat::from_fn(d, 2 * d + 1, |k, j| match j {
            0 => 0.0,
            j if (j - 1) / 2 == k => h * if j % 2 == 1 { 1.0 } else { -1.0 },
            _ => 0.0,
        });
        let y = self.margins(inputs, constraint, points.as_ref());
        let index = |i: usize| {
            let slope = |k: usize| (y[(i, 2 * k + 1)] - y[(i, 2 * k + 2)]) / (2.0 * h);
            let length = (0..d).map(|k| slope(k).powi(2)).sum::<f64>().sqrt();
            -y[(i, 0)] / length.max(1e-12)
        };
        (0..y.nrows()).map(index).fold(f64::INFINITY, f64::min)
    }

    /// Margins `(modes, b)` of a target at points v `(d, b)`, in process standard deviations.
    fn margins(&self, inputs: &InputModel, constraint: &Constraint, v: MatRef<'_, f64>) -> Mat<f64> {
        let (d, b) = (v.nrows(), v.ncols());
        let surrogates = &self.surrogates;
        let standardised = |j: usize| {
            let point: Vec<f64> = (0..d).map(|k| v[(k, j)]).collect();
            inputs.standardise(&inputs.from_independent_normals(&point))
        };
        let block = |start: usize| {
            let count = BLOCK.min(b - start);
            let z: Vec<f64> = (start..start + count).flat_map(standardised).collect();
            let points = MatRef::from_column_major_slice(&z, d, count);
            let column = constraint.column;
            let margin = |mode: &usize| -> Vec<f64> {
                let (model, threshold, dual) = &surrogates[*mode];
                let scale = model.sigma2[column].sqrt().max(f64::MIN_POSITIVE);
                let mean = model.predict_means(points, dual, column..column + 1);
                (0..count).map(|j| (mean[(0, j)] - threshold) / scale).collect()
            };
            constraint.modes.iter().map(margin).collect::<Vec<_>>()
        };
        let blocks: Vec<Vec<Vec<f64>>> = (0..b).into_par_iter().step_by(BLOCK).map(block).collect();
        Mat::from_fn(constraint.modes.len(), b, |i, j| blocks[j / BLOCK][i][j % BLOCK])
    }

    /// Derivatives of the index of every target by the y of the quantities `free` `(targets)(q,)`; zero for the others.
    fn index_slopes(&self, y: &[f64], free: &[usize]) -> Vec<Vec<f64>> {
        let mut slopes = vec![vec![0.0; y.len()]; self.constraints.len()];
        let Some(values) = self.targets(y) else { return slopes };
        let points = |TargetValue { estimate, .. }: &TargetValue| {
            let roots = &estimate.roots;
            Mat::from_fn(self.reference.dimension(), roots.len(), |k, j| roots[j].point[k])
        };
        let points: Vec<Mat<f64>> = values.iter().map(points).collect();
        for &k in free {
            let moved = |by: f64| {
                let mut y = y.to_vec();
                y[k] = (y[k] + by).clamp(0.0, 1.0);
                self.inputs(&y).map(|inputs| (y[k], inputs)).ok()
            };
            let (Some((low, below)), Some((high, above))) = (moved(-STEP), moved(STEP)) else { continue };
            for (i, (value, constraint)) in values.iter().zip(&self.constraints).enumerate() {
                let both = [&above, &below];
                let difference = if value.tangent {
                    let [above, below] = both.map(|inputs| self.tangent_index(inputs, constraint));
                    above - below
                } else {
                    let [above, below] =
                        both.map(|inputs| self.margins(inputs, constraint, points[i].as_ref()));
                    let roots = value.estimate.roots.iter().enumerate();
                    let changes = roots.map(|(j, r)| r.weight * (above[(r.mode, j)] - below[(r.mode, j)]));
                    -changes.sum::<f64>() / standard_normal_pdf(value.beta)
                };
                slopes[i][k] = difference / (high - low);
            }
        }
        slopes
    }
}

/// The design as a program over some of its quantities, the others held fixed.
pub(super) struct FreeDesign<'a> {
    pub reliability: &'a DesignReliability<'a>,
    /// Indices of the quantities that vary.
    pub free: Vec<usize>,
    /// All y `(q,)`; those of the free quantities are replaced.
    pub at: Vec<f64>,
}

impl FreeDesign<'_> {
    /// All y `(q,)`, with those of the free quantities given.
    pub fn all(&self, free: &[f64]) -> Vec<f64> {
        let mut y = self.at.clone();
        self.free.iter().zip(free).for_each(|(k, value)| y[*k] = *value);
        y
    }
}

impl Program for FreeDesign<'_> {
    fn bounds(&self) -> Vec<(f64, f64)> {
        self.free.iter().map(|k| self.reliability.region[*k]).collect()
    }

    fn objective(&self, free: &[f64]) -> (f64, Vec<f64>) {
        let DesignReliability { problem, cost_scale, .. } = self.reliability;
        let y = self.all(free);
        let part = |k: usize| {
            let quantity = &problem.quantities[k];
            let DesignQuantity { lower, upper, .. } = quantity;
            let at = quantity.value(y[k]);
            let (cost, slope) = quantity.cost_at(at);
            let by_y = if quantity.kind.is_spread() { at * (upper / lower).ln() } else { upper - lower };
            (cost / cost_scale, slope * by_y / cost_scale)
        };
        let cost = (0..y.len()).map(|k| part(k).0).sum();
        (cost, self.free.iter().map(|k| part(*k).1).collect())
    }

    fn constraints(&self, free: &[f64]) -> Vec<f64> {
        let constraints = &self.reliability.constraints;
        match self.reliability.targets(&self.all(free)) {
            Some(values) => values.iter().zip(constraints).map(|(v, c)| v.beta - c.beta).collect(),
            None => vec![IMPOSSIBLE; constraints.len()],
        }
    }

    fn slopes(&self, free: &[f64]) -> Vec<Vec<f64>> {
        let all = self.reliability.index_slopes(&self.all(free), &self.free);
        all.into_iter().map(|slopes| self.free.iter().map(|k| slopes[*k]).collect()).collect()
    }
}
