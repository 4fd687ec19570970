//! The text of a scene with other contents: comments, the order of keys and the notation of everything that stays the same are kept.
//!
//! The wanted contents are compared with those of the text, table by table and row by row; only what differs is written.

use serde::de::IntoDeserializer;
use serde::{Deserialize, Serialize};
use toml::{Table, Value};
use toml_edit::ser::ValueSerializer;
use toml_edit::{DocumentMut, Item, TableLike};

/// A text with the contents of `document`, in the form of the last of `texts`; what that does not have has the form of the first of the
/// others that has it.
pub(super) fn rewritten(texts: &[&str], document: &Table) -> String {
    let mut parsed: Vec<DocumentMut> = texts.iter().filter_map(|text| text.parse().ok()).collect();
    let edited = parsed.pop().map(|mut text| {
        let others: Vec<&Item> = parsed.iter().map(DocumentMut::as_item).collect();
        fit_table(text.as_table_mut(), &others, document, true);
        text.to_string()
    });
    let is_right = |text: &String| text.parse::<Table>().is_ok_and(|found| found == *document);
    let kept = edited.filter(is_right);
    let text = kept.unwrap_or_else(|| toml::to_string(document).expect("a scene is a table of TOML"));
    // Each text may begin with what it is about.
    let others = &texts[..texts.len().saturating_sub(1)];
    let heads = others.iter().map(|text| head(text)).filter(|head| !head.is_empty());
    heads.map(|head| head + "\n").chain([text]).collect()
}

/// The comment at the head of a text.
fn head(text: &str) -> String {
    text.lines().take_while(|line| line.starts_with('#')).map(|line| format!("{line}\n")).collect()
}

/// Gives a table these contents; `others` are the same table in other texts.
fn fit_table(table: &mut dyn TableLike, others: &[&Item], contents: &Table, is_whole: bool) {
    let gone = table.iter().map(|(key, _)| key.to_owned()).filter(|key| !contents.contains_key(key));
    for key in gone.collect::<Vec<_>>() {
        table.remove(&key);
    }
    for (key, value) in contents {
        let others: Vec<&Item> = others.iter().filter_map(|other| other.as_table_like()?.get(key)).collect();
        match table.get_mut(key) {
            Some(item) => fit(item, &others, value),
            None => drop(table.insert(key, new_item(&others, value, is_whole))),
        }
    }
}

/// Gives an item this value; `others` are the items in its place in other texts.
fn fit(item: &mut Item, others: &[&Item], value: &Value) {
    if read(item).as_ref() == Some(value) {
        return;
    }
    match (item, value) {
        (item, Value::Table(contents)) if item.is_table_like() => {
            if let Some(table) = item.as_table_like_mut() {
                fit_table(table, others, contents, false);
            }
        }
        (Item::ArrayOfTables(rows), Value::Array(values)) if are_tables(values) => {
            let fitted = fit_rows(rows.iter().cloned().map(Item::Table).collect(), others, values);
            *rows = fitted.into_iter().filter_map(|(row, _)| row.into_table().ok()).collect();
        }
        (Item::Value(toml_edit::Value::Array(list)), Value::Array(values)) => {
            let old: Vec<Item> = list.iter().cloned().map(Item::Value).collect();
            // The space before an entry, without a comment that belongs to the one before it.
            let before =
                list.iter().last().and_then(|entry| entry.decor().prefix()?.as_str().map(str::to_owned));
            let space = before.map(|text| text[text.rfind('\n').unwrap_or(0)..].to_owned());
            list.clear();
            for (row, is_new) in fit_rows(old, others, values) {
                let Ok(mut value) = row.into_value() else { continue };
                if let Some(space) = space.as_ref().filter(|_| is_new) {
                    value.decor_mut().set_prefix(space);
                    value.decor_mut().set_suffix("");
                }
                list.push_formatted(value);
            }
        }
        (item, value) => {
            let decor = item.as_value().map(|value| value.decor().clone());
            *item = new_item(others, value, false);
            if let (Some(written), Some(decor)) = (item.as_value_mut(), decor) {
                *written.decor_mut() = decor;
            }
        }
    }
}

/// Rows with these values, each from the old row of the same value or name, and true for those that are new.
fn fit_rows(old: Vec<Item>, others: &[&Item], values: &[Value]) -> Vec<(Item, bool)> {
    let mut old: Vec<Option<Item>> = old.into_iter().map(Some).collect();
    let others: Vec<Vec<Item>> = others.iter().map(|other| rows_of(other)).collect();
    let is_row = |item: &Item, value: &Value| {
        name(value).is_some() && read(item).as_ref().and_then(name) == name(value)
    };
    let fitted = values.iter().enumerate().map(|(k, value)| {
        let others: Vec<&Item> =
            others.iter().filter_map(|rows| rows.iter().find(|row| is_row(row, value))).collect();
        let find =
            |is_asked: &dyn Fn(&Item) -> bool| old.iter().position(|row| row.as_ref().is_some_and(is_asked));
        let place = match value {
            // Entries of a list of values have their places; rows have names, or are the same.
            Value::Table(_) => find(&|row| read(row).as_ref() == Some(value))
                .or_else(|| find(&|row| is_row(row, value)))
                .or_else(|| Some(k).filter(|_| name(value).is_none())),
            _ => Some(k),
        };
        match place.and_then(|place| old.get_mut(place)?.take()) {
            Some(mut row) => {
                fit(&mut row, &others, value);
                (row, false)
            }
            None => (new_row(&others, value), true),
        }
    });
    fitted.collect()
}

/// A row that the text does not have.
fn new_row(others: &[&Item], value: &Value) -> Item {
    match new_item(others, value, true) {
        Item::Value(toml_edit::Value::InlineTable(row)) => Item::Table(row.into_table()),
        other => other,
    }
}

/// The rows or entries of a list.
fn rows_of(item: &Item) -> Vec<Item> {
    match item {
        Item::ArrayOfTables(rows) => rows.iter().cloned().map(Item::Table).collect(),
        Item::Value(toml_edit::Value::Array(list)) => list.iter().cloned().map(Item::Value).collect(),
        _ => vec![],
    }
}

/// A value that the text does not have, in the form of one of `others` if they have it; as tables with separate heads if `has_heads`.
fn new_item(others: &[&Item], value: &Value, has_heads: bool) -> Item {
    let Some((first, rest)) = others.split_first() else { return written(value, has_heads) };
    let mut item = (*first).clone();
    forget_positions(&mut item);
    fit(&mut item, rest, value);
    item
}

/// A value in the usual form.
fn written(value: &Value, has_heads: bool) -> Item {
    match value {
        Value::Table(table) if has_heads => {
            let entries = table.iter().map(|(key, value)| (key.as_str(), written(value, false)));
            Item::Table(entries.collect())
        }
        Value::Array(rows) if has_heads && are_tables(rows) => {
            let rows = rows.iter().filter_map(|row| written(row, true).into_table().ok());
            Item::ArrayOfTables(rows.collect())
        }
        value => Item::Value(value.serialize(ValueSerializer::new()).expect("a value of TOML")),
    }
}

/// The value of an item; `None` if it has none.
fn read(item: &Item) -> Option<Value> {
    Value::deserialize(item.clone().into_value().ok()?.into_deserializer()).ok()
}

/// The tables of another text have the places of that text.
fn forget_positions(item: &mut Item) {
    let tables: Vec<&mut toml_edit::Table> = match item {
        Item::Table(table) => vec![table],
        Item::ArrayOfTables(rows) => rows.iter_mut().collect(),
        _ => vec![],
    };
    for table in tables {
        table.set_position(None);
        table.iter_mut().for_each(|(_, item)| forget_positions(item));
    }
}

fn are_tables(rows: &[Value]) -> bool {
    !rows.is_empty() && rows.iter().all(Value::is_table)
}

/// The name of a row; `None` if it has none.
pub(super) fn name(row: &Value) -> Option<&str> {
    row.get("name")?.as_str()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "\
# A crank, after API 11E.
[scene]
name = 'crank' # short

# Rows of one name.
[[bodies]]
name = \"frame\"
# Points of the frame.
[bodies.points]
pin = [\"1 mm\", 0x10] # from the drawing

[[bodies]] # turns
name = \"crank\"
mass = \"2_000 g\"

[parameters]
z = 1_000
a = \"2 mm\" # last

[life]
rows = [
  { name = \"one\", value = 1 }, # the first
  { name = \"two\", value = 2 },
]
";

    /// The text after a change of its contents.
    fn changed(edit: impl FnOnce(&mut Table)) -> String {
        let mut document: Table = TEXT.parse().unwrap();
        edit(&mut document);
        let text = rewritten(&[TEXT], &document);
        assert_eq!(text.parse::<Table>().unwrap(), document);
        text
    }

    #[test]
    fn issue_a_changed_scene_lost_its_comments_and_the_order_of_its_keys() {
        assert_eq!(changed(|_| ()), TEXT);
        let value = changed(|document| {
            document["parameters"]["a"] = "3 mm".into();
            document["bodies"][0]["points"]["pin"][0] = "2 mm".into();
        });
        assert_eq!(value, TEXT.replace("2 mm", "3 mm").replace("1 mm", "2 mm"));
        // A key of a table, a row of a list, a table and a list.
        let more = changed(|document| {
            document["bodies"][1].as_table_mut().unwrap().insert("inertia".into(), 3.into());
            let row: Table = "name = \"rod\"\npoints = { pin = [0, 0] }".parse().unwrap();
            document["bodies"].as_array_mut().unwrap().push(row.into());
            document["life"]["rows"].as_array_mut().unwrap().push("x = 3".parse::<Table>().unwrap().into());
            document.insert("study".into(), Value::Table("seed = 3".parse().unwrap()));
            document.insert("gravity".into(), vec![0, 1].into());
        });
        let added =
            ["inertia = 3\n", "\n[[bodies]]\nname = \"rod\"\n", "  { x = 3 }", "\n[study]\nseed = 3\n"];
        for line in TEXT.lines().chain(added) {
            assert!(more.contains(line), "{line}\n{more}");
        }
        let less = changed(|document| {
            document["bodies"].as_array_mut().unwrap().remove(0);
            document["life"]["rows"].as_array_mut().unwrap().remove(1);
            document.remove("parameters");
        });
        assert!(less.contains("[[bodies]] # turns\nname = \"crank\"\nmass = \"2_000 g\"\n"), "{less}");
        assert!(!less.contains("frame") && less.contains("{ name = \"one\", value = 1 }"), "{less}");
    }

    #[test]
    fn what_a_text_does_not_have_comes_from_the_others() {
        let own = "[scene]\nname = 'mine'\n# Heavier.\n[[bodies]]\nname = \"crank\"\nmass = \"3 kg\"\n\
                   # A rod.\n[[bodies]]\nname = \"rod\" # new\n";
        let mut document: Table = TEXT.parse().unwrap();
        document["scene"]["name"] = "mine".into();
        document["bodies"][1]["mass"] = "3 kg".into();
        let row: Table = "name = \"rod\"".parse().unwrap();
        document["bodies"].as_array_mut().unwrap().push(row.into());
        let text = rewritten(&[own, TEXT], &document);
        assert_eq!(text.parse::<Table>().unwrap(), document);
        for line in TEXT.replace("'crank'", "'mine'").replace("2_000 g", "3 kg").lines() {
            assert!(text.contains(line), "{line}\n{text}");
        }
        assert!(text.contains("# A rod.\n[[bodies]]\nname = \"rod\" # new\n"), "{text}");
    }
}
