//! Reader of the file of units, CSV: one observation a line, `unit, cycles, quantity, value, error`. The quantity is an output
//! or a random variable of the scene, with value and standard deviation of its error, or `survived` or `failed` without both.
//! A first line that begins with `unit` is a heading; lines that begin with `#` are comments.

use super::observation::{Observable, Observation, ObservedUnit, Quantity};
use crate::analyses::quantity::output_quantity;
use crate::study::LifeModel;
use common::scene::{Faults, Scene, SceneSource, Section, read_quantity, read_rows, read_text};
use std::path::Path;

/// Columns of the file.
const COLUMNS: [&str; 5] = ["unit", "cycles", "quantity", "value", "error"];
/// Differences of two values of one quantity at one life that contradict each other [standard deviations].
const CONTRADICTION: f64 = 4.0;

/// Reads a file of units for a study.
///
/// # Errors
/// All faults.
pub fn read(path: &Path, source: &SceneSource, model: &LifeModel) -> Result<Vec<ObservedUnit>, Faults> {
    parse(&read_text(path)?, &path.display().to_string(), source, model)
}

/// Reads the text of such a file.
///
/// # Errors
/// All faults.
pub fn parse(
    text: &str,
    file: &str,
    source: &SceneSource,
    model: &LifeModel,
) -> Result<Vec<ObservedUnit>, Faults> {
    let reader = UnitReader { source, scene: source.nominal(), model };
    read_rows(text, file, &COLUMNS, |rows| {
        let mut units = Vec::<ObservedUnit>::new();
        for (line, row) in rows.iter_mut() {
            let Some((name, observation)) = reader.observation(*line, row) else { continue };
            match units.iter_mut().find(|unit| unit.name == name) {
                Some(unit) => unit.observations.push(observation),
                None => units.push(ObservedUnit { name, observations: vec![observation] }),
            }
        }
        for unit in &mut units {
            unit.observations.sort_by(|a, b| {
                a.cycles.total_cmp(&b.cycles).then(a.quantity.rank().cmp(&b.quantity.rank()))
            });
            for (line, column, what) in contradictions(unit) {
                let row = rows.iter().find(|(other, _)| *other == line);
                row.expect("observations are those of rows").1.inconsistent(column, what);
            }
        }
        units
    })
}

struct UnitReader<'a> {
    source: &'a SceneSource,
    scene: &'a Scene,
    model: &'a LifeModel,
}

impl UnitReader<'_> {
    /// Unit and observation of a row; `None` with a fault.
    fn observation(&self, line: u64, row: &mut Section) -> Option<(String, Observation)> {
        let before = row.fault_count();
        let unit = row.text("unit", "the name of the unit");
        let name = row.text("quantity", "an output, a random variable, survived or failed");
        let quantity = name.and_then(|name| self.quantity(name, row));
        let cycles = self.cycles(row, quantity.as_ref());
        let (cycles, name, quantity) = (cycles?, name?.to_owned(), quantity?);
        let observation = Observation { line, cycles, name, quantity };
        (row.fault_count() == before).then_some((unit?.to_owned(), observation))
    }

    fn quantity(&self, name: &str, row: &mut Section) -> Option<Quantity> {
        let outputs = self.scene.outputs.iter().map(|output| output.name.as_str());
        let variables = self.scene.variables.iter().map(|variable| variable.name.as_str());
        let all: Vec<&str> = outputs.chain(variables).chain(["survived", "failed"]).collect();
        let place = row.meant("quantity", "quantity", name, all.iter().copied())?;
        if let word @ ("survived" | "failed") = all[place] {
            for column in ["value", "error"] {
                if let Some(cell) = row.get(column) {
                    row.inconsistent(column, format!("{cell}: {word} has no {column}"));
                }
            }
            return Some(if word == "survived" { Quantity::Survived } else { Quantity::Failed });
        }
        let output = self.scene.outputs.get(place);
        let of = match output {
            Some(_) => Observable::Output(place),
            None => Observable::Variable(place - self.scene.outputs.len()),
        };
        if let Observable::Variable(k) = of
            && self.scene.variables[k].distribution.is_constant()
        {
            row.inconsistent(
                "quantity",
                format!("{name} is constant in this study: there is nothing to learn"),
            );
        }
        let [value, error] = ["value", "error"].map(|column| {
            let text = row.text_or(column, "a quantity", "").unwrap_or_default();
            let read = match (output, self.source.kind_of(all[place])) {
                (Some(output), _) => output_quantity(output, text),
                (None, kind) => read_quantity(text, kind?).map_err(|fault| fault.to_string()),
            };
            read.map_err(|what| row.inconsistent(column, what)).ok()
        });
        if error.is_some_and(|error| error <= 0.0) {
            row.inconsistent("error", "allowed: a standard deviation above 0");
        }
        Some(Quantity::Measured { of, value: value?, error: error? })
    }

    fn cycles(&self, row: &mut Section, quantity: Option<&Quantity>) -> Option<f64> {
        let text = row.text_or("cycles", "a number of cycles", "")?;
        let of = match quantity {
            Some(Quantity::Measured { of, .. }) => Some(of),
            _ => None,
        };
        if text.is_empty() && (quantity.is_none() || matches!(of, Some(Observable::Variable(_)))) {
            return Some(0.0);
        }
        let first = match of {
            Some(Observable::Output(output)) => self.model.beginning(*output),
            _ => 0.0,
        };
        let last = self.model.end();
        let read = text.parse::<f64>().ok().filter(|n| (first..=last).contains(n));
        if read.is_none() {
            let from = if first > 0.0 {
                format!("{first:.0}, the first checkpoint (the value at the start of life is not known),")
            } else {
                "0".to_owned()
            };
            let allowed = format!("a number of cycles from {from} to {last:.0}, the end of the study");
            row.inconsistent("cycles", format!("{text:?}: allowed: {allowed}"));
        }
        read
    }
}

/// Observations of a unit, in order, that cannot be true together: line, column and why.
fn contradictions(unit: &ObservedUnit) -> Vec<(u64, &'static str, String)> {
    let mut faults = Vec::new();
    let failed = unit.observations.iter().find(|o| o.quantity == Quantity::Failed);
    for (place, observation) in unit.observations.iter().enumerate() {
        let Observation { line, cycles, ref name, quantity } = *observation;
        if let Some(failure) = failed.filter(|failure| failure.line != line) {
            let after = match quantity {
                Quantity::Measured { of: Observable::Variable(_), .. } => false,
                Quantity::Survived => cycles >= failure.cycles,
                _ => cycles > failure.cycles || quantity == Quantity::Failed,
            };
            if after {
                let what = format!(
                    "unit {} had failed by {} cycles (line {}); nothing can follow",
                    unit.name, failure.cycles, failure.line
                );
                faults.push((line, "cycles", what));
            }
        }
        for before in &unit.observations[..place] {
            let (
                Quantity::Measured { of: first, value: one, error: e },
                Quantity::Measured { of, value: other, error: f },
            ) = (before.quantity, quantity)
            else {
                continue;
            };
            let same_life = before.cycles == cycles || matches!(of, Observable::Variable(_));
            let (difference, error) = ((one - other).abs(), e.hypot(f));
            if same_life && first == of && difference > CONTRADICTION * error {
                let what = format!(
                    "{name} of unit {} contradicts line {}: the values differ by {:.1} standard deviations of their errors; \
                     allowed: at most {CONTRADICTION}",
                    unit.name,
                    before.line,
                    difference / error
                );
                faults.push((line.max(before.line), "value", what));
            }
        }
    }
    faults
}
