//! Reads the limit states of a scene: outputs with one threshold or two.

use super::context::Range;
use super::faults::FaultKind;
use super::model::{Fails, LimitState};
use super::outputs::OutputRow;
use super::quantity::Kind;
use super::section::Section;

/// Columns that result files have besides one for each limit state.
const COLUMNS: [&str; 4] = ["cycles", "total", "standard_error", "numerical"];

/// Reads `[[limit_states]]`; a threshold is of the kind of its output.
pub(super) fn limit_states(file: &mut Section, outputs: &[OutputRow]) -> Vec<Option<LimitState>> {
    let mut limit_states = Vec::new();
    for (name, mut row) in file.rows("limit_states") {
        if COLUMNS.contains(&name) {
            let (value, reason) = (name.to_owned(), "it is a column of result files".to_owned());
            row.fault("name", FaultKind::BadName { value, reason });
        }
        let known = outputs.iter().map(|output| output.name.as_str());
        let declared = outputs.iter().any(|output| output.declared);
        let output = row.text("output", "the name of an output");
        let output = output.and_then(|output| row.reference("output", "output", output, known));
        let kind = output.and_then(|output| outputs[output].kind);
        // The outputs of a mechanism are sizes.
        let range = if declared { Range::Any } else { Range::Positive };
        let sides = sides(&mut row, kind, range);
        row.finish();
        let state =
            |(output, (threshold, fails))| LimitState { name: name.to_owned(), output, threshold, fails };
        limit_states.push(output.zip(sides).map(state));
    }
    limit_states
}

/// Reads threshold and side of a limit state: `threshold` with `fails`, or `lower` and `upper`, outside of which it fails. A threshold
/// of an unknown kind is left unread.
fn sides(row: &mut Section, kind: Option<Kind>, range: Range) -> Option<(f64, Fails)> {
    let outside = Fails::Outside { lower: 0.0 };
    let words = [("above", Fails::Above), ("below", Fails::Below), ("outside", outside)];
    let [one, lower, upper] = ["threshold", "lower", "upper"].map(|key| row.get(key).map(|_| key));
    let two = lower.or(upper);
    let default = if two.is_some() { outside } else { Fails::Above };
    let fails = row.word_or("fails", &words, default)?;
    let one_sided = fails != outside;
    if let Some(surplus) = if one_sided { two } else { one } {
        let expected = "expected threshold, or lower and upper with fails = \"outside\", not some of both";
        row.inconsistent(surplus, expected);
        return None;
    }
    let mut threshold = |key| row.quantity(key, kind?, range);
    if one_sided {
        return Some((threshold("threshold")?, fails));
    }
    let (lower, upper) = (threshold("lower"), threshold("upper"));
    let (lower, upper) = (lower?, upper?);
    if lower >= upper {
        row.inconsistent("lower", "expected lower < upper");
        return None;
    }
    Some((upper, Fails::Outside { lower }))
}
