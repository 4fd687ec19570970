//! Variants of the model in a study: the range of the lives in words, the envelope of R, and the lives with their changes as a table.

use super::figures::span;
use super::format::{fixed, signed_with_width, whole};
use super::life::{LEVELS, LifeAt, life_and_limits, life_at};
use super::{Axis, Figure, Ink, LifeAxis, Plot, Points, Series, Shape, table};
use crate::results::summary::{ReliabilityRow, StudySummary, VariantRow};
use maud::Markup;

/// The study with the lives and reliabilities of a variant.
fn as_study(summary: &StudySummary, variant: &VariantRow) -> StudySummary {
    StudySummary {
        lives: variant.lives.clone(),
        reliability: variant.reliability.clone(),
        curves: vec![],
        ..summary.clone()
    }
}

/// The range of the life at R = 0.99 over the study and the variants of the model; `None` without any, or if no life is known.
pub fn sentence(summary: &StudySummary) -> Option<String> {
    let of = |study: &StudySummary| match life_at(study, "total", LEVELS[0]) {
        LifeAt::Cycles { life, .. } => Some(life),
        _ => None,
    };
    let count = Some(summary.variants.len()).filter(|count| *count > 0)?;
    let variants = summary.variants.iter();
    let all: Vec<(&str, Option<f64>)> = std::iter::once(("the study", of(summary)))
        .chain(variants.map(|variant| (variant.name.as_str(), of(&as_study(summary, variant)))))
        .collect();
    let known = || all.iter().filter_map(|(name, life)| Some((*name, (*life)?)));
    let (low, least) = known().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (high, largest) = known().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let unknown: Vec<&str> = all.iter().filter(|(_, life)| life.is_none()).map(|(name, _)| *name).collect();
    let without =
        if unknown.is_empty() { String::new() } else { format!("; not known for {}", unknown.join(", ")) };
    Some(format!(
        "With {count} variant{} of the model, life at R = {}: {} ({low}) to {} cycles ({high}){without}. Intervals are those of one \
         model each.",
        if count == 1 { "" } else { "s" },
        LEVELS[0],
        whole(least),
        whole(largest)
    ))
}

/// R of the system at the checkpoints (x, R).
fn points(rows: &[ReliabilityRow], axis: &LifeAxis) -> Points {
    rows.iter().filter_map(|row| Some((axis.place(row.cycles), *row.reliability.get("total")?))).collect()
}

/// The envelope of R over the study and its variants.
pub fn figure(summary: &StudySummary) -> Option<Figure> {
    let known: Vec<&VariantRow> =
        summary.variants.iter().filter(|variant| !variant.reliability.is_empty()).collect();
    if known.is_empty() || summary.is_static() {
        return None;
    }
    let axis = LifeAxis::new(summary);
    let own = points(&summary.reliability, &axis);
    let each: Vec<Points> = known.iter().map(|variant| points(&variant.reliability, &axis)).collect();
    let envelope = own.iter().enumerate().map(|(n, (x, r))| {
        let all = each.iter().map(|points| points[n].1).chain([*r]);
        let (low, high) = all.fold((1.0_f64, 0.0_f64), |(low, high), r| (low.min(r), high.max(r)));
        (*x, low, high)
    });
    let mut series = vec![Series::unlisted("envelope", Ink::Muted, Shape::Band(envelope.collect()))];
    let lines = known
        .iter()
        .zip(each)
        .enumerate()
        .map(|(k, (variant, points))| Series::new(&variant.name, Ink::Series(k), Shape::Dashed(points)));
    series.extend(lines);
    series.push(Series::new("study", Ink::Ink, Shape::Line(own)));
    let x = Axis::linear(axis.label, span(summary, &axis));
    let caption = "Reliability of the whole system by the study and by each variant; area: between the least and the largest.";
    Some(Plot::of_reliability("variants", x, &series).figure("R by variants of the model", caption))
}

/// Lives of every variant with their changes.
pub fn rows(summary: &StudySummary) -> Markup {
    let [first, _, last] = LEVELS;
    let row = |variant: &VariantRow| {
        let study = as_study(summary, variant);
        let life = |level: f64| match variant.reliability.as_slice() {
            [] => "too few results".to_owned(),
            _ => life_and_limits(life_at(&study, "total", level)).0,
        };
        let change = variant.changes_of_lives.first().copied().flatten();
        let change = change.map_or("not known".to_owned(), |change| match (change.lower, change.upper) {
            (Some(lower), Some(upper)) => signed_with_width(change.value, 0.5 * (upper - lower)),
            _ => fixed(change.value, 0),
        });
        let effort = format!("{} ({} failed)", variant.evaluations, variant.failed);
        [variant.name.clone(), variant.changes.join(", "), life(first), change, life(last), effort]
    };
    let head = ["variant", "changes", "life at R = 0.99", "change (95 %)", "life at R = 0.5", "simulations"];
    table(&head, summary.variants.iter().map(row))
}
