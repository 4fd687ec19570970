//! The parts of the JSON Schema of scenes and of the page about their language that follow from the table of the wear model; written and compared as
//! in `language_tables.rs`: `WRITE_TABLES=1 cargo test -p common --test scene -- --test-threads=1 tables`.

use crate::language_tables::{compare, described, in_cell, with_definition, with_table, written};
use common::scene::{Form, Key, WearModel};
use serde_json::{Map, Value, json};

fn row(key: &Key) -> String {
    let [range, default] = match key.form {
        Form::Word(words) => {
            let quoted: Vec<String> = words.iter().map(|word| format!("`\"{word}\"`")).collect();
            [quoted.join(" or "), quoted[0].clone()]
        }
        _ => ["whole number, 1 to 100 000 000".to_owned(), "none".to_owned()],
    };
    format!("| `{}` | {} | {range} | {default} |\n", key.name, in_cell(key.about))
}

#[test]
fn the_page_of_the_wear_model_follows_from_its_table() {
    compare("scenes/README.md", |page| {
        let rows: String = WearModel::KEYS.iter().map(row).collect();
        with_table(&page, "wear", &format!("| key | value | range | default |\n|---|---|---|---|\n{rows}"))
    });
}

#[test]
fn the_schema_of_the_wear_model_follows_from_its_table() {
    let property = |key: &'static Key| {
        let mut schema = written(key).remove(0).schema;
        schema["description"] = json!(described(key));
        (key.name.to_owned(), schema)
    };
    let properties: Map<String, Value> = WearModel::KEYS.iter().map(property).collect();
    let definition = json!({
        "description": "Choices of the wear model",
        "type": "object",
        "properties": properties,
        "additionalProperties": false,
    });
    compare("../coordinator/schemas/scene.schema.json", |text| {
        with_definition(&text, "wear_model", &definition)
    });
}
