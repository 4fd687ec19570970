//! The units of the documents are those of the program, with their exact definitions.

use common::scene::expression::{ExpressionError, evaluate, read_unit};
use common::scene::quantity::{Quantity, UNITS};
use std::collections::BTreeSet;

const PAGE: &str = include_str!("../../scenes/README.md");

/// The cells of the tables of the section on units, by the head of their first column.
fn rows(head: &str) -> Vec<[&'static str; 2]> {
    let section = PAGE.split("### Units").nth(1).unwrap().split("\n## ").next().unwrap();
    let table = section.split(&format!("| {head} |")).nth(1).unwrap();
    let rows: Vec<_> = table
        .lines()
        .skip(2)
        .take_while(|line| line.starts_with('|'))
        .map(|line| {
            let mut cells = line.trim_matches('|').split(" | ").map(str::trim);
            [cells.next().unwrap(), cells.next().unwrap()]
        })
        .collect();
    assert!(rows.len() > 5, "{head}");
    rows
}

fn quoted(cell: &'static str) -> impl Iterator<Item = &'static str> {
    cell.split('`').skip(1).step_by(2)
}

fn value(text: &str) -> Quantity {
    let unknown = |name: &str| Err(ExpressionError::UnknownName { name: name.to_owned(), nearest: None });
    evaluate(text, &mut { unknown }).unwrap_or_else(|error| panic!("{text}: {error}"))
}

#[test]
fn the_page_lists_every_unit_under_its_kind() {
    let mut listed = BTreeSet::new();
    for [kind, units] in rows("kind") {
        let all: Vec<&str> = quoted(units).collect();
        let of_first = read_unit(all[0]).unwrap();
        for symbol in &all {
            let unit = read_unit(symbol).unwrap_or_else(|error| panic!("{symbol}: {error}"));
            assert_eq!(
                (unit.dimension, unit.angle),
                (of_first.dimension, of_first.angle),
                "{kind}: {symbol}"
            );
            assert!(listed.insert(*symbol), "{symbol} is listed twice");
        }
    }
    // The letter mu has two codes; the page shows one.
    let missing: Vec<_> =
        UNITS.iter().filter(|(symbol, _)| !listed.contains(symbol) && *symbol != "\u{3bc}m").collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn units_outside_the_si_have_their_exact_definitions() {
    let defined: BTreeSet<&str> = rows("unit").iter().flat_map(|[unit, _]| quoted(unit)).collect();
    for [unit, definition] in rows("unit") {
        let (unit, definition) = (quoted(unit).next().unwrap(), quoted(definition).next().unwrap());
        let (found, expected) = (read_unit(unit).unwrap(), value(definition));
        assert_eq!(found.dimension, expected.dimension, "{unit}");
        let relative = found.multiply / expected.value - 1.0;
        assert!(relative.abs() <= 2.0 * f64::EPSILON, "{unit}: {} is not {}", found.multiply, expected.value);
    }
    // Every unit whose factor is no power of ten, time and turns apart.
    for (symbol, unit) in UNITS {
        let decades = (unit.multiply / unit.divide).log10();
        let usual = (decades - decades.round()).abs() < 1e-12
            || ["min", "h", "deg", "r", "rev", "rpm"].contains(symbol);
        assert!(usual || defined.contains(symbol), "{symbol} has no definition");
    }
    assert_eq!(value("1 in").value, 0.0254);
    assert_eq!(value("1 lbf").value, 4.448_221_615_260_5);
    // NIST SP 811, appendix B.8: 6.894757 kPa, 0.1129848 N m, 175.1268 N/m.
    for (text, si) in [("1 psi", 6894.757), ("1 lbf in", 0.112_984_8), ("1 lbf/in", 175.1268)] {
        assert!((value(text).value / si - 1.0).abs() < 5e-7, "{text}: {}", value(text).value);
    }
}

#[test]
fn several_units_below_the_bar_may_stand_in_a_parenthesis() {
    for (grouped, single) in [
        ("1e-4 mm^3/(N m)", "1e-4 mm^3/N/m"),
        ("2 kg/(m * s^2)", "2 kg/m/s^2"),
        ("3 1/(Pa s)", "3 1/Pa/s"),
        ("4 m/(s^2)*2", "8 m/s^2"),
    ] {
        assert_eq!(value(grouped), value(single), "{grouped}");
    }
    let unknown = |name: &str| Err(ExpressionError::UnknownName { name: name.to_owned(), nearest: None });
    for wrong in ["1 mm^3/(N m", "1 mm^3/(N m) s", "1 mm^3/(N q)"] {
        assert!(evaluate(wrong, &mut { unknown }).is_err(), "{wrong}");
    }
}
