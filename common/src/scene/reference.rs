//! Published results of a built-in scene, which tests, calibration and reports compare with.

use super::builtin;
use super::context::{Context, Overrides};
use super::document::document;
use super::faults::Faults;
use super::section::Section;
use std::collections::BTreeMap;

/// The published results of a built-in scene by name, in SI units and cycles; empty if none are known.
///
/// They stand with their source in `common/scenes/NAME.reference.toml`.
///
/// # Errors
/// Faults of that file.
pub fn published_results(scene: &str) -> Result<BTreeMap<String, f64>, Faults> {
    let Some(text) = builtin::reference(scene) else { return Ok(BTreeMap::new()) };
    let document = document(text, scene)?;
    let none = Overrides::new();
    let cx = Context::new(scene, &none);
    let mut file = Section::new(&cx, "", &document);
    let mut results = BTreeMap::new();
    if let Some(published) = file.section("published", "a table of results") {
        for (name, value) in published.entries() {
            let found = cx.value(&published.key(name), value, None);
            results.extend(found.map(|found| (name.clone(), found.value)));
        }
    }
    file.finish();
    let faults = cx.take_faults();
    if faults.is_empty() { Ok(results) } else { Err(Faults(faults)) }
}
