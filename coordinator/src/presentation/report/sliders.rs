//! The chapter of the report that answers what-if questions itself: sliders for means, spreads and thresholds, and a script that
//! predicts R(n) and the lives from the surrogates of the study, without network.
//!
//! The script needs no distributions: a variable is a table of its standardised values z over standard normals u, for five means
//! and five standard deviations, between which it interpolates by polynomials. So all distributions of a scene have sliders whose
//! moments `what-if` takes, and move as it moves them.

use super::figures::{curve, ink_of, span, words};
use super::{Axis, LifeAxis, Page, Plot, ReportInput, Series, Shape};
use crate::results::life_summary::LifeCurveRow;
use crate::statistics::design::{InputModel, fixed_bounds, with_moments};
use crate::study::{ExplicitLimitState, LEVELS};
use common::random::{Distribution, RandomVariable, standard_normal_cdf};
use common::scene::expression::read_unit;
use common::scene::{LimitState, OutputUnit, SceneSource};
use maud::{Markup, PreEscaped, html};
use serde_json::{Value, json};

const SCRIPT: &str = include_str!("chapters/sliders.js");

/// Means of the tables, in reaches of the slider from the studied mean; and exponents of 2 of their standard deviations over the
/// studied one.
const NODES: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];

/// Reach of the slider of a mean in standard deviations: the first at which all distributions exist.
const REACHES: [f64; 3] = [3.0, 1.5, 0.5];

/// Standard normals u at which the values of a variable are tabulated: from -5 to 5.
const NORMALS: std::ops::RangeInclusive<i32> = -20..=20;
const STEPS_PER_NORMAL: f64 = 4.0;

/// Adds the chapter; nothing for a study whose surrogates are not stored, or without a life. Returns the data and the script, for the
/// end of the page.
pub fn chapter(page: &mut Page, input: &ReportInput) -> Markup {
    let summary = &input.summary;
    let source = SceneSource::parse(&input.meta.scene_source, "scene.toml").ok();
    let Some((source, explicit)) = source.zip(input.explicit.as_ref()) else { return html! {} };
    if summary.curves.is_empty() || !summary.designs.is_empty() {
        return html! {};
    }
    let (inputs, axis) = (InputModel::from_scene(&input.scene), LifeAxis::new(summary));
    let variables = input.scene.variables.iter().zip(fixed_bounds(&source)).zip(&explicit.simulated);
    let variables = variables.enumerate().map(|(k, ((variable, fixed), (from, to)))| {
        let z = |x| inputs.standardised_value(k, x);
        of_variable(variable, fixed, &[*from, *to].map(z), z)
    });
    let d = inputs.dimension();
    let unit = |k: usize| (0..d).map(|i| f64::from(u8::from(i == k))).collect::<Vec<f64>>();
    let columns = (!inputs.copula.is_independent())
        .then(|| (0..d).map(|k| inputs.copula.correlate(&unit(k))).collect::<Vec<_>>());
    let states = input.scene.limit_states.iter().zip(&explicit.limit_states);
    let end = summary.reliability.last().map_or(0, |row| row.cycles);
    // A single limit state has the curve of the whole system.
    let is_drawn = |row: &&LifeCurveRow| summary.limit_states.len() > 1 || row.limit_state == "total";
    let curves = summary.curves.iter().filter(is_drawn).map(|curve| {
        let name = if curve.limit_state == "total" { input.subject() } else { &curve.limit_state };
        json!({ "name": name, "cycles": curve.cycles, "reliability": curve.reliability,
            "ink": ink_of(summary, &curve.limit_state).hex() })
    });
    let data = json!({
        "variables": variables.collect::<Value>(), "columns": columns, "levels": LEVELS, "end": end,
        "states": states.map(|(state, explicit)| of_state(input, state, explicit)).collect::<Vec<_>>(),
        "curves": curves.collect::<Vec<_>>(), "divisor": f64::from(end) / axis.place(end),
    });
    // As far to the left of the first failures as the end lies to their right.
    let first = (2.0 * span(summary, &axis).0 - axis.place(end)).max(0.0);
    let line = |LifeCurveRow { limit_state, .. }: &LifeCurveRow| {
        let mut points = curve(summary, limit_state, &axis).0;
        points.retain(|(life, _)| *life >= first);
        Series::new(limit_state, ink_of(summary, limit_state), Shape::Line(points))
    };
    let series: Vec<Series> = summary.curves.iter().filter(is_drawn).map(line).collect();
    let x = Axis::linear(axis.label, (first, axis.place(end)));
    let drawing = Plot::of_reliability("sliders", x, &series).drawing();
    page.begin("What if");
    page.add(html! {
        p.asks {
            "Other means, standard deviations and thresholds: reliability and lives follow the sliders, as the surrogates of the study \
             predict them. Pale lines: the study; full lines: with the change. The command below the table answers the same with 95 % \
             intervals."
        }
        noscript { p.none { "The sliders need JavaScript; " code { "coordinator what-if" } " answers without it." } }
        div.beside.asks id="sliders" hidden="" {
            div.controls {}
            div {
                svg viewBox=(drawing.view) font-family="sans-serif" font-size=[drawing.letters] data-axes=[&drawing.axes] role="img"
                    aria-label="Reliability over life, with the change" { (PreEscaped(&drawing.content)) }
            }
        }
    });
    html! {
        script type="application/json" id="surrogates" { (PreEscaped(data.to_string().replace('<', "\\u003c"))) } "\n"
        script { "\n" (PreEscaped(SCRIPT)) } "\n"
    }
}

/// A random variable: what its sliders show, and its standardised values for every mean and standard deviation of the nodes, or for the
/// studied ones alone where neither can be changed.
fn of_variable(
    variable: &RandomVariable,
    fixed: [bool; 2],
    simulated: &[f64],
    z: impl Fn(f64) -> f64,
) -> Value {
    let law = &variable.distribution;
    let (mean, std) = (law.parent_mean(), law.given_std());
    let table = |law: &Distribution| {
        let value = |i: i32| z(law.quantile(standard_normal_cdf(f64::from(i) / STEPS_PER_NORMAL)));
        let table: Vec<f64> = NORMALS.map(value).map(|z| (1e6 * z).round() / 1e6).collect();
        table.iter().all(|z| z.is_finite()).then_some(table)
    };
    let of_nodes = |reach: &f64| {
        let all =
            NODES.iter().flat_map(|a| NODES.iter().map(move |b| (mean + a * reach * std, std * b.exp2())));
        let tables = all.map(|(mean, std)| table(&with_moments(law, mean, std, fixed).ok()?));
        Some((*reach, tables.collect::<Option<Vec<_>>>()?))
    };
    let found = REACHES.iter().find_map(of_nodes).filter(|_| !law.is_constant());
    let (reach, tables) = found.unwrap_or((0.0, vec![table(law).unwrap_or_default()]));
    let (written, scale) = of_unit(&variable.unit);
    json!({ "name": variable.name, "unit": variable.unit, "written": written, "scale": scale, "mean": mean, "std": std,
        "reach": reach, "tables": tables, "simulated": simulated })
}

/// A limit state: its thresholds, with the distance by which their sliders move them, and its surrogate.
fn of_state(input: &ReportInput, state: &LimitState, explicit: &ExplicitLimitState) -> Value {
    let unit = input.unit_of(state);
    let symbol = unit.symbol().replace('µ', "u");
    let (written, scale) = of_output_unit(&unit, &symbol);
    json!({ "name": state.name, "title": words(&state.name), "unit": unit.symbol(), "written": written, "scale": scale,
        "thresholds": state.thresholds(), "reach": 0.5 * state.scale(),
        "sign": state.response(1.0) - state.response(0.0), "surrogate": explicit })
}

/// As [`of_unit`], of an output: those of a simulator of its own are plain numbers, whose unit is only displayed.
fn of_output_unit<'s>(unit: &OutputUnit, symbol: &'s str) -> (&'s str, f64) {
    if matches!(unit, OutputUnit::External(_)) { ("", 1.0) } else { of_unit(symbol) }
}

/// A unit as a scene writes it, empty for plain numbers, and its size [SI].
fn of_unit(unit: &str) -> (&str, f64) {
    match read_unit(unit) {
        Ok(read) if unit != "1" => (unit, read.multiply / read.divide),
        _ => ("", 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn issue_thresholds_of_a_simulators_outputs_had_a_unit_that_what_if_refuses() {
        assert_eq!(of_output_unit(&OutputUnit::External("N/mm".into()), "N/mm"), ("", 1.0));
        assert_eq!(of_output_unit(&OutputUnit::Length, "um"), ("um", 1e-6));
    }
}
