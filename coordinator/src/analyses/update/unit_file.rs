//! Reader of the file of units, CSV: one observation a line, `unit, cycles, quantity, value, error`. The quantity is an output
//! or a random variable of the scene, with value and standard deviation of its error, or `survived` or `failed` without both.
//! A first line that begins with `unit` is a heading; lines that begin with `#` are comments.

use super::observation::{Observation, ObservedUnit, Quantity};
use crate::analyses::quantity::output_quantity;
use crate::study::LifeModel;
use common::scene::{
    Cell, CsvRow, Fault, FaultKind, Faults, Scene, SceneSource, csv_rows, nearest, read_text,
};
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
    let rows = csv_rows(text);
    let is_heading =
        |(place, row): &(usize, &CsvRow)| *place == 0 && row.cells[0].text.eq_ignore_ascii_case("unit");
    let observed: Vec<&CsvRow> =
        rows.iter().enumerate().filter(|numbered| !is_heading(numbered)).map(|(_, row)| row).collect();
    let mut units = Vec::<ObservedUnit>::new();
    let mut faults: Vec<(u64, usize, FaultKind)> = Vec::new();
    for row in &observed {
        let mut reader =
            RowReader { source, scene: source.nominal(), model, cells: &row.cells, faults: vec![] };
        if let Some((name, observation)) = reader.read(row.line) {
            match units.iter_mut().find(|unit| unit.name == name) {
                Some(unit) => unit.observations.push(observation),
                None => units.push(ObservedUnit { name, observations: vec![observation] }),
            }
        }
        faults.extend(reader.faults.into_iter().map(|(column, kind)| (row.line, column, kind)));
    }
    for unit in &mut units {
        unit.observations
            .sort_by(|a, b| a.cycles.total_cmp(&b.cycles).then(a.quantity.rank().cmp(&b.quantity.rank())));
        let found = contradictions(unit).into_iter();
        faults
            .extend(found.map(|(line, column, message)| (line, column, FaultKind::Inconsistent { message })));
    }
    if observed.is_empty() {
        let message = format!("the file has no observation; expected lines of {}", COLUMNS.join(", "));
        let end = text.trim_end().len();
        return Err(Faults(vec![Fault::at(file, text, end..end, "", FaultKind::Inconsistent { message })]));
    }
    if faults.is_empty() {
        return Ok(units);
    }
    faults.sort_by_key(|(line, column, _)| (*line, *column));
    let placed = |(line, column, kind): (u64, usize, FaultKind)| {
        let row = observed.iter().find(|row| row.line == line).expect("faults are those of rows");
        let end = row.cells[row.cells.len() - 1].span.end;
        let span = row.cells.get(column).map_or(end..end, |cell| cell.span.clone());
        Fault::at(file, text, span, COLUMNS[column], kind)
    };
    Err(Faults(faults.into_iter().map(placed).collect()))
}

/// The reader of one row, and the faults found in it, by column.
struct RowReader<'a> {
    source: &'a SceneSource,
    scene: &'a Scene,
    model: &'a LifeModel,
    cells: &'a [Cell<'a>],
    faults: Vec<(usize, FaultKind)>,
}

impl<'a> RowReader<'a> {
    fn cell(&self, column: usize) -> &'a str {
        self.cells.get(column).map_or("", |cell| cell.text)
    }

    fn fault(&mut self, column: usize, message: String) {
        self.faults.push((column, FaultKind::Inconsistent { message }));
    }

    /// Unit and observation of the row; `None` with a fault.
    fn read(&mut self, line: u64) -> Option<(String, Observation)> {
        if self.cells.len() > COLUMNS.len() {
            let (found, expected, names) = (self.cells.len(), COLUMNS.len(), COLUMNS.join(", "));
            let what = format!(
                "{found} cells, expected {expected}: {names}; a comma within a number separates cells, too"
            );
            self.fault(COLUMNS.len() - 1, what);
            // Which cells are meant for which column is not known.
            return None;
        }
        if self.cell(0).is_empty() {
            self.fault(0, "is empty: expected the name of the unit".to_owned());
        }
        let quantity = self.quantity();
        let cycles = self.cycles(quantity.as_ref());
        let observation =
            Observation { line, cycles: cycles?, name: self.cell(2).to_owned(), quantity: quantity? };
        self.faults.is_empty().then(|| (self.cell(0).to_owned(), observation))
    }

    fn quantity(&mut self) -> Option<Quantity> {
        let name = self.cell(2);
        let word = [("survived", Quantity::Survived), ("failed", Quantity::Failed)];
        if let Some((word, quantity)) = word.into_iter().find(|(word, _)| *word == name) {
            for column in [3, 4] {
                let cell = self.cell(column);
                if !cell.is_empty() {
                    self.fault(column, format!("{cell:?}: {word} has no {}", COLUMNS[column]));
                }
            }
            return Some(quantity);
        }
        let outputs = self.scene.outputs.iter().map(|output| output.name.as_str());
        let variables = self.scene.variables.iter().map(|variable| variable.name.as_str());
        let all: Vec<&str> = outputs.chain(variables).chain(["survived", "failed"]).collect();
        let place = |name: &str| all.iter().position(|known| *known == name);
        // After a fault the row is read on as if the nearest name had been meant.
        let place = place(name).or_else(|| {
            let nearest = nearest(name, all.iter().copied());
            let meant = nearest.as_deref().and_then(place);
            let known = all.iter().map(|name| (*name).to_owned()).collect();
            let kind =
                FaultKind::UnknownReference { what: "quantity", value: name.to_owned(), nearest, known };
            self.faults.push((2, kind));
            meant
        })?;
        if let Some(output) = self.scene.outputs.get(place) {
            let [value, error] =
                [3, 4].map(|column| self.number(column, output_quantity(output, self.cell(column))));
            let error = error.and_then(|error| self.positive(error));
            return Some(Quantity::Output { output: place, value: value?, error: error? });
        }
        let variable = place - self.scene.outputs.len();
        let of = self.scene.variables.get(variable)?;
        if of.distribution.is_constant() {
            self.fault(2, format!("{name} is constant in this study: there is nothing to learn"));
        }
        let [value, error] = [3, 4].map(|column| {
            let read = self.source.parse_setting(&format!("{}={}", of.name, self.cell(column)));
            self.number(
                column,
                read.map(|(_, value)| value).map_err(|Faults(faults)| faults[0].kind.to_string()),
            )
        });
        let error = error.and_then(|error| self.positive(error));
        Some(Quantity::Variable { variable, value: value?, error: error? })
    }

    /// The number of a column, or its fault.
    fn number(&mut self, column: usize, read: Result<f64, String>) -> Option<f64> {
        read.map_err(|what| self.fault(column, what)).ok()
    }

    /// An error above zero.
    fn positive(&mut self, error: f64) -> Option<f64> {
        if error > 0.0 {
            return Some(error);
        }
        self.fault(4, "allowed: a standard deviation above 0".to_owned());
        None
    }

    fn cycles(&mut self, quantity: Option<&Quantity>) -> Option<f64> {
        let text = self.cell(1);
        if text.is_empty() && matches!(quantity, None | Some(Quantity::Variable { .. })) {
            return Some(0.0);
        }
        let first = match quantity {
            Some(Quantity::Output { output, .. }) => self.model.beginning(*output),
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
            self.fault(1, format!("{text:?}: allowed: {allowed}"));
        }
        read
    }
}

/// Observations of a unit, in order, that cannot be true together: line, column and why.
fn contradictions(unit: &ObservedUnit) -> Vec<(u64, usize, String)> {
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
                faults.push((line, 1, what));
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
                faults.push((line.max(before.line), 3, what));
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
