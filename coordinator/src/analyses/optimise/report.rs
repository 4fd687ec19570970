//! The result of an optimisation as Markdown and as a page.

use super::front_figure::front_figure;
use super::result::{Advice, Bound, FrontPoint, OptimisationResult, OptimisedQuantity, OptimisedTarget};
use crate::presentation::report::PlotError;
use crate::presentation::report::decision::{DecisionPage, DecisionTable};
use crate::results::summary::StudySummary;
use common::random::{standard_normal_pdf, standard_normal_quantile};

/// Half-width of a 95 % interval in standard errors [1].
const REACH: f64 = 1.96;

/// The result, Markdown.
pub fn markdown(result: &OptimisationResult) -> String {
    let mut text = format!("# Optimum\n\n{}\n", verdict(result));
    for table in tables(result) {
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        text +=
            &format!("\n## {}\n\n{}{}", table.heading, line(&table.head), "|---".repeat(table.head.len()));
        text += "|\n";
        table.rows.iter().for_each(|row| text += &line(row));
    }
    text += "\n## Errors and prices\n\n";
    notes(result).iter().for_each(|note| text += &format!("- {note}\n"));
    text
}

/// The result as a page with the reliability `curves` of the study and of the optimum.
///
/// # Errors
/// [`PlotError`].
pub fn page(
    result: &OptimisationResult,
    scene: &str,
    curves: Vec<(String, StudySummary)>,
) -> Result<DecisionPage, PlotError> {
    Ok(DecisionPage {
        title: "Optimum".to_owned(),
        subtitle: format!("Scene: {scene}"),
        sentences: std::iter::once(verdict(result).replace("**", "")).chain(notes(result)).collect(),
        figures: front_figure(result)?.into_iter().collect(),
        curves,
        tables: tables(result),
    })
}

/// Cost and confirmation in sentences.
fn verdict(result: &OptimisationResult) -> String {
    let added = match result.evaluations.added {
        1 => "1 simulation was added".to_owned(),
        n => format!("{n} simulations were added"),
    };
    let work = format!("{added} to the {} that the study had.", result.evaluations.study);
    if !result.feasible {
        let short = |target: &OptimisedTarget| {
            let reached = with_interval(target.reliability, target.standard_error);
            format!("{} is {reached} there, the target is {}", target.name, share(target.target))
        };
        let missed: Vec<String> =
            result.targets.iter().filter(|target| target.reliability < target.target).map(short).collect();
        return format!(
            "**No design within the bounds meets every target.** The design below comes nearest: {}. {} {work}",
            if missed.is_empty() {
                "a target is missed by less than its error".to_owned()
            } else {
                missed.join("; ")
            },
            confirmation(result)
        );
    }
    let error = if result.grades.is_none() && result.cost_standard_error > 0.0 {
        format!(
            " ± {} (95 %, from the errors of the reliabilities)",
            rounded(REACH * result.cost_standard_error)
        )
    } else {
        String::new()
    };
    format!(
        "Cost {} with the design of the study, {}{error} at the optimum. {} {work}",
        number(result.cost_before),
        number(result.cost),
        confirmation(result)
    )
}

fn confirmation(result: &OptimisationResult) -> String {
    if result.confirmed {
        "Simulations at this design confirm its reliability.".to_owned()
    } else {
        format!("This design is not confirmed by simulations: {}.", result.stopped_because)
    }
}

/// Tables of quantities, reliabilities and the front.
fn tables(result: &OptimisationResult) -> Vec<DecisionTable> {
    let table = |heading: &str, head: &[&str], rows: Vec<Vec<String>>| DecisionTable {
        heading: heading.to_owned(),
        head: head.iter().map(|cell| (*cell).to_owned()).collect(),
        rows,
    };
    let found = if result.feasible { "optimum" } else { "nearest" };
    let (cost, counted) = (format!("cost, {found}"), format!("{found}, counted"));
    let mut tables = vec![
        table(
            "Design",
            &["quantity", "study", found, "allowed", "unit", "change", "cost, study", &cost],
            result.quantities.iter().map(quantity_row).collect(),
        ),
        table(
            "Reliability",
            &["reliability", "target", "study", found, &counted, "state"],
            result.targets.iter().map(target_row).collect(),
        ),
    ];
    if result.feasible {
        let head = ["failure probability allowed", "targets", "least cost"];
        tables.push(table("Cost against reliability", &head, result.front.iter().map(front_row).collect()));
    }
    tables
}

fn quantity_row(quantity: &OptimisedQuantity) -> Vec<String> {
    let grade = quantity.grade.as_ref().map_or(String::new(), |grade| format!(" ({grade})"));
    let bound = match quantity.on_bound {
        None => "",
        Some(Bound::Lower) => ", on its lower bound",
        Some(Bound::Upper) => ", on its upper bound",
    };
    let advice = match quantity.advice {
        Advice::Tighten => "tighten",
        Advice::Loosen => "loosen",
        Advice::Raise => "raise",
        Advice::Lower => "lower",
        Advice::Keep => "keep",
    };
    vec![
        quantity.name.clone(),
        number(quantity.before),
        format!("{}{grade}", number(quantity.after)),
        format!("{} to {}", number(quantity.lower), number(quantity.upper)),
        quantity.unit.clone(),
        format!("{advice}{bound}"),
        number(quantity.cost_before),
        number(quantity.cost_after),
    ]
}

fn target_row(target: &OptimisedTarget) -> Vec<String> {
    let state = match (target.met, target.active) {
        (false, _) => "missed",
        (true, true) => "met, decides the optimum",
        (true, false) => "met with a reserve",
    };
    vec![
        target.name.clone(),
        share(target.target),
        with_interval(target.before, target.standard_error_before),
        with_interval(target.reliability, target.standard_error),
        with_interval(target.counted, target.counted_standard_error),
        state.to_owned(),
    ]
}

fn front_row(point: &FrontPoint) -> Vec<String> {
    let targets: Vec<String> = point.targets.iter().map(|target| share(*target)).collect();
    let factor = match point.factor {
        factor if (factor - 1.0).abs() < 1e-12 => "as targeted".to_owned(),
        factor => format!("{factor} times as targeted"),
    };
    let cost = point.cost.map_or("no design within the bounds".to_owned(), number);
    vec![factor, targets.join(", "), cost]
}

/// Sentences on errors and prices.
fn notes(result: &OptimisationResult) -> Vec<String> {
    let mut notes = vec![
        "Reliabilities have 95 % intervals. That of the optimum is integrated along lines over the surrogates; its interval \
         contains the surrogate error. The counted one is that of a population that the surrogates classify at the optimum."
            .to_owned(),
    ];
    if let Some(grades) = result.grades {
        let proof = if grades.proved {
            "on the surrogates no other combination of the allowed grades is cheaper"
        } else {
            "not all were examined, so a cheaper one may exist"
        };
        notes.push(format!(
            "{} combinations of grades were examined: {proof}. If every tolerance between the grades were allowed, the cost \
             would be {}.",
            grades.examined,
            number(grades.relaxed_cost)
        ));
    }
    if !result.feasible {
        return notes;
    }
    for target in result.targets.iter().filter(|target| target.multiplier > 0.0) {
        let allowed = 1.0 - target.target;
        let beta = -standard_normal_quantile(allowed);
        let tenth = target.multiplier * 0.1 * allowed / standard_normal_pdf(beta);
        notes.push(format!(
            "Price of {}: to allow a tenth less than the failure probability {} costs about {} more (Lagrange multiplier {} \
             per unit of the reliability index).",
            target.name,
            number(allowed),
            number(tenth),
            number(target.multiplier)
        ));
    }
    let continuous =
        if result.grades.is_some() { ", with every tolerance between the grades allowed" } else { "" };
    notes.push(format!(
        "The costs against reliability are optima on the surrogates{continuous}; no simulation confirms them."
    ));
    notes
}

/// A number with four digits.
fn number(value: f64) -> String {
    with_digits(value, 4)
}

/// An error with two digits.
fn rounded(value: f64) -> String {
    with_digits(value, 2)
}

fn with_digits(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let exponent = value.abs().log10().floor() as i32;
    if (-3..6).contains(&exponent) {
        let decimals = usize::try_from(digits - 1 - exponent).unwrap_or(0);
        format!("{value:.decimals$}")
    } else {
        format!("{value:.0$e}", usize::try_from(digits - 1).unwrap_or(0))
    }
}

/// A reliability with as many digits as its distance from one needs.
fn share(r: f64) -> String {
    let distance = (1.0 - r).min(r).max(1e-12);
    let decimals = (2.0 - distance.log10().floor()).clamp(2.0, 12.0) as usize;
    let text = format!("{r:.decimals$}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A reliability with its 95 % interval; the digits follow the interval.
fn with_interval(r: f64, standard_error: f64) -> String {
    let width = REACH * standard_error;
    if width.is_nan() || width <= 1e-9 {
        return if 1.0 - r < 1e-9 { "1".to_owned() } else { share(r) };
    }
    let decimals = (1.0 - width.log10().floor()).clamp(1.0, 12.0) as usize;
    format!("{r:.decimals$} ± {width:.decimals$}")
}
