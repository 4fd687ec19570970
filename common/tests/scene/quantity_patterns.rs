//! Definitions of quantities in the JSON Schema of scenes: a pattern for every kind, so that editors mark unknown units, units of other kinds,
//! decimal commas and missing units while a scene is written.

use common::random::ToleranceClass;
use common::scene::Range;
use common::scene::quantity::{AngleUnit, Dimension, KINDS, Kind, UNITS, Unit};
use serde_json::{Value, json};

/// The first of the units that messages suggest for a kind of quantity.
pub(crate) fn first_unit(kind: Kind) -> &'static str {
    kind.units.split(',').next().unwrap_or_default()
}

/// Name of the definition of the quantities of a kind.
fn name_of(kind: Kind) -> String {
    kind.name.trim_start_matches("an ").trim_start_matches("a ").replace(' ', "_")
}

pub(crate) fn of_kind(kind: Kind) -> Value {
    json!({ "$ref": format!("#/$defs/{}", name_of(kind)) })
}

/// A quantity that is no number outside of the range, with what is shown of it; the ends of an interval are those of a number without a unit.
pub(crate) fn in_range(mut schema: Value, range: Range, (key, shown): (&str, Value)) -> Value {
    let (refused, ends) = match range {
        Range::Any => (None, vec![]),
        Range::NonNegative => (Some("negative"), vec![]),
        Range::Positive => (Some("not_positive"), vec![]),
        Range::NotZero => (Some("zero"), vec![]),
        Range::Within(from, to) => (None, vec![("minimum", from), ("maximum", to)]),
        Range::Above(from, to) => (None, vec![("exclusiveMinimum", from), ("maximum", to)]),
        Range::Between(from, to) => (None, vec![("exclusiveMinimum", from), ("exclusiveMaximum", to)]),
    };
    if let Some(name) = refused {
        schema["not"] = json!({ "$ref": format!("#/$defs/{name}") });
    }
    for (key, end) in ends {
        schema[key] = json!(end);
    }
    schema[key] = shown;
    schema
}

const NUMBER_PATTERN: &str = r"\s*[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?";

/// Symbols of units, the longest first.
fn any_of(mut symbols: Vec<&str>) -> String {
    symbols.sort_by_key(|symbol| std::cmp::Reverse(symbol.len()));
    format!("(?:{})", symbols.join("|"))
}

/// Symbols of the units of a dimension, of angle or not.
fn symbols_of(dimension: Dimension, angle: AngleUnit) -> String {
    let is_of = |(_, unit): &&(&str, Unit)| (unit.dimension, unit.angle) == (dimension, angle);
    any_of(UNITS.iter().filter(is_of).map(|(symbol, _)| *symbol).collect())
}

/// Patterns of two units, or of one in a denominator, that make a kind of quantity; none if no two do.
fn two_units(kind: &Kind) -> Option<String> {
    let mut classes: Vec<(Dimension, AngleUnit)> = Vec::new();
    for (_, unit) in UNITS {
        if !classes.contains(&(unit.dimension, unit.angle)) {
            classes.push((unit.dimension, unit.angle));
        }
    }
    let mut found = Vec::new();
    for (below, angle) in &classes {
        let firsts = std::iter::once(None).chain(classes.iter().map(Some));
        for (first, sign) in firsts.flat_map(|first| [(first, 1), (first, -1)]) {
            let above = first.map_or(Dimension::NONE, |(dimension, _)| *dimension);
            let is_angle = [Some(*angle), first.map(|(_, angle)| *angle)].contains(&Some(AngleUnit::Present));
            if above.times(below.power(sign)) == kind.dimension
                && (first.is_some() || sign < 0)
                && (kind.angle != AngleUnit::Present || is_angle)
            {
                let first = first.map_or("1".to_owned(), |(dimension, angle)| symbols_of(*dimension, *angle));
                let separator = if sign < 0 { "/" } else { " " };
                found.push(format!("{first}{separator}{}", symbols_of(*below, *angle)));
            }
        }
    }
    (!found.is_empty()).then(|| format!(r"^{NUMBER_PATTERN}\s*(?:{})\s*$", found.join("|")))
}

/// Classes of ISO 286, alone or those of a hole and a shaft.
fn tolerance() -> Value {
    let letters: Vec<String> = ('a'..='z').map(String::from).chain(["js".to_owned()]).collect();
    let grades: Vec<String> = (1..=18).map(|grade: u8| grade.to_string()).collect();
    let known = |letter: &str, grade: &str| ToleranceClass::parse(&format!("{letter}{grade}")).is_ok();
    let grades = grades.into_iter().filter(|grade| known("h", grade)).collect::<Vec<_>>().join("|");
    let class = |of: &dyn Fn(&String) -> String| {
        let letters: Vec<String> = letters.iter().map(of).filter(|letter| known(letter, "7")).collect();
        format!("(?:{})(?:{grades})", letters.join("|"))
    };
    let (hole, shaft) = (class(&|letter| letter.to_uppercase()), class(&String::clone));
    json!({
        "description": "A tolerance class or a fit of ISO 286",
        "type": "string",
        "pattern": format!(r"^(?:{hole}|{shaft}|\s*{hole}\s*/\s*{shaft}\s*)$"),
    })
}

/// Patterns of quantities: a number with one or two units of its kind, with several units of any kind, or an expression, in which a number with anything
/// behind it is not the whole; numbers that are not positive; names of parameters, which are no units.
pub(crate) fn quantities() -> Vec<(String, Value)> {
    let with_unit = |symbols: Vec<&str>| json!({ "type": "string", "pattern": format!(r"^{NUMBER_PATTERN}\s*{}\s*$", any_of(symbols)) });
    let all: Vec<&str> = UNITS.iter().map(|(symbol, _)| *symbol).collect();
    let unit = any_of(all.clone());
    let power = r"(?:\^-?\d+)?";
    let two = format!(r"{NUMBER_PATTERN}\s*(?:1|{unit})[ /]{unit}\s*$");
    let more = format!(r"(?:1|{unit}){power}(?:[ /](?:1|{unit}){power})+");
    let compound = format!(r"^(?!{two}){NUMBER_PATTERN}\s*(?:{unit}\^-?\d+|{more})\s*$");
    let word = format!(r"(?:[^\W\d_][^\W_]*|[%°]){power}");
    let expression =
        format!(r"^(?!{two})(?!{NUMBER_PATTERN}\s*(?:{word}(?: {word})*)?\s*$)[\w.+\-*/^() %]+$");
    let others = [json!({ "$ref": "#/$defs/compound" }), json!({ "$ref": "#/$defs/expression" })];
    let either = |about: &str, first: Vec<Value>| {
        let all = [first, others.to_vec()].concat();
        json!({ "description": about, "anyOf": all })
    };
    let of = |kind: &Kind| {
        let is_of = |(_, unit): &&(&str, Unit)| {
            unit.dimension == kind.dimension && (kind.angle == AngleUnit::Open || unit.angle == kind.angle)
        };
        let symbols: Vec<&str> = UNITS.iter().filter(is_of).map(|(symbol, _)| *symbol).collect();
        let mut first = Vec::new();
        if kind.dimension == Dimension::NONE && kind.angle != AngleUnit::Present {
            first = vec![
                json!({ "type": "number" }),
                json!({ "type": "string", "pattern": format!(r"^{NUMBER_PATTERN}\s*$") }),
            ];
        }
        first.extend((!symbols.is_empty()).then(|| with_unit(symbols)));
        first.extend(two_units(kind).map(|pattern| json!({ "type": "string", "pattern": pattern })));
        (name_of(*kind), either(&format!("A quantity with its unit: {}", kind.in_words()), first))
    };
    let about = "A quantity: a number with its unit, or an expression over parameters; a number without quotes only where it has no unit";
    let plain = json!({ "type": "string", "pattern": format!(r"^{NUMBER_PATTERN}\s*$") });
    let of_two = json!({ "type": "string", "pattern": format!("^{two}") });
    let mut quantity =
        either(about, vec![json!({ "type": "number" }), plain, with_unit(all.clone()), of_two]);
    quantity["examples"] = json!(["10 mm", "2 * arm * cos(15 deg)"]);
    // Numbers of which nothing or a unit follows the digits.
    let number = |about: &str, bound: (&str, f64), digits: &str| {
        let pattern =
            format!(r"^\s*{digits}(?:[eE][-+]?\d+)?\s*(?:{unit}{power}(?:[ /]{unit}{power})*)?\s*$");
        let mut plain = json!({ "type": "number" });
        plain[bound.0] = json!(bound.1);
        json!({ "description": about, "anyOf": [plain, { "type": "string", "pattern": pattern }] })
    };
    let (below, zero) = (r"-\s*(?:\d+\.?\d*|\.\d+)", r"[-+]?\s*(?:0+\.?0*|\.0+)");
    let either_digits = format!("(?:{below}|{zero})");
    let parameter = format!("^(?!{unit}$)[^0-9\\W]\\w*$");
    let shared = [
        ("quantity", quantity),
        (
            "compound",
            json!({ "description": "A number with several units", "type": "string", "pattern": compound }),
        ),
        (
            "expression",
            json!({ "description": "An expression over parameters", "type": "string", "pattern": expression }),
        ),
        ("negative", number("A number below zero", ("exclusiveMaximum", 0.0), below)),
        ("not_positive", number("A number not above zero", ("maximum", 0.0), &either_digits)),
        ("zero", number("Zero", ("const", 0.0), zero)),
        (
            "parameter",
            json!({ "description": "Name of a parameter, which is no unit", "pattern": parameter }),
        ),
        ("tolerance", tolerance()),
    ];
    shared.map(|(name, value)| (name.to_owned(), value)).into_iter().chain(KINDS.iter().map(of)).collect()
}
