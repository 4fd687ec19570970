//! Tables of what is uncertain and of what counts as failure: random variables, correlations, outputs, limit states, life.

use crate::presentation::report::format::{UNKNOWN, count, seven_digits};
use crate::presentation::report::page::captioned;
use crate::presentation::report::tables::{table, table_of_text};
use common::random::{Correlation, RandomVariable};
use common::scene::expression::read_unit;
use common::scene::{Fails, Scene};
use maud::{Markup, Render, html};

/// Distribution, moments and bounds of every random variable, in its own unit, and the correlations.
pub fn variables(scene: &Scene) -> Markup {
    let head = ["variable", "unit", "distribution", "mean", "std", "lower bound", "upper bound", "sets"];
    let correlations = scene.correlations.iter().map(|Correlation { first, second, coefficient }| {
        let name = |k: usize| scene.variables[k].name.render();
        vec![name(*first), name(*second), seven_digits(*coefficient).render()]
    });
    html! {
        (captioned(
            "variables",
            "Random variables; of a truncated distribution mean and standard deviation are those before truncation",
            table_of_text(&head, scene.variables.iter().map(variable)),
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

fn variable(variable: &RandomVariable) -> Vec<Markup> {
    let law = &variable.distribution;
    // The unit was read when the scene was checked; "1" denotes a plain number.
    let scale = read_unit(&variable.unit).map_or(1.0, |unit| unit.multiply / unit.divide);
    let shown = |value: f64| {
        if value.is_finite() && !law.is_constant() { seven_digits(value / scale) } else { UNKNOWN.to_owned() }
    };
    let (lower, upper) = law.support();
    let sets = if variable.changes.is_empty() {
        "input of the simulator".into()
    } else {
        variable.changes.join(", ")
    };
    [
        variable.name.clone(),
        variable.unit.clone(),
        law.name().to_owned(),
        seven_digits(law.parent_mean() / scale),
        shown(law.given_std()),
        shown(lower),
        shown(upper),
        sets,
    ]
    .map(|cell| cell.render())
    .to_vec()
}

/// Outputs, limit states and life.
pub fn limits(scene: &Scene) -> Markup {
    let (body, joint) = (|k: usize| &*scene.bodies[k].name, |k: usize| &*scene.joints[k].name);
    let outputs = scene.outputs.iter().map(|output| {
        let what = output.kind.description(body, joint);
        [output.name.clone(), output.kind.unit().symbol().to_owned(), what].map(|cell| cell.render()).to_vec()
    });
    let limits = scene.limit_states.iter().map(|limit| {
        let output = &scene.outputs[limit.output];
        let unit = output.kind.unit();
        let threshold = unit.after(&seven_digits(unit.to_shown(limit.threshold)));
        let fails = match limit.fails {
            Fails::Above => "≥",
            Fails::Below => "≤",
        };
        [limit.name.clone(), output.name.clone(), format!("{fails} {threshold}")]
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
