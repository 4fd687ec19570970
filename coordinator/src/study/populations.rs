//! What a campaign classifies: a Monte Carlo population, and where failures are too rare for any, one conditional on an
//! intermediate event.

use super::plan::{Plan, Problem};
use super::rare::conditional_population;
use super::surrogates::Surrogate;
use crate::statistics::design::Population;
use crate::statistics::reliability::Condition;

/// Relative change of a failure probability between two conditional populations below which it counts as settled.
const SETTLED: f64 = 0.1;
/// Conditional populations after which it is taken as it is.
const MOST_DRAWS: u32 = 8;

/// The population that is classified.
#[derive(Debug)]
pub struct LookedAt {
    /// Its points.
    pub population: Population,
    /// What it is conditional on.
    pub condition: Condition,
    /// The population without condition, if this one has one.
    unconditional: Option<Population>,
    /// Conditional populations drawn so far, and the failure probability when the last one was replaced.
    draws: u32,
    pf_before: Option<f64>,
}

impl LookedAt {
    pub(super) fn new(population: Population) -> Self {
        Self { population, condition: Condition::NONE, unconditional: None, draws: 0, pf_before: None }
    }

    /// Independent samples of the variables: this population, or the one there was before it was conditional.
    pub fn unconditional(&self) -> &Population {
        self.unconditional.as_ref().unwrap_or(&self.population)
    }

    /// Coefficient of variation of the probability that a failed share stands for.
    pub fn coefficient_of_variation(&self, failed: f64) -> f64 {
        self.condition.coefficient_of_variation(failed, self.population.len())
    }

    /// Whether another population is needed, which then is the present one: a larger one for the coefficient of variation where
    /// that can be had, else one conditional on an intermediate event; and that again until the failure probability no
    /// longer depends on the draw. `failed` is the system's failed share, `cov` the coefficient of variation.
    pub(super) fn changes(
        &mut self,
        problem: &Problem,
        plan: &Plan,
        surrogates: &[Surrogate],
        failed: f64,
        cov: f64,
    ) -> bool {
        if self.unconditional.is_none() {
            if cov <= plan.targets.cov {
                return false;
            }
            if let Some(wanted) = self.size_wanted(plan, failed) {
                self.population.grow_to(wanted);
                return true;
            }
        } else {
            let pf = self.condition.probability * failed;
            // A surrogate that reaches the limit nowhere knows too little: what was simulated on the last level moves it.
            let settled = |before: f64| failed > 0.0 && (pf / before - 1.0).abs() < SETTLED;
            if self.pf_before.is_some_and(settled) || self.draws >= MOST_DRAWS {
                return false;
            }
            self.pf_before = Some(pf);
        }
        let draw = (plan.settings.seed, self.draws);
        let (drawn, condition) = conditional_population(problem, self.unconditional(), surrogates, draw);
        let replaced = std::mem::replace(&mut self.population, drawn);
        self.unconditional.get_or_insert(replaced);
        self.condition = condition;
        self.draws += 1;
        true
    }

    /// Size of the population that the coefficient of variation asks for, with a tenth in reserve; `None` if it is beyond
    /// the largest, or nothing failed to tell it by.
    fn size_wanted(&self, plan: &Plan, failed: f64) -> Option<usize> {
        let (n, largest) = (self.population.len(), plan.largest_population);
        let wanted = 1.1 * (1.0 - failed) / (failed * plan.targets.cov.powi(2));
        let within = failed > 0.0 && wanted <= largest as f64;
        within.then(|| (wanted.ceil() as usize).clamp(n + n / 10 + 1, largest.max(n + n / 10 + 1)))
    }
}
