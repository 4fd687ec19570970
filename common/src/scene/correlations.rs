//! Reads the correlations of random variables: `[[correlations]]`, each a pair of variables with the coefficient of
//! their standard normals or their rank correlation.

use super::context::{Context, Range};
use super::quantity::NUMBER;
use super::section::Section;
use crate::random::{Correlation, GaussianCopula, RandomVariable, normal_from_rank_correlation};

/// A row of `[[correlations]]`, its names not yet resolved.
pub(super) struct CorrelationRow {
    path: String,
    pair: [String; 2],
    /// Correlation of the standard normals [1].
    coefficient: f64,
}

/// Reads `[[correlations]]` as written.
pub(super) fn correlation_rows(file: &mut Section) -> Vec<CorrelationRow> {
    let mut rows = Vec::new();
    for mut row in file.unnamed_rows("correlations") {
        let expected = "a pair of random variables, e.g. [\"rod_length\", \"friction\"]";
        let names = row.texts("variables", expected);
        let pair = names.and_then(|names| match names[..] {
            [a, b] if a != b => Some([a.to_owned(), b.to_owned()]),
            _ => {
                row.inconsistent("variables", format!("is not {expected}"));
                None
            }
        });
        let coefficient = coefficient(&mut row);
        let path = row.path.clone();
        row.finish();
        rows.extend((|| Some(CorrelationRow { path, pair: pair?, coefficient: coefficient? }))());
    }
    rows
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

/// Resolves the variables among `names`, those of all rows; `variables` are the rows without a fault.
pub(super) fn correlations(
    cx: &Context,
    rows: &[CorrelationRow],
    names: &[&str],
    variables: &[RandomVariable],
) -> Vec<Correlation> {
    let before = cx.fault_count();
    let mut found: Vec<Correlation> = Vec::new();
    for row in rows {
        let key = format!("{}.variables", row.path);
        let index = |name: &str| {
            let i = cx.reference(&key, "random variable", name, names.iter().copied())?;
            if variables.iter().any(|variable| variable.name == name && variable.distribution.is_constant()) {
                cx.inconsistent(key.clone(), format!("\"{name}\" is constant and cannot be correlated"));
                return None;
            }
            Some(i)
        };
        let [first, second] = row.pair.each_ref().map(|name| index(name));
        let Some((first, second)) = first.zip(second) else { continue };
        let same = |c: &&Correlation| (c.first.min(c.second), c.first.max(c.second));
        if found.iter().any(|c| same(&c) == (first.min(second), first.max(second))) {
            let [a, b] = &row.pair;
            cx.inconsistent(key, format!("the correlation of \"{a}\" and \"{b}\" is given twice"));
            continue;
        }
        found.push(Correlation { first, second, coefficient: row.coefficient });
    }
    if cx.fault_count() == before
        && let Err(error) = GaussianCopula::new(names.len(), &found)
    {
        let message = format!(
            "the correlation matrix is not positive definite: the correlations of \"{}\" contradict those before it; use \
             coefficients nearer to 0",
            names[error.variable]
        );
        cx.inconsistent("correlations", message);
    }
    found
}
