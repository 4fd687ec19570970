//! Values of a scene as its language reads them: as few digits as give the same number, with a unit.

use crate::presentation::report::format::{seven_digits, unit_scale};
use crate::presentation::report::written::WrittenScene;
use common::scene::expression::{ExpressionError, evaluate, read_unit};

/// Most digits that a number can have.
const DIGITS: usize = 17;

/// What the language reads [SI]; `None` if it is no quantity.
pub fn read(text: &str) -> Option<f64> {
    let unknown = |name: &str| Err(ExpressionError::UnknownName { name: name.to_owned(), nearest: None });
    evaluate(text, &mut { unknown }).ok().map(|quantity| quantity.value)
}

/// A number in plain digits, or with a power of ten far from one.
fn plain(value: f64) -> String {
    if (1e-3..1e6).contains(&value.abs()) || value == 0.0 { value.to_string() } else { format!("{value:e}") }
}

/// The number of this unit with the fewest digits, seven if they suffice, that the language reads as `value` [SI]; `None` if the unit
/// has no such number.
fn number(value: f64, unit: &str) -> Option<String> {
    let scale = read_unit(unit).ok()?;
    let shown = value / (scale.multiply / scale.divide);
    let texts = (6..DIGITS).filter_map(|digits| format!("{shown:.digits$e}").parse().ok().map(plain));
    texts
        .into_iter()
        .find(|text| read(&format!("{text} {unit}")).map(f64::to_bits) == Some((value + 0.0).to_bits()))
}

/// A text with the signs of print: a minus, a square.
fn printed(text: &str) -> String {
    text.replace('-', "\u{2212}").replace("^2", "²")
}

/// A plain number.
pub fn exact_number(value: f64) -> String {
    number(value, "").map_or_else(|| printed(&plain(value)), |text| printed(&text))
}

/// A value [SI] with its unit: this one, or the SI unit where only that has an exact number.
pub fn exact(value: f64, unit: &str) -> String {
    let (text, unit) = number(value, unit).map_or_else(
        || {
            let si = read_unit(unit).map_or(String::new(), |unit| unit.dimension.si_unit());
            // Angles are the quantities without a dimension that have a unit.
            let si = if si == "1" || si.is_empty() { "rad".to_owned() } else { si };
            (format!("{value:e}"), si)
        },
        |text| (text, unit.to_owned()),
    );
    format!("{}\u{a0}{}", printed(&text), printed(&unit).replace('\u{2212}', "-"))
}

/// Texts of the quantities of a scene below a key: exact, and with seven digits where they follow from a formula.
pub struct ExactTexts<'a> {
    /// The scene as it was written.
    pub written: &'a WrittenScene,
    at: String,
}

impl<'a> ExactTexts<'a> {
    /// Texts of the quantities whose keys begin with `at` and a full stop; of all quantities if it is empty.
    pub fn below(written: &'a WrittenScene, at: impl Into<String>) -> Self {
        Self { written, at: at.into() }
    }

    /// The whole key of a quantity.
    pub fn key(&self, last: &str) -> String {
        if self.at.is_empty() { last.to_owned() } else { format!("{}.{last}", self.at) }
    }

    /// The quantity at a key [SI] in this unit.
    pub fn value(&self, last: &str, value: f64, unit: &str) -> String {
        let shown = self.written.units.symbol(unit);
        // A unit that the scene chooses stays, also where it has no exact number.
        let is_exact = shown == unit || number(value, shown).is_some();
        if is_exact && !self.written.has_formula(&self.key(last)) {
            return exact(value, shown);
        }
        self.rounded(value, unit)
    }

    /// A value that follows from others, with seven digits.
    pub fn rounded(&self, value: f64, unit: &str) -> String {
        let unit = self.written.units.symbol(unit);
        format!("{}\u{a0}{}", seven_digits(value / unit_scale(unit)), unit.replace("^2", "²"))
    }

    /// A plain number at a key.
    pub fn number(&self, last: &str, value: f64) -> String {
        if self.written.has_formula(&self.key(last)) { seven_digits(value) } else { exact_number(value) }
    }

    /// A pair at a key [SI] in this unit, which only an entry that has no exact number of it states.
    pub fn pair(&self, last: &str, pair: [f64; 2], unit: &str) -> String {
        let unit = self.written.units.symbol(unit);
        let suffix = format!("\u{a0}{}", unit.replace("^2", "²"));
        let [x, y] = [("x", pair[0]), ("y", pair[1])].map(|(axis, value)| {
            let text = self.value(&format!("{last}.{axis}"), value, unit);
            text.strip_suffix(&suffix).map(str::to_owned).unwrap_or(text)
        });
        format!("({x}, {y})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_the_same_bits() {
        for (text, unit) in [
            ("40.0549 mm", "mm"),
            ("0.8 in", "mm"),
            ("1.293e-13 1/Pa", "1/Pa"),
            ("900 r/min", "r/min"),
            ("53.13 deg", "deg"),
            ("206 GPa", "GPa"),
            ("-0.8 N m", "N m"),
            ("1.7 um", "um"),
        ] {
            let value = read(text).unwrap();
            let shown = exact(value, unit).replace('\u{2212}', "-").replace('\u{a0}', " ");
            assert_eq!(read(&shown), Some(value), "{text}: {shown}");
            assert!(text == "0.8 in" || shown == text, "{text}: {shown}");
        }
        // Values that no decimal of the unit gives, or only long ones.
        for value in [1.0 / 3.0e5, 0.1 + 0.2, std::f64::consts::PI * 1e-7] {
            for unit in ["mm", "um", "deg"] {
                let shown = exact(value, unit).replace('\u{2212}', "-").replace('\u{a0}', " ");
                assert_eq!(read(&shown), Some(value), "{shown}");
            }
        }
        assert_eq!(exact_number(-0.25), "\u{2212}0.25");
        assert_eq!(exact(6e-6, "kg m^2"), "6e\u{2212}6\u{a0}kg m²");
    }
}
