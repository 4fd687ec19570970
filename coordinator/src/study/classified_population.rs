//! The population that a campaign classifies: a Monte Carlo population, and where failures are too rare for
//! any, one conditional on an intermediate event.

use super::plan::{Plan, Problem};
use super::rare::conditional_population;
use super::surrogates::Surrogate;
use crate::statistics::design::{Population, Stream, open_stream};
use crate::statistics::reliability::Condition;

/// Relative change of a failure probability between two conditional populations below which it counts as
/// settled.
const SETTLED: f64 = 0.1;
/// Conditional populations after which it is taken as it is.
const MOST_DRAWS: u32 = 8;

/// The population that a campaign classifies.
#[derive(Debug)]
pub struct ClassifiedPopulation {
    /// Points of the population.
    pub population: Population,
    /// The event the points are conditional on.
    pub condition: Condition,
    /// The population before it became conditional; `None` while it is unconditional.
    unconditional: Option<Population>,
    /// Number of conditional populations drawn so far.
    draws: u32,
    /// Failure probability when the last conditional population was replaced [1].
    pf_before: Option<f64>,
}

impl ClassifiedPopulation {
    /// A population of independent samples of the variables.
    pub(super) fn new(population: Population) -> Self {
        Self { population, condition: Condition::NONE, unconditional: None, draws: 0, pf_before: None }
    }

    /// Independent samples of the variables: this population, or the one from before it became conditional.
    pub fn unconditional(&self) -> &Population {
        self.unconditional.as_ref().unwrap_or(&self.population)
    }

    /// Coefficient of variation [1] of the failure probability that belongs to the share `failed` of the
    /// points [1].
    pub fn coefficient_of_variation(&self, failed: f64) -> f64 {
        self.condition.coefficient_of_variation(failed, self.population.len())
    }

    /// Replaces or enlarges the population if the coefficient of variation requires it; returns true if it
    /// did.
    ///
    /// An unconditional population grows as long as the size needed is allowed; beyond that it is replaced by
    /// one conditional on an intermediate event. A conditional population is drawn anew until the failure
    /// probability no longer depends on the draw. `failed` is the failed share of the system [1], `cov` the
    /// coefficient of variation of the failure probability [1].
    pub(super) fn replace_if_needed(
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
            if let Some(size) = self.size_needed(plan, failed) {
                self.population.grow_to(size);
                return true;
            }
        } else {
            let pf = self.condition.probability * failed;
            // A surrogate without any failure is not settled: the simulations on the last level will change
            // it.
            let settled = |before: f64| failed > 0.0 && (pf / before - 1.0).abs() < SETTLED;
            if self.pf_before.is_some_and(settled) || self.draws >= MOST_DRAWS {
                return false;
            }
            self.pf_before = Some(pf);
        }
        let mut rng = open_stream(plan.settings.seed, Stream::Subset(self.draws));
        let (drawn, condition) = conditional_population(problem, self.unconditional(), surrogates, &mut rng);
        let replaced = std::mem::replace(&mut self.population, drawn);
        self.unconditional.get_or_insert(replaced);
        self.condition = condition;
        self.draws += 1;
        true
    }

    /// Size of the population for the target coefficient of variation, 1.1 (1 - P_f) / (P_f cov^2), with a
    /// tenth in reserve; `None` if it exceeds the largest allowed, or if nothing failed.
    fn size_needed(&self, plan: &Plan, failed: f64) -> Option<usize> {
        let (n, largest) = (self.population.len(), plan.largest_population);
        let wanted = 1.1 * (1.0 - failed) / (failed * plan.targets.cov.powi(2));
        let within = failed > 0.0 && wanted <= largest as f64;
        within.then(|| (wanted.ceil() as usize).clamp(n + n / 10 + 1, largest.max(n + n / 10 + 1)))
    }
}
