//! Reads the correlations of random variables: `[[correlations]]`, each a pair of variables with the coefficient of
//! their standard normals or their rank correlation.

use super::context::Range;
use super::quantity::NUMBER;
use super::section::Section;
use super::variables::Variable;
use crate::random::{Correlation, GaussianCopula, normal_from_rank_correlation};

/// Reads `[[correlations]]` of the `variables`, each with its name; in a scene that `is_faulty` their names may be wrong only because of that.
pub(super) fn correlations(
    file: &mut Section,
    variables: &[(&str, Option<Variable>)],
    is_faulty: bool,
) -> Vec<Correlation> {
    let before = file.cx.fault_count();
    let mut found: Vec<Correlation> = Vec::new();
    for mut row in file.unnamed_rows("correlations") {
        let expected = "a pair of random variables, e.g. [\"rod_length\", \"friction\"]";
        let names = row.texts("variables", expected);
        let pair = names.and_then(|names| match names[..] {
            [a, b] if a != b => Some([a, b]),
            _ => {
                row.inconsistent("variables", format!("is not {expected}"));
                None
            }
        });
        let coefficient = coefficient(&mut row);
        row.finish();
        let (Some([a, b]), Some(coefficient), false) = (pair, coefficient, is_faulty) else { continue };
        let index = |name: &str| {
            let names = variables.iter().map(|(name, _)| *name);
            let i = row.reference("variables", "random variable", name, names)?;
            if variables[i].1.as_ref().is_some_and(|(variable, _)| variable.distribution.is_constant()) {
                row.inconsistent("variables", format!("\"{name}\" is constant and cannot be correlated"));
                return None;
            }
            Some(i)
        };
        let (first, second) = (index(a), index(b));
        let Some((first, second)) = first.zip(second) else { continue };
        if found.iter().any(|c| [(first, second), (second, first)].contains(&(c.first, c.second))) {
            row.inconsistent("variables", format!("the correlation of \"{a}\" and \"{b}\" is given twice"));
            continue;
        }
        found.push(Correlation { first, second, coefficient });
    }
    if file.cx.fault_count() == before
        && let Err(error) = GaussianCopula::new(variables.len(), &found)
    {
        let message = format!(
            "the correlation matrix is not positive definite: the correlations of \"{}\" contradict those before it; use \
             coefficients nearer to 0",
            variables[error.variable].0
        );
        file.inconsistent("correlations", message);
    }
    found
}

/// The coefficient of the standard normals, from `coefficient` or `rank`.
fn coefficient(row: &mut Section) -> Option<f64> {
    let key = match (row.get("coefficient"), row.get("rank")) {
        (Some(_), None) => "coefficient",
        (None, Some(_)) => "rank",
        (Some(_), Some(_)) => {
            row.inconsistent_table("give either coefficient or rank, not both");
            return None;
        }
        (None, None) => {
            row.missing("coefficient", "a number between -1 and 1, or rank");
            return None;
        }
    };
    let value = row.quantity(key, NUMBER, Range::Any)?;
    if value.abs() >= 1.0 {
        row.out_of_range(key, value.to_string(), "> -1 and < 1");
        return None;
    }
    Some(if key == "rank" { normal_from_rank_correlation(value) } else { value })
}
