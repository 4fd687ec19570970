//! Reader of the file of units, CSV: one observation a line, `unit, cycles, quantity, value, error`. The quantity is an output
//! or a random variable of the scene, with value and standard deviation of its error, or `survived` or `failed` without both.
//! A first line that begins with `unit` is a heading; lines that begin with `#` are comments.

use super::observation::{Observation, ObservedUnit, Quantity};
use super::{UnitFault, UnitFaults, UpdateError};
use crate::analyses::quantity::output_quantity;
use crate::study::LifeModel;
use common::scene::{Scene, SceneSource};
use common::text_file::read_text;
use std::path::Path;

/// Columns of the file.
const COLUMNS: [&str; 5] = ["unit", "cycles", "quantity", "value", "error"];
/// Differences of two values of one quantity at one life that contradict each other [standard deviations].
const CONTRADICTION: f64 = 4.0;

/// Reads a file of units for a study.
///
/// # Errors
/// [`UpdateError::Read`], [`UpdateError::Units`] with all faults.
pub fn read(path: &Path, source: &SceneSource, model: &LifeModel) -> Result<Vec<ObservedUnit>, UpdateError> {
    let file = path.display().to_string();
    let text = read_text(path, "a CSV file").map_err(|why| UpdateError::Read { file: file.clone(), why })?;
    parse(&text, &file, source, model)
}

/// Reads the text of such a file.
///
/// # Errors
/// [`UpdateError::Units`] with all faults.
pub fn parse(
    text: &str,
    file: &str,
    source: &SceneSource,
    model: &LifeModel,
) -> Result<Vec<ObservedUnit>, UpdateError> {
    let row = RowReader { source, scene: source.nominal(), model };
    let (mut units, mut faults) = (Vec::<ObservedUnit>::new(), Vec::new());
    let lines = text
        .trim_start_matches('\u{feff}')
        .lines()
        .zip(1..)
        .map(|(line, number): (&str, u64)| (number, line.trim()));
    for (place, (line, content)) in
        lines.filter(|(_, content)| !content.is_empty() && !content.starts_with('#')).enumerate()
    {
        let record = cells_of(content);
        let cells: Vec<&str> = record.iter().collect();
        if place == 0 && cells[0].eq_ignore_ascii_case("unit") {
            continue;
        }
        match row.read(&cells, line) {
            Ok((name, observation)) => match units.iter_mut().find(|unit| unit.name == name) {
                Some(unit) => unit.observations.push(observation),
                None => units.push(ObservedUnit { name, observations: vec![observation] }),
            },
            Err((column, what)) => faults.push(UnitFault { line, column, what }),
        }
    }
    for unit in &mut units {
        unit.observations
            .sort_by(|a, b| a.cycles.total_cmp(&b.cycles).then(a.quantity.rank().cmp(&b.quantity.rank())));
        faults.extend(contradictions(unit));
    }
    if units.is_empty() && faults.is_empty() {
        let what = format!("the file has no observation; expected lines of {}", COLUMNS.join(", "));
        faults.push(UnitFault { line: 1, column: COLUMNS[0], what });
    }
    if faults.is_empty() {
        return Ok(units);
    }
    faults.sort_by_key(|fault| fault.line);
    Err(UpdateError::Units(UnitFaults { file: file.to_owned(), faults }))
}

/// Cells of a line.
fn cells_of(line: &str) -> csv::StringRecord {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(line.as_bytes());
    let first = reader.records().next().and_then(Result::ok);
    first.unwrap_or_else(|| csv::StringRecord::from(vec![line]))
}

/// A fault of a row: column and what is wrong.
type RowFault = (&'static str, String);

struct RowReader<'a> {
    source: &'a SceneSource,
    scene: &'a Scene,
    model: &'a LifeModel,
}

impl RowReader<'_> {
    fn read(&self, cells: &[&str], line: u64) -> Result<(String, Observation), RowFault> {
        let cell = |k: usize| cells.get(k).copied().unwrap_or_default();
        if cells.len() > COLUMNS.len() {
            let what = format!("{} cells, expected {}: {}", cells.len(), COLUMNS.len(), COLUMNS.join(", "));
            return Err((COLUMNS[4], what));
        }
        let name = cell(0);
        if name.is_empty() {
            return Err((COLUMNS[0], "is empty: expected the name of the unit".to_owned()));
        }
        let quantity = self.quantity(cell(2), cell(3), cell(4))?;
        let cycles = self.cycles(cell(1), &quantity)?;
        Ok((name.to_owned(), Observation { line, cycles, name: cell(2).to_owned(), quantity }))
    }

    fn quantity(&self, name: &str, value: &str, error: &str) -> Result<Quantity, RowFault> {
        if let Some(quantity) = [("survived", Quantity::Survived), ("failed", Quantity::Failed)]
            .into_iter()
            .find_map(|(word, quantity)| (word == name).then_some(quantity))
        {
            let extra = [(3, value), (4, error)].into_iter().find(|(_, cell)| !cell.is_empty());
            return match extra {
                Some((k, cell)) => Err((COLUMNS[k], format!("{cell:?}: {name} has no {}", COLUMNS[k]))),
                None => Ok(quantity),
            };
        }
        if let Some(output) = self.scene.outputs.iter().position(|output| output.name == name) {
            let read = |text: &str| output_quantity(&self.scene.outputs[output], text);
            let value = read(value).map_err(|what| (COLUMNS[3], what))?;
            let error = read(error).map_err(|what| (COLUMNS[4], what)).and_then(positive)?;
            return Ok(Quantity::Output { output, value, error });
        }
        if let Some(variable) = self.scene.variables.iter().position(|variable| variable.name == name) {
            if self.scene.variables[variable].distribution.is_constant() {
                return Err((
                    COLUMNS[2],
                    format!("{name} is constant in this study: there is nothing to learn"),
                ));
            }
            let value = self.variable(name, value).map_err(|what| (COLUMNS[3], what))?;
            let error = self.variable(name, error).map_err(|what| (COLUMNS[4], what)).and_then(positive)?;
            return Ok(Quantity::Variable { variable, value, error });
        }
        let outputs = self.scene.outputs.iter().map(|output| output.name.as_str());
        let variables = self.scene.variables.iter().map(|variable| variable.name.as_str());
        let all: Vec<&str> = outputs.chain(variables).chain(["survived", "failed"]).collect();
        Err((COLUMNS[2], format!("{name:?} is no quantity of this study; allowed: {}", all.join(", "))))
    }

    /// A quantity of a random variable [SI].
    fn variable(&self, name: &str, text: &str) -> Result<f64, String> {
        let found = self.source.parse_setting(&format!("{name}={text}"));
        let value = found.map_err(|faults| {
            let kinds: Vec<String> = faults.0.iter().map(|fault| fault.kind.to_string()).collect();
            kinds.join("; ")
        })?;
        if value.1.is_finite() { Ok(value.1) } else { Err(format!("{text:?} is not finite")) }
    }

    fn cycles(&self, text: &str, quantity: &Quantity) -> Result<f64, RowFault> {
        if text.is_empty() && matches!(quantity, Quantity::Variable { .. }) {
            return Ok(0.0);
        }
        let first = match quantity {
            Quantity::Output { output, .. } => self.model.beginning(*output),
            _ => 0.0,
        };
        let last = self.model.end();
        let read = text.parse::<f64>().ok().filter(|n| (first..=last).contains(n));
        read.ok_or_else(|| {
            let from = if first > 0.0 {
                format!("{first:.0}, the first checkpoint (the value at the start of life is not known),")
            } else {
                "0".to_owned()
            };
            (
                COLUMNS[1],
                format!(
                    "{text:?}: allowed: a number of cycles from {from} to {last:.0}, the end of the study"
                ),
            )
        })
    }
}

/// An error above zero.
fn positive(error: f64) -> Result<f64, RowFault> {
    if error > 0.0 {
        Ok(error)
    } else {
        Err((COLUMNS[4], "allowed: a standard deviation above 0".to_owned()))
    }
}

/// Observations of a unit, in order, that cannot be true together.
fn contradictions(unit: &ObservedUnit) -> Vec<UnitFault> {
    let mut faults = Vec::new();
    let failed = unit.observations.iter().find(|o| o.quantity == Quantity::Failed);
    for (place, observation) in unit.observations.iter().enumerate() {
        let Observation { line, cycles, ref name, quantity } = *observation;
        if let Some(failure) = failed.filter(|failure| failure.line != line) {
            let after = match quantity {
                Quantity::Variable { .. } => false,
                Quantity::Survived => cycles >= failure.cycles,
                _ => cycles > failure.cycles || quantity == Quantity::Failed,
            };
            if after {
                let what = format!(
                    "unit {} had failed by {} cycles (line {}); nothing can follow",
                    unit.name, failure.cycles, failure.line
                );
                faults.push(UnitFault { line, column: COLUMNS[1], what });
            }
        }
        for before in &unit.observations[..place] {
            let Some((difference, error, unit_word)) = differ(&before.quantity, &quantity) else { continue };
            let same_life = before.cycles == cycles || unit_word == "variable";
            if same_life && before.name == *name && difference > CONTRADICTION * error {
                let what = format!(
                    "{name} of unit {} contradicts line {}: the values differ by {:.1} standard deviations of their errors; \
                     allowed: at most {CONTRADICTION}",
                    unit.name,
                    before.line,
                    difference / error
                );
                faults.push(UnitFault { line: line.max(before.line), column: COLUMNS[3], what });
            }
        }
    }
    faults
}

/// Distance of two measured values of one quantity, the standard deviation of its error, and what they measure.
fn differ(a: &Quantity, b: &Quantity) -> Option<(f64, f64, &'static str)> {
    match (*a, *b) {
        (
            Quantity::Output { output: o, value: v, error: e },
            Quantity::Output { output: p, value: w, error: f },
        ) if o == p => Some(((v - w).abs(), e.hypot(f), "output")),
        (
            Quantity::Variable { variable: o, value: v, error: e },
            Quantity::Variable { variable: p, value: w, error: f },
        ) if o == p => Some(((v - w).abs(), e.hypot(f), "variable")),
        _ => None,
    }
}
