//! `scene.extends`: finds the scenes that a scene changes, and merges them with it.

use super::builtin;
use super::csv_import::import;
use super::document::document;
use super::faults::{FaultKind, Faults, nearest};
use super::layers::{Layer, Layers};
use super::merge::merge;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Scenes may extend each other through this many files.
const EXTENDS_LIMIT: usize = 8;

/// Path of the key that names the extended scene.
const KEY: &str = "scene.extends";

/// Reads a file of a scene.
///
/// # Errors
/// [`FaultKind::Unreadable`].
pub(super) fn read(path: &Path) -> Result<String, Faults> {
    std::fs::read_to_string(path).map_err(|error| {
        Faults::one(&path.display().to_string(), "", FaultKind::Unreadable { message: error.to_string() })
    })
}

/// The fault of a name that is neither a built-in scene nor a file.
pub(super) fn unknown_scene(name: &str) -> FaultKind {
    let known: Vec<&str> = builtin::SCENES.iter().map(|(name, _)| *name).collect();
    FaultKind::UnknownScene {
        nearest: nearest(name, known.iter().copied()),
        known: known.into_iter().map(str::to_owned).collect(),
    }
}

/// The scene of a text, merged with all scenes that it extends, and their texts.
///
/// # Errors
/// Faults of syntax, and what is wrong with `extends`, each with its place.
pub(super) fn flatten(text: String, origin: &str, folder: Option<&Path>) -> Result<(Table, Layers), Faults> {
    let mut layers = Vec::new();
    let mut documents = Vec::new();
    let mut next = Some((text, origin.to_owned(), folder.map(Path::to_path_buf)));
    while let Some((text, file, folder)) = next {
        let mut own = document(&text, &file)?;
        let scene = own.get_mut("scene").and_then(Value::as_table_mut);
        let extends = scene.and_then(|scene| scene.remove("extends"));
        let mut layer = Layer { file, text, imported: Vec::new() };
        let imported = import(&mut own, &layer.file, folder.as_deref());
        layer.imported = imported.map_err(|faults| Layers(vec![layer.clone()]).located(faults))?;
        next = match extends {
            None => None,
            Some(extends) => {
                let base = base(&extends, documents.len(), &layer.file, folder.as_deref());
                Some(base.map_err(|faults| Layers(vec![layer.clone()]).located(faults))?)
            }
        };
        documents.push(own);
        layers.push(layer);
    }
    let merged = documents.into_iter().rev().reduce(|mut below, above| {
        merge(&mut below, above);
        below
    });
    Ok((merged.unwrap_or_default(), Layers(layers)))
}

/// Text, file and folder of the scene that `extends` names, in a file which `depth` others extend.
fn base(
    extends: &Value,
    depth: usize,
    origin: &str,
    folder: Option<&Path>,
) -> Result<(String, String, Option<PathBuf>), Faults> {
    if depth == EXTENDS_LIMIT {
        return Err(Faults::one(origin, KEY, FaultKind::ExtendsTooDeep { limit: EXTENDS_LIMIT }));
    }
    let Some(name) = extends.as_str() else {
        let message = format!("{extends} is not the name of a scene or file");
        return Err(Faults::one(origin, KEY, FaultKind::Inconsistent { message }));
    };
    if let Some(text) = builtin::text(name) {
        return Ok((text.to_owned(), name.to_owned(), None));
    }
    match folder.map(|folder| folder.join(name)).filter(|path| path.is_file()) {
        Some(path) => Ok((read(&path)?, path.display().to_string(), path.parent().map(Path::to_path_buf))),
        None => Err(Faults::one(origin, KEY, unknown_scene(name))),
    }
}
