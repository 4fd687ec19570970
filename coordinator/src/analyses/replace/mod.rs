//! When to replace: the age of replacement with the least cost per cycle, hazard and mean life, from the reliability of a
//! finished study; and replacement above a measured level, from the surrogates.
//!
//! Every number has a 95 % interval from the limits of the curve, with the numerical error of the simulations where they state
//! one; what the study cannot know, beyond its last checkpoint, is stated as a bound.

mod inspections;
#[cfg(test)]
mod tests;
mod text;

pub use inspections::{InspectionPlan, InspectionRow, Schedule, inspect};
pub use text::answer;

use super::error::RefusedQuestion;
use crate::results::life_summary::{LifeCurveRow, LifeRow};
use crate::results::summary::{ReliabilityRow, StudySummary};
use crate::statistics::design::{Stream, open_stream};
use crate::statistics::replacement::{AgeReplacement, CurveBand, ReplacementCosts, SurvivalCurve};
use serde::Serialize;

/// Points of the curve of the cost rate.
const POINTS: usize = 200;

/// Pieces of a curve of constant hazard before the first checkpoint.
const PIECES: usize = 256;
/// Share of the cost per cycle at the end of the study below which a minimum before it counts as none [1]: the straight pieces of a
/// curve of constant hazard have such.
const SHALLOW: f64 = 1e-3;

/// A number with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Stated {
    /// Best estimate of the number.
    pub value: f64,
    /// Lower limit of its interval.
    pub lower: f64,
    /// Upper limit of its interval.
    pub upper: f64,
}

/// The age of replacement under a demand.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DemandedAge {
    /// Least reliability at the age of replacement [1].
    pub reliability: f64,
    /// Confidence with which it holds [1].
    pub confidence: f64,
    /// Latest age at which it does [cycles].
    pub latest: f64,
    /// Age of the least cost up to there [cycles].
    pub age: f64,
    /// Cost per cycle at that age.
    pub cost_rate: f64,
}

/// Failure density and hazard between two lives.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RateRow {
    /// Beginning of the interval [cycles].
    pub from: f64,
    /// Its end [cycles].
    pub to: f64,
    /// Mean failure density [1/cycle].
    pub density: Stated,
    /// Mean hazard [1/cycle]; `None` where too few survive.
    pub hazard: Option<Stated>,
}

/// The answer of `coordinator replace`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReplacementReport {
    /// Simulations that were made.
    pub evaluations: usize,
    /// Reliability of the study.
    pub reliability: Vec<ReliabilityRow>,
    /// Limit state, or `total`.
    pub curve: String,
    /// Cost of a planned replacement.
    pub planned_cost: f64,
    /// Cost of a failure with its replacement.
    pub failure_cost: f64,
    /// Age of replacement with the least cost per cycle [cycles].
    pub age: Stated,
    /// True if the cost per cycle has no minimum before the end of the study: the hazard does not rise enough, and units run to failure.
    pub no_minimum: bool,
    /// Checkpoint before which the fall of R is not resolved and is taken as that of a constant hazard [cycles]; `None` without one.
    pub constant_hazard_before: Option<u32>,
    /// Share of the curves within the limits that have no minimum before the end [1].
    pub share_without_minimum: f64,
    /// Cost per cycle at that age.
    pub cost_rate: Stated,
    /// Reliability at that age [1].
    pub reliability_at_age: Stated,
    /// Cost per cycle of running to failure; an upper bound if `mean_life_is_bound`.
    pub run_to_failure: Stated,
    /// Share of the cost per cycle that replacement saves against running to failure; at most that if `mean_life_is_bound`.
    pub gain: Stated,
    /// Mean life up to the end of the study [cycles].
    pub mean_life: Stated,
    /// True if units outlive the study, so that the mean life is larger.
    pub mean_life_is_bound: bool,
    /// Last checkpoint [cycles].
    pub end: f64,
    /// Lives that 1, 10 and 50 % of the units do not reach.
    pub lives: Vec<LifeRow>,
    /// Failure density and hazard between the checkpoints.
    pub rates: Vec<RateRow>,
    /// Cost per cycle over the age of replacement: cycles, best, lower, upper.
    pub cost_curve: Vec<[f64; 4]>,
    /// The age under a demanded reliability, if there is one.
    pub demanded: Option<DemandedAge>,
    /// Replacement above a measured level, one row per schedule of inspections.
    pub inspections: Vec<InspectionRow>,
}

/// The curve of a limit state, or of the system as `total`.
///
/// # Errors
/// [`RefusedQuestion`] if there is none of that name.
pub fn curve_of<'s>(summary: &'s StudySummary, name: &str) -> Result<&'s LifeCurveRow, RefusedQuestion> {
    let names: Vec<&str> = summary.curves.iter().map(|curve| curve.limit_state.as_str()).collect();
    let found = summary.curves.iter().find(|curve| curve.limit_state == name);
    found.ok_or_else(|| {
        if names.is_empty() {
            return RefusedQuestion::new(
                "this study has no reliability between checkpoints",
                "it has a single checkpoint, or an earlier version made it; run it with at least two checkpoints",
            );
        }
        let fault = format!("there is none of that name; allowed: {}", names.join(", "));
        RefusedQuestion::new(format!("--curve {name}"), fault)
    })
}

/// Checks the costs.
///
/// # Errors
/// [`RefusedQuestion`] if no replacement pays.
pub fn check_costs(costs: &ReplacementCosts) -> Result<(), RefusedQuestion> {
    let ReplacementCosts { planned, failure } = *costs;
    let fault = format!(
        "allowed: above --planned-cost {planned}; a failure that is no dearer than a planned replacement never pays for one"
    );
    let refused = RefusedQuestion::new(format!("--failure-cost {failure}"), fault);
    if failure > planned { Ok(()) } else { Err(refused) }
}

/// A curve `[cycles, R, lower limit, upper limit]` `(4)(g,)` with a constant hazard from age 0 to a checkpoint, R(t) = R(first)^(t /
/// first). Its limits there are all curves that do not rise: R may fall at once, or not before the checkpoint.
fn with_constant_hazard_before(first: f64, curve: &[Vec<f64>; 4]) -> [Vec<f64>; 4] {
    let [cycles, reliability, lower, upper] = curve;
    let from = cycles.partition_point(|t| *t < first).min(cycles.len() - 1);
    let (r, least) = (reliability[from], lower[from]);
    let shares = (0..PIECES).map(|k| k as f64 / PIECES as f64);
    let before = |values: &[f64], of: &dyn Fn(f64) -> f64| -> Vec<f64> {
        shares.clone().map(of).chain(values[from..].iter().copied()).collect()
    };
    [
        before(cycles, &|share| share * first),
        before(reliability, &|share| r.max(1e-12).powf(share)),
        before(lower, &|share| if share > 0.0 { least } else { 1.0 }),
        before(upper, &|_| 1.0),
    ]
}

/// Age replacement from a curve of a study's summary.
///
/// # Errors
/// [`RefusedQuestion`].
pub fn replace(
    summary: &StudySummary,
    name: &str,
    costs: &ReplacementCosts,
    demand: Option<(f64, f64)>,
) -> Result<ReplacementReport, RefusedQuestion> {
    check_costs(costs)?;
    let row = curve_of(summary, name)?;
    let [lower, upper] = row.limits().map(<[f64]>::to_vec);
    let curve = [row.cycles.clone(), row.reliability.clone(), lower, upper];
    let best_of = |curve: &SurvivalCurve| {
        let (best, end) = (costs.best_age(curve), curve.end());
        let cost_rate = costs.rate(curve, end);
        let is_shallow = best.cost_rate > (1.0 - SHALLOW) * cost_rate;
        if is_shallow { AgeReplacement { age: end, cost_rate, at_the_end: true } } else { best }
    };
    let first = best_of(&SurvivalCurve::new(&row.cycles, &row.reliability));
    let unresolved = summary.unresolved_fall.filter(|fall| fall.from == 0 && first.age < f64::from(fall.to));
    let changed = unresolved.map(|fall| with_constant_hazard_before(f64::from(fall.to), &curve));
    let [cycles, reliability, lower, upper] = changed.unwrap_or(curve);
    let mut rng = open_stream(summary.seed, Stream::Curve);
    let band =
        CurveBand::new(&cycles, &reliability, [&lower, &upper], summary.unconditional_points(), &mut rng);
    let stated = |of: &dyn Fn(&SurvivalCurve) -> Option<f64>| {
        let value = of(&band.best)?;
        band.interval(of).map(|[lower, upper]| Stated { value, lower, upper })
    };
    let sure = |of: &dyn Fn(&SurvivalCurve) -> f64| {
        stated(&|curve| Some(of(curve))).expect("every curve has this number")
    };
    let best = best_of(&band.best);
    let end = band.best.end();
    if band.best.restricted_mean() <= 0.0 {
        return Err(RefusedQuestion::new(
            format!("--curve {name}"),
            "every unit has failed from the beginning: there is no age to replace it at",
        ));
    }
    // Between two points of the curve the band has its straight lines; where it falls there is not known.
    let [mut age, mut cost_rate] =
        [sure(&|curve| best_of(curve).age), sure(&|curve| best_of(curve).cost_rate)];
    if !best.at_the_end {
        let ([from, to], least) = costs.unresolved(&band.best, best.age);
        (age.lower, age.upper) = (age.lower.min(from), age.upper.max(to));
        cost_rate.lower = cost_rate.lower.min(least);
    }
    let checkpoints: Vec<f64> = summary.reliability.iter().map(|row| f64::from(row.cycles)).collect();
    let rate = |k: usize| {
        let (from, to) = (if k == 0 { 0.0 } else { checkpoints[k - 1] }, checkpoints[k]);
        let density = sure(&|curve| curve.rate(from, to).0);
        RateRow { from, to, density, hazard: stated(&|curve| curve.rate(from, to).1) }
    };
    let at = |k: usize| {
        let age = end * k as f64 / POINTS as f64;
        let cost = sure(&|curve| costs.rate(curve, age));
        [age, cost.value, cost.lower, cost.upper]
    };
    let demanded = demand.map(|(reliability, confidence)| {
        let latest = band.surely_until(reliability, confidence);
        // An earlier limit is the best age up to there, unless an earlier minimum lies before it.
        let ages = (1..=POINTS).map(|k| latest * k as f64 / POINTS as f64);
        let ages = ages.chain((best.age <= latest).then_some(best.age));
        let costs = ages.map(|age| (age, costs.rate(&band.best, age)));
        let (age, cost_rate) = costs.min_by(|a, b| a.1.total_cmp(&b.1)).expect("POINTS is positive");
        DemandedAge { reliability, confidence, latest, age, cost_rate }
    });
    let lives = summary.lives.iter().filter(|life| life.limit_state == row.limit_state).cloned();
    Ok(ReplacementReport {
        evaluations: 0,
        reliability: summary.reliability.clone(),
        curve: row.limit_state.clone(),
        planned_cost: costs.planned,
        failure_cost: costs.failure,
        age,
        no_minimum: best.at_the_end,
        constant_hazard_before: unresolved.map(|fall| fall.to),
        share_without_minimum: band.share(|curve| best_of(curve).at_the_end),
        cost_rate,
        reliability_at_age: sure(&|curve| curve.at(best.age)),
        run_to_failure: sure(&|curve| costs.of_failures(curve)),
        gain: sure(&|curve| 1.0 - best_of(curve).cost_rate / costs.of_failures(curve)),
        mean_life: sure(&SurvivalCurve::restricted_mean),
        mean_life_is_bound: band.best.last() > 0.0,
        end,
        lives: lives.collect(),
        rates: (0..checkpoints.len()).map(rate).collect(),
        cost_curve: (1..=POINTS).map(at).collect(),
        demanded,
        inspections: vec![],
    })
}
