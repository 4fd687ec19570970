//! The result of an optimisation with its tables, sentences and figures.

use super::result::{
    FrontPoint, Grades, OptimisationResult, OptimisedQuantity, OptimisedTarget, TargetState,
};
use crate::presentation::report::format::{percent, shortest, significant};
use crate::presentation::report::{
    Answer, AnswerPart, Axis, ComparedStudy, Figure, Ink, Plot, Scale, Series, Shape, Table,
};
use crate::statistics::reliability::REACH;
use common::random::{standard_normal_pdf, standard_normal_quantile};

/// The result with the reliability `curves` of the study and of the optimum.
pub fn answer(result: &OptimisationResult, scene: &str, curves: Vec<ComparedStudy>) -> Answer {
    let first = [AnswerPart::Text(verdict(result)), AnswerPart::Figures];
    let tables = tables(result).into_iter().map(AnswerPart::Table);
    let notes = AnswerPart::Notes("Errors and prices", notes(result));
    Answer {
        name: "optimum".to_owned(),
        title: "Optimum".to_owned(),
        subtitle: format!("Scene: {scene}"),
        parts: first.into_iter().chain(tables).chain([notes]).collect(),
        figures: front_figure(result).into_iter().collect(),
        curves,
        prints_markdown: true,
        ..Answer::default()
    }
}

/// Cost, limits of the search and confirmation in sentences.
fn verdict(result: &OptimisationResult) -> String {
    let added = match result.evaluations.added {
        1 => "1 simulation was added".to_owned(),
        n => format!("{n} simulations were added"),
    };
    let work = format!("{added} to the {} that the study had.", result.evaluations.study);
    let limits = limits(result);
    let confirmed = "Simulations at this design agree with the surrogates within the stated errors.";
    let unconfirmed = format!("This design is not confirmed by simulations: {}.", result.stopped_because);
    let confirmation = if result.confirmed { confirmed } else { &unconfirmed };
    if !result.feasible {
        let missed = |target: &OptimisedTarget| {
            let found = promise(target).unwrap_or_else(|| interval(target));
            format!("{} is {found}, the target is {}", target.name, share(target.target))
        };
        let targets = result.targets.iter().filter(|target| target.state == TargetState::NotMet);
        let mut missed = targets.map(missed).collect::<Vec<_>>().join("; ");
        if missed.is_empty() {
            "a target is missed by less than its error".clone_into(&mut missed);
        }
        let of_all = "**No design within the bounds was found that meets every target.**";
        let of_region =
            format!("**Within what the simulations support, no design meets every target.** {limits}");
        let head = if result.supports_all() { of_all } else { &of_region };
        return format!("{head} The design below comes nearest: {missed}. {confirmation} {work}");
    }
    let [before, cost] = [result.cost_before, result.cost].map(number);
    if result.is_held() {
        return format!(
            "Cost {before} with the design of the study, {cost} on the edge of what the simulations support, which is no optimum. \
             {limits} {confirmation} {work}"
        );
    }
    let error = significant(REACH * result.cost_standard_error, 2);
    let has_error = result.grades.is_none() && result.cost_standard_error > 0.0;
    let error = format!(" ± {error} (95 %, from the errors of the reliabilities)");
    let (error, states) = (if has_error { &error } else { "" }, states(result));
    format!(
        "Cost {before} with the design of the study, {cost}{error} at the optimum. {states} {confirmation} {work}"
    )
}

/// The trust region, where it limits the search, and what to do.
fn limits(result: &OptimisationResult) -> String {
    let is_held = result.is_held();
    let region = |OptimisedQuantity { name, unit, supported, .. }: &OptimisedQuantity| {
        let [from, to] = supported.map(number);
        let space = if unit.is_empty() { "" } else { " " };
        format!("{name} ({from} to {to}{space}{unit})")
    };
    let limiting = result.quantities.iter().filter(|q| if is_held { q.held } else { !q.all_supported });
    let limiting = limiting.map(region).collect::<Vec<_>>().join(", ");
    let verb = if is_held { "The search was stopped by" } else { "The search was within" };
    format!(
        "{verb} the trust region of {limiting}; designs beyond it, within the bounds, were not examined. More --max-evaluations \
         move the region."
    )
}

/// What the intervals say of the targets.
fn states(result: &OptimisationResult) -> String {
    let of = |state: TargetState| {
        let targets = result.targets.iter().filter(|t| t.state == state && t.at_least.is_none());
        let text = |t: &OptimisedTarget| format!("{} = {} for {}", t.name, interval(t), share(t.target));
        targets.map(text).collect::<Vec<_>>().join("; ")
    };
    let (within, missed) = (of(TargetState::MetWithinErrors), of(TargetState::NotMet));
    let promises = |target: &OptimisedTarget| {
        Some(format!("{} is {}, for {}.", target.name, promise(target)?, share(target.target)))
    };
    let mut said: Vec<String> = result.targets.iter().filter_map(promises).collect();
    if said.is_empty() && within.is_empty() && missed.is_empty() {
        said.push("Every target is met by the whole interval of its reliability.".to_owned());
    }
    let why = "since the optimum lies on its target and the interval on both sides of it";
    said.extend((!missed.is_empty()).then(|| format!("Not met: {missed}.")));
    said.extend((!within.is_empty()).then(|| format!("Met within the stated errors only, {why}: {within}.")));
    said.join(" ")
}

/// Tables of quantities, reliabilities and the front.
fn tables(result: &OptimisationResult) -> Vec<Table> {
    let cheapest = if result.is_held() { "cheapest supported" } else { "optimum" };
    let found = if result.feasible { cheapest } else { "nearest" };
    let (cost, counted) = (format!("cost, {found}"), format!("{found}, counted"));
    let OptimisationResult { quantities, targets, front, .. } = result;
    let of_design = ["quantity", "study", found, "allowed", "unit", "change", "cost, study", &cost];
    let of_r = ["reliability", "target", "study", found, "95 % interval", &counted, "state"];
    let of_front = ["failure probability allowed", "targets", "least cost"];
    let mut tables = vec![
        Table::new("Design", of_design, quantities.iter().map(quantity_row)),
        Table::new("Reliability", of_r, targets.iter().map(target_row)),
    ];
    if !front.is_empty() && result.feasible {
        tables.push(Table::new("Cost against reliability", of_front, front.iter().map(front_row)));
    }
    tables
}

fn quantity_row(quantity: &OptimisedQuantity) -> Vec<String> {
    let OptimisedQuantity { name, unit, advice, cost_before, cost_after, .. } = quantity;
    let grade = quantity.grade.as_ref().map_or(String::new(), |grade| format!(" ({grade})"));
    let edge = if quantity.held { ", on the edge of the trust region" } else { "" };
    let bound = quantity.on_bound.map_or(edge.to_owned(), |bound| format!(", on its {bound} bound"));
    let numbers =
        [quantity.before, quantity.after, quantity.lower, quantity.upper, *cost_before, *cost_after];
    let [before, after, lower, upper, cost_before, cost_after] = numbers.map(number);
    let (after, allowed) = (format!("{after}{grade}"), format!("{lower} to {upper}"));
    let change = format!("{advice}{bound}");
    vec![name.clone(), before, after, allowed, unit.clone(), change, cost_before, cost_after]
}

fn target_row(target: &OptimisedTarget) -> Vec<String> {
    let state = match target.state {
        TargetState::NotMet => "not met",
        TargetState::MetWithinErrors => "met within the stated errors",
        TargetState::Met => "met",
    };
    let with = promise(target).map_or(String::new(), |promise| format!(": {promise}"));
    let active = if target.active { ", decides the design" } else { "" };
    vec![
        target.name.clone(),
        share(target.target),
        with_interval(target.before, target.standard_error_before),
        share(target.reliability),
        ends(target),
        with_interval(target.counted, target.counted_standard_error),
        format!("{state}{with}{active}"),
    ]
}

fn front_row(point: &FrontPoint) -> Vec<String> {
    let FrontPoint { factor, targets, cost, unsupported } = point;
    let targets: Vec<String> = targets.iter().map(|target| share(*target)).collect();
    let is_own = (factor - 1.0).abs() < 1e-12;
    let factor = if is_own { "as targeted".to_owned() } else { format!("{factor} times as targeted") };
    let none =
        if *unsupported { "beyond what the simulations support" } else { "no design within the bounds" };
    vec![factor, targets.join(", "), cost.map_or(none.to_owned(), number)]
}

/// Sentences on errors and prices.
fn notes(result: &OptimisationResult) -> Vec<String> {
    let intervals = "Reliabilities have 95 % intervals. That of the optimum is integrated along lines over the surrogates; its interval \
                     contains the surrogate error and the numerical error of the simulations, and that all or none may fail of the \
                     units outside of what was simulated, if these are most of them. The counted one is that of a population that the \
                     surrogates classify at the optimum, without these errors.";
    let mut notes = vec![intervals.to_owned()];
    if let Some(Grades { examined, proved, relaxed_cost }) = result.grades {
        let proof = "on the surrogates no other combination of the allowed grades is cheaper";
        let proof = if proved { proof } else { "not all were examined, so a cheaper one may exist" };
        let cost = number(relaxed_cost);
        notes.push(format!(
            "{examined} combinations of grades were examined: {proof}. If every tolerance between the grades were allowed, the cost \
             would be {cost}."
        ));
    }
    if !result.feasible || result.is_held() {
        return notes;
    }
    let price = |OptimisedTarget { name, target, multiplier, .. }: &OptimisedTarget| {
        let allowed = 1.0 - target;
        let tenth = multiplier * 0.1 * allowed / standard_normal_pdf(-standard_normal_quantile(allowed));
        let [allowed, tenth, multiplier] = [allowed, tenth, *multiplier].map(number);
        format!(
            "Price of {name}: to allow a tenth less than the failure probability {allowed} costs about {tenth} more (Lagrange \
             multiplier {multiplier} per unit of the reliability index)."
        )
    };
    notes.extend(result.targets.iter().filter(|target| target.multiplier > 0.0).map(price));
    notes.extend(result.confidence_cost.map(|cost| {
        format!(
            "Price of the confidence: by the estimates alone the targets would cost {} less.",
            number(cost)
        )
    }));
    let continuous =
        if result.grades.is_some() { ", with every tolerance between the grades allowed" } else { "" };
    notes.push(format!(
        "The costs against reliability are optima on the surrogates{continuous}; no simulation confirms them."
    ));
    notes
}

/// A number with four digits.
fn number(value: f64) -> String {
    significant(value, 4)
}

/// A reliability with as many digits as its distance from one needs.
fn share(r: f64) -> String {
    let distance = (1.0 - r).min(r).max(1e-12);
    let decimals = (2.0 - distance.log10().floor()).clamp(2.0, 12.0) as usize;
    let text = format!("{r:.decimals$}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A reliability and the ends of its 95 % interval with all errors.
fn interval(target: &OptimisedTarget) -> String {
    format!("{} ({})", share(target.reliability), ends(target))
}

/// What holds of a target with its confidence.
fn promise(target: &OptimisedTarget) -> Option<String> {
    Some(format!("at least {} with {} confidence", share(target.at_least?), percent(target.confidence?)))
}

/// The ends of the 95 % interval of a reliability.
fn ends(target: &OptimisedTarget) -> String {
    let [lower, upper] = target.interval.map(share);
    format!("{lower} to {upper}")
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

/// The figure; `None` with fewer than two targets that any design meets.
fn front_figure(result: &OptimisationResult) -> Option<Figure> {
    let known = |point: &FrontPoint| Some((point.factor.log10(), point.cost?));
    let mut front: Vec<(f64, f64)> = result.front.iter().filter_map(known).collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [first, .., last] = &front[..] else { return None };
    let (label, range) = ("failure probability allowed, times that of the targets", (first.0, last.0));
    let text = |exponent: f64| shortest(10f64.powf(exponent), 3);
    let x = Axis { label, range, text, scale: Scale::Logarithm };
    let costs = front.iter().map(|(_, cost)| *cost).chain([result.cost]);
    let (low, high) = costs.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), c| (l.min(c), h.max(c)));
    let margin = 0.05 * (high - low).max(0.01 * high.abs());
    let series = [
        Series::new("least cost", Ink::Series(0), Shape::Dotted(front.clone())),
        Series::new("optimum", Ink::Limit, Shape::Marked(vec![((0.0, result.cost), String::new())])),
        Series::unlisted("cost of the study's design", Ink::Muted, Shape::Level(result.cost_before)),
    ];
    // The design of the study is drawn where it lies in the range of the others.
    let series = if (low..=high).contains(&result.cost_before) { &series[..] } else { &series[..2] };
    let y = Axis::linear("cost", (low - margin, high + margin));
    let plot = Plot { figure: "cost-against-reliability", x, y, series };
    let caption = "Least costs on the surrogates, with every tolerance between grades allowed; 1 stands for the targets.";
    Some(plot.figure("Cost against reliability", caption))
}
