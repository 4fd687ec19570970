//! The answer of `coordinator test-plan` with its tables.

use super::{GroupRow, PlanRow, PriorRow, TestPlanReport};
use crate::presentation::report::answer::{Answer, AnswerPart, Table};
use crate::presentation::report::format::{count, near_one, percent, significant, three_digits, whole};

/// The plans as an answer.
pub fn answer(report: &TestPlanReport) -> Answer {
    let TestPlanReport { reliability, at, confidence, plans, .. } = report;
    let has_prior = report.prior.is_some();
    let has_inspections = plans.iter().any(|plan| plan.mean_cycles.is_some());
    let mut head = vec!["cycles", "failures allowed", "units", "90 % pass with R"];
    head.extend(has_inspections.then_some("mean length at R0"));
    if has_prior {
        head.extend([
            "units with the study",
            "passed",
            "R < R0 if passed",
            "failed and R >= R0",
            "passed at R = R0",
        ]);
    }
    let row = |plan: &PlanRow| {
        let PlanRow { cycles, allowed, units, passes, mean_cycles, .. } = plan;
        let mut cells = vec![whole(*cycles), allowed.to_string(), count(*units), significant(*passes, 6)];
        cells.extend(mean_cycles.map(whole));
        if let Some(prior) = plan.with_prior {
            cells.push(count(prior.units));
            let shares = [prior.passed, prior.wrongly_passed, prior.wrongly_failed, prior.passed_at_limit];
            cells.extend(shares.map(percent));
        }
        cells
    };
    let mut parts = vec![AnswerPart::Table(Table::new("", head, plans.iter().map(row)).with_left(&[]))];
    if let Some(size) = report.group {
        let rows = report.groups.iter().map(|GroupRow { groups, cycles, passes }| {
            let units = groups * size;
            vec![groups.to_string(), units.to_string(), whole(*cycles), significant(*passes, 6)]
        });
        let heading = format!("Sudden death: groups of {size}, each up to its first failure");
        let head = ["groups", "units", "mean first failure at or after [cycles]", "90 % pass with R"];
        parts.push(AnswerPart::Table(Table::new(heading, head, rows).with_left(&[])));
    }
    parts.push(AnswerPart::Notes("What is assumed", assumptions(report, has_inspections)));
    let (life, sure) = (whole(*at), percent(*confidence));
    let subtitle =
        "Every unit runs the cycles of its plan; the test is passed with at most the failures allowed";
    Answer {
        name: "test-plan".to_owned(),
        title: format!("Tests that demonstrate R({life}) >= {reliability} with a confidence of {sure}"),
        subtitle: subtitle.to_owned(),
        parts,
        ..Answer::default()
    }
}

fn assumptions(report: &TestPlanReport, has_inspections: bool) -> Vec<String> {
    let mut notes = vec![
        "Units of the same population fail independently; without prior an R below R0 passes in at most 1 - C of all tests."
            .to_owned(),
    ];
    let origin = if report.shape_of_study { "by the study's lives at R = 0.99 and 0.5" } else { "as given" };
    notes.extend(report.shape.map(|shape| {
        format!(
            "Tests of other lengths than the life: Weibull lives of shape {}, {origin}. Longer tests need fewer units than this only if \
             the shape is not smaller.",
            three_digits(shape)
        )
    }));
    let groups = "Groups: the mean is that of the first failures to the power of the shape; a group that is stopped earlier counts \
                  with its cycles.";
    notes.extend(report.group.map(|_| groups.to_owned()));
    let inspections = "Inspections find every failure that has happened; the test ends at the first one with more failures than \
                       allowed. The numbers of units do not change: the last inspection is at the end of the test.";
    notes.extend(has_inspections.then(|| inspections.to_owned()));
    if let Some(prior) = &report.prior {
        let PriorRow { scene, reliability: [r, lower, upper], survived, failed, confidence } = prior;
        let [r, lower, upper] = [r, lower, upper].map(|r| near_one(*r, 5));
        notes.push(format!(
            "Prior by the study of {scene}: R = {r} ({lower} to {upper}), as Beta({}, {}), worth {} units; without any test \
             R >= R0 with {}. The interval contains the errors of the simulations, not those of the model and of what is not known of \
             its inputs: --prior-units limits what it is worth.",
            three_digits(*survived),
            three_digits(*failed),
            whole(survived + failed),
            percent(*confidence)
        ));
        notes.push(
            "With the study, R < R0 if passed is the risk among populations whose R follows the prior; passed at R = R0 is the risk if the prior is wrong."
                .to_owned(),
        );
    }
    notes
}
