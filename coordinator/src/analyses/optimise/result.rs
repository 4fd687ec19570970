//! Result of an optimisation as data; the fields are the keys of its JSON.

use serde::Serialize;

/// What the optimum asks for, compared with the study's design.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Advice {
    /// A smaller spread.
    Tighten,
    /// A larger spread.
    Loosen,
    /// A larger mean.
    Raise,
    /// A smaller mean.
    Lower,
    /// No change beyond one hundredth.
    Keep,
}

/// A bound that an optimum lies on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Bound {
    /// The lower bound.
    Lower,
    /// The upper bound.
    Upper,
}

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
    /// Bound on which the optimum lies.
    pub on_bound: Option<Bound>,
    /// What changes against the study.
    pub advice: Advice,
    /// Cost in the study and at the optimum.
    pub cost_before: f64,
    /// Cost at the optimum.
    pub cost_after: f64,
}

/// A target before and at the optimum.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OptimisedTarget {
    /// Name, e.g. `R wear at 8000`.
    pub name: String,
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
    /// True if the target is met within its 95 % interval.
    pub met: bool,
    /// Rise of the cost per unit of a larger reliability index; 0 if the target is not active.
    pub multiplier: f64,
}

/// A point of the front of cost against reliability.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrontPoint {
    /// Factor on the failure probability that each target allows [1].
    pub factor: f64,
    /// Targets `(targets,)` [1].
    pub targets: Vec<f64>,
    /// Least cost, with continuous quantities; `None` if no design within the bounds meets these targets.
    pub cost: Option<f64>,
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
    /// True if a design within the bounds meets all targets; else the design is the one that comes nearest.
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
