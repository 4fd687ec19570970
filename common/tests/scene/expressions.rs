//! Quantities with units and expressions over parameters.

use common::scene::expression::{ExpressionError, evaluate};
use common::scene::quantity::*;
use proptest::prelude::*;

fn parameters(name: &str) -> Result<Quantity, ExpressionError> {
    let quantity = |value, kind: Kind| Ok(Quantity { value, dimension: kind.dimension, angle: kind.angle });
    match name {
        "rod_length" => quantity(0.0400549, LENGTH),
        "rod_inclination" => quantity(3.0_f64.to_radians(), ANGLE),
        "rod_mass" => quantity(0.57e-3, MASS),
        _ => Err(ExpressionError::UnknownName { name: name.to_owned(), nearest: None }),
    }
}

fn value(text: &str, kind: Kind) -> f64 {
    let quantity = evaluate(text, &mut parameters).unwrap_or_else(|error| panic!("{text}: {error}"));
    assert_eq!(quantity.dimension, kind.dimension, "{text}");
    quantity.value
}

fn error(text: &str) -> String {
    match evaluate(text, &mut parameters) {
        Ok(quantity) => panic!("{text} has the value {quantity:?}"),
        Err(error) => error.to_string(),
    }
}

fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 4.0 * f64::EPSILON * expected.abs(), "{found} is not {expected}");
}

#[test]
fn units_give_si() {
    let turn = 2.0 * std::f64::consts::PI;
    for (text, expected, kind) in [
        ("1.5 mm", 0.0015, LENGTH),
        ("40.05mm", 0.04005, LENGTH),
        ("23.5 um", 23.5e-6, LENGTH),
        ("23.5 µm", 23.5e-6, LENGTH),
        ("480 r/min", 8.0 * turn, ANGULAR_VELOCITY),
        ("480 rpm", 8.0 * turn, ANGULAR_VELOCITY),
        ("200 GPa", 2e11, PRESSURE),
        ("180 deg", turn / 2.0, ANGLE),
        ("0.57 g", 0.57e-3, MASS),
        ("6.55 N s/m", 6.55, DAMPING),
        ("6.55 N*s/m", 6.55, DAMPING),
        ("7.5 s/m", 7.5, INVERSE_SPEED),
        ("1.288e-13 1/Pa", 1.288e-13, INVERSE_PRESSURE),
        ("1.288e-7 mm^2/N", 1.288e-13, INVERSE_PRESSURE),
        ("6.07e-7 kg m^2", 6.07e-7, INERTIA),
        ("9.81 m/s^2", 9.81, ACCELERATION),
        ("95 N/m", 95.0, STIFFNESS),
        ("0.095 N/mm", 95.0, STIFFNESS),
        ("2.4 mm/s", 0.0024, SPEED),
        ("3 N mm", 0.003, TORQUE),
        ("0.2 %", 0.002, NUMBER),
        ("2 mm^2", 2e-6, AREA),
        ("2 kg m^-1 s^-2", 2.0, PRESSURE),
    ] {
        close(value(text, kind), expected);
    }
}

#[test]
fn expressions_carry_their_dimension() {
    close(value("rod_length * cos(rod_inclination)", LENGTH), 0.0400549 * 3.0_f64.to_radians().cos());
    let inertia = 0.57e-3 * (0.0400549_f64 * 3.0_f64.to_radians().cos()).powi(2) / 12.0;
    close(value("rod_mass * (rod_length*cos(rod_inclination))^2 / 12", INERTIA), inertia);
    close(value("-rod_length", LENGTH), -0.0400549);
    close(value("- -rod_length + 1 mm", LENGTH), 0.0410549);
    close(value("sqrt(rod_length * rod_length)", LENGTH), 0.0400549);
    close(value("abs(-3 N)", FORCE), 3.0);
    close(value("2 mm * rod_length", AREA), 2e-3 * 0.0400549);
    close(value("1 / 2 mm * rod_length", NUMBER), 0.0400549 / 2e-3);
    close(value("-2^2", NUMBER), -4.0);
    close(value("2 * (1 + 3)^-2", NUMBER), 0.125);
    close(value("tan(45 deg) - sin(90 deg)", NUMBER) + 1.0, 1.0);
    close(value("2 * pi / 0.125 s", ANGULAR_VELOCITY), 16.0 * std::f64::consts::PI);
}

#[test]
fn faulty_expressions_say_why() {
    for [text, reason] in crate::rows("faulty_expressions_say_why") {
        let found = error(text);
        assert!(found.contains(reason), "{text}: {found}");
    }
    assert!(error(&"(".repeat(100_000)).contains("nested"));
    assert!(evaluate(&format!("{}1", "-".repeat(100_000)), &mut parameters).is_ok());
}

#[test]
fn dimensions_are_named() {
    assert_eq!(FORCE.dimension.to_string(), "a force");
    assert_eq!(FORCE.dimension.times(FORCE.dimension).to_string(), "a quantity in kg^2 m^2/s^4");
    assert_eq!(INVERSE_PRESSURE.dimension.base_units(), "m s^2/kg");
    assert_eq!(STIFFNESS.dimension.si_unit(), "N/m");
}

proptest! {
    #[test]
    fn no_text_panics(text in "\\PC{0,60}") {
        let _ = evaluate(&text, &mut parameters);
    }

    #[test]
    fn no_plausible_text_panics(text in "[0-9a-eEmNs.()+*/^% -]{0,40}") {
        if let Ok(quantity) = evaluate(&text, &mut parameters) {
            prop_assert!(quantity.value.is_finite());
        }
    }

    #[test]
    fn numbers_keep_their_bits(x in proptest::num::f64::NORMAL) {
        let found = evaluate(&format!("{x:?}"), &mut parameters).map(|quantity| quantity.value.to_bits());
        prop_assert_eq!(found, Ok(x.to_bits()));
    }
}

#[test]
fn a_unit_of_angle_is_kept_through_products_with_plain_numbers() {
    let angle =
        |text: &str| evaluate(text, &mut parameters).unwrap_or_else(|error| panic!("{text}: {error}")).angle;
    for text in ["30", "900 1/min", "2 * 900 1/min", "1 / 0.1 s", "-5 %", "sin(30 deg)", "2^3", "rod_mass"] {
        let found = angle(text);
        // A parameter of another kind is open here, as the kinds are.
        let expected = if text == "rod_mass" { AngleUnit::Open } else { AngleUnit::Absent };
        assert_eq!(found, expected, "{text}");
    }
    for text in
        ["30 deg", "900 r/min", "900 rpm", "-2 * rod_inclination / 3", "30 deg + 1 rad", "abs(-1 mrad)"]
    {
        assert_eq!(angle(text), AngleUnit::Present, "{text}");
    }
    for text in ["2 * pi", "pi / 0.5 s", "3 m/s / 20 mm", "sqrt(5 N/m / 2 kg)", "30 + 1 deg", "1 r / 0.1 s"] {
        assert_eq!(angle(text), AngleUnit::Open, "{text}");
    }
}
