//! Sentences about outputs of the motion that depend on the number of control points.
//!
//! Each control point is a number of the model where a scene declares it so; where not, it is numerical, and what more points change is in the
//! stated error. Neither more points nor a finer accuracy lessen the error of an output that does not converge.

use crate::presentation::format::{count, three_digits};
use crate::results::control_points::ControlPointsRow;

/// Error over the value from which on an output that does not converge is pointed out [1].
const NOTABLE: f64 = 0.01;

/// A sentence for each output whose error is left out of the stated ones, or that does not converge.
pub fn control_points_notes(rows: &[ControlPointsRow]) -> Vec<String> {
    rows.iter().filter_map(note).collect()
}

fn note(row: &ControlPointsRow) -> Option<String> {
    let ControlPointsRow { output, unit, value, with_twice, with_four_times, .. } = row;
    let [cycles, own, twice, four_times, error] = [
        count(row.cycles.into()),
        three_digits(*value),
        three_digits(*with_twice),
        three_digits(*with_four_times),
        three_digits(row.error),
    ];
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    let values = format!(
        "after {cycles} cycles of the nominal mechanism it is {own}{unit}, and {twice} and {four_times}{unit} on surfaces with twice and four times \
         the control points"
    );
    let text = if !row.stated {
        format!(
            "the stated errors of {output} leave out the number of control points, which this scene declares a part of its model: {values}"
        )
    } else if !row.converges && row.error > NOTABLE * value.abs() {
        format!(
            "{output} does not converge with the number of control points: {values}; its stated error contains {error}{unit} for that, which no \
             accuracy lessens: compare with another contact_law"
        )
    } else {
        return None;
    };
    Some(text.replace('\u{a0}', " "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(stated: bool, converges: bool, error: f64) -> ControlPointsRow {
        ControlPointsRow {
            output: "asymmetry".into(),
            unit: "r/min".into(),
            cycles: 66_000,
            value: 24.58,
            with_twice: 26.37,
            with_four_times: 34.39,
            error,
            converges,
            stated,
        }
    }

    #[test]
    fn outputs_that_do_not_converge_and_errors_left_out_are_named_with_their_size() {
        let said = |row| control_points_notes(&[row]).pop();
        let text = said(row(true, false, 19.6)).expect("a note");
        assert!(
            text.starts_with(
                "asymmetry does not converge with the number of control points: after 66 000 cycles"
            ),
            "{text}"
        );
        assert!(text.contains("it is 24.6 r/min, and 26.4 and 34.4 r/min on surfaces"), "{text}");
        assert!(text.contains("its stated error contains 19.6 r/min"), "{text}");
        assert_eq!((said(row(true, true, 19.6)), said(row(true, false, 0.1))), (None, None));
        let text = said(row(false, true, 0.1)).expect("a note");
        assert!(
            text.starts_with("the stated errors of asymmetry leave out the number of control points"),
            "{text}"
        );
    }
}
