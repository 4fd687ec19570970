//! Plans of tests that demonstrate a reliability at a life with a confidence: without prior knowledge, and with the reliability of a
//! finished study as prior.
//!
//! From a study follow the prior of R at the life, a beta distribution with the mean and at least the 95 % interval of R, and, unless it
//! is given, the Weibull shape through its lives at R = 0.99 and 0.5, which relates tests of other lengths to the life.

mod text;

pub use text::answer;

use crate::analyses::error::RefusedQuestion;
use crate::analyses::replace::curve_of;
use crate::results::summary::StudySummary;
use crate::statistics::replacement::SurvivalCurve;
use crate::statistics::test_plan::{
    BetaPrior, group_plan, mean_length, pass_probability, reliability_passed, units,
};
use serde::Serialize;

/// Groups of the plans of sudden death.
const GROUPS: [u64; 6] = [1, 2, 3, 5, 8, 12];
/// Probability with which good units shall pass [1].
const GOOD: f64 = 0.9;

/// What is to be demonstrated, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct TestPlanQuestion {
    /// Reliability R0 to be demonstrated [1].
    pub reliability: f64,
    /// Life at which it is [cycles].
    pub at: f64,
    /// Confidence C [1].
    pub confidence: f64,
    /// Most allowed failures of the plans.
    pub allowed: u64,
    /// Lengths of the tests; empty for the life alone, or with a shape shorter and longer ones, too [cycles].
    pub lengths: Vec<f64>,
    /// Number of units that are there: their length of test is sought.
    pub units: Option<u64>,
    /// Weibull shape of the lives [1].
    pub shape: Option<f64>,
    /// Units of a group of which each runs to its first failure.
    pub group: Option<u64>,
    /// Distance of inspections [cycles].
    pub inspect_every: Option<f64>,
    /// Most units that the prior is worth [1].
    pub prior_units: f64,
}

/// A plan of one length.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlanRow {
    /// Length of the test [cycles].
    pub cycles: f64,
    /// Number of failures with which it is passed.
    pub allowed: u64,
    /// Number of units without prior.
    pub units: u64,
    /// Reliability at the life of units of which 90 % of the tests are passed [1].
    pub passes: f64,
    /// With inspections the mean length of a test of units with R0 [cycles].
    pub mean_cycles: Option<f64>,
    /// The plan with the study as prior.
    pub with_prior: Option<PriorPlan>,
}

/// A plan with a prior.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PriorPlan {
    /// Number of units.
    pub units: u64,
    /// Probability over the prior that the test is passed [1].
    pub passed: f64,
    /// That R < R0 although it was passed: the error of the first kind [1].
    pub wrongly_passed: f64,
    /// That it is failed although R >= R0: the error of the second kind [1].
    pub wrongly_failed: f64,
    /// Probability of passing with R = R0, whatever the prior says [1].
    pub passed_at_limit: f64,
}

/// The prior of R at the life.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PriorRow {
    /// Scene of the study.
    pub scene: String,
    /// R by the study with its 95 % interval [1].
    pub reliability: [f64; 3],
    /// Parameter a of the beta distribution [1].
    pub survived: f64,
    /// Parameter b [1].
    pub failed: f64,
    /// P(R >= R0) without any test [1].
    pub confidence: f64,
}

/// Groups of units of which each runs to its first failure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct GroupRow {
    /// Number of groups.
    pub groups: u64,
    /// Mean length to be reached, to the power of the shape [cycles].
    pub cycles: f64,
    /// Reliability at the life of units of which 90 % of the tests are passed [1].
    pub passes: f64,
}

/// The plans that answer the question.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TestPlanReport {
    /// Reliability to be demonstrated [1].
    pub reliability: f64,
    /// Life at which it is [cycles].
    pub at: f64,
    /// Confidence of the demonstration [1].
    pub confidence: f64,
    /// Weibull shape, if it is known [1].
    pub shape: Option<f64>,
    /// True if the shape is that of the study.
    pub shape_of_study: bool,
    /// The prior of R at the life.
    pub prior: Option<PriorRow>,
    /// The plans by length and allowed failures.
    pub plans: Vec<PlanRow>,
    /// Units of a group.
    pub group: Option<u64>,
    /// Plans by groups.
    pub groups: Vec<GroupRow>,
}

/// Weibull shape through the lives of a curve at R = 0.99 and 0.5 [1].
fn shape_of(curve: &SurvivalCurve) -> Option<f64> {
    let (first, median) = (curve.life_at(0.99)?, curve.life_at(0.5)?);
    let shape = (0.5_f64.ln() / 0.99_f64.ln()).ln() / (median / first).ln();
    (first > 0.0 && median > first).then_some(shape)
}

/// The plans, with the curve `name` of a study as prior.
///
/// # Errors
/// [`RefusedQuestion`].
pub fn plan(
    question: &TestPlanQuestion,
    study: Option<(&StudySummary, &str)>,
) -> Result<TestPlanReport, RefusedQuestion> {
    let TestPlanQuestion { reliability, at, confidence, .. } = *question;
    let (mut shape, mut prior) = (question.shape, None);
    if let Some((summary, name)) = study {
        let row = curve_of(summary, name)?;
        let of = |values: &[f64]| SurvivalCurve::new(&row.cycles, values);
        let best = of(&row.reliability);
        if at > best.end() {
            let fault = format!("the study ends at {} cycles; allowed: up to there", best.end());
            return Err(RefusedQuestion::new(format!("--at {at}"), fault));
        }
        shape = shape.or_else(|| shape_of(&best));
        let [lower, upper] = row.limits().map(|limit| of(limit).at(at));
        let r = best.at(at);
        let law = BetaPrior::containing(r, [lower, upper], question.prior_units);
        let (scene, confidence) = (summary.scene.clone(), 1.0 - law.below(reliability));
        let (survived, failed) = (law.survived, law.failed);
        prior = Some((law, PriorRow { scene, reliability: [r, lower, upper], survived, failed, confidence }));
    }
    let fault = "needs the Weibull shape of the lives, which relates them to --at; give --shape, or a study with lives at R = 0.99 \
                 and 0.5";
    let need = |option| shape.ok_or_else(|| RefusedQuestion::new(option, fault));
    let fault = "more than ten million units; allowed: a lower reliability or confidence, or longer tests";
    let too_many = || RefusedQuestion::new("no plan", fault);
    let lengths = match (question.lengths.as_slice(), shape) {
        ([], Some(_)) if question.units.is_none() => [0.5, 1.0, 1.5, 2.0].map(|length| length * at).to_vec(),
        ([], _) => vec![at],
        (given, _) => given.to_vec(),
    };
    let mut plans = Vec::new();
    for allowed in 0..=question.allowed {
        // With given units the length follows from them.
        let lengths = match question.units {
            None => lengths.clone(),
            Some(units) if units <= allowed => {
                let fault = format!("allowed: above the number of allowed failures, {allowed}");
                return Err(RefusedQuestion::new(format!("--units {units}"), fault));
            }
            Some(units) => {
                let seen = reliability_passed(units, allowed, 1.0 - confidence);
                vec![at * (seen.ln() / reliability.ln()).powf(1.0 / need("--units")?)]
            }
        };
        for cycles in lengths {
            let length = cycles / at;
            let power = if cycles.to_bits() == at.to_bits() { 1.0 } else { length.powf(need("--length")?) };
            let seen = reliability.powf(power);
            let found = question.units.or_else(|| units(seen, allowed, confidence));
            let with_prior = prior.as_ref().map(|(law, _)| {
                let units = law.units_for(reliability, allowed, confidence, power)?;
                let [passed, wrongly_passed, wrongly_failed] =
                    law.risks(reliability, (units, allowed), power);
                let passed_at_limit = pass_probability(units, allowed, seen);
                Some(PriorPlan { units, passed, wrongly_passed, wrongly_failed, passed_at_limit })
            });
            // Of the lengths that were not asked for, those without a plan are left out.
            let is_extra = question.lengths.is_empty() && power.to_bits() != 1.0_f64.to_bits();
            if is_extra && (found.is_none() || with_prior == Some(None)) {
                continue;
            }
            let units = found.ok_or_else(too_many)?;
            let mean_cycles = question.inspect_every.map(|every| {
                let shape = need("--inspect-every")?;
                let inspections = (1..).map(|k| f64::from(k) * every / at).take_while(|life| *life < length);
                let lives: Vec<f64> = inspections.chain([length]).collect();
                Ok(at * mean_length(units, allowed, reliability, shape, &lives))
            });
            let mean_cycles = mean_cycles.transpose()?;
            let contradicted = || {
                let fault = format!(
                    "the study speaks against R = {reliability}, and ten million units would not outweigh it; without the study \
                     the plan has {units} units"
                );
                RefusedQuestion::new("no plan with the study as prior", fault)
            };
            let with_prior = with_prior.map(|plan| plan.ok_or_else(contradicted)).transpose()?;
            let passes = reliability_passed(units, allowed, GOOD).powf(1.0 / power);
            plans.push(PlanRow { cycles, allowed, units, passes, mean_cycles, with_prior });
        }
    }
    let mut groups = vec![];
    if let Some(size) = question.group {
        let shape = need("--group")?;
        groups.extend(GROUPS.map(|groups| {
            let (length, passes) = group_plan(groups, size, reliability, confidence, shape);
            GroupRow { groups, cycles: at * length, passes }
        }));
    }
    Ok(TestPlanReport {
        reliability,
        at,
        confidence,
        shape,
        shape_of_study: question.shape.is_none() && shape.is_some(),
        prior: prior.map(|(_, row)| row),
        plans,
        group: question.group,
        groups,
    })
}
