//! The parts of the JSON Schema of scenes and of the page about their language that follow from the tables of loads, outputs and distributions. With `WRITE_TABLES=1` they are written into the
//! files, otherwise compared with them: `WRITE_TABLES=1 cargo test -p common --test scene language_tables`.

use crate::quantity_patterns::{first_unit, in_range, of_kind, quantities};
use common::scene::quantity::ANGLE;
use common::scene::*;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// A key as scenes write it: its JSON Schema, and whether it is required.
pub(crate) struct Written {
    pub(crate) key: &'static str,
    pub(crate) schema: Value,
    is_required: bool,
}

/// The keys in a scene of a key of the table; none for what the word of the element states.
pub(crate) fn written(key: &'static Key) -> Vec<Written> {
    let one = |schema: Value, is_required: bool| vec![Written { key: key.name, schema, is_required }];
    let reference = |name: &str| json!({ "$ref": format!("#/$defs/{name}") });
    let pair = |items: Value| json!({ "type": "array", "minItems": 2, "maxItems": 2, "items": items });
    let words = |words: [&str; 2]| json!({ "enum": words, "default": words[0] });
    match key.form {
        Form::Name => one(json!({ "type": "string", "pattern": "^[^.]+$" }), true),
        Form::Place | Form::FreePlace => one(reference("place"), true),
        Form::Body | Form::FreeBody | Form::DrivenBody => one(json!({ "type": "string" }), true),
        Form::SignedBody => one(reference("signed_body"), true),
        Form::Direction => {
            let mut direction = pair(json!({ "type": ["number", "string"] }));
            direction["not"] = json!({ "const": [0, 0] });
            one(direction, true)
        }
        Form::Pair(kind) => one(pair(of_kind(kind)), true),
        Form::Number(kind, range) => one(
            in_range(of_kind(kind), range, ("examples", json!([format!("1 {}", first_unit(kind))]))),
            true,
        ),
        Form::NumberOr(kind, range, default) => one(
            in_range(of_kind(kind), range, ("default", json!(format!("{default} {}", first_unit(kind))))),
            false,
        ),
        Form::Curve(_) => one(reference("curve"), true),
        Form::Wanted(_) | Form::Factor => one(reference("curve"), false),
        Form::WantedPoint => ["wanted_x", "wanted_y"]
            .map(|key| Written { key, schema: reference("curve"), is_required: false })
            .into(),
        Form::Joints | Form::StruckJoints | Form::WornJoints => {
            one(json!({ "type": "array", "items": { "type": "string" } }), false)
        }
        Form::ErrorMeasure => one(words(ErrorMeasure::WORDS.map(|(word, _)| word)), false),
        Form::ImpactMeasure => one(words(ImpactMeasure::WORDS.map(|(word, _)| word)), false),
        Form::Held => vec![
            Written { key: "input", schema: json!({ "type": "string" }), is_required: false },
            Written {
                key: "input_angle",
                schema: in_range(of_kind(ANGLE), Range::Any, ("examples", json!(["30 deg"]))),
                is_required: false,
            },
        ],
        Form::Cycles => one(json!({ "type": "integer", "minimum": 1, "maximum": 100_000_000 }), false),
        Form::Word(words) => one(json!({ "enum": words, "default": words[0] }), false),
        Form::WearQuantity | Form::Elsewhere => vec![],
    }
}

/// What a key is, with its range.
pub(crate) fn described(key: &Key) -> String {
    let about = key.about.trim().trim_end_matches('.').replace("`(2,)` ", "").replace(" [1]", "");
    let range = match key.form {
        Form::Number(_, range) | Form::NumberOr(_, range, _) => match range {
            Range::NonNegative => ", >= 0",
            Range::Positive => ", > 0",
            Range::NotZero => ", not 0",
            _ => "",
        },
        Form::Factor => ", >= 0",
        _ => "",
    };
    format!("{about}{range}")
}

/// A schema without what it only suggests.
fn bare(schema: &Value) -> Value {
    let mut fields = schema.as_object().cloned().unwrap_or_default();
    fields.retain(|key, _| key != "examples" && key != "default");
    Value::Object(fields)
}

/// The definition of an element: every key with its types, and for every word the keys that it has; `more` are keys without a table.
fn definition<T>(about: &str, kinds: &'static [ElementKind<T>], more: Value) -> Value {
    let mut found: BTreeMap<&str, Vec<(&str, Value, String)>> = BTreeMap::new();
    for kind in kinds {
        for (word, key) in
            kind.words.iter().take(1).flat_map(|(word, _)| kind.keys.iter().map(move |key| (*word, key)))
        {
            for Written { key: name, schema, .. } in written(key) {
                found.entry(name).or_default().push((word, schema, described(key)));
            }
        }
    }
    let mut properties = more.as_object().cloned().unwrap_or_default();
    let words: Vec<&str> = kinds.iter().flat_map(|kind| kind.words.iter().map(|(word, _)| *word)).collect();
    properties.insert("type".to_owned(), json!({ "description": "Kind", "enum": words }));
    for (key, uses) in &found {
        let mut schemas: Vec<&Value> = Vec::new();
        let mut texts: Vec<(&str, Vec<&str>)> = Vec::new();
        for (word, schema, text) in uses {
            if !schemas.iter().any(|known| bare(known) == bare(schema)) {
                schemas.push(schema);
            }
            match texts.iter_mut().find(|(known, _)| known == text) {
                Some((_, words)) => words.push(word),
                None => texts.push((text, vec![word])),
            }
        }
        let mut property = match schemas[..] {
            [one] if uses.iter().all(|(_, schema, _)| schema == one) => one.clone(),
            [one] => bare(one),
            _ => json!({ "anyOf": schemas }),
        };
        property["description"] = json!(match &texts[..] {
            [(text, _)] => (*text).to_owned(),
            several => {
                let each = several.iter().map(|(text, words)| format!("{}: {text}", words.join(", ")));
                each.collect::<Vec<_>>().join("; ")
            }
        });
        properties.insert((*key).to_owned(), property);
    }
    properties.entry("name".to_owned()).or_insert(json!({ "type": "string", "pattern": "^[^.]+$" }))["description"] =
        json!("Unique name: not empty, without dots");
    let all_of = kinds.iter().filter(|kind| !kind.words.is_empty()).map(|kind| {
        let keys: Vec<Written> = kind.keys.iter().flat_map(written).collect();
        let mut names = vec!["name", "type"];
        names.extend(keys.iter().map(|written| written.key).filter(|key| *key != "name"));
        let mut then = json!({ "propertyNames": { "enum": names } });
        // Keys whose values differ from one kind of element to the other.
        let own = keys.iter().filter(|written| {
            found[written.key].iter().any(|(_, schema, _)| bare(schema) != bare(&written.schema))
        });
        let own: Map<String, Value> =
            own.map(|written| (written.key.to_owned(), written.schema.clone())).collect();
        if !own.is_empty() {
            then["properties"] = Value::Object(own);
        }
        json!({ "if": of_words(kind), "then": then })
    });
    json!({
        "description": about,
        "type": "object",
        "properties": properties,
        "additionalProperties": false,
        "required": ["name"],
        "allOf": all_of.collect::<Vec<_>>(),
    })
}

/// What an element needs in a scene that does not extend another one.
fn required<T>(about: &str, kinds: &'static [ElementKind<T>]) -> Value {
    let of_kind = |kind: &'static ElementKind<T>| {
        let keys =
            kind.keys.iter().flat_map(written).filter(|written| written.is_required && written.key != "name");
        let keys: Vec<&str> = keys.map(|written| written.key).collect();
        (!keys.is_empty()).then(|| json!({ "if": of_words(kind), "then": { "required": keys } }))
    };
    let all_of: Vec<Value> = kinds.iter().filter(|kind| !kind.words.is_empty()).filter_map(of_kind).collect();
    json!({ "description": about, "required": ["type"], "allOf": all_of })
}

/// The keys of a random variable with each distribution; those with a standard deviation may have it from a fit.
fn law() -> Value {
    let all_of = LAWS.map(|(word, keys)| {
        let fit: &[&str] = if keys.contains(&"std") { &["fit", "diameter", "capability"] } else { &[] };
        let keys = [&["name", "distribution", "changes", "unit"], keys, fit].concat();
        json!({
            "if": { "properties": { "distribution": { "enum": [word] } }, "required": ["distribution"] },
            "then": { "propertyNames": { "enum": keys } },
        })
    });
    json!({ "description": "Keys of a random variable by its distribution", "allOf": all_of })
}

/// The condition that the type of an element is one of the words of a kind.
fn of_words<T>(kind: &ElementKind<T>) -> Value {
    let words: Vec<&str> = kind.words.iter().map(|(word, _)| *word).collect();
    json!({ "properties": { "type": { "enum": words } }, "required": ["type"] })
}

/// Keys of a schema in the order in which a person reads them; others follow.
const ORDER: [&str; 12] = [
    "description",
    "type",
    "pattern",
    "enum",
    "minItems",
    "maxItems",
    "properties",
    "additionalProperties",
    "if",
    "then",
    "propertyNames",
    "required",
];
/// Most letters of a line.
const WIDTH: usize = 150;

/// A value as indented text; on one line where that is short enough.
fn pretty(value: &Value, indent: usize) -> String {
    let in_lines = |open: &str, parts: Vec<String>, close: &str| {
        let line = format!("{open}{}{close}", parts.join(", "));
        if line.len() + indent <= WIDTH && !line.contains('\n') {
            return line;
        }
        let margin = " ".repeat(indent + 2);
        let parts: Vec<String> = parts.iter().map(|part| format!("{margin}{part}")).collect();
        format!("{open}\n{}\n{}{close}", parts.join(",\n"), " ".repeat(indent))
    };
    match value {
        Value::Object(fields) => {
            let place = |key: &String| ORDER.iter().position(|known| known == key).unwrap_or(ORDER.len());
            let mut fields: Vec<(&String, &Value)> = fields.iter().collect();
            fields.sort_by_key(|(key, _)| place(key));
            let field =
                |(key, value): (&String, &Value)| format!("{}: {}", json!(key), pretty(value, indent + 2));
            in_lines("{", fields.into_iter().map(field).collect(), "}")
        }
        Value::Array(items) => {
            in_lines("[", items.iter().map(|item| pretty(item, indent + 2)).collect(), "]")
        }
        other => other.to_string(),
    }
}

/// The text of a schema with this definition.
pub(crate) fn with_definition(text: &str, name: &str, definition: &Value) -> String {
    let head = format!("\n    \"{name}\": ");
    let start = text.find(&head).expect("a definition of this name") + head.len();
    let line = text[start..].lines().next().unwrap_or_default().trim_end_matches(',');
    let end = if line.ends_with('}') {
        start + line.len()
    } else {
        start
            + ["\n    },\n", "\n    }\n"].iter().filter_map(|end| text[start..].find(end)).min().unwrap()
            + 6
    };
    format!("{}{}{}", &text[..start], pretty(definition, 4), &text[end..])
}

/// Range and default of a key on the page of the language.
fn range_and_default(form: Form) -> [String; 2] {
    let range = |range: Range| match range {
        Range::NonNegative => ">= 0",
        Range::NotZero => "not 0",
        Range::Positive => "> 0",
        _ => "any",
    };
    let [range, default] = match form {
        Form::Number(_, allowed) => [range(allowed).to_owned(), "required".to_owned()],
        Form::NumberOr(_, allowed, default) => [range(allowed).to_owned(), default.to_string()],
        Form::Direction => ["not `[0, 0]`".to_owned(), "required".to_owned()],
        Form::Factor => [">= 0".to_owned(), "1".to_owned()],
        Form::Joints => [String::new(), "all".to_owned()],
        Form::StruckJoints => [String::new(), "all with clearance".to_owned()],
        Form::WornJoints => [String::new(), "all such".to_owned()],
        Form::Wanted(_) | Form::WantedPoint => [String::new(), "that with ideal joints".to_owned()],
        Form::ErrorMeasure => [String::new(), "`\"largest\"`".to_owned()],
        Form::ImpactMeasure => [String::new(), "`\"total\"`".to_owned()],
        Form::Held => [String::new(), "the only driven body; the largest over the cycle".to_owned()],
        _ => [String::new(), "required".to_owned()],
    };
    [range, default]
}

/// How a value is written, before what it is.
fn written_as(form: Form) -> &'static str {
    match form {
        Form::Place => "place: ",
        Form::FreePlace => "place on a free body: ",
        Form::Body => "name of a body: ",
        Form::FreeBody => "name of a free body: ",
        Form::DrivenBody => "name of a driven body: ",
        Form::SignedBody => "`{ body, sign, label }`: ",
        Form::Direction => "pair of plain numbers, whose length is ignored: ",
        Form::Pair(_) => "pair: ",
        Form::Curve(_) | Form::Wanted(_) | Form::Factor => "curve: ",
        Form::WantedPoint => "curves: ",
        Form::Joints | Form::StruckJoints | Form::WornJoints => "list of names: ",
        Form::ErrorMeasure => "`\"largest\"` or `\"rms\"`: ",
        Form::ImpactMeasure => "`\"total\"` or `\"largest\"`: ",
        _ => "",
    }
}

/// A doc comment in a cell of a table: units in parentheses, without shapes.
pub(crate) fn in_cell(about: &str) -> String {
    let text =
        about.trim().trim_end_matches('.').replace("`(2,)` ", "").replace(" [1]", "").replace('|', "\\|");
    let mut letters = text.chars();
    let first = letters.next().map(|letter| letter.to_lowercase().to_string()).unwrap_or_default();
    let text = first + letters.as_str();
    match text.rsplit_once(" [") {
        Some((what, unit)) if unit.ends_with(']') => format!("{what} (`{}`)", unit.trim_end_matches(']')),
        _ => text,
    }
}

/// The rows of an element: for each kind what it is, then its keys. `last` is what the last column says of a word.
fn rows<T>(kinds: &'static [ElementKind<T>], last: impl Fn(&T) -> String, has_range: bool) -> String {
    let mut text = String::new();
    for kind in kinds.iter().filter(|kind| !kind.words.is_empty()) {
        let about = in_cell(kind.about);
        for (place, (word, of_word)) in kind.words.iter().enumerate() {
            let about = if place == 0 { about.as_str() } else { "likewise" };
            text += &format!("| `\"{word}\"` | | {about} | |{}\n", last(of_word));
        }
        for key in kind.keys.iter().filter(|key| !matches!(key.form, Form::Name | Form::WearQuantity)) {
            let names = written(key)
                .iter()
                .map(|written| format!("`{}`", written.key))
                .collect::<Vec<_>>()
                .join(", ");
            let [range, default] = range_and_default(key.form);
            let value = format!("{}{}", written_as(key.form), in_cell(key.about));
            text += &match has_range {
                true => format!("| | {names} | {value} | {range} | {default} |\n"),
                false => format!("| | {names} | {value} | {default} | |\n"),
            };
        }
    }
    text
}

/// The text of the page with this table between its marks.
pub(crate) fn with_table(page: &str, name: &str, table: &str) -> String {
    let start = page.find(&format!("<!-- {name}: written by ")).expect("the mark of a table");
    let start = start + page[start..].find('\n').expect("a line") + 1;
    let end = start + page[start..].find("<!-- end -->").expect("the end of a table");
    format!("{}{table}{}", &page[..start], &page[end..])
}

/// Compares a file with what follows from the tables, or writes it.
pub(crate) fn compare(file: &str, follows: impl Fn(String) -> String) {
    let file = format!("{}/{file}", env!("CARGO_MANIFEST_DIR"));
    let present = std::fs::read_to_string(&file).unwrap();
    let text = follows(present.clone());
    if std::env::var_os("WRITE_TABLES").is_some() {
        std::fs::write(file, text).unwrap();
    } else {
        assert!(
            text == present,
            "{file}: run WRITE_TABLES=1 cargo test -p common --test scene language_tables"
        );
    }
}

#[test]
fn the_page_follows_from_the_tables() {
    compare("scenes/README.md", |page| {
        let head = "| `type` | key | value | range | default |\n|---|---|---|---|---|\n";
        let loads = format!("{head}{}", rows(Load::KINDS, |_| " |".to_owned(), true));
        let head = "| `type` | key | value | default | unit |\n|---|---|---|---|---|\n";
        let unit = |unit: &OutputUnit| {
            let name = unit.kind().name.trim_start_matches("an ").trim_start_matches("a ");
            format!(" {} |", if name == "plain number" { "none" } else { name })
        };
        let outputs = format!("{head}{}", rows(OutputKind::KINDS, unit, false));
        with_table(&with_table(&page, "loads", &loads), "outputs", &outputs)
    });
}

#[test]
fn the_schema_follows_from_the_tables() {
    let of_simulator = json!({
        "unit": { "description": "Of an external simulator: unit for display, not converted", "type": "string" },
        "values": {
            "description": "Of an external simulator: number of values, 1 or one per checkpoint",
            "type": "integer", "minimum": 1, "maximum": 100_000_000
        },
    });
    let mut whole_output = required("What an output of a mechanism needs", OutputKind::KINDS);
    whole_output["propertyNames"] = json!({ "not": { "enum": ["unit", "values"] } });
    let definitions = [
        ("load", definition("A load on bodies", Load::KINDS, json!({}))),
        ("output", definition("A number per checkpoint of life", OutputKind::KINDS, of_simulator)),
        ("whole_load", required("What a load needs", Load::KINDS)),
        ("whole_output", whole_output),
        ("law", law()),
        (
            "distribution",
            json!({ "description": "Its distribution", "enum": LAWS.map(|(word, _)| word), "default": DEFAULT_LAW }),
        ),
    ];
    let definitions = definitions.map(|(name, definition)| (name.to_owned(), definition));
    let definitions: Vec<(String, Value)> = definitions.into_iter().chain(quantities()).collect();
    compare("../coordinator/schemas/scene.schema.json", |text| {
        definitions.iter().fold(text, |text, (name, definition)| with_definition(&text, name, definition))
    });
}
