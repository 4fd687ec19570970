//! The answers for all designs as CSV.

use super::answer::DesignAnswer;
use super::space::DesignSpace;
use crate::analyses::paired_results::curve_names;
use crate::results::csv_table::{CsvTable, number};

/// One row per design, curve and checkpoint: the values of the design variables, `limit_state`, `cycles`, `R`, `standard_error`,
/// and the 95 % interval `lower`, `upper`.
pub fn csv(space: &DesignSpace, answers: &[DesignAnswer]) -> String {
    let labels: Vec<String> = space.variables().iter().map(super::DesignVariable::label).collect();
    let head = ["limit_state", "cycles", "R", "standard_error", "lower", "upper"].map(str::to_owned);
    let mut table = CsvTable::new(labels.into_iter().chain(head));
    for answer in answers {
        let values: Vec<String> = answer.values.iter().map(|value| number(*value)).collect();
        for name in curve_names(&answer.summary) {
            for row in &answer.summary.reliability {
                let r = row.reliability.get(&name).copied().map_or(String::new(), number);
                let error = row.standard_error.get(&name).copied().map_or(String::new(), number);
                let range = row.interval_of(&name).map(|range| [range.lower, range.upper].map(number));
                let [lower, upper] = range.unwrap_or_default();
                let own = [name.clone(), row.cycles.to_string(), r, error, lower, upper];
                table.push(values.iter().cloned().chain(own));
            }
        }
    }
    table.into_text()
}
