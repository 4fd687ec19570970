//! What a calibration found, for programs and people.

use super::design::parameters;
use super::least_squares::Problem;
use super::responses::Responses;
use super::space::Space;
use super::targets::Target;
use faer::Mat;
use serde::Serialize;
use std::fmt::Write;

/// Residual in tolerances from which a target counts as not met.
const MISSED: f64 = 2.0;
/// Weight of a target that is to be met before all others.
const FIRST: f64 = 1e4;
/// Distance to a bound, as a share of that between the bounds, below which a parameter stands on it.
const ON_BOUND: f64 = 0.01;
/// Uncertainty over that of the bounds alone from which the targets say nothing of a parameter.
const OPEN: f64 = 0.9;

/// A parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FittedParameter {
    /// Name.
    pub name: String,
    /// Best value [unit].
    pub value: f64,
    /// Standard uncertainty by linear error propagation from the targets' tolerances, enlarged where they are not met
    /// [unit].
    pub uncertainty: f64,
    /// SI unit; empty of a factor.
    pub unit: String,
    /// Least value allowed.
    pub lower: f64,
    /// Largest value allowed.
    pub upper: f64,
    /// Whether it stands on a bound.
    pub on_bound: bool,
    /// Whether the targets say anything of it.
    pub determined: bool,
}

/// A target.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FittedTarget {
    /// Name.
    pub name: String,
    /// Value to be met [SI].
    pub target: f64,
    /// How well [SI].
    pub tolerance: f64,
    /// Value at the optimum [SI].
    pub fitted: f64,
    /// (fitted - target) / tolerance [1].
    pub residual: f64,
    /// Leave-one-out Q2 of the surrogate it is seen through [1].
    pub q2: f64,
    /// Unit it was written in.
    pub unit: String,
    /// That unit in SI.
    pub unit_si: f64,
}

/// A target that is not met, and what meeting it would cost.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Conflict {
    /// Which.
    pub target: String,
    /// Its residual when it goes before all others [1]: still large if no parameters within the bounds meet it.
    pub alone: f64,
    /// Other targets that are then missed: name, residual at the optimum, residual then.
    pub costs: Vec<(String, f64, f64)>,
}

/// What was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outcome {
    /// Simulations, failed ones included.
    pub simulations: usize,
    /// Failed ones.
    pub failed: usize,
    /// Free parameters: fitted, not predicted.
    pub parameters: Vec<FittedParameter>,
    /// Correlations of their uncertainties `(p)(p,)`.
    pub correlation: Vec<Vec<f64>>,
    /// Targets.
    pub targets: Vec<FittedTarget>,
    /// Sum of the squared residuals.
    pub chi_squared: f64,
    /// Targets that cannot be met together with the others.
    pub conflicts: Vec<Conflict>,
}

pub(super) fn outcome<R: Fn(&[f64]) -> Vec<f64> + Sync>(
    space: &Space,
    targets: &[Target],
    responses: &Responses<'_>,
    problem: &Problem<R>,
    best: &[f64],
    spread: &Mat<f64>,
    (simulations, failed): (usize, usize),
) -> Outcome {
    let residuals = (problem.residuals)(best);
    let chi_squared: f64 = residuals.iter().map(|r| r * r).sum();
    let freedom = targets.len().saturating_sub(best.len());
    let scale = if freedom > 0 { (chi_squared / freedom as f64).max(1.0).sqrt() } else { 1.0 };
    let values = parameters(&space.free, best);
    let parameter = |(k, free): (usize, &super::Free)| {
        let width = free.upper - free.lower;
        let std = spread[(k, k)].sqrt();
        FittedParameter {
            name: free.name.clone(),
            value: values[k],
            uncertainty: (scale * std).min(1.0) * width,
            unit: free.unit.clone(),
            lower: free.lower,
            upper: free.upper,
            on_bound: best[k] < ON_BOUND || best[k] > 1.0 - ON_BOUND,
            determined: std < OPEN / 12.0_f64.sqrt(),
        }
    };
    let p = best.len();
    let correlation = |i: usize, j: usize| spread[(i, j)] / (spread[(i, i)] * spread[(j, j)]).sqrt();
    let target = |(target, residual): (&Target, &f64)| FittedTarget {
        name: target.name.clone(),
        target: target.value,
        tolerance: target.tolerance,
        fitted: target.value + residual * target.tolerance,
        residual: *residual,
        q2: responses.q2(target),
        unit: target.unit.0.clone(),
        unit_si: target.unit.1,
    };
    Outcome {
        simulations,
        failed,
        parameters: space.free.iter().enumerate().map(parameter).collect(),
        correlation: (0..p).map(|i| (0..p).map(|j| correlation(i, j)).collect()).collect(),
        targets: targets.iter().zip(&residuals).map(target).collect(),
        chi_squared,
        conflicts: conflicts(targets, problem, best, &residuals),
    }
}

/// For every target that is missed: the fit again with that target before all others.
fn conflicts<R: Fn(&[f64]) -> Vec<f64> + Sync>(
    targets: &[Target],
    problem: &Problem<R>,
    best: &[f64],
    residuals: &[f64],
) -> Vec<Conflict> {
    let missed = (0..targets.len()).filter(|i| residuals[*i].abs() > MISSED);
    missed
        .map(|i| {
            let mut weights = vec![1.0; targets.len()];
            weights[i] = FIRST;
            let preferring = Problem { residuals: &problem.residuals, weights };
            let places = preferring.minimise(&[best.to_vec(), vec![0.5; best.len()]]);
            let then = (problem.residuals)(&places);
            let costs = (0..targets.len())
                .filter(|j| *j != i && then[*j].abs() > MISSED && then[*j].abs() > residuals[*j].abs() + 0.5)
                .map(|j| (targets[j].name.clone(), residuals[j], then[j]))
                .collect();
            Conflict { target: targets[i].name.clone(), alone: then[i], costs }
        })
        .collect()
}

/// The outcome as Markdown.
pub fn markdown(found: &Outcome) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_markdown(&mut out, found);
    out
}

fn write_markdown(out: &mut String, found: &Outcome) -> std::fmt::Result {
    writeln!(
        out,
        "{} simulations, {} of them failed; chi squared {:.2} for {} targets.\n",
        found.simulations,
        found.failed,
        found.chi_squared,
        found.targets.len()
    )?;
    writeln!(
        out,
        "Free parameters: fitted to the targets below, so nothing that follows from them alone is a prediction.\n"
    )?;
    writeln!(out, "| parameter | value | uncertainty | bounds | |\n|---|---|---|---|---|")?;
    for p in &found.parameters {
        let remark = match (p.determined, p.on_bound) {
            (false, _) => "not determined by these targets",
            (true, true) => "stands on a bound",
            (true, false) => "",
        };
        let (name, unit) = (&p.name, &p.unit);
        writeln!(
            out,
            "| {name} | {:.5} {unit} | {:.2} {unit} | {:.5} to {:.5} {unit} | {remark} |",
            Short(p.value),
            Short(p.uncertainty),
            Short(p.lower),
            Short(p.upper)
        )?;
    }
    writeln!(
        out,
        "\n| target | to be met | within | fitted | residual | surrogate's Q2 |\n|---|---|---|---|---|---|"
    )?;
    for t in &found.targets {
        let shown = |si: f64| Short(si / t.unit_si);
        writeln!(
            out,
            "| {} | {:.4} {unit} | {:.2} {unit} | {:.4} {unit} | {:+.1} | {:.4} |",
            t.name,
            shown(t.target),
            shown(t.tolerance),
            shown(t.fitted),
            t.residual,
            t.q2,
            unit = t.unit
        )?;
    }
    if found.parameters.len() > 1 {
        writeln!(out, "\nCorrelations of the parameters' uncertainties:\n")?;
        for (i, row) in found.correlation.iter().enumerate() {
            for (j, value) in row.iter().enumerate().take(i) {
                writeln!(
                    out,
                    "- {} and {}: {value:+.2}",
                    found.parameters[j].name, found.parameters[i].name
                )?;
            }
        }
    }
    for conflict in &found.conflicts {
        write!(out, "\n{} is not met. ", conflict.target)?;
        if conflict.alone.abs() > MISSED {
            write!(
                out,
                "No parameters within the bounds meet it: {:+.1} tolerances at best. ",
                conflict.alone
            )?;
        }
        if !conflict.costs.is_empty() {
            let cost =
                |(name, before, then): &(String, f64, f64)| format!("{name} ({before:+.1} to {then:+.1})");
            let costs: Vec<String> = conflict.costs.iter().map(cost).collect();
            write!(out, "To come as near as can be it costs {}.", costs.join(", "))?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// A number with so many significant digits as its precision says, in the shorter notation.
struct Short(f64);

impl std::fmt::Display for Short {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let digits = f.precision().unwrap_or(4).max(1);
        if self.0 == 0.0 || !self.0.is_finite() {
            return write!(f, "{}", self.0);
        }
        let exponent = self.0.abs().log10().floor() as i32;
        if (-4..6).contains(&exponent) {
            let decimals = usize::try_from(digits as i32 - 1 - exponent).unwrap_or(0);
            write!(f, "{:.decimals$}", self.0)
        } else {
            write!(f, "{:.1$e}", self.0, digits - 1)
        }
    }
}
