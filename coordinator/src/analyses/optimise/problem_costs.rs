//! Costs and grades of the file of an optimisation problem.

use super::problem::{Grade, PrintedUnit};
use super::problem_rows::{CostRow, ProblemReader, QuantityRow, VariableUnit};
use crate::statistics::optimisation::{CostModel, CostTable};
use common::random::ToleranceClass;
use common::scene::expression::read_unit;
use common::scene::quantity::{Dimension, LENGTH};

/// Grades of the table: IT5 to IT11 are read, IT12 is ten times IT7.
const GRADES: std::ops::RangeInclusive<u8> = 5..=12;
impl ProblemReader<'_> {
    /// The grades of a quantity by ascending width; none if it has none, or after a fault.
    pub(super) fn grades(
        &mut self,
        path: &str,
        row: &QuantityRow,
        word: &str,
        dimension: Dimension,
    ) -> Vec<Grade> {
        if row.grades.is_empty() {
            if row.diameter.is_some() {
                self.fault(&format!("{path}.diameter"), "is for grades only".to_owned());
            }
            return vec![];
        }
        let key = format!("{path}.grades");
        if word != "tolerance" || dimension != LENGTH.dimension {
            self.fault(
                &key,
                "grades are for the tolerance of a length, e.g. \"rod_length.tolerance\"".to_owned(),
            );
            return vec![];
        }
        let Some(diameter) = &row.diameter else {
            self.fault(
                &format!("{path}.diameter"),
                "is missing: the nominal size that the grades refer to".to_owned(),
            );
            return vec![];
        };
        let length = VariableUnit { dimension, printed: PrintedUnit { symbol: "mm".to_owned(), si: 1e-3 } };
        let Some(diameter) = self.number(&format!("{path}.diameter"), diameter, &length, None) else {
            return vec![];
        };
        let mut grades: Vec<Grade> = Vec::new();
        for name in &row.grades {
            match grade_width(name, diameter) {
                Ok(width) => grades.push(Grade { name: name.clone(), width }),
                Err(what) => self.fault(&key, what),
            }
        }
        grades.sort_by(|a, b| a.width.total_cmp(&b.width));
        if grades.windows(2).any(|pair| pair[0].width == pair[1].width) {
            self.fault(&key, "a grade is named twice".to_owned());
        } else if grades.len() == 1 && row.grades.len() == 1 {
            self.fault(&key, "expected at least two grades to choose from".to_owned());
        }
        grades
    }

    /// The cost of a quantity and the unit of the quantity in it [SI].
    pub(super) fn cost(
        &mut self,
        path: &str,
        row: &CostRow,
        unit: &VariableUnit,
        grades: &[Grade],
    ) -> Option<(CostModel, f64)> {
        let before = self.faults.len();
        let cost_unit = match &row.unit {
            None => unit.printed.si,
            Some(text) => match read_unit(text) {
                Ok(found) if found.dimension == unit.dimension => found.multiply / found.divide,
                _ => {
                    let what = format!("{text:?} is not a unit of {}", unit.dimension);
                    self.fault(&format!("{path}.unit"), what);
                    1.0
                }
            },
        };
        let c0 = row.c0.unwrap_or(0.0);
        let needed: &[(&str, Option<f64>)] = match row.model.as_str() {
            "reciprocal-power" => &[("c1", row.c1)],
            "exponential" => &[("c1", row.c1), ("k", row.k)],
            "linear" => &[("c1", row.c1)],
            _ => &[],
        };
        for (key, _) in needed.iter().filter(|(_, value)| value.is_none()) {
            self.fault(&format!("{path}.{key}"), "is missing".to_owned());
        }
        for (key, value) in [("c0", row.c0), ("c1", row.c1), ("k", row.k)] {
            if value.is_some_and(|value| !value.is_finite()) {
                self.fault(&format!("{path}.{key}"), "expected a finite number".to_owned());
            }
        }
        let (c1, k) = (row.c1.unwrap_or(0.0), row.k.unwrap_or(1.0));
        if row.model != "linear" {
            for (key, value) in [("c1", row.c1), ("k", row.k)] {
                if value.is_some_and(|value| value <= 0.0) {
                    self.fault(
                        &format!("{path}.{key}"),
                        "expected above 0: a wider tolerance costs less".to_owned(),
                    );
                }
            }
        }
        let model = match row.model.as_str() {
            "reciprocal-power" => Some(CostModel::ReciprocalPower { c0, c1, k }),
            "exponential" => Some(CostModel::Exponential { c0, c1, k }),
            "linear" => Some(CostModel::Linear { c0, c1 }),
            "table" => self.table(path, row, unit, grades, cost_unit).map(CostModel::Table),
            other => {
                let what = format!("{other:?}: allowed are reciprocal-power, exponential, linear and table");
                self.fault(&format!("{path}.model"), what);
                None
            }
        };
        model.filter(|_| self.faults.len() == before).map(|model| (model, cost_unit))
    }

    fn table(
        &mut self,
        path: &str,
        row: &CostRow,
        unit: &VariableUnit,
        grades: &[Grade],
        cost_unit: f64,
    ) -> Option<CostTable> {
        let key = format!("{path}.points");
        let Some(rows) = &row.points else {
            self.fault(&key, "is missing, e.g. [[\"1 um\", 8.0], [\"2 um\", 5.0]]".to_owned());
            return None;
        };
        let mut points = Vec::new();
        for (at, cost) in rows {
            let grade = grades.iter().find(|grade| at.as_str() == Some(&grade.name));
            let at = match grade {
                Some(grade) => grade.width,
                None => self.number(&key, at, unit, None)?,
            };
            points.push((at / cost_unit, *cost));
        }
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        match CostTable::new(&points) {
            Ok(table) => Some(table),
            Err(error) => {
                self.fault(&key, error.to_string());
                None
            }
        }
    }
}

/// Width of the tolerance zone of a grade at a nominal size [m], from the tables of ISO 286-1. IT12 is ten times IT7, as
/// from IT6 on every fifth step multiplies by ten.
pub(super) fn grade_width(name: &str, diameter: f64) -> Result<f64, String> {
    let number = name.strip_prefix("IT").and_then(|number| number.parse::<u8>().ok());
    let Some(number) = number.filter(|number| GRADES.contains(number)) else {
        return Err(format!("{name:?}: allowed are IT5 to IT12"));
    };
    let (number, factor) = if number == 12 { (7, 10.0) } else { (number, 1.0) };
    let class = ToleranceClass::parse(&format!("js{number}")).map_err(|error| error.to_string())?;
    let (lower, upper) = class.deviations(diameter).map_err(|error| error.to_string())?;
    Ok(factor * (upper - lower))
}
