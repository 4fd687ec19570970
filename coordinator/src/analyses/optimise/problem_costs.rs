//! Costs and grades of the file of an optimisation problem.

use super::problem::Grade;
use crate::analyses::quantity::ShownUnit;
use crate::statistics::optimisation::{CostModel, CostTable};
use common::random::ToleranceClass;
use common::scene::expression::read_unit;
use common::scene::quantity::{LENGTH, NUMBER};
use common::scene::{Range, Section};
use toml::Value;

/// Grades of the table: IT5 to IT11 are read, IT12 is ten times IT7.
const GRADES: std::ops::RangeInclusive<u8> = 5..=12;

/// The words of `model`.
const MODELS: [&str; 4] = ["reciprocal-power", "exponential", "linear", "table"];

/// The grades of a quantity by ascending width; none if it has none. `word` is its parameter, as far as it is known.
pub(super) fn grades(row: &mut Section, word: Option<&str>, unit: Option<&ShownUnit>) -> Vec<Grade> {
    if row.get("grades").is_none() {
        if row.get("diameter").is_some() {
            row.inconsistent("diameter", "is for grades only");
        }
        return vec![];
    }
    let names = row.texts("grades", "a list of grades, e.g. [\"IT6\", \"IT7\"]").unwrap_or_default();
    // Names are checked at a size of every table if the one meant is not known.
    let diameter = row.quantity("diameter", LENGTH, Range::Positive).unwrap_or(0.01);
    let is_length = unit.is_none_or(|unit| unit.kind.dimension == LENGTH.dimension);
    if word.is_some_and(|word| word != "tolerance") || !is_length {
        row.inconsistent("grades", "grades are for the tolerance of a length, e.g. \"rod_length.tolerance\"");
    }
    let grade = |name: &&str| {
        let width = grade_width(name, diameter).map_err(|what| row.inconsistent("grades", what)).ok()?;
        Some(Grade { name: (*name).to_owned(), width })
    };
    let mut grades: Vec<Grade> = names.iter().filter_map(grade).collect();
    grades.sort_by(|a, b| a.width.total_cmp(&b.width));
    if grades.windows(2).any(|pair| pair[0].width == pair[1].width) {
        row.inconsistent("grades", "a grade is named twice");
    } else if names.len() < 2 {
        row.inconsistent("grades", "expected at least two grades to choose from");
    }
    grades
}

/// The cost of a quantity and the unit of the quantity in it [SI]. `unit` is that of the quantity, as far as it is known.
pub fn cost(row: &mut Section, unit: Option<&ShownUnit>, grades: &[Grade]) -> Option<(CostModel, f64)> {
    let mut row = row.section("cost", "a table { model, ... }")?;
    let text = row.text_or("unit", "a unit", "").filter(|text| !text.is_empty());
    let read = text.map(|text| read_unit(text).map_err(|error| error.to_string()));
    let of_kind = |dimension| unit.is_none_or(|unit| unit.kind.dimension == dimension);
    let cost_unit = match read {
        None => unit.map_or(1.0, |unit| unit.si),
        Some(Ok(found)) if of_kind(found.dimension) => found.multiply / found.divide,
        Some(found) => {
            let expected = unit.map_or("", |unit| unit.kind.name);
            let what = found.map_or_else(|error| error, |found| format!("is of {}", found.dimension));
            row.inconsistent("unit", format!("{what}; expected a unit of {expected}"));
            1.0
        }
    };
    let model = match row.word("model", &MODELS.map(|word| (word, word)))? {
        "table" => table(&mut row, unit, grades, cost_unit).map(CostModel::Table),
        "linear" => {
            let (c0, c1) = coefficients(&mut row, Range::Any);
            c0.zip(c1).map(|(c0, c1)| CostModel::Linear { c0, c1 })
        }
        // A wider tolerance costs less.
        "exponential" => {
            let (c0, c1) = coefficients(&mut row, Range::Positive);
            let k = row.quantity("k", NUMBER, Range::Positive);
            c0.zip(c1).zip(k).map(|((c0, c1), k)| CostModel::Exponential { c0, c1, k })
        }
        _ => {
            let (c0, c1) = coefficients(&mut row, Range::Positive);
            let k = row.quantity_or("k", NUMBER, Range::Positive, 1.0);
            c0.zip(c1).zip(k).map(|((c0, c1), k)| CostModel::ReciprocalPower { c0, c1, k })
        }
    };
    row.finish();
    Some((model?, cost_unit))
}

/// The coefficients `c0` and `c1` of a cost.
fn coefficients(row: &mut Section, range: Range) -> (Option<f64>, Option<f64>) {
    (row.quantity_or("c0", NUMBER, Range::Any, 0.0), row.quantity("c1", NUMBER, range))
}

fn table(row: &mut Section, unit: Option<&ShownUnit>, grades: &[Grade], cost_unit: f64) -> Option<CostTable> {
    let expected = "a list of points, e.g. [[\"1 um\", 8.0], [\"2 um\", 5.0]]";
    let Some(value) = row.get("points") else {
        row.missing("points", expected);
        return None;
    };
    let pair = |value: &'_ Value| value.as_array().is_some_and(|pair| pair.len() == 2);
    let Some(rows) = value.as_array().filter(|rows| rows.iter().all(pair)) else {
        row.wrong_type("points", value, expected);
        return None;
    };
    let read = |(place, point): (usize, &Value)| {
        let (at, cost) = (&point[0], &point[1]);
        let key = |end: &str| format!("points.{}.{end}", place + 1);
        let cost = row.as_quantity(&key("y"), cost, NUMBER, Range::Any);
        let at = match grades.iter().find(|grade| at.as_str() == Some(&grade.name)) {
            Some(grade) => Some(grade.width),
            None => row.as_quantity(&key("x"), at, unit?.kind, Range::Any),
        };
        Some((at? / cost_unit, cost?))
    };
    let read: Vec<Option<(f64, f64)>> = rows.iter().enumerate().map(read).collect();
    let mut points: Vec<(f64, f64)> = read.into_iter().collect::<Option<_>>()?;
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    CostTable::new(&points).map_err(|error| row.inconsistent("points", error)).ok()
}

/// Width of the tolerance zone of a grade at a nominal size [m], from the tables of ISO 286-1. IT12 is ten times IT7, as
/// from IT6 on every fifth step multiplies by ten.
pub(super) fn grade_width(name: &str, diameter: f64) -> Result<f64, String> {
    let number = name.strip_prefix("IT").and_then(|number| number.parse::<u8>().ok());
    let number = number.filter(|number| GRADES.contains(number));
    let number = number.ok_or_else(|| format!("{name:?}: allowed are IT5 to IT12"))?;
    let (number, factor) = if number == 12 { (7, 10.0) } else { (number, 1.0) };
    let class = ToleranceClass::parse(&format!("js{number}")).map_err(|error| error.to_string())?;
    let (lower, upper) = class.deviations(diameter).map_err(|error| error.to_string())?;
    Ok(factor * (upper - lower))
}
