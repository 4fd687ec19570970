//! The units that a quantity may have, for the message about one that does not exist.

use super::expression::{ExpressionError, read_unit};
use super::expression_error::nearest_unit;
use super::quantity::{AngleUnit, Dimension, Kind, Quantity, UNITS, Unit};

/// The message of an error; of an unknown unit with the units that the quantity may have.
pub(super) fn advised(error: &ExpressionError, expected: Option<Kind>) -> String {
    let ExpressionError::UnknownUnit(name) = error else { return error.to_string() };
    let meant = nearest_unit(name);
    let of_nearest = || {
        let Unit { dimension, angle, .. } = read_unit(meant.as_deref()?).ok()?;
        Some(Quantity { value: 1.0, dimension, angle }.kind())
    };
    match expected.or_else(of_nearest) {
        Some(kind) => format!("{error} (units of {}: {})", kind.name, units_of(kind)),
        None => format!("{error} (units: {})", symbols(|_| true).join(", ")),
    }
}

/// The units of a kind: those suggested first, then all others.
fn units_of(kind: Kind) -> String {
    let suggested = kind.units.split(", ").filter(|symbol| !symbol.is_empty()).map(str::to_owned);
    let mut all: Vec<String> = suggested.collect();
    let plain = kind.dimension == Dimension::NONE && kind.angle == AngleUnit::Absent;
    let is_of_kind = |unit: &Unit| unit.dimension == kind.dimension && kind.takes(unit.angle);
    for symbol in symbols(is_of_kind) {
        if !all.contains(&symbol) {
            all.push(symbol);
        }
    }
    if plain {
        all.insert(0, "none".to_owned());
    }
    all.join(", ")
}

/// The symbols of units, without those that keyboards lack.
fn symbols(of: impl Fn(&Unit) -> bool) -> Vec<String> {
    let found = UNITS.iter().filter(|(symbol, unit)| symbol.is_ascii() && of(unit));
    found.map(|(symbol, _)| (*symbol).to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::quantity::{ANGLE, LENGTH, NUMBER, STIFFNESS, TORQUE};
    use super::*;

    #[test]
    fn the_units_of_a_kind_are_listed() {
        let unknown = ExpressionError::UnknownUnit("mmm".to_owned());
        assert_eq!(
            advised(&unknown, Some(LENGTH)),
            "unknown unit `mmm`, did you mean `mm`? (units of a length: mm, um, m, km, cm, nm, in, ft, mil)"
        );
        assert!(advised(&unknown, None).contains("units of a length: mm, um"));
        assert!(advised(&unknown, Some(STIFFNESS)).ends_with("units of a stiffness: N/m, N/mm)"));
        assert!(advised(&unknown, Some(TORQUE)).ends_with("units of a torque: N m, N mm, mJ, J)"));
        assert!(advised(&unknown, Some(NUMBER)).ends_with("units of a plain number: none, %)"));
        assert!(advised(&unknown, Some(ANGLE)).ends_with("deg, rad, mrad, arcmin, arcsec, r, rev)"));
        let product = ExpressionError::UnknownUnit("Nm".to_owned());
        assert!(advised(&product, None).contains("did you mean `N m`? (units of a torque: N m, N mm"));
        let far = ExpressionError::UnknownUnit("furlong".to_owned());
        assert!(advised(&far, None).contains(" (units: m, km, cm"), "{}", advised(&far, None));
    }
}
