//! ProblemReader of the file of an optimisation problem, TOML; every fault is reported at once.

use super::problem::{DesignProblem, DesignQuantity, Grade, PrintedUnit, QuantityKind, ReliabilityTarget};
use super::problem_rows::{OneOrMore, ProblemReader, QuantityRow, VariableUnit};
use super::{OptimiseError, ProblemFault};
use crate::statistics::design::InputModel;
use common::random::Distribution;
use common::scene::SceneSource;
use common::scene::expression::read_unit;
use common::scene::quantity::Dimension;
use serde::Deserialize;
use std::path::Path;
use toml::{Table, Value};

/// Relative difference below which two variables have the same value.
const SAME: f64 = 1e-9;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ProblemDocument {
    #[serde(default)]
    quantities: Vec<QuantityRow>,
    #[serde(default)]
    targets: Vec<ReliabilityTargetRow>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ReliabilityTargetRow {
    limit_state: Option<String>,
    cycles: Option<u32>,
    reliability: Value,
}

/// Reads the file of a problem for the scene of a study.
///
/// # Errors
/// [`OptimiseError::Problem`] with all faults.
pub fn read(
    path: &Path,
    source: &SceneSource,
    names: &[(String, String)],
) -> Result<DesignProblem, OptimiseError> {
    let text = std::fs::read_to_string(path).map_err(|error| {
        let file = path.display().to_string();
        OptimiseError::Problem(vec![ProblemFault { file, key: "file".to_owned(), what: error.to_string() }])
    })?;
    parse(&text, &path.display().to_string(), source, names)
}

/// Reads the text of such a file, which messages call `file`; `names` are the design variables of the study, `(key, name of the
/// random variable that stands for it)`.
///
/// # Errors
/// [`OptimiseError::Problem`] with all faults.
pub fn parse(
    text: &str,
    file: &str,
    source: &SceneSource,
    names: &[(String, String)],
) -> Result<DesignProblem, OptimiseError> {
    let scene = source.nominal();
    let inputs = InputModel::from_scene(scene);
    let mut reader = ProblemReader { file, scene, inputs: &inputs, names, faults: vec![] };
    let rows: ProblemDocument = match toml::from_str(text) {
        Ok(rows) => rows,
        Err(error) => {
            reader.fault("file", error.to_string().trim_end().to_owned());
            return Err(OptimiseError::Problem(reader.faults));
        }
    };
    if rows.quantities.is_empty() || rows.targets.is_empty() {
        reader.fault("file", "at least one [[quantities]] and one [[targets]] are needed".to_owned());
    }
    let mut quantities: Vec<DesignQuantity> = Vec::new();
    for (place, row) in rows.quantities.iter().enumerate() {
        let Some(quantity) = reader.quantity(&format!("quantities[{}]", place + 1), row) else { continue };
        let same = |other: &DesignQuantity| {
            other.kind.is_spread() == quantity.kind.is_spread()
                && other.variables.iter().any(|k| quantity.variables.contains(k))
        };
        if let Some(other) = quantities.iter().find(|other| same(other)) {
            let what = format!("{} changes what {} changes already", quantity.name, other.name);
            reader.fault(&format!("quantities[{}].change", place + 1), what);
        }
        quantities.push(quantity);
    }
    let targets: Vec<ReliabilityTarget> = rows
        .targets
        .iter()
        .enumerate()
        .filter_map(|(place, row)| reader.target(&format!("targets[{}]", place + 1), row))
        .collect();
    let problem = DesignProblem { quantities, targets, fixed_bounds: fixed_bounds(source), designs: None };
    if reader.faults.is_empty() {
        reader.check_corners(&problem);
    }
    if reader.faults.is_empty() { Ok(problem) } else { Err(OptimiseError::Problem(reader.faults)) }
}

/// Bounds that the scene gives, by variable.
fn fixed_bounds(source: &SceneSource) -> Vec<[bool; 2]> {
    let document: Table = source.text().parse().unwrap_or_default();
    let rows = document.get("variables").and_then(Value::as_array).cloned().unwrap_or_default();
    let given = |name: &str| {
        let row = rows.iter().find(|row| row.get("name").and_then(Value::as_str) == Some(name));
        ["lower", "upper"].map(|key| row.is_some_and(|row| row.get(key).is_some()))
    };
    source.variables().iter().map(|variable| given(&variable.name)).collect()
}

impl ProblemReader<'_> {
    fn quantity(&mut self, path: &str, row: &QuantityRow) -> Option<DesignQuantity> {
        let before = self.faults.len();
        let changes: Vec<&str> = match &row.change {
            OneOrMore::One(change) => vec![change],
            OneOrMore::More(changes) => changes.iter().map(String::as_str).collect(),
        };
        let key = format!("{path}.change");
        let found: Vec<(usize, &str)> =
            changes.iter().filter_map(|change| self.variable_of(&key, change)).collect();
        if found.len() != changes.len() || found.is_empty() {
            if changes.is_empty() {
                self.fault(&key, "is empty, expected VARIABLE.mean, .std or .tolerance".to_owned());
            }
            return None;
        }
        let word = found[0].1;
        let capability = row.capability.unwrap_or(1.0);
        let kind = match word {
            "mean" => QuantityKind::Mean,
            "std" => QuantityKind::Std,
            _ => QuantityKind::Tolerance { capability },
        };
        if found.iter().any(|(_, other)| *other != word) {
            self.fault(&key, "one quantity changes means, standard deviations or tolerances, not several of them; give each its own [[quantities]]".to_owned());
        }
        if !(capability > 0.0 && capability.is_finite()) {
            self.fault(&format!("{path}.capability"), format!("{capability}: expected above 0"));
        }
        if row.capability.is_some() && word != "tolerance" {
            self.fault(&format!("{path}.capability"), "is for tolerances only".to_owned());
        }
        let variables: Vec<usize> = found.iter().map(|(k, _)| *k).collect();
        let unit = self.unit_of(variables[0]);
        self.check_equal(&key, &variables, kind);
        let grades = self.grades(path, row, word, unit.dimension);
        let (lower, upper) = self.bounds(path, row, variables[0], kind, &unit, &grades);
        let (cost, cost_unit) = self.cost(&format!("{path}.cost"), &row.cost, &unit, &grades)?;
        (self.faults.len() == before).then(|| DesignQuantity {
            name: changes.join(", "),
            variables,
            kind,
            lower,
            upper,
            unit: unit.printed,
            cost,
            cost_unit,
            grades,
        })
    }

    /// Variable and parameter of a key such as `rod_length.std`.
    fn variable_of<'c>(&mut self, key: &str, change: &'c str) -> Option<(usize, &'c str)> {
        if let Some((_, name)) = self.names.iter().find(|(design, _)| design == change) {
            let place = self.scene.variables.iter().position(|variable| variable.name == *name);
            return place.map(|k| (k, "mean"));
        }
        let known = || self.scene.variables.iter().map(|v| v.name.as_str()).collect::<Vec<_>>().join(", ");
        let Some((name, word)) = change.rsplit_once('.') else {
            let what = format!(
                "{change:?}: expected a variable and what changes of it, e.g. {:?}",
                format!("{change}.std")
            );
            self.fault(key, what);
            return None;
        };
        let Some(k) = self.scene.variables.iter().position(|variable| variable.name == name) else {
            let what = format!("there is no random variable {name:?}; there are {}", known());
            self.fault(key, what);
            return None;
        };
        if !["mean", "std", "tolerance"].contains(&word) {
            self.fault(key, format!("{change:?}: allowed after the variable are .mean, .std and .tolerance"));
            return None;
        }
        if word != "mean" && self.scene.variables[k].distribution.is_constant() {
            self.fault(key, format!("{change:?}: a constant has no spread"));
            return None;
        }
        if matches!(self.scene.variables[k].distribution, Distribution::Triangular(_)) {
            let what =
                "a triangular variable is given by its bounds and its mode, which an optimum does not change";
            self.fault(key, format!("{change:?}: {what}"));
            return None;
        }
        Some((k, word))
    }

    fn unit_of(&self, k: usize) -> VariableUnit {
        let symbol = self.scene.variables[k].unit.clone();
        match read_unit(&symbol) {
            Ok(unit) => VariableUnit {
                dimension: unit.dimension,
                printed: PrintedUnit { symbol, si: unit.multiply / unit.divide },
            },
            // A unit of the simulator, which is only displayed.
            Err(_) => VariableUnit { dimension: Dimension::NONE, printed: PrintedUnit { symbol, si: 1.0 } },
        }
    }

    /// Variables of one quantity have the same value in the study and the same unit.
    fn check_equal(&mut self, key: &str, variables: &[usize], kind: QuantityKind) {
        let value = |k: usize| kind.of(&self.scene.variables[k].distribution);
        let first = variables[0];
        let differs = variables.iter().copied().find(|k| {
            (value(*k) - value(first)).abs() > SAME * value(first).abs()
                || self.unit_of(*k).dimension != self.unit_of(first).dimension
        });
        if let Some(other) = differs {
            let name = |k: usize| &self.scene.variables[k].name;
            let what = format!(
                "{} and {} have different values in the study; give each its own [[quantities]]",
                name(first),
                name(other)
            );
            self.fault(key, what);
        }
    }

    fn bounds(
        &mut self,
        path: &str,
        row: &QuantityRow,
        variable: usize,
        kind: QuantityKind,
        unit: &VariableUnit,
        grades: &[Grade],
    ) -> (f64, f64) {
        if !row.grades.is_empty() {
            if row.lower.is_some() || row.upper.is_some() {
                self.fault(path, "give either grades, or lower and upper, not both".to_owned());
            }
            let width = |grade: Option<&Grade>| grade.map_or(1.0, |grade| grade.width);
            return (width(grades.first()), width(grades.last()));
        }
        let share = kind.is_spread().then(|| self.scene.variables[variable].distribution.parent_mean().abs());
        let mut bound = |name: &str, value: &Option<Value>| match value {
            Some(value) => self.number(&format!("{path}.{name}"), value, unit, share),
            None => {
                self.fault(&format!("{path}.{name}"), "is missing".to_owned());
                None
            }
        };
        let (lower, upper) = (bound("lower", &row.lower), bound("upper", &row.upper));
        let (Some(lower), Some(upper)) = (lower, upper) else { return (0.0, 1.0) };
        let (from, to) = (self.shown(lower, unit), self.shown(upper, unit));
        if kind.is_spread() && lower <= 0.0 {
            self.fault(&format!("{path}.lower"), format!("{from}: a spread is above 0"));
        }
        if lower >= upper {
            self.fault(&format!("{path}.lower"), format!("{from} is not below upper, {to}"));
        }
        (lower, upper)
    }

    fn shown(&self, value: f64, unit: &VariableUnit) -> String {
        let number = format!("{}", (value / unit.printed.si * 1e9).round() / 1e9);
        if unit.printed.symbol.is_empty() { number } else { format!("{number} {}", unit.printed.symbol) }
    }

    fn target(&mut self, path: &str, row: &ReliabilityTargetRow) -> Option<ReliabilityTarget> {
        let before = self.faults.len();
        let name = row.limit_state.as_deref().unwrap_or("total");
        let known: Vec<&str> = self.scene.limit_states.iter().map(|limit| limit.name.as_str()).collect();
        let limit_state = known.iter().position(|other| *other == name);
        if limit_state.is_none() && name != "total" {
            let what = format!("there is no limit state {name:?}; there are {}, total", known.join(", "));
            self.fault(&format!("{path}.limit_state"), what);
        }
        let all = self.scene.life.checkpoints();
        let cycles = row.cycles.unwrap_or(all[all.len() - 1]);
        let checkpoint = all.iter().position(|other| *other == cycles);
        if checkpoint.is_none() {
            let (first, last) = (all[0], all[all.len() - 1]);
            let every = self.scene.life.checkpoint_every;
            let what = if all.len() > 1 {
                format!("{cycles}: expected a checkpoint of the study, {first} to {last} by {every}")
            } else {
                format!("{cycles}: the study has no life, so a target has no cycles; remove the key")
            };
            self.fault(&format!("{path}.cycles"), what);
        }
        let plain = VariableUnit {
            dimension: Dimension::NONE,
            printed: PrintedUnit { symbol: String::new(), si: 1.0 },
        };
        let key = format!("{path}.reliability");
        let reliability = self.number(&key, &row.reliability, &plain, None).unwrap_or(f64::NAN);
        if self.faults.len() == before && !(reliability > 0.0 && reliability < 1.0) {
            self.fault(&key, format!("{reliability}: expected above 0 and below 1"));
        }
        let checkpoint = checkpoint.filter(|_| self.faults.len() == before)?;
        let name = if all.len() > 1 { format!("R {name} at {cycles}") } else { format!("R {name}") };
        Some(ReliabilityTarget { name, limit_state, checkpoint, cycles, reliability })
    }

    /// Every distribution must exist where all quantities lie on bounds.
    fn check_corners(&mut self, problem: &DesignProblem) {
        for (place, quantity) in problem.quantities.iter().enumerate() {
            let others: Vec<usize> = (0..problem.quantities.len())
                .filter(|other| {
                    *other != place
                        && problem.quantities[*other].variables.iter().any(|k| quantity.variables.contains(k))
                })
                .collect();
            for (bound, value) in [("lower", quantity.lower), ("upper", quantity.upper)] {
                let mut values = problem.present(self.inputs);
                values[place] = value;
                let with_others = |bound: fn(&DesignQuantity) -> f64| {
                    let mut values = values.clone();
                    others.iter().for_each(|o| values[*o] = bound(&problem.quantities[*o]));
                    values
                };
                let corners = [values.clone(), with_others(|q| q.lower), with_others(|q| q.upper)];
                let error = corners.iter().find_map(|values| problem.variables(self.inputs, values).err());
                if let Some(error) = error {
                    let unit = self.unit_of(quantity.variables[0]);
                    let what = format!("{}: {error} [SI]", self.shown(value, &unit));
                    self.fault(&format!("quantities[{}].{bound}", place + 1), what);
                }
            }
        }
    }
}

#[cfg(test)]
#[path = "problem_file_tests.rs"]
mod tests;
