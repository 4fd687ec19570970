//! Figures of the influence of the variables: derivatives of the failure probabilities, and contributions to the variance
//! of the outputs.

use super::{file_name, governing_cycles, words};
use crate::presentation::report::format::number_of_cycles;
use crate::presentation::report::{BarPair, Bars, Figure, ReportInput};
use crate::results::summary::{SensitivityRow, SobolRow};

/// Bars shown per figure.
const SHOWN: usize = 12;

/// The checkpoint of `all` nearest to the governing one.
fn nearest_to_governing(input: &ReportInput, all: impl Iterator<Item = u32>) -> Option<u32> {
    let governing = governing_cycles(input);
    all.min_by_key(|cycles| cycles.abs_diff(governing))
}

fn finite(value: f64) -> f64 {
    if value.is_finite() { value } else { 0.0 }
}

/// The rows of one limit state at the checkpoint nearest to the governing one where derivatives are known, longest bar first.
pub fn rows_at_governing<'a>(input: &'a ReportInput, limit_state: &str) -> Vec<&'a SensitivityRow> {
    let all = input.summary.sensitivity.iter().filter(|row| row.limit_state == limit_state);
    let known = all.clone().filter(|row| row.is_known()).map(|row| row.cycles);
    let Some(cycles) = nearest_to_governing(input, known) else { return vec![] };
    let mut rows: Vec<_> = all.filter(|row| row.cycles == cycles).collect();
    rows.sort_by(|a, b| finite(b.strength()).total_cmp(&finite(a.strength())));
    rows
}

/// Indices of the variables that are not constant, the one with the largest effect on any failure probability first; in the order of
/// the scene where no effects are known.
pub fn by_influence(input: &ReportInput) -> Vec<usize> {
    let variables = &input.scene.variables;
    let rows: Vec<&SensitivityRow> =
        input.summary.curve_names().flat_map(|name| rows_at_governing(input, name)).collect();
    let effect = |k: &usize| {
        let own = rows.iter().filter(|row| row.variable == variables[*k].name);
        own.map(|row| finite(row.strength())).fold(0.0, f64::max)
    };
    let mut all: Vec<usize> =
        (0..variables.len()).filter(|k| !variables[*k].distribution.is_constant()).collect();
    all.sort_by(|a, b| effect(b).total_cmp(&effect(a)));
    all
}

/// One figure per limit state with derivatives of its failure probability.
pub fn sensitivities(input: &ReportInput) -> Vec<Figure> {
    let mut figures = Vec::new();
    for name in input.summary.curve_names() {
        let rows = rows_at_governing(input, name);
        let Some(first) = rows.first() else { continue };
        let cause = if name == "total" { "any limit state" } else { name };
        let caption = format!(
            "Derivatives of the probability of failure by {cause} at {} by the mean and the standard deviation of a variable, times \
             its standard deviation: to first order the change for an increase by one, with the bounds of bounded variables held; \
             positive: more failures. Thin lines: 1.96 standard errors of sampling alone. The {} largest of {}.",
            number_of_cycles(first.cycles),
            rows.len().min(SHOWN),
            rows.len()
        );
        // The errors of the derivatives, on the scale of the scaled derivatives.
        let pair = |row: &&SensitivityRow| BarPair {
            name: words(&row.variable),
            values: [finite(row.scaled.d_pf_d_mean), finite(row.scaled.d_pf_d_std)],
            errors: row.scaled_errors().map(finite),
        };
        let (figure, all) = (&format!("sensitivity-{}", file_name(name)), rows.iter().map(pair).collect());
        let (labels, axis) = (["mean", "std"], "derivative of failure probability, times std");
        let bars = Bars { figure, labels, axis, signed: true, all, shown: SHOWN };
        figures.push(bars.figure(&format!("Sensitivity of failure by {cause}"), &caption));
    }
    figures
}

/// One figure per limit state with Sobol indices of its output.
pub fn variance_contributions(input: &ReportInput) -> Vec<Figure> {
    let mut figures = Vec::new();
    for state in &input.scene.limit_states {
        let all = input.summary.sobol.iter().filter(|row| row.limit_state == state.name);
        let Some(cycles) = nearest_to_governing(input, all.clone().map(|row| row.cycles)) else { continue };
        let mut rows: Vec<&SobolRow> = all.filter(|row| row.cycles == cycles).collect();
        rows.sort_by(|a, b| finite(b.total).total_cmp(&finite(a.total)));
        let output = input.output_of(state);
        let caption = format!(
            "Sobol indices of the surrogate at {}: share of the variance of the {output} due to a variable alone \
             (first order) and with its interactions (total). Thin lines: 1.96 standard errors by sampling and surrogate. The {} largest of {}.",
            number_of_cycles(cycles),
            rows.len().min(SHOWN),
            rows.len()
        );
        let pair = |row: &&SobolRow| BarPair {
            name: words(&row.variable),
            values: [finite(row.first_order), finite(row.total)],
            errors: [finite(row.standard_error.first_order), finite(row.standard_error.total)],
        };
        let (figure, all) = (&format!("sobol-{}", file_name(&state.name)), rows.iter().map(pair).collect());
        let (labels, axis) = (["first order", "total"], "share of the variance");
        let bars = Bars { figure, labels, axis, signed: false, all, shown: SHOWN };
        figures.push(bars.figure(&format!("Variance contributions (Sobol): {output}"), &caption));
    }
    figures
}
