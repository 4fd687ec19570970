//! The loop: optimise on the surrogates, simulate at the optimum, until optimum and reliability agree.
//!
//! An optimum is confirmed when a campaign has ended by its own stopping rule at a design next to it, the optimum found
//! with the surrogates of that campaign has not moved away, the surrogate error of every target there is small, and the
//! reliability by line sampling agrees with the one counted over the population.

use super::campaign::{StudyBasis, TargetCampaign};
use super::context::{Context, values_of};
use super::finding::Finding;
use super::problem::DesignProblem;
use super::reliability::{TargetValue, place};
use super::result::{OptimisationResult, Simulations};
use super::solve::{Solved, solve};
use super::{Simulate, trust};
use crate::analyses::error::AnalysisError;
use crate::statistics::design::InputModel;
use crate::study::StopReason;

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
    let context = Context::new(study, problem, &campaign);
    let present = problem.present(&context.reference);
    let start: Vec<f64> = problem.quantities.iter().zip(&present).map(|(q, v)| place(q, *v)).collect();
    let middle = vec![0.5; start.len()];
    let dimension = study.problem.inputs.dimension();
    let visit = (VISIT.0 + dimension).min(VISIT.1);
    let allowed = problem.targets.iter().map(|target| 1.0 - target.reliability).fold(1.0, f64::min);

    let mut learned = campaign.learn(&context.reference, 0, allowed, simulate)?;
    // The design of the last campaign with simulations, and whether it ended by its own rule.
    let mut last: Option<(InputModel, bool)> = None;
    let mut known = vec![start.clone(), middle];
    let (mut round, mut visited) = (0, false);
    let (solved, region, reason) = loop {
        round += 1;
        let (solved, region) = {
            let mut reliability = context.reliability(&learned, &known[0]);
            let inputs = context.inputs(&values_of(problem, &known[0]))?;
            reliability.region = trust::region(problem, &inputs, &known[0], visited);
            (solve(&mut reliability, &known), reliability.region)
        };
        let added = campaign.simulations() - before;
        let met = if solved.feasible { "" } else { ", none within the trust region meets the targets" };
        let cost = solved.cost;
        progress(format!(
            "round {round}: cost {cost:.5} on the present surrogates{met}; {added} simulations added"
        ));
        known = vec![solved.y.clone()];
        let pf = solved.least_probability(problem);
        let values = values_of(problem, &solved.y);
        let inputs = context.inputs(&values)?;
        let near = last.as_ref().is_some_and(|(at, _)| context.are_near(&inputs, at));
        let ended = last.as_ref().is_some_and(|(_, ended)| *ended);
        if near && ended {
            // The surrogates of the last campaign, assessed at the optimum itself.
            learned = campaign.learn(&inputs, 0, pf, simulate)?;
            let solved = context.assessed(&solved, &learned);
            // A design on the edge of the region is no optimum.
            if trust::held(&region, &solved.y).is_empty() && context.is_accurate(&solved, &learned) {
                break (solved, region, None);
            }
        }
        let left = budget.saturating_sub(added);
        if left == 0 || round == MOST_ROUNDS {
            learned = campaign.learn(&inputs, 0, pf, simulate)?;
            let reason = if left == 0 {
                format!("the budget of {budget} simulations is spent")
            } else {
                format!("{MOST_ROUNDS} rounds have passed")
            };
            break (context.assessed(&solved, &learned), region, Some(reason));
        }
        learned = if near {
            campaign.learn(&inputs, left, pf, simulate)?
        } else {
            visited = true;
            campaign.learn(&trust::of_visit(problem, &inputs), visit.min(left), pf, simulate)?
        };
        let ended = learned.stop != StopReason::Budget;
        last = Some((inputs, ended));
    };
    let added = campaign.simulations() - before;
    let at_present = campaign.learn(&context.reference, 0, allowed, simulate)?;
    let confirmed = reason.is_none();
    let stopped_because =
        reason.unwrap_or_else(|| "the optimum and the reliabilities simulated there agree".to_owned());
    let evaluations = Simulations { study: before, added };
    let finding = Finding { solved, region, confirmed, stopped_because, evaluations, present };
    Ok(finding.result(&context, &learned, &at_present))
}

impl Solved {
    /// The least failure probability that matters to a target: the one it allows, or that of the design if it is larger.
    fn least_probability(&self, problem: &DesignProblem) -> f64 {
        let of = |(value, target): (&TargetValue, &super::ReliabilityTarget)| {
            value.estimate.probability.max(1.0 - target.reliability)
        };
        self.values.iter().zip(&problem.targets).map(of).fold(1.0, f64::min)
    }
}
