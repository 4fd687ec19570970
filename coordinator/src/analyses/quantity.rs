//! Quantities that a person writes: for an output of a scene, e.g. `15.2 um`, and a checkpoint of its life; and the unit in which
//! a quantity is shown.

use common::scene::expression::read_unit;
use common::scene::quantity::{Kind, NUMBER};
use common::scene::{Life, Output, OutputUnit, Scene, Section, number_and_unit, read_quantity};

/// Unit in which a quantity is written and shown.
#[derive(Debug, Clone, PartialEq)]
pub struct ShownUnit {
    /// Symbol; empty for a plain number.
    pub symbol: String,
    /// The unit in SI.
    pub si: f64,
    /// Kind of the quantities that have it.
    pub kind: Kind,
}

impl ShownUnit {
    /// The unit with this symbol; one of a simulator, which is only displayed, is that of plain numbers.
    pub fn of(symbol: &str) -> Self {
        let unit = read_unit(symbol).ok();
        Self {
            symbol: if symbol == "1" { String::new() } else { symbol.to_owned() },
            si: unit.map_or(1.0, |unit| unit.multiply / unit.divide),
            kind: unit.map_or(NUMBER, |unit| Kind::from_dimension(unit.dimension)),
        }
    }
}

/// The SI value of a quantity of `output`; the output of an external simulator has the unit of its scene, which may be left
/// out.
///
/// # Errors
/// What is wrong and what is expected, in words.
pub fn output_quantity(output: &Output, text: &str) -> Result<f64, String> {
    match output.kind.unit() {
        OutputUnit::External(unit) => external(&unit, text),
        unit => read_quantity(text, unit.kind()).map_err(|fault| fault.to_string()),
    }
}

fn external(unit: &str, text: &str) -> Result<f64, String> {
    let read = number_and_unit(text).filter(|(_, found)| found.is_empty() || *found == unit);
    let expected = if unit.is_empty() { String::new() } else { format!(" in {unit}") };
    read.map(|(value, _)| value).ok_or_else(|| format!("{text:?}: expected a number{expected}"))
}

/// The checkpoint at the key `cycles` of a row, its index and its life [cycles]; by default `default`, without one it is required.
pub fn checkpoint(row: &mut Section, life: &Life, default: Option<u32>) -> Option<(usize, u32)> {
    let all = life.checkpoints();
    let cycles = row.integer("cycles", 1..=i64::from(u32::MAX), default.map(i64::from))?;
    let found = all.iter().position(|other| i64::from(*other) == cycles);
    if found.is_none() && all.len() == 1 {
        let what = "the study has no life, so a target has no cycles; remove the key";
        row.inconsistent("cycles", format!("{cycles}: {what}"));
    } else if found.is_none() {
        let allowed =
            format!("a checkpoint of the life: {} to {} by {}", all[0], life.cycles, life.checkpoint_every);
        row.out_of_range("cycles", cycles.to_string(), allowed);
    }
    found.map(|place| (place, all[place]))
}

/// The limit state at the key `limit_state` of a row, its name and index; by default `total`, all together, which has no index.
pub fn limit_state<'s>(row: &mut Section<'s>, scene: &Scene) -> Option<(&'s str, Option<usize>)> {
    let name = row.text_or("limit_state", "the name of a limit state, or total", "total")?;
    let limits = scene.limit_states.iter().map(|limit| limit.name.as_str());
    let place = row.meant("limit_state", "limit state", name, limits.chain(["total"]))?;
    Some((name, Some(place).filter(|place| *place < scene.limit_states.len())))
}

/// A number above 0 and up to `most` in a cell; another one is a fault with what is allowed.
pub fn positive(row: &Section, column: &str, text: &str, most: f64, allowed: &str) -> Option<f64> {
    let read = text.parse::<f64>().ok().filter(|value| *value > 0.0 && value.is_finite() && *value <= most);
    if read.is_none() {
        row.inconsistent(column, format!("{text:?}: allowed: {allowed}"));
    }
    read
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::SceneSource;

    #[test]
    fn units_are_read_and_others_refused() {
        let source = SceneSource::builtin("four-bar").unwrap();
        let wear = &source.nominal().outputs[0];
        assert!((output_quantity(wear, "15.2 um").unwrap() - 15.2e-6).abs() < 1e-18);
        for wrong in ["15.2", "3 N", "um", "", "1e999 um"] {
            assert!(output_quantity(wear, wrong).is_err(), "{wrong}");
        }
        assert_eq!((external("MPa", "250 MPa"), external("MPa", "250")), (Ok(250.0), Ok(250.0)));
        assert!(external("MPa", "250 N").unwrap_err().contains("in MPa") && external("", "nan").is_err());
    }
}
