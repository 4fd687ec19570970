//! A quantity that a person writes for an output of a scene, e.g. `15.2 um`, as SI value.

use common::scene::expression::{ExpressionError, evaluate};
use common::scene::quantity::{ANGLE, ANGULAR_VELOCITY, FORCE, Kind, LENGTH, TORQUE, VOLUME};
use common::scene::{Output, OutputUnit};

/// The SI value of a quantity of `output`; the output of an external simulator has the unit of its scene, which may be left
/// out.
///
/// # Errors
/// What is wrong and what is expected, in words.
pub fn output_quantity(output: &Output, text: &str) -> Result<f64, String> {
    let kind: Kind = match output.kind.unit() {
        OutputUnit::Length => LENGTH,
        OutputUnit::Volume => VOLUME,
        OutputUnit::AngularVelocity => ANGULAR_VELOCITY,
        OutputUnit::Angle => ANGLE,
        OutputUnit::Force => FORCE,
        OutputUnit::Torque => TORQUE,
        OutputUnit::External(unit) => return external(&unit, text),
    };
    let mut nothing = |name: &str| Err(ExpressionError::UnknownName { name: name.to_owned(), nearest: None });
    match evaluate(text, &mut nothing) {
        Err(error) => Err(format!("{text:?}: {error}; expected {}", kind.in_words())),
        Ok(found) if found.dimension != kind.dimension || !kind.takes(found.angle) => {
            Err(format!("{text:?} is no quantity of {}: expected {}", output.name, kind.in_words()))
        }
        Ok(found) if !found.value.is_finite() => Err(format!("{text:?} is not finite")),
        Ok(found) => Ok(found.value),
    }
}

fn external(unit: &str, text: &str) -> Result<f64, String> {
    let number = text.strip_suffix(unit).unwrap_or(text).trim();
    let value = number.parse::<f64>().ok().filter(|value| value.is_finite());
    let expected = if unit.is_empty() { String::new() } else { format!(" in {unit}") };
    value.ok_or_else(|| format!("{text:?}: expected a number{expected}"))
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
