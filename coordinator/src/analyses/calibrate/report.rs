//! Result of a calibration, as JSON and with its tables.

use super::least_squares::{Fit, LeastSquares};
use super::responses::ResponseSurrogates;
use super::space::FreeParameter;
use super::target_file::Target;
use crate::presentation::report::answer::{Answer, AnswerPart, Table};
use crate::presentation::report::format::significant;
use serde::Serialize;

/// Residual above which a target counts as missed [tolerances].
const MISSED: f64 = 2.0;
/// Weight of a target that takes precedence over all others [1].
const FIRST: f64 = 1e4;
/// Distance from a bound below which a parameter counts as at the bound, as a share of the distance between the bounds.
const ON_BOUND: f64 = 0.01;
/// Uncertainty relative to that of the bounds alone, above which a parameter counts as undetermined by the targets.
const OPEN: f64 = 0.9;

/// A fitted parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FittedParameter {
    /// Name in the file of targets.
    pub name: String,
    /// Value at the optimum [unit].
    pub value: f64,
    /// Standard uncertainty by linear error propagation from the tolerances, enlarged if the targets are missed
    /// [unit].
    pub uncertainty: f64,
    /// SI unit; empty for a factor.
    pub unit: String,
    /// Lower bound [unit].
    pub lower: f64,
    /// Upper bound [unit].
    pub upper: f64,
    /// True if the value is at a bound.
    pub on_bound: bool,
    /// True if the targets determine the parameter.
    pub determined: bool,
}

/// A target and its value at the optimum.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FittedTarget {
    /// Name of the target.
    pub name: String,
    /// Value to be met [SI].
    pub target: f64,
    /// Tolerance, a standard deviation [SI].
    pub tolerance: f64,
    /// Value at the optimum [SI].
    pub fitted: f64,
    /// (fitted - target) / tolerance [1].
    pub residual: f64,
    /// Smallest leave-one-out Q2 of its surrogates [1].
    pub q2: f64,
    /// Unit in the file of targets.
    pub unit: String,
    /// This unit in SI.
    pub unit_si: f64,
}

/// A missed target, and the effect of meeting it on the others.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Conflict {
    /// Name of the missed target.
    pub target: String,
    /// Its residual if it takes precedence over all others [1]; large if no parameters within the bounds meet it.
    pub alone: f64,
    /// Other targets that are then missed.
    pub costs: Vec<(String, f64, f64)>,
}

/// Result of a calibration.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CalibrationResult {
    /// Number of simulations, failed ones included.
    pub simulations: usize,
    /// Number of failed simulations.
    pub failed: usize,
    /// Free parameters, which are fitted and not predicted.
    pub parameters: Vec<FittedParameter>,
    /// Correlations of the parameters' uncertainties `(p)(p,)` [1].
    pub correlation: Vec<Vec<f64>>,
    /// Targets and their values at the optimum.
    pub targets: Vec<FittedTarget>,
    /// Sum of the squared residuals [1].
    pub chi_squared: f64,
    /// Targets that cannot be met together with the others.
    pub conflicts: Vec<Conflict>,
}

/// The result of the last round, with the numbers of all simulations and of those without a result.
pub(super) fn result<R: Fn(&[f64]) -> Vec<f64>>(
    responses: &ResponseSurrogates<'_>,
    problem: &LeastSquares<R>,
    fit: &Fit,
    (simulations, failed): (usize, usize),
) -> CalibrationResult {
    let ResponseSurrogates { space, targets, .. } = responses;
    let best = fit.best.as_slice();
    let residuals = (problem.residuals)(best);
    let chi_squared: f64 = residuals.iter().map(|r| r * r).sum();
    let freedom = targets.len().saturating_sub(best.len());
    let scale = if freedom > 0 { (chi_squared / freedom as f64).max(1.0).sqrt() } else { 1.0 };
    let values = space.parameters(best);
    let parameter = |(k, free): (usize, &FreeParameter)| FittedParameter {
        name: free.name.clone(),
        value: values[k],
        uncertainty: (scale * fit.uncertainty(k)).min(1.0) * (free.upper - free.lower),
        unit: free.unit.clone(),
        lower: free.lower,
        upper: free.upper,
        on_bound: best[k] < ON_BOUND || best[k] > 1.0 - ON_BOUND,
        determined: fit.uncertainty(k) < OPEN / 12.0_f64.sqrt(),
    };
    let p = best.len();
    let target = |(target, residual): (&Target, &f64)| FittedTarget {
        name: target.name.clone(),
        target: target.value,
        tolerance: target.tolerance,
        fitted: target.value + residual * target.tolerance,
        residual: *residual,
        q2: responses.q2(target),
        unit: target.unit.symbol.clone(),
        unit_si: target.unit.si,
    };
    CalibrationResult {
        simulations,
        failed,
        parameters: space.free.iter().enumerate().map(parameter).collect(),
        correlation: (0..p).map(|i| (0..p).map(|j| fit.correlation(i, j)).collect()).collect(),
        targets: targets.iter().zip(&residuals).map(target).collect(),
        chi_squared,
        conflicts: conflicts(targets, problem, best, &residuals),
    }
}

/// For every missed target: the fit in which it takes precedence over all others.
fn conflicts<R: Fn(&[f64]) -> Vec<f64>>(
    targets: &[Target],
    problem: &LeastSquares<R>,
    best: &[f64],
    residuals: &[f64],
) -> Vec<Conflict> {
    let conflict = |i: usize| {
        let mut weights = vec![1.0; targets.len()];
        weights[i] = FIRST;
        let preferring = LeastSquares { residuals: &problem.residuals, weights };
        let then = (problem.residuals)(&preferring.minimise(&[best.to_vec(), vec![0.5; best.len()]]));
        let cost = |j: usize| {
            let is_missed = j != i && then[j].abs() > MISSED && then[j].abs() > residuals[j].abs() + 0.5;
            is_missed.then(|| (targets[j].name.clone(), residuals[j], then[j]))
        };
        let costs = (0..targets.len()).filter_map(cost).collect();
        Conflict { target: targets[i].name.clone(), alone: then[i], costs }
    };
    (0..targets.len()).filter(|i| residuals[*i].abs() > MISSED).map(conflict).collect()
}

/// The result for the scene of this name with its tables.
pub fn answer(found: &CalibrationResult, scene: &str) -> Answer {
    let CalibrationResult { simulations, failed, parameters, chi_squared, .. } = found;
    let (all, sum) = (found.targets.len(), format!("chi squared {chi_squared:.2}"));
    let counts = format!("{simulations} simulations, {failed} of them failed; {sum} for {all} targets.");
    let caution = "Free parameters: fitted to the targets below, so results that follow from them alone are not predictions.";
    let heading = "Correlations of the parameters' uncertainties";
    let correlations = (parameters.len() > 1).then(|| AnswerPart::Notes(heading, correlations(found)));
    let conflicts = found.conflicts.iter().map(|conflict| AnswerPart::Text(conflict_in_words(conflict)));
    let parts = [
        AnswerPart::Text(counts),
        AnswerPart::Text(caution.to_owned()),
        AnswerPart::Table(parameters_table(parameters)),
        AnswerPart::Table(targets_table(&found.targets)),
    ];
    Answer {
        name: "calibration".to_owned(),
        title: format!("Calibration of {scene}"),
        parts: parts.into_iter().chain(correlations).chain(conflicts).collect(),
        prints_markdown: true,
        ..Answer::default()
    }
}

fn parameters_table(parameters: &[FittedParameter]) -> Table {
    let row = |p: &FittedParameter| {
        let place = if p.on_bound { "at a bound" } else { "" };
        let remark = if p.determined { place } else { "not determined by these targets" };
        let [value, lower, upper] = [p.value, p.lower, p.upper].map(|x| significant(x, 5));
        let texts = [value, significant(p.uncertainty, 2), format!("{lower} to {upper}")];
        let [value, uncertainty, bounds] = texts.map(|text| format!("{text} {}", p.unit));
        vec![p.name.clone(), value, uncertainty, bounds, remark.to_owned()]
    };
    Table::new("", ["parameter", "value", "uncertainty", "bounds", ""], parameters.iter().map(row))
}

fn targets_table(targets: &[FittedTarget]) -> Table {
    let row = |t: &FittedTarget| {
        let shown =
            |(si, digits): (f64, usize)| format!("{} {}", significant(si / t.unit_si, digits), t.unit);
        let [target, tolerance, fitted] = [(t.target, 4), (t.tolerance, 2), (t.fitted, 4)].map(shown);
        let (residual, q2) = (format!("{:+.1}", t.residual), format!("{:.4}", t.q2));
        vec![t.name.clone(), target, tolerance, fitted, residual, q2]
    };
    let head = ["target", "value", "tolerance", "fitted", "residual", "surrogate's Q2"];
    Table::new("", head, targets.iter().map(row))
}

fn correlations(found: &CalibrationResult) -> Vec<String> {
    let name = |k: usize| &found.parameters[k].name;
    let pairs = (0..found.parameters.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    pairs.map(|(i, j)| format!("{} and {}: {:+.2}", name(j), name(i), found.correlation[i][j])).collect()
}

fn conflict_in_words(conflict: &Conflict) -> String {
    let mut text = format!("The target {} is missed.", conflict.target);
    let Conflict { alone, costs, .. } = conflict;
    if alone.abs() > MISSED {
        text += &format!(
            " No parameters within the bounds meet it: the smallest residual is {alone:+.1} tolerances."
        );
    }
    if !costs.is_empty() {
        let costs = costs.iter().map(|(name, from, to)| format!("{name} ({from:+.1} to {to:+.1})"));
        let costs = costs.collect::<Vec<_>>().join(", ");
        text += &format!(" If it takes precedence, other residuals increase: {costs}.");
    }
    text
}
