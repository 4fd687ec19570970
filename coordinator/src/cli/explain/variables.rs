//! The random variables: distribution, mean, standard deviation and bounds, in the unit of the scene file.

use common::random::Correlation;
use common::scene::Scene;
use coordinator::presentation::report::format::{seven_digits, unit_scale};
use std::fmt::Write;

pub(super) fn variables(out: &mut String, scene: &Scene) -> std::fmt::Result {
    if scene.variables.is_empty() {
        return writeln!(out, "No random variables: a study of this scene has nothing to vary.\n");
    }
    let dependence =
        if scene.correlations.is_empty() { "independent" } else { "dependent by a Gaussian copula" };
    writeln!(out, "Random variables: {dependence}")?;
    let width = scene.variables.iter().map(|variable| variable.name.len()).max().unwrap_or(0);
    for variable in &scene.variables {
        let law = &variable.distribution;
        // The unit was read when the scene was checked; "1" denotes a plain number.
        let scale = unit_scale(&variable.unit);
        let shown = |value: f64| digits(value / scale);
        let unit = if variable.unit == "1" { String::new() } else { format!(" {}", variable.unit) };
        let (mean, std) = (shown(law.parent_mean()), shown(law.given_std()));
        let bounds = match law.support() {
            _ if law.is_constant() => String::new(),
            (lower, upper) if lower.is_finite() && upper.is_finite() => {
                format!(", from {} to {}", shown(lower), shown(upper))
            }
            (lower, _) if lower.is_finite() => format!(", from {}", shown(lower)),
            (_, upper) if upper.is_finite() => format!(", to {}", shown(upper)),
            _ => String::new(),
        };
        let spread = if law.is_constant() { String::new() } else { format!(", std {std}") };
        writeln!(out, "  {:width$}  {}, mean {mean}{spread}{bounds}{unit}", variable.name, law.name())?;
    }
    let name = |k: usize| &scene.variables[k].name;
    for Correlation { first, second, coefficient } in &scene.correlations {
        let coefficient = digits(*coefficient);
        writeln!(out, "  correlation of {} and {}, as normals: {coefficient}", name(*first), name(*second))?;
    }
    writeln!(out)
}

/// The value with seven digits, in the signs of a keyboard.
fn digits(value: f64) -> String {
    seven_digits(value).replace('\u{2212}', "-")
}
