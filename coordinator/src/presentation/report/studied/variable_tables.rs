//! Tables of what is uncertain and of what counts as failure: random variables, correlations, outputs, limit states, life.

use crate::presentation::report::format::{UNKNOWN, count, seven_digits};
use crate::presentation::report::page::captioned;
use crate::presentation::report::tables::{table, table_of_text};
use crate::results::scene_summary::VariableRow;
use crate::results::summary::StudySummary;
use common::random::{Correlation, RandomVariable};
use common::scene::expression::read_unit;
use common::scene::{Fails, Scene};
use maud::{Markup, Render, html};

/// Distribution, moments and bounds of every random variable, in the unit in which it is displayed, and the correlations.
pub fn variables(scene: &Scene, summary: &StudySummary) -> Markup {
    let head = ["variable", "unit", "distribution", "mean", "std", "lower bound", "upper bound", "sets"];
    let correlations = scene.correlations.iter().map(|Correlation { first, second, coefficient }| {
        let name = |k: usize| scene.variables[k].name.render();
        vec![name(*first), name(*second), seven_digits(*coefficient).render()]
    });
    let rows = scene.variables.iter().zip(&summary.variables).map(|(variable, row)| cells(variable, row));
    html! {
        (captioned(
            "variables",
            "Random variables; of a truncated distribution mean and standard deviation are those before truncation",
            table_of_text(&head, rows),
        ))
        @if !scene.correlations.is_empty() {
            (captioned(
                "correlations",
                "Correlations of the standard normals behind the variables (Gaussian copula); all other pairs are independent",
                table(&["variable", "and", "coefficient"], correlations),
            ))
        }
    }
}

fn cells(variable: &RandomVariable, row: &VariableRow) -> Vec<Markup> {
    // The unit was read when the scene was checked; "1" denotes a plain number.
    let scale = read_unit(&variable.unit).map_or(1.0, |unit| unit.multiply / unit.divide);
    let is_constant = variable.distribution.is_constant();
    let shown = |value: Option<f64>| {
        let value = value.filter(|_| !is_constant);
        value.map_or(UNKNOWN.to_owned(), |value| seven_digits(value / scale))
    };
    let sets = if variable.changes.is_empty() {
        "input of the simulator".into()
    } else {
        variable.changes.join(", ")
    };
    [
        row.name.clone(),
        variable.unit.clone(),
        row.distribution.clone(),
        seven_digits(row.mean / scale),
        shown(Some(row.std)),
        shown(row.lower),
        shown(row.upper),
        sets,
    ]
    .map(|cell| cell.render())
    .to_vec()
}

/// Outputs, limit states and life.
pub fn limits(scene: &Scene, summary: &StudySummary) -> Markup {
    let (body, joint) = (|k: usize| &*scene.bodies[k].name, |k: usize| &*scene.joints[k].name);
    let outputs = scene.outputs.iter().map(|output| {
        let what = output.kind.description(body, joint);
        [output.name.clone(), output.kind.unit().symbol().to_owned(), what].map(|cell| cell.render()).to_vec()
    });
    let limits = summary.limits.iter().zip(&scene.limit_states).map(|(row, limit)| {
        let unit = scene.outputs[limit.output].kind.unit();
        let threshold = unit.after(&seven_digits(unit.to_shown(limit.threshold)));
        let fails = match row.fails {
            Fails::Above => "≥",
            Fails::Below => "≤",
        };
        [row.name.clone(), row.output.clone(), format!("{fails} {threshold}")]
            .map(|cell| cell.render())
            .to_vec()
    });
    let life = &scene.life;
    html! {
        (captioned("outputs", "Outputs at every checkpoint", table_of_text(&["output", "unit", "quantity"], outputs)))
        (captioned("limits", "Limit states", table(&["limit state", "output", "failed where the output is"], limits)))
        @if life.cycles > 1 {
            p {
                "Life studied: " (count(life.cycles.into())) " cycles"
                @if life.period > 0.0 { " of " (seven_digits(life.period)) " s" }
                ", with a checkpoint every " (count(life.checkpoint_every.into())) " cycles"
                @if life.settle_cycles > 0 { "; cycles that settle the motion before the first measured one: " (life.settle_cycles) }
                "."
            }
        }
    }
}
