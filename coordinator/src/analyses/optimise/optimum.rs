//! The loop: optimise on the surrogates, simulate at the optimum, until optimum and reliability agree.
//!
//! An optimum is confirmed when a campaign has ended by its own stopping rule at a design next to it, the optimum found
//! with the surrogates of that campaign has not moved away, the surrogate error of every target there is small, and the
//! reliability by line sampling agrees with the one counted over the population.

use super::campaign::{StudyBasis, TargetCampaign};
use super::problem::DesignProblem;
use super::reliability::{Constraint, DesignReliability, ModeSurrogate, TargetValue, place};
use super::result::{
    Advice, Bound, FrontPoint, Grades, OptimisationResult, OptimisedQuantity, OptimisedTarget, Simulations,
};
use super::solve::{Solved, solve, solve_relaxed};
use super::{OptimiseError, Simulate};
use crate::statistics::design::InputModel;
use crate::study::{CampaignResult, StopReason};
use common::random::{Distribution, standard_normal_pdf, standard_normal_quantile};

/// Most rounds of the loop.
const MOST_ROUNDS: usize = 25;
/// Simulations of a first visit to a design, besides one per variable, and at most.
const VISIT: (usize, usize) = (4, 16);
/// Designs are next to each other if no mean differs by more than this [standard deviations] ...
const NEAR_MEAN: f64 = 0.3;
/// ... and no logarithm of a standard deviation by more than this [1].
const NEAR_SPREAD: f64 = 0.15;
/// Distance from the last design that was simulated, up to which the surrogates are trusted in a mean [standard deviations].
const TRUST: f64 = 3.0;
/// Difference of two reliabilities in their standard errors up to which they agree [1].
const AGREE: f64 = 3.0;
/// Half-width of a 95 % interval in standard errors [1].
const REACH: f64 = 1.96;
/// Constraint below which a target is active [1].
const ACTIVE: f64 = 1e-3;
/// Place, from a bound, below which a quantity lies on it [1].
const ON_BOUND: f64 = 1e-3;
/// Relative change below which a quantity is kept [1].
const KEPT: f64 = 0.01;
/// Factors on the failure probabilities of the targets for the front.
const FRONT: [f64; 4] = [4.0, 2.0, 0.5, 0.25];

/// Progress of an optimisation: an optimum on the surrogates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OptimisationProgress {
    /// Round, from 1.
    pub round: usize,
    /// Cost of the optimum on the present surrogates.
    pub cost: f64,
    /// True if it meets the targets on the present surrogates.
    pub feasible: bool,
    /// Simulations added so far.
    pub added: usize,
}

/// Indices of a target's curve and column, and its name as a constraint.
struct Context<'a> {
    problem: &'a DesignProblem,
    reference: &'a InputModel,
    seed: u64,
    /// Curve and column of every target in the campaigns.
    places: Vec<(usize, usize)>,
    constraints: Vec<Constraint>,
}

impl<'a> Context<'a> {
    fn new(study: &'a StudyBasis, problem: &'a DesignProblem, campaign: &TargetCampaign<'_>) -> Self {
        let places: Vec<(usize, usize)> = problem
            .targets
            .iter()
            .map(|target| campaign.place(target.limit_state, target.checkpoint))
            .collect();
        let modes = campaign.modes.len();
        let constraint =
            |(target, (curve, column)): (&super::ReliabilityTarget, &(usize, usize))| Constraint {
                modes: if *curve == modes { (0..modes).collect() } else { vec![*curve] },
                column: *column,
                beta: -standard_normal_quantile(1.0 - target.reliability),
            };
        let constraints = problem.targets.iter().zip(&places).map(constraint).collect();
        Self { problem, reference: &study.problem.inputs, seed: study.settings.seed, places, constraints }
    }

    /// Reliability over designs with the surrogates of a campaign at the design y, its lines placed for it.
    fn reliability<'r>(&'r self, learned: &'r CampaignResult, y: &[f64]) -> DesignReliability<'r> {
        let surrogate = |(mode, surrogate): (
            &crate::statistics::learning::Classification,
            &'r crate::study::Surrogate,
        )| ModeSurrogate {
            dual: surrogate.model.dual(),
            threshold: mode.threshold,
            model: &surrogate.model,
        };
        let surrogates = learned.assessment.modes.iter().zip(&learned.assessment.surrogates).map(surrogate);
        let constraints = self.constraints.clone();
        let surrogates = surrogates.collect();
        let mut made =
            DesignReliability::new(self.problem, self.reference, surrogates, constraints, self.seed, y);
        made.region = self.trusted(y);
        made
    }

    /// Region of y around a design in which its surrogates are trusted: no mean further than [`TRUST`] standard deviations.
    fn trusted(&self, y: &[f64]) -> Vec<(f64, f64)> {
        let laws = self.problem.variables(self.reference, &values_of(self.problem, y)).unwrap_or_default();
        let range = |(quantity, y): (&super::DesignQuantity, &f64)| {
            let stds = quantity.variables.iter().filter_map(|k| laws.get(*k)).map(Distribution::given_std);
            let reach = TRUST * stds.fold(f64::INFINITY, f64::min) / (quantity.upper - quantity.lower);
            if quantity.kind.is_spread() || reach.is_nan() || reach <= 0.0 {
                (0.0, 1.0)
            } else {
                ((y - reach).max(0.0), (y + reach).min(1.0))
            }
        };
        self.problem.quantities.iter().zip(y).map(range).collect()
    }

    fn inputs(&self, values: &[f64]) -> Result<InputModel, OptimiseError> {
        Ok(self.problem.inputs(self.reference, values)?)
    }

    /// True if two designs are next to each other.
    fn are_near(&self, a: &InputModel, b: &InputModel) -> bool {
        a.variables().iter().zip(b.variables()).enumerate().all(|(k, (a_law, b_law))| {
            if a_law.is_constant() {
                // A design variable: in standard deviations of its range.
                let shift = a.standardised_value(k, a_law.parent_mean())
                    - b.standardised_value(k, b_law.parent_mean());
                return shift.abs() <= NEAR_MEAN;
            }
            let (a, b) = (a_law, b_law);
            let shift = (a.parent_mean() - b.parent_mean()).abs() / b.parent_std();
            let spread = (a.parent_std() / b.parent_std()).ln().abs();
            shift <= NEAR_MEAN && spread <= NEAR_SPREAD
        })
    }

    /// True if at a campaign's design every surrogate error is small and line sampling agrees with counting.
    fn is_accurate(&self, solved: &Solved, learned: &CampaignResult) -> bool {
        let counted = learned.reliability();
        solved.values.iter().zip(&self.places).zip(&self.problem.targets).all(
            |((value, (curve, column)), target)| {
                let error = TargetCampaign::surrogate_error(learned, *curve, *column);
                let p = value.estimate.probability;
                let point = counted[*curve][*column];
                let both = point.standard_error.hypot(value.estimate.standard_error);
                let allowed = p.max(1.0 - target.reliability);
                TargetCampaign::is_accurate(error, allowed)
                    && (1.0 - point.reliability - p).abs() <= AGREE * both
            },
        )
    }
}

/// Finds the cheapest design that meets the targets, with at most `budget` simulations besides those of the study.
///
/// # Errors
/// [`OptimiseError`].
pub fn optimise(
    study: &StudyBasis,
    problem: &DesignProblem,
    budget: usize,
    simulate: &mut Simulate<'_>,
    progress: &mut dyn FnMut(OptimisationProgress),
) -> Result<OptimisationResult, OptimiseError> {
    let mut campaign = TargetCampaign::new(study, problem);
    let before = campaign.simulations();
    let context = Context::new(study, problem, &campaign);
    let present = problem.present(context.reference);
    let start: Vec<f64> = problem.quantities.iter().zip(&present).map(|(q, v)| place(q, *v)).collect();
    let middle = vec![0.5; start.len()];
    let dimension = study.problem.inputs.dimension();
    let visit = (VISIT.0 + dimension).min(VISIT.1);
    let allowed = problem.targets.iter().map(|target| 1.0 - target.reliability).fold(1.0, f64::min);

    let mut learned = campaign.learn(context.reference, 0, allowed, simulate)?;
    // The design of the last campaign with simulations, and whether it ended by its own rule.
    let mut last: Option<(InputModel, bool)> = None;
    let mut known = vec![start.clone(), middle];
    let mut round = 0;
    let (solved, reason) = loop {
        round += 1;
        let solved = {
            let mut reliability = context.reliability(&learned, &known[0]);
            solve(&mut reliability, &known)
        };
        let added = campaign.simulations() - before;
        progress(OptimisationProgress { round, cost: solved.cost, feasible: solved.feasible, added });
        known = vec![solved.y.clone()];
        let pf = solved.least_probability(problem);
        let values = values_of(problem, &solved.y);
        let inputs = context.inputs(&values)?;
        let near = last.as_ref().is_some_and(|(at, _)| context.are_near(&inputs, at));
        let ended = last.as_ref().is_some_and(|(_, ended)| *ended);
        if near && ended {
            // The surrogates of the last campaign, assessed at the optimum itself.
            learned = campaign.learn(&inputs, 0, pf, simulate)?;
            let reliability = context.reliability(&learned, &solved.y);
            let values = reliability.targets(&solved.y).unwrap_or_default();
            let solved = Solved { values, ..solved.clone() };
            if context.is_accurate(&solved, &learned) {
                break (solved, None);
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
            break (solved, Some(reason));
        }
        let count = if near { left } else { visit.min(left) };
        learned = campaign.learn(&inputs, count, pf, simulate)?;
        let ended = learned.stop != StopReason::Budget;
        last = Some((inputs, ended));
    };
    let added = campaign.simulations() - before;
    let at_present = campaign.learn(context.reference, 0, allowed, simulate)?;
    let confirmed = reason.is_none();
    let stopped_because =
        reason.unwrap_or_else(|| "the optimum and the reliabilities simulated there agree".to_owned());
    let evaluations = Simulations { study: before, added };
    let finding = Finding { solved, confirmed, stopped_because, evaluations, present };
    Ok(result(&context, &finding, &learned, &at_present))
}

fn values_of(problem: &DesignProblem, y: &[f64]) -> Vec<f64> {
    problem.quantities.iter().zip(y).map(|(q, y)| super::reliability::value(q, *y)).collect()
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

/// What the loop has found.
struct Finding {
    solved: Solved,
    confirmed: bool,
    stopped_because: String,
    evaluations: Simulations,
    present: Vec<f64>,
}

fn result(
    context: &Context<'_>,
    finding: &Finding,
    learned: &CampaignResult,
    at_present: &CampaignResult,
) -> OptimisationResult {
    let problem = context.problem;
    let Finding { solved, present, .. } = finding;
    let values = values_of(problem, &solved.y);
    let targets = targets(context, solved, learned, at_present);
    let variance = |target: &OptimisedTarget| {
        let beta = -standard_normal_quantile(1.0 - target.reliability);
        (target.multiplier * target.standard_error / standard_normal_pdf(beta).max(1e-300)).powi(2)
    };
    let cost_standard_error = targets.iter().map(variance).sum::<f64>().sqrt();
    let quantity = |k: usize| {
        let quantity = &problem.quantities[k];
        let (was, is) = (present[k], values[k]);
        let si = quantity.unit.si;
        let at = solved.y[k];
        let on_bound = match at {
            at if at < ON_BOUND => Some(Bound::Lower),
            at if at > 1.0 - ON_BOUND => Some(Bound::Upper),
            _ => None,
        };
        let spread = quantity.kind.is_spread();
        let scale = if spread { was.abs() } else { (quantity.upper - quantity.lower).abs() };
        let advice = match is - was {
            change if change.abs() <= KEPT * scale => Advice::Keep,
            change if change < 0.0 && spread => Advice::Tighten,
            _ if spread => Advice::Loosen,
            change if change < 0.0 => Advice::Lower,
            _ => Advice::Raise,
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
            advice,
            cost_before: quantity.cost_at(was).0,
            cost_after: quantity.cost_at(is).0,
        }
    };
    OptimisationResult {
        feasible: solved.feasible,
        confirmed: finding.confirmed,
        stopped_because: finding.stopped_because.clone(),
        evaluations: finding.evaluations,
        cost_before: problem.cost(present),
        cost: solved.cost,
        cost_standard_error,
        quantities: (0..values.len()).map(quantity).collect(),
        targets,
        front: front(context, solved, learned),
        grades: solved.grades.map(|search| Grades {
            examined: search.examined,
            proved: search.proved,
            relaxed_cost: solved.relaxed_cost,
        }),
        values,
    }
}

fn targets(
    context: &Context<'_>,
    solved: &Solved,
    learned: &CampaignResult,
    at_present: &CampaignResult,
) -> Vec<OptimisedTarget> {
    let counted = learned.reliability();
    let counted_before = at_present.reliability();
    let target = |i: usize| {
        let target = &context.problem.targets[i];
        let (curve, column) = context.places[i];
        let value = &solved.values[i];
        let surrogate = TargetCampaign::surrogate_error(learned, curve, column);
        let standard_error = surrogate.hypot(value.estimate.standard_error);
        let reliability = 1.0 - value.estimate.probability;
        let point = counted[curve][column];
        let was = counted_before[curve][column];
        OptimisedTarget {
            name: target.name.clone(),
            cycles: target.cycles,
            target: target.reliability,
            before: was.reliability,
            standard_error_before: was.standard_error,
            reliability,
            standard_error,
            counted: point.reliability,
            counted_standard_error: point.standard_error,
            active: value.beta - context.constraints[i].beta < ACTIVE || solved.multipliers[i] > 0.0,
            met: reliability + REACH * standard_error >= target.reliability,
            multiplier: solved.multipliers[i],
        }
    };
    (0..context.problem.targets.len()).map(target).collect()
}

/// Least costs for stricter and looser targets, on the last surrogates.
fn front(context: &Context<'_>, solved: &Solved, learned: &CampaignResult) -> Vec<FrontPoint> {
    let mut reliability = context.reliability(learned, &solved.y);
    let allowed: Vec<f64> = context.problem.targets.iter().map(|target| 1.0 - target.reliability).collect();
    let mut point = |factor: f64| {
        let targets: Vec<f64> = allowed.iter().map(|p| 1.0 - factor * p).collect();
        for (constraint, p) in reliability.constraints.iter_mut().zip(&allowed) {
            constraint.beta = -standard_normal_quantile(factor * p);
        }
        let found = solve_relaxed(&mut reliability, std::slice::from_ref(&solved.y));
        FrontPoint { factor, targets, cost: found.feasible.then_some(found.cost) }
    };
    let mut points: Vec<FrontPoint> =
        FRONT.into_iter().filter(|factor| allowed.iter().all(|p| factor * p < 1.0)).map(&mut point).collect();
    let own = FrontPoint {
        factor: 1.0,
        targets: context.problem.targets.iter().map(|target| target.reliability).collect(),
        cost: solved.feasible.then_some(solved.relaxed_cost),
    };
    let place = points.iter().position(|point| point.factor < 1.0).unwrap_or(points.len());
    points.insert(place, own);
    points
}
