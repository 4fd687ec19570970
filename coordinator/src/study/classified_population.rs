//! The population that a campaign classifies: a Monte Carlo population, and where failures are too rare for
//! any, one conditional on an intermediate event.

use super::rare::conditional_population;
use super::{Plan, Surrogate};
use crate::statistics::design::{Population, Stream, open_stream};
use crate::statistics::reliability::Condition;

/// Relative change of a failure probability between two conditional populations below which it counts as
/// settled.
const SETTLED: f64 = 0.05;
/// Change between two draws over the coefficient of variation of each, about one standard deviation of the
/// difference, up to which it counts as settled too.
const SCATTER: f64 = 1.5;
/// Conditional populations after which it is taken as it is.
const MOST_DRAWS: u32 = 10;
/// Samples of a level at first: a probability of 1e-9 is then known to about 6 %.
const SAMPLES: usize = 100_000;
/// Most samples of a level, drawn where failures lie so that the chains of fewer are too much alike.
const MOST_SAMPLES: usize = 400_000;
/// Coefficient of variation of a rare failure probability above which more samples are drawn, over the one
/// wanted of others: levels and chains cost a factor of about two.
const RARE_COV: f64 = 2.0;

/// Standard deviation of a failure probability by sampling, over the share of the population that cannot be simulated, below
/// which more samples add nothing to its interval [1].
const WITHIN: f64 = 0.05;

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
    /// Samples of a level.
    samples: usize,
    /// True if the last change left the population much as it was: it grew, or was drawn again without a
    /// contradicted prediction.
    pub(super) similar: bool,
    /// True if a prediction was contradicted since the last change.
    contradicted: bool,
    /// Failure probability when the last conditional population was replaced [1].
    pf_before: Option<f64>,
}

impl ClassifiedPopulation {
    /// A population of independent samples of the variables.
    pub(super) fn new(population: Population) -> Self {
        Self {
            population,
            condition: Condition::NONE,
            unconditional: None,
            draws: 0,
            samples: SAMPLES,
            similar: false,
            contradicted: false,
            pf_before: None,
        }
    }

    /// True if failures are too rare for an unconditional population: the population is conditional, or will be
    /// at the next stop with the failed share of the system `failed` [1].
    /// Where more of the population is `barred` [1], that will not be.
    pub(super) fn is_rare(&self, plan: &Plan, failed: f64, barred: f64) -> bool {
        let is_resolved = self.coefficient_of_variation(failed) <= plan.targets.cov
            || self.is_within_barred(failed, barred);
        self.is_conditional() || (!is_resolved && self.size_needed(plan, failed).is_none())
    }

    /// True if the sampling of the failure probability that belongs to the share `failed` of the points [1] adds nothing to an
    /// interval that contains the share `barred` [1].
    pub(super) fn is_within_barred(&self, failed: f64, barred: f64) -> bool {
        let counted = failed.max(1.0 / self.population.len() as f64);
        let std = self.coefficient_of_variation(failed) * counted * self.condition.probability;
        std <= WITHIN * barred
    }

    /// Has a conditional population drawn anew before the next stop, after a contradicted prediction: the region
    /// it was drawn in may not be the one that fails.
    pub(super) fn require_another_draw(&mut self) {
        self.contradicted = true;
        self.pf_before = None;
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

    /// Enlarges an unconditional population to the first of these sizes that is larger; returns true if it did.
    pub(super) fn grow_to_next(&mut self, sizes: &[usize]) -> bool {
        let present = self.population.len();
        let size = sizes.iter().copied().find(|size| *size > present && self.unconditional.is_none());
        size.map(|size| self.population.grow_to(size)).is_some()
    }

    /// Enlarges the population to the size that the coefficient of variation requires, if that is allowed; returns true if it did.
    pub(super) fn grow_if_needed(&mut self, plan: &Plan, failed: f64) -> bool {
        let is_needed = self.coefficient_of_variation(failed) > plan.targets.cov;
        let size = self.size_needed(plan, failed).filter(|_| is_needed);
        size.map(|size| self.population.grow_to(size)).is_some()
    }

    /// Replaces or enlarges the population if the coefficient of variation requires it; returns true if it
    /// did.
    ///
    /// An unconditional population grows as long as the size needed is allowed; beyond that it is replaced by
    /// one conditional on an intermediate event. A conditional population is drawn anew until the failure
    /// probability no longer depends on the draw. `failed` is the failed share of the system [1], `barred` the share of
    /// the population that cannot be simulated [1].
    pub(super) fn replace_if_needed(
        &mut self,
        plan: &Plan,
        surrogates: &[Surrogate],
        failed: f64,
        barred: f64,
    ) -> bool {
        let cov = self.coefficient_of_variation(failed);
        if self.is_within_barred(failed, barred) {
            return false;
        }
        if self.unconditional.is_none() {
            if cov <= plan.targets.cov {
                return false;
            }
            if self.grow_if_needed(plan, failed) {
                self.similar = true;
                return true;
            }
            (self.similar, self.contradicted) = (false, false);
        } else {
            let pf = self.condition.probability * failed;
            // Two draws without any failure: simulations on the last level have not changed that.
            // Two draws differ by their own scatter, too.
            let change = SETTLED.max(SCATTER * cov);
            let settled = |before: f64| {
                if failed > 0.0 { (pf / before - 1.0).abs() < change } else { before == 0.0 }
            };
            if self.draws >= MOST_DRAWS {
                return false;
            }
            self.similar = !std::mem::take(&mut self.contradicted);
            if self.pf_before.is_some_and(settled) {
                let excess = (cov / (RARE_COV * plan.targets.cov)).powi(2);
                if failed == 0.0 || excess <= 1.0 || self.samples == MOST_SAMPLES {
                    return false;
                }
                // A multiple of ten, as a level needs.
                let wanted = (SAMPLES as f64 * excess / 10.0).ceil() as usize * 10;
                self.samples = wanted.min(MOST_SAMPLES);
            }
            self.pf_before = Some(pf);
        }
        self.draw(plan, surrogates);
        true
    }

    /// Replaces the population by a new one conditional on an intermediate event.
    pub(super) fn draw(&mut self, plan: &Plan, surrogates: &[Surrogate]) {
        let mut rng = open_stream(plan.settings.seed, Stream::Subset(self.draws));
        let (drawn, condition) =
            conditional_population(self.unconditional(), surrogates, self.samples, &mut rng);
        self.unconditional.get_or_insert(std::mem::replace(&mut self.population, drawn));
        self.condition = condition;
        self.draws += 1;
    }

    /// True if the population is conditional on an event.
    pub(super) fn is_conditional(&self) -> bool {
        self.unconditional.is_some()
    }

    /// Adds the change of the failure probability by the last draw, from `before` [1] to that of the share `failed`
    /// [1], to the coefficient of variation of the event.
    pub(super) fn add_change(&mut self, before: f64, failed: f64) {
        let now = self.condition.probability * failed;
        if now > 0.0 {
            self.condition.cov = self.condition.cov.hypot(before / now - 1.0);
        }
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
