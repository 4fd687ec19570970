//! Definitions of quantities in the JSON Schema of scenes: a pattern for every kind, so that editors mark unknown units, units of other kinds,
//! decimal commas and missing units while a scene is written.

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

/// A quantity that is no number below zero where the range has none, with what is shown of it.
pub(crate) fn in_range(mut schema: Value, range: Range, (key, shown): (&str, Value)) -> Value {
    if matches!(range, Range::NonNegative | Range::Positive) {
        schema["not"] = json!({ "$ref": "#/$defs/negative" });
    }
    schema[key] = shown;
    schema
}

const NUMBER_PATTERN: &str = r"\s*[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?";

/// Patterns of quantities: a number with one unit of its kind, with several units of any kind, or an expression, in which a number with anything behind
/// it is not the whole; and negative numbers.
pub(crate) fn quantities() -> Vec<(String, Value)> {
    let any_of = |symbols: Vec<&str>| {
        let mut symbols = symbols;
        symbols.sort_by_key(|symbol| std::cmp::Reverse(symbol.len()));
        format!("(?:{})", symbols.join("|"))
    };
    let with_unit = |symbols: Vec<&str>| json!({ "type": "string", "pattern": format!(r"^{NUMBER_PATTERN}\s*{}\s*$", any_of(symbols)) });
    let all: Vec<&str> = UNITS.iter().map(|(symbol, _)| *symbol).collect();
    let unit = any_of(all.clone());
    let power = r"(?:\^-?\d+)?";
    let compound =
        format!(r"^{NUMBER_PATTERN}\s*(?:{unit}\^-?\d+|(?:1|{unit}){power}(?:[ /](?:1|{unit}){power})+)\s*$");
    let word = format!(r"(?:[^\W\d_][^\W_]*|[%°]){power}");
    let expression = format!(r"^(?!{NUMBER_PATTERN}\s*(?:{word}(?: {word})*)?\s*$)[\w.+\-*/^() %]+$");
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
        (name_of(*kind), either(&format!("A quantity with its unit: {}", kind.in_words()), first))
    };
    let about = "A quantity: a number with its unit, or an expression over parameters; a number without quotes only where it has no unit";
    let plain = json!({ "type": "string", "pattern": format!(r"^{NUMBER_PATTERN}\s*$") });
    let mut quantity = either(about, vec![json!({ "type": "number" }), plain, with_unit(all)]);
    quantity["examples"] = json!(["10 mm", "2 * arm * cos(15 deg)"]);
    let negative = json!({
        "description": "A number below zero",
        "anyOf": [
            { "type": "number", "exclusiveMaximum": 0 },
            { "type": "string", "pattern": format!(r"^\s*-\s*(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?\s*{unit}?\s*$") },
        ],
    });
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
        ("negative", negative),
    ];
    shared.map(|(name, value)| (name.to_owned(), value)).into_iter().chain(KINDS.iter().map(of)).collect()
}
