//! The result of an optimisation as Markdown.

use super::result::{Advice, Bound, OptimisationResult, OptimisedQuantity, OptimisedTarget};
use common::random::{standard_normal_pdf, standard_normal_quantile};
use std::fmt::Write;

/// Half-width of a 95 % interval in standard errors [1].
const REACH: f64 = 1.96;

/// The result, Markdown.
pub fn markdown(result: &OptimisationResult) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = write_all(&mut text, result);
    text
}

fn write_all(out: &mut String, result: &OptimisationResult) -> std::fmt::Result {
    writeln!(out, "# Optimum\n\n{}\n", verdict(result))?;
    writeln!(out, "| quantity | study | optimum | unit | allowed | change | cost: study | optimum |")?;
    writeln!(out, "|---|---|---|---|---|---|---|---|")?;
    for quantity in &result.quantities {
        writeln!(out, "{}", quantity_row(quantity))?;
    }
    writeln!(out, "\n| reliability | target | study | optimum | counted there | |\n|---|---|---|---|---|---|")?;
    for target in &result.targets {
        writeln!(out, "{}", target_row(target))?;
    }
    writeln!(
        out,
        "\nReliabilities with their 95 % intervals. The optimum's is integrated along lines over the surrogates; its interval \
         contains the surrogate error. The one counted there is that of a population that the surrogates classify."
    )?;
    if let Some(grades) = result.grades {
        let proof = if grades.proved {
            "no other combination of the allowed grades is cheaper, by the surrogates"
        } else {
            "a cheaper combination of the allowed grades may exist"
        };
        writeln!(
            out,
            "\nGrades: {} combinations examined; {proof}. With any tolerance between the grades the cost would be {}.",
            grades.examined,
            number(grades.relaxed_cost)
        )?;
    }
    prices(out, result)
}

/// Cost and confirmation in sentences.
fn verdict(result: &OptimisationResult) -> String {
    let added = match result.evaluations.added {
        1 => "1 simulation was added".to_owned(),
        n => format!("{n} simulations were added"),
    };
    let work = format!("{added} to the {} of the study.", result.evaluations.study);
    if !result.feasible {
        let gap = result.targets.iter().filter(|target| !target.met);
        let short: Vec<String> = gap
            .map(|target| {
                format!(
                    "{} reaches {} there, {} is wanted",
                    target.name,
                    with_interval(target.reliability, target.standard_error),
                    share(target.target)
                )
            })
            .collect();
        return format!(
            "**No design within the bounds meets every target.** The design below is the one whose worst target comes \
             nearest: {}. {work}",
            if short.is_empty() { "by the surrogates a target is just missed".to_owned() } else { short.join("; ") }
        );
    }
    let confirmed = if result.confirmed {
        "Confirmed by simulations at the optimum: the reliability found there agrees with the one the optimum was found with."
            .to_owned()
    } else {
        format!("Not confirmed by simulations: {}.", result.stopped_because)
    };
    let error = if result.grades.is_none() && result.cost_standard_error > 0.0 {
        format!(" ± {} (95 %, from the errors of the reliabilities)", number(REACH * result.cost_standard_error))
    } else {
        String::new()
    };
    format!("Cost {} at the study's design, {}{error} at the optimum. {confirmed} {work}", number(result.cost_before), number(result.cost))
}

fn quantity_row(quantity: &OptimisedQuantity) -> String {
    let OptimisedQuantity { name, unit, before, after, lower, upper, cost_before, cost_after, .. } = quantity;
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
    format!(
        "| {name} | {} | {}{grade} | {unit} | {} to {} | {advice}{bound} | {} | {} |",
        number(*before),
        number(*after),
        number(*lower),
        number(*upper),
        number(*cost_before),
        number(*cost_after)
    )
}

fn target_row(target: &OptimisedTarget) -> String {
    let state = match (target.met, target.active) {
        (false, _) => "missed",
        (true, true) => "met, holds the optimum",
        (true, false) => "met with a reserve",
    };
    format!(
        "| {} | {} | {} | {} | {} | {state} |",
        target.name,
        share(target.target),
        with_interval(target.before, target.standard_error_before),
        with_interval(target.reliability, target.standard_error),
        with_interval(target.counted, target.counted_standard_error)
    )
}

/// The price of reliability: multipliers and front.
fn prices(out: &mut String, result: &OptimisationResult) -> std::fmt::Result {
    if !result.feasible {
        return Ok(());
    }
    writeln!(out, "\n## Price of reliability\n")?;
    for target in result.targets.iter().filter(|target| target.multiplier > 0.0) {
        let allowed = 1.0 - target.target;
        let beta = -standard_normal_quantile(allowed);
        let by_tenth = target.multiplier * 0.1 * allowed / standard_normal_pdf(beta);
        writeln!(
            out,
            "- {}: a failure probability smaller by a tenth of {} costs about {} more (Lagrange multiplier {} per unit of the \
             reliability index).",
            target.name,
            probability(allowed),
            number(by_tenth),
            number(target.multiplier)
        )?;
    }
    writeln!(out, "\n| failure probability allowed | targets | least cost |\n|---|---|---|")?;
    for point in &result.front {
        let targets: Vec<String> = point.targets.iter().map(|target| share(*target)).collect();
        let factor = match point.factor {
            factor if factor == 1.0 => "as targeted".to_owned(),
            factor => format!("times {factor}"),
        };
        let cost = point.cost.map_or("no design within the bounds".to_owned(), number);
        writeln!(out, "| {factor} | {} | {cost} |", targets.join(", "))?;
    }
    writeln!(
        out,
        "\nThe front is solved on the surrogates, with continuous quantities; only the optimum was confirmed."
    )
}

/// A number with four digits.
fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let exponent = value.abs().log10().floor() as i32;
    if (-4..6).contains(&exponent) {
        let decimals = usize::try_from(3 - exponent).unwrap_or(0);
        format!("{value:.decimals$}")
    } else {
        format!("{value:.3e}")
    }
}

/// A reliability with as many digits as its distance from one needs.
fn share(r: f64) -> String {
    let distance = (1.0 - r).min(r).max(1e-15);
    let decimals = (2.0 - distance.log10().floor()).clamp(2.0, 15.0) as usize;
    let text = format!("{r:.decimals$}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn probability(p: f64) -> String {
    if p < 1e-3 { format!("{p:.2e}") } else { number(p) }
}

/// A reliability with its 95 % interval; the digits follow the interval.
fn with_interval(r: f64, standard_error: f64) -> String {
    let width = REACH * standard_error;
    if !(width > 0.0) {
        return share(r);
    }
    let decimals = (1.0 - width.log10().floor()).clamp(1.0, 15.0) as usize;
    format!("{r:.decimals$} ± {width:.decimals$}")
}
