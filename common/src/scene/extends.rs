//! `scene.extends`: finds the scenes that a scene changes, and merges them with it.
//!
//! Tables merge key by key; lists of named tables merge row by row, by name, new rows at the end; everything else is
//! replaced. What `scene.without` names is left out first.

use super::builtin;
use super::csv_import::{SOURCE, import};
use super::document::document;
use super::edit::name;
use super::faults::{FaultKind, Faults, nearest, suggestion};
use super::layers::Layer;
use crate::text_file::read_text;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Scenes may extend each other through this many files.
const EXTENDS_LIMIT: usize = 8;

/// Path of the key that names the extended scene.
const KEY: &str = "scene.extends";

/// Path of the key that lists what is left out of the extended scene.
const WITHOUT: &str = "scene.without";

/// What the file of a scene is, for messages.
pub(super) const SCENE_FILE: &str = "the TOML file of a scene";

/// Name of the scene in the folder of a study.
const COPY: &str = "scene.toml";

/// Text of an input file.
///
/// # Errors
/// It cannot be read.
pub fn read_input(path: &Path) -> Result<String, Faults> {
    read(path, "a text file")
}

/// Text of a file; `expected` says what it should be.
///
/// # Errors
/// It cannot be read.
pub(super) fn read(path: &Path, expected: &str) -> Result<String, Faults> {
    read_text(path, expected).map_err(|why| {
        let copy = path.join(COPY);
        let message = match copy.is_file() {
            true => format!("it is a folder; the scene of a study is {}", copy.display()),
            false => why,
        };
        Faults::one(&path.display().to_string(), "", format!("cannot be read: {message}"))
    })
}

/// The fault of a name that is neither a built-in scene nor a file.
pub(super) fn unknown_scene(name: &str) -> FaultKind {
    let known: Vec<&str> = builtin::SCENES.iter().map(|(name, _)| *name).collect();
    let meant = suggestion(&nearest(name, known.iter().copied()));
    format!("no such scene or file{meant}; built-in scenes: {}", known.join(", ")).into()
}

/// The scene of a text, merged with all scenes that it extends, and their texts.
///
/// # Errors
/// Faults of syntax, and what is wrong with `extends`, each with its place.
pub(super) fn flatten(
    text: String,
    origin: &str,
    folder: Option<&Path>,
) -> Result<(Table, Vec<Layer>), Faults> {
    let mut layers = Vec::new();
    let mut documents = Vec::new();
    let mut next = Some((text, origin.to_owned(), folder.map(Path::to_path_buf)));
    while let Some((text, file, folder)) = next {
        let mut own = document(&text, &file)?;
        let scene = own.get_mut("scene").and_then(Value::as_table_mut);
        let (extends, without) =
            scene.map_or((None, None), |scene| (scene.remove("extends"), scene.remove("without")));
        let mut layer = Layer { file, text, imported: Vec::new() };
        let imported = import(&mut own, &layer.file, folder.as_deref());
        layer.imported = imported.map_err(|faults| layer.located(faults))?;
        let located = |faults| layer.located(faults);
        let without = left_out(without, extends.is_some(), &layer.file).map_err(located)?;
        let base = extends.map(|name| base(&name, documents.len(), &layer.file, folder.as_deref()));
        next = base.transpose().map_err(located)?;
        documents.push((own, without));
        layers.push(layer);
    }
    let mut merged = Table::new();
    for ((own, without), layer) in documents.into_iter().zip(&layers).rev() {
        for path in without {
            if !leave_out(&mut merged, &path) {
                let message = format!("the extended scene has no {path:?}");
                return Err(layer.located(Faults::one(&layer.file, WITHOUT, message)));
            }
        }
        merge(&mut merged, own);
    }
    Ok((merged, layers))
}

/// Paths of what a scene leaves out of the one that it extends.
fn left_out(without: Option<Value>, extends: bool, origin: &str) -> Result<Vec<String>, Faults> {
    let Some(without) = without else { return Ok(vec![]) };
    let fault = |message: String| Faults::one(origin, WITHOUT, message);
    if !extends {
        return Err(fault("needs `extends`: the scene that has what is left out".to_owned()));
    }
    let texts = |paths: &Vec<Value>| paths.iter().map(|path| path.as_str().map(str::to_owned)).collect();
    without.as_array().and_then(texts).ok_or_else(|| {
        fault(format!("{without} is no list of keys, e.g. [\"loads.push\", \"variables.push\"]"))
    })
}

/// Text, file and folder of the scene that `extends` names, in a file which `depth` others extend.
fn base(
    extends: &Value,
    depth: usize,
    origin: &str,
    folder: Option<&Path>,
) -> Result<(String, String, Option<PathBuf>), Faults> {
    if depth == EXTENDS_LIMIT {
        let message = format!("`extends` goes through more than {EXTENDS_LIMIT} scenes: is it a circle?");
        return Err(Faults::one(origin, KEY, message));
    }
    let Some(name) = extends.as_str() else {
        let message = format!("{extends} is not the name of a scene or file");
        return Err(Faults::one(origin, KEY, message));
    };
    if let Some(text) = builtin::text(name) {
        return Ok((text.to_owned(), name.to_owned(), None));
    }
    match folder.map(|folder| folder.join(name)).filter(|path| path.is_file()) {
        Some(path) => {
            let text = read(&path, SCENE_FILE)?;
            Ok((text, path.display().to_string(), path.parent().map(Path::to_path_buf)))
        }
        None => Err(Faults::one(origin, KEY, unknown_scene(name))),
    }
}

/// Keys of a variable that give its distribution without measured samples.
const PARAMETERS: [&str; 9] =
    ["distribution", "mean", "std", "truncation", "lower", "upper", "mode", "diameter", "capability"];

/// Keys of a curve or of samples whose values the scene states.
const VALUES: [&str; 3] = ["at", "value", "values"];

/// Merges `over` into `base`, in place.
fn merge(base: &mut Table, over: Table) {
    if VALUES.iter().any(|key| over.contains_key(*key)) {
        base.remove(SOURCE);
    }
    for (key, value) in over {
        match (base.get_mut(&key), value) {
            (Some(Value::Table(below)), Value::Table(above)) => merge(below, above),
            (Some(Value::Array(below)), Value::Array(above)) if named(below) && named(&above) => {
                merge_rows(below, above);
            }
            (_, value) => {
                base.insert(key, value);
            }
        }
    }
}

/// Removes a key, or a row of a list of named tables, by its path, e.g. `loads.push`: false if there is none.
fn leave_out(base: &mut Table, path: &str) -> bool {
    let Some((first, rest)) = path.split_once('.') else { return base.remove(path).is_some() };
    match base.get_mut(first) {
        Some(Value::Table(inner)) => leave_out(inner, rest),
        Some(Value::Array(rows)) => {
            let (row, below) = rest.split_once('.').unwrap_or((rest, ""));
            let Some(place) = rows.iter().position(|other| name(other) == Some(row)) else { return false };
            if row == rest {
                rows.remove(place);
                return true;
            }
            rows[place].as_table_mut().is_some_and(|row| leave_out(row, below))
        }
        _ => false,
    }
}

fn named(rows: &[Value]) -> bool {
    !rows.is_empty() && rows.iter().all(|row| name(row).is_some())
}

/// Removes the measured samples of a variable whose distribution is given by parameters above, and the reverse.
fn replace_distribution(below: &mut Table, above: &Table) {
    let is_parameter = |key: &str| PARAMETERS.contains(&key);
    if above.contains_key("samples") {
        below.retain(|key, _| key != "fit" && !is_parameter(key));
    } else if below.contains_key("samples") && above.keys().any(|key| is_parameter(key)) {
        below.retain(|key, _| key != "samples" && key != "fit");
    }
}

/// Removes the thresholds of a limit state on whose place others stand above: one where two are given, and the reverse.
fn replace_thresholds(below: &mut Table, above: &Table) {
    let two = |row: &Table| row.contains_key("lower") || row.contains_key("upper");
    let had_two = two(below);
    if !below.contains_key("output") || had_two == two(above) {
        return;
    }
    if above.contains_key("threshold") {
        below.retain(|key, _| !["lower", "upper", "fails"].contains(&key));
    } else if !had_two {
        below.retain(|key, _| !["threshold", "fails"].contains(&key));
    }
}

fn merge_rows(base: &mut Vec<Value>, over: Vec<Value>) {
    let inherited = base.len();
    for row in over {
        let place = base[..inherited].iter().position(|below| name(below) == name(&row));
        match (place.map(|i| &mut base[i]), row) {
            (Some(Value::Table(below)), Value::Table(above)) => {
                replace_distribution(below, &above);
                replace_thresholds(below, &above);
                merge(below, above);
            }
            // Rows of the same file with one name stay two rows: the reader reports the duplicate.
            (_, row) => base.push(row),
        }
    }
}
