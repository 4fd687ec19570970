//! The chapter of the simulations: combinations that fail, most probable failures.

use crate::presentation::report::figures::{capital, parallel_coordinates};
use crate::presentation::report::format::{
    UNKNOWN, fixed, joined, number_of_cycles, percent, seven_digits, three_digits, unit_scale,
};
use crate::presentation::report::{Page, ReportInput, captioned, table};
use crate::results::summary_rows::{CoordinateRow, FailurePointRow};
use common::random::RandomVariable;
use maud::{Markup, html};

/// Adds the chapter of combinations that fail and of most probable failures.
pub fn failures(page: &mut Page, input: &ReportInput) {
    page.begin("Simulations and failure points");
    let combinations = page.draw(parallel_coordinates(input), "two");
    page.add(html! { (combinations) (failure_points(input)) });
}

/// The most probable failures of all limit states: one pair of columns each, one row per variable.
fn failure_points(input: &ReportInput) -> Markup {
    let points = &input.summary.failure_points;
    if points.is_empty() {
        let failed = input.summary.reliability.iter().any(|row| row.reliability.get("total") < Some(&1.0));
        return html! {
            p.none {
                @if failed { "The study stored no most probable failures." }
                @else { "No failure was found, so that there is no most probable one." }
            }
        };
    }
    let of_point =
        |point: &FailurePointRow| [format!("{}: value", point.limit_state), "standard deviations".to_owned()];
    let head: Vec<String> =
        ["variable", "unit"].map(str::to_owned).into_iter().chain(points.iter().flat_map(of_point)).collect();
    let rows = input.scene.variables.iter().map(|variable| {
        let cells = points.iter().flat_map(|point| cells_of(point, variable));
        [variable.name.clone(), variable.unit.clone()].into_iter().chain(cells)
    });
    let title = format!(
        "Most probable failure per limit state: of all failed points of the population the one nearest to the medians in the space of \
         independent standard normals. {}",
        joined(points.iter().map(|point| sentence(input, point)), " ")
    );
    captioned("failure-points", &title, table(&head, rows))
}

fn sentence(input: &ReportInput, point: &FailurePointRow) -> String {
    let by = format!("by {}, when ", number_of_cycles(point.cycles));
    let by = if input.summary.is_static() { "" } else { &by };
    let failed = if point.failed < 1e-4 { three_digits(point.failed) } else { percent(point.failed) };
    format!(
        "{}: {by}{failed} of the population {}, at a distance of {} standard deviations.",
        capital(&point.limit_state),
        if by.is_empty() { "fails" } else { "have failed" },
        fixed(point.distance, 2)
    )
}

fn cells_of(point: &FailurePointRow, variable: &RandomVariable) -> [String; 2] {
    let scale = unit_scale(&variable.unit);
    let own = point.variables.iter().find(|row| row.variable == variable.name);
    let cell = |text: &dyn Fn(&CoordinateRow) -> String| own.map_or(UNKNOWN.to_owned(), text);
    [cell(&|row| seven_digits(row.value / scale)), cell(&|row| fixed(row.normal, 2))]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::test_study;

    #[test]
    fn the_table_has_values_in_units_and_distances() {
        let mut input = test_study::report_input();
        let text = |input: &ReportInput| failure_points(input).0.replace('\u{a0}', " ");
        input.summary.failure_points.clear();
        assert!(text(&input).contains("stored no most probable failures"));
        let row = |variable: &RandomVariable| CoordinateRow {
            variable: variable.name.clone(),
            value: if variable.name == "rod_length" { 0.040_055_4 } else { variable.distribution.mean() },
            normal: if variable.name == "rod_length" { 1.0 } else { 0.0 },
        };
        input.summary.failure_points.push(FailurePointRow {
            limit_state: "wear".into(),
            cycles: 63_000,
            failed: 0.0123,
            distance: 2.345,
            variables: input.scene.variables.iter().map(row).collect(),
        });
        let found = text(&input);
        for said in [
            "<td>rod_length</td><td>mm</td>",
            ">40.0554</td>",
            "Wear: by 63 000 cycles, when 1.2 % of the population have failed",
            "distance of 2.35 standard",
        ] {
            assert!(found.contains(said), "{said}: {found}");
        }
        for at in &mut input.summary.reliability {
            at.reliability.insert("total".into(), 1.0);
        }
        input.summary.failure_points.clear();
        assert!(text(&input).contains("No failure was found"));
    }
}
