//! Reader of the file of an optimisation problem, TOML; every fault is reported at once.

use super::problem::{DesignProblem, DesignQuantity, Grade, QuantityKind, ReliabilityTarget};
use super::problem_costs;
use crate::analyses::designs::{DesignSpace, DesignVariable};
use crate::analyses::quantity::{ShownUnit, checkpoint, limit_state};
use crate::statistics::design::{InputModel, fixed_bounds, relative_spreads};
use common::random::Distribution;
use common::scene::quantity::NUMBER;
use common::scene::{FaultKind, Faults, InputFile, Range, Scene, SceneSource, Section, nearest};

/// Relative difference below which two variables have the same value.
const SAME: f64 = 1e-9;
/// Share of a range by which a bound may lie outside of it, for rounding.
const ROUNDING: f64 = 1e-9;
/// Parameters of a random variable that a quantity may be.
const PARAMETERS: [&str; 3] = ["mean", "std", "tolerance"];

/// Reads the file of a problem for the scene of a study, or for its present design if it has `designs`: their space and the scene
/// that was studied for them.
///
/// # Errors
/// All faults.
pub fn read(
    file: &InputFile,
    source: &SceneSource,
    designs: Option<(&DesignSpace, &Scene)>,
) -> Result<DesignProblem, Faults> {
    let keys = designs.map(|(space, _)| space.quantities()).unwrap_or_default();
    let reader = ProblemReader { scene: source.nominal(), designs: &keys };
    let problem = file.read(|file| {
        let mut rows = ["quantities", "targets"].map(|key| {
            let rows = file.unnamed_rows(key);
            if rows.is_empty() {
                file.inconsistent(key, format!("at least one [[{key}]] is needed"));
            }
            rows
        });
        let quantities: Vec<_> = rows[0].iter_mut().map(|row| reader.quantity(row)).collect();
        let targets = rows[1].iter_mut().filter_map(|row| reader.target(row)).collect();
        for (place, quantity) in quantities.iter().enumerate() {
            let Some(quantity) = quantity else { continue };
            let is_same = |other: &&DesignQuantity| {
                other.kind.is_spread() == quantity.kind.is_spread()
                    && other.variables.iter().any(|k| quantity.variables.contains(k))
            };
            if let Some(other) = quantities[..place].iter().flatten().find(is_same) {
                let message = format!("{} changes what {} changes already", quantity.name, other.name);
                file.inconsistent(&format!("quantities[{}].change", place + 1), message);
            }
        }
        let quantities = quantities.into_iter().flatten().collect();
        let (fixed_bounds, relative_spreads) = (fixed_bounds(source), relative_spreads(source));
        DesignProblem { quantities, targets, fixed_bounds, relative_spreads, ..DesignProblem::default() }
    })?;
    file.refuse_for(reader.impossible_bounds(&problem))?;
    let Some((space, studied)) = designs else { return Ok(problem) };
    for_designs(problem, space, studied, file)
}

/// The problem, read for the present design of a study with the design variables of `space` and the `augmented` scene.
///
/// # Errors
/// A bound lies outside the range of the study, or a random variable does not follow a design
/// variable along a straight line.
fn for_designs(
    problem: DesignProblem,
    space: &DesignSpace,
    augmented: &Scene,
    file: &InputFile,
) -> Result<DesignProblem, Faults> {
    let followers = space.followers()?;
    let mut faults = Vec::new();
    for (place, quantity) in problem.quantities.iter().enumerate() {
        let own = space.quantities().into_iter().filter(|(_, k, _)| quantity.variables.contains(k));
        for (design @ DesignVariable { key, lower: first, upper: last, .. }, k, _) in own {
            let mut refuse = |what: String| faults.push((format!("quantities[{}]", place + 1), what));
            let (lower, upper) = augmented.variables[k].distribution.support();
            let margin = ROUNDING * (upper - lower);
            if quantity.lower < lower - margin || quantity.upper > upper + margin {
                let range = [*first, *last].map(|end| design.with_unit(end)).join(" to ");
                refuse(format!("the study has designs with {key} from {range} only"));
            }
            if let Some(bent) = followers.iter().find(|f| f.leader == k && !f.is_straight) {
                let name = &augmented.variables[bent.variable].name;
                refuse(format!(
                    "the distribution of {name} does not follow {key} along a straight line, which an optimum needs; give the mean \
                     of {name} as a quantity instead"
                ));
            }
        }
    }
    file.refuse_for(faults)?;
    Ok(DesignProblem { augmented: Some(InputModel::from_scene(augmented)), followers, ..problem })
}

/// The rows of a file for a scene. After a fault they are read on with values that have no meaning.
struct ProblemReader<'a> {
    scene: &'a Scene,
    /// Design variables of the study, each with index and name of the random variable that represents it.
    designs: &'a [(&'a DesignVariable, usize, &'a str)],
}

impl ProblemReader<'_> {
    fn quantity(&self, row: &mut Section) -> Option<DesignQuantity> {
        let expected = "VARIABLE.mean, VARIABLE.std or VARIABLE.tolerance, or a list of them";
        let changes = row.text_or_texts("change", expected).unwrap_or_default();
        let found: Vec<_> = changes.iter().filter_map(|change| self.variable_of(row, change)).collect();
        let word = found.first().map(|(_, word)| *word);
        if found.iter().any(|(_, other)| Some(*other) != word) {
            row.inconsistent("change", "one quantity changes means, standard deviations or tolerances, not several of them; give each its own [[quantities]]");
        }
        if word != Some("tolerance") && row.get("capability").is_some() {
            row.inconsistent("capability", "is for tolerances only");
        }
        let capability = row.quantity_or("capability", NUMBER, Range::Positive, 1.0).unwrap_or(1.0);
        let kind = match word {
            Some("tolerance") => QuantityKind::Tolerance { capability },
            Some("std") => QuantityKind::Std,
            _ => QuantityKind::Mean,
        };
        let variables: Vec<usize> = found.iter().map(|(k, _)| *k).collect();
        let unit = variables.first().map(|k| self.unit_of(*k));
        self.check_equal(row, &variables, kind);
        let grades = problem_costs::grades(row, word, unit.as_ref());
        let (lower, upper) = self.bounds(row, variables.first().copied(), kind, &grades);
        let cost = problem_costs::cost(row, unit.as_ref(), &grades);
        row.finish();
        let ((cost, cost_unit), unit) = (cost?, unit?);
        let name = changes.join(", ");
        Some(DesignQuantity { name, variables, kind, lower, upper, unit, cost, cost_unit, grades })
    }

    /// Variable and parameter of a key such as `rod_length.std`; after a typing error those that were meant.
    fn variable_of(&self, row: &Section, change: &str) -> Option<(usize, &'static str)> {
        let variables = self.scene.variables.iter().map(|variable| variable.name.as_str());
        let designs = self.designs.iter().map(|(variable, ..)| variable.key.as_str());
        if nearest(change, designs.clone()).is_some() {
            let (_, k, _) = self.designs[row.meant("change", "design variable", change, designs)?];
            return Some((k, "mean"));
        }
        let Some((name, word)) = change.rsplit_once('.') else {
            let what = "expected a variable and what changes of it";
            row.inconsistent("change", format!("{change:?}: {what}, e.g. \"{change}.std\""));
            return None;
        };
        let k = row.meant("change", "random variable", name, variables);
        let known = PARAMETERS.into_iter().find(|known| *known == word);
        if known.is_none() {
            row.fault("change", FaultKind::unknown_word(word, PARAMETERS.into_iter()));
        }
        let (word, k) = (known?, k?);
        let law = &self.scene.variables[k].distribution;
        if word != "mean" && law.is_constant() {
            row.inconsistent("change", format!("{change:?}: a constant has no spread"));
        }
        if matches!(law, Distribution::Triangular(_)) {
            let what = "is given by its bounds and its mode, which an optimum does not change";
            row.inconsistent("change", format!("{change:?}: a triangular variable {what}"));
        }
        Some((k, word))
    }

    fn unit_of(&self, k: usize) -> ShownUnit {
        ShownUnit::of(&self.scene.variables[k].unit)
    }

    /// Variables of one quantity have the same value in the study and the same unit.
    fn check_equal(&self, row: &Section, variables: &[usize], kind: QuantityKind) {
        let value = |k: usize| kind.of(&self.scene.variables[k].distribution);
        let Some((&first, others)) = variables.split_first() else { return };
        let differs = |k: &&usize| {
            (value(**k) - value(first)).abs() > SAME * value(first).abs()
                || self.unit_of(**k).kind.dimension != self.unit_of(first).kind.dimension
        };
        if let Some(other) = others.iter().find(differs) {
            let [first, other] = [first, *other].map(|k| &self.scene.variables[k].name);
            let what = "have different values in the study; give each its own [[quantities]]";
            row.inconsistent("change", format!("{first} and {other} {what}"));
        }
    }

    fn bounds(
        &self,
        row: &mut Section,
        variable: Option<usize>,
        kind: QuantityKind,
        grades: &[Grade],
    ) -> (f64, f64) {
        let bounds = ["lower", "upper"];
        if row.get("grades").is_some() {
            if bounds.into_iter().any(|key| row.get(key).is_some()) {
                row.inconsistent("grades", "give either grades, or lower and upper, not both");
            }
            let width = |grade: Option<&Grade>| grade.map_or(1.0, |grade| grade.width);
            return (width(grades.first()), width(grades.last()));
        }
        let found = bounds.map(|key| {
            // Of which quantity is not known.
            let Some(k) = variable else { return row.get(key).and(None) };
            let unit = self.unit_of(k).kind;
            if kind.is_spread() {
                let mean = self.scene.variables[k].distribution.parent_mean();
                row.quantity_or_share(key, unit, mean.abs())
            } else {
                row.quantity(key, unit, Range::Any)
            }
        });
        let ([Some(lower), Some(upper)], Some(k)) = (found, variable) else { return (0.0, 1.0) };
        let (from, to) = (self.shown(k, lower), self.shown(k, upper));
        if kind.is_spread() && lower <= 0.0 {
            row.out_of_range("lower", from.clone(), "> 0: it is a spread");
        }
        if lower >= upper {
            row.out_of_range("lower", from, format!("below upper, {to}"));
        }
        (lower, upper)
    }

    fn shown(&self, k: usize, value: f64) -> String {
        let ShownUnit { symbol, si, .. } = self.unit_of(k);
        let number = format!("{}", (value / si * 1e9).round() / 1e9);
        if symbol.is_empty() { number } else { format!("{number} {symbol}") }
    }

    fn target(&self, row: &mut Section) -> Option<ReliabilityTarget> {
        let limit_state = limit_state(row, self.scene);
        let all = self.scene.life.checkpoints();
        let checkpoint = checkpoint(row, &self.scene.life, all.last().copied());
        let reliability = row.quantity("reliability", NUMBER, Range::Between(0.0, 1.0));
        let confidence = row.quantity_if_any("confidence", NUMBER, Range::Within(0.5, 0.999));
        row.finish();
        let ((name, limit_state), (checkpoint, cycles)) = (limit_state?, checkpoint?);
        let name = if all.len() > 1 { format!("R {name} at {cycles}") } else { format!("R {name}") };
        let (reliability, confidence) = (reliability?, confidence?);
        Some(ReliabilityTarget { name, limit_state, checkpoint, cycles, reliability, confidence })
    }

    /// Every distribution must exist where all quantities lie on bounds: the keys of bounds where one does not.
    fn impossible_bounds(&self, problem: &DesignProblem) -> Vec<(String, String)> {
        let inputs = InputModel::from_scene(self.scene);
        let mut faults = Vec::new();
        for (place, quantity) in problem.quantities.iter().enumerate() {
            let shares =
                |other: &DesignQuantity| other.variables.iter().any(|k| quantity.variables.contains(k));
            for (bound, value) in [("lower", quantity.lower), ("upper", quantity.upper)] {
                let present = problem.present(&inputs);
                // The other quantities of its variables where they are, or at their bounds.
                let at = |k: usize, end: fn(&DesignQuantity) -> Option<f64>| match &problem.quantities[k] {
                    _ if k == place => value,
                    other if shares(other) => end(other).unwrap_or(present[k]),
                    _ => present[k],
                };
                let ends: [fn(&DesignQuantity) -> _; 3] = [|_| None, |q| Some(q.lower), |q| Some(q.upper)];
                let error = ends.into_iter().find_map(|end| {
                    let values: Vec<f64> = (0..present.len()).map(|k| at(k, end)).collect();
                    problem.variables(&inputs, &values).err()
                });
                if let Some(error) = error {
                    let what = format!("{}: {error} [SI]", self.shown(quantity.variables[0], value));
                    faults.push((format!("quantities[{}].{bound}", place + 1), what));
                }
            }
        }
        faults
    }
}

#[cfg(test)]
#[path = "problem_file_tests.rs"]
mod tests;
