//! The loop: optimise on the surrogates, simulate at the optimum, until optimum and reliability agree.
//!
//! An optimum is confirmed when a campaign has ended by its own stopping rule at a design next to it, the optimum found
//! with the surrogates of that campaign has not moved away, the surrogate error of every target there is small, and the
//! reliability by line sampling agrees with the one counted over the population.

use super::campaign::{StudyBasis, TargetCampaign};
use super::context::{Context, index_of};
use super::problem::DesignProblem;
use super::reliability::Constraint;
use super::result::{
    FrontPoint, OptimisationResult, OptimisedQuantity, OptimisedTarget, Simulations, TargetState,
};
use super::solve::{Solved, solve, solve_relaxed};
use super::{Simulate, trust};
use crate::analyses::error::AnalysisError;
use crate::statistics::design::InputModel;
use crate::statistics::reliability::REACH;
use crate::study::{CampaignResult, StopReason};
use common::random::{standard_normal_pdf, standard_normal_quantile};

/// Most rounds of the loop.
const MOST_ROUNDS: usize = 25;
/// Simulations of a first visit to a design, besides one per variable, and at most.
const VISIT: (usize, usize) = (4, 16);

/// Finds the cheapest design that meets the targets, with at most `budget` simulations besides those of the study.
///
/// # Errors
/// [`AnalysisError`].
pub fn optimise(
    study: &StudyBasis,
    problem: &DesignProblem,
    budget: usize,
    simulate: &mut Simulate<'_>,
    progress: &mut dyn FnMut(String),
) -> Result<OptimisationResult, AnalysisError> {
    let mut campaign = TargetCampaign::new(study, problem);
    let before = campaign.simulations();
    let mut context = Context::new(study, problem, &campaign);
    let present = problem.present(&context.reference);
    let start: Vec<f64> = problem.quantities.iter().zip(&present).map(|(q, v)| q.place(*v)).collect();
    let middle = vec![0.5; start.len()];
    let dimension = study.problem.inputs.dimension();
    let visit = (VISIT.0 + dimension).min(VISIT.1);
    let allowed = problem.targets.iter().map(|target| 1.0 - target.reliability).fold(1.0, f64::min);

    let mut learned = campaign.learn(&context.reference, 0, allowed, simulate)?;
    // The design of the last campaign with simulations, and whether it ended by its own rule.
    let mut last: Option<(InputModel, bool)> = None;
    // The place of that design.
    let mut centre = start.clone();
    let mut known = vec![start, middle];
    let (mut round, mut visited) = (0, false);
    let (solved, region, bounds, reason) = loop {
        round += 1;
        let (solved, region) = {
            let mut reliability = context.reliability(&learned, &known[0]);
            let inputs = context.inputs(&problem.values(&centre))?;
            reliability.region = trust::region(problem, &inputs, &centre, visited);
            (solve(&mut reliability, &known), reliability.region)
        };
        let added = campaign.simulations() - before;
        let met = if solved.feasible { "" } else { ", none within the trust region meets the targets" };
        let cost = format!("cost {:.5} on the present surrogates", solved.cost);
        progress(format!("round {round}: {cost}{met}; {added} simulations added"));
        known = vec![solved.y.clone()];
        let pf = solved.least_probability(problem);
        let inputs = context.inputs(&problem.values(&solved.y))?;
        let near = last.as_ref().filter(|(at, _)| context.are_near(&inputs, at));
        if near.is_some_and(|(_, ended)| *ended) {
            // The surrogates of the last campaign, assessed at the optimum itself.
            learned = campaign.learn(&inputs, 0, pf, simulate)?;
            let solved = context.assessed(&solved, &learned);
            // A design on the edge of the region is no optimum.
            if trust::held(&region, &solved.y).is_empty() && context.is_accurate(&solved, &learned) {
                let bounds = context.bounds(&solved, &learned, &campaign);
                if context.reserve(&solved, &bounds) {
                    break (solved, region, bounds, None);
                }
                if round < MOST_ROUNDS {
                    continue;
                }
            }
        }
        let left = budget.saturating_sub(added);
        if left == 0 || round == MOST_ROUNDS {
            learned = campaign.learn(&inputs, 0, pf, simulate)?;
            let solved = context.assessed(&solved, &learned);
            let bounds = context.bounds(&solved, &learned, &campaign);
            if !context.reserve(&solved, &bounds) && round < MOST_ROUNDS {
                continue;
            }
            let spent = format!("the budget of {budget} simulations is spent");
            let reason = if left == 0 { spent } else { format!("{MOST_ROUNDS} rounds have passed") };
            break (solved, region, bounds, Some(reason));
        }
        visited |= near.is_none();
        learned = match near {
            Some(_) => campaign.learn(&inputs, left, pf, simulate)?,
            None => campaign.learn(&trust::of_visit(problem, &inputs), visit.min(left), pf, simulate)?,
        };
        last = Some((inputs, learned.stop != StopReason::Budget));
        centre.clone_from(&solved.y);
    };
    let added = campaign.simulations() - before;
    let at_present = campaign.learn(&context.reference, 0, allowed, simulate)?;
    let (context, learned, at_present) = (&context, &learned, &at_present);
    let finding = Finding { context, learned, at_present, solved, region, bounds, present };
    Ok(finding.result(Simulations { study: before, added }, reason))
}

impl Solved {
    /// The least failure probability that matters to a target: the one it allows, or that of the design if it is larger.
    fn least_probability(&self, problem: &DesignProblem) -> f64 {
        let both = self.values.iter().zip(&problem.targets);
        both.map(|(value, target)| value.estimate.probability.max(1.0 - target.reliability))
            .fold(1.0, f64::min)
    }
}

/// Constraint below which a target is active [1].
const ACTIVE: f64 = 1e-3;
/// Place, from a bound, below which a quantity lies on it [1].
const ON_BOUND: f64 = 1e-3;
/// Relative change below which a quantity is kept [1].
const KEPT: f64 = 0.01;
/// Reason of an end with confirmation.
const AGREEMENT: &str = "the optimum and the reliabilities simulated there agree";
/// Factors on the failure probabilities of the targets for the front.
const FRONT: [f64; 4] = [4.0, 2.0, 0.5, 0.25];

/// What the loop has found.
struct Finding<'a> {
    context: &'a Context<'a>,
    /// Campaigns at the design found, and at the study's.
    learned: &'a CampaignResult,
    at_present: &'a CampaignResult,
    solved: Solved,
    /// Region in which the design was sought `(q,)`.
    region: Vec<(f64, f64)>,
    /// Lower bounds of the targets that have a confidence `(targets,)` [1].
    bounds: Vec<Option<f64>>,
    /// Values of the quantities in the study `(q,)` [SI].
    present: Vec<f64>,
}

impl Finding<'_> {
    /// The result after these simulations; `stopped` is the reason of an end without confirmation.
    fn result(&self, evaluations: Simulations, stopped: Option<String>) -> OptimisationResult {
        let Finding { solved, present, region, context: Context { problem, .. }, .. } = self;
        let held = trust::held(region, &solved.y);
        let values = problem.values(&solved.y);
        let targets = self.targets();
        let variance = |target: &OptimisedTarget| {
            let beta = -standard_normal_quantile(1.0 - target.reliability);
            (target.multiplier * target.standard_error / standard_normal_pdf(beta).max(1e-300)).powi(2)
        };
        let cost_standard_error = targets.iter().map(variance).sum::<f64>().sqrt();
        let quantity = |k: usize| {
            let quantity = &problem.quantities[k];
            let (was, is, at, si) = (present[k], values[k], solved.y[k], quantity.unit.si);
            let at_lower = (at < ON_BOUND).then_some("lower");
            let on_bound = at_lower.or((at > 1.0 - ON_BOUND).then_some("upper"));
            let is_spread = quantity.kind.is_spread();
            let scale = if is_spread { was.abs() } else { (quantity.upper - quantity.lower).abs() };
            let advice = match (is_spread, is < was) {
                _ if (is - was).abs() <= KEPT * scale => "keep",
                (true, true) => "tighten",
                (true, false) => "loosen",
                (false, true) => "lower",
                (false, false) => "raise",
            };
            let nearest =
                quantity.grades.iter().min_by(|a, b| (a.width - is).abs().total_cmp(&(b.width - is).abs()));
            OptimisedQuantity {
                name: quantity.name.clone(),
                unit: quantity.unit.symbol.clone(),
                before: was / si,
                after: is / si,
                lower: quantity.lower / si,
                upper: quantity.upper / si,
                grade: nearest.map(|grade| grade.name.clone()),
                on_bound,
                supported: [region[k].0, region[k].1].map(|y| quantity.value(y) / si),
                all_supported: region[k] == (0.0, 1.0),
                held: held.contains(&k),
                advice,
                cost_before: quantity.cost_at(was).0,
                cost_after: quantity.cost_at(is).0,
            }
        };
        OptimisationResult {
            feasible: solved.feasible,
            confirmed: stopped.is_none(),
            stopped_because: stopped.unwrap_or_else(|| AGREEMENT.to_owned()),
            evaluations,
            cost_before: problem.cost(present),
            cost: solved.cost,
            cost_standard_error,
            quantities: (0..values.len()).map(quantity).collect(),
            targets,
            confidence_cost: self.confidence_cost(),
            front: if held.is_empty() { self.front() } else { vec![] },
            grades: solved.grades,
            values,
        }
    }

    /// The cheapest design with continuous quantities on the last surrogates for constraints `beta` `(targets,)`, and whether it lies
    /// within the region.
    fn cheapest(&self, beta: &[f64]) -> (Solved, bool) {
        let mut reliability = self.context.reliability(self.learned, &self.solved.y);
        reliability.region.clone_from(&self.region);
        let constraints = reliability.constraints.iter_mut().zip(beta);
        constraints.for_each(|(constraint, beta)| constraint.beta = *beta);
        let found = solve_relaxed(&mut reliability, std::slice::from_ref(&self.solved.y));
        let inside = trust::held(&self.region, &found.y).is_empty();
        (found, inside)
    }

    /// What the confidence of the targets costs, against the estimates alone; `None` without one or without an optimum.
    fn confidence_cost(&self) -> Option<f64> {
        self.bounds.iter().flatten().next()?;
        let targets = &self.context.problem.targets;
        let beta: Vec<f64> = targets.iter().map(|target| index_of(1.0 - target.reliability)).collect();
        let (found, inside) = self.cheapest(&beta);
        let is_optimum = self.solved.feasible && found.feasible && inside;
        is_optimum.then_some(self.solved.relaxed_cost - found.cost)
    }

    /// Least costs for stricter and looser targets, on the last surrogates.
    fn front(&self) -> Vec<FrontPoint> {
        let Self { solved, context, .. } = self;
        let targets: Vec<f64> = context.problem.targets.iter().map(|target| target.reliability).collect();
        let allowed: Vec<f64> = targets.iter().map(|r| 1.0 - r).collect();
        let point = |factor: f64| {
            let targets: Vec<f64> = allowed.iter().map(|p| 1.0 - factor * p).collect();
            // With the reserve of the optimum.
            let beta = allowed.iter().zip(&context.constraints);
            let beta: Vec<f64> =
                beta.map(|(p, own)| index_of(factor * p) + (own.beta - index_of(*p))).collect();
            // What the region holds, or what it may hide, is not known.
            let (found, inside) = self.cheapest(&beta);
            let whole = self.region.iter().all(|ends| *ends == (0.0, 1.0));
            let unsupported = !inside || !(found.feasible || whole);
            let cost = (found.feasible && inside).then_some(found.cost);
            FrontPoint { factor, targets, cost, unsupported }
        };
        let mut points: Vec<FrontPoint> =
            FRONT.into_iter().filter(|factor| allowed.iter().all(|p| factor * p < 1.0)).map(point).collect();
        let cost = solved.feasible.then_some(solved.relaxed_cost);
        let own = FrontPoint { factor: 1.0, targets, cost, unsupported: false };
        let place = points.iter().position(|point| point.factor < 1.0).unwrap_or(points.len());
        points.insert(place, own);
        points
    }

    fn targets(&self) -> Vec<OptimisedTarget> {
        let Self { solved, context, learned, at_present, .. } = self;
        let counted = [at_present, learned].map(|campaign| campaign.reliability());
        let target = |i: usize| {
            let target = &context.problem.targets[i];
            let Constraint { curve, column, beta, .. } = context.constraints[i];
            let value = &solved.values[i];
            let surrogate = TargetCampaign::surrogate_error(learned, curve, column);
            let standard_error = surrogate.hypot(value.estimate.standard_error);
            let reliability = 1.0 - value.estimate.probability;
            let [was, point] = [0, 1].map(|k: usize| counted[k][curve][column]);
            let optimised = OptimisedTarget {
                name: target.name.clone(),
                limit_state: target.limit_state,
                cycles: target.cycles,
                target: target.reliability,
                before: was.reliability,
                standard_error_before: was.standard_error,
                reliability,
                standard_error,
                counted: point.reliability,
                counted_standard_error: point.standard_error,
                active: value.beta - beta < ACTIVE || solved.multipliers[i] > 0.0,
                met: false,
                state: TargetState::NotMet,
                interval: [-REACH, REACH].map(|reach| (reliability + reach * standard_error).clamp(0.0, 1.0)),
                multiplier: solved.multipliers[i],
                confidence: target.confidence,
                at_least: self.bounds[i],
            };
            optimised.judged(solved.feasible)
        };
        (0..context.problem.targets.len()).map(target).collect()
    }
}
