//! Result of an optimisation as data; the fields are the keys of its JSON.

use crate::results::summary::{ReliabilityRange, StudySummary};
use crate::statistics::reliability::REACH;
use serde::Serialize;

/// A quantity of the design before and at the optimum.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OptimisedQuantity {
    /// Name: the key it changes.
    pub name: String,
    /// Unit of the values.
    pub unit: String,
    /// Value in the study [unit].
    pub before: f64,
    /// Value at the optimum [unit].
    pub after: f64,
    /// Lower bound [unit].
    pub lower: f64,
    /// Upper bound [unit].
    pub upper: f64,
    /// Grade at the optimum, if the quantity has grades.
    pub grade: Option<String>,
    /// Bound on which the optimum lies: `lower` or `upper`.
    pub on_bound: Option<&'static str>,
    /// Range that the simulations support: the trust region around the last design simulated, within the bounds [unit].
    pub supported: [f64; 2],
    /// True if these are all values within the bounds.
    pub all_supported: bool,
    /// True if the trust region holds the quantity where it is: the optimum may lie beyond.
    pub held: bool,
    /// What the optimum asks for against the study: to `tighten` or `loosen` a spread, to `raise` or `lower` a mean, or to `keep` what
    /// changes by less than one hundredth.
    pub advice: &'static str,
    /// Cost in the study and at the optimum.
    pub cost_before: f64,
    /// Cost at the optimum.
    pub cost_after: f64,
}

/// What the interval of a reliability says of its target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum TargetState {
    /// The whole interval meets it.
    Met,
    /// The interval contains it, as that of a target on which an optimum lies does.
    MetWithinErrors,
    /// It is missed.
    NotMet,
}

/// Share of the failure probability allowed by which a target may be missed for the tolerance of the search [1].
const TOLERANCE: f64 = 1e-4;

/// A target before and at the optimum.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OptimisedTarget {
    /// Name, e.g. `R wear at 8000`.
    pub name: String,
    /// Index of the limit state; `None` for all together.
    #[serde(skip)]
    pub limit_state: Option<usize>,
    /// Life at which the reliability is wanted [cycles].
    pub cycles: u32,
    /// Least reliability [1].
    pub target: f64,
    /// Reliability of the study's design [1].
    pub before: f64,
    /// Standard error of it [1].
    pub standard_error_before: f64,
    /// Reliability at the optimum, by line sampling over the surrogates [1].
    pub reliability: f64,
    /// Standard error of it, from lines and surrogates [1].
    pub standard_error: f64,
    /// Reliability at the optimum, counted over a population that a campaign there has classified [1].
    pub counted: f64,
    /// Standard error of that [1].
    pub counted_standard_error: f64,
    /// True if the target holds the optimum: a looser one would make it cheaper.
    pub active: bool,
    /// 95 % interval of the reliability at the optimum: lines, surrogates and the numerical errors of the simulations [1].
    pub interval: [f64; 2],
    /// What that interval says of the target.
    pub state: TargetState,
    /// True if the whole interval meets the target, or the bound of a target with a confidence.
    pub met: bool,
    /// Rise of the cost per unit of a larger reliability index; 0 if the target is not active.
    pub multiplier: f64,
    /// Confidence with which the target is to be met, if it has one [1].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub confidence: Option<f64>,
    /// One-sided lower bound of the reliability with that confidence, all errors of the interval included [1].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_least: Option<f64>,
}

impl OptimisedTarget {
    /// The target with the state that its interval gives; `feasible` if the design meets all targets on the surrogates.
    pub(super) fn judged(mut self, feasible: bool) -> Self {
        let [lower, upper] = self.interval;
        self.met = self.at_least.unwrap_or(lower) >= self.target;
        // An optimum lies on its target up to the tolerance of the search.
        let target = self.target - TOLERANCE * (1.0 - self.target);
        self.state = if self.met {
            TargetState::Met
        } else if upper < target || self.at_least.is_some() || (!feasible && self.reliability < target) {
            TargetState::NotMet
        } else {
            TargetState::MetWithinErrors
        };
        self
    }
}

impl OptimisationResult {
    /// The result with the numerical errors in the intervals of its reliabilities, those of `optimum`, the study's answer for the
    /// optimum; and with the share `unknown` of its units, outside of what was simulated, of which all or none may fail [1].
    #[must_use]
    pub fn with_errors_of(mut self, optimum: &StudySummary, unknown: f64) -> Self {
        let judged = |mut target: OptimisedTarget| {
            let row = optimum.reliability.iter().find(|row| row.cycles == target.cycles);
            let name = target.limit_state.map_or("total", |place| optimum.limit_states[place].as_str());
            if let Some(parts) = row.and_then(|row| row.parts.get(name)) {
                let (r, reach) = (target.reliability, REACH * parts.numerical);
                let [own, range] = [target.interval, [r - reach, r + reach]]
                    .map(|[lower, upper]| ReliabilityRange { lower, upper });
                let ReliabilityRange { lower, upper } = own.widened(r, range);
                target.interval = [(lower - unknown).max(0.0), (upper + unknown).min(1.0)];
            }
            target.at_least = target.at_least.map(|bound| (bound - unknown).max(0.0));
            target.judged(self.feasible)
        };
        self.targets = self.targets.into_iter().map(judged).collect();
        self
    }

    /// True if the trust region holds a quantity: a cheaper design, or one nearer to the targets, may lie beyond it.
    pub fn is_held(&self) -> bool {
        self.quantities.iter().any(|quantity| quantity.held)
    }

    /// True if simulations support all designs within the bounds.
    pub fn supports_all(&self) -> bool {
        self.quantities.iter().all(|quantity| quantity.all_supported)
    }
}

/// A point of the front of cost against reliability.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrontPoint {
    /// Factor on the failure probability that each target allows [1].
    pub factor: f64,
    /// Targets `(targets,)` [1].
    pub targets: Vec<f64>,
    /// Least cost, with continuous quantities; `None` if no design meets these targets, or none that simulations support.
    pub cost: Option<f64>,
    /// True if the answer lies beyond what the simulations support.
    pub unsupported: bool,
}

/// Numbers of simulations.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Simulations {
    /// Of the study.
    pub study: usize,
    /// Added at designs.
    pub added: usize,
}

/// The search over grades.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Grades {
    /// Number of combinations examined.
    pub examined: usize,
    /// True if no other combination of the allowed grades is cheaper, by the surrogates.
    pub proved: bool,
    /// Cost if every value between the narrowest and the widest grade were allowed.
    pub relaxed_cost: f64,
}

/// Result of an optimisation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OptimisationResult {
    /// True if a design was found that meets all targets on the surrogates; else the design is the one that comes nearest.
    pub feasible: bool,
    /// True if the optimum was confirmed by simulations there.
    pub confirmed: bool,
    /// Reason for the end, in words.
    pub stopped_because: String,
    /// Numbers of simulations.
    pub evaluations: Simulations,
    /// Cost of the study's design.
    pub cost_before: f64,
    /// Cost of the optimum.
    pub cost: f64,
    /// Standard error of the cost that follows from those of the reliabilities; continuous quantities.
    pub cost_standard_error: f64,
    /// Rise of the cost by the confidence of the targets, with continuous quantities; `None` without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub confidence_cost: Option<f64>,
    /// Quantities of the design.
    pub quantities: Vec<OptimisedQuantity>,
    /// Targets before and at the optimum.
    pub targets: Vec<OptimisedTarget>,
    /// Least cost against stricter and looser targets.
    pub front: Vec<FrontPoint>,
    /// The search over grades, if there are any.
    pub grades: Option<Grades>,
    /// Values of the quantities at the optimum `(q,)` [SI].
    pub values: Vec<f64>,
}
