//! Reads the correlations of random variables: `[[correlations]]`, each a pair of variables with the coefficient of
//! their standard normals or their rank correlation.

use super::faults::FaultKind;
use super::quantity::NUMBER;
use super::read::{Context, Range};
use super::section::Section;
use crate::random::{Correlation, GaussianCopula, RandomVariable, normal_from_rank_correlation};

/// A row of `[[correlations]]`, its variables not yet looked up.
pub(super) struct CorrelationRow {
    path: String,
    pair: [String; 2],
    /// Of the standard normals.
    coefficient: f64,
}

/// Reads `[[correlations]]` as written.
pub(super) fn correlation_rows(cx: &mut Context, file: &mut Section) -> Vec<CorrelationRow> {
    let mut rows = Vec::new();
    for mut row in file.unnamed_rows(cx, "correlations") {
        let expected = "a pair of random variables, e.g. [\"rod_length\", \"friction\"]";
        let names = row.texts(cx, "variables", expected);
        let pair = names.and_then(|names| match names[..] {
            [a, b] if a != b => Some([a.to_owned(), b.to_owned()]),
            _ => {
                cx.inconsistent(row.key("variables"), format!("is not {expected}"));
                None
            }
        });
        let coefficient = coefficient(cx, &mut row);
        let path = row.path.clone();
        row.finish(cx);
        rows.extend((|| Some(CorrelationRow { path, pair: pair?, coefficient: coefficient? }))());
    }
    rows
}

/// The coefficient of the standard normals, from `coefficient` or `rank`.
fn coefficient(cx: &mut Context, row: &mut Section) -> Option<f64> {
    let key = match (row.get("coefficient"), row.get("rank")) {
        (Some(_), None) => "coefficient",
        (None, Some(_)) => "rank",
        (Some(_), Some(_)) => {
            cx.inconsistent(&row.path, "give either coefficient or rank, not both");
            return None;
        }
        (None, None) => {
            let expected = "a number between -1 and 1, or rank".to_owned();
            cx.fault(row.key("coefficient"), FaultKind::Missing { expected });
            return None;
        }
    };
    let value = row.quantity(cx, key, NUMBER, Range::Any)?;
    if value.abs() >= 1.0 {
        let allowed = "> -1 and < 1".to_owned();
        cx.fault(row.key(key), FaultKind::OutOfRange { value: value.to_string(), allowed });
        return None;
    }
    Some(if key == "rank" { normal_from_rank_correlation(value) } else { value })
}

/// Looks the variables up among `names`, all that the scene has; `variables` are those of them without a fault.
pub(super) fn correlations(
    cx: &mut Context,
    rows: &[CorrelationRow],
    names: &[&str],
    variables: &[RandomVariable],
) -> Vec<Correlation> {
    let before = cx.faults.len();
    let mut found: Vec<Correlation> = Vec::new();
    for row in rows {
        let key = format!("{}.variables", row.path);
        let index = |cx: &mut Context, name: &str| {
            let i = cx.reference(&key, "random variable", name, names.iter().copied())?;
            if variables.iter().any(|variable| variable.name == name && variable.distribution.is_constant()) {
                cx.inconsistent(key.clone(), format!("\"{name}\" is constant: nothing depends on it"));
                return None;
            }
            Some(i)
        };
        let [first, second] = row.pair.each_ref().map(|name| index(cx, name));
        let Some((first, second)) = first.zip(second) else { continue };
        let same = |c: &&Correlation| (c.first.min(c.second), c.first.max(c.second));
        if found.iter().any(|c| same(&c) == (first.min(second), first.max(second))) {
            let [a, b] = &row.pair;
            cx.inconsistent(key, format!("the correlation of \"{a}\" and \"{b}\" is given twice"));
            continue;
        }
        found.push(Correlation { first, second, coefficient: row.coefficient });
    }
    if cx.faults.len() == before
        && let Err(error) = GaussianCopula::new(names.len(), &found)
    {
        let message = format!(
            "no variables can be correlated like this: those of \"{}\" contradict those before it (the matrix is not \
             positive definite); use coefficients nearer to 0",
            names[error.variable]
        );
        cx.inconsistent("correlations", message);
    }
    found
}
