//! Rows of the file of an optimisation problem as written, and the reader of their numbers.

use super::ProblemFault;
use super::problem::PrintedUnit;
use crate::statistics::design::InputModel;
use common::scene::Scene;
use common::scene::expression::{ExpressionError, evaluate};
use common::scene::quantity::Dimension;
use serde::Deserialize;
use toml::Value;

/// A text, or a list.
#[derive(Deserialize)]
#[serde(untagged)]
pub(super) enum OneOrMore {
    One(String),
    More(Vec<String>),
}

/// A quantity of the design as written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct QuantityRow {
    pub change: OneOrMore,
    pub lower: Option<Value>,
    pub upper: Option<Value>,
    pub capability: Option<f64>,
    #[serde(default)]
    pub grades: Vec<String>,
    pub diameter: Option<Value>,
    pub cost: CostRow,
}

/// Cost of a quantity as written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CostRow {
    pub model: String,
    pub c0: Option<f64>,
    pub c1: Option<f64>,
    pub k: Option<f64>,
    pub unit: Option<String>,
    pub points: Option<Vec<(Value, f64)>>,
}

/// The rows of a file for a scene, and the faults so far.
pub(super) struct ProblemReader<'a> {
    pub file: &'a str,
    pub scene: &'a Scene,
    pub inputs: &'a InputModel,
    /// Design variables of the study: key, and name of the random variable that stands for it.
    pub names: &'a [(String, String)],
    pub faults: Vec<ProblemFault>,
}

/// Dimension of a variable, and the unit in which it is printed.
pub(super) struct VariableUnit {
    pub dimension: Dimension,
    pub printed: PrintedUnit,
}

impl ProblemReader<'_> {
    /// Records a fault of this key.
    pub(super) fn fault(&mut self, key: &str, what: String) {
        self.faults.push(ProblemFault { file: self.file.to_owned(), key: key.to_owned(), what });
    }

    /// A quantity in SI; `share`: what a percentage refers to.
    pub(super) fn number(
        &mut self,
        key: &str,
        value: &Value,
        unit: &VariableUnit,
        share: Option<f64>,
    ) -> Option<f64> {
        let text = match value {
            Value::String(text) => text.clone(),
            other => other.to_string(),
        };
        let bare = matches!(value, Value::Float(_) | Value::Integer(_));
        if bare && unit.dimension != Dimension::NONE {
            self.fault(key, format!("{text} has no unit, expected e.g. \"{text} {}\"", unit.printed.symbol));
            return None;
        }
        let mut nothing =
            |name: &str| Err(ExpressionError::UnknownName { name: name.to_owned(), nearest: None });
        let relative = text.trim_end().ends_with('%');
        let what = match evaluate(&text, &mut nothing) {
            Err(error) => format!("{text:?}: {error}"),
            Ok(found) if !found.value.is_finite() => format!("{text:?} is not finite"),
            Ok(found) if relative && share.is_some() => return share.map(|of| of * found.value),
            Ok(found) if found.dimension == unit.dimension => return Some(found.value),
            Ok(found) => format!("{text:?} is {}, expected {}", found.dimension, unit.dimension),
        };
        self.fault(key, what);
        None
    }
}
