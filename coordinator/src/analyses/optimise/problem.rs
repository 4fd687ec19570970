//! An optimisation problem: the quantities of a design with their bounds and costs, and the reliabilities to be reached.

use crate::analyses::designs::Follower;
use crate::analyses::quantity::ShownUnit;
use crate::analyses::scene_settings::written_value;
use crate::statistics::design::{InputModel, with_moments};
use crate::statistics::optimisation::CostModel;
use common::random::{Distribution, LawError};
use common::scene::Scene;
use std::collections::BTreeSet;

/// Parameter of a random variable that a design changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum QuantityKind {
    /// The mean of the variable.
    Mean,
    /// The standard deviation.
    Std,
    /// The width of the tolerance zone, 6 C_p standard deviations.
    Tolerance {
        /// Capability C_p of the process [1].
        capability: f64,
    },
}

impl QuantityKind {
    /// Value of the quantity for a variable [SI].
    pub fn of(self, law: &Distribution) -> f64 {
        match self {
            Self::Mean => law.parent_mean(),
            Self::Std => law.given_std(),
            Self::Tolerance { capability } => 6.0 * capability * law.given_std(),
        }
    }

    /// True for a spread: a standard deviation or a tolerance.
    pub fn is_spread(self) -> bool {
        self != Self::Mean
    }
}

/// A standard tolerance grade.
#[derive(Debug, Clone, PartialEq)]
pub struct Grade {
    /// Name, e.g. `IT7`.
    pub name: String,
    /// Width of the tolerance zone [SI].
    pub width: f64,
}

/// A quantity of the design.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignQuantity {
    /// Name in results: the key it changes, e.g. `rod_length.std`, several joined by `, `.
    pub name: String,
    /// Indices of the random variables it changes, at least one.
    pub variables: Vec<usize>,
    /// Parameter of these variables.
    pub kind: QuantityKind,
    /// Lower bound [SI].
    pub lower: f64,
    /// Upper bound [SI].
    pub upper: f64,
    /// Unit in results.
    pub unit: ShownUnit,
    /// Cost over the quantity in `cost_unit`.
    pub cost: CostModel,
    /// Unit of the quantity in the cost [SI].
    pub cost_unit: f64,
    /// Allowed grades by ascending width; empty if every value between the bounds is allowed.
    pub grades: Vec<Grade>,
}

impl DesignQuantity {
    /// Value at the place y in [0, 1] between the bounds [SI].
    pub fn value(&self, y: f64) -> f64 {
        let Self { lower, upper, .. } = self;
        if self.kind.is_spread() { lower * (upper / lower).powf(y) } else { lower + (upper - lower) * y }
    }

    /// The place y of a value [SI], within [0, 1].
    pub fn place(&self, value: f64) -> f64 {
        let Self { lower, upper, .. } = self;
        let linear = (value - lower) / (upper - lower);
        let y = if self.kind.is_spread() { (value / lower).ln() / (upper / lower).ln() } else { linear };
        if y.is_finite() { y.clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Cost at the value [SI] and its derivative [1/SI].
    pub fn cost_at(&self, value: f64) -> (f64, f64) {
        let (cost, slope) = self.cost.at(value / self.cost_unit);
        (cost, slope / self.cost_unit)
    }
}

/// A reliability to be reached.
#[derive(Debug, Clone, PartialEq)]
pub struct ReliabilityTarget {
    /// Name in results, e.g. `R wear at 8000`.
    pub name: String,
    /// Index of the limit state; `None` for all together.
    pub limit_state: Option<usize>,
    /// Index of the checkpoint of the study.
    pub checkpoint: usize,
    /// Life at which the reliability is wanted [cycles].
    pub cycles: u32,
    /// Least reliability [1].
    pub reliability: f64,
    /// One-sided confidence with which it is to hold, over the errors of lines, surrogates and simulations [1].
    pub confidence: Option<f64>,
}

/// What is to be minimised: the sum of the costs, such that every target is met.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DesignProblem {
    /// Quantities of the design, at least one.
    pub quantities: Vec<DesignQuantity>,
    /// Reliabilities to be reached, at least one.
    pub targets: Vec<ReliabilityTarget>,
    /// Which bounds of each variable stay where they are, the lower and the upper one; none if there are fewer entries.
    pub fixed_bounds: Vec<[bool; 2]>,
    /// Which variables have a standard deviation that is a share of the mean; none if there are fewer entries.
    pub relative_spreads: Vec<bool>,
    /// In a study of designs: its random variables, design variables among them, in whose coordinates the surrogates are.
    pub augmented: Option<InputModel>,
    /// Variables whose distributions follow design variables.
    pub followers: Vec<Follower>,
}

impl DesignProblem {
    /// Values of the quantities at the places y `(q,)` [SI].
    pub fn values(&self, y: &[f64]) -> Vec<f64> {
        self.quantities.iter().zip(y).map(|(quantity, y)| quantity.value(*y)).collect()
    }

    /// Values of the quantities in a study with these inputs `(q,)` [SI].
    pub fn present(&self, inputs: &InputModel) -> Vec<f64> {
        let own = |quantity: &DesignQuantity| quantity.kind.of(&inputs.variables()[quantity.variables[0]]);
        self.quantities.iter().map(own).collect()
    }

    /// Distributions of the variables with these values of the quantities `(q,)` [SI].
    ///
    /// # Errors
    /// [`LawError`] of the first distribution that does not exist.
    pub fn variables(&self, inputs: &InputModel, values: &[f64]) -> Result<Vec<Distribution>, LawError> {
        let mut moments: Vec<(f64, f64)> =
            inputs.variables().iter().map(|law| (law.parent_mean(), law.given_std())).collect();
        let mut changed = vec![false; moments.len()];
        for follower in &self.followers {
            let Some(value) = self.value_of(follower.leader, values) else { continue };
            let shift = value - inputs.variables()[follower.leader].parent_mean();
            changed[follower.variable] = true;
            let (mean, std) = &mut moments[follower.variable];
            (*mean, *std) = (*mean + follower.mean * shift, *std + follower.std * shift);
        }
        let mut quantities: Vec<_> = self.quantities.iter().zip(values).collect();
        // A spread of its own takes the place of one that follows the mean.
        quantities.sort_by_key(|(quantity, _)| quantity.kind.is_spread());
        for (quantity, value) in quantities {
            for k in &quantity.variables {
                changed[*k] = true;
                let (mean, std) = &mut moments[*k];
                match quantity.kind {
                    QuantityKind::Mean => {
                        if self.relative_spreads.get(*k) == Some(&true) {
                            *std *= (value / *mean).abs();
                        }
                        *mean = *value;
                    }
                    QuantityKind::Std => *std = *value,
                    QuantityKind::Tolerance { capability } => *std = value / (6.0 * capability),
                }
            }
        }
        let law = |(k, law): (usize, &Distribution)| {
            let fixed = self.fixed_bounds.get(k).copied().unwrap_or_default();
            if changed[k] { with_moments(law, moments[k].0, moments[k].1, fixed) } else { Ok(law.clone()) }
        };
        inputs.variables().iter().enumerate().map(law).collect()
    }

    /// The input model with these values of the quantities `(q,)` [SI], in the coordinates of `inputs`.
    ///
    /// # Errors
    /// Those of [`DesignProblem::variables`].
    pub fn inputs(&self, inputs: &InputModel, values: &[f64]) -> Result<InputModel, LawError> {
        let changed = InputModel::new(self.variables(inputs, values)?, inputs.copula.clone());
        Ok(changed.standardised_as(self.augmented.as_ref().unwrap_or(inputs)))
    }

    /// Value of the quantity that is the mean of variable `k` [SI]; `None` if there is none.
    fn value_of(&self, k: usize, values: &[f64]) -> Option<f64> {
        let is_mean = |q: &DesignQuantity| q.kind == QuantityKind::Mean && q.variables.contains(&k);
        self.quantities.iter().position(is_mean).map(|i| values[i])
    }

    /// Indices of the random variables whose distributions the quantities change, ascending.
    pub fn changed_variables(&self) -> Vec<usize> {
        let own = || self.quantities.iter().flat_map(|quantity| quantity.variables.iter().copied());
        let led =
            self.followers.iter().filter(|follower| own().any(|k| k == follower.leader)).map(|f| f.variable);
        own().chain(led).collect::<BTreeSet<_>>().into_iter().collect()
    }

    /// Cost of a design `(q,)` [SI].
    pub fn cost(&self, values: &[f64]) -> f64 {
        self.quantities.iter().zip(values).map(|(quantity, value)| quantity.cost_at(*value).0).sum()
    }

    /// The changes `VARIABLE.mean=VALUE` and `VARIABLE.std=VALUE`, in the form of `what-if --set`, that make the design `values` `(q,)`
    /// [SI] of a scene.
    ///
    /// # Errors
    /// [`LawError`] if a distribution of the design does not exist.
    pub fn settings(&self, scene: &Scene, values: &[f64]) -> Result<Vec<String>, LawError> {
        let laws = self.variables(&InputModel::from_scene(scene), values)?;
        let settings = self.changed_variables().into_iter().flat_map(|k| {
            let (variable, law) = (&scene.variables[k], &laws[k]);
            let setting = |key: &str, value: f64| {
                format!("{}.{key}={}", variable.name, written_value(value, &variable.unit))
            };
            let std = (!law.is_constant()).then(|| setting("std", law.given_std()));
            [Some(setting("mean", law.parent_mean())), std].into_iter().flatten()
        });
        Ok(settings.collect())
    }

    /// True if a quantity has grades.
    pub fn is_discrete(&self) -> bool {
        self.quantities.iter().any(|quantity| !quantity.grades.is_empty())
    }
}
