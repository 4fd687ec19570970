//! One reading of a scene's tables with some of its quantities overridden: the quantities, then the random variables whose
//! nominal values follow from them.

use super::context::{Context, Overrides};
use super::correlations::correlations;
use super::faults::Faults;
use super::measured::MeasuredVariable;
use super::resolve::{Resolved, resolve};
use super::variables::variables;
use crate::random::{Correlation, RandomVariable};
use std::collections::BTreeSet;
use toml::Table;

/// The quantities of a scene and its random variables.
pub(super) struct Reading {
    /// The scene, its variables and correlations still empty.
    pub(super) base: Resolved,
    pub(super) variables: Vec<RandomVariable>,
    /// Those of them that have measured samples.
    pub(super) measured: Vec<MeasuredVariable>,
    pub(super) correlations: Vec<Correlation>,
    /// Parameters that the random variables depend on.
    pub(super) used: BTreeSet<String>,
}

impl Reading {
    /// Reads a scene with these quantities in the place of those written.
    ///
    /// # Errors
    /// Every fault found.
    pub(super) fn of(origin: &str, document: &Table, overrides: &Overrides) -> Result<Self, Faults> {
        let base = resolve(origin, document, overrides).map_err(Faults)?;
        let cx = Context::new(origin, overrides);
        if let Some(parameters) = document.get("parameters").and_then(toml::Value::as_table) {
            cx.read_parameters(parameters);
        }
        let (variables, measured): (Vec<_>, Vec<_>) =
            variables(&cx, &base.variables, &base.seen).into_iter().unzip();
        let names: Vec<&str> = base.variables.iter().map(|row| row.name.as_str()).collect();
        let correlations = correlations(&cx, &base.correlations, &names, &variables);
        if cx.fault_count() > 0 {
            return Err(Faults(cx.take_faults()));
        }
        let used = cx.used_parameters();
        Ok(Self { base, variables, measured: measured.into_iter().flatten().collect(), correlations, used })
    }
}
